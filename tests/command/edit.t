#!/usr/bin/env perl
# bcifs edit: the area of every curve of the gallery stays what it was, whatever is free; reports, files, refusals.
use strict;
use warnings;
no warnings "qw"; # commas are part of the words
use File::Basename qw(basename dirname);
use File::Temp ();
use lib dirname(__FILE__) . '/lib';
use Bcifs qw($BCIFS $ROOT file_text file_write);
use JSON::PP;
use Test::More;

my $directory = File::Temp->newdir();

# (exit status, standard output, standard error) of bcifs edit.
sub edit {
    my $line = join ' ', map { "'$_'" } @_;
    my $output = qx('$BCIFS' edit $line 2>'$directory/errors' </dev/null);
    return ($? >> 8, $output, file_text("$directory/errors"));
}

# The signed area inside a polygon, the shoelace formula; an open one is closed by its chord.
sub shoelace {
    my @points = @_;
    my $sum = 0;
    for my $i (0 .. $#points) {
        my ($p, $q) = ($points[$i], $points[($i + 1) % @points]);
        $sum += $p->[0] * $q->[1] - $q->[0] * $p->[1];
    }
    return $sum / 2;
}

my $square = "$ROOT/automata/chaikin.bcifs";

# ---- The report --------------------------------------------------------------------------------------------

my ($status, $output, $errors) = edit($square, qw(--refine 3 --coarsen 2 --move 1:1/2,-1/4 --json));
is($status, 0, 'an edit succeeds');
my $report = decode_json($output);
is_deeply([sort keys %{$report->{area}}], [qw(after before deformed relative_error target)], 'the keys of area');
ok(exists $report->{energy}{$_}, "energy has $_") for qw(deformed after);
ok(exists $report->{$_}, "there is $_") for qw(iterations multiplier scale_points points);
is(scalar @{$report->{points}}, 32, 'the fine control points');
is(scalar @{$report->{scale_points}}, 8, 'the control points of the level');
# The square's curve: four arcs of parabolas cut a sixth of each corner's unit triangle, 4 - 4/6.
ok(abs($report->{area}{before} - 10 / 3) < 1e-13, 'the area before is 10/3');
ok(abs($report->{area}{after} - 10 / 3) < 1e-12, 'and so it is after');
ok($report->{area}{deformed} > 3.4 || $report->{area}{deformed} < 3.3, 'not so in between');

# ---- Every curve of the gallery ----------------------------------------------------------------------------

