#!/usr/bin/env perl
# Points of curves and attractors, held against what mathematics says they are: B-splines by Cox and de Boor's
# recursion, Bézier arcs by Bernstein's polynomials, classical fractals by complex numbers, schemes by running
# their own rule on the polygon. None of the expected values is computed with an automaton's maps, except where
# a product of refinement matrices is the definition ([IM] 5.1); those matrices are written out here from the
# sources.
#
# [SI] is Morin and Gentil, "Subdivision et IFS" (2010); [IM] Tosan et al., "Modélisation itérative de courbes et
# surfaces : aspect multirésolution".
use strict;
use warnings;
use FindBin;
use lib "$FindBin::Bin/lib";
use List::Util qw(max min sum);
use Math::BigInt;
use Math::BigRat;
use Test::More;
use Eval;

# Limit points are sums of a handful of products per level or table; 1e-13 is what the project promises.
my $promised = 1e-13;

# ---- Figures -------------------------------------------------------------------------------------------------

# A gallery automaton with one more figure, `extra`, on the given points.
sub with_figure
{
    my ($name, $body, @controls) = @_;
    my $rows = join '; ', map { join ' ', map { sprintf '%.17g', $_ } @$_ } @controls;
    return gallery($name, "figure extra {\n  $body\n  points [ $rows ]\n}");
}

# The file of a scheme; `ring` is a closed non-uniform spline of eight pieces, its figure called extra.
my $ring;
sub automaton_of
{
    my ($name) = @_;
    return gallery($name) if $name ne 'ring';
    srand 8;
    return $ring //= with_figure('nonuniform-quadratic', 'closed p intervals [ 1 1/8 1 1/8 1 1 1 1 ]', random_points(8, 2));
}

# The control points of piece i, step Δ, m of them, wrapping.
sub piece_controls
{
    my ($controls, $i, $step, $m) = @_;
    return [ map { $controls->[ ($i * $step + $_) % @$controls ] } 0 .. $m - 1 ];
}

# Points of a curve at the parameters k/count of every piece, piece by piece; the end as well if it is open.
sub along
{
    my ($pieces, $count, $closed, $point) = @_;
    my @points;
    for my $i (0 .. $pieces - 1) {
        push @points, $point->($i, $_ / $count) for 0 .. $count - 1;
    }
    push @points, $point->($pieces - 1, 1) unless $closed;
    return \@points;
}

# The uniform B-spline whose piece i has control points i … i + degree.
sub uniform_spline
{
    my ($degree, $controls, $closed, $count) = @_;
    my $pieces = $closed ? @$controls : @$controls - $degree;
    my @knots = (-$degree .. $degree + 1);
    return along($pieces, $count, $closed,
        sub { bspline($degree, \@knots, piece_controls($controls, $_[0], 1, $degree + 1), $_[1]) });
}

# ---- Splines -------------------------------------------------------------------------------------------------

sub test_chaikin
{
    my $good = 1;
    for my $seed (1 .. effort(4)) {
        srand $seed;
        my @controls = random_points(3 + $seed, 2);
        for my $closed (0, 1) {
            my $file = with_figure('chaikin', $closed ? 'closed arc' : 'open arc', @controls);
            for my $depth (0, 1, 2, 5, 8) {
                my $found = points(2, $file, '--figure', 'extra', '--depth', $depth);
                $good &&= agree($found, uniform_spline(2, \@controls, $closed, 2**$depth), $promised,
                    "seed $seed, closed $closed, depth $depth");
            }
        }
    }
    ok($good, "Chaikin's limit is the uniform quadratic B-spline, open and closed");
    test_deep(gallery('chaikin'), 4, 2, [ [ 0, 0 ], [ 2, 0 ], [ 2, 2 ], [ 0, 2 ] ], 2);
}

# Depth 20: points picked out of the whole.
sub test_deep
{
    my ($file, $pieces, $degree, $controls, $dimension) = @_;
    my $raw = scratch('deep.f64');
    my ($status) = run('eval', $file, '--depth', 20, '-o', $raw);
    is($status, 0, 'depth 20 is written');
    is(-s $raw, $pieces * 2**20 * $dimension * 8, 'depth 20: 4 pieces of 2^20 points');
    open my $handle, '<:raw', $raw or die;
    srand 20;
    my (@found, @expected);
    my @knots = (-$degree .. $degree + 1);
    for (1 .. effort(1500)) {
        my $index = int(rand $pieces * 2**20);
        seek $handle, $index * $dimension * 8, 0;
        read $handle, my $bytes, $dimension * 8;
        push @found, [ unpack 'd<*', $bytes ];
        my $i = $index >> 20;
        push @expected,
            bspline($degree, \@knots, piece_controls($controls, $i, 1, $degree + 1), ($index & (2**20 - 1)) / 2**20);
    }
    close $handle;
    unlink $raw;
    ok(agree(\@found, \@expected, $promised, 'depth 20'), 'depth 20: points are where Cox and de Boor have them');
}

# The mask of the uniform B-spline of a degree with N subdivisions: N((1 + z + … + z^(N-1))/N)^(degree + 1), as
# integers over N^degree (Lane and Riesenfeld).
sub spline_mask
{
    my ($degree, $n) = @_;
    my @mask = (1);
    for (0 .. $degree) {
        my @next = (0) x (@mask + $n - 1);
        for my $k (0 .. $#mask) {
            $next[ $k + $_ ] += $mask[$k] for 0 .. $n - 1;
        }
        @mask = @next;
    }
    return map { "$_/" . $n**$degree } @mask;
}

sub test_masks
{
    my $good = 1;
    for my $n (2 .. 5) {
        for my $degree (1 .. 6) {
            srand 10 * $n + $degree;
            my @controls = random_points(2 * $degree + 2, 2);
            my $closed = ($n + $degree) % 2;
            my $rows = join '; ', map { "@$_" } @controls;
            my $kind = $closed ? 'closed' : 'open';
            my $file = spit(scratch('mask.bcifs'),
                      "automaton mask\nedge arc { mask $n [ @{[ spline_mask($degree, $n) ]} ] }\n"
                    . "figure f { $kind arc points [ $rows ] }\n");
            my $depth = $n == 2 ? 5 : 2;
            my $found = points(2, $file, '--depth', $depth);
            $good &&= agree($found, uniform_spline($degree, \@controls, $closed, $n**$depth), $promised,
                "degree $degree by $n, $kind");
        }
    }
    ok($good, 'masks of B-splines of degrees 1 to 6, subdivided into 2 to 5, give them');
    srand 3;
    my @controls = random_points(9, 3);
    my $file = with_figure('bspline-cubic', 'closed arc', @controls);
    ok(agree(points(3, $file, '--figure', 'extra', '--depth', 9), uniform_spline(3, \@controls, 1, 2**9), $promised,
            'cubic'),
        'the cubic mask of the gallery is the cubic B-spline, in space');
}

sub test_bezier
{
    my $good = 1;
    for my $degree (2, 3) {
        my $name = $degree == 2 ? 'bezier-quadratic' : 'bezier-cubic';
        for my $seed (1 .. effort(3)) {
            srand 100 * $degree + $seed;
            for my $closed (0, 1) {
                my $pieces = 1 + $seed + $closed;
                my @controls = random_points($degree * $pieces + 1 - $closed, 2);
                my $file = with_figure($name, $closed ? 'closed arc' : 'open arc', @controls);
                for my $depth (0, 3, 8) {
                    my $expected = along($pieces, 2**$depth, $closed,
                        sub { bezier(piece_controls(\@controls, $_[0], $degree, $degree + 1), $_[1]) });
                    my $found = points(2, $file, '--figure', 'extra', '--depth', $depth);
                    $good &&= agree($found, $expected, $promised, "degree $degree, seed $seed, closed $closed");
                }
            }
        }
    }
    ok($good, "Bézier arcs are Bernstein's, quadratic and cubic, open and closed");
    # The circle of the gallery is the draughtsman's: radius 1 to 3 parts in 10000.
    my $circle = points(2, gallery('bezier-cubic'), '--figure', 'circle', '--depth', 6);
    my $off = max(map { abs(sqrt($_->[0]**2 + $_->[1]**2) - 1) } @$circle);
    ok(@$circle == 256 && $off < 3e-4 && $off > 2e-4, "the circle is one to 3/10000 ($off)");
}

