#!/usr/bin/env perl
# Pictures read back: an .svg by a small XML scanner, a .png by checksums and an inflater that are not the
# writer's. What is drawn is compared with the points that .f64 gives for the same options.
use strict;
use warnings;
use Compress::Zlib qw(uncompress);
use FindBin;
use lib "$FindBin::Bin/lib";
use List::Util qw(max min);
use Test::More;
use Eval;

my %entities = (lt => '<', gt => '>', amp => '&', quot => '"', apos => "'", '#13' => "\r");

# Elements of an XML document in order, with attributes and the text directly inside; dies where it is not well
# formed (XML 1.0, 2.1: one root, matching tags, quoted attributes that differ, only known references).
sub xml_elements
{
    my ($text) = @_;
    my (@elements, @open);
    my $unescape = sub {
        my ($raw) = @_;
        die "stray < in '$raw'\n" if $raw =~ /</;
        $raw =~ s/&([^;\s]*;?)/my $name = $1; $name =~ s!;$!! or die "stray &\n"; $entities{$name} \/\/ die "reference $name\n"/ge;
        return $raw;
    };
    die "control characters\n" if $text =~ /[\x00-\x08\x0b\x0c\x0e-\x1f]/;
    utf8::decode(my $copy = $text) or die "not UTF-8\n";
    $text =~ s/^<\?xml version="1\.0" encoding="UTF-8"\?>\n// or die "no declaration\n";
    while ($text =~ /\G([^<]*)(?:<(!--.*?--|[^>]*)>|\z)/gs) {
        my ($before, $tag) = ($1, $2);
        if (@open) {
            $open[-1]{text} .= $unescape->($before);
        } elsif ($before =~ /\S/) {
            die "text outside the root\n";
        }
        last unless defined $tag;
        next if $tag =~ /^!--/ && $tag !~ /^!--.*--.*--$/s;
        if ($tag =~ s!^/!!) {
            my $last = pop @open or die "</$tag> closes nothing\n";
            die "</$tag> closes <$last->{name}>\n" if $last->{name} ne $tag;
            next;
        }
        my $empty = $tag =~ s!/$!!;
        $tag =~ s/^([A-Za-z][\w:.-]*)// or die "no name in <$tag>\n";
        my $element = { name => $1, text => '', attributes => {}, depth => scalar @open };
        while ($tag =~ s/^\s+([A-Za-z][\w:.-]*)="([^"]*)"//) {
            die "attribute $1 twice\n" if exists $element->{attributes}{$1};
            $element->{attributes}{$1} = $unescape->($2);
        }
        die "rest of a tag: '$tag'\n" if $tag =~ /\S/;
        die "two roots\n" if @elements && !@open;
        push @elements, $element;
        push @open, $element unless $empty;
    }
    die "<$open[-1]{name}> is not closed\n" if @open;
    return @elements;
}

# Subpaths of path data M x y L x y … Z, h0: lists of points with a flag for Z.
sub subpaths
{
    my ($data) = @_;
    my @paths;
    my $number = qr/-?\d+(?:\.\d+)?/;
    while ($data =~ /\G\s*(?:([ML])($number) ($number)|(h)($number)|(Z))/gc) {
        if (defined $1) {
            push @paths, { points => [] } if $1 eq 'M';
            push @{ $paths[-1]{points} }, [ $2, $3 ];
        } elsif (defined $4) {
            $paths[-1]{stroke} = $5;
        } else {
            $paths[-1]{closed} = 1;
        }
    }
    $data =~ /\G\s*$/ or die 'path data: ' . substr $data, pos $data // 0, 30;
    return @paths;
}

