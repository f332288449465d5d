#!/usr/bin/env perl
# Bad input: nothing crashes, hangs or gives nonsense. A refusal is exit status 2, one line that says where and what,
# nothing on standard output and no output file; what the system fails is exit status 3 and no partial file.
# Every run has a few seconds and, without sanitizers, 256 MiB.
use strict;
use warnings;
use utf8;
use FindBin;
use lib "$FindBin::Bin/lib";
use Bcifs;
use Encode qw(decode_utf8 encode_utf8);
use Test::More;

binmode $_, ':utf8' for map { Test::More->builder->$_ } qw(output failure_output todo_output);

my %limits = (seconds => 10, kilobytes => 256 * 1024);

# Reports with bytes that a terminal must not be given: what is not UTF-8, and control characters.
my @unclean;

# What is wrong with a refusal: bcifs(words) must exit with 2 and say `file:line:col: error: …`, `file: error: …` or
# `bcifs: …`, in a line that matches.
sub refusal_problems {
    my ($words, $pattern, %option) = @_;
    my $output = scratch('output-that-must-not-be');
    unlink $output;
    my ($status, $out, $err) = bcifs($words, %limits, %option);
    my @wrong;
    push @wrong, "status $status" if $status ne '2';
    push @wrong, 'standard output: ' . substr $out, 0, 80 if $out ne '';
    my ($first) = grep { !/: warning: / && /: error: |^bcifs: / } split /\n/, decode_utf8($err);
    $first //= '';
    push @wrong, "standard error: $first" if $first !~ /^(?:.+?:\d+:\d+: error: |.+?: error: |bcifs: )./;
    push @wrong, "no match of $pattern: " . substr $err, 0, 200 if decode_utf8($err) !~ $pattern;
    push @wrong, 'a long report' if length $err > 20_000 && $err !~ /n{1000}/;
    push @unclean, "@$words" if !utf8::decode(my $copy = $err) || $err =~ /[\x00-\x08\x0b-\x1f\x7f]/;
    push @wrong, 'an output file' if -e $output;
    return @wrong;
}

sub refused {
    my ($words, $pattern, $what, %option) = @_;
    my @wrong = refusal_problems($words, $pattern, %option);
    is_deeply(\@wrong, [], $what);
}

# A text is refused by check, by eval, and by eval into a file; and by fmt when it is no automaton at all.
sub text_refused {
    my ($text, $pattern, $what, @commands) = @_;
    my $file = scratch('bad.bcifs', $text);
    my $output = scratch('output-that-must-not-be');
    @commands = qw(check eval) if !@commands;
    my @wrong;
    for my $command (@commands) {
        push @wrong, map { "$command: $_" } refusal_problems([ $command, $file, '-o', "$output" ], $pattern);
    }
    is_deeply(\@wrong, [], $what);
}

my $line = "vertex v 1 { }\nedge line 2 { start v at 0 end v at 1 sub line [ 1 1/2; 0 1/2 ] sub line [ 1/2 0; 1/2 1 ] }\n";
my $figure = "figure f { open line points [ 0 0; 1 2; 3 1 ] }\n";
my $good = scratch('good.bcifs', "automaton good\n$line$figure");
my $chaikin = "$ROOT/automata/chaikin.bcifs";
my $dragon = "$ROOT/automata/dragon.bcifs";

# ---- Files that are no automata --------------------------------------------------------------------------------

text_refused('', qr/expected 'automaton'/, 'an empty file', qw(check eval fmt));
text_refused("\n\n  \n", qr/expected 'automaton'/, 'blank lines', qw(check eval fmt));
text_refused("# a comment\n", qr/expected 'automaton'/, 'a comment only', qw(check eval fmt));
text_refused("\xEF\xBB\xBF", qr/expected 'automaton'/, 'a byte order mark only', qw(check eval fmt));
text_refused("automaton x\0", qr/bad\.bcifs:1:12: error: .*NUL/, 'a NUL byte', qw(check eval fmt));
text_refused("automaton x\n# \xff", qr/bad\.bcifs:2:3: error: .*UTF-8.*0xFF/, 'a byte that is not UTF-8', qw(check eval fmt));
text_refused("automaton x\n# \xc0\xaf", qr/UTF-8/, 'an overlong character', qw(check eval fmt));
text_refused("automaton x\n# \xed\xa0\x80", qr/UTF-8/, 'a surrogate', qw(check eval fmt));
text_refused("automaton x\n# \xf4\x90\x80\x80", qr/UTF-8/, 'beyond Unicode', qw(check eval fmt));
text_refused("automaton x\n# \xe2\x82", qr/UTF-8/, 'a character cut off', qw(check eval fmt));
text_refused("automaton x\n# \e[31mred", qr/control character 0x1B/, 'an escape sequence', qw(check eval fmt));
text_refused("automaton x\n# \xc2\x9b31m", qr/control character 0x9B/, 'an escape sequence of one character', qw(check eval fmt));
text_refused("automaton x\rvertex v 1 { }", qr/carriage return/, 'old line ends', qw(check eval fmt));
{
    srand 5;
    text_refused(join('', map { chr int rand 256 } 1 .. 100_000), qr/error/, 'random bytes', qw(check eval fmt));
    text_refused(join('', map { chr(32 + int rand 95) . (rand() < 0.02 ? "\n" : '') } 1 .. 100_000), qr/error/, 'random characters', qw(check eval fmt));
    my @marks = split //, '{}[](),;=+-*/%^?. ';
    text_refused('automaton x ' . join('', map { $marks[ rand @marks ] } 1 .. 50_000), qr/error/, 'random marks', qw(check eval fmt));
    no warnings 'qw';
    my @words = qw(automaton use as param in let vertex edge face cell affine sub start end boundary join reversed refine
        mask at for sum wavelet smooth detail figure open closed piece size intervals points displace p q 1 2 0.5 ? { } [ ] ( ) , ; = + - * / % ^ . ..);
    for my $round (1 .. 10) {
        text_refused("automaton x\n" . join(' ', map { $words[ rand @words ] . (rand() < 0.1 ? "\n" : '') } 1 .. 3000), qr/error/, "random words, $round", qw(check eval fmt));
    }
}
{
    open my $program, '<:raw', $BCIFS or die;
    read $program, my $bytes, 200_000;
    text_refused($bytes, qr/NUL|UTF-8|control/, 'a program', qw(check eval fmt));
}
text_refused("automaton x\n" . ' ' x (16 * 1024 * 1024), qr/longer than 16777216 bytes/, 'a file of more than 16 MiB', qw(check fmt));
refused([ $_, $ROOT ], qr/directory/, "$_ of a directory") for qw(check eval fmt);
refused([ $_, scratch('missing.bcifs') ], qr/cannot open .*No such file/, "$_ of a missing file") for qw(check eval fmt);
refused([ $_, '' ], qr/./, "$_ of a file without a name") for qw(check eval fmt);
refused([ 'check', "$good/x" ], qr/cannot open/, 'a path through a file');
refused([ 'check', '-' ], qr/<stdin>:1:1: error|<stdin>: error/, 'standard input that is empty', stdin => '');
SKIP: {
    my $secret = scratch('secret.bcifs', 'automaton x');
    chmod 0, $secret;
    skip 'everything can be read', 1 if -r $secret;
    refused([ 'check', $secret ], qr/Permission denied/, 'a file that may not be read');
}
SKIP: {
    skip 'no /dev/zero', 1 if !-e '/dev/zero';
    refused([ 'check', '/dev/zero' ], qr/NUL|longer/, 'a file without end');
}

