#!/usr/bin/env perl
# Every automaton of the gallery: its equations hold, exactly where its entries are rational; its text is in
# canonical layout and says where the scheme comes from; every figure of it can be evaluated and drawn.
use strict;
use warnings;
use FindBin;
use lib "$FindBin::Bin/lib";
use JSON::PP;
use List::Util qw(max);
use Test::More;
use Eval;

my @files = glob gallery('*');
cmp_ok(scalar @files, '>=', 19, 'the gallery is there');

sub words_of
{
    my ($text) = @_;
    $text =~ s/#.*//g;
    $text =~ s/"[^"]*"//g;
    return $text;
}

# Entries of maps and boundaries are rational unless a root, a transcendental function, pi, or a decimal of 15 or
# more digits occurs outside the figures.
sub is_rational
{
    my ($text) = @_;
    $text = words_of($text);
    $text =~ s/\bfigure\s+\w+\s*\{[^}]*\}//g;
    return 0 if $text =~ /\b(?:sqrt|sin|cos|tan|exp|log|pi)\b/;
    return !grep { tr/0-9// >= 15 } $text =~ /\d*\.\d+/g;
}

sub test_words
{
    my ($name, $text) = @_;
    my ($head) = $text =~ /^((?:#[^\n]*\n)+)/;
    ok($head && $head =~ /^# \S/, "$name: begins with what it is");
    ok($head && $head =~ /^# Source:/m, "$name: names its source");
    ok($head && $head =~ /^# Look at:/m, "$name: says what to look at");
    like($text, qr/^automaton \w+ "[^"]+"$/m, "$name: has a title");
    like(words_of($text), qr/^figure \w+ \{/m, "$name: has a figure");
    ok($text !~ /\t|\r| $/m && $text =~ /\n\z/, "$name: no tabs, no trailing blanks");
    cmp_ok(max(map { utf8::decode(my $line = $_); length $line } split /\n/, $text), '<=', 120, "$name: lines of a readable length");
}

sub test_check
{
    my ($file, $name, $text) = @_;
    my ($status, $out, $err) = run('check', $file, '--json');
    is($status, 0, "$name: check accepts it") or diag($err);
    my $check = eval { decode_json($out) } or fail("$name: JSON"), return;
    my @failing = grep { !$_->{holds} } @{ $check->{equations} };
    ok($check->{valid} && !@failing, "$name: every equation holds") or diag("$_->{state}: $_->{equation}") for @failing[ 0 .. min_index(\@failing) ];
    my @numeric = grep { !$_->{exact} } @{ $check->{equations} };
    is(scalar @numeric, 0, "$name: every equation exactly") if is_rational($text);
    # Columns of every map and boundary, and two incidences and N - 1 adjacencies of every edge.
    my %kinds;
    $kinds{ $_->{kind} }++ for @{ $check->{equations} };
    my $edges = grep { $_->{kind} eq 'edge' } @{ $check->{states} };
    cmp_ok($kinds{incidence} // 0, '>=', 2 * $edges, "$name: incidence at both ends of every edge");
    cmp_ok($kinds{adjacency} // 0, '>=', $edges, "$name: adjacency inside every edge");
    cmp_ok($kinds{barycentric}, '>=', @{ $check->{states} }, "$name: columns that sum to 1");
    # Bounds of the joint spectral radius, and that no scheme of the gallery expands.
    my ($lower, $upper) = @{ $check->{contraction} }{qw(lower upper)};
    ok($lower >= 0 && $lower <= $upper * (1 + 1e-12) && $lower < 1, "$name: contraction $lower .. $upper");
    ($status, $out, $err) = run('check', $file);
    is($err, '', "$name: without a warning");
    ($status, $out, $err) = run('fmt', $file, '--check');
    is($status, 0, "$name: in canonical layout") or diag($err);
    ($status, $out) = run('fmt', $file);
    is_same($out, $text, "$name: which fmt leaves alone");
}

sub min_index { return $#{ $_[0] } < 2 ? $#{ $_[0] } : 2 }

# Every figure, at several depths, as data and as pictures.
sub test_figures
{
    my ($file, $name, $text) = @_;
    for my $figure (words_of($text) =~ /^figure (\w+)/mg) {
        my $good = 1;
        my $before = 0;
        for my $depth (0, 1, 3, 5) {
            for my $format (qw(csv svg png)) {
                my ($status, $out, $err) = run('eval', $file, '--figure', $figure, '--depth', $depth, '--format', $format, '--width', 100);
                my $size = length $out;
                my $fine = $status == 0 && $err eq '' && $size >= 8 && $out !~ /\b(?:nan|inf)/i || ($format eq 'png' && $status == 0 && $err eq '');
                diag("$name $figure, depth $depth, $format: exit $status, $size bytes: $err") unless $fine;
                $good &&= $fine;
                next if $format ne 'csv';
                my $lines = $out =~ tr/\n//;
                $good &&= $lines > $before;
                $before = $lines;
            }
        }
        my ($status, $out, $err) = run('eval', $file, '--figure', $figure);
        my $lines = $out =~ tr/\n//;
        ok($good && $status == 0, "$name: figure $figure evaluates and draws");
        # At most about 4096 points by default, and more than a level below that.
        ok($lines > 64 && $lines < 4200, "$name: figure $figure has $lines points by default");
    }
}

# Figures are shown in documents, so no two automata may share a name.
my %names;
for my $file (@files) {
    my ($name) = $file =~ m{([^/]+)\.bcifs$};
    my $text = slurp($file);
    my ($automaton) = $text =~ /^automaton (\w+)/m;
    ok(!$names{ $automaton // '' }++, "$name: its automaton has a name of its own");
    ok(($automaton // '') eq $name =~ tr/-/_/r, "$name: which is the file's");
    test_words($name, $text);
    test_check($file, $name, $text);
    test_figures($file, $name, $text);
}
done_testing();
