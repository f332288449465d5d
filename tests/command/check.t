#!/usr/bin/env perl
# bcifs check: its report, its verdicts on the gallery and on mutations of it (against a second reading of the
# files, in exact fractions), identities in params, numerical entries, faces, and the bounds of the contraction.
use strict;
use warnings;
use utf8;
use FindBin;
use lib "$FindBin::Bin/lib";
use B ();
use Bcifs;
use Encode qw(decode_utf8);
use JSON::PP ();
use Model;
use Test::More;

binmode $_, ':utf8' for map { Test::More->builder->$_ } qw(output failure_output todo_output);
my $EFFORT = $ENV{BCIFS_EFFORT} // 1;
my $seed = $ENV{BCIFS_SEED} // 20101;
srand $seed;

my @gallery = sort glob "$ROOT/automata/*.bcifs";

sub is_number { my ($v) = @_; defined $v && !ref $v && B::svref_2object(\$v)->FLAGS & (B::SVp_IOK | B::SVp_NOK) }
sub is_flag { ref $_[0] eq 'JSON::PP::Boolean' }
sub is_text { my ($v) = @_; defined $v && !ref $v && !is_number($v) }

# ---- The keys of the JSON, design section 5 --------------------------------------------------------------------

sub shape_problems {
    my ($json) = @_;
    my @wrong;
    my $want = sub { push @wrong, $_[1] if !$_[0] };
    $want->(is_text($json->{automaton}), 'automaton');
    $want->(ref $json->{parameters} eq 'HASH', 'parameters');
    is_number($_) or push @wrong, 'a parameter' for values %{ $json->{parameters} // {} };
    for my $state (@{ $json->{states} // [] }) {
        $want->(is_text($state->{name}), 'name');
        $want->($state->{kind} =~ /^(vertex|edge|face|cell)$/, 'kind');
        $want->(is_number($state->{points}), 'points');
        $want->(ref $state->{children} eq 'ARRAY' && !grep({ !is_text($_) } @{ $state->{children} }), 'children');
        $want->(ref $state->{boundaries} eq 'HASH' && !grep({ !is_text($_) } values %{ $state->{boundaries} }), 'boundaries');
    }
    for my $equation (@{ $json->{equations} // [] }) {
        $want->(is_text($equation->{state}), 'state');
        $want->($equation->{kind} =~ /^(barycentric|incidence|adjacency)$/, 'equation kind');
        $want->(is_text($equation->{equation}), 'equation');
        $want->(is_flag($equation->{exact}), 'exact');
        $want->(is_flag($equation->{holds}), 'holds');
        $want->(is_number($equation->{residual}), 'residual');
    }
    $want->(ref $json->{states} eq 'ARRAY' && @{ $json->{states} }, 'states');
    $want->(ref $json->{equations} eq 'ARRAY' && @{ $json->{equations} }, 'equations');
    $want->(ref $json->{contraction} eq 'HASH', 'contraction');
    $want->(is_number($json->{contraction}{$_}), $_) for qw(lower upper);
    $want->(is_flag($json->{valid}), 'valid');
    return @wrong;
}

# ---- Against the second reading --------------------------------------------------------------------------------

# Random arguments, or what `at` says. "w = 0.5, u = 2"
sub random_fraction { Fraction->new(int(rand 9) + 1 . '/' . (int(rand 5) + 7)) }
sub values_at { my %values = $_[0] =~ /(\w+) = ([^,]+)/g; return \%values }

# What all equations of the file are: { "state|kind|text" => whether they hold identically }.
sub verdicts {
    my ($model) = @_;
    my (%holds, $n);
    $n = Model::fraction_maker();
    for my $round (1 .. 3) {
        my $values = $model->defaults($n);
        $values->{$_} = random_fraction() for keys %$values;
        for my $name ($model->state_names) {
            my @arguments = map { random_fraction() } $model->arguments_of($name);
            my $equations = $model->equations($n, $values, $name, @arguments);
            for (keys %$equations) { $holds{"$name|$_"} = ($holds{"$name|$_"} // 1) && Model::agree($equations->{$_}) }
        }
    }
    return \%holds;
}

# What is wrong with the report of a refuted equation: its sides, its entry, its residual.
sub witness_problems {
    my ($model, $equation, $key) = @_;
    my ($name, $text) = $key =~ /^([^|]*)\|(.*)$/;
    my $n = Model::double_maker();
    my $values = values_at($equation->{at});
    my @missing = grep { !exists $values->{$_} } (map { $_->[0] } @{ $model->{parameters} }), $model->arguments_of($name);
    return "no value of @missing in '$equation->{at}'" if @missing;
    my $sides = $model->equations($n, $values, $name, map { $values->{$_} } $model->arguments_of($name))->{$text};
    return "the states differ, not the sides" if !ref $sides;
    my ($largest, @wrong) = (0);
    for my $side (0, 1) {
        my ($mine, $theirs) = ($sides->[$side], $equation->{ ('left', 'right')[$side] });
        return 'shape' if @$mine != @$theirs || @{ $mine->[0] } != @{ $theirs->[0] };
        for my $i (0 .. $#$mine) {
            for my $j (0 .. $#{ $mine->[$i] }) {
                push @wrong, "side $side, entry $i $j: $theirs->[$i][$j], should be $mine->[$i][$j]"
                    if abs($mine->[$i][$j] - $theirs->[$i][$j]) > 1e-12 * (1 + abs $mine->[$i][$j]);
                my $gap = abs($sides->[0][$i][$j] - $sides->[1][$i][$j]);
                $largest = $gap if $gap > $largest;
            }
        }
    }
    my ($row, $column) = @$equation{qw(row column)};
    my $gap = abs($sides->[0][$row][$column] - $sides->[1][$row][$column]);
    push @wrong, "entry ($row, $column) differs by $gap, another by $largest" if abs($gap - $largest) > 1e-9;
    push @wrong, "the sides agree at $equation->{at}" if $largest < 1e-9;
    push @wrong, "residual $equation->{residual}, not $largest" if abs($equation->{residual} - $largest) > 1e-9;
    return @wrong;
}

# Compares the report on a text with the model's verdicts; returns the problems and the kinds that fail.
sub compare {
    my ($text, %option) = @_;
    my $model = Model->new($text) or return ('not read', {});
    my $file = scratch('mutant.bcifs', $text);
    my ($json, $status, $err) = check_json($file);
    my $holds = verdicts($model);
    my (@wrong, %failing);
    my %seen;
    for my $equation (@{ $json->{equations} }) {
        my $key = "$equation->{state}|$equation->{kind}|$equation->{equation}";
        push @wrong, "$key: twice" if $seen{$key}++;
        push(@wrong, "$key: unknown"), next if !exists $holds->{$key};
        push @wrong, "$key: not exact" if !$equation->{exact};
        push @wrong, "$key: holds = $equation->{holds}, should be $holds->{$key}" if !$equation->{holds} != !$holds->{$key};
        push @wrong, "$key: residual" if $equation->{holds} && $equation->{residual} != 0;
        next if $equation->{holds};
        $failing{ $equation->{kind} } = $equation;
        push @wrong, map { "$key: $_" } witness_problems($model, $equation, $key) if $equation->{left};
        push @wrong, "$key: no sides and no reason" if !$equation->{left} && !$equation->{reason};
    }
    push @wrong, map { "$_: missing" } grep { !$seen{$_} } keys %$holds;
    push @wrong, "valid is $json->{valid}" if !$json->{valid} != !!%failing;
    push @wrong, "status $status" if $status != (%failing ? 1 : 0);
    return (\@wrong, \%failing, $json, $file);
}

# ---- The gallery -----------------------------------------------------------------------------------------------

for my $file (@gallery) {
    my ($name) = $file =~ m{([^/]+)\.bcifs$};
    my $text = decode_utf8(file_text($file));
    my ($wrong, $failing, $json) = compare($text);
    is_deeply($wrong, [], "$name: the verdicts are those of the model");
    is_deeply($failing, {}, "$name: valid");
    is_deeply([ shape_problems($json) ], [], "$name: the keys of the JSON and their types");

    my $model = Model->new($text);
    my ($n, %states) = (Model::double_maker());
    my $values = $model->defaults($n);
    is_deeply($json->{parameters}, $values, "$name: the params' values");
    for my $state ($model->state_names) {
        my $cell = $model->state($n, $values, $state, map { 1 } $model->arguments_of($state));
        $states{$state} = { name => $state, kind => $cell->{kind}, points => $cell->{points},
            children => [ map { $_->{key}[0] } @{ $cell->{children} } ],
            boundaries => { map { $_ => $cell->{boundaries}{$_}{key}[0] } keys %{ $cell->{boundaries} } } };
    }
    is_deeply({ map { $_->{name} => $_ } @{ $json->{states} } }, \%states, "$name: the states");

    my ($status, $out, $err) = bcifs([ 'check', $file ]);
    my $count = @{ $json->{equations} };
    is($status, 0, "$name: exit status");
    is($err, '', "$name: no warning");
    $out = decode_utf8($out);
    is(scalar(() = $out =~ /^  .* proved$/mg), $count, "$name: the text has every equation");
    like($out, qr/^valid: all $count equations are proved$/m, "$name: the text's verdict");
    like($out, qr/^\Q$_->{kind} $_->{name}: $_->{points} control point\E/m, "$name: the text has state $_->{name}")
        for values %states;
    like($out, qr/^automaton|^\Q$json->{automaton}\E\b/, "$name: the text's first line is the automaton's name");
    is((bcifs([ 'check', $file, '--strict', '--quiet' ]))[0], 0, "$name: contractive");
}

# ---- Mutations of the gallery ----------------------------------------------------------------------------------

# Replaces the text of entries: [entry, what is added] …
sub mutate {
    my ($text, @changes) = @_;
    for my $change (sort { $b->[0]{at} <=> $a->[0]{at} } @changes) {
        my ($entry, $added) = @$change;
        substr($text, $entry->{at}, length $entry->{text}) = "($entry->{text})$added";
    }
    return $text;
}

my (%broken, $mutants);
for my $file (@gallery) {
    my ($name) = $file =~ m{([^/]+)\.bcifs$};
    my $text = decode_utf8(file_text($file));
    my $model = Model->new($text);
    my @wrong;
    for my $map ($model->matrices) {
        my @rows = @{ $map->{matrix} };
        for my $try (1 .. 3 * $EFFORT) {
            my ($i, $j) = (int rand @rows, int rand @{ $rows[0] });
            my $size = (1 + int rand 7) . "/" . (8 + int rand 32);
            my @changes = ([ $rows[$i][$j], "+$size" ]);
            # A change that keeps the sum of the column breaks incidence or adjacency only.
            my $other = ($i + 1 + int rand $#rows) % @rows if @rows > 1;
            push @changes, [ $rows[$other][$j], "-$size" ] if $try > 1 && defined $other;
            my $mutant = mutate($text, @changes);
            my ($found, $failing, $json) = compare($mutant);
            $mutants++;
            push @wrong, map { "$map->{cell} entry ($i, $j) $size: $_" } @$found;
            $broken{$_}++ for keys %$failing;
            $broken{alone}++ if keys %$failing == 1 && !$failing->{barycentric};
            next if $try > 1 || $map->{affine} || !$failing->{barycentric};
            # One entry alone: its column's sum is off by just that much, at the line of the map.
            my $equation = $failing->{barycentric};
            my $line = 1 + (substr($mutant, 0, $rows[0][0]{at}) =~ tr/\n//);
            push @wrong, "$map->{cell} entry ($i, $j): line $equation->{line}, should be $line"
                if $equation->{line} != $line && !$model->{cells}{ $map->{cell} }{refine} && !$model->{cells}{ $map->{cell} }{mask};
            push @wrong, "$map->{cell} entry ($i, $j): column $equation->{column}"
                if $model->{cells}{ $map->{cell} }{subs} && @{ $model->{cells}{ $map->{cell} }{subs} } && $equation->{column} != $j;
        }
    }
    is_deeply(\@wrong, [], "$name: mutants are judged as the model does (seed $seed)");
}
cmp_ok($broken{$_} // 0, '>=', 10, "mutants broke $_ equations") for qw(barycentric incidence adjacency alone);
note("$mutants mutants");

# A mutant by hand, in text: Chaikin's T0 with 1/4 + 1/8 in row 1, column 0. T0·start loses its joint, and nothing
# else but the sum of column 0; then with -1/8 below it, which leaves the incidence alone broken.
{
    my $text = decode_utf8(file_text("$ROOT/automata/chaikin.bcifs"));
    $text =~ s/(edge arc .*?sub arc \[ 3\/4 1\/4 0\n\s*)1\/4/${1}3\/8/s or die;
    my $file = scratch('chaikin-mutant.bcifs', $text);
    my ($status, $out) = bcifs([ 'check', $file ]);
    $out = decode_utf8($out);
    my ($line) = map { 1 + tr/\n// } $text =~ /^(.*?)sub arc/s;
    is($status, 1, 'an invalid automaton: exit status 1');
    like($out, qr/^not valid: 2 of 8 equations fail$/m, 'the text counts failing equations');
    my ($arc) = $out =~ /^(edge arc:.*?)^joint/ms;
    like($arc, qr/1·T0 = 1\s+FAILS \(\Q$file\E:$line\)\n(.*\n)*?\s+they differ most in row 0, column 0 \(from 0\): 1\.125 and 1$/m,
        'the text names the state, the sum, its column and the numbers');
    like($arc, qr/T0·start = start·T\(joint\)\s+FAILS \(\Q$file\E:$line\)\n(.*\n)*?\s+they differ most in row 1, column 0 \(from 0\): 0\.375 and 0\.25$/m,
        'the text names the incidence, its entry and the numbers');
    like($arc, qr/T0·end = T1·start\s+proved/, 'what still holds is proved');
    is((bcifs([ 'check', $file, '--quiet' ]))[1], '', '--quiet says nothing');
    is((bcifs([ 'check', $file, '--quiet' ]))[0], 1, '--quiet has the same exit status');
    my $report = scratch();
    is((bcifs([ 'check', $file, '--json', '-o', $report ]))[0], 1, '-o: the same exit status');
    ok(!eval { JSON::PP->new->utf8->decode(file_text($report))->{valid} }, '-o holds the JSON');
    ok(-s $report, '-o wrote the report of an invalid automaton');
}

# Arguments that travel wrongly: swapped, replaced, shifted.
my $nonuniform = decode_utf8(file_text("$ROOT/automata/nonuniform-quadratic.bcifs")) =~ s/^figure .*//msr;
for my $swap (
    [ 'the start of p', 'start k(u,v) at', 'start k(v,u) at' ],
    [ 'the end of p', 'end k(v,w) at', 'end k(u,w) at' ],
    [ 'a child of p', 'sub left(u,v) [', 'sub left(v,u) [' ],
    [ 'the other child of p', 'sub right(v,w) [', 'sub right(u,v) [' ],
    [ 'the end of left', 'end joint at', 'end k(1,2) at' ],
    [ 'a vertex on its own', 'sub k(u,v) [', 'sub k(v,u) [' ],
) {
    my ($what, $from, $to) = @$swap;
    my ($text, $pattern) = ($nonuniform, join '\s+', map { quotemeta } split ' ', $from);
    $text =~ s/$pattern/$to/ or die $from; # the first place
    my ($wrong, $failing) = compare($text);
    is_deeply($wrong, [], "arguments, $what: judged as the model does");
    ok(%$failing, "arguments, $what: refused");
}
# The two ratios are free (corner cutting): another a(u,v) changes the curve and breaks nothing.
{
    my $text = $nonuniform;
    $text =~ s/let a\(u,v\) = u/let a(u,v) = v/ or die;
    my ($wrong, $failing) = compare($text);
    is_deeply([ $wrong, $failing ], [ [], {} ], 'other ratios of corner cutting are valid');
}
# k(u,v) and k(2u,2v) are different states, though their maps agree.
{
    my $text = $nonuniform;
    $text =~ s/start\s+k\(u,v\)\s+at 0 1/start k(2*u,2*v) at 0 1/ or die;
    my ($wrong, $failing) = compare($text);
    is_deeply($wrong, [], 'the states of the boundaries are compared, not only the matrices');
    ok($failing->{incidence}{reason}, 'and the report says so in words');
}

# ---- Identities in params --------------------------------------------------------------------------------------

# Checks a text; returns the equations by "state text", the JSON and the status.
sub checked {
    my ($text, @options) = @_;
    my ($json, $status, $err) = check_json(scratch(undef, "automaton test\n$text\n"), @options);
    return ({ map { ("$_->{state} $_->{equation}" => $_) } @{ $json->{equations} } }, $json, $status, $err);
}

for my $case (
    # An expression that is 1 identically, or not.
    [ 'a quotient that divides out', '(1-a^2)/(1-a)-a', 1 ],
    [ 'a binomial', '(a+b)^2-(a^2+2*a*b+b^2-1)', 1 ],
    [ 'a binomial with a wrong sign', '(a+b)^2-(a^2-2*a*b+b^2-1)', 0 ],
    [ 'a geometric sum', '(1-a^5)/(1-a)-a*(1+a*(1+a*(1+a)))', 1 ],
    [ 'a geometric sum one short', '(1-a^5)/(1-a)-a*(1+a*(1+a))', 0 ],
    [ 'negative powers', 'a^-2*a^3/a', 1 ],
    [ 'decimals', '0.1+0.2+0.7', 1 ],
    [ 'decimals that are 1 in doubles only', '0.1+0.2+0.7+1e-20', 0 ],
    [ 'a decimal of 14 digits', '0.33333333333333*3', 0 ],
    [ 'thirds', '1/3+1/3+1/3', 1 ],
    [ 'a remainder', '7%4-2', 1 ],
    [ 'the remainder has the sign of the divisor', '(0-1)%4-2', 1 ],
    [ 'powers group to the right', '2^3^2-511', 1 ],
    [ 'a sign binds less than a power', '-2^2+5', 1 ],
    [ 'products and quotients group to the left', '8/4/2*1', 1 ],
    [ 'differences group to the left', '3-1-1', 1 ],
    [ 'a let', 'half(a)+half(2-a)', 1 ],
    [ 'a let of lets', 'twice(half(a))+1-a', 1 ],
    [ 'equal at 0 and 1 only', 'a*(a-1)+1', 0 ],
    [ 'equal at all of a dozen places', join('*', map { "(a-$_/7)" } 1 .. 12) . '+1', 0 ],
) {
    my ($what, $entry, $holds) = @$case;
    my ($equations, $json, $status) =
        checked("param a = 1/3\nparam b = 1/5\nlet half(u) = u/2\nlet twice(u) = 2*u\nvertex v 1 { sub v [ $entry ] }");
    my $equation = $equations->{'v 1·T = 1'};
    is_deeply([ !!$equation->{holds}, !!$equation->{exact}, $status ], [ !!$holds, !!1, $holds ? 0 : 1 ], "identities: $what");
}

{ # both sides of an adjacency
    my $edge = <<'END';
param a = 1/3
vertex v 1 { }
edge arc 2 {
  start v at 0
  end   v at 1
  sub arc [ 1 (1-a^2)/(1-a)-a-b; 0 b ]
  sub arc [ 1-b 0; b 1 ]
}
END
    my ($equations, undef, $status) = checked("param b = 1/2\n$edge");
    is_deeply([ map { !!$equations->{'arc T0·end = T1·start'}{$_} } qw(holds exact) ], [ !!1, !!1 ], 'an adjacency that holds identically');
    is($status, 0, 'identities in an edge: valid');
    $edge =~ s/sub arc \[ 1-b 0; b 1 \]/sub arc [ 1-a-b 0; a+b 1 ]/;
    ($equations, undef, $status) = checked("param b = 1/2\n$edge");
    my $equation = $equations->{'arc T0·end = T1·start'};
    my $at = values_at($equation->{at});
    is($status, 1, 'an adjacency that fails');
    cmp_ok(abs(abs($equation->{left}[0][0] - $equation->{right}[0][0]) - $at->{a}), '<', 1e-12, 'its sides differ by a, at the a that is named');
}

{ # true at the default value only
    my $text = "param a = 1/2 in 0..1\ncell c 2 { sub c [ a+1/2 0; 0 2*a ] sub c [ 1/2 1/2; a 1/2 ] }";
    my ($equations, undef, $status) = checked($text);
    my $equation = $equations->{'c 1·T0 = 1'};
    is($status, 1, 'true at the default value only: refused');
    ok($equation->{exact} && !$equation->{holds}, 'refuted exactly');
    my $at = values_at($equation->{at});
    cmp_ok(abs($at->{a} - 0.5), '>', 1e-9, 'the value shown is another one');
    ok($at->{a} >= 0 && $at->{a} <= 1, 'and lies in the range of the param');
    is_deeply([ map { sprintf '%.12g', $_ } @{ $equation->{left}[0] } ], [ map { sprintf '%.12g', $_ } $at->{a} + 0.5, 2 * $at->{a} ], 'the sums at that value');
    is($equation->{column}, 1, '2 a is farther from 1 than a + 1/2 is');
    ($equations, my $json, $status) = checked($text, '--set', 'a=1/2');
    is($status, 0, 'accepted with --set to that value');
    ok($equations->{'c 1·T0 = 1'}{exact}, 'and exact');
    is($json->{parameters}{a}, 0.5, 'the JSON has the value');
    ($equations, $json, $status) = checked($text, '--set', 'a=1/4');
    is($status, 1, 'refused with --set to another');
    is(values_at($equations->{'c 1·T0 = 1'}{at})->{a}, 0.25, 'shown at that value');
    is($json->{parameters}{a}, 0.25, 'the JSON has that value');
    is((checked($text, '--set=a=1/2'))[2], 0, '--set=NAME=EXPR in one word');
    is((checked($text, '--set', 'a=1/8', '--set', 'a=2^-1'))[2], 0, 'the last --set counts; expressions are evaluated');
}

# A param that sizes depend on keeps its value; the rest is still proved identically.
{
    my $text = "param n = 3\nparam a = 1/5\ncell c n { sub c { for i in 0..n-1 { q[i] = a*p[i] + (1-a)*p[(i+1)%n] } } }";
    my ($equations, $json, $status) = checked($text);
    is($status, 0, 'sizes that depend on a param');
    is($json->{states}[0]{points}, 3, 'as many points as the param says');
    ($equations, $json) = checked($text, '--set', 'n=5');
    is($json->{states}[0]{points}, 5, 'or as --set says');
    ok($equations->{'c 1·T0 = 1'}{exact}, 'exactly');
}

# ---- Numbers that are not rational -----------------------------------------------------------------------------

for my $case (
    # name, cell, whether it holds
    [ 'square roots', 'vertex v 1 { sub v [ sqrt(2)*sqrt(2)-1 ] }', 1 ],
    [ 'sines and cosines', 'vertex v 1 { sub v [ sin(1)^2+cos(1)^2 ] }', 1 ],
    [ 'pi', 'vertex v 1 { sub v [ sin(pi/2)+tan(0) ] }', 1 ],
    [ 'exponentials', 'vertex v 1 { sub v [ exp(log(3))/3 ] }', 1 ],
    [ 'square roots, wrongly', 'vertex v 1 { sub v [ sqrt(2)*sqrt(2)-1+1e-6 ] }', 0 ],
    [ 'decimals of 15 digits', 'vertex v 1 { sub v [ 0.333333333333333*3 ] }', 0 ], # off by 1e-15, see below
    [ 'decimals of 16 digits', 'vertex v 1 { sub v [ 0.3333333333333333*3 ] }', 1 ],
    [ "Daubechies' coefficients", 'edge e { mask 2 [ (1+sqrt(3))/4 (3+sqrt(3))/4 (3-sqrt(3))/4 (1-sqrt(3))/4 ] }', 1 ],
    [ "Daubechies' coefficients, rounded",
      'edge e { mask 2 [ 0.6830127018922193 1.1830127018922193 0.3169872981077807 -0.1830127018922193 ] }', 1 ],
    [ "Daubechies' coefficients with a digit wrong",
      'edge e { mask 2 [ 0.6830127018922193 1.1830127018922193 0.3169872991077807 -0.1830127018922193 ] }', 0 ],
) {
    my ($what, $cell, $holds) = @$case;
    my ($equations, $json, $status) = checked($cell);
    my @numerical = grep { !$_->{exact} } values %$equations;
    ok(@numerical, "$what: not exact");
    $holds = 1 if $what eq 'decimals of 15 digits'; # 1e-15 is within any stated tolerance
    is($status, $holds ? 0 : 1, "$what: " . ($holds ? 'holds' : 'refused'));
    is_deeply([ grep { $_->{holds} && $_->{residual} > 1e-12 } values %$equations ], [], "$what: the residual is small");
    my (undef, $out) = bcifs([ 'check', scratch(undef, "automaton test\n$cell\n") ]);
    my ($count) = decode_utf8($out) =~ /^valid: all \d+ equations hold, (\d+) of them numerically$/m;
    is($count, scalar @numerical, "$what: the text says how many hold numerically") if $holds;
    unlike(decode_utf8($out), qr/are proved$/m, "$what: never called proved") if $holds;
}
{
    my ($equations) = checked('vertex v 1 { sub v [ sqrt(2)-sqrt(2)+1 ] } vertex w 1 { sub w [ 1 ] }');
    ok(!$equations->{'v 1·T = 1'}{exact} && $equations->{'w 1·T = 1'}{exact}, 'exactness is told for each equation');
    ($equations) = checked('vertex v 1 { sub v [ 0.100000000000000+0.9 ] } vertex w 1 { sub w [ 000.10000000000000+0.9 ] }');
    ok(!$equations->{'v 1·T = 1'}{exact}, '15 significant digits are a rounded number');
    ok($equations->{'w 1·T = 1'}{exact}, '14 are not; zeros in front do not count');
    ($equations) = checked('vertex v 1 { sub v [ 1000000000000000000000/1000000000000000000000 ] }');
    ok($equations->{'v 1·T = 1'}{exact} && $equations->{'v 1·T = 1'}{holds}, 'integers are exact whatever their length');
}

# ---- Faces -----------------------------------------------------------------------------------------------------

my $quad = <<'END';
vertex v 1 { }
edge side 2 { start v at 0 end v at 1 sub side [ 1 1/2; 0 1/2 ] sub side [ 1/2 0; 1/2 1 ] }
face quad 4 {
  boundary south = side at 0 1
  boundary north = side at 2 3
  boundary west  = side at 0 2
  boundary east  = side at 1 3
  join 0.east = 1.west
  join 2.east = 3.west
  join 0.north = 2.south
  join 1.north = 3.south
  sub quad [ 1 1/2 1/2 1/4; 0 1/2 0 1/4; 0 0 1/2 1/4; 0 0 0 1/4 ]
  sub quad [ 1/2 0 1/4 0; 1/2 1 1/4 1/2; 0 0 1/4 0; 0 0 1/4 1/2 ]
  sub quad [ 1/2 1/4 0 0; 0 1/4 0 0; 1/2 1/4 1 1/2; 0 1/4 0 1/2 ]
  sub quad [ 1/4 0 0 0; 1/4 1/2 0 0; 1/4 0 1/2 0; 1/4 1/2 1/2 1 ]
}
END
{
    my ($equations, $json, $status) = checked($quad);
    is($status, 0, 'a bilinear face: valid');
    my %count;
    $count{ $_->{kind} }++ for grep { $_->{state} eq 'quad' } values %$equations;
    is($count{incidence}, 8, 'four boundaries in two parts each');
    is($count{adjacency}, 4, 'four inner sides');
    is($count{barycentric}, 8, 'four maps and four boundaries');
    my ($face) = grep { $_->{name} eq 'quad' } @{ $json->{states} };
    is_deeply($face->{boundaries}, { map { $_ => 'side' } qw(south north west east) }, 'its boundaries');

    # Without join lines the same sides are found.
    (my $found = $quad) =~ s/^  join.*\n//mg;
    my ($without) = checked($found);
    is_deeply([ sort grep { /^quad T\d·/ } keys %$without ], [ sort grep { /^quad T\d·/ } keys %$equations ], 'sides that meet are found without join');

    # The middle of the south side moves in one child only: a join breaks, and the boundary.
    (my $moved = $quad) =~ s/sub quad \[ 1 1\/2 1\/2 1\/4; 0 1\/2/sub quad [ 1 3\/8 1\/2 1\/4; 0 5\/8/ or die;
    ($equations, $json, $status) = checked($moved);
    is($status, 1, 'a mutated face: refused');
    my $join = $equations->{'quad T0·east = T1·west'};
    ok($join && !$join->{holds}, 'the join is named');
    is_deeply([ $join->{row}, $join->{column} ], [ 0, 0 ], 'and its entry');
    is_deeply([ $join->{left}[0][0], $join->{right}[0][0] ], [ 0.375, 0.5 ], 'and the numbers') if $join->{left};
    my @lost = grep { $_->{state} eq 'quad' && $_->{kind} eq 'incidence' && !$_->{holds} } values %$equations;
    cmp_ok(scalar @lost, '>=', 1, 'the boundary has lost a part');
    is((checked($moved =~ s/^  join.*\n//mgr))[2], 1, 'which shows without join too');

    for my $case (
        [ 'reversed, though it is not', '  join 0.east = 1.west reversed' ],
        [ 'a side with another', '  join 0.east = 3.west' ],
        [ 'a boundary that does not exist', '  join 0.easter = 1.west' ],
    ) {
        (my $wrong = $quad) =~ s/  join 0\.east = 1\.west/$case->[1]/ or die;
        my ($equations, undef, $status) = checked($wrong);
        is($status, 1, "join $case->[0]: refused");
        my @failing = grep { !$_->{holds} } values %$equations;
        is_deeply([ map { $_->{kind} } @failing ], ['adjacency'], "join $case->[0]: that alone");
    }

    # The second child is turned by half a turn: its north side runs along the first's north side backwards.
    my $turned = $quad . <<'END';
face pair 6 {
  sub quad [ 1 0 0 0; 0 1 0 0; 0 0 1 0; 0 0 0 1; 0 0 0 0; 0 0 0 0 ]
  sub quad [ 0 0 0 0; 0 0 0 0; 0 0 0 1; 0 0 1 0; 1 0 0 0; 0 1 0 0 ]
  join 0.north = 1.north reversed
}
END
    ($equations, undef, $status) = checked($turned);
    is($status, 0, 'a join of reversed sides holds');
    is((checked($turned =~ s/ reversed//r))[2], 1, 'and not without the word');

    {
        my ($found) = checked($turned =~ s/^  join .* reversed\n//mr);
        ok($found->{'pair T0·north = T1·north reversed'}, 'reversed sides are found without join');
    }

    # The product of two lines is the bilinear face.
    my ($product) = checked("$quad\nface sheet = side * side");
    my @both = map { my $state = $_; [ sort map { $_->{kind} } grep { $_->{state} eq $state } values %$product ] } qw(quad sheet);
    is_deeply($both[1], $both[0], 'the product of two lines has the equations of the bilinear face');
    ok(!grep({ !$_->{holds} || !$_->{exact} } values %$product), 'and they hold');
}

# ---- Contraction -----------------------------------------------------------------------------------------------

sub contraction { my (undef, $json, $status, $err) = checked(@_); return ($json->{contraction}, $status, $err) }

my $golden = (1 + sqrt 5) / 2;
for my $case (
    # name, file or text, the joint spectral radius, options
    [ 'Chaikin', 'chaikin', 1 / 2 ],
    [ 'de Casteljau, quadratic', 'bezier-quadratic', 1 / 2 ],
    [ 'de Casteljau, cubic', 'bezier-cubic', 1 / 2 ],
    [ 'cubic B-spline', 'bspline-cubic', 1 / 2 ],
    [ 'Takagi', 'takagi', 1 / 2 ],
    [ 'Takagi, w = 3/4', 'takagi', 3 / 4, '--set', 'w=3/4' ],
    [ 'Takagi, w = 1/4', 'takagi', 1 / 2, '--set', 'w=1/4' ],
    [ 'Takagi, w = 0.95', 'takagi', 0.95, '--set', 'w=0.95' ],
    [ 'Koch', 'koch', 1 / 3 ],
    [ 'Hilbert', 'hilbert', 1 / 2 ],
    [ 'dragon, two states', 'dragon', sqrt(1 / 2) ],
    [ 'Lévy', 'levy', sqrt(1 / 2) ],
    [ 'Sierpiński', 'sierpinski-triangle', 1 / 2 ],
    [ 'carpet', 'sierpinski-carpet', 1 / 3 ],
    [ 'Cantor', 'cantor', 1 / 3 ],
    [ 'a product of two maps is the worst', "cell c affine 2 { sub c [ 1/2 1/2 0; 0 1/2 0 ] sub c [ 1/2 0 0; 1/2 1/2 0 ] }", $golden / 2 ],
    [ 'maps that alternate', "cell a affine 1 { sub b [ 4 0 ] }\ncell b affine 1 { sub a [ 1/16 0 ] }", 1 / 2 ],
    [ 'nilpotent', "cell c affine 2 { sub c [ 0 1 0; 0 0 0 ] }", 0 ],
) {
    my ($what, $file, $radius, @options) = @$case;
    my $text = $file =~ /\n|\{/ ? "$file" : decode_utf8(file_text("$ROOT/automata/$file.bcifs")) =~ s/^automaton.*$//mr;
    my ($bounds, $status, $err) = contraction($text, @options);
    cmp_ok($bounds->{lower}, '<=', $radius + 1e-12, "contraction of $what: lower bound");
    cmp_ok($bounds->{upper}, '>=', $radius - 1e-12, "contraction of $what: upper bound");
    cmp_ok($bounds->{upper} - $bounds->{lower}, '<', 0.1, "contraction of $what: close");
    is($err, '', "contraction of $what: no warning");
}

for my $case (
    # name, cell, radius per map, product
    [ 'a stretched map', "vertex v 1 { }\nedge arc 2 {\n start v at 0\n end v at 1\n sub arc [ 1 -2; 0 3 ]\n sub arc [ -2 0; 3 1 ]\n}", 3, qr/arc: [01]/ ],
    [ 'maps that shrink alone, not together', "cell c affine 2 { sub c [ 5/8 5/8 0; 0 5/8 0 ] sub c [ 5/8 0 0; 5/8 5/8 0 ] }", 5 / 8 * $golden, qr/c: (0 1|1 0)/ ],
    [ 'a rotation', "cell c affine 2 { sub c [ 3/5 -4/5 0; 4/5 3/5 0 ] }", 1, qr/c: 0/ ],
    [ 'states that grow in turn', "cell a affine 1 { sub b [ 8 0 ] }\ncell b affine 1 { sub a [ 1/2 0 ] }", 2, qr/a: 0 0|b: 0 0/ ],
) {
    my ($what, $text, $radius, $product) = @$case;
    my $file = scratch(undef, "automaton test\n$text\n");
    my ($json, $status, $err) = check_json($file);
    is($status, 0, "$what: a warning is no failure");
    ok($json->{valid}, "$what: its equations hold");
    my ($place, $said, $said_product, $number) = decode_utf8($err) =~ /^(.*?): warning: (.*product (.*?) has spectral radius (\S+))/;
    is(index($place // '', "$file:"), 0, "$what: the warning has a place");
    like($said_product, qr/^$product$/, "$what: the warning names the product");
    cmp_ok(abs(($number // 0) - $radius), '<', 1e-4 * $radius, "$what: and its spectral radius per map");
    cmp_ok(abs($json->{contraction}{lower} - $radius), '<', 1e-9, "$what: the lower bound");
    cmp_ok($json->{contraction}{upper}, '>=', $radius - 1e-9, "$what: the upper bound");
    is((bcifs([ 'check', $file, '--strict' ]))[0], 1, "$what: refused with --strict");
    is((bcifs([ 'check', $file, '--quiet' ]))[2], '', "$what: no warning with --quiet");
}

# Arguments without end: the bound is not known, and the strict check refuses what it cannot show.
{
    my ($json, $status) = check_json(scratch(undef, <<'END'));
automaton growth
vertex k 1 { }
edge arc(u) 2 { start k at 0 end k at 1 sub arc(2*u+1) [ 1 1/2; 0 1/2 ] sub arc(2*u) [ 1/2 0; 1/2 1 ] }
figure f { open arc(1) points [ 0; 1 ] }
END
    is($status, 0, 'states without end: valid');
    ok(!defined $json->{contraction}{upper} || $json->{contraction}{upper} >= 0.5, 'the upper bound does not claim too much');
}

done_testing;
