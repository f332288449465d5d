#!/usr/bin/env perl
# bcifs describe: the class of every edge, its three levels of description and the ways between them, the sparse
# refinement matrix, and the automaton drawn. What is expected is computed here, from the matrices in the files.
use strict;
use utf8;
use warnings;
use FindBin;
use lib "$FindBin::Bin/lib";
use Bcifs;
use Encode qw(decode_utf8);
use JSON::PP ();
use Math::BigRat;
use Test::More;

binmode $_, ':encoding(UTF-8)' for Test::More->builder->output, Test::More->builder->failure_output;

sub gallery { "$ROOT/automata/$_[0].bcifs" }

sub describe_json {
    my ($file, @options) = @_;
    my ($status, $out, $err) = bcifs([ 'describe', $file, '--json', @options ]);
    diag("describe $file @options: status $status\n$err") if $status;
    return JSON::PP->new->utf8->decode($out);
}

sub edge_named {
    my ($json, $name) = @_;
    my ($edge) = grep { $_->{state} eq $name } @{ $json->{edges} };
    return $edge;
}

# ---- Reading automata ------------------------------------------------------------------------------------------

# The matrix in "[ … ]" when all its entries are fractions, otherwise undef.
sub matrix_read {
    my ($text) = @_;
    my @rows;
    for my $line (split /[\n;]/, $text) {
        my @entries = split ' ', $line or next;
        return if grep { !m{^-?\d+(?:/\d+)?$} } @entries;
        push @rows, [ map { Math::BigRat->new($_) } @entries ];
    }
    return \@rows;
}

# The maps of every edge written with literal matrices: { arc => [ [ child, matrix ], … ] }.
sub maps_read {
    my ($text) = @_;
    $text =~ s/#.*//g;
    my %maps;
    while ($text =~ /^edge (\w+)[^{\n]*\{(.*?)^\}/msg) {
        my ($name, $body, @maps) = ($1, $2);
        while ($body =~ /sub (\w+)(?:\([^)]*\))? \[(.*?)\]/sg) {
            push @maps, [ $1, matrix_read($2) ];
        }
        $maps{$name} = \@maps if @maps && !grep { !defined $_->[1] } @maps;
    }
    return \%maps;
}

sub multiply {
    my ($A, $B) = @_;
    my @product;
    for my $row (@$A) {
        push @product, [
            map {
                my ($j, $sum) = ($_, Math::BigRat->new(0));
                $sum += $row->[$_] * $B->[$_][$j] for grep { !$row->[$_]->is_zero } 0 .. $#$row;
                $sum;
            } 0 .. $#{ $B->[0] }
        ];
    }
    return \@product;
}

