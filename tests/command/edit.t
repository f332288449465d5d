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

# ---- Editing on ----------------------------------------------------------------------------------------------

# The fine points of one edit are the control points of the next: that is the same as both edits in one session, so the
# second begins with what the first ended with.
{
    my $first = decode_json((edit($square, qw(--refine 3 --coarsen 2 --move 1:1/2,-1/4 --json)))[1]);
    is((edit($square, qw(--refine 3 --coarsen 2 --move 1:1/2,-1/4 -o), "$directory/first.csv"))[0], 0, 'a first edit');
    my ($code, $json) = edit($square, '--points', "$directory/first.csv", qw(--coarsen 3 --move 2:0,1 --free all --json));
    my $second = decode_json($json);
    is($code, 0, 'a second edit of its points');
    ok(abs($second->{area}{before} - $first->{area}{after}) < 1e-13, 'it begins with the area of the first');
    ok(abs($second->{area}{after} - 10 / 3) < 1e-12, 'and ends with it');
    is(scalar @{ $second->{scale_points} }, 4, 'three levels above 32 points there are 4');
    my ($same) = (edit($square, '--points', "$directory/first.csv", qw(--keep none --json)))[1];
    is_deeply(decode_json($same)->{points}, $first->{points}, 'points are written and read to the last bit');
    for my $format (qw(npy f64 json)) {
        is((edit($square, qw(--refine 1 --move 0:1,1 -o), "$directory/x.$format"))[0], 0, "-o x.$format");
        ok(-s "$directory/x.$format", "x.$format holds something");
    }
    is(-s "$directory/x.f64", 8 * 2 * 8, '8 points of two doubles');
    is_deeply(decode_json(file_text("$directory/x.json"))->{area}{relative_error} <= 1e-12, 1, '-o x.json is the report');
}

# ---- Drawn outlines ------------------------------------------------------------------------------------------

# A rectangle of 4 by 3, run through clockwise as y points up. At each corner the curve is a parabola from the middle of
# one side to that of the next, which cuts a third off the triangle between: 1/3 · 1/2 · 2 · 3/2.
file_write("$directory/box.svg", '<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0 h4 v3 h-4 z"/></svg>');
for my $options ([], [qw(--refine 2 --coarsen 1 --move 0:1,0)], [qw(--refine 4 --coarsen 4 --move 3:1/3,-1 --free near:1)]) {
    my ($code, $json, $told) = edit($square, '--curve', "$directory/box.svg", '--json', @$options);
    is($code, 0, "--curve @$options") or diag($told);
    my $area = $code ? {} : decode_json($json)->{area};
    ok(abs($area->{before} + 12 - 4 / 2) < 1e-13 && $area->{relative_error} <= 1e-12, "the outline's area is 12 - 2");
}
file_write("$directory/rectangle.svg", '<svg xmlns="http://www.w3.org/2000/svg"><rect width="3" height="4"/></svg>');

# ---- The options ---------------------------------------------------------------------------------------------

