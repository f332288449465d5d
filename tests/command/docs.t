#!/usr/bin/env perl
# The documentation is true: every example of README.md and docs/*.md does what it shows, the manual page has the
# options that the command has, and the limits are those of the source.
#
# In the pages, the word behind the language of a fenced block says what it is:
#
#   ```bcifs NAME.bcifs          a complete file that check accepts, in canonical layout
#   ```bcifs NAME.bcifs free     the same in another layout
#   ```bcifs NAME.bcifs no       check answers no: status 1
#   ```bcifs NAME.bcifs error    check refuses it: status 2
#   ```c NAME.c                  a C program, for the commands below it
#   ```console [STATUS]          commands behind "$ " and what they print; the last one exits with STATUS (0)
#   ```sh                        commands: `make TARGET` must be known, `build/bcifs …` must succeed
#   ```                          not run (grammar and the like)
#
# The blocks of a page share a directory, in which `automata`, `include` and `build` are found as in the source.
use strict;
use warnings;
use File::Basename qw(basename dirname);
use File::Temp ();
use lib dirname(__FILE__) . '/lib';
use Bcifs qw($BCIFS $BUILD $ROOT file_text file_write);
use Test::More;

my @pages = ("$ROOT/README.md", sort glob "$ROOT/docs/*.md");

# ---- Blocks ------------------------------------------------------------------------------------------------