# The picture of some options, taken apart.
sub picture
{
    my (@options) = @_;
    my ($status, $text, $err) = run('eval', @options, '--format', 'svg');
    if ($status != 0) {
        diag("eval @options: exit $status: $err");
        return;
    }
    my @elements = eval { xml_elements($text) };
    if ($@) {
        diag("eval @options: not well formed: $@");
        return;
    }
    my %named;
    push @{ $named{ $_->{name} } }, $_ for @elements;
    my $picture = {
        text => $text,
        named => \%named,
        transform => $named{'bcifs:transform'}[0]{attributes},
        root => $named{svg}[0]{attributes} };
    for my $path (@{ $named{path} }) {
        push @{ $picture->{ $path->{attributes}{class} } }, [ subpaths($path->{attributes}{d}) ];
    }
    return $picture;
}

# Where a point of the plane is drawn, as the file itself says.
sub drawn
{
    my ($picture, $point) = @_;
    my $t = $picture->{transform};
    return [ $t->{left} + $t->{'scale-u'} * ($point->[0] - $t->{u0}), $t->{bottom} - $t->{'scale-v'} * ($point->[1] - $t->{v0}) ];
}

# Whether a subpath holds the points in order, within half a step of the grid; points that fall on the same place
# as the one before are left out.
sub holds
{
    my ($picture, $subpath, $points, $grid) = @_;
    my @left = @{ $subpath->{points} };
    my ($last, $current) = (undef, shift @left);
    for my $point (@$points) {
        my $place = drawn($picture, $point);
        my $near = sub { $_[0] && max(abs($_[0][0] - $place->[0]), abs($_[0][1] - $place->[1])) <= 0.5001 * $grid };
        if (!defined $last) {
            return 0 unless $near->($current);
            $last = $current;
        } elsif ($near->($left[0]) && !$near->($last)) {
            $last = shift @left;
        } elsif (!$near->($last)) {
            return 0 unless $near->($left[0]);
            $last = shift @left;
        }
    }
    return !@left;
}

