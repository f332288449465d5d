#!/usr/bin/env perl
# Parameter maps. Expected classes come from conditions derived by hand ([SI]; norms and eigenvalues of the linear
# parts), never from an earlier output.
use strict;
use warnings;
use File::Basename qw(dirname);
use lib dirname(__FILE__) . '/lib';
use Bcifs qw(bcifs $ROOT $SANITIZED file_text scratch);
use Test::More;

my $corner = "$ROOT/automata/corner-cutting.bcifs";
my $takagi = "$ROOT/automata/takagi.bcifs";
my $four = "$ROOT/automata/four-point.bcifs";

# [params …, class] of every grid point.
sub map_rows {
    my ($file, @options) = @_;
    my ($status, $out, $err) = bcifs(['map', $file, @options], seconds => 60);
    is($status, 0, "map @options succeeds") or diag($err);
    my ($header, @lines) = split /\n/, $out;
    return map { [split /,/] } @lines;
}

sub in_classes {
    my ($class, @wanted) = @_;
    return scalar grep { $_ eq $class } @wanted;
}

# ---- Corner cutting ----------------------------------------------------------------------------------------

# The class at (i/n, j/n), all decisions in integers.
sub corner_wrong {
    my ($i, $j, $n, $class) = @_;
    my $inside = $i > 0 && $j > 0;
    # The largest absolute row sum is max(1-a-b, a+b); beyond, column sums bound the radius; a = 1 and b = 1 are
    # eigenvalues, and so is 1-a-b = 1.
    my $contractive = $inside
        && ($i + $j < $n || (2 * $i + $j < 2 * $n && $i + 2 * $j < 2 * $n));
    my $expanding = $i == $n || $j == $n || $i + $j == 0;
    return 1 if $contractive && $class eq 'not-contractive';
    return 1 if $contractive && $class eq 'undecided';
    return 1 if $expanding && $class ne 'not-contractive';
    return 0 unless $inside && $i + $j < $n;
    my $tangent = $n - 2 * $i - $j >= 0 && $n - $i - 2 * $j >= 0;
    return 1 if $tangent != in_classes($class, 'tangent-continuous', 'C1');
    return (2 * ($i + $j) == $n) != ($class eq 'C1');
}

for my $n ($SANITIZED ? (12) : (60, 48)) {
    my $count = $n + 1;
    my @rows = map_rows($corner, '--over', "a=0..1:$count", '--over', "b=0..1:$count");
    is(scalar @rows, $count * $count, "n = $n: one row for a grid point");
    my (@wrong, $at);
    for my $k (0 .. $#rows) {
        my ($i, $j) = (int($k / $count), $k % $count);
        my ($a, $b, $class) = @{$rows[$k]};
        push @wrong, "($a, $b): $class"
            if abs($a - $i / $n) > 1e-15 || abs($b - $j / $n) > 1e-15 || corner_wrong($i, $j, $n, $class);
    }
    is("@wrong[0 .. ($#wrong > 4 ? 4 : $#wrong)]", '', "n = $n: every class is what the exact conditions say");
}

# The axes in the other order.
{
    my %class = map { ("$_->[1],$_->[0]" => $_->[2]) } map_rows($corner, '--over', 'b=0..1:13', '--over', 'a=0..1:13');
    my @rows = map_rows($corner, '--over', 'a=0..1:13', '--over', 'b=0..1:13');
    is(join(' ', map { $_->[2] } @rows), join(' ', map { $class{"$_->[0],$_->[1]"} } @rows), 'axes may be exchanged');
}

# ---- Lines -------------------------------------------------------------------------------------------------

# The arc's displacement shrinks by w; the chord's halves have slopes that agree for w = 1/4 only (the parabola).
{
    (my $text = file_text($takagi)) =~ s/^param w.*$/param w = 1\/2/m;
    my @rows = map_rows(scratch('takagi.bcifs', $text), '--over', 'w=0..3/2:61');
    my @wrong = grep {
        my ($w, $class) = @$_;
        $w >= 1 ? $class ne 'not-contractive' : $w == 0.25 ? $class ne 'C1' : $class ne 'contractive'
    } @rows;
    is(join(' ', map { "@$_" } @wrong), '', 'Takagi: contractive below 1, smooth at 1/4 only');
    is($rows[10][0], '0.25', 'and the grid hits 1/4');
}

