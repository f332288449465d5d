#!/usr/bin/env perl
# bcifs basis: blending functions against the classical ones, against each other at different levels, and drawn.
use strict;
use warnings;
use FindBin;
use lib "$FindBin::Bin/lib";
use Bcifs;
use Test::More;

sub gallery { "$ROOT/automata/$_[0].bcifs" }

# The table as (parameters, rows of values).
sub basis {
    my ($file, @options) = @_;
    my ($status, $out, $err) = bcifs([ 'basis', $file, @options ]);
    is($status, 0, "basis $file @options") or diag($err);
    my ($header, @lines) = split /\n/, $out;
    my @rows = map { [ split /,/, $_, -1 ] } @lines;
    my $last = @{ $rows[0] } - 2;
    is($header, join(',', 't', map {"h$_"} 0 .. $last), 'the header');
    return ([ map { shift @$_ } @rows ], \@rows);
}

sub sums_to_one {
    my ($rows, $what) = @_;
    my $largest = 0;
    for my $row (@$rows) {
        my $sum = 0;
        $sum += $_ for @$row;
        $largest = abs($sum - 1) if abs($sum - 1) > $largest;
    }
    cmp_ok($largest, '<', 1e-12, "$what: the functions sum to 1 everywhere");
}

sub agree {
    my ($rows, $expected, $what) = @_;
    my $largest = @$rows == @$expected ? 0 : 1e300;
    for my $i (0 .. $#$rows) {
        $largest = 1e300 if @{ $rows->[$i] } != @{ $expected->[$i] };
        for my $k (0 .. $#{ $rows->[$i] }) {
            my $difference = abs($rows->[$i][$k] - $expected->[$i][$k]);
            $largest = $difference if $difference > $largest;
        }
    }
    return cmp_ok($largest, '<', 1e-12, $what);
}

# All B-spline basis functions of a degree over uniform knots -degree, …, 0, …, pieces + degree, at x in 0..pieces,
# by Cox and de Boor's recursion; the last interval is closed.
sub cox_de_boor {
    my ($degree, $pieces, $x) = @_;
    my @basis = map { $x < $pieces ? ($x >= $_ && $x < $_ + 1 ? 1 : 0) : ($_ == $pieces - 1 ? 1 : 0) }
        -$degree .. $pieces + $degree - 1;
    for my $p (1 .. $degree) {
        for my $i (0 .. $#basis - $p) {
            my $knot = $i - $degree;
            $basis[$i] = ($x - $knot) / $p * $basis[$i] + ($knot + $p + 1 - $x) / $p * $basis[ $i + 1 ];
        }
    }
    return [ @basis[ 0 .. $pieces + $degree - 1 ] ];
}

sub bernstein {
    my ($degree, $t) = @_;
    my ($choose, @values) = (1);
    for my $i (0 .. $degree) {
        push @values, $choose * $t**$i * (1 - $t)**($degree - $i);
        $choose = $choose * ($degree - $i) / ($i + 1);
    }
    return \@values;
}

# ---- Classical functions ---------------------------------------------------------------------------------------

my $hat = scratch('hat.bcifs', "automaton hat\nedge e { mask 2 [ 1/2 1 1/2 ] }\nfigure f { open e points [ 0; 1; 5; 2 ] }\n");
my %degrees = ($hat => [ 1, 'e' ], gallery('chaikin') => [ 2, 'arc' ], gallery('bspline-cubic') => [ 3, 'arc' ]);
for my $file (sort keys %degrees) {
    my ($degree, $state) = @{ $degrees{$file} };
    my ($t, $rows) = basis($file, '--state', $state, '--depth', 6);
    is(scalar @$t, 65, 'one row for every parameter of the depth');
    is_deeply([ @$t[ 0, 1, 64 ] ], [ 0, 1 / 64, 1 ], 'from 0 to 1');
    sums_to_one($rows, $file);
    agree($rows, [ map { cox_de_boor($degree, 1, $_) } @$t ], "degree $degree: Cox and de Boor");
    for my $level (1 .. 3) {
        my ($u, $fine) = basis($file, '--state', $state, '--depth', 6, '--level', $level);
        agree($fine, [ map { cox_de_boor($degree, 2**$level, $_ * 2**$level) } @$u ],
            "degree $degree, level $level: uniform knots 2^-$level apart");
    }
}
{
    my ($t, $rows) = basis($hat, '--depth', 4);
    agree($rows, [ map { cox_de_boor(1, 3, 3 * $_) } @$t ], 'hats of a figure of three pieces');
}
for ([ 'bezier-quadratic', 2 ], [ 'bezier-cubic', 3 ]) {
    my ($name, $degree) = @$_;
    my ($t, $rows) = basis(gallery($name), '--state', 'arc', '--depth', 7);
    agree($rows, [ map { bernstein($degree, $_) } @$t ], "$name: Bernstein's polynomials");
}
{
    my ($t, $rows) = basis(gallery('takagi'), '--state', 'arc', '--depth', 7, '--set', 'w=1/4');
    agree($rows, [ map { bernstein(2, $_) } @$t ], 'Takagi with w = 1/4 is Bernstein, too');
}

