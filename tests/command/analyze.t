#!/usr/bin/env perl
# bcifs analyze: half-tangents and junctions against conditions derived on paper ([SI], the Takagi series, small
# automata made so that each kind of subdominant eigenvalue occurs).
use strict;
use warnings;
use utf8;
use FindBin;
use lib "$FindBin::Bin/lib";
use Bcifs;
use JSON::PP ();
use Test::More;

binmode $_, ':utf8' for map { Test::More->builder->$_ } qw(output failure_output todo_output);

sub analyze {
    my ($file, @options) = @_;
    my ($status, $out, $err) = bcifs(['analyze', $file, '--json', '--quiet', @options]);
    return $status == 0 ? JSON::PP::decode_json($out) : { status => $status, err => $err };
}

sub near { my ($a, $b, $tolerance) = @_; abs($a - $b) <= ($tolerance // 1e-9) }

sub vector_near {
    my ($found, $wanted, $tolerance) = @_;
    return 0 unless $found && @$found == @$wanted;
    near($found->[$_], $wanted->[$_], $tolerance) || return 0 for 0 .. $#$wanted;
    return 1;
}

my $half = sqrt(1 / 2);

# ---- Chaikin: the curve touches the middle of each leg of its polygon, along the leg ----------------------------
{
    my $edge = analyze("$ROOT/automata/chaikin.bcifs")->{edges}[0];
    ok(vector_near($edge->{start}{point}, [0.5, 0.5, 0]), 'Chaikin starts at the middle of the first leg');
    ok(vector_near($edge->{start}{tangent}, [-$half, $half, 0]), 'along it');
    ok(vector_near($edge->{end}{tangent}, [0, -$half, $half]), 'and ends along the second');
    ok(near($edge->{start}{eigenvalue}, 0.5), 'the subdominant eigenvalue is 1/2');
    ok(vector_near($edge->{maps}[0]{eigenvalues}, [1, 0.5, 0.25]), 'eigenvalues of T0');
    ok($edge->{junctions}[0]{tangent_continuous} && $edge->{tangent_continuous}, 'tangent continuous');
    ok(vector_near($edge->{junctions}[0]{left}, $edge->{junctions}[0]{right}, 1e-6), 'both sides agree');
}

# ---- Corner cutting, [SI]: tangent continuous exactly when 1 - 2a - b >= 0 and 1 - a - 2b >= 0 ---------------------
{
    my @wrong;
    for my $i (1 .. 11) {
        for my $j (1 .. 11 - $i) {
            my $json = analyze("$ROOT/automata/corner-cutting.bcifs", '--set', "a=$i/12", '--set', "b=$j/12");
            my $found = $json->{edges}[0]{tangent_continuous} ? 1 : 0;
            my $wanted = 12 - 2 * $i - $j >= 0 && 12 - $i - 2 * $j >= 0 ? 1 : 0;
            push @wrong, "a=$i/12 b=$j/12" if $found != $wanted;
        }
    }
    is("@wrong", '', 'corner cutting meets the slides\' conditions on a grid, their boundary included');
    my $edge = analyze("$ROOT/automata/corner-cutting.bcifs", '--set', 'a=1/3', '--set', 'b=1/3')->{edges}[0];
    ok($edge->{tangent_continuous}, 'a = b = 1/3: a defective eigenvalue, tangent continuous');
    ok(near($edge->{maps}[0]{eigenvalues}[1], 1 / 3, 1e-6), 'its eigenvalue is shown as a real number');
    # The eigenvector of T0 for a is (-b, 1-2a, 2a+b-1) (the slides list those of T1 first): where a is subdominant
    # it is the half-tangent, up to its sign.
    my ($a, $b) = (0.4, 0.3);
    my @v = (-$b, 1 - 2 * $a, 2 * $a + $b - 1);
    my $length = sqrt($v[0]**2 + $v[1]**2 + $v[2]**2);
    $edge = analyze("$ROOT/automata/corner-cutting.bcifs", '--set', "a=$a", '--set', "b=$b")->{edges}[0];
    my $tangent = $edge->{start}{tangent};
    my $sign = $tangent && $tangent->[0] * $v[0] < 0 ? -1 : 1;
    ok(vector_near($tangent, [map { $sign * $_ / $length } @v]), 'a = 0.4, b = 0.3: the slides\' eigenvector');
}

# ---- Eigenvectors: those the slides print ([SI], "Etude des valeurs et vecteurs propres"; T1's come first there) -----
{
    my ($p, $q) = (1 / 3, 1 / 4);
    my $json = analyze("$ROOT/automata/corner-cutting.bcifs", '--set', 'a=1/3', '--set', 'b=1/4');
    my @printed = (
        { 1 => [$q / ($p + $q), $p / ($p + $q), 0], joint => [1, -1, 0], own => [-$q, 1 - 2 * $p, 2 * $p + $q - 1] },
        { 1 => [0, $q / ($p + $q), $p / ($p + $q)], joint => [0, 1, -1], own => [$p + 2 * $q - 1, 1 - 2 * $q, -$p] },
    );
    my @wrong;
    for my $map (0, 1) {
        my $found = $json->{edges}[0]{maps}[$map];
        my %value = (1 => 1, joint => 1 - $p - $q, own => $map ? $q : $p);
        for my $name (sort keys %value) {
            my ($k) = grep { near($found->{eigenvalues}[$_], $value{$name}) } 0 .. 2;
            my $vector = defined $k ? $found->{eigenvectors}[$k] : undef;
            my $wanted = $printed[$map]{$name};
            # The fixed point sums to 1; directions are compared up to their length and sign.
            my ($pivot) = sort { abs($wanted->[$b]) <=> abs($wanted->[$a]) } 0 .. 2;
            my $scale = $vector ? $vector->[$pivot] / $wanted->[$pivot] : 0;
            push @wrong, "T$map $name" if !vector_near($vector, [map { $scale * $_ } @$wanted])
                || ($name eq '1' && !near($scale, 1));
        }
    }
    is("@wrong", '', 'the eigenvectors of corner cutting are those of the slides');
    my $joint = $json->{joints}[0];
    is($joint->{state}, 'joint', 'its joint is analyzed, too');
    ok(vector_near($joint->{point}, [$q / ($p + $q), $p / ($p + $q)]), 'with its limit point');
    ok(vector_near($joint->{eigenvalues}, [1, 1 - $p - $q]), 'its eigenvalues');
    ok(vector_near($joint->{eigenvectors}[1], [$half, -$half]), 'and eigenvectors');
}

# ---- Takagi: the curve is the graph of F(t) = Σ w^n s(2^n t) over the chord; F' jumps unless Σ (2w)^n = 1, n >= 1 ----
{
    my @wrong;
    for my $w ('1/8', '3/16', '1/4', '5/16', '3/8', '7/16') {
        my $json = analyze("$ROOT/automata/takagi.bcifs", '--set', "w=$w");
        push @wrong, $w if !!$json->{edges}[0]{tangent_continuous} != !!($w eq '1/4');
    }
    is("@wrong", '', 'of the Takagi family with w < 1/2 only w = 1/4, the Bézier arc, is tangent continuous');
    # With slope F'(0) = Σ (2w)^n in units of 2d per chord: the tangent is chord + F'(0)·(displacement direction).
    my $w = 3 / 8;
    my $edge = analyze("$ROOT/automata/takagi.bcifs", '--set', "w=$w")->{edges}[0];
    my $slope = 1 / (1 - 2 * $w);
    my @v = (-1 - $slope / 2, $slope, 1 - $slope / 2);
    my $length = sqrt($v[0]**2 + $v[1]**2 + $v[2]**2);
    ok(vector_near($edge->{start}{tangent}, [map { $_ / $length } @v]), 'w = 3/8: the slope is Σ (2w)^n');
    my @vertical = map { $_ / sqrt(6) } -1, 2, -1;
    for my $steep ('1/2', '3/4') {
        $edge = analyze("$ROOT/automata/takagi.bcifs", '--set', "w=$steep")->{edges}[0];
        ok(vector_near($edge->{start}{tangent}, \@vertical, 1e-6), "w = $steep: the half-tangent is vertical");
        ok(!$edge->{tangent_continuous}, "w = $steep: and turns back at the middle");
    }
}

# ---- Each kind of eigenvalue: arcs of three points on joints of one, T0 = [1 s0 t0; 0 s1 t1; 0 s2 t2] --------------
sub three_points {
    my ($s1, $s2, $t1, $t2) = @_;
    my ($s0, $t0) = ("(1-($s1)-($s2))", "(1-($t1)-($t2))");
    return scratch(undef, <<"FILE");
automaton three
vertex end 1 { }
edge arc 3 {
  start end at 0
  end end at 2
  sub arc [ 1 $s0 $t0; 0 $s1 $t1; 0 $s2 $t2 ]
  sub arc [ $t0 1/4 0; $t1 1/4 0; $t2 1/2 1 ]
}
FILE
}

my @kinds = (
    ['negative', ['(-1/2)', '0', '1/2', '1/4'], qr/negative/],
    ['complex', ['1/4', '1/4', '(-1/4)', '1/4'], qr/spiral.* 45 degrees/],
    ['tied', ['1/2', '0', '1/4', '(-1/2)'], qr/same modulus/],
);
for my $kind (@kinds) {
    my ($name, $entries, $reason) = @$kind;
    my $edge = analyze(three_points(@$entries))->{edges}[0];
    ok($edge && !$edge->{start}{tangent} && $edge->{start}{reason} =~ $reason, "$name: no half-tangent, and why")
        or diag($edge->{start}{reason} // 'no answer');
}

# ---- A subdominant eigenvalue that no difference of points has a part in: a straight arc and an idle third point ----
{
    my $edge = analyze(scratch(undef, <<'FILE'))->{edges}[0];
automaton idle
vertex end 1 { }
edge arc 3 {
  start end at 0
  end end at 1
  sub arc [ 1 1/2 1/10; 0 1/2 0; 0 0 9/10 ]
  sub arc [ 1/2 0 0; 1/2 1 1/10; 0 0 9/10 ]
}
FILE
    ok(near($edge->{maps}[0]{eigenvalues}[1], 0.9), 'the subdominant eigenvalue of T0 is 9/10');
    ok(near($edge->{start}{eigenvalue}, 0.5), 'the one that moves the arc is 1/2');
    ok(vector_near($edge->{start}{tangent}, [-$half, $half, 0]), 'and the half-tangent is the chord');
    ok($edge->{tangent_continuous}, 'a straight arc is tangent continuous');
}

# ---- Fractal arcs, several states -------------------------------------------------------------------------------
{
    my $koch = analyze("$ROOT/automata/koch.bcifs")->{edges}[0];
    # Its T0 scales by 1/3: the arc is its own magnification.
    like($koch->{start}{reason}, qr/several eigenvectors/, 'the Koch arc looks alike at every scale');
    ok(!$koch->{start}{tangent} && !$koch->{tangent_continuous}, 'and has no half-tangent');
    my $coil = (grep { $_->{state} eq 'coil' } @{ analyze("$ROOT/automata/spiral.bcifs")->{edges} })[0];
    like($coil->{start}{reason}, qr/ 60 degrees.* 0\.7$/, 'the coil turns by 60 degrees and shrinks by 7/10');
    my @edges = @{ analyze("$ROOT/automata/nonuniform-quadratic.bcifs")->{edges} };
    is(scalar(grep { !$_->{tangent_continuous} } @edges), 0, 'non-uniform quadratic B-splines are tangent continuous');
    my ($p) = grep { $_->{state} eq 'p(1,2,1)' } @edges;
    # The point between knot intervals u, v divides the leg as v : u.
    ok(vector_near($p->{start}{point}, [2 / 3, 1 / 3, 0]), 'and start where the intervals divide the leg');
}

# ---- Degenerate and non-contractive automata get an answer in words --------------------------------------------------
{
    my %degenerate = (
        'a map that does not contract' => 'sub arc [ 1 0; 0 1 ]  sub arc [ 0 0; 1 1 ]',
        'an arc that stands still at its start' => 'sub arc [ 1 1; 0 0 ]  sub arc [ 1 0; 0 1 ]',
        'a single map' => 'sub arc [ 1 0; 0 1 ]',
        'maps that expand' => 'sub arc [ 1 -2; 0 3 ]  sub arc [ -2 0; 3 1 ]',
    );
    for my $name (sort keys %degenerate) {
        my $file = scratch(undef, "automaton d\nvertex end 1 { }\nedge arc 2 {\n  start end at 0\n  end end at 1\n"
                . "  $degenerate{$name}\n}\n");
        my ($status, $out, $err) = bcifs(['analyze', $file, '--quiet']);
        ok($status == 0 && $out =~ /no continuity certified/, "$name: an answer") or diag("$status $out $err");
    }
}

# ---- Refusals, text, pictures -----------------------------------------------------------------------------------
{
    my $broken = scratch(undef, "automaton b\nvertex v 1 { }\nedge e 2 {\n  start v at 0\n  end v at 1\n"
            . "  sub e [ 1 1/2; 0 1/2 ]\n  sub e [ 1/4 0; 3/4 1 ]\n}\n");
    my ($status, $out, $err) = bcifs(['analyze', $broken]);
    is($status, 1, 'an automaton whose equations fail is refused');
    like($err, qr/T0·end = T1·start|T0\xc2\xb7end = T1\xc2\xb7start/, 'with the equation');
    is($out, '', 'and nothing else');
    ($status, $out) = bcifs(['analyze', "$ROOT/automata/cantor.bcifs"]);
    is($status, 0, 'a file without edges gets an answer');
    my $svg = scratch('tangents.svg');
    ($status) = bcifs(['analyze', "$ROOT/automata/chaikin.bcifs", '--level', '2', '-o', $svg]);
    is($status, 0, 'a picture with half-tangents');
    # 4 pieces, 2^2 cells each, two half-tangents a cell.
    like(file_text($svg), qr/32 half-tangents/, 'two for each cell of the level');
}

done_testing();
