#!/usr/bin/env perl
# Drawn curves: control points from SVG and CSV (--curve), and control points fitted to them (fit). Bézier curves are
# held against Bernstein's polynomials, fits against the control points that made their targets.
use strict;
use warnings;
use FindBin;
use lib "$FindBin::Bin/lib";
use JSON::PP ();
use Test::More;
use Eval;

my $json = JSON::PP->new;

sub svg { return spit(scratch('drawing.svg'), "<svg xmlns=\"http://www.w3.org/2000/svg\">\n$_[0]\n</svg>\n") }

# ---- Control points from a drawing ---------------------------------------------------------------------------

# A path of random cubics, and its control points with y up.
sub random_cubics
{
    my ($count, $closed) = @_;
    my @points = random_points(3 * $count + ($closed ? 0 : 1), 2);
    my @again = $closed ? (@points, $points[0]) : @points;
    my $d = sprintf 'M%s,%s', @{ $again[0] };
    $d .= ' C' . join ' ', map { "@{ $again[$_] }" } 3 * $_ + 1 .. 3 * $_ + 3 for 0 .. $count - 1;
    return ($d . ($closed ? 'Z' : ''), map { [ $_->[0], -$_->[1] ] } @points);
}

srand 11;
my $wave = gallery('bezier-cubic', 'figure any_line { open arc points [ 0 0; 0 1; 1 1; 1 0 ] }
figure any_ring { closed arc points [ 0 0; 0 1; 1 1 ] }');
for my $closed (0, 1) {
    my $good = 1;
    for (1 .. effort(10)) {
        my $count = 1 + int rand 5;
        $count++ if $closed && $count == 1;
        my ($d, @controls) = random_cubics($count, $closed);
        my $found = points(2, $wave, '--figure', $closed ? 'any_ring' : 'any_line', '--depth', 3, '--curve',
            svg("<path d='$d'/>"));
        my @expected;
        for my $i (0 .. $count - 1) {
            my @piece = map { $controls[ (3 * $i + $_) % @controls ] } 0 .. 3;
            push @expected, map { bezier(\@piece, $_ / 8) } 0 .. 7;
        }
        push @expected, $controls[-1] unless $closed;
        $good = agree($found, \@expected, 1e-13, $d) && $good;
    }
    ok($good, ($closed ? 'closed' : 'open') . ' cubic paths are the curves that SVG draws, upside up');
}

# Control points of depth 0.
sub controls_of
{
    my ($file, $figure, $curve) = @_;
    return points(2, $file, '--figure', $figure, '--depth', 0, '--show', 'control', '--curve', $curve);
}

my $chaikin = gallery('chaikin', 'figure line { open arc points [ 0 0; 1 0; 1 1 ] }');
my $square = [ [ 0, 0 ], [ 2, 0 ], [ 2, 2 ], [ 0, 2 ] ];
is_deeply(controls_of($chaikin, 'square', svg('<path d="M0 0H2V-2H0z"/>')), $square, 'a closed path for a closed figure');
is_deeply(controls_of($chaikin, 'square', svg('<path d="M0 0H2V-2H0V0"/>')), $square,
    'an open path that comes back gives its last point up');
is_deeply(controls_of($chaikin, 'line', svg('<path d="M0 0H2V-2H0z"/>')), [ @$square, [ 0, 0 ] ],
    'an open figure on a closed path comes back to its start');
is_deeply(controls_of($chaikin, 'line', svg('<g transform="translate(1 1)"><path d="M-1-1h2v-2h-2"/></g>')), $square,
    'an open path for an open figure, transformed');
my $listed = spit(scratch('list.CSV'), "x,y\n0,0\n2,0\n2,2\n0,2\n0,0\n");
is_deeply(controls_of($chaikin, 'square', $listed), $square, 'points from CSV');
is_deeply(controls_of($chaikin, 'line', $listed), [ @$square, [ 0, 0 ] ], 'points from CSV, open');
spit(scratch('unnamed'), slurp(svg('<path d="M0 0H2V-2H0z"/>')));
is_deeply(controls_of($chaikin, 'square', scratch('unnamed')), $square, 'SVG is known by its text, too');

# ---- Fits ----------------------------------------------------------------------------------------------------

# The figure's limit points at a depth as a target, and what fit makes of them.
sub fit
{
    my ($file, @options) = @_;
    my ($status, $out, $err) = run('fit', $file, '--json', @options);
    is($status, 0, "fit @options") or diag($err);
    return $status == 0 ? $json->decode($out) : {points => []};
}

for my $case ([ 'bspline-cubic', 'clover', 12 ], [ 'bezier-cubic', 'wave', 2 ], [ 'takagi', 'curve', 1 ],
    [ 'koch', 'snowflake', 3 ], [ 'four-point', 'star', 10 ], [ 'nonuniform-quadratic', 'crest', 0 ]) {
    my ($name, $figure, $pieces) = @$case;
    my $target = scratch("$name.csv");
    run('eval', gallery($name), '--figure', $figure, '--depth', 5, '-o', $target);
    my $known = points(2, gallery($name), '--figure', $figure, '--depth', 0, '--show', 'control');
    my $found = fit(gallery($name), '--figure', $figure, '--to', $target, $pieces ? ('--pieces', $pieces) : ());
    # No error is left, and the control points are uncertain by rounding times the condition of the equations.
    ok(agree($found->{points}, $known, 1e-10, "$name, $figure"), "$name, $figure: its own limit points give it back");
    cmp_ok($found->{rms}, '<', 1e-11, 'with no error');
    cmp_ok($found->{rms}, '<=', $found->{maximum}, 'the largest error is not below the mean');
    is($found->{pieces}, $pieces, 'and as many pieces') if $pieces;
}

my $circle = svg('<path d="M1 0C1 .5523 .5523 1 0 1S-1 .5523-1 0-.5523-1 0-1 1-.5523 1 0z"/>');
my $clover = gallery('bspline-cubic');
my @errors = map { fit($clover, '--to', $circle, '--pieces', $_)->{rms} } 5, 10;
# Periodic cubic splines come near to a circle in the fourth power of the interval; drawn by Bézier arcs it is off
# by 3e-4 itself, which the finer spline follows in part.
cmp_ok($errors[1], '<', $errors[0] / 8, "twice the pieces, an eighth of the error at most: @errors");

my $csv = scratch('fitted.csv');
is((run('fit', $clover, '--to', $circle, '--pieces', 8, '-o', $csv))[0], 0, 'control points as CSV');
my $radii = points(2, $clover, '--depth', 4, '--points', $csv);
my @off = grep { abs(sqrt($_->[0]**2 + $_->[1]**2) - 1) > 2e-3 } @$radii;
ok(@$radii == 128 && !@off, 'are what eval --points draws the circle with');
for my $ending ('svg', 'png') {
    my $picture = scratch("fit.$ending");
    my ($status, undef, $err) = run('fit', $clover, '--to', $circle, '--pieces', 8, '-o', $picture);
    ok($status == 0 && -s $picture > 1000, "a picture, $ending") or diag($err);
}
my $drawn = slurp(scratch('fit.svg'));
like($drawn, qr/class="$_"/, "with the $_") for qw(target curve polygon);
like($drawn, qr/fit .*--pieces 8/, 'and its command line');
my ($status, $out) = run('fit', $clover, '--to', $circle, '--pieces', 4, '--depth', 3);
is($status, 0, '--depth');
like($out, qr/^x,y\n(?:-?[0-9.e-]+,-?[0-9.e-]+\n){4}$/, 'control points on standard output');
is_same((run('fit', $clover, '--to', $circle, '--pieces', 4, '--depth', 3))[1], $out, 'the same every time');

# ---- Refusals ------------------------------------------------------------------------------------------------

# Exit status 2 with `file:line:column: error: …`, or `bcifs: …`, no output and no file.
sub refused
{
    my ($pattern, @words) = @_;
    my $output = scratch('must-not-be.csv');
    my ($code, $text, $err) = run(@words, '-o', $output);
    ok($code == 2 && $text eq '' && !-e $output && $err =~ $pattern, "refused: $pattern")
        or diag("status $code: $text$err");
}

my %drawings = (
    '<path d="M0 0A1 1 0 0 0 2 2"/>' => qr/:2:14: error: elliptical arcs \(command A\)/,
    '<path d="M0 0L1 1Q1 1 0 0"/>'   => qr/:2:18: error: quadratic curves \(command Q\)/,
    '<rect width="3"/>'              => qr/:2:2: error: there is no <path> to read; convert this <rect>/,
    '<path d="M0 0L1 one"/>'         => qr/:2:17: error: expected a number, found 'one'/,
    '<path d="M0 0L1 nan"/>'         => qr/:2:17: error: expected a number, found 'nan'/,
    '<path d="M0 0L1 1e400"/>'       => qr/:2:17: error: the number '1e400' is too large/,
    '<path d="M0 0L1 1"'             => qr/:3:1: error: expected an attribute/,
    '<path d="M0 0L1 1M2 2"/>'       => qr/:2:18: error: the path has a second outline/,
    '<g><path d="M0 0L1'             => qr/:2:12: error: the value of 'd' is not closed/,
);
for my $drawing (sort keys %drawings) {
    refused($drawings{$drawing}, 'fit', $clover, '--to', svg($drawing));
    refused($drawings{$drawing}, 'eval', $clover, '--curve', svg($drawing));
}
my $line = svg('<path d="M0 0L1 1"/>');
refused(qr/list:2:3: error: expected a number, found 'nan'/, 'fit', $clover, '--to', spit(scratch('list'), "1,2\n3,nan\n"));
refused(qr/at least 2 points/, 'fit', $clover, '--to', spit(scratch('one.csv'), "1,2\n"));
refused(qr/no length/, 'fit', $clover, '--to', spit(scratch('same.csv'), "1,2\n1,2\n"));
refused(qr/at most 3 coordinates/, 'fit', $clover, '--to', spit(scratch('four.csv'), "1,2,3,4\n1,2,3,5\n"));
refused(qr/no such file/i, 'fit', $clover, '--to', scratch('none.svg'));
refused(qr/--to FILE/, 'fit', $clover);
refused(qr/at least 1 piece/, 'fit', $clover, '--to', $line, '--pieces', 0);
refused(qr/--pieces: expected a whole number/, 'fit', $clover, '--to', $line, '--pieces', '3/2');
refused(qr/exclude each other/, 'fit', $clover, '--to', $line, '--figure', 'clover', '--state', 'arc');
refused(qr/exclude each other/, 'eval', $clover, '--curve', $line, '--points', $line);
refused(qr/:\d+:\d+: error: 4 pieces of 'p' need 6 intervals/, 'fit', gallery('nonuniform-quadratic'), '--figure', 'crest',
    '--to', $line, '--pieces', 4);
refused(qr/not one curve/, 'fit', gallery('fern'), '--to', $line);
refused(qr/csv, json, svg or png, not as 'npy'/, 'fit', $clover, '--to', $line, '--format', 'npy');

done_testing();