{
    my @move = qw(--refine 3 --coarsen 2 --move 1:1,-1/2 --json);
    my $report = sub { decode_json((edit($square, @move, @_))[1]) };
    my ($loose, $usual, $strict) = map { $report->('--alpha', $_) } qw(1/100 100 1e6);
    ok($loose->{energy}{after} <= $usual->{energy}{after} && $usual->{energy}{after} <= $strict->{energy}{after},
        'the smaller alpha, the smaller the energy');
    is_deeply($report->(qw(--alpha 100 --free scale --keep area --energy bending)), $report->(), 'the defaults');
    is($report->('--energy', $_)->{energy}{kind}, $_, "--energy $_") for qw(bending discrete none);
    # Moves of one point add up; expressions are read.
    is_deeply($report->(qw(--move 2:sqrt(4),0)), decode_json((edit($square, @move, qw(--move 2:1,0 --move 2:1,0)))[1]),
        '--move may be repeated');
    my $all = $report->(qw(--free all));
    ok($all->{global} && $all->{area}{relative_error} <= 1e-12, '--free all');
    my (undef, $quiet, $silence) = edit("$ROOT/automata/koch.bcifs", qw(--move 0:0.1,0.1 --quiet));
    is($silence, '', '--quiet: no warning');
    (undef, undef, $silence) = edit("$ROOT/automata/koch.bcifs", qw(--move 0:0.1,0.1 --energy discrete));
    is($silence, '', '--energy discrete: neither');
    my ($code, $text) = edit($square, qw(--move 0:1,1));
    like($text, qr/area before +3\.3333.*\n.*deformed.*\n.*after +3\.3333.*\n.*target +3\.3333.*\n.*missed by/, 'the text');
    my ($pictured, $json) = edit($square, qw(--move 0:1,1 --json -o), "$directory/both.svg");
    ok($pictured == 0 && decode_json($json)->{area}{after} > 3 && -s "$directory/both.svg", '--json beside a picture');
    my $svg = file_text("$directory/both.svg");
    my @paths = $svg =~ /<path/g;
    cmp_ok(scalar @paths, '>=', 3, 'a path for each curve');
    edit($square, qw(--move 0:1,1 --keep none -o), "$directory/two.svg");
    unlike(file_text("$directory/two.svg"), qr/#cc1f1f/, '--keep none: no red curve');
    is((edit($square, qw(--move 0:1,1 --width 200 --depth 3 -o), "$directory/x.png"))[0], 0, 'a PNG');
    like(file_text("$directory/x.png"), qr/^\x89PNG.{4}.{8}\0\0\0\xc8/s, '200 pixels wide');
}

# ---- Bad input -----------------------------------------------------------------------------------------------

my $number = qr/expected a number/;
my $count = qr/expected a whole number from 0/;
for my $case (
    [2, qr/usage/],
    [2, $number, $square, '--move', '0:nan,1'],
    [2, $number, $square, '--move', '0:inf,1'],
    [2, qr/too large/, $square, '--move', '0:1e400,1'],
    [2, qr/division by zero/, $square, '--move', '0:1/0,1'],
    [2, qr/expected I:dx,dy/, $square, '--move', '0:1'],
    [2, $number, $square, '--move', '0:,'],
    [2, $number, $square, '--move', '0:1,2,3'],
    [2, $number, $square, '--move', ':1,1'],
    [2, $count, $square, '--move', '-1:1,1'],
    [2, $count, $square, '--move', '1.5:1,1'],
    [2, $count, $square, '--move', '99999999999999999999:1,1'],
    [2, qr/expected/, $square, '--move', ('9' x 5000) . ':1,1'],
    [2, qr/alpha must be a number from 0 to 1e300/, $square, qw(--alpha 1e308)],
    [2, $number, $square, qw(--alpha nan)],
    [2, $number, $square, qw(--area inf)],
    [1, qr/cannot be made 1e\+?300: .*nearest area within reach is/, $square, qw(--area 1e300)],
    [2, $number, $square, qw(--free near:)],
    [2, $count, $square, qw(--free near:-1)],
    [2, $count, $square, qw(--free near:99999999999)],
    [1, qr/no control point is free to answer; the nearest area within reach is 1\.66/, $square, qw(--free near:0 --move 0:1,1)],
    [2, qr/expected control points such as/, $square, qw(--free list:)],
    [2, qr/expected control points such as/, $square, qw(--free list:0,,1)],
    [2, qr/no control point 4 at this level; it has 4/, $square, qw(--free list:4)],
    [2, qr/no control point 7 at this level/, $square, qw(--pin 7)],
    [2, $number, $square, qw(--pin x)],
    [2, qr/at most \d+ control points/, $square, '--pin', join(',', (0) x 5000)],
    [2, $count, $square, qw(--coarsen -1)],
    [2, qr/at most 64 levels/, $square, qw(--refine 65)],
    [2, qr/at most 64 levels/, $square, qw(--coarsen 1000)],
    [3, qr/cannot write/, $square, '-o', "$directory/none/x.svg"],
    [2, qr/unknown format 'obj'/, $square, '-o', "$directory/x.obj"],
    [2, qr/a picture needs a file/, $square, qw(--format svg)],
    [2, qr/greatest depth/, $square, qw(--depth 70 -o), "$directory/deep.svg"],
    [2, qr/no option '--unknown'/, $square, '--unknown'],
    [2, qr/is not a curve/, "$ROOT/automata/fern.bcifs"],
    [2, qr/no figure 'nope'/, $square, qw(--figure nope)],
    [2, qr/cannot open/, "$directory/none.bcifs"],
    [2, qr/cannot open/, $square, '--points', "$directory/none.csv"],
    [2, qr/no <path>.*<rect>/, $square, '--curve', "$directory/rectangle.svg"],
    [2, qr/exclude each other/, $square, '--curve', "$directory/box.svg", '--points', "$directory/first.csv"],
) {
    my ($wanted, $message, @words) = @$case;
    my ($code, $printed, $told) = edit(@words);
    my $name = substr "@words", 0, 120;
    $name =~ s/\Q$ROOT\E\/automata\/|\Q$directory\E\///g;
    is($code, $wanted, "$name: status $wanted");
    like($told, $message, "$name: the message");
    is($printed, '', "$name: nothing is printed");
    ok($told =~ /^(?:bcifs: |.+?: error: )/ && $told !~ /nan\b.*nan\b.*nan\b|\x00/, "$name: one report");
}
ok(!-e "$directory/x.obj" && !-e "$directory/deep.svg", 'no file is left of what failed');

# Points that are none, too few, in space.
for my $case (["1,2\n3\n", qr/x\.csv:2/], ["0,0\n1,0\n", qr/./], ["0,0,0\n1,0,0\n1,1,0\n0,1,1\n", qr/3 coordinates/],
    ["0,0\n1,nan\n1,1\n0,1\n", qr/nan/], ["", qr/./]) {
    my ($rows, $message) = @$case;
    my ($code, $printed, $told) = edit($square, '--points', file_write("$directory/x.csv", $rows));
    (my $shown = $rows) =~ s/\n/ /g;
    ok($code == 2 || $rows =~ /^0,0\n1,0\n$/ && $code == 0, "points $shown: status $code") or diag($told);
    like($told, $message, "points $shown: the message") if $code;
}

# Filters that do not fit, each in its own way: the file, the line and the column are told, and the product.
for my $change (['smooth -2 \\[ -1/4', 'smooth -2 [ -1/3'], ['detail -2 \\[ 1/4', 'detail -2 [ 1/5'], ['smooth -2', 'smooth -1'],
    ['detail -2 \\[ 1/4 -3/4 3/4 -1/4', 'detail -2 [ -1/4 3/4 3/4 -1/4']) {
    my ($from, $to) = @$change;
    (my $text = file_text($square)) =~ s/$from/$to/ or die;
    my $file = file_write("$directory/wrong.bcifs", $text);
    my ($code, $printed, $told) = edit($file, qw(--refine 1 --coarsen 1));
    is($code, 2, "$to: refused");
    like($told, qr/wrong\.bcifs:3[01]:13: error: .*P A \+ Q B = I: .* gives .* instead of /, "$to: where, and the product");
    is($printed, '', "$to: nothing is printed");
}

done_testing();
