#!/usr/bin/env perl
# bcifs area: areas of the gallery's curves against the polygons of finer and finer levels, against calculus, and under
# similarities; what is refused and how.
use strict;
use warnings;
use utf8;
use FindBin;
use lib "$FindBin::Bin/lib";
use Bcifs;
use JSON::PP ();
use Test::More;

binmode $_, ':utf8' for map { Test::More->builder->$_ } qw(output failure_output todo_output);

sub gallery { "$ROOT/automata/$_[0].bcifs" }

sub area {
    my ($file, @options) = @_;
    my ($status, $out, $err) = bcifs([ 'area', $file, '--json', '--quiet', @options ]);
    return $status == 0 ? JSON::PP::decode_json($out) : { status => $status, err => $err };
}

# The area of the polygons through the limit points of a depth, each open one closed by its chord; and their size.
sub shoelace {
    my ($file, $depth, @options) = @_;
    my ($status, $out, $err) = bcifs([ 'eval', $file, '--quiet', '--depth', $depth, @options ]);
    die "eval $file @options: $err" if $status;
    my ($area, $size) = (0, 0);
    for my $path (split /\n\n/, $out) {
        my @points = points_of($path);
        my ($x0, $y0) = @{ $points[0] };
        $_ = [ $_->[0] - $x0, $_->[1] - $y0 ] for @points;
        for my $i (0 .. $#points) {
            my ($p, $q) = @points[ $i - 1, $i ];
            $area += ($p->[0] * $q->[1] - $p->[1] * $q->[0]) / 2;
            my $square = $q->[0]**2 + $q->[1]**2;
            $size = $square if $square > $size;
        }
    }
    return ($area, $size);
}

my %curves = (
    'bezier-cubic'          => [qw(flower circle wave)],
    'bezier-quadratic'      => [qw(heart parabola)],
    'bspline-cubic'         => [qw(clover two_arcs)],
    'chaikin'               => [qw(square)],
    'corner-cutting'        => [qw(star corner)],
    'five-points'           => [qw(arch two_arcs crown)],
    'four-point'            => [qw(star arch)],
    'hilbert'               => [qw(square moore)],
    'koch'                  => [qw(snowflake curve antisnowflake bent)],
    'nonuniform-quadratic'  => [qw(crest star)],
    'spiral'                => [qw(lace coil)],
    'takagi'                => [qw(curve cloud four_motifs)],
    'two-motifs'            => [qw(two_motifs bezier takagi bspline tangent spiral)],
);