# A closed curve of four pieces has four functions, the uniform one shifted: h_k over the knots k - 2 … k + 1.
{
    my ($t, $rows) = basis(gallery('chaikin'), '--figure', 'square', '--depth', 4);
    is(scalar @$t, 65, 'closed: the end is written too');
    is_deeply($rows->[64], $rows->[0], 'and is the beginning');
    my @expected = map {
        my $open = cox_de_boor(2, 4, 4 * $_);
        [ $open->[0] + $open->[4], $open->[1] + $open->[5], $open->[2], $open->[3] ]
    } @$t;
    agree($rows, \@expected, 'closed: periodic B-splines');
}

# ---- Levels ----------------------------------------------------------------------------------------------------

# Proposition 5.1 of [IM]: H^x(t) = T_÷ⁿ H^x(n)(t), the matrix read from MatrixMarket.
sub proposition {
    my ($file, $level, $depth, @choice) = @_;
    my ($t, $coarse) = basis($file, '--depth', $depth, @choice);
    my ($u, $fine) = basis($file, '--depth', $depth, '--level', $level, @choice);
    is_deeply($u, $t, 'the same parameters');
    sums_to_one($fine, "$file @choice, level $level");
    my ($status, $out) = bcifs([ 'describe', $file, '--depth', $level, '--format', 'mtx', @choice ]);
    my ($size, @entries) = grep { !/^%/ } split /\n/, $out;
    my ($rows, $columns) = split ' ', $size;
    is(scalar @{ $fine->[0] }, $columns, 'a function for every control point of the level');
    my @expected = map { [ (0) x $rows ] } @$t;
    for (@entries) {
        my ($i, $k, $value) = split;
        $expected[$_][ $i - 1 ] += $value * $fine->[$_][ $k - 1 ] for 0 .. $#$t;
    }
    agree($coarse, \@expected, "$file @choice: H = T_÷ H($level)");
}
proposition(gallery('chaikin'), 2, 5);
proposition(gallery('five-points'), 2, 5, '--figure', 'two_arcs');
proposition(gallery('koch'), 1, 4, '--state', 'arc');
proposition(gallery('dragon'), 3, 6, '--figure', 'twindragon');
proposition(gallery('dragon'), 2, 5, '--figure', 'four');
proposition(gallery('nonuniform-quadratic'), 2, 5, '--figure', 'star');
proposition(gallery('four-point'), 2, 5, '--figure', 'arch');
proposition(gallery('bezier-cubic'), 1, 4, '--figure', 'flower');

# Σ H_k(t) p_k is the curve: the rows of eval, at the same parameters.
{
    my ($t, $rows) = basis(gallery('nonuniform-quadratic'), '--figure', 'crest', '--depth', 5);
    my @points = ([ 0, 0 ], [ 1, 4 ], [ 5, 5 ], [ 7, 1 ], [ 10, 0 ]);
    my ($status, $out) = bcifs([ 'eval', gallery('nonuniform-quadratic'), '--figure', 'crest', '--depth', 5 ]);
    my @expected = points_of($out);
    my @found;
    for my $row (@$rows) {
        my @point = (0, 0);
        for my $k (0 .. $#points) {
            $point[$_] += $row->[$k] * $points[$k][$_] for 0, 1;
        }
        push @found, \@point;
    }
    agree(\@found, \@expected, 'the functions times the control points are the curve');
}