# Knots of which interval j is intervals[j], 0 being the start of interval `origin`: a short interval far from 0
# would lose its digits. The two outermost knots do not matter within the domain.
sub knots_of
{
    my ($origin, @intervals) = @_;
    my @knots = (0);
    unshift @knots, $knots[0] - $intervals[$_] for reverse 0 .. $origin - 1;
    push @knots, $knots[-1] + $intervals[$_] for $origin .. $#intervals;
    return ($knots[0] - 1, @knots, $knots[-1] + 1);
}

sub test_nonuniform
{
    my $good = 1;
    for my $seed (1 .. effort(6)) {
        srand 500 + $seed;
        for my $closed (0, 1) {
            my $pieces = 3 + int rand 5;
            # Positive intervals over five orders of magnitude, written as fractions.
            my @intervals = map { (1 + int rand 99) . '/' . (1 + int rand 9)**(1 + int rand 4) }
                1 .. ($closed ? $pieces : $pieces + 2);
            my @controls = random_points($pieces + ($closed ? 0 : 2), 2);
            my $kind = $closed ? 'closed p' : 'open p';
            my $file = with_figure('nonuniform-quadratic', "$kind intervals [ @intervals ]", @controls);
            my @lengths = map { fraction($_) } @intervals, $closed ? @intervals[ 0, 1 ] : ();
            my @extended = (@controls, $closed ? @controls[ 0, 1 ] : ());
            # Piece i lives on interval i + 1.
            my $expected = along($pieces, 64, $closed,
                sub { bspline(2, [ knots_of($_[0] + 1, @lengths) ], \@extended, $lengths[ $_[0] + 1 ] * $_[1]) });
            my $found = points(2, $file, '--figure', 'extra', '--depth', 6);
            $good &&= agree($found, $expected, $promised, "seed $seed, $kind, intervals @intervals");
        }
    }
    ok($good, 'non-uniform quadratic B-splines by Cox and de Boor, random intervals, open and closed');
    # "The curve touches side i of its polygon at the fraction u/(u+v)": the crest's joints, by [SI] (1), (2).
    my @joints = ([ 1 / 3, 4 / 3 ], [ 1 + 4 * 2 / 3, 4 + 2 / 3 ], [ 5 + 2 * 2 / 3, 5 - 4 * 2 / 3 ], [ 7 + 3 / 7, 1 - 1 / 7 ]);
    ok(agree(points(2, gallery('nonuniform-quadratic'), '--figure', 'crest', '--depth', 0), \@joints, $promised, 'crest'),
        'the joints divide the sides as the intervals do');
}

# The four-point rule, run on a polygon: every point stays, a new one stands between two.
sub four_point
{
    my ($w, $controls, $closed) = @_;
    my ($n, @next) = (scalar @$controls);
    for my $i ($closed ? (0 .. $n - 1) : (1 .. $n - 3)) {
        my @four = map { $controls->[ ($i + $_) % $n ] } -1 .. 2;
        push @next, $four[1], combine([ -$w, 0.5 + $w, 0.5 + $w, -$w ], \@four);
    }
    push @next, $controls->[ $n - 2 ] unless $closed;
    return \@next;
}

