#!/usr/bin/env perl
# bcifs fmt: formatting twice changes nothing, comments and meaning are kept, for the gallery, for the samples of the
# tests, and for both of them spoiled in layout.
use strict;
use warnings;
use utf8;
use FindBin;
use lib "$FindBin::Bin/lib";
use Bcifs;
use Encode qw(decode_utf8 encode_utf8);
use JSON::PP ();
use Test::More;

binmode $_, ':utf8' for map { Test::More->builder->$_ } qw(output failure_output todo_output);
my $seed = $ENV{BCIFS_SEED} // 20103;
srand $seed;

sub format_text {
    my ($text) = @_;
    my ($status, $out, $err) = bcifs([ 'fmt', '-' ], stdin => $text);
    return ($out, $status, $err);
}

# Strings and tokens outside comments, and the comments, in order. Layout is all that may change: newlines inside
# brackets and ";" both separate rows.
sub tokens_of {
    my ($text) = @_;
    my (@tokens, @comments);
    my ($depth, $parens) = (0, 0);
    $text =~ s/^\x{feff}//;
    for ($text) {
        while ((pos // 0) < length) {
            if (/\G#(.*)/gc) { push @comments, $1 =~ s/\s+$//r }
            elsif (/\G("[^"]*")/gc) { push @tokens, $1 }
            elsif (/\G\n/gc) { push @tokens, 'ROW' if $depth == 1 && !$parens }
            elsif (/\G[ \t\r]+/gc) { push @tokens, 'SPACE' if $depth == 1 && !$parens }
            elsif (/\G\[/gc) { push @tokens, '['; $depth++ }
            elsif (/\G\]/gc) { push @tokens, ']'; $depth-- }
            elsif (/\G;/gc) { push @tokens, 'ROW' }
            elsif (/\G([()])/gc) { push @tokens, $1; $parens += $1 eq '(' ? 1 : -1 if $depth }
            elsif (/\G(\w+|\.\.|.)/gcs) { push @tokens, $1 }
        }
    }
    my $line = join "\x{1}", @tokens;
    $line =~ s/\x{1}(?:(?:SPACE|ROW)\x{1})*ROW(?:\x{1}(?:SPACE|ROW))*\x{1}/\x{1}ROW\x{1}/g;
    $line =~ s/(\[)\x{1}(?:(?:SPACE|ROW)\x{1})+/$1\x{1}/g;
    $line =~ s/(?:\x{1}(?:SPACE|ROW))+(\x{1}\])/$1/g;
    $line =~ s/SPACE(?:\x{1}SPACE)+/SPACE/g;
    return ($line, join "\n", @comments);
}

# What a file is bound to: the report of check without places, and the points of every figure.
sub meaning {
    my ($file) = @_;
    my ($status, $out, $err) = bcifs([ 'check', $file, '--json' ]);
    my $json = eval { JSON::PP->new->utf8->decode($out) };
    if ($json) {
        delete @$_{qw(file line)} for @{ $json->{equations} };
        $out = JSON::PP->new->canonical->encode($json);
    }
    my @figures = decode_utf8(file_text($file)) =~ /^\s*figure\s+(\w+)/mg;
    my @points = map { join ' ', (bcifs([ 'eval', $file, '--figure', $_, '--depth', 2, '--quiet' ]))[ 0, 1 ] } @figures;
    return join "\n", $status, $out, @points;
}

my @gallery = sort glob "$ROOT/automata/*.bcifs";
my @samples = sort glob "$ROOT/tests/data/*.bcifs $ROOT/tests/data/*/*.bcifs";

# ---- Every file that can be read -------------------------------------------------------------------------------

my ($formatted_files, $refused) = (0, 0);
for my $file (@gallery, @samples) {
    my ($name) = $file =~ m{([^/]+/[^/]+)\.bcifs$};
    my ($status, $out, $err) = bcifs([ 'fmt', $file ]);
    if ($status == 2) { # a sample of a syntax error
        $refused++;
        ok($out eq '' && $err =~ /error: / && $file !~ m{/automata/}, "$name: refused, with nothing on standard output");
        is((bcifs([ 'check', $file ]))[0], 2, "$name: check refuses it too");
        next;
    }
    $formatted_files++;
    is($status, 0, "$name: exit status");
    is($err, '', "$name: nothing on standard error");
    my ($again, $code) = format_text($out);
    is($again, $out, "$name: formatting twice changes nothing");
    my @before = tokens_of(decode_utf8(file_text($file)));
    my @after = tokens_of(decode_utf8($out));
    is($after[1], $before[1], "$name: comments are kept");
    is($after[0], $before[0], "$name: so is every token");
    unlike($out, qr/[ \t]$/m, "$name: no space at the end of a line");
    like($out, qr/[^\n]\n\z/, "$name: one newline at the end");
    is((bcifs([ 'fmt', '--check', $file ]))[0], $out eq file_text($file) ? 0 : 1, "$name: --check tells");
    is((bcifs([ 'fmt', '--check', '-' ], stdin => $out))[0], 0, "$name: --check accepts what fmt wrote");
    # Beside the file, so that `use` finds what it names.
    next if $file !~ m{/automata/};
    my $copy = scratch("$name" =~ s{.*/}{}r . '.bcifs', $out);
    is(meaning($copy), meaning($file), "$name: bound to the same automaton");
}
cmp_ok($formatted_files, '>=', 40, 'files were formatted');
is((bcifs([ 'fmt', '--check', $_ ]))[0], 0, "$_ is in canonical layout") for @gallery;

# ---- Files spoiled in layout -----------------------------------------------------------------------------------

# The same tokens with other white space: outside brackets anything, inside brackets rows stay rows.
sub spoil {
    my ($text) = @_;
    my ($result, $depth, $parens) = ('', 0, 0);
    my $gap = sub { my @gaps = (' ', "\n", "  ", "\t", "\n\n\n", " # aside\n", "\n# own line\n"); $gaps[ rand @gaps ] };
    while ($text =~ /\G(?:(\s+)|(#[^\n]*\n?)|("[^"]*")|(\w+)|(.))/gcs) {
        my ($space, $comment, $string, $word, $mark) = ($1, $2, $3, $4, $5);
        if (defined $space) {
            if ($depth && !$parens) { $result .= $space =~ /\n/ ? (rand() < 0.5 ? ";\n  " : " # row\n\n") : ' ' x (1 + rand 3) }
            elsif ($depth || $result =~ /\b(?:automaton|param|let|use|vertex|edge|face|cell|wavelet|figure)\z/) { $result .= ' ' x (1 + rand 3) }
            elsif ($text =~ /\G(?=(?:param|let|use|vertex|edge|face|cell|wavelet|figure)\b)/gc) { $result .= "\n" x (1 + rand 4) }
            else { $result .= rand() < 0.3 ? $gap->() : ' ' }
        } elsif (defined $comment) { $result .= $comment }
        else {
            $depth++ if defined $mark && $mark eq '[';
            $depth-- if defined $mark && $mark eq ']';
            $parens++ if $depth && defined $mark && $mark eq '(';
            $parens-- if $depth && defined $mark && $mark eq ')';
            $result .= $string // $word // $mark;
        }
    }
    return $result;
}

for my $file (@gallery) {
    my ($name) = $file =~ m{([^/]+)\.bcifs$};
    my $wanted = meaning($file);
    my $spoiled = spoil(decode_utf8(file_text($file)));
    my $path = scratch("$name-spoiled.bcifs", encode_utf8($spoiled));
    my ($formatted, $status, $err) = format_text(encode_utf8($spoiled));
    is($status, 0, "$name spoiled: formatted (seed $seed)") or diag($err);
    is((format_text($formatted))[0], $formatted, "$name spoiled: formatting twice changes nothing");
    my @before = tokens_of($spoiled);
    my @after = tokens_of(decode_utf8($formatted));
    is($after[1], $before[1], "$name spoiled: comments are kept");
    is($after[0], $before[0], "$name spoiled: so is every token");
    is(meaning(scratch("$name-restored.bcifs", $formatted)), $wanted, "$name spoiled: bound to the same automaton");
    is((bcifs([ 'fmt', '--check', $path ]))[0], 1, "$name spoiled: --check says so");
}

# ---- What is kept, and where -----------------------------------------------------------------------------------

for my $case (
    [ 'a comment at the end of a row', "automaton t\nvertex v 2 { sub v [ 1 0 # first\n0 1 # second\n] }\n", qr/1 0\s+# first\n\s*0 1\s+# second/ ],
    [ 'a comment between rows', "automaton t\nvertex v 2 { sub v [ 1 0\n# between\n0 1 ] }\n", qr/1 0\n\s*# between\n\s*0 1/ ],
    [ 'a comment before the first token', "# head\nautomaton t\n", qr/\A# head\nautomaton t\n\z/ ],
    [ 'a comment after the last token', "automaton t\nvertex v 1 { }\n# tail", qr/# tail\n\z/ ],
    [ 'a comment that is empty', "automaton t\n#\nvertex v 1 { }\n", qr/^#$/m ],
    [ 'a comment in an expression', "automaton t\nlet a = 1 + # one\n 2\nvertex v 1 { }\n", qr/# one$/m ],
    [ 'a comment in a call', "automaton t\nlet a = max(1, # one\n 2)\nvertex v 1 { }\n", qr/# one$/m ],
    [ 'a comment inside an entry', "automaton t\nvertex v 1 { sub v [ (1 + # one\n 0) ] }\n", qr/# one$/m ],
    [ 'a comment inside braces', "automaton t\nvertex v 1 { # nothing\n}\n", qr/# nothing$/m ],
    [ 'fractions as written', "automaton t\nvertex v 1 { sub v [ 3/4+1/4 ] }\n", qr{3/4\+1/4} ],
    [ 'numbers as written', "automaton t\nlet a = 1e-03\nlet b = 0.50\nlet c = .5\nvertex v 1 { }\n", qr/1e-03\n.*0\.50\n.*\.5\n/s ],
    [ 'parentheses as written', "automaton t\nlet a = ((1))+(2)\nvertex v 1 { }\n", qr/\(\(1\)\)\s*\+\s*\(2\)/ ],
    [ 'a title', "automaton t \"A title # not a comment\"\n", qr/"A title # not a comment"/ ],
    [ 'rules as rules', "automaton t\nvertex v 1 { sub v { q[0]=p[0] } }\n", qr/q\[0\] = p\[0\]/ ],
    [ 'a mask as a mask', "automaton t\nedge e { mask 2 [ 1/2 1 1/2 ] }\n", qr/mask 2 \[/ ],
    [ 'one blank line between items', "automaton t\n\n\n\nvertex v 1 { }\n\n\n\nvertex w 1 { }\n", qr/\Aautomaton t\n\nvertex v 1 \{ \}\n\nvertex w 1 \{ \}\n\z/ ],
) {
    my ($what, $text, $pattern) = @$case;
    my ($out, $status, $err) = format_text($text);
    is($status, 0, "kept: $what: exit status") or diag($err);
    like(decode_utf8($out), $pattern, "kept: $what");
    is((format_text($out))[0], $out, "kept: $what: formatting twice changes nothing");
}

# Every construct of the grammar.
my $everything = <<'END';
automaton everything   "All of it"
use "other.bcifs"  use "other.bcifs" as   another
param a=1/2   param b = a+1 in -1 .. 2*a
let c=3 let f( u,v )=u^2-v%3*-u
vertex v 1{} vertex w 2{sub w[3/4 1/4;1/4 3/4]}
vertex k(u) 1 {sub k( 2*u )[1]}
edge e(u)3{start k(u)at 0 end k(u)at[2*1]sub e(u/2)[1 ? 0;0 -a (1 - a);0 1/2 f(a, 1)] sub e(u){for i in 0..2{q[i]=sum(j in 0..2,p[j]/3)}}}
edge r{refine 2[1 1/2 0;0 1/2 1]} edge m 3{mask 2[1/4 3/4 3/4 1/4]start w at 0 1 end w[0 0;1 0;0 1]}
cell d affine 2{sub d[1/2 0 0;0 1/2 0]}
face g 4{boundary south=m at 0 1 join 0.south=1.south join 0.south=1.south reversed sub g[1 0 0 0;0 1 0 0;0 0 1 0;0 0 0 1]}
face h=m*another.x(1,2)
wavelet m{smooth -2[-1/4 3/4 3/4 -1/4]detail 0[1 -1]}
figure x{open m closed another.y(1) size 3 4 intervals[1 2 3]points[0 0;1 1]displace 1 2[1 1]displace 1 2 3[1 1]}
figure y{piece d at 0 1 2 piece e(3)at 0 1 2}
END
{
    my ($out, $status, $err) = format_text($everything);
    is($status, 0, 'every construct is printed') or diag($err);
    is((format_text($out))[0], $out, 'formatting twice changes nothing');
    # Spaces between entries are white space; the tokens are the same.
    is(((tokens_of($out))[0] =~ s/\x{1}SPACE//gr), ((tokens_of($everything))[0] =~ s/\x{1}SPACE//gr), 'with every token');
    my ($spoiled, $code) = format_text(spoil($out));
    is($code, 0, 'spoiled, it can still be read');
    is((format_text($spoiled))[0], $spoiled, 'and printed for good');
    my ($crlf) = format_text($everything =~ s/\n/\r\n/gr);
    is($crlf, $out, 'from Windows line ends');
    my ($bom) = format_text("\x{feff}$everything");
    is($bom =~ s/^\xEF\xBB\xBF//r, $out, 'from a file with a byte order mark');
}

# Long things are broken and stay readable; deep ones too.
for my $case (
    [ 'a long sum', 'let a = ' . join('+', 1 .. 500) ],
    [ 'a wide matrix', 'vertex v 1 { sub v [ ' . join(' ', (1) x 300) . ' ] }' ],
    [ 'a tall matrix', "vertex v 1 { sub v [\n" . join("\n", (1) x 3000) . "\n] }" ],
    [ 'long names', 'let ' . 'n' x 128 . ' = ' . 'm' x 128 . '*' . 'o' x 128 ],
    [ 'deep parentheses', 'let a = ' . '(' x 190 . '1' . ')' x 190 ],
    [ 'many rules', 'vertex v 1 { sub v { ' . join(' ', map { "q[$_] = p[$_]" } 0 .. 300) . ' } }' ],
    [ 'nested loops', 'vertex v 1 { sub v { ' . join('', map { "for i$_ in 0..$_ { " } 1 .. 40) . 'q[0] = p[0]' . ' }' x 40 . ' } }' ],
    [ 'an entry of several lines', "vertex v 1 { sub v [ max(1,\n\n\n 2) (1 +\n 2) ] }" ],
    [ 'a long comment', '# ' . 'word ' x 200 ],
) {
    my ($what, $item) = @$case;
    my ($out, $status, $err) = format_text("automaton t\n$item\n");
    is($status, 0, "$what: printed") or diag($err);
    is((format_text($out))[0], $out, "$what: formatting twice changes nothing");
    is((tokens_of($out))[0], (tokens_of("automaton t\n$item\n"))[0], "$what: every token is kept");
}

# ---- Where it is written ---------------------------------------------------------------------------------------
{
    my $text = "automaton   t\nvertex v   1 { }\n";
    my ($wanted) = format_text($text);
    my $file = scratch('same.bcifs', $text);
    chmod 0640, $file;
    my ($status, $out, $err) = bcifs([ 'fmt', $file, '-o', $file ]);
    is("$status$out$err", '0', '-o with the same file');
    is(file_text($file), $wanted, 'which is then formatted');
    is((stat $file)[2] & 0777, 0640, 'and has its permissions');
    is((bcifs([ 'fmt', '--check', $file ]))[0], 0, 'and is in canonical layout');
    my $other = scratch('other.bcifs');
    is((bcifs([ 'fmt', scratch(undef, $text), '-o', $other ]))[0], 0, '-o with another file');
    is(file_text($other), $wanted, 'which holds the formatted text');
    my $broken = scratch('broken.bcifs', "automaton t\nvertex v 1 {\n");
    is((bcifs([ 'fmt', $broken, '-o', $broken ]))[0], 2, '-o with a file that is wrong');
    is(file_text($broken), "automaton t\nvertex v 1 {\n", 'which stays as it is');
    my $spoiled = scratch('spoiled.bcifs', $text);
    ($status, $out, $err) = bcifs([ 'fmt', '--check', $spoiled ]);
    is($status, 1, '--check of another layout');
    is($out, '', '--check prints nothing on standard output');
    like($err, qr/^\Q$spoiled\E: /, '--check names the file');
    is(join('', (bcifs([ 'fmt', '--check', '--quiet', $spoiled ]))), '1', '--check --quiet says nothing');
    is(file_text($spoiled), $text, '--check changes nothing');
    is((bcifs([ 'fmt', '--check', $broken ]))[0], 2, '--check of a file that is wrong');
    my ($names) = (bcifs([ 'fmt', scratch(undef, "automaton t\nvertex v 1 { sub unknown [ nothing ] }\n") ]))[0];
    is($names, 0, 'only the syntax is checked');
}

done_testing;
