# What the tests of evaluation share: running the command, reading its points, and the mathematics that its
# results are held against.
#
# Points are lists of numbers; a curve is a list of points. Nothing in here looks at an automaton's matrices.
package Eval;

use strict;
use warnings;
use Exporter 'import';
use File::Basename qw(dirname);
use File::Temp qw(tempdir);
use List::Util qw(max min);
use POSIX ();
use Test::More;

our @EXPORT = qw(run slurp spit gallery scratch points chains single fraction effort random_points
    random_between span farthest agree bspline bezier combine is_same csv_of number_bits walk_words);

my $command = $ENV{BCIFS} // 'build/bcifs';
my $root = dirname(__FILE__) . '/../../..';
my $scratch = tempdir('bcifs-test-XXXXXX', TMPDIR => 1, CLEANUP => 1);

# A path in a directory that is removed at the end.
sub scratch { return "$scratch/$_[0]" }

sub slurp
{
    my ($path) = @_;
    open my $file, '<:raw', $path or die "$path: $!";
    local $/;
    return scalar <$file>;
}

sub spit
{
    my ($path, $text) = @_;
    open my $file, '>:raw', $path or die "$path: $!";
    print $file $text;
    close $file or die "$path: $!";
    return $path;
}

# The path of an automaton of the gallery; with more text, of a copy that has it appended.
sub gallery
{
    my ($name, $more) = @_;
    my $path = "$root/automata/$name.bcifs";
    return $path unless defined $more;
    return spit(scratch("$name-" . next_number() . '.bcifs'), slurp($path) . "\n$more\n");
}

my $count = 0;
sub next_number { return ++$count }

# Runs the command: exit status (256 + signal when it was killed), standard output and standard error.
sub run
{
    my @words = @_;
    my ($out, $err) = (scratch('out'), scratch('err'));
    my $child = fork // die "fork: $!";
    if ($child == 0) {
        open STDIN, '<', '/dev/null' or die;
        open STDOUT, '>', $out or die;
        open STDERR, '>', $err or die;
        # The copy of this program must end without tidying up what is not its own.
        exec { $command } $command, @words or POSIX::_exit(127);
    }
    waitpid $child, 0;
    my $status = $? & 127 ? 256 + ($? & 127) : $? >> 8;
    return ($status, slurp($out), slurp($err));
}

# All points that `eval` gives, through raw doubles: every bit.
sub points
{
    my ($dimension, $file, @options) = @_;
    my ($status, $bytes, $err) = run('eval', $file, @options, '--format', 'f64');
    if ($status != 0) {
        diag("eval $file @options: exit $status: $err");
        return [];
    }
    my @numbers = unpack 'd<*', $bytes;
    my @points;
    push @points, [ splice @numbers, 0, $dimension ] while @numbers;
    return \@points;
}

# The points of .csv, chain by chain.
sub chains
{
    my ($file, @options) = @_;
    my ($status, $text, $err) = run('eval', $file, @options, '--format', 'csv');
    if ($status != 0) {
        diag("eval $file @options: exit $status: $err");
        return [];
    }
    $text =~ s/^[a-z0-9,]+\n//;
    return [ map { [ map { [ split /,/ ] } split /\n/ ] } split /\n\n/, $text ];
}

