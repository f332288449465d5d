#!/usr/bin/env perl
# make install: what is put where; a program built against it, from the flags of its pkg-config file, with the static
# and with the shared library; the names the shared library gives away; make uninstall.
use strict;
use warnings;
use FindBin;
use lib "$FindBin::Bin/lib";
use Bcifs;
use File::Find ();
use File::Temp ();
use Test::More;

my $make = $ENV{MAKE} // 'make';
my $cc = $ENV{CC} // 'cc';
plan skip_all => 'no make' if system("$make --version >/dev/null 2>&1") != 0;
plan skip_all => "no library in $BUILD" if !-e "$BUILD/libbcifs.a";

# What the make that runs the tests was told does not concern the one that is tested.
delete @ENV{qw(MAKEFLAGS MFLAGS MAKELEVEL DESTDIR PREFIX)};
my $folder = File::Temp->newdir();
my ($destination, $prefix) = ("$folder/stage", '/usr');
my $sanitize = '';
$sanitize = join ' ', file_text("$BUILD/flags") =~ /(-fsanitize=\S+)/ if $SANITIZED;

# The build is not what is tested here: `-o all` takes it as it is, whatever flags it was made with.
sub run_make {
    my ($target) = @_;
    my $log = "$folder/log";
    my $status = system 'sh', '-c', 'umask 077; cd "$0" && exec "$@" >"' . $log . '" 2>&1', $ROOT, split(' ', $make), '-o', 'all', $target,
        "BUILD=$BUILD", "PREFIX=$prefix", "DESTDIR=$destination";
    diag(file_text($log)) if $status;
    return $status;
}

sub all_files {
    my ($top) = @_;
    my @files;
    File::Find::find({ no_chdir => 1, wanted => sub { push @files, $File::Find::name if -l || -f } }, $top) if -d $top;
    return sort map { substr $_, length $top } @files;
}

# Runs a shell command; returns its status and output.
sub shell {
    my ($command) = @_;
    my $output = `$command 2>&1`;
    return ($?, $output);
}

# ---- What is installed -----------------------------------------------------------------------------------------

is(run_make('install'), 0, 'make install');
my ($version) = (bcifs(['--version']))[1] =~ /^bcifs (\S+)$/;
my ($major) = $version =~ /^(\d+)/;
my $soname = "libbcifs.so.$major";
my @gallery = map { m{([^/]+)$} } sort glob "$ROOT/automata/*.bcifs";
is_deeply([ all_files($destination) ], [ sort map { "$prefix/$_" } 'bin/bcifs', 'include/bcifs.h', 'lib/libbcifs.a', 'lib/libbcifs.so',
    "lib/$soname", "lib/libbcifs.so.$version", 'lib/pkgconfig/bcifs.pc', 'share/man/man1/bcifs.1', map { "share/bcifs/automata/$_" } @gallery ],
    'the command, both libraries, header, pkg-config file, manual page, gallery');

my $root = "$destination$prefix";
for my $file (map { "$destination$_" } all_files($destination)) {
    my $wanted = $file =~ m{/bin/bcifs$|\.so\.[\d.]+$} && !-l $file ? 0755 : 0644;
    (my $name = $file) =~ s/^\Q$root\E//;
    next if -l $file;
    is(sprintf('%o', (stat $file)[2] & 0777), sprintf('%o', $wanted), "the mode of $name");
}
is(readlink "$root/lib/$soname", "libbcifs.so.$version", "$soname is a link to the library");
is(readlink "$root/lib/libbcifs.so", $soname, "libbcifs.so is a link to $soname");
is(file_text("$root/include/bcifs.h"), file_text("$ROOT/include/bcifs.h"), 'the header is that of the project');
like(file_text("$root/share/man/man1/bcifs.1"), qr/^\.TH /m, 'the manual page has a title');
is((grep { file_text("$ROOT/automata/$_") ne file_text("$root/share/bcifs/automata/$_") } @gallery), 0, 'the gallery is that of the project');
is((shell("'$root/bin/bcifs' check --quiet '$root/share/bcifs/automata/chaikin.bcifs'"))[0], 0, 'the installed command checks the installed gallery');

# ---- The pkg-config file ---------------------------------------------------------------------------------------

my %pc;
for (split /\n/, file_text("$root/lib/pkgconfig/bcifs.pc")) {
    $pc{$1} = $2 if /^([\w.]+)\s*[=:]\s*(.*)$/;
}
for my $value (values %pc) { 1 while $value =~ s/\$\{(\w+)\}/$pc{$1}/g }
is($pc{prefix}, $prefix, 'bcifs.pc: the prefix');
is($pc{Version}, $version, 'bcifs.pc: the version');
ok($pc{Name} && $pc{Description}, 'bcifs.pc: name and description');
unlike(file_text("$root/lib/pkgconfig/bcifs.pc"), qr/\@\w+\@|\Q$destination\E/, 'bcifs.pc: nothing is left to fill in, and nothing of the stage');
SKIP: {
    skip 'no pkg-config', 2 if (shell('pkg-config --version'))[0] != 0;
    local $ENV{PKG_CONFIG_PATH} = "$root/lib/pkgconfig";
    is((shell('pkg-config --validate bcifs'))[0], 0, 'pkg-config accepts it');
    is((shell('pkg-config --modversion bcifs'))[1], "$version\n", 'pkg-config reads its version');
}