sub inside
{
    my ($picture) = @_;
    my ($x, $y, $width, $height) = split ' ', $picture->{root}{viewBox};
    return 0 if $x != 0 || $y != 0 || $width != $picture->{root}{width} || $height != $picture->{root}{height};
    for my $point (map { @{ $_->{points} } } map { @$_ } map { @{ $picture->{$_} // [] } } qw(curve polygon level points)) {
        return 0 unless 0 <= $point->[0] && $point->[0] <= $width && 0 <= $point->[1] && $point->[1] <= $height;
    }
    return 1;
}

# ---- Vector pictures -----------------------------------------------------------------------------------------

sub test_curves
{
    for my $case (
        [ 'chaikin', 'square', 7, 1 ], [ 'koch', 'snowflake', 5, 1 ], [ 'koch', 'bent', 4, 0 ], [ 'hilbert', 'square', 5, 0 ],
        [ 'five-points', 'arch', 6, 0 ], [ 'dragon', 'twindragon', 9, 1 ], [ 'takagi', 'curve', 10, 0 ]) {
        my ($name, $figure, $depth, $closed) = @$case;
        my @options = (gallery($name), '--figure', $figure, '--depth', $depth);
        my $points = points(2, @options);
        for my $width (100, 1000, 12000) {
            my $grid = $width <= 100 ? 0.001 : $width <= 10000 ? 0.01 : 0.1;
            my $picture = picture(@options, '--width', $width) or fail("$name: a picture"), next;
            my @paths = @{ $picture->{curve}[0] };
            ok(@paths == 1 && !!$paths[0]{closed} == !!$closed, "$name $figure, $width wide: one " . ($closed ? 'closed' : 'open') . ' path');
            ok(holds($picture, $paths[0], $points, $grid), "$name $figure, $width wide: coordinates map back to $grid");
            is($picture->{root}{width}, $width, "$name $figure: the width asked for");
            ok(inside($picture), "$name $figure, $width wide: fits the view box");
            is($picture->{transform}{'scale-u'}, $picture->{transform}{'scale-v'}, "$name $figure: one scale for both directions");
        }
    }
}

sub test_chains
{
    my @options = (gallery('dragon'), '--figure', 'four', '--depth', 6);
    my $picture = picture(@options);
    my $chains = chains(@options);
    my @paths = @{ $picture->{curve}[0] };
    is(scalar @paths, 4, 'four chains, four subpaths');
    my $good = 1;
    $good &&= holds($picture, $paths[$_], $chains->[$_], 0.01) && !$paths[$_]{closed} for 0 .. 3;
    ok($good, 'each in its place, open');
}

sub test_words
{
    my $automaton = spit(scratch("a b'<c>&.bcifs"), slurp(gallery('takagi')) =~ s/"The Takagi family"/"Takagi & <friends>, 'w'"/r);
    my @options = ('eval', $automaton, '--set', 'w=(1 / 4)', '--depth', 5, '--figure', 'cloud', '--format', 'svg');
    my (undef, $text) = run(@options);
    my @elements = eval { xml_elements($text) };
    is($@, '', 'special characters are escaped');
    my %named = map { $_->{name} => $_ } reverse @elements;
    like($named{title}{text}, qr/^Takagi & <friends>, 'w'.*cloud/, 'the title');
    like($named{desc}{text}, qr/closed .*160 points.*x from .* to .*y from .* to/, 'the description counts the points');
    is($elements[0]{name}, 'svg', 'the root is svg');
    is($elements[0]{attributes}{xmlns}, 'http://www.w3.org/2000/svg', 'in its name space');
    ok($named{metadata}, 'metadata');
    is_same($named{'bcifs:automaton'}{text}, slurp($automaton), "the automaton's text, byte for byte");
    # The command line can be typed again: a shell gives the same words.
    my $command = $named{'bcifs:command'}{text};
    my $words = `set -- $command; for word; do printf '%s\\n' "\$word"; done`;
    is($words, join('', map { "$_\n" } 'bcifs', @options), 'the command line, quoted for a shell');
}

sub test_layers
{
    my @options = (gallery('five-points'), '--figure', 'arch', '--depth', 6);
    my $plain = picture(@options);
    ok(!$plain->{polygon} && !$plain->{level}, 'no polygon or levels unless asked for');
    my $picture = picture(@options, '--polygon', '--levels', '2,0,1');
    my @control = ([ 0, 0 ], [ 2, 4 ], [ 5, 5 ], [ 8, 4 ], [ 10, 0 ]);
    ok(holds($picture, $picture->{polygon}[0][0], \@control, 0.01) && !$picture->{polygon}[0][0]{closed}, '--polygon draws the control polygon');
    is(scalar @{ $picture->{points}[0] }, 5, 'and marks its points');
    is(scalar @{ $picture->{level} }, 3, '--levels draws three levels');
    my %expected = map { $_ => points(2, @options[ 0 .. 2 ], '--depth', $_) } 0 .. 2;
    my $found = 0;
    for my $path (map { $_->[0] } @{ $picture->{level} }) {
        $found |= 1 << $_ for grep { @{ $path->{points} } == 2**$_ + 1 && holds($picture, $path, $expected{$_}, 0.01) } 0 .. 2;
    }
    is($found, 7, 'which are the points of those depths');
    ok(holds($picture, $picture->{curve}[0][0], points(2, @options), 0.01), 'with the curve as before');
    ok(inside($picture), 'and the picture has room for all of it');
    # A control polygon that reaches far beyond the curve.
    my $csv = spit(scratch('far.csv'), "0,0\n1000,0\n0,1\n0,2\n");
    $picture = picture(gallery('chaikin'), '--points', $csv, '--depth', 5, '--polygon');
    ok(inside($picture), 'even where the polygon reaches beyond the curve');
    my ($status, undef, $err) = run('eval', @options, '--polygon', '--format', 'csv');
    is($status, 2, 'layers are for pictures');
}

# Picture coordinates do not depend on scale and place of the data.
sub test_invariance
{
    srand 6;
    my @controls = random_points(7, 2);
    my $draw = sub {
        my ($map) = @_;
        my $csv = spit(scratch('moved.csv'), csv_of(map { [ map { $map->($_) } @$_ ] } @controls));
        return picture(gallery('chaikin'), '--points', $csv, '--depth', 4)->{curve}[0][0]{points};
    };
    my $plain = $draw->(sub { $_[0] });
    # Rounding may put a coordinate on the next step of the grid.
    for my $case ([ 'times 1e6', sub { 1e6 * $_[0] } ], [ 'times 1e-6', sub { 1e-6 * $_[0] } ], [ 'times 1e-200', sub { 1e-200 * $_[0] } ],
        [ 'plus 1e6', sub { $_[0] + 1e6 } ]) {
        my ($what, $map) = @$case;
        cmp_ok(farthest($draw->($map), $plain), '<', 0.0101, "the picture is the same: $what");
    }
}

sub test_cells
{
    # Cells as frames: triangles, closed, where the corners are.
    my @options = (gallery('sierpinski-triangle'), '--depth', 4, '--show', 'control');
    my $picture = picture(@options);
    my $corners = points(2, @options);
    my $good = @{ $picture->{curve}[0] } == 81;
    for my $k (0 .. 80) {
        my $path = $picture->{curve}[0][$k];
        my @places = map { drawn($picture, $_) } @$corners[ 3 * $k .. 3 * $k + 2 ];
        $good &&= $path->{closed} && @{ $path->{points} } == 3;
        for my $place (@places) {
            $good &&= grep { max(abs($_->[0] - $place->[0]), abs($_->[1] - $place->[1])) <= 0.00501 } @{ $path->{points} };
        }
    }
    ok($good, 'control frames are closed polygons');
    # Loose points: every point has a dot within a quarter pixel, every dot a point.
    $picture = picture(gallery('fern'), '--depth', 6);
    my @places = map { drawn($picture, $_) } @{ points(2, gallery('fern'), '--depth', 6) };
    my %dots;
    for my $dot (@{ $picture->{curve}[0] }) {
        my ($x, $y) = @{ $dot->{points}[0] };
        my $end = $x + ($dot->{stroke} // 0);
        for (; $x <= $end + 0.001; $x += 0.25) { $dots{ int($x * 4 + 0.5) . ',' . int($y * 4 + 0.5) } = 0 }
    }
    my $missing = 0;
    for my $place (@places) {
        my ($column, $row) = map { int($_ * 4 + 0.5) } @$place;
        my ($near) = grep { exists $dots{$_} } map { my $r = $_; map { ($column + $_) . ',' . ($row + $r) } 0, -1, 1 } 0, -1, 1;
        if (defined $near) { $dots{$near}++ } else { $missing++ }
    }
    is($missing, 0, "the fern's points are all drawn");
    cmp_ok(scalar(grep { !$_ } values %dots), '<', 0.02 * keys %dots, 'and hardly anything else');
    ok(inside($picture), 'inside the picture');
}

# One coordinate is drawn as a graph, three in axonometry.
sub test_other_dimensions
{
    my $csv = spit(scratch('1.csv'), csv_of(random_points(5, 1)));
    my $picture = picture(gallery('chaikin'), '--points', $csv, '--depth', 5);
    my $x = $picture->{curve}[0][0]{points};
    is_deeply([ map { $_->[0] } @$x ], [ sort { $a <=> $b } map { $_->[0] } @$x ], 'a graph runs from left to right');
    ok($x->[0][1] == $x->[-1][1] && @$x == 161, 'and a closed one comes back to its first value');
    $csv = spit(scratch('3.csv'), csv_of(random_points(5, 3)));
    my @options = (gallery('chaikin'), '--points', $csv, '--depth', 5);
    $picture = picture(@options);
    # The projection that the file states: u = (x + y)√3/4, v = z/2 + (y - x)/4.
    is($picture->{transform}{u}, '(x + y)*sqrt(3)/4', 'the projection is stated');
    is($picture->{transform}{v}, 'z/2 + (y - x)/4', 'in both coordinates');
    my @flat = map { [ ($_->[0] + $_->[1]) * sqrt(3) / 4, $_->[2] / 2 + ($_->[1] - $_->[0]) / 4 ] } @{ points(3, @options) };
    ok(holds($picture, $picture->{curve}[0][0], \@flat, 0.01), 'and is what is drawn');
    for my $dimension (4, 16) {
        my $more = spit(scratch('n.csv'), csv_of(random_points(5, $dimension)));
        my ($status, undef, $err) = run('eval', gallery('chaikin'), '--points', $more, '--format', 'svg');
        ok($status == 2 && $err =~ /$dimension/, "$dimension coordinates cannot be drawn");
    }
}

# ---- Pixel pictures ------------------------------------------------------------------------------------------

# CRC-32 of ISO 3309, as the PNG specification has it.
my @crc_table = map { my $c = $_; $c = $c & 1 ? 0xedb88320 ^ ($c >> 1) : $c >> 1 for 1 .. 8; $c } 0 .. 255;

sub crc
{
    my $c = 0xffffffff;
    $c = $crc_table[ ($c ^ $_) & 255 ] ^ ($c >> 8) for unpack 'C*', $_[0];
    return $c ^ 0xffffffff;
}

# A PNG taken apart: size, channels, rows of bytes, texts. Dies where it is not one.
sub png_read
{
    my ($bytes) = @_;
    my %png = (texts => []);
    substr($bytes, 0, 8) eq "\x89PNG\r\n\x1a\n" or die "signature\n";
    my ($at, $data, @kinds) = (8, '');
    while ($at < length $bytes) {
        my ($length, $kind) = unpack 'Na4', substr $bytes, $at, 8;
        my $chunk = substr $bytes, $at + 8, $length;
        length $chunk == $length or die "$kind is cut off\n";
        crc($kind . $chunk) == unpack('N', substr $bytes, $at + 8 + $length, 4) or die "checksum of $kind\n";
        push @kinds, $kind;
        if ($kind eq 'IHDR') {
            (@png{qw(width height)}, my ($bits, $color, $method, $filter, $interlace)) = unpack 'NNC5', $chunk;
            $length == 13 && $bits == 8 && ($color == 0 || $color == 2) && !$method && !$filter && !$interlace or die "IHDR\n";
            $png{channels} = $color == 0 ? 1 : 3;
        }
        $data .= $chunk if $kind eq 'IDAT';
        if ($kind eq 'iTXt') {
            my ($keyword, $flag, $compression, $language, $about, $text) = $chunk =~ /^([^\0]+)\0(.)(.)([^\0]*)\0([^\0]*)\0(.*)$/s
                or die "iTXt\n";
            ord $flag == 0 && ord $compression == 0 && length $keyword < 80 or die "iTXt $keyword\n";
            push @{ $png{texts} }, [ $keyword, $text ];
        }
        $at += 12 + $length;
    }
    $kinds[0] eq 'IHDR' && $kinds[-1] eq 'IEND' or die "order of chunks: @kinds\n";
    join(' ', @kinds) =~ /IDAT.*(iTXt|IHDR).*IDAT/ and die "IDAT is interrupted\n";
    my $raw = uncompress($data) // die "the pixels do not inflate\n";
    my $stride = $png{width} * $png{channels};
    length $raw == $png{height} * ($stride + 1) or die "there are " . length($raw) . " bytes of pixels\n";
    my $before = "\0" x $stride;
    for my $y (0 .. $png{height} - 1) {
        my $filter = ord substr $raw, $y * ($stride + 1), 1;
        my $row = substr $raw, $y * ($stride + 1) + 1, $stride;
        $row = unfilter($filter, $row, $before, $png{channels}) if $filter;
        push @{ $png{rows} }, $row;
        $before = $row;
    }
    return \%png;
}

# PNG specification, 9.2: None, Sub, Up, Average, Paeth.
sub unfilter
{
    my ($filter, $row, $before, $step) = @_;
    my @up = unpack 'C*', $before;
    my @row = unpack 'C*', $row;
    $filter <= 4 or die "filter $filter\n";
    for my $i (0 .. $#row) {
        my ($left, $corner) = $i >= $step ? ($row[ $i - $step ], $up[ $i - $step ]) : (0, 0);
        my $p = $left + $up[$i] - $corner;
        my ($a, $b, $c) = (abs($p - $left), abs($p - $up[$i]), abs($p - $corner));
        my $guess = (0, $left, $up[$i], ($left + $up[$i]) >> 1, $a <= $b && $a <= $c ? $left : $b <= $c ? $up[$i] : $corner)[$filter];
        $row[$i] = ($row[$i] + $guess) & 255;
    }
    return pack 'C*', @row;
}

# 0 black … 255 white.
sub lightness
{
    my ($png, $x, $y) = @_;
    my @channels = unpack 'C*', substr $png->{rows}[$y], int($x) * $png->{channels}, $png->{channels};
    return min(@channels);
}

sub test_png
{
    my $path = scratch('picture.png');
    my $automaton = spit(scratch("a b'c.bcifs"), slurp(gallery('chaikin')));
    for my $width (64, 500, 1000) {
        my @options = ('eval', $automaton, '--depth', 8, '--width', $width, '-o', $path);
        my ($status, undef, $err) = run(@options);
        my $png = eval { png_read(slurp($path)) };
        is("$status $err$@", '0 ', "$width wide: every chunk, checksum and pixel of a .png");
        next unless $png;
        is($png->{width}, $width, "$width wide: as asked");
        my %texts = map { @$_ } @{ $png->{texts} };
        is_same($texts{Automaton}, slurp($automaton), "$width wide: holds the automaton's text");
        my $words = `set -- $texts{Command}; for word; do printf '%s\\n' "\$word"; done`;
        is($words, join('', map { "$_\n" } 'bcifs', @options), "$width wide: holds the command line");
        like($texts{Title}, qr/^Uniform quadratic B-spline by corner cutting/, "$width wide: holds the title");
        # The vector picture of the same width says where the points are: dark there, white in the corners and
        # inside the curve.
        my $svg = picture($automaton, '--depth', 8, '--width', $width);
        is("$svg->{root}{width} $svg->{root}{height}", "$png->{width} $png->{height}", "$width wide: as high as the .svg");
        my @dark = map { lightness($png, $_->[0] - 0.01, $_->[1] - 0.01) } @{ $svg->{curve}[0][0]{points} };
        cmp_ok(max(@dark), '<', 200, "$width wide: the curve is where the .svg has it");
        ok(!(grep { lightness($png, @$_) != 255 } [ 0, 0 ], [ $width - 1, 0 ], [ 0, $png->{height} - 1 ], [ $width / 2, $png->{height} / 2 ]),
            "$width wide: paper elsewhere");
    }
    # Gallery figures of every kind.
    for my $case ([ 'koch', '--depth', 5, '--polygon', '--levels', '0,1,2' ], [ 'fern' ], [ 'sierpinski-triangle', '--show', 'control', '--depth', 5 ],
        [ 'takagi', '--set', 'w=0.6', '--depth', 12 ], [ 'cantor' ]) {
        my ($name, @options) = @$case;
        run('eval', gallery($name), @options, '--width', 300, '-o', $path);
        my $png = eval { png_read(slurp($path)) };
        is($@, '', "$name: a .png");
        my $ink = grep { /[^\xff]/ } @{ $png->{rows} };
        cmp_ok($ink, '>', $name eq 'cantor' ? 50 : 30, "$name: something is drawn");
    }
}

test_curves();
test_chains();
test_words();
test_layers();
test_invariance();
test_cells();
test_other_dimensions();
test_png();
done_testing();