my ($edited, $areas) = (0, 0);
for my $path (sort glob "$ROOT/automata/*.bcifs") {
    my $text = file_text($path);
    while ($text =~ /^figure (\w+) \{\n(?:.*\n)*?  (?:open|closed) (\w+)/mg) {
        my $figure = $1;
        my ($code, $json, $told) =
            edit($path, '--figure', $figure, qw(--refine 2 --coarsen 2 --move 0:1/10,1/5 --json --quiet));
        next if $code == 2 && $told =~ /not a curve|surface|coordinate|not of full rank|does not have full rank/;
        $edited++;
        my $name = basename($path) . ", $figure";
        if ($code == 1) {
            like($told, qr/has no area to keep/, "$name: why the area cannot be kept");
            is((edit($path, '--figure', $figure, qw(--refine 2 --coarsen 2 --move 0:1/10,1/5 --keep none)))[0], 0,
                "$name: edited without it");
            next;
        }
        is($code, 0, "$name: edited") or diag($told);
        my $answer = $code ? {} : decode_json($json);
        ok(($answer->{area}{relative_error} // 1) <= 1e-12, "$name: the area is kept");
        $areas++;
    }
}
ok($edited >= 20 && $areas >= 15, "$edited figures were edited, $areas with their area");

# ---- What is free ------------------------------------------------------------------------------------------

for my $free (qw(scale all near:1 near:2 list:0,3)) {
    ($status, $output) = edit($square, qw(--refine 4 --coarsen 3 --move 1:1/2,-1/4 --json --free), $free);
    is($status, 0, "--free $free");
    my $answer = decode_json($output);
    ok($answer->{area}{relative_error} <= 1e-12, "--free $free keeps the area");
    my $put = $answer->{scale_points}[1];
    my ($before) = (edit($square, qw(--refine 4 --coarsen 3 --keep none --json)))[1];
    my $start = decode_json($before)->{scale_points};
    ok(abs($put->[0] - $start->[1][0] - 0.5) < 1e-12 && abs($put->[1] - $start->[1][1] + 0.25) < 1e-12,
        "--free $free leaves the point where it was put")
        if $free =~ /near|list/;
    my @moved = grep { abs($answer->{scale_points}[$_][0] - $start->[$_][0]) > 1e-9 } 0 .. $#$start;
    is_deeply(\@moved, [0 .. 3, 7], '--free near:2 moves neighbors only') if $free eq 'near:2';
}
($status, $output) = edit($square, qw(--refine 2 --coarsen 1 --move 0:1,1 --pin 3,4 --json));
my $pinned = decode_json($output)->{scale_points};
my $start = decode_json((edit($square, qw(--refine 2 --coarsen 1 --keep none --json)))[1])->{scale_points};
ok(abs($pinned->[$_][0] - $start->[$_][0]) < 1e-13 && abs($pinned->[$_][1] - $start->[$_][1]) < 1e-13, "--pin $_ holds")
    for 3, 4;
($status, $output) = edit($square, qw(--area 5 --json));
ok(abs(decode_json($output)->{area}{after} - 5) < 1e-12, '--area sets the area');

# ---- Files -------------------------------------------------------------------------------------------------

is((edit($square, qw(--refine 3 --coarsen 2 --move 1:1/2,-1/4 -o), "$directory/x.csv"))[0], 0, 'points are written');
($status, $output) = edit($square, '--points', "$directory/x.csv", qw(--coarsen 2 --json));
my $again = decode_json($output);
ok(abs($again->{area}{before} - 10 / 3) < 1e-12, 'and read again with --points');
my @rows = map { [split /,/] } grep { /^[-\d]/ } split /\n/, file_text("$directory/x.csv");
is(scalar @rows, 32, 'one row a fine control point');
is((edit($square, qw(--refine 3 --coarsen 3 --move 0:-1,-1 -o), "$directory/x.svg"))[0], 0, 'a picture is drawn');
my $svg = file_text("$directory/x.svg");
like($svg, qr/$_/i, "it has the color $_") for qw(#1f4eb4 #1d8a34 #cc1f1f);

# ---- Refusals ----------------------------------------------------------------------------------------------

for my $case (
    [1, qr/no control point is free.*nearest area within reach is \d/, qw(--move 0:1,1 --free list:0 --pin 0)],
    [2, qr/no control point 9 at this level; it has 4/, qw(--move 9:1,1)],
    [2, qr/--move: expected I:dx,dy/, qw(--move 9)],
    [2, qr/--free: expected all, scale, near:K or list/, qw(--free some)],
    [2, qr/--energy: expected/, qw(--energy kinetic)],
    [2, qr/--keep: expected/, qw(--keep length)],
    [2, qr/--alpha/, qw(--alpha -1)],
    [2, qr/can be coarsened 2 times only; 3 need a multiple of 8 pieces, such as 8: 8 control points/, qw(--coarsen 3)],
    [2, qr/--area gives the area to be kept/, qw(--area 1 --keep none)],
) {
    my ($wanted, $message, @words) = @$case;
    ($status, $output, $errors) = edit($square, @words);
    is($status, $wanted, "@words: status $wanted");
    like($errors, $message, "@words: the message");
    is($output, '', "@words: nothing is printed");
}
file_write("$directory/wrong.bcifs", file_text($square) =~ s/smooth -2 \[ -1/smooth -2 [ -2/r);
($status, $output, $errors) = edit("$directory/wrong.bcifs", qw(--refine 1 --coarsen 1));
is($status, 2, 'filters that do not fit are refused');
like($errors, qr/wrong\.bcifs:\d+:\d+: error: .*smooth gives .*x0/, 'with the product');
my (undef, undef, $warning) = edit("$ROOT/automata/takagi.bcifs", qw(--move 0:1,1));
like($warning, qr/no bending energy, second differences are used instead/, 'a fractal is told so');

done_testing();