# More functions than are evaluated together: the B-spline of degree 19.
{
    my @row = (1);
    push @row, $row[-1] * (20 - $#row) / @row while @row <= 20;
    my $wide = join ' ', map {"$_/524288"} @row;
    my $file = scratch('wide.bcifs', "automaton wide\nedge e { mask 2 [ $wide ] }\n");
    my ($t, $rows) = basis($file, '--state', 'e', '--depth', 3);
    sums_to_one($rows, 'degree 19');
    agree($rows, [ map { cox_de_boor(19, 1, $_) } @$t ], 'degree 19: Cox and de Boor');
}

# Children of unequal number: every child has an equal share of the parameter.
{
    my $file = scratch('uneven.bcifs', <<'END');
automaton uneven
vertex v 1 { }
edge a 2 { start v at 0
  end v at 1
  sub a [ 1 1/2; 0 1/2 ]
  sub b [ 1/2 0; 1/2 1 ] }
edge b 2 { start v at 0
  end v at 1
  sub b [ 1 2/3; 0 1/3 ]
  sub b [ 2/3 1/3; 1/3 2/3 ]
  sub b [ 1/3 0; 2/3 1 ] }
END
    my ($t, $rows) = basis($file, '--state', 'a', '--depth', 3);
    agree($rows, [ map { [ 1 - $_, $_ ] } @$t ], 'a segment is itself, however it is cut');
    is(scalar @$t, (1 + 3 + 9) + 2, 'a: 1 + 3 + 9 cells below depth 3, one more of a, and the end')
        or diag(scalar @$t);
}

# ---- Pictures --------------------------------------------------------------------------------------------------

for (
    [ gallery('chaikin'),    [ '--state',  'arc' ], 3 ],
    [ gallery('four-point'), [ '--state',  'arc' ], 6 ],
    [ gallery('chaikin'),    [ '--state',  'arc', '--level', 4 ], 18 ],
    [ gallery('chaikin'),    [ '--figure', 'square' ], 4 ],
    )
{
    my ($file, $options, $count) = @$_;
    my $path = scratch('picture.svg');
    my ($status, $out, $err) = bcifs([ 'basis', $file, @$options, '-o', $path ]);
    is($status, 0, "@$options: drawn") or diag($err);
    my $svg = file_text($path);
    my @names = $svg =~ />(h\d+)</g;
    is(join(' ', sort @names), join(' ', sort map {"h$_"} 0 .. $count - 1), 'every function is named once');
    my @boxes;
    while ($svg =~ /<text x="([\d.]+)" y="([\d.]+)" text-anchor="(\w+)"[^>]*>([^<]+)</g) {
        my $width = 7.9 * length $4;
        my $left = $1 - ($3 eq 'middle' ? $width / 2 : $3 eq 'end' ? $width : 0);
        push @boxes, [ $left, $2 - 10, $left + $width, $2 + 1, $4 ];
    }
    my @meeting;
    for my $i (0 .. $#boxes) {
        for my $j (0 .. $i - 1) {
            my ($a, $b) = @boxes[ $i, $j ];
            push @meeting, "$a->[4] / $b->[4]"
                if $a->[0] < $b->[2] && $b->[0] < $a->[2] && $a->[1] < $b->[3] && $b->[1] < $a->[3];
        }
    }
    is_deeply(\@meeting, [], 'no two words meet');
}
{
    my $path = scratch('picture.png');
    is((bcifs([ 'basis', gallery('takagi'), '-o', $path, '--width', 500 ]))[0], 0, 'png: drawn');
    my $png = file_text($path);
    is(substr($png, 0, 8), "\x89PNG\r\n\x1a\n", 'png: its signature');
    is_deeply([ unpack 'N2', substr $png, 16, 8 ], [ 500, 275 ], 'png: its size');
}

# ---- Options and limits ----------------------------------------------------------------------------------------

for (
    [ [ gallery('chaikin'), '--depth', 2, '--level', 3 ],               2, qr/depth, 2, must be at least the level, 3/ ],
    [ [ gallery('chaikin'), '--depth', 30 ],                            2, qr/more than 16777216 numbers/ ],
    [ [ gallery('chaikin'), '--depth', 30, '--level', 20 ],             2, qr/the limit is 65536/ ],
    [ [ gallery('sierpinski-triangle') ],                               2, qr/blending functions are drawn for curves/ ],
    [ [ gallery('chaikin'), '--format', 'npy' ],                        2, qr/csv, svg or png/ ],
    [ [ gallery('chaikin'), '--state', 'arc', '--figure', 'square' ],   2, qr/exclude each other/ ],
    )
{
    my ($words, $expected, $message) = @$_;
    my ($status, $out, $err) = bcifs([ 'basis', @$words ]);
    is($status, $expected, "basis @$words[1 .. $#$words]: exit status");
    like($err, $message, 'its message');
    is($out, '', 'nothing is written');
}
my $broken = scratch(undef, "automaton broken\nvertex v 1 { }\nedge e 2 { start v at 0\n end v at 1\n"
        . " sub e [ 1 1/2; 0 1/2 ]\n sub e [ 1/3 0; 2/3 1 ] }\n");
is((bcifs([ 'basis', $broken, '--state', 'e' ]))[0], 1, 'an automaton whose equations fail is refused');

# A picture can be made again: the automaton's text and the command line travel inside.
{
    my $svg = scratch('provenance.svg');
    my ($status) = bcifs([ 'basis', "$ROOT/automata/chaikin.bcifs", '--state', 'arc', '--depth', 4, '-o', $svg ]);
    is($status, 0, 'a picture of blending functions');
    like(file_text($svg), qr/<bcifs:automaton file="[^"]*chaikin\.bcifs">[^<]*\nautomaton chaikin /, 'holds the automaton');
    like(file_text($svg), qr/<bcifs:command>bcifs basis /, 'and the command line');
}

done_testing;