sub test_four_point
{
    my $good = 1;
    for my $w ('1/16', '0', '1/10', '3/16') {
        srand 7;
        my @controls = random_points(8, 2);
        my $polygon = \@controls;
        my $file = with_figure('four-point', 'closed arc', @controls);
        for my $depth (0 .. 6) {
            # Piece i of six points lies between its points 2 and 3.
            my @turned = @$polygon[ map { ($_ + 2 * 2**$depth) % @$polygon } 0 .. $#$polygon ];
            my $found = points(2, $file, '--figure', 'extra', '--depth', $depth, '--set', "w=$w");
            $good &&= agree($found, \@turned, $promised, "w = $w, depth $depth");
            $polygon = four_point(fraction($w), $polygon, 1);
        }
    }
    ok($good, 'the closed four-point curve goes through all points of its own rule, for several w');
    # Dubuc: w = 1/16 reproduces cubics.
    my $cubic = sub { [ $_[0], $_[0]**3 / 8 - $_[0]**2 + 3 ] };
    my $file = with_figure('four-point', 'open arc', map { $cubic->($_) } 0 .. 9);
    my $expected = along(5, 32, 0, sub { $cubic->(2 + $_[0] + $_[1]) });
    ok(agree(points(2, $file, '--figure', 'extra', '--depth', 5), $expected, $promised, 'cubic'),
        'w = 1/16 reproduces a cubic');
    # The basis function at halves and quarters, by hand from the rule: φ(1/2) = 1/2 + w, φ(3/2) = -w,
    # φ(1/4) = (1/2 + w)(φ(0) + φ(1/2)) - w(φ(-1/2) + φ(1)), here for w = 1/16.
    $file = with_figure('four-point', 'open arc', map { [ $_ == 5 ? 1 : 0 ] } 0 .. 9);
    my $found = single($file, [ map { [ '--at', $_ ] } '2.5/5', '1.5/5', '3.25/5' ], '--figure', 'extra');
    my ($half, $three) = (9 / 16, -1 / 16);
    my $quarter = 9 / 16 * (1 + $half) - 1 / 16 * $half;
    ok(agree($found, [ [$half], [$three], [$quarter] ], 1e-15, 'basis'), 'known values of the basis function');
}

# ---- Takagi and the fractals ---------------------------------------------------------------------------------

# h Σ w^n s(2^n x), s the distance to the nearest integer; x dyadic, so the sum ends.
sub takagi
{
    my ($w, $x) = @_;
    my ($sum, $weight) = (0, 1);
    while ($x != int $x) {
        $sum += $weight * abs($x - int($x + 0.5));
        $weight *= $w;
        $x *= 2;
    }
    return $sum;
}

sub test_takagi
{
    my $good = 1;
    for my $w ('0', '1/10', '1/4', '1/3', '1/2', '0.7', '9/10') {
        srand 4;
        my @controls = random_points(7, 2);
        my $file = with_figure('takagi', 'open arc', @controls);
        my $expected = along(
            3, 256, 0,
            sub {
                my ($i, $x) = @_;
                my ($start, $apex, $end) = @controls[ 2 * $i .. 2 * $i + 2 ];
                my $height = takagi(fraction($w), $x);
                return combine([ 1 - $x - $height / 2, $height, $x - $height / 2 ], [ $start, $apex, $end ]);
            }
        );
        my $found = points(2, $file, '--figure', 'extra', '--depth', 8, '--set', "w=$w");
        $good &&= agree($found, $expected, $promised, "w = $w");
    }
    ok($good, "Takagi's family is its series, for several w");
    my @bezier = map { bezier([ [ 0, 0 ], [ 0.5, 1 ], [ 1, 0 ] ], $_ / 1024) } 0 .. 1024;
    ok(agree(points(2, gallery('takagi'), '--depth', 10, '--set', 'w=1/4'), \@bezier, $promised, 'w = 1/4'),
        "w = 1/4 is Bézier's parabola");
}

sub multiply { return [ $_[0][0] * $_[1][0] - $_[0][1] * $_[1][1], $_[0][0] * $_[1][1] + $_[0][1] * $_[1][0] ] }
sub add { return [ $_[0][0] + $_[1][0], $_[0][1] + $_[1][1] ] }
# z -> az + b, and z -> a conj(z) + b.
sub similarity { my ($a, $b) = @_; return sub { add(multiply($a, $_[0]), $b) } }
sub reflection { my ($a, $b) = @_; return sub { add(multiply($a, [ $_[0][0], -$_[0][1] ]), $b) } }

my $r3 = sqrt 3;
my @koch = (
    similarity([ 1 / 3, 0 ], [ 0, 0 ]),
    similarity([ 1 / 6, $r3 / 6 ], [ 1 / 3, 0 ]),
    similarity([ 1 / 6, -$r3 / 6 ], [ 1 / 2, $r3 / 6 ]),
    similarity([ 1 / 3, 0 ], [ 2 / 3, 0 ]));
my @levy = (similarity([ 0.5, 0.5 ], [ 0, 0 ]), similarity([ 0.5, -0.5 ], [ 0.5, 0.5 ]));
my @hilbert = (
    reflection([ 0, 0.5 ], [ 0, 0 ]),
    similarity([ 0.5, 0 ], [ 0, 0.5 ]),
    similarity([ 0.5, 0 ], [ 0.5, 0.5 ]),
    reflection([ 0, -0.5 ], [ 1, 0.5 ]));

# The dragon's path on k/2^n: the first half is f0 of the path, the second f1 of the path run backwards.
sub dragon
{
    my ($k, $depth) = @_;
    return [ $k, 0 ] if $depth == 0;
    my $half = 2**($depth - 1);
    return multiply([ 0.5, 0.5 ], dragon($k, $depth - 1)) if $k <= $half;
    return add([ 1, 0 ], multiply([ -0.5, 0.5 ], dragon(2 * $half - $k, $depth - 1)));
}

sub test_fractals
{
    my $open = sub { my ($maps, $depth) = @_; return [ @{ walk_words($maps, $depth, [ 0, 0 ]) }, [ 1, 0 ] ] };
    for my $depth (0, 1, 6) {
        ok(agree(points(2, gallery('koch'), '--figure', 'curve', '--depth', $depth), $open->(\@koch, $depth), 1e-14, 'koch'),
            "von Koch's curve, depth $depth");
        ok(agree(points(2, gallery('levy'), '--figure', 'curve', '--depth', $depth), $open->(\@levy, $depth), 1e-14, 'levy'),
            "Lévy's curve, depth $depth");
        ok(agree(points(2, gallery('hilbert'), '--figure', 'square', '--depth', $depth), $open->(\@hilbert, $depth), 1e-14,
                'hilbert'),
            "Hilbert's curve, depth $depth");
        ok(agree(points(2, gallery('dragon'), '--figure', 'curve', '--depth', $depth),
                [ map { dragon($_, $depth) } 0 .. 2**$depth ], 1e-14, 'dragon'),
            "the dragon, depth $depth");
    }
    # The snowflake: three similar copies, from corner to corner of the triangle 0, e^(iπ/3), 1.
    my @snowflake;
    for my $side ([ [ 0, 0 ], [ 0.5, $r3 / 2 ] ], [ [ 0.5, $r3 / 2 ], [ 1, 0 ] ], [ [ 1, 0 ], [ 0, 0 ] ]) {
        my ($from, $to) = @$side;
        my $map = similarity([ $to->[0] - $from->[0], $to->[1] - $from->[1] ], $from);
        push @snowflake, map { $map->($_) } @{ walk_words(\@koch, 4, [ 0, 0 ]) };
    }
    ok(agree(points(2, gallery('koch'), '--figure', 'snowflake', '--depth', 4), \@snowflake, 1e-14, 'snowflake'),
        'the snowflake: 768 points, closed');
    # The twindragon is the path there, and the same turned by a half turn back.
    my @there = map { dragon($_, 8) } 0 .. 255;
    ok(agree(points(2, gallery('dragon'), '--figure', 'twindragon', '--depth', 8),
            [ @there, map { [ 1 - $_->[0], -$_->[1] ] } @there ], 1e-14, 'twindragon'),
        'the twindragon');
    # Every Hilbert cell of depth n is entered at a corner of its own square: 4^n distinct points of the grid.
    my %seen = map { sprintf('%.9f,%.9f', @$_) => 1 } @{ points(2, gallery('hilbert'), '--figure', 'square', '--depth', 6) };
    cmp_ok(scalar(keys %seen), '>', 4**6 / 4, "Hilbert's points spread over the square");
}

sub scale_about { my ($ratio, $center) = @_; return sub { combine([ $ratio, 1 - $ratio ], [ $_[0], $center ]) } }

sub test_attractors
{
    # Left ends of Cantor's intervals: Σ 2 d_i / 3^i, d the binary digits of the index.
    my @cantor = map {
        my ($k, $x) = ($_, 0);
        $x += 2 * ($k >> (10 - $_) & 1) / 3**$_ for 1 .. 10;
        [ $x, 0 ]
    } 0 .. 1023;
    ok(agree(points(2, gallery('cantor'), '--figure', 'set', '--depth', 10), \@cantor, 1e-15, 'cantor'),
        "Cantor's endpoints");
    my @dust = map { my $corner = $_; scale_about(1 / 3, $corner) } [ 0, 0 ], [ 1, 0 ], [ 0, 1 ], [ 1, 1 ];
    ok(agree(points(2, gallery('cantor'), '--depth', 5), walk_words(\@dust, 5, [ 0, 0 ]), 1e-15, 'dust'), "Cantor's dust");
    my @corners = ([ 0, 0 ], [ 1, 0 ], [ 0.5, $r3 / 2 ]);
    my @halves = map { my $corner = $_; scale_about(0.5, $corner) } @corners;
    ok(agree(points(2, gallery('sierpinski-triangle'), '--depth', 7), walk_words(\@halves, 7, $corners[0]), 1e-15, 'triangle'),
        "Sierpiński's triangle");
    my @eight = map { my $cell = $_; sub { [ ($_[0][0] + $cell->[0]) / 3, ($_[0][1] + $cell->[1]) / 3 ] } }
        [ 0, 0 ], [ 1, 0 ], [ 2, 0 ], [ 0, 1 ], [ 2, 1 ], [ 0, 2 ], [ 1, 2 ], [ 2, 2 ];
    ok(agree(points(2, gallery('sierpinski-carpet'), '--depth', 3), walk_words(\@eight, 3, [ 0, 0 ]), 1e-15, 'carpet'),
        "Sierpiński's carpet");
    # Barnsley, Fractals Everywhere, table III.3; the stalk's map fixes the origin.
    my @fern = map {
        my ($a, $b, $c, $d, $e, $f) = @$_;
        sub { [ $a * $_[0][0] + $b * $_[0][1] + $e, $c * $_[0][0] + $d * $_[0][1] + $f ] }
    } [ 0, 0, 0, 0.16, 0, 0 ], [ 0.85, 0.04, -0.04, 0.85, 0, 1.6 ], [ 0.2, -0.26, 0.23, 0.22, 0, 1.6 ],
        [ -0.15, 0.28, 0.26, 0.24, 0, 0.44 ];
    ok(agree(points(2, gallery('fern'), '--depth', 7), walk_words(\@fern, 7, [ 0, 0 ]), 1e-14, 'fern'), "Barnsley's fern");
    # Control points move the attractor affinely: the fern on a frame O, X, Y.
    my @frame = ([ 3, 1 ], [ 4, -1 ], [ 2.5, 5 ]);
    my $moved = spit(scratch('frame.csv'), csv_of(@frame));
    ok(agree(points(2, gallery('fern'), '--depth', 5, '--points', $moved),
            [ map { combine([ 1 - $_->[0] - $_->[1], @$_ ], \@frame) } @{ walk_words(\@fern, 5, [ 0, 0 ]) } ], 1e-14, 'frame'),
        'the fern moves with its frame');
}

# Addresses of Sierpiński's triangle: point w is Σ 2^-i P_(w_i) + 2^-n P_0.
sub test_addresses
{
    my @corners = ([ 0, 0 ], [ 1, 0 ], [ 0.5, $r3 / 2 ]);
    srand 11;
    my (@words, @expected);
    for (1 .. 50) {
        my @word = map { int rand 3 } 1 .. 1 + int rand 40;
        my @weights = (0, 0, 0);
        $weights[ $word[$_] ] += 2**-($_ + 1) for 0 .. $#word;
        $weights[0] += 2**-@word;
        push @words, [ '--address', '0.' . join '', @word ];
        push @expected, combine(\@weights, \@corners);
    }
    ok(agree(single(gallery('sierpinski-triangle'), \@words), \@expected, 1e-15, 'addresses'), "Sierpiński's addresses");

    # Thousands of digits. A periodic word is the fixed point of its product: t = 1/3 and 2/3 by closed forms.
    my $thirds = '01' x 5000;
    my @cases = (
        # Quadratic B-spline of the square's first side: weights (1-t)²/2, …, t²/2.
        [ 'chaikin', 'square', "0.$thirds", bezier_like_spline(1 / 3) ],
        # Takagi's height at 1/3 is 2/3 (each term is 1/3 · 2^-n).
        [ 'takagi', 'curve', "0.$thirds", [ 1 / 3, 2 / 3 ] ],
        # The dragon at 2/3 is the fixed point of 1 - (1-i)/2 z, which is (3+i)/5; 1/3 is (1+i)/2 times that.
        [ 'dragon', 'curve', "0.$thirds", [ 0.2, 0.4 ] ],
        [ 'dragon', 'curve', '0.' . '10' x 5000, [ 0.6, 0.2 ] ],
        # Hilbert at 1/3 = 0.111…(4) is the fixed point of z/2 + i/2.
        [ 'hilbert', 'square', '0.' . '1' x 9999, [ 0, 1 ] ],
        # Koch at 1/3 is the fixed point of e^(iπ/3)z/3 + 1/3: 1/(3 - e^(iπ/3)) = (5 + i√3)/14.
        [ 'koch', 'curve', '0.' . '1' x 9999, [ 5 / 14, $r3 / 14 ] ],
        # Lévy at 1 is its end.
        [ 'levy', 'curve', '0.' . '1' x 9999, [ 1, 0 ] ],
        [ 'cantor', 'set', '0.' . '10' x 5000, [ 3 / 4, 0 ] ],
        [ 'sierpinski-carpet', 'square', '0.' . '7' x 9999, [ 1, 1 ] ]);
    for my $case (@cases) {
        my ($name, $figure, $address, $expected) = @$case;
        ok(agree(single(gallery($name), [ [ '--address', $address ] ], '--figure', $figure), [$expected], 4e-15, $name),
            "$name: an address of " . length($address) . ' characters');
    }
}

# The quadratic B-spline on control points (0,0), (2,0), (2,2).
sub bezier_like_spline
{
    my ($t) = @_;
    return combine([ (1 - $t)**2 / 2, 0.5 + $t - $t**2, $t**2 / 2 ], [ [ 0, 0 ], [ 2, 0 ], [ 2, 2 ] ]);
}

# Figure 4 of [IM]: the sequence of points 0.0…01 satisfies the recurrence of T_0's characteristic polynomial,
# whose subdominant pair is written in the file's head. The factors by hand from the block triangular T_0.
sub test_spiral
{
    my @polynomials = (
        # (λ-1)(λ-3/8)(λ² - λ/2 + 21/64): the pair (2 ± i√17)/8.
        [ 'lace', polynomial_product([ 1, -1 ], [ 1, -3 / 8 ], [ 1, -1 / 2, 21 / 64 ]) ],
        # (λ-1)(λ² - 7/10 λ + 49/100) λ (λ + 2/15): 7/10 at 60 degrees.
        [ 'coil', polynomial_product([ 1, -1 ], [ 1, -7 / 10, 49 / 100 ], [ 1, 0 ], [ 1, 2 / 15 ]) ]);
    for my $case (@polynomials) {
        my ($figure, @polynomial) = @$case;
        my $points = single(gallery('spiral'), [ map { [ '--address', '0.' . '0' x $_ . '1' ] } 0 .. 30 ], '--figure', $figure);
        my ($worst, $size) = (0, span(@$points));
        for my $k (0 .. 30 - $#polynomial) {
            for my $c (0, 1) {
                my $sum = sum(map { $polynomial[$_] * $points->[ $k + $#polynomial - $_ ][$c] } 0 .. $#polynomial);
                $worst = max($worst, abs $sum);
            }
        }
        ok(@$points == 31 && $worst < 1e-14 * $size, "$figure spirals with its complex eigenvalues ($worst)");
    }
    # The coil winds by 60 degrees and shrinks to 7/10 a step, both ends of a joint together.
    my $points = single(gallery('spiral'), [ [ '--address', '0.' ], map { [ '--address', '0.' . '0' x $_ . '1' ] } 8 .. 20 ],
        '--figure', 'coil');
    my $center = shift @$points;
    my $good = @$points == 13;
    for my $k (1 .. $#$points) {
        my ($p, $q) = map { [ $points->[$_][0] - $center->[0], $points->[$_][1] - $center->[1] ] } $k - 1, $k;
        my $ratio = sqrt(($q->[0]**2 + $q->[1]**2) / ($p->[0]**2 + $p->[1]**2));
        my $turn = atan2($p->[0] * $q->[1] - $p->[1] * $q->[0], $p->[0] * $q->[0] + $p->[1] * $q->[1]);
        $good &&= abs($ratio - 0.7) < 1e-6 && abs(abs($turn) - atan2(1, 1) * 4 / 3) < 1e-6;
    }
    ok($good, 'the coil turns by 60 degrees and shrinks to 7/10 at every step');
}

sub polynomial_product
{
    my @product = (1);
    for my $factor (@_) {
        my @next = (0) x (@product + @$factor - 1);
        for my $i (0 .. $#product) {
            $next[ $i + $_ ] += $product[$i] * $factor->[$_] for 0 .. $#$factor;
        }
        @product = @next;
    }
    return @product;
}

# ---- Figures of several kinds --------------------------------------------------------------------------------

sub test_dimensions
{
    my $good = 1;
    for my $dimension (1 .. 16) {
        srand $dimension;
        my @controls = random_points(6, $dimension);
        my $csv = spit(scratch('d.csv'), csv_of(@controls));
        my $found = points($dimension, gallery('chaikin'), '--points', $csv, '--depth', 6);
        $good &&= agree($found, uniform_spline(2, \@controls, 1, 64), $promised, "$dimension coordinates");
        my $single = single(gallery('chaikin'), [ [ '--at', '5/12' ] ], '--points', $csv);
        $good &&= agree($single, [ bspline(2, [ -2 .. 3 ], piece_controls(\@controls, 2, 1, 3), 0.5) ], $promised, '--at');
    }
    ok($good, 'points of 1 to 16 coordinates');
}

# Segments of the line cut unequally: a in three, b in two, with different children. Points and parameters by
# exact fractions.
my $unequal = <<'END';
automaton unequal
vertex end 1 { }
edge a 2 {
  start end at 0
  end end at 1
  sub b [ 1 4/5
          0 1/5 ]
  sub a [ 4/5 1/2
          1/5 1/2 ]
  sub b [ 1/2 0
          1/2 1 ]
}
edge b 2 {
  start end at 0
  end end at 1
  sub a [ 1 1/3
          0 2/3 ]
  sub a [ 1/3 0
          2/3 1 ]
}
figure one { open a points [ 0; 1 ] }
figure two { piece a at 0 1 piece b at 1 2 points [ 0; 1; 5 ] }
figure ring { piece b at 0 1 piece a at 1 0 points [ 2; 3 ] }
figure apart { piece a at 0 1 piece b at 2 3 piece b at 3 0 piece a at 1 2 points [ 0; 1; 5; 9 ] }
END
my %cuts = (a => [ [ 'b', 0, '1/5' ], [ 'a', '1/5', '1/2' ], [ 'b', '1/2', 1 ] ], b => [ [ 'a', 0, '2/3' ], [ 'a', '2/3', 1 ] ]);

# Starts of the cells below a segment: [place, parameter], both exact.
sub unequal_starts
{
    my ($state, $low, $high, $from, $share, $depth) = @_;
    return [ $low, $from ] if $depth == 0;
    my $children = $cuts{$state};
    my $part = $share / @$children;
    return map {
        my ($child, $l, $h) = @{ $children->[$_] };
        unequal_starts($child, $low + ($high - $low) * Math::BigRat->new($l), $low + ($high - $low) * Math::BigRat->new($h),
            $from + $part * $_, $part, $depth - 1)
    } 0 .. $#$children;
}

sub test_unequal
{
    my $file = spit(scratch('unequal.bcifs'), $unequal);
    my $rat = sub { Math::BigRat->new(@_) };
    my $starts = sub {
        my ($depth, @pieces) = @_;
        my $share = $rat->(1) / @pieces;
        return map { unequal_starts($pieces[$_][0], $rat->($pieces[$_][1]), $rat->($pieces[$_][2]), $share * $_, $share, $depth) }
            0 .. $#pieces;
    };
    my @expected = $starts->(5, [ 'a', 0, 1 ]);
    my @points = ((map { [ $_->[0]->numify ] } @expected), [1]);
    ok(agree(points(1, $file, '--depth', 5), \@points, 1e-15, 'unequal'), 'states of two and of three children');
    my @two = $starts->(4, [ 'a', 0, 1 ], [ 'b', 1, 5 ]);
    ok(agree(points(1, $file, '--figure', 'two', '--depth', 4), [ (map { [ $_->[0]->numify ] } @two), [5] ], 1e-15, 'two'),
        'two pieces in different states');
    my @ring = $starts->(4, [ 'b', 2, 3 ], [ 'a', 3, 2 ]);
    ok(agree(points(1, $file, '--figure', 'ring', '--depth', 4), [ map { [ $_->[0]->numify ] } @ring ], 1e-15, 'ring'),
        'a ring of pieces is closed: its start is not repeated');
    # Parameters are equal shares at every level, not equal lengths.
    my $at = single($file, [ map { [ '--at', $_->[1]->bstr ] } @expected ]);
    pop @points;
    ok(agree($at, \@points, 1e-12, 'shares'), 'every child has an equal share of the parameter');
    # A range is cut where those parameters say.
    my $good = 1;
    srand 9;
    for (1 .. effort(20)) {
        my ($from, $to) = sort { $a <=> $b } map { int(rand 4096) / 4096 } 1, 2;
        my @inside = grep { $_->[1] >= $rat->($from) && $_->[1] <= $rat->($to) } @expected;
        next unless @inside;
        $good &&= agree(points(1, $file, '--depth', 5, '--range', "$from..$to"), [ map { [ $_->[0]->numify ] } @inside ], 1e-15,
            "range $from..$to");
    }
    ok($good, 'a range of unequal cells');
    # Chains: 0-1, then 5-9-0, then 1-5.
    my $chains = chains($file, '--figure', 'apart', '--depth', 2);
    is(scalar @$chains, 3, 'pieces that do not meet form chains');
    my @ends = map { [ $_->[0][0], $_->[-1][0] ] } @$chains;
    is_deeply(\@ends, [ [ 0, 1 ], [ 5, 0 ], [ 1, 5 ] ], 'each from its first point to its last');
    # a has 7 cells at depth 2 (2 + 3 + 2), b 6.
    is_deeply([ map { scalar @$_ } @$chains ], [ 8, 13, 8 ], 'each with its own end');
}

sub test_chains
{
    my $chains = chains(gallery('two-motifs'), '--figure', 'two_motifs', '--depth', 5);
    my @controls = ([ 0, 0 ], [ 1, 3 ], [ 2, 0 ], [ 4, -3 ], [ 5, 1 ], [ 6, 5 ], [ 8, 3 ], [ 9, 1 ], [ 10, 2 ]);
    my $motif = sub {
        my ($w) = @_;
        return along(4, 32, 0, sub {
            my ($i, $x) = @_;
            my $height = takagi($w, $x);
            return combine([ 1 - $x - $height / 2, $height, $x - $height / 2 ], [ @controls[ 2 * $i .. 2 * $i + 2 ] ]);
        });
    };
    is(scalar @$chains, 2, '[IM] figure 1: two chains on the same nine points');
    ok(agree($chains->[0], $motif->(1 / 4), $promised, 'bezier'), 'the first of Bézier arcs');
    ok(agree($chains->[1], $motif->(1 / 2), $promised, 'takagi'), 'the second of Takagi arcs');
    my $four = chains(gallery('dragon'), '--figure', 'four', '--depth', 3);
    my @quarter = ([ 1, 0 ]);
    push @quarter, multiply([ 0, 1 ], $quarter[-1]) for 1 .. 3;
    my @expected = map { my $turn = $_; [ map { multiply($turn, dragon($_, 3)) } 0 .. 8 ] } @quarter;
    my $good = @$four == 4;
    $good &&= agree($four->[$_], $expected[$_], 1e-15, "dragon $_") for 0 .. $#$four;
    ok($good, 'four dragons around a point: four open chains');
    my $flower = chains(gallery('bezier-cubic'), '--figure', 'flower', '--depth', 3);
    ok(@$flower == 1 && @{ $flower->[0] } == 64, 'the flower, written piece by piece, is one closed chain');
}

# What the classification of [IM] 4 says of each figure: K pieces, N maps, open or closed, or a cell.
sub test_counts
{
    my @figures = (
        [ 'chaikin', 'square', 4, 2, 'closed' ],
        [ 'bezier-cubic', 'circle', 4, 2, 'closed' ],
        [ 'bezier-cubic', 'flower', 8, 2, 'closed' ],
        [ 'bezier-cubic', 'wave', 2, 2, 'open' ],
        [ 'bezier-quadratic', 'heart', 6, 2, 'closed' ],
        [ 'bspline-cubic', 'clover', 12, 2, 'closed' ],
        [ 'bspline-cubic', 'two_arcs', 2, 2, 'open' ],
        [ 'four-point', 'star', 10, 2, 'closed' ],
        [ 'four-point', 'arch', 3, 2, 'open' ],
        [ 'five-points', 'arch', 1, 2, 'open' ],
        [ 'five-points', 'two_arcs', 2, 2, 'open' ],
        [ 'five-points', 'crown', 4, 2, 'closed' ],
        [ 'koch', 'snowflake', 3, 4, 'closed' ],
        [ 'koch', 'bent', 2, 4, 'open' ],
        [ 'hilbert', 'moore', 4, 4, 'closed' ],
        [ 'dragon', 'twindragon', 2, 2, 'closed' ],
        [ 'nonuniform-quadratic', 'crest', 3, 2, 'open' ],
        [ 'ring', 'extra', 8, 2, 'closed' ],
        [ 'spiral', 'lace', 4, 2, 'closed' ],
        [ 'spiral', 'coil', 6, 2, 'closed' ],
        [ 'fern', 'fern', 1, 4, 'cell' ],
        [ 'cantor', 'rays', 12, 2, 'cell' ],
        [ 'sierpinski-carpet', 'cube', 3, 8, 'cell' ],
        [ 'sierpinski-triangle', 'hexagon', 6, 3, 'cell' ]);
    my ($counts, $once) = (1, 1);
    for my $case (@figures) {
        my ($name, $figure, $pieces, $maps, $kind) = @$case;
        for my $depth (0, 1, 4) {
            my $found = points(2, automaton_of($name), '--figure', $figure, '--depth', $depth);
            my $expected = $pieces * $maps**$depth + ($kind eq 'open' ? 1 : 0);
            diag("$name $figure depth $depth: " . @$found . ", expected $expected") if @$found != $expected;
            $counts &&= @$found == $expected;
            next if $kind eq 'cell' || $figure eq 'flower';
            # Neighbors differ, and the end of a closed curve does not repeat its start.
            my @pairs = map { [ $_ - 1, $_ ] } ($kind eq 'closed' ? 0 : 1) .. $#$found;
            my ($repeated) = grep { farthest([ $found->[ $_->[0] ] ], [ $found->[ $_->[1] ] ]) < 1e-9 } @pairs;
            diag("$name $figure depth $depth: points @$repeated coincide") if $repeated;
            $once &&= !$repeated;
        }
    }
    ok($counts, 'K·N^n points on closed curves and cells, K·N^n + 1 on open ones');
    ok($once, 'a shared point appears once');
}

# ---- Places on a figure --------------------------------------------------------------------------------------

# K and N powers of two: the parameters k/(K N^n) are exact doubles.
my @dyadic = (
    [ 'chaikin', 'square', 4, 2, 6 ],
    [ 'bezier-cubic', 'circle', 4, 2, 6 ],
    [ 'takagi', 'curve', 1, 2, 9 ],
    [ 'koch', 'curve', 1, 4, 5 ],
    [ 'hilbert', 'moore', 4, 4, 4 ],
    [ 'dragon', 'twindragon', 2, 2, 8 ],
    [ 'five-points', 'crown', 4, 2, 6 ],
    [ 'spiral', 'lace', 4, 2, 6 ],
    [ 'ring', 'extra', 8, 2, 6 ],
    [ 'cantor', 'set', 1, 2, 8 ],
    [ 'fern', 'fern', 1, 4, 4 ],
    [ 'sierpinski-carpet', 'square', 1, 8, 3 ]);

sub digits
{
    my ($index, $base, $length) = @_;
    my @digits;
    for (1 .. $length) {
        unshift @digits, $index % $base;
        $index = int($index / $base);
    }
    return join '', @digits;
}

# A descent multiplies the maps of a word one by one, the whole output the last ones first: they agree to a few
# units in the last place, not to all bits.
sub test_places
{
    my ($by_parameter, $by_address) = (1, 1);
    for my $case (@dyadic) {
        my ($name, $figure, $pieces, $maps, $depth) = @$case;
        my $all = points(2, automaton_of($name), '--figure', $figure, '--depth', $depth);
        my $count = $maps**$depth;
        srand 1;
        my @indices = map { int rand $pieces * $count } 1 .. 40;
        my @expected = @$all[@indices];
        my $at = single(automaton_of($name), [ map { [ '--at', $_ / ($pieces * $count) ] } @indices ], '--figure', $figure);
        my $address = single(automaton_of($name),
            [ map { [ '--address', int($_ / $count) . '.' . digits($_ % $count, $maps, $depth) ] } @indices ],
            '--figure', $figure);
        my $size = span(@$all);
        for my $pair ([ \$by_parameter, $at, '--at' ], [ \$by_address, $address, '--address' ]) {
            my ($verdict, $found, $what) = @$pair;
            my $distance = farthest($found, \@expected);
            diag("$name $figure $what: $distance of $size") unless $distance <= 1e-15 * $size;
            $$verdict &&= $distance <= 1e-15 * $size;
        }
    }
    ok($by_parameter, 'the point k of depth n is the point --at k/(K N^n)');
    ok($by_address, 'the point k of depth n has the digits of k for address');
    my $ends = single(gallery('chaikin'), [ [ '--at', 0 ], [ '--at', 1 ] ]);
    is_deeply($ends, [ [ 1, 0 ], [ 1, 0 ] ], 'a closed curve ends where it starts');
    is_deeply(single(gallery('koch'), [ [ '--at', 0 ], [ '--at', 1 ] ], '--figure', 'bent'), [ [ 0, 0 ], [ 2, 0 ] ],
        'an open one at its last joint');
    # The last map of Cantor's set again and again leads to 1.
    ok(agree(single(gallery('cantor'), [ [ '--at', 1 ] ], '--figure', 'set'), [ [ 1, 0 ] ], 1e-15, 'cantor'),
        'an attractor ends at the fixed point of its last map');
}

# Any parameter, dyadic or not, against closed forms.
sub test_parameters
{
    srand 12;
    my @controls = random_points(7, 2);
    my $file = with_figure('chaikin', 'open arc', @controls);
    my @t = map { rand } 1 .. 100;
    my @expected = map {
        my $i = int(5 * $_);
        bspline(2, [ -2 .. 3 ], piece_controls(\@controls, $i, 1, 3), 5 * $_ - $i)
    } @t;
    ok(agree(single($file, [ map { [ '--at', sprintf '%.17g', $_ ] } @t ], '--figure', 'extra'), \@expected, $promised, '--at'),
        '--at any parameter of a B-spline');
    # Three children: fractions of 2^-62 never end in base 3.
    my $ternary = spit(scratch('ternary.bcifs'), "automaton ternary\nedge arc { mask 3 [ @{[ spline_mask(3, 3) ]} ] }\n"
            . 'figure f { open arc points [ ' . join('; ', map { "@$_" } @controls) . " ] }\n");
    @expected = map {
        my $i = int(4 * $_);
        bspline(3, [ -3 .. 4 ], piece_controls(\@controls, $i, 1, 4), 4 * $_ - $i)
    } @t;
    ok(agree(single($ternary, [ map { [ '--at', sprintf '%.17g', $_ ] } @t ]), \@expected, $promised, 'ternary'),
        '--at any parameter of a ternary scheme');
    # Hölder exponents 1/2 and log_4 3 turn the 1e-17 by which a double misses 1/3 into 1e-8 and 1e-13.
    ok(agree(single(gallery('hilbert'), [ [ '--at', '1/3' ] ]), [ [ 0, 1 ] ], 1e-7, 'hilbert'), "Hilbert's curve at 1/3");
    ok(agree(single(gallery('koch'), [ [ '--at', '1/3' ] ], '--figure', 'curve'), [ [ 5 / 14, $r3 / 14 ] ], 1e-12, 'koch'),
        "von Koch's curve at 1/3");
    # A mask with twelve maps: addresses with commas. The segment's cell d_1, d_2, … starts at Σ d_i / 12^i.
    my $twelve = spit(scratch('twelve.bcifs'),
        "automaton twelve\nedge arc { mask 12 [ @{[ spline_mask(1, 12) ]} ] }\nfigure f { open arc points [ 0; 12 ] }\n");
    my $found = single($twelve, [ map { [ '--address', $_ ] } '0.11,3,0', '0.7,10', '0.0,0,6', '0.5' ]);
    ok(agree($found, [ [ 11 + 3 / 12 ], [ 7 + 10 / 12 ], [ 6 / 144 ], [5] ], 1e-15, 'commas'),
        'addresses of more than ten maps have commas');
}

# A range is the sub-list of all points with from <= t <= to, the same bytes.
sub test_ranges
{
    my $good = 1;
    for my $case (@dyadic, [ 'koch', 'snowflake', 3, 4, 5 ], [ 'four-point', 'arch', 3, 2, 7 ], [ 'koch', 'bent', 2, 4, 4 ],
        [ 'chaikin', 'square', 4, 2, 16 ]) {
        my ($name, $figure, $pieces, $maps, $depth) = @$case;
        my @options = (automaton_of($name), '--figure', $figure, '--depth', $depth);
        my (undef, $all) = run('eval', @options, '--format', 'f64');
        my (undef, $text) = run('eval', @options);
        my ($header, @lines) = split /^/, $text;
        my $count = Math::BigInt->new($pieces)->bmul(Math::BigInt->new($maps)->bpow($depth));
        srand 5;
        for my $try (1 .. effort(4)) {
            my ($from, $to) = sort { $a <=> $b } map { rand } 1, 2;
            # Every other time exactly on points.
            ($from, $to) = map { int($_ * $count->numify) / $count->numify } $from, $to if $try % 2 && $pieces != 3;
            my ($first, $last) = map { exact_fraction($_) * $count } $from, $to;
            $first = $first->bceil->numify;
            $last = $last->bfloor->numify;
            next if $first > $last;
            my $range = sprintf '%.17g..%.17g', $from, $to;
            my ($status, $part) = run('eval', @options, '--format', 'f64', '--range', $range);
            my $same = $status == 0 && $part eq substr($all, 16 * $first, 16 * ($last - $first + 1));
            diag("$name $figure --range $range: differs from points $first to $last") unless $same;
            $good &&= $same;
            (undef, $part) = run('eval', @options, '--range', $range);
            $good &&= $part eq join '', $header, @lines[ $first .. $last ];
        }
        my (undef, $tail) = run('eval', @options, '--format', 'f64', '--range', '1/2..1');
        my $half = $count->copy->badd(1)->bdiv(2)->numify;
        $good &&= $tail eq substr($all, 16 * $half);
        diag("$name $figure: 1/2..1 is not the second half") unless $tail eq substr($all, 16 * $half);
        (undef, $tail) = run('eval', @options, '--format', 'f64', '--range', '0..1');
        $good &&= $tail eq $all;
    }
    ok($good, 'a range gives the same bytes as the whole');
}

# A double as a fraction of two integers.
sub exact_fraction
{
    my ($number) = @_;
    my $scaled = Math::BigInt->new(sprintf '%.0f', $number * 2**52 * 2**10);
    return Math::BigRat->new($scaled, Math::BigInt->new(2)->bpow(62));
}

# ---- Control points and seeds --------------------------------------------------------------------------------

# Refinement matrices T_÷ from the sources, by columns: new point c of an arc from its old ones. N, Δ, m_s.
my %refinement = (
    # [SI]: q = P·S.
    chaikin => [ 2, 1, 2, [ [ 0.75, 0.25, 0 ], [ 0.25, 0.75, 0 ], [ 0, 0.75, 0.25 ], [ 0, 0.25, 0.75 ] ] ],
    # De Casteljau at the middle.
    'bezier-quadratic' =>
        [ 2, 2, 1, [ [ 1, 0, 0 ], [ 0.5, 0.5, 0 ], [ 0.25, 0.5, 0.25 ], [ 0, 0.5, 0.5 ], [ 0, 0, 1 ] ] ],
    # [IM] 4.3, last matrix, r = (1/2, 1/2), s = (1/8, 3/4, 1/8).
    'bspline-cubic' => [ 2, 1, 3,
        [ [ 1 / 2, 1 / 2, 0, 0 ], [ 1 / 8, 3 / 4, 1 / 8, 0 ], [ 0, 1 / 2, 1 / 2, 0 ], [ 0, 1 / 8, 3 / 4, 1 / 8 ],
            [ 0, 0, 1 / 2, 1 / 2 ] ] ],
    # [IM] 4.3, the 5 × 7 matrix, with r, s, t and u of the gallery's file.
    'five-points' => [ 2, 2, 3,
        [ [ 3 / 8, 5 / 8, 0, 0, 0 ], [ 1 / 8, 3 / 4, 1 / 8, 0, 0 ], [ 0, 5 / 8, 3 / 8, 0, 0 ],
            [ -1 / 2, 3 / 4, 1 / 2, 3 / 4, -1 / 2 ], [ 0, 0, 3 / 8, 5 / 8, 0 ], [ 0, 0, 1 / 8, 3 / 4, 1 / 8 ],
            [ 0, 0, 0, 5 / 8, 3 / 8 ] ] ]);

# The control polygon one level finer: [IM] 5.1.
sub refine
{
    my ($scheme, $controls, $closed) = @_;
    my ($n, $step, $joint, $columns) = @$scheme;
    my $m = $step + $joint;
    my $pieces = $closed ? @$controls / $step : (@$controls - $m) / $step + 1;
    my @finer;
    for my $i (0 .. $pieces - 1) {
        my $last = !$closed && $i == $pieces - 1 ? $#$columns : $n * $step - 1;
        push @finer, map { combine($_, piece_controls($controls, $i, $step, $m)) } @$columns[ 0 .. $last ];
    }
    return \@finer;
}

# The image of the joint point `seed` at the start of every arc, and at the end of an open curve.
sub seeded
{
    my ($scheme, $controls, $closed, $seed) = @_;
    my ($n, $step, $joint) = @$scheme;
    my $count = $closed ? @$controls / $step : (@$controls - $joint) / $step + 1;
    return [ map { combine($seed, piece_controls($controls, $_, $step, $joint)) } 0 .. $count - 1 ];
}

sub test_control
{
    my ($good, $seeds) = (1, 1);
    for my $name (sort keys %refinement) {
        my $scheme = $refinement{$name};
        my (undef, $step, $joint) = @$scheme;
        for my $closed (0, 1) {
            srand 31;
            my @controls = random_points($closed ? 4 * $step : 3 * $step + $joint, 2);
            my $file = with_figure($name, $closed ? 'closed arc' : 'open arc', @controls);
            my $polygon = \@controls;
            for my $depth (0 .. 5) {
                my @options = ($file, '--figure', 'extra', '--depth', $depth, '--show');
                my $what = "$name, closed $closed, depth $depth";
                $good &&= agree(points(2, @options, 'control'), $polygon, 1e-14, $what);
                for my $seed (map { my @q = map { int(rand 17) / 8 - 1 } 2 .. $joint; [ 1 - sum(0, @q), @q ] } 1 .. 3) {
                    $seeds &&= agree(points(2, @options, 'seed:' . join ',', @$seed), seeded($scheme, $polygon, $closed, $seed),
                        1e-14, "$what, seed @$seed");
                }
                $polygon = refine($scheme, $polygon, $closed);
            }
        }
    }
    ok($good, '--show control is the product of refinement matrices');
    ok($seeds, '--show seed is the image of the point of the joint');
}

sub test_seeds
{
    # The joint's limit point gives the limit points, [IM] (3): (1/7, 5/7, 1/7) by hand from T^s c = c.
    for my $case ([ 'five-points', 'crown', '1/7,5/7,1/7' ], [ 'chaikin', 'square', '1/2,1/2' ],
        [ 'bspline-cubic', 'clover', '1/6,2/3,1/6' ], [ 'koch', 'snowflake', '1' ], [ 'spiral', 'coil', '1/3,1/3,1/3' ]) {
        my ($name, $figure, $seed) = @$case;
        my @options = (gallery($name), '--figure', $figure, '--depth', 5);
        ok(agree(points(2, @options, '--show', "seed:$seed"), points(2, @options), 1e-15, $name),
            "$name: the joint's limit point as seed gives limit points");
    }
    # Five points approximate: the polygon of another seed nears the curve, since the maps contract, but never
    # meets it.
    my @distances = map {
        my @options = (gallery('five-points'), '--figure', 'arch', '--depth', $_);
        farthest(points(2, @options, '--show', 'seed:0,1,0'), points(2, @options))
    } 4, 8, 12, 16;
    my $falling = 1;
    $falling &&= $distances[$_] > 0 && $distances[$_] < 0.5 * $distances[ $_ - 1 ] for 1 .. $#distances;
    ok($falling, "five points: [IM] figure 5, broken lines near the arc");
    diag("distances @distances") unless $falling;
    # A cell's seed is a point of its frame: f_w of it.
    my @corners = ([ 0, 0 ], [ 1, 0 ], [ 0.5, $r3 / 2 ]);
    my @halves = map { my $corner = $_; scale_about(0.5, $corner) } @corners;
    my $center = combine([ 1 / 3, 1 / 3, 1 / 3 ], \@corners);
    ok(agree(points(2, gallery('sierpinski-triangle'), '--depth', 5, '--show', 'seed:1/3,1/3,1/3'),
            walk_words(\@halves, 5, $center), 1e-15, 'centers'),
        'a seed of a cell: the centers of all triangles');
    # Control frames: the corners of all triangles, word by word.
    my @frames;
    my @lists = map { walk_words(\@halves, 4, $_) } @corners;
    for my $k (0 .. 80) {
        push @frames, map { $_->[$k] } @lists;
    }
    ok(agree(points(2, gallery('sierpinski-triangle'), '--depth', 4, '--show', 'control'), \@frames, 1e-15, 'frames'),
        'control frames of cells');
}

# ---- Scale and place -----------------------------------------------------------------------------------------

sub test_invariance
{
    my ($exact, $scaled, $moved) = (1, 1, 1);
    for my $case ([ 'chaikin', 12 ], [ 'four-point', 12 ], [ 'takagi', 12 ], [ 'koch', 12 ], [ 'five-points', 13 ],
        [ 'ring', 8 ], [ 'fern', 3 ], [ 'spiral', 8 ]) {
        my ($name, $number) = @$case;
        srand 17;
        my @controls = random_points($number, 2);
        my $at = sub {
            my ($map) = @_;
            my $csv = spit(scratch('moved.csv'), csv_of(map { [ map { $map->($_) } @$_ ] } @controls));
            return points(2, automaton_of($name), '--points', $csv, '--depth', 4, $name eq 'ring' ? ('--figure', 'extra') : ());
        };
        # takagi's first figure is open and wants an odd number.
        push @controls, [ 1, 1 ] if $name eq 'takagi';
        my $plain = $at->(sub { $_[0] });
        for my $power (20, -20, 300, -300) {
            $exact &&= farthest($at->(sub { $_[0] * 2**$power }), [ map { [ map { $_ * 2**$power } @$_ ] } @$plain ]) == 0;
        }
        for my $factor (1e6, 1e-6, -1e6) {
            $scaled &&= agree($at->(sub { $_[0] * $factor }), [ map { [ map { $_ * $factor } @$_ ] } @$plain ], 1e-14,
                "$name times $factor");
        }
        for my $shift (1e6, -1e-6) {
            $moved &&= agree($at->(sub { $_[0] + $shift }), [ map { [ map { $_ + $shift } @$_ ] } @$plain ], 1e-14,
                "$name plus $shift");
        }
    }
    ok($exact, 'powers of two scale every bit');
    ok($scaled, 'scaling by 1e6 and 1e-6');
    ok($moved, 'translation');
}

# ---- Bare states, parameters ---------------------------------------------------------------------------------

sub test_options
{
    my $csv = spit(scratch('three.csv'), "0,0\n1,2\n2,0\n");
    my $expected = [ map { bspline(2, [ -2 .. 3 ], [ [ 0, 0 ], [ 1, 2 ], [ 2, 0 ] ], $_ / 16) } 0 .. 16 ];
    ok(agree(points(2, gallery('chaikin'), '--state', 'arc', '--points', $csv, '--depth', 4), $expected, $promised, 'state'),
        'a bare state on given points');
    my $same = points(2, gallery('corner-cutting'), '--set', 'a=1/4', '--set', 'b=1/4', '--depth', 6);
    my $chaikin = with_figure('chaikin', 'closed arc', [ 0, 10 ], [ -3, 4 ], [ -10, 3 ], [ -5, -2 ], [ -6, -9 ], [ 0, -5 ], [ 6, -9 ],
        [ 5, -2 ], [ 10, 3 ], [ 3, 4 ]);
    ok(agree($same, points(2, $chaikin, '--figure', 'extra', '--depth', 6), 1e-15, 'a = b = 1/4'),
        "corner cutting with a = b = 1/4 is Chaikin's");
    # Corner cutting by its own rule on the polygon, [SI] (1), (2): a from the start, b from the end of a side.
    my ($a, $b) = (1 / 3, 1 / 5);
    my @polygon = ([ 0, 0 ], [ 3, 5 ], [ -1, 7 ], [ -4, 2 ]);
    my $csv4 = spit(scratch('four.csv'), csv_of(@polygon));
    my $rule = [ 2, 1, 2, [ [ 1 - $a, $a, 0 ], [ $b, 1 - $b, 0 ], [ 0, 1 - $a, $a ], [ 0, $b, 1 - $b ] ] ];
    my $cut = \@polygon;
    $cut = refine($rule, $cut, 1) for 1 .. 6;
    ok(agree(points(2, gallery('corner-cutting'), '--set', 'a=1/3', '--set', 'b=1/5', '--points', $csv4, '--depth', 6, '--show', 'control'),
            $cut, 1e-14, 'corner cutting'),
        'corner cutting by its rule on the polygon');
    # Its joint's limit point divides the side as b : a, [SI] "Etude des valeurs et vecteurs propres".
    my @joints = map { combine([ $b / ($a + $b), $a / ($a + $b) ], [ @$cut[ $_, ($_ + 1) % @$cut ] ]) } 0 .. $#$cut;
    ok(agree(points(2, gallery('corner-cutting'), '--set', 'a=1/3', '--set', 'b=1/5', '--points', $csv4, '--depth', 6), \@joints,
            1e-14, 'joints'),
        'and its limit points divide the sides as b : a');
    # Parameters of points among the options.
    my ($status) = run('eval', gallery('takagi'), '--set', 'w=1/2', '--at', '1/2', '--at', '1/4', '--address', '0.01');
    is($status, 0, '--at and --address together');
    # Without --depth: the deepest level with at most about 4096 points, says the help.
    is(scalar @{ points(2, gallery('chaikin')) }, 4096, 'the default depth gives about 4096 points');
    is(scalar @{ points(2, gallery('koch')) }, 3 * 4**5, 'of a snowflake too');
}

test_chaikin();
test_masks();
test_bezier();
test_nonuniform();
test_four_point();
test_takagi();
test_fractals();
test_attractors();
test_addresses();
test_spiral();
test_dimensions();
test_unequal();
test_chains();
test_counts();
test_places();
test_parameters();
test_ranges();
test_control();
test_seeds();
test_invariance();
test_options();
done_testing();
