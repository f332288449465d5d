# What the tests of the command share: running it with a time limit, telling sanitizer findings from answers,
# and writing small files.
package Bcifs;

use strict;
use warnings;
use Cwd qw(abs_path);
use Exporter 'import';
use File::Basename qw(dirname);
use File::Temp ();
use JSON::PP ();
use POSIX ();
use Test::More ();

our @EXPORT = qw($BCIFS $BUILD $ROOT $SANITIZED bcifs check_json file_text file_write scratch points_of);

our $ROOT = abs_path(dirname(abs_path(__FILE__)) . '/../../..');
our $BUILD = $ENV{BUILD} // "$ROOT/build";
our $BCIFS = $ENV{BCIFS} // "$BUILD/bcifs";
$_ = -e $_ ? abs_path($_) : $_ for $BUILD, $BCIFS;

# A sanitizer reserves terabytes of addresses and takes its time.
our $SANITIZED = do {
    my $flags = -e "$BUILD/flags" ? file_text("$BUILD/flags") : '';
    $flags =~ /-fsanitize/ ? 1 : 0;
};

my $directory = File::Temp->newdir();
my ($own_process, $serial) = ($$, 0);

# The path of a new file (or the named one) in this test's own directory, with `text` in it when given.
sub scratch {
    my ($name, $text) = @_;
    my $path = "$directory/" . (defined $name ? $name : 'file' . $serial++);
    file_write($path, $text) if defined $text;
    return $path;
}

sub file_text {
    my ($path) = @_;
    open my $file, '<:raw', $path or die "$path: $!";
    local $/;
    my $text = <$file>;
    close $file;
    return defined $text ? $text : '';
}

sub file_write {
    my ($path, $text) = @_;
    utf8::encode($text) if utf8::is_utf8($text);
    open my $file, '>:raw', $path or die "$path: $!";
    print $file $text;
    close $file or die "$path: $!";
    return $path;
}

# Runs the command: bcifs([words], stdin => text, seconds => s, kilobytes => k, stdout => path).
# Returns (status, standard output, standard error); the status is -signal for a crash, 'timeout' past the limit.
sub bcifs {
    my ($words, %option) = @_;
    my $seconds = ($option{seconds} // 20) * ($SANITIZED ? 6 : 1);
    my $in = defined $option{stdin} ? scratch('.stdin', $option{stdin}) : '/dev/null';
    my ($out, $err) = ($option{stdout} // "$directory/.stdout", "$directory/.stderr");
    my @command = ($BCIFS, @$words);
    unshift @command, 'sh', '-c', "ulimit -v $option{kilobytes}; exec \"\$0\" \"\$@\""
        if $option{kilobytes} && !$SANITIZED;
    my $process = fork;
    die "fork: $!" unless defined $process;
    if ($process == 0) {
        open STDIN, '<', $in or POSIX::_exit(126);
        open STDOUT, '>', $out or POSIX::_exit(126);
        open STDERR, '>', $err or POSIX::_exit(126);
        chdir $option{directory} if defined $option{directory};
        { no warnings 'exec'; exec { $command[0] } @command; }
        POSIX::_exit(127);
    }
    my $late = 0;
    local $SIG{ALRM} = sub { $late = 1; kill 'KILL', $process };
    alarm $seconds;
    waitpid $process, 0;
    my $wait = $?;
    alarm 0;
    my $status = $late ? 'timeout' : $wait & 127 ? -($wait & 127) : $wait >> 8;
    my $errors = file_text($err);
    if ($errors =~ /(?:Address|Leak|Memory|Thread|UndefinedBehavior)Sanitizer|runtime error:/) {
        Test::More::diag("bcifs @$words\n$errors");
        Test::More::fail('no finding of a sanitizer');
    }
    return ($status, defined $option{stdout} ? '' : file_text($out), $errors);
}

# `check --json` of a file, decoded; dies when that is not one JSON object.
sub check_json {
    my ($file, @options) = @_;
    my ($status, $out, $err) = bcifs([ 'check', $file, '--json', @options ]);
    my $json = eval { JSON::PP->new->utf8->decode($out) };
    Test::More::diag("check $file --json @options: status $status\n$out$err") unless ref $json eq 'HASH';
    $json //= {};
    return wantarray ? ($json, $status, $err) : $json;
}

# The rows of a CSV output, without its header, as lists of numbers.
sub points_of {
    my ($csv) = @_;
    my @lines = split /\n/, $csv;
    shift @lines if @lines && $lines[0] =~ /[a-z]/ && $lines[0] !~ /\d\.|^-?\d/;
    return map { [ split /,/ ] } @lines;
}

END { undef $directory if $$ == $own_process }

1;
