#!/usr/bin/env perl
# Every diagnostic of the language. The files in tests/data/diagnostics say themselves what must be found:
#
#   # expect error 4:7: text            at line 4, column 7 of this file
#   # expect error other.bcifs:4:7: text
#   # expect error: text                in this file, at no place
#   # expect error bcifs: text          in no file
#   # expect error =--set a:1:3: text   in something that is no file
#   # expect warning …                  the same for warnings
#   # run eval --depth 3                the command and its options; without this line: check
#   # status 0                          the exit status; without this line: 2
#   # todo why                          what is expected is not what is reported yet
#
# {folder} in a text stands for the folder of the sample.
# Nothing else may be reported, nothing may be missing, and every placed finding shows its line and a caret.
use strict;
use warnings;
use utf8;
use FindBin;
use lib "$FindBin::Bin/lib";
use Bcifs;
use Encode qw(decode_utf8 encode_utf8);
use Test::More;

binmode $_, ':utf8' for map { Test::More->builder->$_ } qw(output failure_output todo_output);

my $folder = "$ROOT/tests/data/diagnostics";

# The line that the report of a finding must be.
sub expected_line {
    my ($path, $severity, $place, $text) = @_;
    $text =~ s/\{folder\}/$folder/g;
    return "$path: $severity: $text" if $place eq '';
    return "bcifs: $severity: $text" if $place eq 'bcifs';
    return "$path:$place: $severity: $text" if $place =~ /^\d/;
    return substr($place, 1) . ": $severity: $text" if $place =~ /^=/;
    return "$folder/$place: $severity: $text";
}

# Whether the lines below a finding show the line it is about, with a caret under the column.
sub excerpt_is_right {
    my ($file, $line, $column, @below) = @_;
    return @below == 2 && $below[1] =~ /^ *\^$/ && length $below[1] == $column if !-e $file;
    my $source = (split /\n/, decode_utf8(file_text($file)), -1)[ $line - 1 ];
    $source =~ s/\r$//;
    return !@below if $source =~ /^[ \t]*$/;
    return 0 if @below != 2;
    my ($shown, $caret) = @below;
    return 0 if $caret !~ /^[ \t]*\^$/;
    my $at = length($caret) - 1;
    if (length(encode_utf8($source)) > 120) { # a long line is cut
        $shown =~ s/^(…?)//;
        $at -= length $1;
        $shown =~ s/…$//;
        my $from = index $source, $shown;
        return $from >= 0 && substr($source, $column - 1, 1) eq substr($shown, $at, 1);
    }
    return $shown eq $source && $at == $column - 1;
}

for my $path (sort glob "$folder/*.bcifs") {
    my ($name) = $path =~ m{([^/]+)\.bcifs$};
    my $text = decode_utf8(file_text($path));
    my @wanted = map { expected_line($path, @$_) }
        map { [ /^(error|warning) ?(=[^:]+:\d+:\d+|(?:[\w.-]+:)?\d+:\d+|[\w.-]*): (.*)$/ ] } $text =~ /^# expect (.*)$/mg;
    next if !@wanted && $text =~ /^# used by other files/m;
    my ($run) = $text =~ /^# run (.*)$/m;
    my ($status_wanted) = $text =~ /^# status (\d)$/m;
    my ($command, @options) = split ' ', $run // 'check';
    my ($status, $out, $err) = bcifs([ $command, $path, @options ]);
    my @lines = split /\n/, decode_utf8($err);
    my (@found, @wrong);
    for (my $i = 0; $i < @lines; $i++) {
        my ($file, $line, $column) = $lines[$i] =~ /^(.*?)(?::(\d+):(\d+))?: (?:error|warning): ./
            or push(@wrong, $lines[$i]), next;
        push @found, $lines[$i];
        my @below;
        push @below, $lines[ ++$i ] while $i + 1 < @lines && $lines[ $i + 1 ] !~ /^\S.*?: (?:error|warning): /;
        next if !defined $line && !@below;
        push @wrong, $found[-1], @below if !defined $line || !excerpt_is_right($file, $line, $column, @below);
    }
    {
        local our $TODO = $text =~ /^# todo (.*)$/m ? $1 : undef;
        is_deeply([ sort @found ], [ sort @wanted ], "$name: what is reported");
    }
    is_deeply(\@wrong, [], "$name: every finding shows its line and a caret");
    is($status, $status_wanted // 2, "$name: the exit status");
    is($out, '', "$name: nothing on standard output") if !defined $status_wanted;
}

done_testing;