# ---- Polygons of growing depth ---------------------------------------------------------------------------------
# The error falls at least by the certified radius at every level, below 0.95 for the gallery: after some more levels it
# must be half of what it was, until rounding is all there is.
for my $name (sort keys %curves) {
    for my $figure (@{ $curves{$name} }) {
        my $json = area(gallery($name), '--figure', $figure);
        my @depths = $name =~ /^(?:hilbert|koch)$/ ? (2, 4, 6) : (4, 7, 10);
        my ($last, $good) = (1e300, defined $json->{area});
        my @errors;
        for my $depth (@depths) {
            last if !$good;
            my ($polygon, $size) = shoelace(gallery($name), $depth, '--figure', $figure);
            my $error = abs($polygon - $json->{area}) / $size;
            push @errors, $error;
            $good = $error <= $last / 2 || $error < 1e-12;
            $last = $error;
        }
        ok($good && $last < 0.05, "$name, $figure: polygons tend to the area") or diag("errors @errors; ", $json->{err} // '');
    }
}

# ---- Exact numbers --------------------------------------------------------------------------------------------
{
    my $json = area(gallery('chaikin'));
    is($json->{fraction}, '10/3', 'Chaikin\'s square of side 2 encloses 10/3');
    ok($json->{exact} && $json->{area} == 10 / 3, 'exactly');
    is_deeply([ sort keys %$json ], [qw(area automaton exact figure form forms fraction)], 'the keys of the report');
    is_deeply($json->{form}, $json->{forms}[0]{form}, 'the form is that of the first piece');
    is($json->{forms}[0]{state}, 'arc', 'in its state');
    # The snowflake on the triangle (0,0), (1,0), (0,1): apexes at thirds of the way to the other side's mirror image are
    # affine images of the regular ones. The triangle's area is 1/2, the snowflake's 8/5 of it.
    my @corners = ([ 0, 0 ], [ 0, 1 ], [ 1, 0 ]);
    my ($out, $in) = ('', '');
    for my $i (0 .. 2) {
        my ($p, $q, $r) = @corners[ $i, ($i + 1) % 3, ($i + 2) % 3 ];
        # The apex of an equilateral tent over the middle third: the middle of p, q, away from r by a third of the height.
        my @away = map { sprintf '(%d+%d)*2/3-%d/3', $p->[$_], $q->[$_], $r->[$_] } 0, 1;
        my @toward = map { sprintf '(%d+%d+%d)/3', $p->[$_], $q->[$_], $r->[$_] } 0, 1;
        $out .= "$p->[0] $p->[1]; $away[0] $away[1]; ";
        $in .= "$p->[0] $p->[1]; $toward[0] $toward[1]; ";
    }
    s/; $// for $out, $in;
    my $file = scratch('koch.bcifs',
        file_text(gallery('koch')) . "figure out { closed arc points [ $out ] }\nfigure in { closed arc points [ $in ] }\n");
    is(area($file, '--figure', 'out')->{fraction}, '-4/5', 'the snowflake has 8/5 of its triangle');
    is(area($file, '--figure', 'in')->{fraction}, '-1/5', 'the anti-snowflake 2/5');
    my $regular = area(gallery('koch'), '--figure', 'snowflake');
    cmp_ok(abs($regular->{area} + 8 / 5 * sqrt(3) / 4), '<', 1e-15, 'the regular one too');
    ok(!$regular->{exact} && !defined $regular->{fraction}, 'whose points are known in doubles only');
}

# ---- Params: Takagi's area is 1/(4(1-w)) for an apex 1 high on the chord 0..1 -----------------------------------
for my $w ('0', '1/4', '2/3', '9/10') {
    my $json = area(gallery('takagi'), '--set', "w=$w");
    my $expected = -1 / (4 * (1 - eval $w));
    ok(abs($json->{area} / $expected - 1) < 1e-14 && $json->{exact}, "w = $w: $json->{fraction}");
}

# ---- Similarities, random points --------------------------------------------------------------------------------
# A circle's worth of pieces on random points; integers, so that they lose nothing in the translation by 2^30.
for my $seed (1 .. 4) {
    srand $seed;
    my $count = 5 + int rand 20;
    my @points = map { [ int(rand 2001) - 1000, int(rand 2001) - 1000 ] } 1 .. $count;
    my @found;
    for my $map (
        sub { [ $_[0][0], $_[0][1] ] },
        sub { [ $_[0][0] + 2**30, $_[0][1] - 2**31 ] },
        sub { [ 3 * $_[0][0] - 4 * $_[0][1], 4 * $_[0][0] + 3 * $_[0][1] ] },
        sub { [ $_[0][0], -$_[0][1] ] },
        sub { [ $_[0][0] * 2**-40, $_[0][1] * 2**-40 ] },
        )
    {
        my $csv = scratch('points.csv', join '', map { join(',', map { sprintf '%.17g', $_ } @{ $map->($_) }) . "\n" } @points);
        push @found, area(gallery('four-point'), '--figure', 'star', '--points', $csv)->{area};
    }
    my $size = 1e6;
    ok(abs($found[1] - $found[0]) < 1e-12 * $size
            && abs($found[2] / 25 - $found[0]) < 1e-12 * $size
            && abs($found[3] + $found[0]) < 1e-12 * $size
            && $found[4] * 2**80 == $found[0],
        "seed $seed: translated, turned and scaled, mirrored, shrunk") or diag("@found");
    # The same points written in the file give the same number, as a fraction.
    my $file = scratch('star.bcifs', file_text(gallery('four-point'))
            . 'figure random { closed arc points [ ' . join('; ', map { join ' ', @$_ } @points) . " ] }\n");
    my $json = area($file, '--figure', 'random');
    ok($json->{exact} && abs($json->{area} - $found[0]) < 1e-12 * $size, "seed $seed: $json->{fraction}");
    ok(abs(eval($json->{fraction}) - $json->{area}) <= 1e-15 * abs $json->{area}, 'which is the number');
}

# ---- A state of its own -----------------------------------------------------------------------------------------
{
    my $json = area(gallery('bezier-quadratic'), '--state', 'arc');
    ok(exists $json->{area} && !defined $json->{area} && !$json->{exact}, 'a state has no area');
    is_deeply([ map { sprintf '%.12f', $_ } @{ $json->{form}[0] } ], [ map { sprintf '%.12f', $_ } 0, 2 / 3, 1 / 3 ],
        'but a form');
    my $csv = scratch('arc.csv', "0,0\n1,2\n2,0\n");
    $json = area(gallery('bezier-quadratic'), '--state', 'arc', '--points', $csv);
    ok(abs($json->{area} + 4 / 3) < 1e-15, 'with points it has one');
    my ($status, $out) = bcifs([ 'area', gallery('chaikin'), '--state', 'arc' ]);
    is($out, "chaikin\nform of arc, 3 × 3\n  [ 0     5/12  1/12 ]\n  [ -5/12 0     5/12 ]\n  [ -1/12 -5/12 0    ]\n" =~ s/×/\xc3\x97/r,
        'as text');
    my $path = scratch('report.txt');
    ($status) = bcifs([ 'area', gallery('chaikin'), '-o', $path ]);
    is(file_text($path) =~ /^area 10\/3 \(exact\)$/m ? 1 : 0, 1, 'written to a file');
}

# ---- Refusals ---------------------------------------------------------------------------------------------------
for my $case (
    [ 1, qr/do not converge.*is 1, not below 1/, gallery('levy') ],
    [ 1, qr/do not converge.*is 1, not below 1/, gallery('dragon') ],
    [ 1, qr/do not converge.*is 1, not below 1/, gallery('dragon'), '--figure', 'twindragon' ],
    [ 1, qr/do not converge.*is 1, not below 1/, gallery('takagi'), '--set', 'w=1' ],
    [ 2, qr/not a curve/, gallery('sierpinski-triangle') ],
    [ 2, qr/there is no figure/, gallery('koch'), '--figure', 'flake' ],
    [ 2, qr/exclude each other/, gallery('koch'), '--figure', 'curve', '--state', 'arc' ],
    [ 2, qr/takes arguments/, gallery('nonuniform-quadratic'), '--state', 'p' ],
    )
{
    my ($wanted, $message, $file, @options) = @$case;
    my ($status, $out, $err) = bcifs([ 'area', $file, @options ]);
    is($status, $wanted, "area @options exits with $wanted");
    like($err, $message, 'and says why');
    is($out, '', 'and nothing else');
}
{
    my $head = "automaton t\nedge arc { mask 2 [ 1/4 3/4 3/4 1/4 ] }\n";
    my %files = (
        'two coordinates' => "${head}figure f { closed arc points [ 0 0 0; 1 0 0; 1 1 0 ] }\n",
        'displaced'       => "${head}figure f { closed arc points [ 0 0; 1 0; 1 1 ] displace 1 0 [ 1 1 ] }\n",
        'not a curve'     => "${head}figure f { closed arc closed arc size 2 2 points [ 0 0; 1 0; 1 1; 0 1 ] }\n",
    );
    for my $message (sort keys %files) {
        my ($status, $out, $err) = bcifs([ 'area', scratch('x.bcifs', $files{$message}) ]);
        is($status, 2, 'bad input');
        like($err, qr/$message/, 'with its reason');
    }
    my $wrong = "automaton t\nvertex end 1 { }\nedge arc 2 { start end at 0 end end at 1\n"
        . "sub arc [ 1 1/2; 0 1/2 ] sub arc [ 1/3 0; 2/3 1 ] }\nfigure f { open arc points [ 0 0; 1 1 ] }\n";
    my ($status, $out, $err) = bcifs([ 'area', scratch('x.bcifs', $wrong) ]);
    is($status, 1, 'equations must hold');
    # 30 points that each arc depends on: 29·28/2 = 406 entries.
    my @row = map { 1 / 2**29 } 1;
    my @mask = (1);
    @mask = map { ($_ ? $mask[ $_ - 1 ] : 0) + ($mask[$_] // 0) } 0 .. @mask for 1 .. 30;
    my $wide = "automaton t\nedge arc { mask 2 [ @{[ map { \"$_/536870912\" } @mask ]} ] }\n";
    ($status, $out, $err) = bcifs([ 'area', scratch('x.bcifs', $wide), '--state', 'arc', '--quiet' ]);
    is($status, 1, 'too many entries');
    like($err, qr/has 406 entries; the limit is 300/, 'the limit is named');
}

# ---- Matrices of levels ------------------------------------------------------------------------------------------

# The bytes of a PNG's pixels as "rrggbb" => how many, filters undone.
sub png_colors {
    my ($path) = @_;
    my ($bytes, $data, $at) = (file_text($path), '', 8);
    my ($width, $height, $depth, $type) = unpack 'x16 N N C C', $bytes;
    while ($at < length $bytes) {
        my ($length, $kind) = unpack "x$at N a4", $bytes;
        $data .= substr $bytes, $at + 8, $length if $kind eq 'IDAT';
        $at += 12 + $length;
    }
    return {} if $depth != 8 || $type != 2;
    my $inflated = Compress::Zlib::uncompress($data);
    my ($stride, %colors, @above) = (3 * $width);
    @above = (0) x $stride;
    for my $row (0 .. $height - 1) {
        my ($filter, @line) = unpack 'C*', substr $inflated, $row * ($stride + 1), $stride + 1;
        for my $i (0 .. $#line) {
            my ($left, $up, $corner) = ($i < 3 ? 0 : $line[ $i - 3 ], $above[$i], $i < 3 ? 0 : $above[ $i - 3 ]);
            my $guess = $left + $up - $corner;
            my ($a, $b, $c) = map { abs($guess - $_) } $left, $up, $corner;
            my $paeth = $a <= $b && $a <= $c ? $left : $b <= $c ? $up : $corner;
            $line[$i] = ($line[$i] + (0, $left, $up, ($left + $up) >> 1, $paeth)[$filter]) & 255;
        }
        $colors{ sprintf '%02x%02x%02x', @line[ 3 * $_ .. 3 * $_ + 2 ] }++ for 0 .. $width - 1;
        @above = @line;
    }
    return \%colors;
}

# The rows of a MatrixMarket file whose entries below the diagonal stand for those above it, too.
sub market {
    my ($text) = @_;
    my ($head, @lines) = split /\n/, $text;
    is($head, '%%MatrixMarket matrix coordinate real skew-symmetric', 'MatrixMarket, antisymmetric');
    my ($sizes, @entries) = grep { !/^%/ } @lines;
    my ($rows, $columns, $count) = split ' ', $sizes;
    is(scalar @entries, $count, 'as many entries as it says');
    my @matrix = map { [ (0) x $columns ] } 1 .. $rows;
    my $below = 1;
    for (@entries) {
        my ($i, $j, $value) = split;
        $below &&= $i > $j;
        $matrix[ $i - 1 ][ $j - 1 ] = $value;
        $matrix[ $j - 1 ][ $i - 1 ] = -$value;
    }
    ok($below, 'all of them below the diagonal');
    return \@matrix;
}

# Numbers as numbers: 0 and -0, "1" and 1 are the same.
sub numbers { return [ map { [ map { $_ + 0 } @$_ ] } @{ $_[0] } ] }

for my $case (
    [ 'chaikin', 'square', 3, 2, [ 8, 8, 16 ] ],
    [ 'four-point', 'arch', 2, 1, undef ],
    [ 'nonuniform-quadratic', 'crest', 2, 2, undef ],
    [ 'koch', 'snowflake', 1, 1, [ 6, 18 ] ],
    [ 'two-motifs', 'two_motifs', 2, 2, undef ],
    )
{
    my ($name, $figure, $refine, $coarsen, $sizes) = @$case;
    my @options = ('--figure', $figure, '--refine', $refine, '--coarsen', $coarsen);
    my $what = "$name, $figure, level " . ($refine - $coarsen) . " of $refine";
    my ($json, $plain) = (area(gallery($name), @options), area(gallery($name), '--figure', $figure));
    is_deeply([ map { $json->{$_} } sort keys %$plain ], [ map { $plain->{$_} } sort keys %$plain ],
        "$what: the report of the area is part of it");
    my $matrix = $json->{matrix};
    my $size = 0;
    $size += $_ for @{ $json->{level_sizes} };
    is_deeply($json->{level_sizes}, $sizes, 'sizes of the levels') if $sizes;
    is($json->{coarsen}, $coarsen, 'times coarsened');
    is($json->{scale_points}, $json->{level_sizes}[0], 'control points first');
    is(scalar(grep { @$_ == $size } @$matrix), $size, 'a square matrix');
    is(scalar(grep { $_ != 0 } map {@$_} @$matrix), $json->{entries}, 'entries that are not zero');
    my $antisymmetric = 1;
    for my $i (0 .. $#$matrix) {
        $antisymmetric &&= $matrix->[$i][$_] == -$matrix->[$_][$i] for 0 .. $i;
    }
    ok($antisymmetric, 'antisymmetric');
    my ($mtx, $csv) = map { scratch("m.$_") } qw(mtx csv);
    bcifs([ 'area', gallery($name), @options, '-o', $_ ]) for $mtx, $csv;
    is_deeply(numbers(market(file_text($mtx))), numbers($matrix), 'the same in a file .mtx');
    is_deeply(numbers([ map { [ split /,/ ] } split /\n/, file_text($csv) ]), numbers($matrix), 'and .csv');
    my ($status, $out) = bcifs([ 'area', gallery($name), @options, '--format', 'mtx' ]);
    is_deeply(numbers(market($out)), numbers($matrix), 'and on standard output');
}

# A curve that is given by its fine points is coarsened from them: n = J, and X M Yᵀ/2 at level n is its area.
{
    srand 5;
    my @points = map { [ map { rand(2) - 1 } 1, 2 ] } 1 .. 24;
    my $csv = scratch('points.csv', join '', map {"$_->[0],$_->[1]\n"} @points);
    my ($mother, $coarse) =
        map { area(gallery('chaikin'), '--points', $csv, '--coarsen', $_) } 0, 3;
    my $sum = 0;
    for my $i (0 .. 23) {
        $sum += $points[$i][0] * $mother->{matrix}[$i][$_] * $points[$_][1] / 2 for 0 .. 23;
    }
    cmp_ok(abs($sum - $mother->{area}), '<', 1e-12, 'the area is the form of the control points');
    is_deeply($coarse->{level_sizes}, [ 3, 3, 6, 12 ], 'three levels up');
    is($coarse->{level}, 0, 'the coarsest level is 0');
    my ($status, $out, $err) = bcifs([ 'area', gallery('chaikin'), '--points', $csv, '--coarsen', 4 ]);
    is($status, 2, 'four are too many');
    like($err, qr/24 pieces can be coarsened 3 times only; 4 need a multiple of 16 pieces, such as 32: 32 control points/,
        'it says how far it goes, and what would do');
}

# A drawn curve.
{
    my $svg = scratch('drawn.svg', '<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0L4 0L4 -2L0 -2Z"/></svg>');
    my $json = area(gallery('chaikin'), '--curve', $svg);
    # Chaikin's curve of a rectangle a × b: the square of side 2 has 10/3 = 4·5/6.
    cmp_ok(abs($json->{area} - 8 * 5 / 6), '<', 1e-14, 'the area inside control points of a drawing');
    my ($status, $out, $err) = bcifs([ 'area', gallery('chaikin'), '--curve', $svg, '--points', $svg ]);
    is($status, 2, '--curve and --points');
    like($err, qr/exclude each other/, 'exclude each other');
}

# A state of its own.
{
    my $json = area(gallery('bezier-quadratic'), '--state', 'arc', '--refine', 1, '--coarsen', 1);
    ok(exists $json->{area} && !defined $json->{area}, 'a state has no area');
    is_deeply([ map { sprintf '%.12f', $_ } @{ $json->{matrix}[1] }[ 0 .. 2 ] ],
        [ map { sprintf '%.12f', $_ } -2 / 3, 0, 2 / 3 ], 'but a matrix, closed by the chord');
}

# Pictures: the colors of the three blocks, where they are.
for my $J (0, 1, 3) {
    my @colors = $J ? qw(fff3b0 fbd9d3 d9f0d3 d49a00 b82222 1b733a) : qw(fff3b0 d49a00);
    my ($svg, $png) = map { scratch("m.$_") } qw(svg png);
    for my $path ($svg, $png) {
        my ($status, $out, $err) = bcifs([ 'area', gallery('chaikin'), '--refine', 3, '--coarsen', $J, '-o', $path, '--width', 320 ]);
        is($status, 0, "a picture, J = $J") or diag($err);
    }
    my $text = file_text($svg);
    my %found = map { $_ => 1 } $text =~ /fill="#(\w{6})" d=/g;
    is_deeply([ sort keys %found ], [ sort @colors ], "J = $J: the blocks' colors in a vector picture");
    my ($L, $n) = (3 - $J, 3);
    like($text, qr/M\^$L, n = $n: 32 x 32, [\d.]+ % not zero/, 'its caption');
    like($text, qr/>A @{[ 32 >> $J ]} x @{[ 32 >> $J ]}</, 'and its blocks');
    # Every entry of block A is one box or part of one: their area is that of the entries, less the gaps.
    my $json = area(gallery('chaikin'), '--refine', 3, '--coarsen', $J);
    my $side = 32 >> $J;
    my $entries = grep { $_ != 0 } map { @$_[ 0 .. $side - 1 ] } @{ $json->{matrix} }[ 0 .. $side - 1 ];
    my $covered = 0;
    for my $path ($text =~ /<path shape-rendering="crispEdges" fill="#d49a00" d="(.*?)"/gs) {
        $covered += ($3 - $1) * ($4 - $2) while $path =~ /M(\d+) (\d+)H(\d+)V(\d+)H/g;
    }
    is($covered, $entries * 6 * 6, 'all entries of block A are drawn, 7 pixels apart');
SKIP: {
        skip 'no Compress::Zlib', 1 if !eval { require Compress::Zlib; 1 };
        my $pixels = png_colors($png);
        is(scalar(grep { $pixels->{$_} } @colors), scalar @colors, 'the same colors in pixels');
    }
}

# Text.
{
    my ($status, $out) = bcifs([ 'area', gallery('chaikin'), '--refine', 1, '--coarsen', 1 ]);
    my @lines = split /\n/, $out;
    is(scalar @lines, 3 + 8 + 1, 'the head, eight rows, and a line between levels');
    is(scalar(grep {/ \| /} @lines), 8, 'levels apart in every row');
    my %lengths = map { length() => 1 } @lines[ 3 .. $#lines ];
    is(scalar(keys %lengths), 1, 'aligned');
    like($out, qr/^area matrix of level 0 of 1, 8 \S+ 8: 4 control points, details 4$/m, 'what it is');
    ($status, $out) = bcifs([ 'area', gallery('chaikin'), '--refine', 4, '--coarsen', 1 ]);
    like($out, qr/too large to show, -o x\.mtx writes them/, 'a large one is not shown');
}

for my $case (
    [ 2, qr/2048 rows, JSON holds at most 1024: -o x\.mtx/, gallery('chaikin'), '--refine', 9, '--coarsen', 2, '--json' ],
    [ 2, qr/8192 rows, CSV holds at most 4096: -o x\.mtx/, gallery('chaikin'), '--refine', 11, '--coarsen', 1, '--format', 'csv' ],
    [ 2, qr/written as txt, json, csv, mtx, svg or png, not 'npy'/, gallery('chaikin'), '--coarsen', 1, '--format', 'npy' ],
    [ 2, qr/--refine is for the matrix of --coarsen J/, gallery('chaikin'), '--refine', 1 ],
    [ 2, qr/--format is for the matrix/, gallery('chaikin'), '--format', 'mtx' ],
    [ 2, qr/--width is for the matrix/, gallery('chaikin'), '--width', '500' ],
    [ 2, qr/--coarsen: expected a whole number/, gallery('chaikin'), '--coarsen', '1/2' ],
    [ 2, qr/at most 64 levels/, gallery('chaikin'), '--coarsen', '65' ],
    [ 1, qr/do not converge.*is 1, not below 1/, gallery('levy'), '--coarsen', '1' ],
    [ 2, qr/not a curve/, gallery('sierpinski-triangle'), '--coarsen', '1' ],
    )
{
    my ($wanted, $message, $file, @options) = @$case;
    my ($status, $out, $err) = bcifs([ 'area', $file, @options ]);
    is($status, $wanted, "area @options exits with $wanted");
    like($err, $message, 'and says why');
    is($out, '', 'and nothing else');
}

done_testing();