# Every prefix of a file, and every file with one byte changed: no crash, and an exit status that means something.
{
    my $text = file_text("$ROOT/automata/nonuniform-quadratic.bcifs") =~ s/#.*//gr =~ s/[ \n]+/ /gr;
    $text =~ s/ (vertex|edge|let|figure|points|intervals|sub|start|end) /\n$1 /g;
    my ($odd, %seen) = (0);
    srand 6;
    for my $round (1 .. 120) {
        my $copy = $text;
        if ($round % 2) { $copy = substr $copy, 0, int rand length $copy }
        else { substr($copy, rand length $copy, int rand 3) = chr(32 + int rand 95) for 1 .. 1 + int rand 3 }
        my ($status, $out, $err) = bcifs([ 'check', '-', '--quiet' ], %limits, stdin => $copy);
        $seen{$status}++;
        $odd++, diag("status $status\n$copy\n$err") if $status !~ /^[012]$/ || ($status eq '2' && $err !~ /error: /);
    }
    is($odd, 0, 'cut and changed files are judged or refused');
    cmp_ok($seen{2} // 0, '>', 40, 'mostly refused');
}

# ---- Mistakes in an automaton ----------------------------------------------------------------------------------

for my $case (
    [ 'a syntax error', "vertex v 1 {", qr/:2:\d+: error: expected|:3:1: error: expected/ ],
    [ 'an unknown state', "vertex v 1 { sub w [ 1 ] }", qr/:2:18: error: unknown state 'w'/ ],
    [ 'an unknown name', "vertex v 1 { sub v [ w ] }", qr/:2:22: error: unknown name 'w'/ ],
    [ 'an unknown function', "vertex v 1 { sub v [ w(1) ] }", qr/:2:22: error: unknown function 'w'/ ],
    [ 'a ragged matrix', "vertex v 2 { sub v [ 1 2; 3 ] }", qr/:2:27: error: row 2 has 1 entry/ ],
    [ 'a division by zero', "vertex v 1 { sub v [ 1/0 ] }", qr/:2:23: error: division by zero/ ],
    [ 'a division by a zero that is exact', "vertex v 1 { sub v [ 1/(0.1+0.2-0.3) ] }", qr/division by zero/ ],
    [ 'zero to a negative power', "vertex v 1 { sub v [ (1-1)^-2 ] }", qr/division by zero/ ],
    [ 'a remainder of zero', "vertex v 1 { sub v [ 1%0 ] }", qr/division by zero/ ],
    [ 'no number: a root', "vertex v 1 { sub v [ sqrt(-1) ] }", qr/not a finite number/ ],
    [ 'no number: a logarithm', "vertex v 1 { sub v [ log(-1) ] }", qr/not a finite number/ ],
    [ 'no number: a power', "vertex v 1 { sub v [ (-1)^0.5 ] }", qr/not a finite number/ ],
    [ 'infinity', "vertex v 1 { sub v [ log(0) ] }", qr/not a finite number/ ],
    [ 'infinity by a product', "vertex v 1 { sub v [ 1e200*1e200 ] }", qr/not a finite number/ ],
    [ 'infinity by a sum', "vertex v 1 { sub v [ 1e308+1e308 ] }", qr/not a finite number/ ],
    [ 'infinity by a power', "vertex v 1 { sub v [ 10^400 ] }", qr/not a finite number/ ],
    [ 'infinity in a let', "let a = exp(1e3)\nvertex v 1 { sub v [ a ] }", qr/not a finite number/ ],
    [ 'nan as a name', "vertex v 1 { sub v [ nan ] }", qr/unknown name 'nan'/ ],
    [ 'inf as a name', "vertex v 1 { sub v [ inf ] }", qr/unknown name 'inf'/ ],
    [ 'an index that is too large', "vertex v 1 { }\nedge e 2 { start v at 2 end v at 1 sub e [ 1 0; 0 1 ] }", qr/:3:23: error: .*must lie in 0\.\.1, found 2/ ],
    [ 'an index that is negative', "vertex v 1 { }\nedge e 2 { start v at [ -1 ] end v at 1 sub e [ 1 0; 0 1 ] }", qr/must lie in 0\.\.1, found -1/ ],
    [ 'an index of p that is too large', "cell c 2 { sub c { q[0] = p[7] q[1] = p[0] } }", qr/must lie in 0\.\.1, found 7/ ],
    [ 'an index of q that is too large', "cell c 2 { sub c { q[0] = p[0] q[2] = p[0] } }", qr/q\[2\]/ ],
    [ 'a piece on a point that is not there', "${line}figure f { piece line at 0 5 points [ 0; 1 ] }", qr/there is no point 5/ ],
    [ 'a state defined twice', "vertex v 1 { }\nvertex v 1 { }", qr/:3:8: error: .*twice/ ],
    [ 'a param and a let of one name', "param a = 1\nlet a = 2\nvertex v 1 { }", qr/:3:5: error: .*twice/ ],
    [ 'a let named like a function', "let sqrt = 2\nvertex v 1 { }", qr/built in/ ],
    [ 'a figure defined twice', "$line$figure$figure", qr/:5:8: error: .*twice/ ],
    [ 'a let that needs itself', "let a = b\nlet b = a\nvertex v 1 { }", qr/defined by itself/ ],
    [ 'a let that calls itself', "let f(u) = f(u-1)\nvertex v 1 { sub v [ f(3) ] }", qr/defined by itself/ ],
    [ 'a param that needs itself', "param a = a\nvertex v 1 { }", qr/no value yet/ ],
    [ 'a file that uses itself', "use \"bad.bcifs\"\nvertex v 1 { }", qr/circular use/ ],
    [ 'a file that uses itself by another path', "use \"./././bad.bcifs\"\nvertex v 1 { }", qr/circular use/ ],
    [ 'a used file that is missing', "use \"missing.bcifs\"\nvertex v 1 { }", qr/missing\.bcifs'/ ],
    [ 'a used file that is a directory', "use \"/\"\nvertex v 1 { }", qr/directory/ ],
    [ 'a used file without a name', "use \"\"\nvertex v 1 { }", qr/error: / ],
    [ 'a surface of too few rows', "${line}figure f { open line open line size 1 3 points [ 0; 1; 2 ] }", qr/too few/ ],
    [ 'too few points', "${line}figure f { open line points [ 0 0 ] }", qr/too few points/ ],
    [ 'a closed curve of too few points', "${line}figure f { closed line points [ 0 0 ] }", qr/too few points/ ],
    [ 'too few control points of a piece', "${line}figure f { piece line at 0 points [ 0 0; 1 1 ] }", qr/2 control points, found 1/ ],
    [ 'wrong numbers of arguments', "vertex v(u) 1 { sub v [ 1 ] }", qr/takes 1 argument, found 0/ ],
    [ 'too many children in a join', "vertex v 1 { }\nface f 1 { boundary b = v at 0 sub f [ 1 ] join 0.b = 4000000.b }", qr/there is no child 4000000/ ],
) {
    my ($what, $text, $pattern) = @$case;
    text_refused("automaton x\n$text", $pattern, $what);
}

# ---- Too deep, too long, too large -----------------------------------------------------------------------------

my $many = 100_000;
for my $case (
    [ 'parentheses 100000 deep', 'let a = ' . '(' x $many . '1' . ')' x $many, qr/nested more than \d+ levels/ ],
    [ 'parentheses 100000 deep that do not close', 'let a = ' . '(' x $many, qr/nested more than/ ],
    [ 'calls 100000 deep', 'let a = ' . 'abs(' x $many . '1' . ')' x $many, qr/nested more than/ ],
    [ 'signs 100000 deep', 'let a = ' . '-' x $many . '1', qr/nested more than/ ],
    [ 'powers 100000 deep', 'let a = ' . '1^' x $many . '1', qr/nested more than/ ],
    [ 'a sum of 100000 terms', 'let a = 1' . '+1' x $many, qr/more than \d+ operations/ ],
    [ 'a product of 100000 factors', 'let a = 1' . '*1' x $many, qr/more than \d+ operations/ ],
    [ 'parentheses in a matrix', 'vertex v 1 { sub v [ ' . '(' x $many . '1' . ')' x $many . ' ] }', qr/nested more than/ ],
    [ 'loops 100000 deep', 'vertex v 1 { sub v { ' . 'for i in 0..0 { ' x $many . ' q[0] = p[0] ' . '}' x $many . ' } }', qr/nested more than|more than \d+ loops/ ],
    [ 'sums 10000 deep', 'vertex v 1 { sub v { q[0] = ' . 'sum(i in 0..0, ' x 10_000 . 'p[0]' . ')' x 10_000 . ' } }', qr/nested more than|more than \d+ loops/ ],
    [ 'points of points', 'vertex v 1 { sub v { q[0] = ' . 'p[' x $many . '0' . ']' x $many . ' } }', qr/nested more than/ ],
    [ 'brackets 100000 deep', 'vertex v 1 { sub v ' . '[' x $many . ' ] }', qr/expected an entry/ ],
    [ 'braces 100000 deep', 'vertex v 1 ' . '{' x $many, qr/expected/ ],
    [ 'a number of 100000 digits', 'vertex v 1 { sub v [ ' . '9' x $many . ' ] }', qr/too large/ ],
    [ '1e400', 'vertex v 1 { sub v [ 1e400 ] }', qr/:2:22: error: this number is too large/ ],
    [ 'an exponent of 100000 digits', 'vertex v 1 { sub v [ 1e' . '9' x $many . ' ] }', qr/too large/ ],
    [ 'a name of 100000 letters', 'let ' . 'n' x $many . ' = 1', qr/the limit is/ ],
    [ 'a string of 100000 characters that is no file', 'use "' . 'n' x $many . '"', qr/error: / ],
    [ 'a vertex of a billion points', 'vertex v 1000000000 { }', qr/must lie in 1\.\.\d+, found 1000000000|found 1e9/ ],
    [ 'a vertex of 1e300 points', 'vertex v 1e300 { }', qr/must lie in 1\.\.\d+/ ],
    [ 'a vertex of no points', 'vertex v 0 { }', qr/must lie in 1\.\./ ],
    [ 'a vertex of minus one points', 'vertex v -1 { }', qr/must lie in 1\.\./ ],
    [ 'a vertex of half a point', 'vertex v 1/2 { }', qr/must be an integer/ ],
    [ 'affine 99', 'cell c affine 99 { }', qr/an integer from 1 to 16, found '99'/ ],
    [ 'affine 99999999999999999999', 'cell c affine 99999999999999999999 { }', qr/an integer from 1 to 16/ ],
    [ 'a billion children', 'edge e { mask 1000000000 [ 1 2 1 ] }', qr/2 to \d+ children/ ],
    [ 'more children than an integer holds', 'edge e { refine 99999999999999999999 [ 1 2 1 ] }', qr/below 2147483648/ ],
    [ 'a surface of a billion by a billion', "${line}figure f { open line open line size 1000000000 1000000000 points [ 0; 1 ] }", qr/does not hold 2 points/ ],
    [ 'a surface whose size overflows', "${line}figure f { open line open line size 2147483647 2147483647 points [ 0; 1 ] }", qr/does not hold 2 points/ ],
    [ 'a level without end', "${line}figure f { open line points [ 0; 1 ] displace 99999999999 1 [ 1 ] }", qr/below 2147483648/ ],
    [ 'loops of 1000001^2 steps', 'cell c 2 { sub c { for i in 0..1000000 { for j in 0..1000000 { q[i] = p[0] } } } }', qr/error: / ],
    [ 'empty loops of 1000001^2 steps', 'cell c 1 { sub c { q[0] = p[0] for i in 0..1000000 { for j in 0..1000000 { } } } }', qr/steps/ ],
    [ 'a sum of 1000001^2 terms', 'cell c 1 { sub c { q[0] = sum(i in 0..1000000, sum(j in 0..1000000, p[0])) } }', qr/steps|not a finite/ ],
    [ 'a range that is too long', 'cell c 1 { sub c { for i in 0..1e18 { q[0] = p[0] } } }', qr/must lie in/ ],
    [ 'lets that call each other exponentially', join('', map { "let f$_(u) = f" . ($_ - 1) . "(u)+f" . ($_ - 1) . "(u+1)\n" } reverse 1 .. 60) . "let f0(u) = u\nvertex v 1 { sub v [ f60(1) ] }", qr/steps/ ],
    [ 'lets without arguments that double', join('', map { "let f$_ = f" . ($_ - 1) . "+f" . ($_ - 1) . "\n" } reverse 1 .. 60) . "let f0 = 1\nvertex v 1 { sub v [ f60 ] }", qr/steps/ ],
    [ 'a chain of 1000 lets', join('', map { "let f$_ = f" . ($_ - 1) . "\n" } reverse 1 .. 1000) . "let f0 = 1\nvertex v 1 { sub v [ f1000 ] }", qr/more than \d+ lets/ ],
    [ 'a matrix of four million entries', 'vertex v 1 { sub v [ ' . '1 ' x 4_194_305 . '] }', qr/more than 2097152 words/ ],
    [ 'seventeen coordinates', "${line}figure f { open line points [ " . '1 ' x 17 . '; ' . '1 ' x 17 . '] }', qr/at most 16 coordinates, found 17/ ],
    [ 'points that are not finite', "${line}figure f { open line points [ 1e308*10; 0 ] }", qr/not a finite number/ ],
    [ 'a thousand errors', join("\n", map { "let a$_ = b$_" } 1 .. 1000), qr/unknown name/ ],
    [ 'a thousand syntax errors', "let = 1\n" x 1000, qr/expected a name/ ],
    [ 'an item never closed, a thousand times', "vertex v 1 {\n" x 1000, qr/expected/ ],
    [ 'a line of a million characters', 'let a = b' . ' ' x 1_000_000 . '1', qr/error: / ],
) {
    my ($what, $text, $pattern) = @$case;
    text_refused("automaton x\n$text", $pattern, $what, 'check');
}
{
    my ($status, $out, $err) = bcifs([ 'check', scratch(undef, "automaton x\n" . join("\n", map { "let a$_ = b$_" } 1 .. 1000)) ]);
    is(scalar(() = $err =~ /: error: /g), 20, 'at most 20 errors are reported');
    ($status, $out, $err) = bcifs([ 'check', scratch(undef, "automaton x\nlet a = b" . ' ' x 1_000_000 . '; 1') ]);
    cmp_ok(length $err, '<', 2000, 'a long line is not printed whole');
}
{
    my $text = "automaton x\n$line" . join '', map { "edge e$_ 2 { start v at 0 end v at 1 sub e$_ [ 1 0; 0 1 ] }\n" } 0 .. 65;
    for my $i (0 .. 65) { $text .= "face f${i}_$_ = e$i * e$_\n" for 0 .. 65 }
    my $file = scratch('states.bcifs', $text);
    refused([ 'check', $file ], qr/more than 4096 states/, 'more than 4096 states');
    my ($status, $out, $err) = bcifs([ 'check', $file ]);
    is(scalar(() = $err =~ /: error: /g), 1, 'more than 4096 states: said once');
}
# What is large but within the limits is done.
for my $case (
    [ 'parentheses 150 deep', 'let a = ' . '(' x 150 . '1' . ')' x 150 . "\nvertex v 1 { sub v [ a ] }" ],
    [ 'a sum of 900 terms', 'let a = 1' . '+1' x 900 . "\nvertex v 1 { sub v [ a/901 ] }" ],
    [ 'a chain of 50 lets', join('', map { "let f$_ = f" . ($_ - 1) . "\n" } 1 .. 50) . "let f0 = 1\nvertex v 1 { sub v [ f50 ] }" ],
    [ 'a file of 10000 vertices in a chain of states', join("\n", map { "vertex v$_ 1 { sub v" . ($_ % 2000) . ' [ 1 ] }' } 0 .. 1999) ],
    [ 'a file of 10 MB of comments', "# comment\n" x 1_000_000 . 'vertex v 1 { }' ],
    [ 'lets of 60 levels that are not doubled', join('', map { "let f$_(u) = f" . ($_ - 1) . "(u+1)\n" } 1 .. 60) . "let f0(u) = u\nvertex v 1 { sub v [ f60(0)/60 ] }" ],
) {
    my ($what, $text) = @$case;
    my ($status, undef, $err) = bcifs([ 'check', scratch('large.bcifs', "automaton x\n$text"), '--quiet' ], %limits);
    is("$status$err", '0', "$what: accepted");
}
{
    my $folder = scratch('chain');
    mkdir $folder;
    file_write("$folder/$_.bcifs", "automaton a$_\nuse \"" . ($_ + 1) . ".bcifs\"\n") for 0 .. 99;
    file_write("$folder/100.bcifs", "automaton a100\nvertex v 1 { }\n");
    refused([ 'check', "$folder/0.bcifs" ], qr/more than \d+ files/, 'a hundred files that use each other');
    # A tree of uses: every file uses the next one twice.
    file_write("$folder/t$_.bcifs", "automaton t$_\nuse \"t" . ($_ + 1) . ".bcifs\" as a\nuse \"t" . ($_ + 1) . ".bcifs\" as b\n") for 0 .. 39;
    file_write("$folder/t40.bcifs", "automaton t40\nvertex v 1 { }\n");
    refused([ 'check', "$folder/t0.bcifs" ], qr/more than \d+ files/, 'files used 2^40 times');
    symlink "$folder/loop.bcifs", "$folder/loop.bcifs";
    refused([ 'check', "$folder/loop.bcifs" ], qr/cannot open/, 'a link to itself');
    file_write("$folder/link-0.bcifs", "automaton l\nuse \"link-1.bcifs\"\nvertex v 1 { }\n");
    symlink "$folder/link-0.bcifs", "$folder/link-1.bcifs";
    refused([ 'check', "$folder/link-0.bcifs" ], qr/circular|more than \d+ files/, 'a circle through a link');
}

# ---- Evaluation ------------------------------------------------------------------------------------------------

my $output = scratch('output-that-must-not-be');
for my $case (
    [ 'more than 2^40 points', [ $chaikin, '--depth', 40 ], qr/2\^40 points/ ],
    [ 'far more than 2^40 points', [ $chaikin, '--depth', 1000000 ], qr/depth/ ],
    [ 'the depth where the count of points overflows', [ $chaikin, '--depth', 62 ], qr/2\^40 points/ ],
    [ 'the depth where it overflows to nothing', [ $chaikin, '--depth', 64 ], qr/2\^40 points/ ],
    [ 'a depth below nought', [ $chaikin, '--depth', -1 ], qr/--depth/ ],
    [ 'half a depth', [ $chaikin, '--depth', '1/2' ], qr/--depth/ ],
    [ 'a depth in words', [ $chaikin, '--depth', 'deep' ], qr/--depth/ ],
    [ 'an empty depth', [ $chaikin, '--depth', '' ], qr/--depth/ ],
    [ 'a depth of nan', [ $chaikin, '--depth', 'nan' ], qr/--depth/ ],
    [ 'a depth of 1e400', [ $chaikin, '--depth', '1e400' ], qr/--depth/ ],
    [ 'a depth of 10^400', [ $chaikin, '--depth', '10^400' ], qr/--depth/ ],
    [ 'a depth that divides by zero', [ $chaikin, '--depth', '1/0' ], qr/--depth.*division by zero/ ],
    [ 'a depth of 300 characters', [ $chaikin, '--depth', '1+' x 150 . '1' ], qr/--depth/ ],
    [ '--show of something else', [ $chaikin, '--show', 'everything' ], qr/--show/ ],
    [ 'a seed of too few coordinates', [ $chaikin, '--show', 'seed:1' ], qr/seed must have 2 coordinates/ ],
    [ 'a seed of too many coordinates', [ $chaikin, '--show', 'seed:1,0,0' ], qr/seed must have 2 coordinates/ ],
    [ 'a seed that is not barycentric', [ $chaikin, '--show', 'seed:1,1' ], qr/sum to 1/ ],
    [ 'an empty seed', [ $chaikin, '--show', 'seed:' ], qr/--show/ ],
    [ 'a seed with a hole', [ $chaikin, '--show', 'seed:1,,0' ], qr/--show/ ],
    [ 'a seed in words', [ $chaikin, '--show', 'seed:a,b' ], qr/--show/ ],
    [ 'a range below nought', [ $chaikin, '--range', '-1..1' ], qr/--range/ ],
    [ 'a range beyond 1', [ $chaikin, '--range', '0..2' ], qr/--range/ ],
    [ 'a range backwards', [ $chaikin, '--range', '1..0' ], qr/--range/ ],
    [ 'a range without an end', [ $chaikin, '--range', '0..' ], qr/--range/ ],
    [ 'half a range', [ $chaikin, '--range', '0.5' ], qr/--range/ ],
    [ 'a parameter beyond 1', [ $chaikin, '--at', '1.5' ], qr/--at/ ],
    [ 'a parameter below nought', [ $chaikin, '--at', '-0.1' ], qr/--at/ ],
    [ 'a parameter in words', [ $chaikin, '--at', 'half' ], qr/--at/ ],
    [ 'an address without a piece', [ $chaikin, '--address', '0110' ], qr/address/ ],
    [ 'an address of a piece that is not there', [ $chaikin, '--address', '4.0' ], qr/address/ ],
    [ 'an address of a map that is not there', [ $chaikin, '--address', '0.012' ], qr/there is no map 2/ ],
    [ 'an address with letters', [ $chaikin, '--address', '0.0a' ], qr/address/ ],
    [ 'an address with a number without end', [ $chaikin, '--address', '99999999999999999999999.0' ], qr/address/ ],
    [ 'an address with a map without end', [ $chaikin, '--address', '0.99999999999999999999999,1' ], qr/map|address/ ],
    [ 'an empty address', [ $chaikin, '--address', '' ], qr/address/ ],
    [ 'an unknown figure', [ $chaikin, '--figure', 'sqare' ], qr/no figure 'sqare'; did you mean 'square'/ ],
    [ 'an unknown state', [ $chaikin, '--state', 'ark' ], qr/no state 'ark'; did you mean 'arc'/ ],
    [ 'a state without points', [ $chaikin, '--state', 'arc' ], qr/needs 3 control points/ ],
    [ 'a figure and a state', [ $chaikin, '--figure', 'square', '--state', 'arc' ], qr/exclude each other/ ],
    [ 'an unknown format', [ $chaikin, '--format', 'bmp' ], qr/unknown format 'bmp'; expected/ ],
    [ 'an unknown ending', [ $chaikin, '-o', "$output.bmp" ], qr/names no known format/ ],
    [ 'no ending', [ $chaikin, '-o', $output ], qr/names no known format/ ],
    [ 'a picture of no width', [ $chaikin, '--format', 'svg', '--width', 0 ], qr/wide|--width/, 1 ],
    [ 'a picture of a million pixels', [ $chaikin, '--format', 'png', '--width', 1000000 ], qr/pixels wide/ ],
    [ 'a picture of a width in words', [ $chaikin, '--format', 'png', '--width', 'wide' ], qr/--width/ ],
    [ 'levels that are no numbers', [ $chaikin, '--format', 'svg', '--levels', '1,x' ], qr/--levels/ ],
    [ 'levels with a hole', [ $chaikin, '--format', 'svg', '--levels', '1,,2' ], qr/--levels/ ],
    [ 'too many levels', [ $chaikin, '--format', 'svg', '--levels', join(',', (1) x 100) ], qr/at most \d+ layers/ ],
    [ 'levels of data', [ $chaikin, '--levels', '1' ], qr/for pictures/ ],
    [ 'a polygon of data', [ $chaikin, '--polygon' ], qr/for pictures/ ],
    [ 'an unknown param', [ $chaikin, '--set', 'a=1' ], qr/no param 'a'/ ],
    [ 'a param without a value', [ "$ROOT/automata/takagi.bcifs", '--set', 'w' ], qr/NAME=EXPRESSION/ ],
    [ 'a param with an empty value', [ "$ROOT/automata/takagi.bcifs", '--set', 'w=' ], qr/expected an expression/ ],
    [ 'a param out of its range', [ "$ROOT/automata/takagi.bcifs", '--set', 'w=2' ], qr/outside its range 0\.\.1/ ],
    [ 'a param of infinity', [ "$ROOT/automata/takagi.bcifs", '--set', 'w=1e400' ], qr/too large/ ],
    [ 'a param of nan', [ "$ROOT/automata/takagi.bcifs", '--set', 'w=nan' ], qr/unknown name/ ],
    [ 'a param that divides by zero', [ "$ROOT/automata/takagi.bcifs", '--set', 'w=1/0' ], qr/division by zero/ ],
    [ 'a param with something behind', [ "$ROOT/automata/takagi.bcifs", '--set', 'w=1 2' ], qr/expected an operator or the end/ ],
    [ 'a param that is not UTF-8', [ "$ROOT/automata/takagi.bcifs", '--set', "w=\xff" ], qr/UTF-8/ ],
) {
    my ($what, $words, $pattern, $or_done) = @$case;
    next if $or_done && (bcifs([ 'eval', @$words ], %limits))[0] eq '0'; # 0 may stand for the default
    my @output = grep({ $_ eq '-o' } @$words) ? () : ('-o', "$output." . (grep({ /^(?:svg|png)$/ } @$words) ? $words->[2] : 'csv'));
    my @wrong = refusal_problems([ 'eval', @$words ], $pattern);
    push @wrong, refusal_problems([ 'eval', @$words, @output ], $pattern) if @output && "@$words" !~ /--format/;
    push @wrong, 'an output file' if glob "$output*";
    is_deeply(\@wrong, [], "eval: $what");
}
# A curve that runs away leaves the range of numbers.
{
    my $file = scratch('away.bcifs', "automaton away\nvertex v 1 { }\nedge e 2 { start v at 0 end v at 1 sub e [ 1 -1e9; 0 1000000001 ] sub e [ -1e9 0; 1000000001 1 ] }\nfigure f { open e points [ 0; 1 ] }");
    my ($status, $out, $err) = bcifs([ 'eval', $file, '--address', '0.' . '01' x 100 ], %limits);
    is($status, 2, 'points that are not finite: exit status 2');
    is($out, '', 'points that are not finite: nothing on standard output');
    like($err, qr/not finite/, 'points that are not finite: says so');
    my $away = scratch('away.bcifs', "automaton away\nvertex v 1 { }\nedge e 2 { start v at 0 end v at 1 sub e [ 1 -1e99; 0 1e99 ] sub e [ -1e99 0; 1e99 1 ] }\nfigure f { open e points [ 0; 1e300 ] }");
    ($status, $out, $err) = bcifs([ 'eval', $away, '--depth', 4, '-o', "$output.csv" ], %limits);
    isnt($status, 0, 'a file of points that are not finite: refused');
    ok(!-e "$output.csv", 'a file of points that are not finite is not left');
}

# ---- Control points --------------------------------------------------------------------------------------------

for my $case (
    [ 'ragged', "0,0\n1\n2,2\n", qr/:2:1: error: this point has 1 coordinate/ ],
    [ 'ragged the other way', "0\n1,1\n", qr/:2:1: error: this point has 2 coordinates/ ],
    [ 'text', "0,0\n1,one\n2,2\n", qr/:2:3: error: expected a number, found 'one'/ ],
    [ 'only text', "x,y\na,b\n", qr/:2:1: error: expected a number/ ],
    [ 'nan', "0,0\n1,nan\n", qr/:2:3: error: expected a number, found 'nan'/ ],
    [ 'inf', "0,0\n1,inf\n", qr/:2:3: error: expected a number, found 'inf'/ ],
    [ '-inf', "0,0\n-inf,1\n", qr/:2:1: error: expected a number, found '-inf'/ ],
    [ '1e400', "0,0\n1,1e400\n", qr/:2:3: error: / ],
    [ 'hexadecimal', "0,0\n0x10,1\n", qr/:2:1: error: expected a number/ ],
    [ 'a decimal comma', "0;0\n1;5\n", qr/error: / ],
    [ 'an empty file', '', qr/no points/ ],
    [ 'blank lines', "\n\n", qr/no points/ ],
    [ 'a header only', "x,y\n", qr/no points/ ],
    [ 'a coordinate missing', "0,0\n1,\n", qr/:2:\d: error: a coordinate is missing/ ],
    [ 'a coordinate missing in front', "0,0\n,1\n", qr/:2:1: error: a coordinate is missing/ ],
    [ '17 coordinates', join(',', 1 .. 17) . "\n", qr/at most 16 coordinates, found 17/ ],
    [ '100000 coordinates', join(',', (1) x 100_000) . "\n", qr/at most 16 coordinates, found 100000/ ],
    [ 'binary', "\x89PNG\r\n\x1a\n\0\0", qr/error: / ],
    [ 'NUL', "0,0\n1,\0\n", qr/NUL/ ],
    [ 'not UTF-8', "0,0\n\xff,1\n", qr/UTF-8/ ],
    [ 'too few points', "0,0\n", qr/too few points/ ],
    [ 'a thousand mistakes', "0,0\n" . "x,y\n" x 1000, qr/expected a number/ ],
) {
    my ($what, $csv, $pattern) = @$case;
    my $points = scratch('points.csv', $csv);
    refused([ 'eval', $chaikin, '--points', $points ], $pattern, "--points: $what");
}
refused([ 'eval', $chaikin, '--points', scratch('missing.csv') ], qr/No such file/, '--points: a missing file');
refused([ 'eval', $chaikin, '--points', $ROOT ], qr/directory/, '--points: a directory');
refused([ 'eval', $dragon, '--points', scratch('points.csv', "0,0\n1,1\n2,2\n3,3\n") ], qr/do not fit the step/, '--points: a count that does not fit');
{
    my ($status, $out) = bcifs([ 'eval', $chaikin, '--points', scratch('points.csv', "\xEF\xBB\xBFx , y\r\n# corner\r\n 0 , 0\r\n\r\n+1e0,\t.5\r\n2,-0\r\n"), '--depth', 0, '--show', 'control' ]);
    is("$status $out", "0 x,y\n0,0\n1,0.5\n2,0\n", '--points: header, comments, blanks and Windows line ends are well');
    ($status, $out) = bcifs([ 'eval', $chaikin, '--points', '-', '--depth', 0, '--show', 'control' ], stdin => "0,1\n2,3");
    is("$status $out", "0 x,y\n0,1\n2,3\n", '--points: from standard input');
}

# ---- The command line ------------------------------------------------------------------------------------------

for my $case (
    [ 'no command', [], qr/Usage/ ],
    [ 'an unknown command', [ 'chekc', $chaikin ], qr/no command 'chekc'/ ],
    [ 'an empty command', [''], qr/no command/ ],
    [ 'an unknown option as command', ['--verbose'], qr/no command '--verbose'/ ],
    [ 'no file', ['check'], qr/usage: bcifs check FILE/ ],
    [ 'two files', [ 'check', $chaikin, $dragon ], qr/one file at a time/ ],
    [ 'an unknown option', [ 'check', $chaikin, '--jsn' ], qr/no option '--jsn'/ ],
    [ 'an unknown short option', [ 'check', $chaikin, '-x' ], qr/no option '-x'/ ],
    [ 'an option of another command', [ 'fmt', $chaikin, '--depth', 3 ], qr/no option '--depth'/ ],
    [ 'an argument missing', [ 'eval', $chaikin, '--depth' ], qr/--depth needs an argument/ ],
    [ 'an argument too many', [ 'check', $chaikin, '--json=yes' ], qr/--json takes no argument/ ],
    [ 'an option twice', [ 'eval', $chaikin, '--depth', 1, '--depth', 2 ], qr/--depth is given twice/ ],
    [ 'too many settings', [ 'check', "$ROOT/automata/takagi.bcifs", ('--set', 'w=1/2') x 300 ], qr/more than \d+ --set/ ],
    [ 'too many positions', [ 'eval', $chaikin, ('--at', 0) x 300 ], qr/more than \d+ --at/ ],
    [ 'help of an unknown command', [ 'help', 'cehck' ], qr/no command 'cehck'/ ],
) {
    my ($what, $words, $pattern) = @$case;
    my ($status, $out, $err) = bcifs($words, %limits);
    is($status, 2, "$what: exit status 2");
    is($out, '', "$what: nothing on standard output");
    like($err, $pattern, "$what: says so");
}
for my $words ([ '--version' ], [ 'help' ], [ '--help' ], [ '-h' ], map({ ([ 'help', $_ ], [ $_, '--help' ], [ $_, '-h' ]) } qw(check eval fmt))) {
    my ($status, $out, $err) = bcifs($words, %limits);
    ok($status eq '0' && $out ne '' && $err eq '', "bcifs @$words");
}
like((bcifs(['--version']))[1], qr/^bcifs \d+\.\d+\.\d+\n\z/, '--version');
{
    my $dashed = scratch('-dashed.bcifs', "automaton dashed\nvertex v 1 { }\n");
    (my $folder = $dashed) =~ s{/[^/]*$}{};
    is((bcifs([ 'check', '--quiet', '--', '-dashed.bcifs' ], directory => $folder))[0], 0, '-- ends the options');
}

# ---- What the system fails -------------------------------------------------------------------------------------

my @formats = qw(csv json f64 npy svg png);
SKIP: {
    skip 'no /dev/full', 3 * @formats + 8 if !-c '/dev/full';
    for my $format (@formats) {
        my ($status, $out, $err) = bcifs([ 'eval', $chaikin, '--depth', 6, '--format', $format ], %limits, stdout => '/dev/full');
        is($status, 3, "$format: standard output on a full disk: exit status 3");
        like($err, qr/^bcifs: error: cannot write.*No space/m, "$format: says so");
        ($status) = bcifs([ 'eval', $chaikin, '--depth', 6, '--format', $format, '-o', '/dev/full' ], %limits);
        is($status, 3, "$format: -o on a full disk: exit status 3");
    }
    for my $words ([ 'check', $chaikin ], [ 'check', $chaikin, '--json' ], [ 'fmt', $chaikin ], [ 'eval', $chaikin, '--at', '1/2' ], ['help'], [ 'help', 'eval' ], ['--version'], [ 'check', $chaikin, '-o', '/dev/full' ]) {
        my ($status, $out, $err) = bcifs($words, %limits, stdout => '/dev/full');
        is($status, 3, 'a full disk: ' . join(' ', $words->[0], @$words[ 2 .. $#$words ]));
    }
}

# A directory that is not there, that is no directory, and a name that is a directory.
for my $case (
    [ 'a directory that is missing', scratch('nowhere') . '/x.csv' ],
    [ 'a directory that is a file', "$good/x.csv" ],
    [ 'a name that is a directory', do { my $folder = scratch('folder.csv'); mkdir $folder; $folder } ],
) {
    my ($what, $path) = @$case;
    for my $words ([ 'eval', $chaikin, '--depth', 2 ], [ 'check', $chaikin ], [ 'fmt', $chaikin ]) {
        my ($status, $out, $err) = bcifs([ @$words, '-o', $path ], %limits);
        is($status, 3, "$words->[0] -o to $what: exit status 3");
        like($err, qr/error: cannot write/, "$words->[0] -o to $what: says so");
    }
}
SKIP: {
    my $folder = scratch('locked');
    mkdir $folder;
    chmod 0500, $folder;
    skip 'every directory may be written to', 2 if -w $folder;
    my ($status) = bcifs([ 'eval', $chaikin, '--depth', 2, '-o', "$folder/x.csv" ], %limits);
    is($status, 3, 'a directory that may not be written to: exit status 3');
    is_deeply([ glob "$folder/* $folder/.bcifs*" ], [], 'and nothing is left there');
    chmod 0700, $folder;
}

# The file that was there stays when the new one cannot be made.
{
    my $kept = scratch('kept.csv', "as it was\n");
    is((bcifs([ 'eval', $chaikin, '--depth', 60, '-o', $kept ], %limits))[0], 2, 'a refusal with an output file that exists');
    is(file_text($kept), "as it was\n", 'which stays as it is');
    (my $folder = $kept) =~ s{/[^/]*$}{};
    is_deeply([ grep { /bcifs-\d|\.tmp$/ } glob "$folder/.* $folder/*" ], [], 'no temporary files are left');
}

# A disk that fills while a file is written: nothing of it stays. The limit of the size of files stands for the disk.
SKIP: {
    skip 'limits are in the way of sanitizers', 3 if $SANITIZED;
    my $folder = scratch('full');
    mkdir $folder;
    my $status = system 'sh', '-c', 'ulimit -f 64; trap "" XFSZ; exec "$0" eval "$1" --depth 14 -o "$2" 2>"$3"', $BCIFS, $chaikin, "$folder/x.csv", scratch('full.err');
    is($status >> 8, 3, 'a disk that fills: exit status 3');
    is_deeply([ glob "$folder/* $folder/.bcifs*" ], [], 'a disk that fills: nothing is left');
    like(file_text(scratch('full.err')), qr/cannot write .*File too large/, 'a disk that fills: says so');
}

# A reader that goes away.
for my $format (@formats) {
    pipe my $reader, my $writer or die;
    my $errors = scratch('pipe.err');
    my $process = fork // die;
    if ($process == 0) {
        close $reader;
        open STDOUT, '>&', $writer;
        open STDERR, '>', $errors;
        exec { $BCIFS } $BCIFS, 'eval', $chaikin, '--depth', $format eq 'png' || $format eq 'svg' ? 12 : 18, '--format', $format;
    }
    close $writer;
    close $reader;
    local $SIG{ALRM} = sub { kill 'KILL', $process };
    alarm($SANITIZED ? 60 : 10);
    waitpid $process, 0;
    my $wait = $?;
    alarm 0;
    is($wait, 3 << 8, "$format: a closed pipe: exit status 3, no signal");
    like(file_text($errors), qr/cannot write/, "$format: a closed pipe: says so");
}
# A standard output that is closed.
{
    my $status = system 'sh', '-c', 'exec "$0" eval "$1" --depth 2 >&- 2>/dev/null', $BCIFS, $chaikin;
    is($status >> 8, 3, 'no standard output: exit status 3');
    $status = system 'sh', '-c', 'exec "$0" check "$1" --quiet >&- 2>&- <&-', $BCIFS, $chaikin;
    is($status & 127, 0, 'no streams at all: no crash');
}
# Too little memory is exit status 3.
SKIP: {
    skip 'limits are in the way of sanitizers', 1 if $SANITIZED;
    my @rows = map { my $i = $_; join ' ', map { $_ == $i ? 1 : 0 } 1 .. 700 } 1 .. 700;
    my $file = scratch('memory.bcifs', "automaton memory\ncell c 700 { sub c [\n" . join("\n", @rows) . "\n] }\n");
    my ($status, $out, $err) = bcifs([ 'check', $file ], seconds => 10, kilobytes => 24 * 1024);
    is($status, 3, 'no memory: exit status 3') or diag(substr $err, 0, 300);
}

{
    is_deeply(\@unclean, [], 'no report has bytes that are not UTF-8, or control characters');
}

done_testing;