# Points at several --at or --address: a list of [option, value].
sub single
{
    my ($file, $positions, @options) = @_;
    my @found;
    my @rest = @$positions;
    while (my @some = splice @rest, 0, 200) {
        my ($status, $text, $err) = run('eval', $file, (map { @$_ } @some), @options);
        if ($status != 0) {
            diag("eval $file @options: exit $status: $err");
            return [];
        }
        my @lines = split /\n/, $text;
        push @found, map { [ split /,/ ] } @lines[1 .. $#lines];
    }
    return \@found;
}

# How often to repeat a random check: see tests/unit/tap.h.
sub effort
{
    my ($count) = @_;
    return max(1, int($count * ($ENV{TEST_EFFORT} // 1)));
}

# ---- Numbers and points --------------------------------------------------------------------------------------

# The double nearest to what is written as "3/4", "-2" or "0.5".
sub fraction
{
    my ($text) = @_;
    return $text =~ m{^(.*)/(.*)$} ? $1 / $2 : $text + 0;
}

# The 64 bits of a number, as text.
sub number_bits { return unpack 'H16', pack 'd>', $_[0] }

sub random_between { return $_[0] + ($_[1] - $_[0]) * rand }

# `count` points with coordinates in -10..10 that are short decimals, so that text loses nothing.
sub random_points
{
    my ($number, $dimension) = @_;
    return map { [ map { int(rand 20001) / 1000 - 10 } 1 .. $dimension ] } 1 .. $number;
}

sub csv_of
{
    return join '', map { join(',', map { sprintf '%.17g', $_ } @$_) . "\n" } @_;
}

# The largest absolute coordinate.
sub span
{
    return max(1e-300, map { map { abs } @$_ } @_);
}

# The largest difference of a coordinate between two equally long lists of points; infinite otherwise.
sub farthest
{
    my ($found, $expected) = @_;
    return 9**9**9 if @$found != @$expected;
    my $distance = 0;
    for my $i (0 .. $#$expected) {
        return 9**9**9 if @{ $found->[$i] } != @{ $expected->[$i] };
        for my $c (0 .. $#{ $expected->[$i] }) {
            my $difference = abs($found->[$i][$c] - $expected->[$i][$c]);
            $distance = $difference unless $difference <= $distance;
        }
    }
    return $distance;
}

# Whether points agree to `tolerance`, relative to the size of what is expected; says how not.
sub agree
{
    my ($found, $expected, $tolerance, $what) = @_;
    my $distance = farthest($found, $expected);
    my $size = span(@$expected);
    return 1 if $distance <= $tolerance * $size;
    diag(sprintf '%s: %d points, expected %d; error %g of size %g', $what, scalar @$found, scalar @$expected,
        $distance, $size);
    for my $i (0 .. min($#$found, $#$expected)) {
        next if farthest([ $found->[$i] ], [ $expected->[$i] ]) <= $tolerance * $size;
        diag("point $i: (@{ $found->[$i] }), expected (@{ $expected->[$i] })");
        last;
    }
    return 0;
}

# Whether two byte strings are the same, without printing megabytes.
sub is_same
{
    my ($found, $expected, $what) = @_;
    my $same = ok($found eq $expected, $what);
    diag(sprintf 'lengths %d and %d', length $found, length $expected) unless $same;
    return $same;
}

# Σ weight · point.
sub combine
{
    my ($weights, $points) = @_;
    my @sum = (0) x @{ $points->[0] };
    for my $j (0 .. $#$weights) {
        next if $weights->[$j] == 0;
        $sum[$_] += $weights->[$j] * $points->[$j][$_] for 0 .. $#sum;
    }
    return \@sum;
}

# ---- Classical curves ----------------------------------------------------------------------------------------

# A point of a B-spline by Cox and de Boor's recursion for the basis functions (M. Cox, 1972; C. de Boor, 1972).
# The interval of the first functions is half-open, but closed at the last knot.
sub bspline
{
    my ($degree, $knots, $controls, $t) = @_;
    my $last = $knots->[ $#$knots - $degree ];
    my @basis = map {
        my ($low, $high) = @$knots[ $_, $_ + 1 ];
        ($t == $last ? $low < $t && $t <= $high : $low <= $t && $t < $high) ? 1 : 0
    } 0 .. $#$knots - 1;
    for my $p (1 .. $degree) {
        for my $i (0 .. $#$knots - $p - 1) {
            my $sum = 0;
            $sum += ($t - $knots->[$i]) / ($knots->[ $i + $p ] - $knots->[$i]) * $basis[$i] if $basis[$i];
            $sum += ($knots->[ $i + $p + 1 ] - $t) / ($knots->[ $i + $p + 1 ] - $knots->[ $i + 1 ]) * $basis[ $i + 1 ]
                if $basis[ $i + 1 ];
            $basis[$i] = $sum;
        }
    }
    return combine([ @basis[ 0 .. $#$controls ] ], $controls);
}

# A point of a Bézier curve by Bernstein's polynomials.
sub bezier
{
    my ($controls, $t) = @_;
    my $degree = $#$controls;
    my ($choose, @weights) = (1);
    for my $i (0 .. $degree) {
        push @weights, $choose * $t**$i * (1 - $t)**($degree - $i);
        $choose = $choose * ($degree - $i) / ($i + 1);
    }
    return combine(\@weights, $controls);
}

# The points f_w(start) for all words w of length `depth` over the functions, in the order of the words.
sub walk_words
{
    my ($functions, $depth, $start) = @_;
    my @points = ($start);
    for (1 .. $depth) {
        my @next;
        for my $f (@$functions) {
            push @next, map { $f->($_) } @points;
        }
        @points = @next;
    }
    return \@points;
}

1;