# C^1 for 0 < w < (sqrt(5) - 1)/8 (Dyn, Levin, Gregory 1987), and not beyond 0.19274 (Hechler, Mößner, Reif 2009);
# w = 0 is the control polygon.
{
    my @rows = map_rows($four, '--over', $SANITIZED ? 'w=0..1/4:17' : 'w=0..1/4:65');
    my %class = map { ($_->[0] => $_->[1]) } @rows;
    is($class{0.0625}, 'C1', 'four-point: w = 1/16 is certified C^1');
    my $certain = (sqrt(5) - 1) / 8;
    my @inside = grep { $_->[0] > 0 && $_->[0] < $certain && $_->[1] ne 'C1' } @rows;
    my @outside = grep { ($_->[0] <= 0 || $_->[0] > 0.19274) && $_->[1] eq 'C1' } @rows;
    is(join(' ', map { "@$_" } @inside), '', 'all of the interval that is known to be C^1 is');
    is(join(' ', map { "@$_" } @outside), '', 'nothing outside of it is');
}

# ---- States with arguments, params that follow ---------------------------------------------------------------

{
    my $text = "automaton t\nparam a = 1/4\nparam b = 1/2-a\n" . file_text($corner) =~ s/\A.*?(?=^vertex)//smr;
    my @rows = map_rows(scratch('follow.bcifs', $text), '--over', 'a=1/8..3/8:3');
    is(join(' ', map { $_->[1] } @rows), 'C1 C1 C1', 'a param follows the one that its default names');
    @rows = map_rows(scratch('follow.bcifs', $text), '--over', 'a=1/8..3/8:3', '--set', 'b=1/4');
    is(join(' ', map { $_->[1] } @rows), 'tangent-continuous C1 tangent-continuous', 'and does not when it is set');
}
{
    my $text = file_text("$ROOT/automata/nonuniform-quadratic.bcifs");
    if ($text =~ /^figure/m) {
        $text =~ s/^(automaton[^\n]*\n)/$1param r = 1 in 1\/8..8\n/m;
        $text =~ s/intervals\s*\[\s*\S+/intervals [ r/;
        my @rows = map_rows(scratch('intervals.bcifs', $text), '--over', 'r=1/2..2:3');
        is(join(' ', map { $_->[1] } @rows), 'C1 C1 C1', 'intervals that are params: B-splines are C^1 for all of them')
            or diag('with several states the exponents are those of the dyadic parameter');
    }
}

# ---- Threads and formats -----------------------------------------------------------------------------------

{
    my @grid = ('--over', 'a=0..1:31', '--over', 'b=0..1:31');
    for my $format (qw(csv svg png)) {
        my @outputs = map {
            my $path = scratch("threads.$format");
            my ($status) = bcifs(['map', $corner, @grid, '--threads', $_, '-o', $path]);
            my $bytes = $status == 0 ? file_text($path) : "status $status";
            $bytes =~ s/--threads \d+//;   # the command line that the picture tells
            $format eq 'png' ? $bytes =~ s{.*?(?=IDAT)}{}sr : $bytes
        } 1, 2, 7;
        is($outputs[1], $outputs[0], "$format: two threads make what one makes");
        is($outputs[2], $outputs[0], "$format: seven threads make what one makes");
    }
}

{
    my $path = scratch('map.svg');
    my ($status) = bcifs(['map', $corner, '--over', 'a=0..1:21', '--over', 'b=0..1:21', '-o', $path]);
    my $svg = file_text($path);
    is($status, 0, 'a vector picture');
    is_deeply([$svg =~ /<path class="([^"]+)"/g], [qw(not-contractive contractive tangent-continuous C1)],
        'has a path for each class');
    like($svg, qr/>1 \xe2\x88\x92 2a \xe2\x88\x92 b = 0</, 'the first condition is labeled');
    like($svg, qr/>1 \xe2\x88\x92 a \xe2\x88\x92 2b = 0</, 'and the second');
    like($svg, qr{<bcifs:command>bcifs map .*</bcifs:command>}, 'the command is told');
    like($svg, qr{<bcifs:automaton file=}, 'and the automaton');
    # The rectangles cover the plot once: their areas sum to that of the frame.
    my ($area, $x0, $x1, $y0, $y1) = (0, 1e9, -1e9, 1e9, -1e9);
    for my $d ($svg =~ /<path class="[^"]+"[^>]* d="([^"]*)"/g) {
        while ($d =~ /M([\d.]+) ([\d.]+)H([\d.]+)V([\d.]+)H/g) {
            $area += ($3 - $1) * ($4 - $2);
            $x0 = $1 if $1 < $x0;
            $x1 = $3 if $3 > $x1;
            $y0 = $2 if $2 < $y0;
            $y1 = $4 if $4 > $y1;
        }
    }
    my $frame = ($x1 - $x0) * ($y1 - $y0);
    ok(abs($area - $frame) < 1e-3 * $frame, 'the fields cover the plot once');
    ($status) = bcifs(['map', $takagi, '--over', 'w=0..1:5', '-o', $path]);
    unlike(file_text($path), qr/ = 0</, 'no condition is drawn for another scheme');
}
{
    # Renamed, exchanged and rewritten, it is still corner cutting; with another entry it is not.
    my $text = "automaton t\nparam s = 1/4\nparam t = 1/4\n"
        . 'vertex joint 2 { sub joint [ 1-t s; t 1-s ] }' . "\n"
        . 'edge arc 3 { start joint at 0 1' . "\n" . 'end joint at 1 2' . "\n"
        . 'sub arc [ 1-t s 0; t 1-s 1-t; 0 0 t ]' . "\n" . 'sub arc [ s 0 0; 1-s 1-t s; 0 t 1-s ] }' . "\n";
    my $path = scratch('renamed.svg');
    my ($status) = bcifs(['map', scratch('renamed.bcifs', $text), '--over', 's=0..1:5', '--over', 't=0..1:5', '-o', $path]);
    is($status, 0, 'a renamed file');
    like(file_text($path), qr/>1 \xe2\x88\x92 2t \xe2\x88\x92 s = 0</, 'is recognized, its params in either order');
    my $path_png = scratch('renamed.png');
    bcifs(['map', scratch('renamed.bcifs'), '--over', 's=0..1:5', '--over', 't=0..1:5', '-o', $path_png, '--width', 300]);
    my $png = file_text($path_png);
    is(substr($png, 0, 8), "\x89PNG\r\n\x1a\n", 'a pixel picture');
    is(unpack('N', substr $png, 16, 4), 300, 'as wide as asked for');
}

# ---- Refusals ----------------------------------------------------------------------------------------------

my @a = ('--over', 'a=0..1:5');
for my $case (
    ['no --over', []],
    ['three axes', [@a, '--over', 'b=0..1:5', '--over', 'a=0..1:5']],
    ['an axis twice', [@a, @a]],
    ['no range', ['--over', 'a']],
    ['no count', ['--over', 'a=0..1']],
    ['no dots', ['--over', 'a=0:5']],
    ['a count of 1', ['--over', 'a=0..1:1']],
    ['a count that is no number', ['--over', 'a=0..1:x']],
    ['a count beyond the limit', ['--over', 'a=0..1:4194305']],
    ['too many grid points', ['--over', 'a=0..1:4000', '--over', 'b=0..1:4000']],
    ['an empty range', ['--over', 'a=1..0:5']],
    ['a range of one number', ['--over', 'a=1/2..1/2:5']],
    ['a range beyond the declared one', ['--over', 'a=0..2:5']],
    ['not a number', ['--over', 'a=zero..1:5']],
    ['division by zero', ['--over', 'a=1/0..1:5']],
    ['an unknown param', ['--over', 'c=0..1:5']],
    ['a param that was set', [@a, '--set', 'a=1/2']],
    ['an unknown state', [@a, '--state', 'ark']],
    ['no threads', [@a, '--threads', '0']],
    ['too many threads', [@a, '--threads', '257']],
    ['a negative effort', [@a, '--effort', '-1']],
    ['an unknown format', [@a, '--format', 'obj']],
    ['an unknown ending', [@a, '-o', scratch('map.obj')]],
    ['too narrow a picture', [@a, '--format', 'svg', '--width', '16']],
) {
    my ($name, $options) = @$case;
    my ($status, $out, $err) = bcifs(['map', $corner, @$options]);
    is($status, 2, "$name: status 2");
    is($out, '', "$name: nothing is written");
    like($err, qr/\S/, "$name: and it says why");
}
{
    my $text = "automaton t\nparam a = 1/4\n"
        . "cell c 2 { sub c [ a 1/4; 3/4 3/4 ] }\nfigure f { piece c at 0 1\npoints [ 0 0; 1 0 ] }\n";
    my ($status, $out, $err) = bcifs(['map', scratch('false.bcifs', $text), '--over', 'a=0..1:5']);
    is($status, 1, 'equations that hold for one value only: status 1');
    like($err, qr/for all a/, 'and it says so');
}

done_testing();