# [ A_0 | A_1 | … ], neighbors sharing `joint` columns.
sub fuse {
    my ($joint, @blocks) = @_;
    my $first = shift @blocks;
    my @rows = map { [@$_] } @$first;
    for my $block (@blocks) {
        push @{ $rows[$_] }, @{ $block->[$_] }[ $joint .. $#{ $block->[$_] } ] for 0 .. $#rows;
    }
    return \@rows;
}

# R_0 = I, R_n = fuse of T_i R_n-1(y_i).
sub level_matrix {
    my ($maps, $name, $joint, $depth) = @_;
    my $size = @{ $maps->{$name}[0][1] };
    return [ map { my $i = $_; [ map { Math::BigRat->new($i == $_ ? 1 : 0) } 0 .. $size - 1 ] } 0 .. $size - 1 ]
        if $depth == 0;
    my %below;
    return fuse($joint,
        map { multiply($_->[1], $below{ $_->[0] } //= level_matrix($maps, $_->[0], $joint, $depth - 1)) }
            @{ $maps->{$name} });
}

sub largest_difference {
    my ($found, $expected) = @_;
    return 1e300 if @$found != @$expected || @{ $found->[0] } != @{ $expected->[0] };
    my $largest = 0;
    for my $i (0 .. $#$found) {
        for my $j (0 .. $#{ $found->[$i] }) {
            my $difference = abs($found->[$i][$j] - $expected->[$i][$j]->numify);
            $largest = $difference if $difference > $largest;
        }
    }
    return $largest;
}

sub same_maps {
    my ($one, $other) = @_;
    my $print = sub { join '|', map { "$_->[0] " . join ';', map { join ' ', map { "$_" } @$_ } @{ $_->[1] } } @{ $_[0] } };
    return join(',', sort keys %$one) eq join(',', sort keys %$other)
        && !grep { $print->($one->{$_}) ne $print->($other->{$_}) } keys %$one;
}

# ---- Classes ---------------------------------------------------------------------------------------------------

# N, Δ, m_s, m_a, case, interpolating: read off the matrices by hand.
my %classes = (
    'chaikin arc'                => [ 2, 1, 2, 3, 2, 0 ],
    'bspline-cubic arc'          => [ 2, 1, 3, 4, 3, 0 ],
    'bezier-quadratic arc'       => [ 2, 2, 1, 3, 1, 1 ],
    'bezier-cubic arc'           => [ 2, 3, 1, 4, 1, 1 ],
    'takagi arc'                 => [ 2, 2, 1, 3, 1, 1 ],
    'koch arc'                   => [ 4, 2, 1, 3, 1, 1 ],
    'hilbert arc'                => [ 4, 2, 1, 3, 1, 1 ],
    'levy arc'                   => [ 2, 2, 1, 3, 1, 1 ],
    'four-point arc'             => [ 2, 1, 5, 6, 3, 1 ],
    'five-points arc'            => [ 2, 2, 3, 5, 2, 0 ],
    'corner-cutting arc'         => [ 2, 1, 2, 3, 2, 0 ],
    'spiral arc'                 => [ 2, 2, 2, 4, 1, 0 ],
    'spiral coil'                => [ 2, 2, 3, 5, 2, 0 ],
    'two-motifs tangent'         => [ 2, 2, 2, 4, 1, 0 ],
    'two-motifs bspline'         => [ 2, 1, 3, 4, 3, 0 ],
    'nonuniform-quadratic p'     => [ 2, 1, 2, 3, 2, 0 ],
    'nonuniform-quadratic right' => [ 2, 1, 2, 3, 2, 0 ],
    'dragon backward'            => [ 2, 2, 1, 3, 1, 1 ],
);
for (sort keys %classes) {
    my ($file, $state) = split;
    my $edge = edge_named(describe_json(gallery($file)), $state);
    my ($n, $step, $joint, $points, $case, $interpolating) = @{ $classes{$_} };
    is_deeply(
        { map { ($_ => $edge->{$_}) } qw(subdivisions step joint_points points degree order case) },
        {   subdivisions => $n, step => $step, joint_points => $joint, points => $points,
            degree => $points - 1, order => $joint - 1, case => $case
        },
        "$_: its class");
    is($edge->{interpolating} ? 1 : 0, $interpolating, "$_: interpolating");
    is(scalar @{ $edge->{refinement} }, $points, "$_: rows of the refinement matrix");
    is(scalar @{ $edge->{refinement}[0] }, $n * $step + $joint, "$_: its columns");
}

# The joint's limit point is tested exactly: it misses the control point by 1e-14 here, and not at all there.
for ([ '1', 1 ], [ '99999999999999/100000000000000', 0 ]) {
    my ($entry, $expected) = @$_;
    my $file = scratch(undef, <<"END");
automaton close
vertex j 2 { sub j [ $entry 1/2; 1-$entry 1/2 ] }
edge e 3 { start j at 0 1
  end j at 1 2
  sub e [ $entry 1/2 0; 1-$entry 1/2 $entry; 0 0 1-$entry ]
  sub e [ 1/2 0 0; 1/2 $entry 1/2; 0 1-$entry 1/2 ] }
END
    my $edge = edge_named(describe_json($file), 'e');
    is($edge->{interpolating} ? 1 : 0, $expected, "a joint with the entry $entry");
}

my $chaikin = describe_json(gallery('chaikin'));
is_deeply(
    [ @{ $chaikin->{edges}[0] }{qw(refinement joint masks mask)} ],
    [   [ [ 0.75, 0.25, 0, 0 ], [ 0.25, 0.75, 0.75, 0.25 ], [ 0, 0, 0.25, 0.75 ] ],
        [ [ 0.75, 0.25 ], [ 0.25, 0.75 ] ],
        [ [ 0.75, 0.25 ], [ 0.25, 0.75 ] ],
        [ 0.25, 0.75, 0.75, 0.25 ]
    ],
    'Chaikin: the matrices of the slides, and its masks');
is_deeply([ sort keys %$chaikin ], [qw(automaton cells edges faces parameters)], 'the keys of the report');
is_deeply(
    edge_named(describe_json(gallery('bspline-cubic')), 'arc')->{masks},
    [ [ 0.5, 0.5 ], [ 0.125, 0.75, 0.125 ] ],
    'cubic B-spline: r and s of [IM] 4.3');
is(edge_named(describe_json(gallery('dragon')), 'forward')->{masks}, undef, 'children in other states: no masks');
my $triangle = describe_json(gallery('sierpinski-triangle'));
is_deeply($triangle->{edges}, [], 'a cell is no edge');
is($triangle->{cells}[0]{subdivisions}, 3, 'cells are listed');

# Children of different steps: no refinement matrix, but a reason.
my $uneven = scratch(undef, <<'END');
automaton uneven
vertex v 1 { }
edge a 3 { start v at 0
  end v at 2
  sub a [ 1 1/2 1/4; 0 1/2 1/2; 0 0 1/4 ]
  sub b [ 1/4 0; 1/2 0; 1/4 1 ] }
edge b 2 { start v at 0
  end v at 1
  sub b [ 1 1/2; 0 1/2 ]
  sub b [ 1/2 0; 1/2 1 ] }
END
my $edge = edge_named(describe_json($uneven), 'a');
is($edge->{refinement}, undef, 'steps that differ: no refinement matrix');
like($edge->{refinement_reason}, qr/steps of the children differ/, 'and why not');
ok(edge_named(describe_json($uneven), 'b')->{refinement}, 'the other edge has one');

# ---- T_÷ and its levels ----------------------------------------------------------------------------------------

for my $file (sort glob "$ROOT/automata/*.bcifs") {
    my ($name) = $file =~ m{([^/]+)\.bcifs$};
    my $maps = maps_read(decode_utf8(file_text($file)));
    my %levels;
    for my $state (sort keys %$maps) {
        for my $depth (0 .. 4) {
            my $edge = edge_named($levels{$depth} //= describe_json($file, '--depth', $depth), $state);
            my $expected = level_matrix($maps, $state, $edge->{joint_points}, $depth);
            cmp_ok(largest_difference($edge->{refinement}, $expected), '<=', 1e-15,
                "$name: the refinement matrix of '$state', level $depth");
        }
        # Column iΔ + j of T_÷ is column j of T_i.
        my $edge = edge_named($levels{1}, $state);
        my $wrong = 0;
        for my $i (0 .. $#{ $maps->{$state} }) {
            for my $row (0 .. $edge->{points} - 1) {
                $wrong += abs($edge->{refinement}[$row][ $i * $edge->{step} + $_ ]
                        - $maps->{$state}[$i][1][$row][$_]->numify) > 1e-16
                    for 0 .. $edge->{points} - 1;
            }
        }
        is($wrong, 0, "$name: every map of '$state' is in it");
    }
}

# ---- Rewriting -------------------------------------------------------------------------------------------------

# Writes the automaton at a level; the path of the result.
sub rewritten {
    my ($file, $level, @options) = @_;
    my ($status, $out, $err) = bcifs([ 'describe', $file, '--as', $level, @options ]);
    is($status, 0, "$file as $level") or diag($err);
    return scratch(undef, decode_utf8($out));
}

sub limit_points {
    my ($file, @options) = @_;
    my ($status, $out, $err) = bcifs([ 'eval', $file, '--depth', 5, @options ]);
    diag("eval $file: $err") if $status;
    return $out;
}

for my $name (
    qw(chaikin bspline-cubic bezier-quadratic bezier-cubic takagi koch hilbert levy four-point five-points corner-cutting spiral two-motifs)
    )
{
    my $file = gallery($name);
    my $maps = rewritten($file, 'maps');
    my $refinement = rewritten($maps, 'refinement');
    my $back = rewritten($refinement, 'maps');
    is(file_text($back), file_text($maps), "$name: maps, refinement, maps is the same text");
    for my $rewritten ($maps, $refinement, rewritten($file, 'refinement')) {
        my ($json, $status) = check_json($rewritten);
        is($status, 0, "$name, rewritten: valid");
        is(scalar(grep { !$_->{exact} } @{ $json->{equations} }), 0, "$name, rewritten: proved exactly");
        is(limit_points($rewritten), limit_points($file), "$name, rewritten: the same points, bit for bit");
        is((bcifs([ 'fmt', '--check', $rewritten ]))[0], 0, "$name, rewritten: in canonical layout");
    }
    ok(same_maps(maps_read(decode_utf8(file_text($maps))), maps_read(decode_utf8(file_text($file)))),
        "$name: the maps are the file's own")
        if %{ maps_read(decode_utf8(file_text($file))) } && $name !~ /spiral|two-motifs/;
}

my %masks = (
    'chaikin'        => '1/4 3/4 3/4 1/4',
    'bspline-cubic'  => '1/8 1/2 3/4 1/2 1/8',
    'corner-cutting' => 'a 1-b 1-a b',
    'four-point'     => '-w 0 1/2+w 1 1/2+w 0 -w',
);
for my $name (sort keys %masks) {
    my $maps = rewritten(gallery($name), 'maps');
    my $mask = rewritten($maps, 'mask');
    like(file_text($mask), qr/mask 2 \[ \Q$masks{$name}\E \]/, "$name: its mask");
    is(file_text(rewritten($mask, 'maps')), file_text($maps), "$name: maps, mask, maps is the same text");
    my $refinement = rewritten($mask, 'refinement');
    is(file_text(rewritten($refinement, 'mask')), file_text($mask), "$name: mask, refinement, mask too");
    is((check_json($mask))[1], 0, "$name as mask: valid");
    is(limit_points($mask), limit_points(gallery($name)), "$name as mask: the same points, bit for bit");
}
is(limit_points(rewritten(gallery('takagi'), 'refinement'), '--set', 'w=2/5'),
    limit_points(gallery('takagi'), '--set', 'w=2/5'), 'a param stays free');
like(file_text(rewritten(gallery('takagi'), 'refinement', '--set', 'w=2/5')), qr/^param w = 2\/5 in 0\.\.1$/m,
    'a param that is set gets its value');

# Random masks with N = 3: columns of T_÷ sum to 1, so coefficients of each residue do.
for my $seed (1 .. 6) {
    srand $seed;
    my $n = 2 + $seed % 3;
    my $length = ($n - 1) * (2 + $seed % 2) + 1 + $seed % ($n - 1 || 1);
    my @c = map { Math::BigRat->new(int(rand 41) - 20) / 16 } 1 .. $length;
    for my $residue (0 .. $n - 1) {
        my @places = grep { $_ % $n == $residue } 0 .. $#c;
        my $sum = Math::BigRat->new(0);
        $sum += $c[$_] for @places[ 1 .. $#places ];
        $c[ $places[0] ] = 1 - $sum;
    }
    my $row = join ' ', map { "$_" } @c;
    my $file = scratch(undef, "automaton random\nedge e { mask $n [ $row ] }\n");
    my $maps = rewritten($file, 'maps');
    my $again = rewritten($maps, 'mask');
    my ($found) = file_text($again) =~ /mask $n \[ (.*?) \]/;
    my @found = map { Math::BigRat->new($_) } split ' ', $found // '';
    pop @found while @found && $found[-1]->is_zero;
    pop @c while $c[-1]->is_zero;
    is("@found", "@c", "seed $seed: mask $n [ $row ] through maps and back");
}

# Rules have no texts to copy: numbers, for the params' values, and a note.
my $rules = scratch(undef, <<'END');
automaton rules
param a = 1/3
edge arc 3 {
  refine 2 {
    q[0] = (1-a)*p[0] + a*p[1]
    q[1] = a*p[0] + (1-a)*p[1]
    q[2] = (1-a)*p[1] + a*p[2]
    q[3] = a*p[1] + (1-a)*p[2]
  }
}
figure f { open arc points [ 0 0; 1 2; 2 0 ] }
END
my $numbers = rewritten($rules, 'maps');
like(file_text($numbers), qr/^# The entries are for a = 1\/3\.$/m, 'rules: a note says for which values');
like(file_text($numbers), qr/sub arc \[ 2\/3 1\/3 0\s+1\/3 2\/3 2\/3\s+0 +0 +1\/3 \]/, 'exact fractions');
{
    # 1-1/3 is rounded once more than 2/3.
    my @found = map { @$_ } points_of(limit_points($numbers));
    my @expected = map { @$_ } points_of(limit_points($rules));
    is(scalar(grep { abs($found[$_] - $expected[$_]) > 1e-14 } 0 .. $#expected), 0, 'and the same points');
}

for (
    [ 'dragon',           'refinement', qr/'forward' cannot be written as a refinement matrix: its children are in other states/ ],
    [ 'nonuniform-quadratic', 'mask', qr/cannot be written as a mask: its children are in other states/ ],
    [ 'takagi',           'mask', qr/its step is 2; a mask has step 1/ ],
    [ 'five-points',      'mask', qr/its step is 2/ ],
    [ 'sierpinski-carpet', 'mask', qr/no edge/ ],
    )
{
    my ($name, $level, $reason) = @$_;
    my ($status, $out, $err) = bcifs([ 'describe', gallery($name), '--as', $level ]);
    is($status, 1, "$name as $level: the answer is no");
    like($err, $reason, 'and why');
    is($out, '', 'nothing is printed');
}
my $crooked = scratch(undef, <<'END');
automaton crooked
vertex v 1 { }
edge e 3 { start v at 1
  end v at 2
  sub e [ 0 0 0; 1/2 1 1/2; 1/2 0 1/2 ]
  sub e [ 0 0 0; 1/2 1/2 0; 1/2 1/2 1 ] }
END
{
    my ($status, $out, $err) = bcifs([ 'describe', $crooked, '--as', 'refinement' ]);
    is($status, 1, 'boundaries elsewhere: the answer is no');
    like($err, qr/the start of 'e' is not at its first control points/, 'and why');
}

# ---- MatrixMarket ----------------------------------------------------------------------------------------------

# Reads the format: rows, columns and { "row column" => value }, from 1.
sub market_read {
    my ($text) = @_;
    my @lines = split /\n/, $text;
    like(shift @lines, qr/^%%MatrixMarket matrix coordinate real general$/, 'MatrixMarket: the banner');
    shift @lines while @lines && $lines[0] =~ /^%/;
    my ($rows, $columns, $count) = split ' ', shift @lines;
    is(scalar @lines, $count, 'MatrixMarket: as many entries as it says');
    my %entries = map { my ($i, $j, $value) = split; ("$i $j" => $value) } @lines;
    is(scalar keys %entries, $count, 'MatrixMarket: no entry twice');
    return ($rows, $columns, \%entries);
}

sub figure_points {
    my ($file, $figure) = @_;
    my $text = file_text($file);
    my ($matrix) = $text =~ /^figure \Q$figure\E \{.*?points \[(.*?)\]/ms;
    return map { [ map { s/sqrt\((\d+)\)/sqrt $1/e; m{^(-?[\d.]+)/([\d.]+)$} ? $1 / $2 : $_ } split ] }
        grep { /\S/ } split /[\n;]/, $matrix;
}

sub market_check {
    my ($file, $figure, $depth, @options) = @_;
    my $what = "$figure of $file, depth $depth";
    my ($status, $out, $err) =
        bcifs([ 'describe', $file, '--figure', $figure, '--depth', $depth, '--format', 'mtx', @options ]);
    is($status, 0, "$what: written") or diag($err);
    my ($rows, $columns, $entries) = market_read($out);
    my @points = figure_points($file, $figure);
    is($rows, scalar @points, "$what: a row for every control point");
    my (@sums, @images);
    while (my ($place, $value) = each %$entries) {
        my ($i, $j) = split ' ', $place;
        $sums[ $j - 1 ] += $value;
        $images[ $j - 1 ][$_] += $value * $points[ $i - 1 ][$_] for 0 .. $#{ $points[0] };
    }
    is(scalar(grep { abs(($_ // 0) - 1) > 1e-13 } @sums), 0, "$what: columns sum to 1");
    my ($evaluated, $csv) = bcifs([ 'eval', $file, '--figure', $figure, '--depth', $depth, '--show', 'control', @options ]);
    my @found = points_of(join "\n", grep { length } split /\n/, $csv);
    is($columns, scalar @found, "$what: a column for every control point of the level");
    my $largest = 0;
    for my $j (0 .. $#found) {
        for my $c (0 .. $#{ $found[$j] }) {
            my $difference = abs($found[$j][$c] - ($images[$j][$c] // 0));
            $largest = $difference if $difference > $largest;
        }
    }
    cmp_ok($largest, '<', 1e-11, "$what: the figure's points times it are eval --show control");
}

market_check(gallery('chaikin'), 'square', $_) for 0, 1, 3;
market_check(gallery('bspline-cubic'), 'two_arcs', 3);
market_check(gallery('bezier-cubic'), 'flower', 2); # every piece has one control point twice
market_check(gallery('koch'), 'bent', 2);
market_check(gallery('four-point'), 'arch', 2);
market_check(gallery('nonuniform-quadratic'), 'crest', 3);
market_check(gallery('dragon'), 'four', 4);
market_check(gallery('spiral'), 'lace', 2);
market_check(gallery('two-motifs'), 'two_motifs', 2);
market_check(gallery('cantor'), 'rays', 2);
market_check(gallery('takagi'), 'cloud', 2, '--set', 'w=1/3');

# The B-spline of degree 19 has 20 control points, more than are evaluated together.
sub binomials {
    my ($n) = @_;
    my @row = (Math::BigInt->new(1));
    push @row, $row[-1] * ($n - $#row) / @row while @row <= $n;
    return @row;
}
my $wide = join ' ', map { "$_/524288" } binomials(20);
my $spline = scratch('wide.bcifs', "automaton wide\nedge e { mask 2 [ $wide ] }\nfigure f {\n  open e\n  points [ "
        . join('; ', map { "$_ " . ($_ * $_ % 7) } 0 .. 21) . " ]\n}\n");
market_check($spline, 'f', 2);

# ---- Pictures --------------------------------------------------------------------------------------------------

# The boxes of all words of an SVG, by what a monospaced face takes.
sub word_boxes {
    my ($svg) = @_;
    my @boxes;
    while ($svg =~ /<text class="(\w+)[^"]*"(?: style="[^"]*")? x="(-?\d+)" y="(-?\d+)">([^<]*)</g) {
        my ($class, $x, $y, $text) = ($1, $2, $3, $4);
        my $width = length($text) * ($class eq 'name' ? 9 : $class eq 'title' ? 9.6 : 7.8);
        my $left = $class eq 'name' || ($class eq 'points' && $text =~ /^\d|vary/) ? $x - $width / 2 : $x;
        push @boxes, [ $left, $y - 11, $left + $width, $y + 3, $text ];
    }
    return @boxes;
}

my $product = scratch('product.bcifs', <<"END");
automaton product "A product and a face with a vertex for boundary"
use "$ROOT/automata/chaikin.bcifs" as c
use "$ROOT/automata/nonuniform-quadratic.bcifs" as n
face patch = c.arc * n.uniform
vertex v 1 { }
face tri 3 {
  boundary corner = v at 0
  sub tri [ 1 1/2 1/2; 0 1/2 0; 0 0 1/2 ]
  sub tri [ 1/2 0 0; 1/2 1 1/2; 0 0 1/2 ]
  sub tri [ 1/2 0 0; 0 1/2 0; 1/2 1/2 1 ]
}
END
for my $file ($product, sort glob "$ROOT/automata/*.bcifs") {
    my ($status, $out, $err) = bcifs([ 'describe', $file, '--format', 'svg' ]);
    is($status, 0, "$file drawn") or diag($err);
    my $svg = decode_utf8($out);
    my ($width, $height) = $svg =~ /<svg [^>]*width="(\d+)" height="(\d+)"/;
    my @boxes = word_boxes($svg);
    cmp_ok(scalar @boxes, '>=', 3, "$file: it has words");
    is_deeply([ map { $_->[4] } grep { $_->[0] < 0 || $_->[2] > $width || $_->[3] > $height } @boxes ],
        [], "$file: they are on the paper");
    my @meeting;
    for my $i (0 .. $#boxes) {
        for my $j (0 .. $i - 1) {
            my ($one, $other) = @boxes[ $i, $j ];
            push @meeting, "$one->[4] / $other->[4]"
                if $one->[0] < $other->[2] && $other->[0] < $one->[2] && $one->[1] < $other->[3] && $other->[1] < $one->[3];
        }
    }
    is_deeply(\@meeting, [], "$file: no two of them meet");
}
{
    my ($status, $out) = bcifs([ 'describe', gallery('nonuniform-quadratic'), '--format', 'dot' ]);
    is($status, 0, 'dot is written');
    my $dot = decode_utf8($out);
    like($dot, qr/^digraph "nonuniform_quadratic" \{$/m, 'a digraph');
    my %nodes = $dot =~ /^  (n\d+) \[label="([\w,()]+): /mg;
    my %name = map { ($nodes{$_} => $_) } keys %nodes;
    ok($dot =~ /^  $name{'p(u,v,w)'} -> $name{'left(u,v)'} \[label="T0"\];$/m, 'its first map');
    ok($dot =~ /^  $name{'p(u,v,w)'} -> $name{'k(u,v)'} \[label="start, end", style=dashed\];$/m, 'its boundaries');
    is(scalar(() = $dot =~ /->/g), 7 + 2 + 6, 'seven arrows of maps of edges, two of vertices, six of boundaries');
}

# ---- Options and limits ----------------------------------------------------------------------------------------

for (
    [ [ gallery('chaikin'), '--as', 'wavelets' ],           2, qr/expected maps, refinement or mask/ ],
    [ [ gallery('chaikin'), '--state', 'ark' ],             2, qr/no state 'ark'; did you mean 'arc'\?/ ],
    [ [ gallery('chaikin'), '--state', 'joint' ],           2, qr/is a vertex/ ],
    [ [ gallery('chaikin'), '--depth', 40 ],                2, qr/more than 1048576 entries/ ],
    [ [ gallery('chaikin'), '--figure', 'square' ],         2, qr/-o x\.mtx/ ],
    [ [ gallery('chaikin'), '--format', 'gif' ],            2, qr/expected text, json, mtx, dot or svg/ ],
    [ [ gallery('chaikin'), '--depth', 4097, '--format', 'mtx' ], 2, qr/depth must be at most 4096/ ],
    )
{
    my ($words, $expected, $message) = @$_;
    my ($status, $out, $err) = bcifs([ 'describe', @$words ]);
    is($status, $expected, "describe @$words[1 .. $#$words]: exit status");
    like($err, $message, 'its message');
}
my $open = scratch(undef, "automaton open\nvertex v 1 { }\nedge e 2 { start v at 0\n end v at 1\n sub e [ 1 ?; 0 ? ]\n sub e [ ? 0; ? 1 ] }\n");
is((bcifs([ 'describe', $open ]))[0], 2, 'unknown entries are refused');
is((bcifs([ 'describe', $open, '--format', 'svg' ]))[0], 0, 'but the automaton can be drawn');
{
    my ($status, $out) = bcifs([ 'describe', gallery('chaikin') ]);
    my $text = decode_utf8($out);
    like($text, qr/N = 2 subdivisions, step Δ = 1, joints of m_s = 2 control points/, 'text: the class');
    like($text, qr/\[ 3\/4 1\/4 0 +0 +\]\n +\[ 1\/4 3\/4 3\/4 1\/4 \]/, 'text: the matrix in fractions');
}

done_testing;