# [language, info words, text, line] of each fenced block.
sub blocks {
    my ($page) = @_;
    my (@blocks, $open);
    my $number = 0;
    for my $line (split /^/, file_text($page)) {
        $number++;
        if ($line =~ /^```(\w*)\s*(.*?)\s*$/) {
            if ($open) {
                push @blocks, $open;
                $open = undef;
            } else {
                $open = {language => $1, info => [split ' ', $2], text => '', line => $number};
            }
        } elsif ($open) {
            $open->{text} .= $line;
        }
    }
    is($open, undef, basename($page) . ': every block is closed');
    return @blocks;
}

# A directory in which the commands of a page find what they find in the source.
sub workplace {
    my $directory = File::Temp->newdir();
    mkdir "$directory/$_" or die "$_: $!" for qw(build tools docs);
    symlink $BCIFS, "$directory/build/bcifs" or die $!;
    symlink $BCIFS, "$directory/tools/bcifs" or die $!;
    symlink "$BUILD/libbcifs.a", "$directory/build/libbcifs.a" or die $!;
    symlink "$ROOT/$_", "$directory/$_" or die $! for qw(automata include docs/examples docs/figures);
    # The compiler of this build; a library with sanitizers links with them only.
    my $compiler = $ENV{CC} // 'cc';
    my $flags = -e "$BUILD/flags" ? file_text("$BUILD/flags") : '';
    my $sanitize = join ' ', $flags =~ /(-fsanitize=\S+)/g;
    file_write("$directory/tools/cc", "#!/bin/sh\nPATH='$ENV{PATH}'\nexec $compiler -std=c11 $sanitize \"\$@\"\n");
    chmod 0755, "$directory/tools/cc" or die $!;
    return $directory;
}

# Runs a command line: (exit status, what it printed on both outputs).
sub run_line {
    my ($directory, $line) = @_;
    file_write("$directory/.line", "cd '$directory' && PATH=\"\$PWD/tools:\$PATH\"\n$line\n");
    my $output = qx(sh '$directory/.line' 2>&1 </dev/null);
    return ($? & 127 ? "signal " . ($? & 127) : $? >> 8, $output);
}

# ---- What a block claims -----------------------------------------------------------------------------------

sub file_block {
    my ($directory, $block, $where) = @_;
    my ($name, $kind) = (@{$block->{info}}, '');
    my $wanted = {error => 2, no => 1}->{$kind} // 0;
    file_write("$directory/$name", $block->{text});
    my ($status, $output) = run_line($directory, "bcifs check --quiet $name");
    is($status, $wanted, "$where: check of $name exits with $wanted") or diag($output);
    return if $kind eq 'free' || $kind eq 'error';
    ($status, $output) = run_line($directory, "bcifs fmt $name");
    is($output, $block->{text}, "$where: $name is in canonical layout");
}

sub console_block {
    my ($directory, $block, $where) = @_;
    my @parts = split /^(?=\$ )/m, $block->{text};
    for my $i (0 .. $#parts) {
        my ($line, $expected) = $parts[$i] =~ /\A\$ ([^\n]*)\n(.*)\z/s;
        if (!defined $line) {
            fail("$where: the block begins with a command");
            next;
        }
        my $wanted = $i == $#parts ? $block->{info}[0] // 0 : 0;
        my ($status, $output) = run_line($directory, $line);
        is($status, $wanted, "$where: '$line' exits with $wanted");
        is($output, $expected, "$where: '$line' prints what is shown");
    }
}

# Nothing is built here: the build that is tested must stay as it is.
sub shell_block {
    my ($directory, $block, $where) = @_;
    for my $line (split /\n/, $block->{text}) {
        if ($line =~ /^make /) {
            local $ENV{MAKEFLAGS} = '';
            qx(cd '$ROOT' && $line -n 2>&1);
            is($?, 0, "$where: '$line' is known");
        } elsif ($line =~ m{^build/bcifs .* -o docs/}) {
                my ($status, $output) = run_line($directory, $line);
            is($status, 0, "$where: '$line' succeeds") or diag($output);
        } else {
            fail("$where: do not know how to try '$line'");
        }
    }
}

# A picture of the documentation shows what its command draws now; its words may lag behind.
sub pictures_compare {
    my ($directory) = @_;
    for my $path (glob "$directory/docs/*.svg") {
        my $name = basename($path);
        my ($new, $old) = map { join '', file_text($_) =~ /(<path.*?>)/gs } $path, "$ROOT/docs/$name";
        ok(length $new && $new eq $old, "docs/$name is what its command draws");
    }
}

# Whether the numbers of two texts agree to a hundredth of a pixel, and all else to the letter.
sub is_near {
    my ($one, $other) = @_;
    my @numbers = map { [/(-?[\d.]+)/g] } $one, $other;
    return 0 if @{$numbers[0]} != @{$numbers[1]};
    return !grep { abs($numbers[0][$_] - $numbers[1][$_]) > 0.011 } 0 .. $#{$numbers[0]};
}

for my $page (@pages) {
    my $directory = workplace();
    for my $block (blocks($page)) {
        my $where = basename($page) . ":$block->{line}";
        my $language = $block->{language};
        if ($language eq 'bcifs') {
            file_block($directory, $block, $where);
        } elsif ($language eq 'c') {
            file_write("$directory/$block->{info}[0]", $block->{text});
        } elsif ($language eq 'console') {
            console_block($directory, $block, $where);
        } elsif ($language eq 'sh') {
            shell_block($directory, $block, $where);
        } else {
            is($language, '', "$where: a block of a known language");
        }
    }
    pictures_compare($directory);
}

# The pictures of the editor are what their script makes, up to the words in them.
{
    my $made = File::Temp->newdir();
    my $status = system("cd '$ROOT' && BCIFS='$BCIFS' sh docs/figures.sh '$made'");
    is($status, 0, 'docs/figures.sh makes the pictures of the editor');
    for my $path (glob "$ROOT/docs/figures/*.svg") {
        my $name = basename($path);
        my ($new, $old) = map { -e $_ ? join('', file_text($_) =~ /(<path.*?>)/gs) : '' } "$made/$name", $path;
        ok(length $new && is_near($new, $old), "docs/figures/$name is what the script draws");
    }
}

# ---- Links -------------------------------------------------------------------------------------------------

# The anchors of a page's headings, as they are made on the web.
sub anchors {
    my ($page) = @_;
    my $text = file_text($page);
    $text =~ s/^```.*?^```$//gms;
    return map { my $anchor = lc; $anchor =~ s/[`*?,:]//g; $anchor =~ s/\s/-/g; ($anchor => 1) } $text =~ /^#+ (.*)$/gm;
}

for my $page (@pages) {
    my $text = file_text($page);
    $text =~ s/^```.*?^```$//gms;
    for my $link ($text =~ /\]\(([^)\s]+)\)/g) {
        next if $link =~ m{^https?://};
        my ($file, $anchor) = $link =~ /^([^#]*)(?:#(.*))?$/;
        my $target = length $file ? dirname($page) . "/$file" : $page;
        my $good = -e $target && (!defined $anchor || {anchors($target)}->{$anchor});
        ok($good, basename($page) . ": the link $link leads somewhere");
    }
}

# ---- The manual page ---------------------------------------------------------------------------------------

my $manual = file_text("$ROOT/docs/bcifs.1");

# Name => argument of the options in a section of the manual page.
sub manual_options {
    my ($command) = @_;
    my ($section) = $manual =~ /^\.SS \Q$command\E\n(.*?)(?=^\.S[SH])/ms or return;
    my %options;
    while ($section =~ /^\.TP\n\.BI? (\\-\S+)(?: "\s*(.*?)"| (\S+))?$/mg) {
        my ($name, $argument) = ($1, $2 // $3 // '');
        $name =~ s/\\-/-/g;
        $options{$name} = $argument;
    }
    return \%options;
}

# The same from the help of the command.
sub help_options {
    my ($command) = @_;
    my $help = qx('$BCIFS' help $command);
    $help =~ s/…/.../g;
    my %options;
    $options{$1} = $2 // '' while $help =~ /^  (-\S+)(?: (\S+))?  +\S/mg;
    return \%options;
}

my $overview = qx('$BCIFS' help);
my @commands = $overview =~ /^  (\w+)  +\S/mg;
is_deeply([sort $manual =~ /^\.SS (\w+)$/mg], [sort @commands], 'the manual page has the commands of bcifs help');
is_deeply(manual_options($_), help_options($_), "the manual page has the options of bcifs help $_")
    for grep { $_ ne 'help' } @commands;

my ($version) = qx('$BCIFS' --version) =~ /^(bcifs \S+)$/m;
like($manual, qr/^\.TH BCIFS 1 "\d{4}-\d\d-\d\d" "\Q$version\E"/m, 'the manual page is of this version');
my ($formats) = $manual =~ /^\.SH FORMATS\n(.*?)(?=^\.SH)/ms;
my ($known) = qx('$BCIFS' eval '$ROOT/automata/chaikin.bcifs' --format none 2>&1) =~ /expected (.*)/;
is_deeply([sort $formats =~ /^\.TP\n\.B (\w+)$/mg], [sort grep { $_ ne 'or' } $known =~ /(\w+)/g],
    'the manual page has the formats that eval knows');

SKIP: {
    my ($formatter) = grep { system("command -v $_->[0] >/dev/null 2>&1") == 0 }
        ['mandoc', 'mandoc -T lint -W warning'], ['groff', 'groff -man -ww -Tascii -z'];
    skip 'no formatter of manual pages', 1 unless $formatter;
    is(qx($formatter->[1] '$ROOT/docs/bcifs.1' 2>&1), '', "$formatter->[0] finds nothing in the manual page");
}

# ---- Limits ------------------------------------------------------------------------------------------------

# A constant expression of the source: numbers, *, <<, -, parentheses.
sub constant_value {
    my ($text) = @_;
    $text =~ s/UINT64_C\((\w+)\)/$1/g;
    $text =~ s/\s*$//;
    return $text =~ /^[0-9a-fx*<\s()-]+$/ ? eval $text =~ s/(0x[0-9a-f]+)/hex $1/er : undef;
}

my (%constants, %in_language);
for my $path (glob "$ROOT/lib/*/*.[ch]") {
    (my $text = file_text($path)) =~ s{/\*.*?\*/}{}gs;
    while ($text =~ /\b([A-Z][A-Z_]+)\s*=\s*([^,;}\n]+)|^#define\s+([A-Z][A-Z_]+)\s+(.+)$/mg) {
        my ($name, $value) = ($1 // $3, constant_value($2 // $4));
        next unless defined $value;
        $constants{$name}{$value} = 1;
        $in_language{$name} = 1
            if $path =~ m{/lib/(?:language|automaton)/\w+\.h$} && $name =~ /MOST|LONGEST|DEEPEST|TALLEST/;
    }
}

my ($table) = file_text("$ROOT/docs/language.md") =~ /^## Limits\n(.*?)^## /ms;
my %documented;
$documented{$2} = $1 while $table =~ /^\|[^|]*\|\s*(\d+)\s*\|\s*`(\w+)`\s*\|$/mg;
for my $name (sort keys %documented) {
    my @values = sort keys %{$constants{$name} // {}};
    is("@values", $documented{$name}, "the limit $name is that of the source");
}
is_deeply([grep { !exists $documented{$_} } sort keys %in_language], [], 'every limit of the language is documented');

done_testing();
