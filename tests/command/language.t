#!/usr/bin/env perl
# The language of automata: every construct of its grammar means what the definitions say. Where a thing can be
# written in two ways, random ones are written in both and compared: as the JSON of check, and as evaluated points.
use strict;
use warnings;
use utf8;
use FindBin;
use lib "$FindBin::Bin/lib";
use Bcifs;
use Encode qw(decode_utf8 encode_utf8);
use Fraction;
use List::Util qw(max shuffle sum0);
use Test::More;

binmode $_, ':utf8' for map { Test::More->builder->$_ } qw(output failure_output todo_output);
my $seed = $ENV{BCIFS_SEED} // 20102;
my $EFFORT = $ENV{BCIFS_EFFORT} // 1;
srand $seed;

# ---- Helpers ---------------------------------------------------------------------------------------------------

sub automaton_file { my ($text, $name) = @_; return scratch($name, "automaton test\n$text\n") }

# The points of a figure; options default to --depth 3.
sub evaluate {
    my ($text, @options) = @_;
    my $file = automaton_file($text);
    my ($status, $out, $err) = bcifs([ 'eval', $file, @options ? @options : ('--depth', 3) ]);
    diag("$text\nstatus $status\n$err") if $status;
    return [ points_of($out) ];
}

sub distance {
    my ($a, $b) = @_;
    return 1e300 if @$a != @$b || !@$a;
    my $largest = 0;
    for my $i (0 .. $#$a) {
        return 1e300 if @{ $a->[$i] } != @{ $b->[$i] };
        for my $j (0 .. $#{ $a->[$i] }) { $largest = max($largest, abs($a->[$i][$j] - $b->[$i][$j])) }
    }
    return $largest;
}

sub same_points {
    my ($a, $b, $what) = @_;
    my $gap = distance($a, $b);
    cmp_ok($gap, '<=', 1e-12, $what) or diag("seed $seed");
}

# The states and equations that check reports, without what depends on the layout of the file.
sub judged {
    my ($text, @options) = @_;
    my $json = check_json(automaton_file($text), @options);
    delete @$_{qw(file line)} for @{ $json->{equations} };
    return $json;
}

sub written { my ($rows) = @_; return '[ ' . join('; ', map { join ' ', @$_ } @$rows) . ' ]' }

# A random matrix of fractions whose columns sum to 1, and whose linear part is small.
sub random_map {
    my ($rows, $columns) = @_;
    my @matrix;
    for my $j (0 .. $columns - 1) {
        my $rest = Fraction->new('1');
        for my $i (1 .. $rows - 1) {
            $matrix[$i][$j] = Fraction->new((int(rand 9) - 3) . '/16');
            $rest = $rest - $matrix[$i][$j];
        }
        $matrix[0][$j] = $rest;
    }
    return \@matrix;
}

sub figure_of_cell {
    my ($state, $count, $dimension) = @_;
    my @points = map { [ map { int(rand 21) - 10 } 1 .. $dimension ] } 1 .. $count;
    return "figure f { piece $state at " . join(' ', 0 .. $count - 1) . ' points ' . written(\@points) . ' }';
}

# ---- Maps as rules ---------------------------------------------------------------------------------------------

# c·p[i] in one of the ways to write it.
sub term {
    my ($c, $i) = @_;
    my @ways = ("$c*p[$i]", "p[$i]*($c)", "($c)*p[$i]", "2*($c)*p[$i]/2", "p[$i]*$c", "($c*(p[$i]))", "-(0-$c)*p[$i]");
    return $ways[ rand @ways ];
}

sub as_rules {
    my ($map) = @_;
    my @rules;
    for my $j (shuffle 0 .. $#{ $map->[0] }) {
        my @terms = map { term($map->[$_][$j], $_) } shuffle grep { $map->[$_][$j] != 0 } 0 .. $#$map;
        push @rules, "q[$j] = " . (@terms ? join(' + ', @terms) : '0*p[0]');
    }
    return "{\n" . join(rand() < 0.5 ? "\n" : '  ', @rules) . "\n}";
}

for my $round (1 .. 6 * $EFFORT) {
    my ($a, $b) = (2 + int rand 4, 2 + int rand 4);
    my %maps = (aa => random_map($a, $a), ab => random_map($a, $b), ba => random_map($b, $a));
    my $figure = figure_of_cell('a', $a, 2);
    my $text = sub {
        my ($write) = @_;
        return "cell a $a { sub a " . $write->($maps{aa}) . ' sub b ' . $write->($maps{ab}) . " }\n"
            . "cell b $b { sub a " . $write->($maps{ba}) . " }\n$figure";
    };
    my ($matrices, $rules) = ($text->(\&written), $text->(\&as_rules));
    is_deeply(judged($rules), judged($matrices), "rules and matrices, $round: the same report");
    same_points(evaluate($rules), evaluate($matrices), "rules and matrices, $round: the same points");
}

# Chaikin by rules is Chaikin by matrices.
my $chaikin_points = 'figure f { open arc points [ 0 0; 1 3; 4 4; 5 0 ] }';
my $chaikin = "vertex v 2 { sub v [ 3/4 1/4; 1/4 3/4 ] }\nedge arc 3 { start v at 0 1 end v at 1 2\n"
    . " sub arc [ 3/4 1/4 0; 1/4 3/4 3/4; 0 0 1/4 ]\n sub arc [ 1/4 0 0; 3/4 3/4 1/4; 0 1/4 3/4 ] }\n";
{
    my $rules = <<'END';
vertex v 2 { sub v { for i in 0..1 { q[i] = sum(k in 0..1, (3-2*abs(k-i))/4*p[k]) } } }
edge arc 3 {
  start v at 0 1
  end   v at 1 2
  sub arc { q[0] = 3/4*p[0] + 1/4*p[1]  q[1] = 1/4*p[0] + 3/4*p[1]  q[2] = 3/4*p[1] + 1/4*p[2] }
  sub arc { for k in 0..2 { q[k] = sum(i in 0..1, (1+2*((i+k)%2))/4*p[(k+k%2)/2+i]) } }
}
END
    is_deeply([ map { $_->[0] } @{ evaluate("$chaikin$chaikin_points", '--depth', 1, '--show', 'control') } ],
        [ 0.25, 0.75, 1.75, 3.25, 4.25, 4.75 ], 'Chaikin: the first control polygon by hand');
    same_points(evaluate("$chaikin$chaikin_points", '--depth', 0, '--show', 'control'), [ [ 0, 0 ], [ 1, 3 ], [ 4, 4 ], [ 5, 0 ] ],
        'the control points of level 0 are those of the figure');
    is_deeply(judged("$rules$chaikin_points"), judged("$chaikin$chaikin_points"), 'loops, sums and remainders: the same report');
    same_points(evaluate("$rules$chaikin_points"), evaluate("$chaikin$chaikin_points"), 'loops, sums and remainders: the same points');
}

# Empty ranges, nested ranges, ranges that depend on an outer index, an index that hides a param.
{
    my $text = <<'END';
param i = 7
param n = 4
cell c n {
  sub c {
    for k in 3..2 { q[99] = p[99] }
    for i in 0..n-1 { q[i] = sum(j in i..i, p[j]) / 2 + sum(j in 1..0, p[j]) + sum(j in 0..n-1, sum(k in j..j, p[k]/(2*n))) }
  }
}
END
    my $explicit = 'cell c 4 { sub c [ 5/8 1/8 1/8 1/8; 1/8 5/8 1/8 1/8; 1/8 1/8 5/8 1/8; 1/8 1/8 1/8 5/8 ] }';
    my $figure = figure_of_cell('c', 4, 3);
    same_points(evaluate("$text$figure"), evaluate("$explicit$figure"), 'ranges');
    is((bcifs([ 'check', automaton_file("$text$figure") ]))[0], 0, 'an empty loop does nothing');
}

# ---- Masks and refinement matrices -----------------------------------------------------------------------------

# T_i and T^s of T_÷, with Δ = m_a - m_s: columns iΔ … iΔ + m_a - 1 and the corner m_s × m_s.
sub explicit_edge {
    my ($whole, $n, $joint) = @_;
    my $m = @$whole;
    my $step = $m - $joint;
    my @corner = map { [ @{ $whole->[$_] }[ 0 .. $joint - 1 ] ] } 0 .. $joint - 1;
    my $text = "vertex joint $joint { sub joint " . written(\@corner) . " }\nedge arc $m {\n";
    $text .= '  start joint at ' . join(' ', 0 .. $joint - 1) . "\n  end joint at " . join(' ', $step .. $m - 1) . "\n";
    for my $i (0 .. $n - 1) {
        $text .= '  sub arc ' . written([ map { [ @$_[ $i * $step .. $i * $step + $m - 1 ] ] } @$whole ]) . "\n";
    }
    return "$text}\n";
}

# The cubic B-spline, T_i[j][j'] = c[i + N(m_a-1-j) - (m_a-1-j')], c = (1 4 6 4 1)/8, m_a = 4, by hand.
{
    my $mask = "edge arc { mask 2 [ 1/8 1/2 3/4 1/2 1/8 ] }\n";
    my $hand = <<'END';
vertex joint 3 { sub joint [ 1/2 1/8 0; 1/2 3/4 1/2; 0 1/8 1/2 ] }
edge arc 4 {
  start joint at 0 1 2
  end joint at 1 2 3
  sub arc [ 1/2 1/8 0 0; 1/2 3/4 1/2 1/8; 0 1/8 1/2 3/4; 0 0 0 1/8 ]
  sub arc [ 1/8 0 0 0; 3/4 1/2 1/8 0; 1/8 1/2 3/4 1/2; 0 0 1/8 1/2 ]
}
END
    my $refine = "edge arc { refine 2 [ 1/2 1/8 0 0 0; 1/2 3/4 1/2 1/8 0; 0 1/8 1/2 3/4 1/2; 0 0 0 1/8 1/2 ] }\n";
    my $figure = 'figure f { open arc points [ 0 0; 1 4; 4 5; 7 4; 8 0; 9 9 ] }';
    for my $what ([ 'mask', $mask ], [ 'refine', $refine ]) {
        for my $show (qw(limit control)) {
            same_points(evaluate("$what->[1]$figure", '--depth', 3, '--show', $show),
                evaluate("$hand$figure", '--depth', 3, '--show', $show), "cubic B-spline by $what->[0] and by hand: $show");
        }
    }
    # A uniform cubic B-spline's point at a knot: (P0 + 4 P1 + P2)/6.
    my $first = evaluate("$mask$figure", '--depth', 0)->[0];
    cmp_ok(abs($first->[0] - 8 / 6) + abs($first->[1] - 21 / 6), '<', 1e-12, 'its first point is (P0 + 4 P1 + P2)/6');
    my $json = judged("$mask$figure");
    is_deeply([ map { $_->{points} } sort { $a->{name} cmp $b->{name} } @{ $json->{states} } ], [ 4, 3 ], 'm_a = 4, m_s = 3');
}

for my $round (1 .. 8 * $EFFORT) {
    # A random mask for N children: the coefficients of every residue class sum to 1.
    my ($n, $length) = (2 + int rand 3);
    $length = $n + 1 + int rand 8;
    my @c = map { Fraction->new((int(rand 13) - 3) . '/16') } 1 .. $length;
    for my $class (0 .. $n - 1) {
        my @members = grep { $_ % $n == $class } 0 .. $length - 1;
        my $sum = Fraction->new('0');
        $sum = $sum + $c[$_] for @members[ 1 .. $#members ];
        $c[ $members[0] ] = 1 - $sum;
    }
    my $m = int(($length - 1 + $n - 2) / ($n - 1));
    my @whole; # column i + j' is column j' of T_i
    for my $i (0 .. $n - 1) {
        for my $j (0 .. $m - 1) {
            for my $k (0 .. $m - 1) {
                my $index = $i + $n * ($m - 1 - $j) - ($m - 1 - $k);
                $whole[$j][ $i + $k ] = $index >= 0 && $index < $length ? $c[$index] : 0;
            }
        }
    }
    my $figure = 'figure f { open arc points ' . written([ map { [ int rand 20, int rand 20 ] } 1 .. $m + 2 ]) . ' }';
    my $explicit = explicit_edge(\@whole, $n, $m - 1) . $figure;
    my $mask = "edge arc { mask $n " . written([ \@c ]) . " }\n$figure";
    my $refine = "edge arc { refine $n " . written(\@whole) . " }\n$figure";
    my @reports = map { judged($_) } $explicit, $mask, $refine;
    my @verdicts = map { join ' ', sort map { (my $text = "$_->{kind} $_->{equation} $_->{holds}") =~ s/arc\.joint/joint/; $text } @{ $_->{equations} } } @reports;
    is($verdicts[1], $verdicts[0], "mask $n of $length: the equations of the explicit maps (seed $seed)");
    is($verdicts[2], $verdicts[0], "refine $n of $length: the equations of the explicit maps");
    ok($reports[0]{valid}, "mask $n of $length: a mask satisfies the equations");
    my @options = ('--depth', 2, '--show', 'control');
    my $points = evaluate($explicit, @options);
    same_points(evaluate($mask, @options), $points, "mask $n of $length: the points");
    same_points(evaluate($refine, @options), $points, "refine $n of $length: the points");
}

for my $round (1 .. 5 * $EFFORT) {
    # A random refinement matrix with a step of 1 to 3 that satisfies the equations: the corner T^s, a free middle,
    # and the corner again Δ rows lower in the last m_s columns.
    my ($n, $step, $joint) = (2 + int rand 2, 1 + int rand 3, 1 + int rand 3);
    $joint = $step if $joint > $step; # case 1: joints do not overlap
    my $m = $step + $joint;
    my $columns = $n * $step + $joint;
    my $whole = random_map($m, $columns);
    my $corner = $joint == 1 ? [ [ Fraction->new('1') ] ] : random_map($joint, $joint);
    for my $i (0 .. $m - 1) {
        for my $j (0 .. $joint - 1) {
            $whole->[$i][$j] = $i < $joint ? $corner->[$i][$j] : Fraction->new('0');
            $whole->[$i][ $columns - $joint + $j ] = $i >= $step ? $corner->[ $i - $step ][$j] : Fraction->new('0');
        }
    }
    my $figure = 'figure f { open arc points ' . written([ map { [ int rand 20, int rand 20 ] } 1 .. $m + 2 * $step ]) . ' }';
    my ($refine, $explicit) = ("edge arc $m { refine $n " . written($whole) . " }\n$figure", explicit_edge($whole, $n, $joint) . $figure);
    ok(judged($refine)->{valid}, "refine, Δ = $step, m_s = $joint: valid (seed $seed)");
    my @options = ('--depth', 3, '--show', 'control');
    same_points(evaluate($refine, @options), evaluate($explicit, @options), "refine, Δ = $step, m_s = $joint: the points");
    # The same by rules: q[k] is column k.
    my $rules = "edge arc $m { refine $n " . as_rules($whole) . " }\n$figure";
    same_points(evaluate($rules, @options), evaluate($explicit, @options), "refine by rules, Δ = $step, m_s = $joint: the points");
}

# start and end may be given beside refine.
{
    my $refine = "vertex joint 2 { sub joint [ 3/4 1/4; 1/4 3/4 ] }\n"
        . "edge arc { refine 2 [ 3/4 1/4 0 0; 1/4 3/4 3/4 1/4; 0 0 1/4 3/4 ] start joint at 0 1 end joint at 1 2 }\n$chaikin_points";
    same_points(evaluate($refine), evaluate("$chaikin$chaikin_points"), 'refine with start and end');
    is(judged($refine)->{states}[1]{boundaries}{end}, 'joint', 'its boundaries are the written ones');
}

# ---- Affine states ---------------------------------------------------------------------------------------------

# [A b] moves the frame O, X, Y, …: O goes to b, the j-th axis point to A e_j + b; O's coordinate makes up 1.
for my $round (1 .. 6 * $EFFORT) {
    my $d = 1 + $round % 3;
    my @texts = ("cell c affine $d {", 'cell c ' . ($d + 1) . ' {');
    for my $map (1 .. 3) {
        my @affine = map { [ map { Fraction->new((int(rand 9) - 4) . '/16') } 0 .. $d ] } 1 .. $d;
        my @columns = ([ map { $_->[$d] } @affine ], map { my $j = $_; [ map { $_->[$j] + $_->[$d] } @affine ] } 0 .. $d - 1);
        my @barycentric = ([ map { my $rest = Fraction->new('1'); $rest = $rest - $_ for @$_; $rest } @columns ]);
        for my $i (0 .. $d - 1) { push @barycentric, [ map { $_->[$i] } @columns ] }
        $texts[0] .= ' sub c ' . written(\@affine);
        $texts[1] .= ' sub c ' . written(\@barycentric);
    }
    my $own = figure_of_cell('c', $d + 1, 3);
    my @frame = map { my $i = $_; [ map { $i == $_ ? 1 : 0 } 1 .. $d ] } 0 .. $d;
    my $unit = 'figure u { piece c at ' . join(' ', 0 .. $d) . ' points ' . written(\@frame) . ' }';
    my $bare = 'figure u { piece c at ' . join(' ', 0 .. $d) . ' }';
    same_points(evaluate("$texts[0] }\n$own"), evaluate("$texts[1] }\n$own"), "affine $d: moved by control points (seed $seed)");
    same_points(evaluate("$texts[0] }\n$bare"), evaluate("$texts[1] }\n$unit"), "affine $d: points default to the unit frame");
    same_points(evaluate("$texts[0] }", '--state', 'c', '--depth', 3), evaluate("$texts[1] }\n$unit"), "affine $d: --state needs no figure");
    my @reports = map { judged("$_ }\n$own") } @texts;
    is_deeply($reports[0]{states}, $reports[1]{states}, "affine $d: the same states");
    is($reports[0]{contraction}{lower}, $reports[1]{contraction}{lower}, "affine $d: the same contraction");
}
# x -> x/2 + 1/2 on the unit frame: the fixed point is 1, the image of 0 is 1/2.
is_deeply(evaluate("cell c affine 1 { sub c [ 1/2 1/2 ] }", '--state', 'c', '--depth', 1, '--show', 'control'), [ [0.5], [1] ], 'affine 1 by hand');

# ---- Numbers, names, lets and params ---------------------------------------------------------------------------

# Values of expressions: they become control points and are printed back.
sub values_of {
    my ($head, @expressions) = @_;
    my $rows = join "\n", map { "  $_" } @expressions, '0';
    my $points = evaluate("$head\nvertex v 1 { }\nedge line 2 { start v at 0 end v at 1 sub line [ 1 1/2; 0 1/2 ] sub line [ 1/2 0; 1/2 1 ] }\n"
        . "figure f { open line points [\n$rows ] }", '--depth', 0, '--show', 'control');
    return map { $_->[0] } @$points[ 0 .. $#expressions ];
}

my $head = <<'END';
param w = 3/2
param h = 2*w + 1
let half(u) = u/2
let mean(u, v) = (u + v)/2
let three = 3
let later(u) = much_later(u) + three
let much_later(u) = u*u
let shadow(w) = w + h
END
my @cases = (
    # expression, value
    [ '12', 12 ], [ '0.5', 0.5 ], [ '.5', 0.5 ], [ '1e-3', 0.001 ], [ '2E+2', 200 ], [ '1.25e2', 125 ], [ '007', 7 ],
    [ '3/4', 0.75 ], [ '1-2-3', -4 ], [ '8/4/2', 1 ], [ '2*3+4*5', 26 ], [ '2+3*4', 14 ], [ '(2+3)*4', 20 ],
    [ '2^10', 1024 ], [ '2^3^2', 512 ], [ '-2^2', -4 ], [ '(-2)^2', 4 ], [ '2^-1', 0.5 ], [ '4^(1/2)', 2 ], [ '2*-3', -6 ],
    [ '--3', 3 ], [ '+3', 3 ], [ '3--2', 5 ], [ '-3%2', 1 ], [ '7%3', 1 ], [ '(-7)%3', 2 ], [ '7%-3', -2 ], [ '5.5%2', 1.5 ], [ '2*7%4', 2 ],
    [ '0^0', 1 ],
    [ 'pi', 3.14159265358979323846 ], [ 'sqrt(2)', sqrt 2 ], [ 'sin(1)', sin 1 ], [ 'cos(1)', cos 1 ], [ 'tan(1)', sin(1) / cos(1) ],
    [ 'exp(1)', exp 1 ], [ 'log(10)', log 10 ], [ 'abs(-3/2)', 1.5 ], [ 'min(2,-3)', -3 ], [ 'max(2,-3)', 2 ],
    [ 'min(max(1,2),3)', 2 ], [ 'sqrt(3)/2', sqrt(3) / 2 ], [ '2*pi', 2 * 3.14159265358979323846 ],
    [ 'w', 1.5 ], [ 'h', 4 ], [ 'half(w)', 0.75 ], [ 'mean(w, h)', 2.75 ], [ 'mean(half(2),three)', 2 ], [ 'later(2)', 7 ],
    [ 'half(half(half(8)))', 1 ], [ 'shadow(10)', 14 ], [ '(1 - w)', -0.5 ], [ '( 1 +  2 )', 3 ], [ "(1 +\n 2)", 3 ], [ 'half( 3 )', 1.5 ],
    [ '1-w', -0.5 ], [ '-w', -1.5 ], [ '3*(w-1)^2', 0.75 ], [ '1e300*1e-300', 1 ],
);
my @found = values_of($head, map { $_->[0] } @cases);
for my $i (0 .. $#cases) {
    my ($expression, $value) = @{ $cases[$i] };
    cmp_ok(abs($found[$i] - $value), '<=', 1e-15 * abs $value, "$expression is $value") or diag($found[$i]);
}

# Random expressions, evaluated here in doubles, too: [text, value, precedence of its outermost operator].
sub random_expression {
    my ($depth) = @_;
    if ($depth == 0 || rand() < 0.15) {
        my @leaves = ([ int rand 10 ], [ '0.' . (1 + int rand 9) ], [ 'w', 1.5 ], [ 'three', 3 ], [ (1 + int rand 9) . 'e-1' ]);
        my $leaf = $leaves[ rand @leaves ];
        return [ $leaf->[0], $leaf->[1] // 0 + $leaf->[0], 9 ];
    }
    my $paren = sub { my ($e, $least) = @_; $e->[2] < $least ? "($e->[0])" : $e->[0] };
    my ($a, $b) = (random_expression($depth - 1), random_expression($depth - 1));
    my $kind = int rand 8;
    return [ $paren->($a, 1) . '+' . $paren->($b, 2), $a->[1] + $b->[1], 1 ] if $kind == 0;
    return [ $paren->($a, 1) . '-' . $paren->($b, 2), $a->[1] - $b->[1], 1 ] if $kind == 1;
    return [ $paren->($a, 2) . '*' . $paren->($b, 3), $a->[1] * $b->[1], 2 ] if $kind == 2;
    return [ $paren->($a, 2) . '/' . $paren->($b, 3), $a->[1] / $b->[1], 2 ] if $kind == 3 && abs $b->[1] > 1e-6;
    return [ '-' . $paren->($a, 3), -$a->[1], 3 ] if $kind == 4;
    return [ "max($a->[0],$b->[0])", $a->[1] > $b->[1] ? $a->[1] : $b->[1], 9 ] if $kind == 5;
    return [ "(" . join(' ', split /(?<=[-+*\/,])(?=\()/, $a->[0]) . ")", $a->[1], 9 ] if $kind == 6;
    return [ $paren->($a, 4 + 1) . '^2', $a->[1] * $a->[1], 4 ];
}
{
    my @expressions = map { random_expression(4) } 1 .. 120 * $EFFORT;
    @expressions = grep { abs $_->[1] < 1e200 } @expressions;
    my @values = values_of($head, map { $_->[0] } @expressions);
    my @wrong = grep { abs($values[$_] - $expressions[$_][1]) > 1e-9 * (1 + abs $expressions[$_][1]) } 0 .. $#expressions;
    is_deeply([ map { "$expressions[$_][0] = $values[$_], should be $expressions[$_][1]" } @wrong ], [], "random expressions (seed $seed)");
}

# White space separates entries; newlines and ; separate rows.
for my $case (
    [ '[ 1-w 2 ]', 2 ], [ '[ 1 -w ]', 2 ], [ '[ 1 -w -2 +3 ]', 4 ], [ '[ (1 - w) ]', 1 ], [ '[ half(w) half (w) 1 ]', undef ],
    [ "[ 1 2\n\n3 4 ]", 2 ], [ '[ 1 2; 3 4; ]', 2 ], [ "[\n 1 2\n 3 4\n]", 2 ], [ "[ 1 2;\n 3 4 ]", 2 ], [ "[1\t2;3 4]", 2 ],
    [ "[ # first\n 1 2 # row\n # between\n\n 3 4 # row\n # last\n]", 2 ], [ '[ mean(1, 2) (3 + 4) ]', 2 ],
) {
    my ($matrix, $columns) = @$case;
    next if !defined $columns;
    my $text = "$head\nvertex v 1 { }\nedge line 2 { start v at 0 end v at 1 sub line [ 1 1/2; 0 1/2 ] sub line [ 1/2 0; 1/2 1 ] }\n";
    my $rows = $matrix =~ /[34] 4/ ? 2 : 1;
    $matrix =~ s/ \]$/; @{[ join ' ', (0) x $columns ]} ]/ if $rows == 1;
    my $points = evaluate("$text\nfigure f { open line points $matrix }", '--depth', 0, '--show', 'control');
    (my $shown = $matrix) =~ s/\n/\\n/g;
    is(scalar @{ $points->[0] }, $columns, "columns of $shown");
    is(scalar @$points, 2, "rows of $shown");
}

# Params: --set, in this file and in used ones; what is set reaches lets, counts and points.
{
    my $text = "param n = 2\nparam w = n/4 in 0..1\ncell c n { sub c { for i in 0..n-1 { q[i] = w*p[i] + (1-w)*p[0] } } }\n"
        . 'figure f { piece c at 0 1 points [ 0; w ] }';
    my $file = automaton_file($text);
    my ($json) = check_json($file);
    is_deeply($json->{parameters}, { n => 2, w => 0.5 }, 'a param may use those above it');
    ($json) = check_json($file, '--set', 'w=1/3+1/3');
    cmp_ok(abs($json->{parameters}{w} - 2 / 3), '<', 1e-15, '--set takes an expression');
    my ($status, $out) = bcifs([ 'eval', $file, '--set', 'w=1/4', '--depth', 0, '--show', 'control' ]);
    is($out, "x\n0\n0.25\n", '--set moves the points');
    ($status) = bcifs([ 'check', $file, '--set', 'w=2' ]);
    is($status, 2, '--set outside the range');
}

# ---- use -------------------------------------------------------------------------------------------------------
{
    my $folder = scratch('used');
    mkdir $folder;
    mkdir "$folder/deep";
    file_write("$folder/line.bcifs", "automaton segments\nparam t = 1/2\nlet other = 1-t\nvertex v 1 { }\n"
        . "edge line 2 { start v at 0 end v at 1 sub line [ 1 other; 0 t ] sub line [ other 0; t 1 ] }\nfigure own { open line points [ 0; 1 ] }\n");
    file_write("$folder/deep/both.bcifs", "automaton both\nuse \"../line.bcifs\" as thin\n"
        . "edge pair 2 { start thin.v at 0 end thin.v at 1 sub thin.line [ 1 1/2; 0 1/2 ] sub pair [ 1/2 0; 1/2 1 ] }\n");
    my $figure = 'figure f { open %s points [ 0 0; 4 1; 5 5 ] }';
    my $main = file_write("$folder/main.bcifs", "automaton main\nuse \"line.bcifs\" as straight\nuse \"line.bcifs\"\nuse \"deep/both.bcifs\"\n"
        . "edge mixed 2 { start straight.v at 0 end straight.v at 1 sub straight.line [ 1 1/2; 0 1/2 ] sub straight.line [ 1/2 0; 1/2 1 ] }\n"
        . join('', map { my $name = $_; $name =~ tr/./_/; sprintf("$figure\n", $_) =~ s/figure f/figure $name/r } qw(mixed straight.line segments.line both.pair)));
    my ($json, $status) = check_json($main);
    is($status, 0, 'used files');
    is_deeply([ sort map { $_->{name} } @{ $json->{states} } ],
        [ sort qw(mixed straight.v straight.line segments.v segments.line both.pair both.thin.v both.thin.line) ],
        'names: as what use says, or the used automaton\'s own name; used files of used files');
    is_deeply([ sort keys %{ $json->{parameters} } ], [ sort qw(straight.t segments.t both.thin.t) ], 'their params');
    my %points;
    for my $name (qw(mixed straight_line segments_line both_pair)) {
        my ($status, $out) = bcifs([ 'eval', $main, '--figure', $name, '--depth', 2 ]);
        $points{$name} = $out;
        is($status, 0, "figure $name of used states");
    }
    is_deeply([ @points{qw(straight_line segments_line both_pair)} ], [ ($points{mixed}) x 3 ], 'all of them are the polygon');
    my (undef, $out) = bcifs([ 'eval', $main, '--figure', 'straight_line', '--depth', 1, '--set', 'straight.t=1/4' ]);
    is($out, "x,y\n0,0\n1,0.25\n4,1\n4.25,2\n5,5\n", '--set NAME.PARAM reaches one use of a file');
    (undef, $out) = bcifs([ 'eval', $main, '--figure', 'segments_line', '--depth', 1, '--set', 'straight.t=1/4' ]);
    is($out, "x,y\n0,0\n2,0.5\n4,1\n4.5,3\n5,5\n", 'and not the other');
    my ($code, undef, $err) = bcifs([ 'eval', $main, '--figure', 'own' ]);
    is($code, 2, 'figures of a used file stay there');
    # From another folder, and with the folder spelled otherwise.
    ($code) = bcifs([ 'check', 'main.bcifs', '--quiet' ], directory => $folder);
    is($code, 0, 'paths are relative to the file, run from its folder');
    ($code) = bcifs([ 'check', "$folder/deep/../main.bcifs", '--quiet' ]);
    is($code, 0, 'paths are relative to the file, run from elsewhere');
}

# ---- Boundaries ------------------------------------------------------------------------------------------------
{
    my $figure = 'figure f { open arc points [ 0 0; 1 2; 3 1; 4 4; 7 0 ] }';
    my $maps = 'sub arc [ 1 1/2 1/4; 0 1/2 1/2; 0 0 1/4 ] sub arc [ 1/4 0 0; 1/2 1/2 0; 1/4 1/2 1 ]';
    my $numbers = "vertex v 1 { }\nedge arc 3 { start v at 0 end v at 2 $maps }\n$figure";
    for my $case (
        [ 'matrices', "edge arc 3 { start v [ 1; 0; 0 ] end v [ 0; 0; 1 ] $maps }" ],
        [ 'bracketed indices', "param n = 3\nedge arc n { start v at [ 0 ] end v at [ n-1 ] $maps }" ],
        [ 'end before start', "edge arc 3 { $maps end v at 2 start v at 0 }" ],
        [ 'without a count', "edge arc { start v at 0 end v at 2 $maps }" ],
        [ 'a vertex with its map written', "edge arc 3 { start v at 0 end v at 2 $maps }", 'vertex v 1 { sub v [ 1 ] }' ],
        [ 'the vertex after the edge', "edge arc 3 { start v at 0 end v at 2 $maps }\nvertex v 1 { }", '' ],
    ) {
        my ($what, $edge, $vertex) = @$case;
        my $text = ($vertex // 'vertex v 1 { }') . "\n$edge\n$figure";
        my ($report, $wanted) = (judged($text), judged($numbers));
        delete @$_{qw(parameters)} for $report, $wanted;
        $_->{states} = [ sort { $a->{name} cmp $b->{name} } @{ $_->{states} } ] for $report, $wanted;
        $_->{equations} = [ sort { "$a->{state}$a->{equation}" cmp "$b->{state}$b->{equation}" } @{ $_->{equations} } ] for $report, $wanted;
        is_deeply($report, $wanted, "boundaries: $what: the same report");
        same_points(evaluate($text), evaluate($numbers), "boundaries: $what: the same points");
    }
}

# ---- Arguments and intervals -----------------------------------------------------------------------------------

my $nonuniform = decode_utf8(file_text("$ROOT/automata/nonuniform-quadratic.bcifs")) =~ s/^automaton.*$//mr =~ s/^figure .*//msr;
{
    my $points = 'points [ 0 0; 1 4; 5 5; 7 1; 10 0 ]';
    my $open = "figure f { open p intervals [ 1 2 1 1/2 3 ] $points }";
    my $pieces = "figure f { piece p(1,2,1) at 0 1 2 piece p(2,1,1/2) at 1 2 3 piece p(1,1/2,3) at 2 3 4 $points }";
    same_points(evaluate("$nonuniform$open"), evaluate("$nonuniform$pieces"), 'intervals: piece i takes intervals i, i+1, i+2');
    my $closed = "figure f { closed p intervals [ 1 2 3 4 5 ] $points }";
    $pieces = "figure f { piece p(1,2,3) at 0 1 2 piece p(2,3,4) at 1 2 3 piece p(3,4,5) at 2 3 4 piece p(4,5,1) at 3 4 0 piece p(5,1,2) at 4 0 1 $points }";
    same_points(evaluate("$nonuniform$closed"), evaluate("$nonuniform$pieces"), 'intervals of a closed curve wrap');
    # The knots of figure f are where it touches side i, at u/(u+v) of it: [SI].
    my $first = evaluate("$nonuniform$open", '--depth', 0);
    my @sides = ([ 0, 0, 1, 4, 1, 2 ], [ 1, 4, 5, 5, 2, 1 ], [ 5, 5, 7, 1, 1, 1 / 2 ], [ 7, 1, 10, 0, 1 / 2, 3 ]);
    same_points($first, [ map { my ($x, $y, $X, $Y, $u, $v) = @$_; my $t = $u / ($u + $v); [ $x + $t * ($X - $x), $y + $t * ($Y - $y) ] } @sides ],
        'the curve touches each side at the fraction u/(u+v)');
    my $equal = 'figure f { open p intervals [ 2 2 2 2 ] points [ 0 0; 1 3; 4 4; 5 0 ] }';
    same_points(evaluate("$nonuniform$equal"), evaluate("$chaikin$chaikin_points"), 'equal intervals: Chaikin');
    my $written = 'figure f { open p(1,2,1) points [ 0 0; 1 3; 4 4 ] }';
    same_points(evaluate("$nonuniform$written"), evaluate("${nonuniform}figure f { open p intervals [ 1 2 1 ] points [ 0 0; 1 3; 4 4 ] }"), 'arguments written in the figure');
}

# Counts that depend on arguments: a ring of n points that shrinks to its center, for any n.
{
    my $ring = <<'END';
cell ring(n) n {
  sub ring(n) { for i in 0..n-1 { q[i] = 1/2*p[i] + sum(j in 0..n-1, p[j])/(2*n) } }
  sub ring(n) { for i in 0..n-1 { q[i] = 1/2*p[i] + 1/2*p[(i+1)%n] } }
}
END
    for my $n (1, 2, 5, 12) {
        my @points = map { [ int rand 20, int rand 20 ] } 1 .. $n;
        my $figure = sub { "figure f { piece $_[0] at " . join(' ', 0 .. $n - 1) . ' points ' . written(\@points) . ' }' };
        my (@first, @second);
        for my $i (0 .. $n - 1) {
            for my $j (0 .. $n - 1) {
                $first[$j][$i] = Fraction->new(1 . '/' . 2 * $n) + ($i == $j ? Fraction->new('1/2') : 0);
                $second[$j][$i] = Fraction->new(($i == $j ? 1 : 0) + (($i + 1) % $n == $j ? 1 : 0) . '/2');
            }
        }
        my $explicit = "cell c $n { sub c " . written(\@first) . ' sub c ' . written(\@second) . " }\n";
        same_points(evaluate($ring . $figure->("ring($n)")), evaluate($explicit . $figure->('c')), "a count that is an argument: $n points");
        my ($state) = grep { $_->{name} =~ /^ring\b/ } @{ judged($ring . $figure->("ring($n)"))->{states} };
        is($state->{points}, $n, "a count that is an argument: check sees $n points");
    }
    # Arguments that count: a chain of n edges as one edge, its last child reached by n-1.
    my $chain = <<'END';
vertex v 1 { }
edge line 2 { start v at 0 end v at 1 sub line [ 1 1/2; 0 1/2 ] sub line [ 1/2 0; 1/2 1 ] }
edge poly(n) n { start v at 0 end v at [ n-1 ]
  sub line { q[0] = p[0]  q[1] = p[1] }
  sub poly(max(2,n-1)) { for i in 0..max(2,n-1)-1 { q[i] = (n-2)/max(1,n-2)*p[min(i+1,n-1)] + (1-(n-2)/max(1,n-2))*(p[0]+p[1])/2*(1-i) + (1-(n-2)/max(1,n-2))*i*p[1] } }
}
END
    my $text = "$chain figure f { open poly(4) points [ 0 0; 1 5; 2 2; 3 0 ] }";
    my $json = judged($text);
    my %sizes = map { $_->{points} => 1 } grep { $_->{name} =~ /^poly\b/ } @{ $json->{states} };
    is_deeply([ sort keys %sizes ], [ 2, 3, 4 ], 'counts that shrink along the children: every size that is reached');
}

# ---- Surfaces and products -------------------------------------------------------------------------------------
{
    my $edges = "vertex v 1 { }\nvertex pair 2 { sub pair [ 3/4 1/4; 1/4 3/4 ] }\n"
        . "edge a 3 { start pair at 0 1 end pair at 1 2 sub a [ 3/4 1/4 0; 1/4 3/4 3/4; 0 0 1/4 ] sub a [ 1/4 0 0; 3/4 3/4 1/4; 0 1/4 3/4 ] }\n"
        . "edge b 2 { start v at 0 end v at 1 sub b [ 1 1/3; 0 2/3 ] sub b [ 1/3 1/6; 2/3 5/6 ] sub b [ 1/6 0; 5/6 1 ] }\n";
    my $json = judged("$edges face f = a * b");
    ok($json->{valid}, 'a product of valid edges is valid');
    my %states = map { $_->{name} => $_ } @{ $json->{states} };
    is($states{f}{points}, 6, 'm = 3 · 2');
    is($states{f}{kind}, 'face', 'a product of edges is a face');
    is(scalar @{ $states{f}{children} }, 6, '2 · 3 maps');
    is(scalar keys %{ $states{f}{boundaries} }, 4, 'four boundaries');
    my %kinds;
    $kinds{ $states{$_}{kind} }++ for values %{ $states{f}{boundaries} };
    is_deeply(\%kinds, { edge => 4 }, 'which are edges');
    ok(!grep({ !$_->{exact} } @{ $json->{equations} }), 'exactly');

    # T_{i,j} = T^a_i ⊗ T^b_j in the order of i, then j: the sums of columns multiply.
    my (@a, @b);
    my $edge = sub {
        my ($name, $points, $count, $sums) = @_;
        my @vertex = $points == 2 ? ('v', 0, 1) : ('v', 0, 2);
        my $text = "edge $name $points { start v at 0 end v at $vertex[2]";
        for my $i (0 .. $count - 1) {
            my $map = random_map($points, $points);
            for my $j (0 .. $points - 1) {
                my $more = Fraction->new(int(rand 9) - 4);
                $map->[ rand $points ][$j] += $more;
                $sums->[$i][$j] = 1 + $more;
            }
            $text .= ' sub ' . $name . ' ' . written($map);
        }
        return "$text }\n";
    };
    my $text = "vertex v 1 { }\n" . $edge->('a', 3, 2, \@a) . $edge->('b', 2, 3, \@b) . "face f = a * b\n";
    my %equations = map { ("$_->{state} $_->{equation}" => $_) } @{ judged($text)->{equations} };
    my @wrong;
    for my $i (0 .. 1) {
        for my $j (0 .. 2) {
            my @sums = map { my $x = $_; map { 0 + $x * $_ } @{ $b[$j] } } @{ $a[$i] };
            my $equation = $equations{ 'f 1·T' . (3 * $i + $j) . ' = 1' };
            my @shown = $equation->{left} ? @{ $equation->{left}[0] } : (1) x 6;
            push @wrong, "T$i,$j: @shown, should be @sums" if grep { abs($shown[$_] - $sums[$_]) > 1e-12 } 0 .. $#sums;
        }
    }
    is_deeply(\@wrong, [], "the maps of a product are Kronecker products, the first factor's index slowest (seed $seed)");

    # Figures of surfaces bind: open and closed in two directions, sizes, and the count of points.
    for my $case (
        [ 'open a open b size 4 3', 12 ], [ 'closed a open b size 4 2', 8 ], [ 'open a closed b size 3 3', 9 ],
        [ 'closed a closed a size 4 4', 16 ], [ 'open b open b size 2 5', 10 ], [ 'open b open b size 2 5', 9, 2 ],
        [ 'open a open a size 2 5', 10, 2 ],
    ) {
        my ($parts, $count, $wanted) = @$case;
        my $figure = "figure s { $parts points " . written([ map { [ $_, 0, 0 ] } 1 .. $count ]) . ' }';
        my ($status) = bcifs([ 'check', automaton_file("$edges$figure"), '--quiet' ]);
        is($status, $wanted // 0, "a surface: $parts, $count points");
    }
    my $surface = automaton_file("$edges figure s { open a open b size 3 2 points [ 0 0 0; 0 1 0; 1 0 0; 1 1 1; 2 0 0; 2 1 0 ] displace 1 0 1 [ 0 0 1 ] }");
    is((bcifs([ 'check', $surface, '--quiet' ]))[0], 0, 'displace on a surface takes two indices');

    # A product with arguments, and intervals in both directions.
    my $both = "${nonuniform}face q = p * p\nfigure s { open p open p intervals [ 1 2 1 1/2 ] intervals [ 3 1 2 ] size 4 3 points " . written([ map { [ $_, $_ % 3, 1 ] } 1 .. 12 ]) . ' }';
    my ($status, $out, $err) = bcifs([ 'check', automaton_file($both), '--quiet' ]);
    is("$status$err", '0', 'products of states with arguments; intervals in both directions');
    my $some = "${nonuniform}face q = p(1,2,1) * p(1,1,1)\n";
    is((bcifs([ 'check', automaton_file($some), '--quiet' ]))[0], 0, 'products of states with arguments written');
}

# ---- Unknown entries -------------------------------------------------------------------------------------------
{
    my $text = "vertex v 1 { }\nedge arc 3 {\n  start v at 0\n  end v at 2\n  sub arc [ 1 ? ?; 0 1/2 1/2; 0 ? 1/4 ]\n  sub arc [ 1/4 0 0; 1/2 1/2 0; 1/4 1/2 1 ]\n}\nfigure f { open arc points [ 0 0; 1 2; 2 0 ] }";
    my $file = automaton_file($text);
    for my $command (qw(check eval)) {
        my ($status, $out, $err) = bcifs([ $command, $file ]);
        is($status, 2, "$command of unknown entries: exit status 2");
        is($out, '', "$command of unknown entries: no output");
        like($err, qr/error: .*3 unknown entries/, "$command of unknown entries: says so");
    }
    my ($status, $out) = bcifs([ 'fmt', $file ]);
    is($status, 0, 'fmt prints unknown entries');
    is(scalar(() = $out =~ /\?/g), 3, 'all of them');
    # Shapes and names are checked before.
    ($status, undef, my $err) = bcifs([ 'check', automaton_file("vertex v 2 { sub v [ ? ?; ? w ] }") ]);
    like($err, qr/unknown name 'w'/, 'names beside unknown entries are looked up');
    ($status, undef, $err) = bcifs([ 'check', automaton_file("vertex v 2 { sub v [ ? ? ] }") ]);
    like($err, qr/must be 2 × 2|must be 2 \xc3\x97 2/, 'the shape of a matrix of unknown entries is checked');
}

# ---- Order, layout and characters ------------------------------------------------------------------------------

# Items of a file in random order; params keep theirs, for they may use those above.
sub items_of {
    my ($text) = @_;
    $text =~ s/#.*//g;
    my ($head, @items) = split /^(?=(?:use|param|let|vertex|edge|face|cell|wavelet|figure)\b)/m, $text;
    return ($head, @items);
}
for my $name (qw(chaikin nonuniform-quadratic dragon two-motifs takagi cantor)) {
    my $text = decode_utf8(file_text("$ROOT/automata/$name.bcifs"));
    my ($figure) = $text =~ /^figure (\w+)/m;
    my ($head, @items) = items_of($text);
    my $shuffled = join "\n", $head, shuffle @items;
    my ($file, $mixed) = (scratch(undef, encode_utf8($text)), scratch(undef, encode_utf8($shuffled)));
    my @reports = map { scalar check_json($_) } $file, $mixed;
    for (@reports) {
        delete @$_{qw(file line)} for @{ $_->{equations} };
        $_->{states} = { map { $_->{name} => $_ } @{ $_->{states} } };
        $_->{equations} = { map { ("$_->{state} $_->{equation}" => $_) } @{ $_->{equations} } };
        delete $_->{contraction}{product};
        $_ = sprintf '%.9g', $_ for @{ $_->{contraction} }{qw(lower upper)};
    }
    is_deeply($reports[1], $reports[0], "$name in another order: the same report (seed $seed)");
    my @options = ('--figure', $figure, '--depth', 3);
    is((bcifs([ 'eval', $mixed, @options ]))[1], (bcifs([ 'eval', $file, @options ]))[1], "$name in another order: the same points");
}
{
    my $text = "automaton test\n$chaikin$chaikin_points\n";
    my $wanted = (bcifs([ 'eval', scratch(undef, $text), '--depth', 2 ]))[1];
    (my $commented = $text) =~ s/;/ # end of a row\n\n  # a line\n\n/g;
    my %variants = (
        'comments and blank lines inside matrices' => $commented,
        'Windows line ends' => $text =~ s/\n/\r\n/gr,
        'a byte order mark' => "\xEF\xBB\xBF$text",
        'no newline at the end' => $text =~ s/\n$//r,
        'all on few lines' => $text =~ s/(?<!test)\n/ /gr,
        'tabs' => $text =~ s/ /\t/gr,
        'a title in UTF-8 and comments in UTF-8' => encode_utf8($text =~ s/test/test "Schnörkel — ∞"  # être/r),
        'every token on a line of its own outside brackets' => join('', map { /^\[/ ? $_ : s/[ \n]+/\n/gr } split /(\[[^\]]*\])/, $text),
        'no space around brackets and braces' => $text =~ s/ ?([][{};]) ?/$1/gr,
    );
    for my $what (sort keys %variants) {
        my ($status, $out, $err) = bcifs([ 'eval', scratch(undef, $variants{$what}), '--depth', 2 ]);
        is($out, $wanted, "$what") or diag($err);
    }
    my ($status, $out) = bcifs([ 'eval', '-', '--depth', 2 ], stdin => $text);
    is($out, $wanted, 'from standard input');
    my ($json) = check_json(scratch(undef, 'automaton with_a_Title_2 "A \\ title"' . "\nvertex _v 1 { }"));
    is($json->{automaton}, 'with_a_Title_2', 'the name of the automaton');
    is($json->{states}[0]{name}, '_v', 'names may begin with _');
    like((bcifs([ 'check', scratch(undef, "automaton x \"Title here\"\nvertex v 1 { }") ]))[1], qr/^x: Title here$/m, 'the title is shown');
}

# The words of the grammar are words where it asks for them, and names elsewhere.
{
    my $text = "param mask = 1/2\nparam points = 3\nlet at = 1/2\nvertex sub 1 { }\nedge edge 2 { start sub at 0 end sub at 1 sub edge [ 1 mask; 0 at ] sub edge [ at 0; mask 1 ] }\n"
        . 'figure figure { open edge points [ 0; points; 4 ] }';
    same_points(evaluate($text, '--depth', 1), [ [0], [1.5], [3], [3.5], [4] ], 'words of the grammar as names');
}

# Wavelets are read, and kept out of the way.
{
    my $text = "$chaikin$chaikin_points\nwavelet arc { smooth -2 [ -1/4 3/4 3/4 -1/4 ] detail -2 [ 1/4 -3/4 3/4 -1/4 ] }";
    same_points(evaluate($text), evaluate("$chaikin$chaikin_points"), 'a wavelet does not change the curve');
    my $displaced = automaton_file("$chaikin figure f { open arc points [ 0 0; 1 3; 4 4; 5 0 ] displace 1 2 [ 1 -1 ] }");
    is((bcifs([ 'check', $displaced, '--quiet' ]))[0], 0, 'displace is read and bound');
}

# Which figure: the first, or the named one.
{
    my $text = "$chaikin figure one { open arc points [ 0; 1; 2 ] } figure two { open arc points [ 0; 2; 4 ] }";
    same_points(evaluate($text, '--depth', 0, '--show', 'control'), [ [0], [1], [2] ], 'the first figure');
    same_points(evaluate($text, '--depth', 0, '--show', 'control', '--figure', 'two'), [ [0], [2], [4] ], 'the named figure');
}

done_testing;