# ---- A program -------------------------------------------------------------------------------------------------

file_write("$folder/program.c", <<'END');
#include <bcifs.h>
#include <stdio.h>
#include <string.h>

int main(int count, char **words)
{
    bcifs_automaton *automaton;
    bcifs_check *check;
    bcifs_figure *figure;
    bcifs_plan *plan;
    bcifs_walker *walker;
    bcifs_error error;
    bcifs_view view = {.depth = 2, .to = 1};
    double points[64];
    if (count != 2 || strcmp(bcifs_version(), BCIFS_VERSION) != 0)
        return 1;
    if (bcifs_load("/nowhere/to/be/found", NULL, &automaton, &error) != BCIFS_INPUT || !error.message[0])
        return 2;
    if (bcifs_load(words[1], NULL, &automaton, &error) || bcifs_check_create(automaton, NULL, &check, &error))
        return 3;
    if (!bcifs_check_valid(check) || bcifs_figure_create(automaton, NULL, &figure, &error))
        return 4;
    if (bcifs_plan_create(figure, &view, &plan, &error) || bcifs_walker_create(plan, &walker, &error))
        return 5;
    size_t found = bcifs_walker_next(walker, points, 32);
    printf("%s %s %d %g %g\n", bcifs_automaton_name(automaton), bcifs_figure_name(figure), (int)found, points[0], points[1]);
    bcifs_walker_free(walker);
    bcifs_plan_free(plan);
    bcifs_figure_free(figure);
    bcifs_check_free(check);
    bcifs_automaton_free(automaton);
    return 0;
}
END
# The flags, where the files were staged.
my %flags = map { $_ => ($pc{$_} // '') =~ s{(-[IL])\Q$prefix\E}{$1$root}gr } 'Cflags', 'Libs', 'Libs.private';
my $compile = "$cc -std=c11 -Wall -Wextra -pedantic -Werror $sanitize '$folder/program.c'";
# The square of Chaikin: 4 pieces of 4 points at depth 2, the first in the middle of the first side.
my $answer = "chaikin square 16 1 0\n";
my $chaikin = "$root/share/bcifs/automata/chaikin.bcifs";
{
    my ($status, $log) = shell("$compile $flags{Cflags} $flags{Libs} -o '$folder/shared'");
    is($status, 0, 'a program is built against the shared library') or diag($log);
    local $ENV{LD_LIBRARY_PATH} = join ':', "$root/lib", $ENV{LD_LIBRARY_PATH} // ();
    my (undef, $output) = shell("'$folder/shared' '$chaikin'");
    is($output, $answer, 'and runs');
    SKIP: {
        my ($no_readelf, $dynamic) = shell("readelf -d '$folder/shared'");
        skip 'no readelf', 1 if $no_readelf;
        like($dynamic, qr/NEEDED.*\[\Q$soname\E\]/, 'and asks for the library by its soname');
    }
}
{
    my $static = $flags{Libs} =~ s{-lbcifs}{'$root/lib/libbcifs.a'}r;
    my ($status, $log) = shell("$compile $flags{Cflags} $static $flags{'Libs.private'} -o '$folder/static'");
    is($status, 0, 'a program is built against the static library') or diag($log);
    local $ENV{LD_LIBRARY_PATH};
    my (undef, $output) = shell("'$folder/static' '$chaikin'");
    is($output, $answer, 'and runs');
}
SKIP: {
    skip 'no C++ compiler', 1 if (shell('c++ --version'))[0] != 0;
    file_write("$folder/header.cc", "#include <bcifs.h>\nint main() { return bcifs_version()[0] == 0; }\n");
    my ($status, $log) = shell("c++ -Wall -Wextra -Werror -fsyntax-only $flags{Cflags} '$folder/header.cc'");
    is($status, 0, 'the header is good for C++') or diag($log);
}

# ---- Names -----------------------------------------------------------------------------------------------------

SKIP: {
    my ($no_nm, $table) = shell("nm -D --defined-only '$root/lib/$soname'");
    skip 'no nm', 2 if $no_nm;
    skip 'a sanitizer adds names of its own', 2 if $SANITIZED;
    my @names = sort map { (split ' ')[-1] =~ s/@.*//r } grep { /\S/ } split /\n/, $table;
    is_deeply([ grep { !/^bcifs_/ } @names ], [], 'the shared library exports names that begin with bcifs_ only');
    my $header = file_text("$root/include/bcifs.h");
    my @declared = sort $header =~ /^BCIFS_PUBLIC[^;(]*?\b(bcifs_\w+)\s*\(/mg;
    is_deeply(\@names, \@declared, 'just those that the header declares');
}

# ---- And away --------------------------------------------------------------------------------------------------

is(run_make('install'), 0, 'make install over what is there');
file_write("$root/share/mine", "kept\n");
is(run_make('uninstall'), 0, 'make uninstall');
is_deeply([ all_files($destination) ], ["$prefix/share/mine"], 'make uninstall removes everything, and nothing else');
ok(!-d "$root/share/bcifs", 'its own folders too');

done_testing;
