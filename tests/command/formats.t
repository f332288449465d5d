#!/usr/bin/env perl
# The data formats of `eval`, read back by other code than wrote them, and what becomes of the file when
# something fails. The raw doubles of .f64 are the measure: every other format has to hold the same bits.
use strict;
use warnings;
use FindBin;
use lib "$FindBin::Bin/lib";
use JSON::PP;
use Test::More;
use Eval;

# Figures of every kind: closed, open, several chains, loose points, control frames, 1 to 16 coordinates.
sub samples
{
    srand 2;
    my @samples = (
        [ 'closed', 2, gallery('chaikin'), '--depth', 9 ],
        [ 'open', 2, gallery('koch'), '--figure', 'bent', '--depth', 4 ],
        [ 'chains', 2, gallery('dragon'), '--figure', 'four', '--depth', 6 ],
        [ 'loose', 2, gallery('fern'), '--depth', 6 ],
        [ 'frames', 2, gallery('sierpinski-triangle'), '--depth', 4, '--show', 'control' ]);
    for my $dimension (1, 3, 4, 16) {
        my $csv = spit(scratch("points-$dimension.csv"), csv_of(random_points(6, $dimension)));
        push @samples, [ "$dimension coordinates", $dimension, gallery('chaikin'), '--points', $csv, '--depth', 5 ];
    }
    # Numbers of all sizes.
    my $csv = spit(scratch('sizes.csv'), "1e-300,1e300\n-3e-320,2e5\n0,-7.25e-9\n123456789012345678,1\n");
    push @samples, [ 'sizes', 2, gallery('chaikin'), '--points', $csv, '--depth', 5 ];
    return @samples;
}

sub header { return join(',', $_[0] <= 3 ? (qw(x y z))[ 0 .. $_[0] - 1 ] : map { "x$_" } 0 .. $_[0] - 1) . "\n" }

sub test_sample
{
    my ($what, $dimension, @options) = @_;
    my ($status, $raw, $err) = run('eval', @options, '--format', 'f64');
    is($status, 0, "$what: f64") or diag($err);
    my @numbers = unpack 'd<*', $raw;
    my $count = @numbers / $dimension;
    ok($count == int $count && $count > 10, "$what: whole points");
    my %text;
    for my $format (qw(csv json npy f64)) {
        my $path = scratch("sample.$format");
        ($status, my $out, $err) = run('eval', @options, '-o', $path);
        $text{$format} = slurp($path);
        ok($status == 0 && $out eq '' && $err eq '', "$what: .$format by its ending, in silence") or diag($err);
        (undef, $out) = run('eval', @options, '--format', $format);
        is_same($out, $text{$format}, "$what: the same on standard output");
        unlink $path;
    }
    is_same($text{f64}, $raw, "$what: .f64 is raw doubles");
    test_csv($what, $dimension, $text{csv}, \@numbers);
    test_json($what, $dimension, $text{json}, \@numbers, $text{csv});
    test_npy($what, $dimension, $count, $text{npy}, $raw);
}

sub test_csv
{
    my ($what, $dimension, $text, $numbers) = @_;
    my $head = header($dimension);
    my @rows = grep { $_ ne '' } split /\n/, substr $text, length $head;
    is(substr($text, 0, length $head), $head, "$what: header of .csv");
    my @cells = map { split /,/ } @rows;
    ok(join(',', map { number_bits($_) } @cells) eq join(',', map { number_bits($_) } @$numbers), "$what: .csv holds every bit");
    # Shortest: one digit less, either way, is another number. %.{n}g has n significant digits.
    my $shortest = 1;
    for my $cell (@cells[ 0 .. ($#cells < 400 ? $#cells : 400) ]) {
        (my $digits = $cell) =~ s/e.*//;
        $digits =~ s/[-.]//g;
        $digits =~ s/^0+|0+$//g;
        my $less = length($digits) - 1;
        next if $less < 1 || sprintf("%.${less}g", $cell) != $cell;
        diag("$what: $cell");
        $shortest = 0;
    }
    ok($shortest, "$what: numbers have no digit too many");
}

# What a JSON number says is the double that perl reads from it.
sub test_json
{
    my ($what, $dimension, $text, $numbers, $csv) = @_;
    my $data = eval { decode_json($text) };
    ok($data, "$what: .json is JSON") or return diag($@);
    is($data->{dimension}, $dimension, "$what: .json has the dimension");
    is($data->{points}, @$numbers / $dimension, "$what: .json has the number of points");
    my $lists = $data->{coordinates} ? [ $data->{coordinates} ] : $data->{polygons} || [ map { $_->{points} } @{ $data->{paths} } ];
    my @found = map { map { @$_ } @$_ } @$lists;
    ok(join(',', map { number_bits($_) } @found) eq join(',', map { number_bits($_) } @$numbers), "$what: .json holds every bit");
    # The blank lines of .csv stand between the same groups.
    my @groups = split /\n\n/, $csv =~ s/^[a-z0-9,]+\n//r;
    is_deeply([ map { scalar @$_ } @$lists ], [ map { scalar(split /\n/) } @groups ], "$what: the groups are the blocks of .csv");
    like($text, qr/"automaton": "\w+", "figure": "\w*"/, "$what: .json names the automaton and the figure");
    is_deeply([ map { $_->{closed} ? 1 : 0 } @{ $data->{paths} } ], $what eq 'open' ? [0] : $what eq 'chains' ? [ (0) x 4 ] : [1],
        "$what: .json says which paths are closed")
        if $data->{paths};
    ok(!$data->{paths} == ($what eq 'loose' || $what eq 'frames'), "$what: cells are not paths");
}

# The format of numpy.lib.format, version 1.0.
sub test_npy
{
    my ($what, $dimension, $count, $text, $raw) = @_;
    my ($magic, $major, $minor, $length) = unpack 'a6CCv', $text;
    ok($magic eq "\x93NUMPY" && $major == 1 && $minor == 0, "$what: magic and version of .npy");
    is((10 + $length) % 64, 0, "$what: the data of .npy are aligned");
    my $header = substr $text, 10, $length;
    like($header, qr/^\{'descr': '<f8', 'fortran_order': False, 'shape': \($count, $dimension\), \} *\n$/, "$what: header of .npy");
    is_same(substr($text, 10 + $length), $raw, "$what: data of .npy");
}

# ---- Files ---------------------------------------------------------------------------------------------------

sub leftovers
{
    my ($directory) = @_;
    opendir my $handle, $directory or die;
    return sort grep { !/^\.\.?$/ } readdir $handle;
}

# A failing run leaves an existing file as it was, and no other.
sub test_failures
{
    my $directory = scratch('files');
    mkdir $directory or die;
    my $broken = spit(scratch('broken.bcifs'), slurp(gallery('chaikin')) =~ s/sub arc \[ 3\/4/sub arc [ 2\/4/r);
    # Frames that double at every level leave the doubles behind level 1024.
    my $overflow = spit(scratch('overflow.bcifs'), <<'END');
automaton overflow
cell c 2 {
  sub c [ 3/2 -1/2
         -1/2  3/2 ]
}
figure f { piece c at 0 1 points [ 1; -1 ] }
END
    my @cases = (
        [ 'an equation that fails', 1, $broken ],
        [ 'no such file', 2, scratch('missing.bcifs') ],
        [ 'no such figure', 2, gallery('chaikin'), '--figure', 'circle' ],
        [ 'too deep', 2, gallery('chaikin'), '--depth', '100' ],
        [ 'points that are not finite', 2, $overflow, '--show', 'control', '--depth', 1100 ],
        [ 'bad seed', 2, gallery('chaikin'), '--show', 'seed:1,1' ],
        [ 'an empty range', 2, gallery('chaikin'), '--depth', 1, '--range', '0.3..0.31' ],
        [ 'a picture of four coordinates', 2, gallery('chaikin'), '--points', spit(scratch('4.csv'), csv_of(random_points(4, 4))) ],
    );
    for my $format (qw(csv json npy f64 svg png)) {
        my $path = "$directory/kept.$format";
        my $good = 1;
        for my $case (@cases) {
            my ($what, $expected, @options) = @$case;
            next if $what =~ /picture/ && $format !~ /svg|png/;
            spit($path, "old $format");
            my ($status, $out, $err) = run('eval', @options, '-o', $path);
            my $kept = $status == $expected && $out eq '' && $err ne '' && slurp($path) eq "old $format";
            diag("$what: exit $status, file '" . substr(slurp($path), 0, 20) . "', $err") unless $kept;
            unlink $path;
            run('eval', @options, '-o', $path);
            $kept &&= !-e $path;
            $good &&= $kept;
        }
        ok($good, "a failing run leaves an existing .$format alone, and makes none");
    }
    is_deeply([ leftovers($directory) ], [], 'and leaves nothing beside it');
    # Success replaces what was there.
    spit("$directory/new.csv", 'x' x 100000);
    my ($status) = run('eval', gallery('chaikin'), '--depth', 1, '-o', "$directory/new.csv");
    ok($status == 0 && slurp("$directory/new.csv") =~ /^x,y\n1,0\n/, 'a run that succeeds replaces it');
    is_deeply([ leftovers($directory) ], ['new.csv'], 'with one file');
    ($status, my $out, my $err) = run('eval', gallery('chaikin'), '-o', "$directory/no/such/place.csv");
    ok($status >= 2 && $err =~ /place\.csv/, "a directory that does not exist: exit $status");
    ($status, $out, $err) = run('eval', gallery('chaikin'), '-o', "$directory/a.xyz");
    ok($status == 2 && $err =~ /csv/, 'an ending that names no format lists those there are');
    test_small_disk("$directory/new.csv");
    is_deeply([ leftovers($directory) ], ['new.csv'], 'and leaves nothing beside it');
    SKIP: {
        skip 'no /dev/full here', 2 unless -c '/dev/full';
        ($status, $out, $err) = run('eval', gallery('chaikin'), '--format', 'csv', '-o', '/dev/full');
        is($status, 3, 'a full device: exit 3');
        like($err, qr{/dev/full}, 'and its name');
    }
}

# A disk that fills up on the way: files may grow to 64 blocks, writes beyond fail.
sub test_small_disk
{
    my ($path) = @_;
    my $child = fork // die;
    if ($child == 0) {
        $SIG{XFSZ} = 'IGNORE';
        open STDERR, '>', scratch('small') or die;
        exec 'sh', '-c', 'ulimit -f 64; exec "$@"', 'sh', $ENV{BCIFS} // 'build/bcifs', 'eval', gallery('chaikin'), '--depth', 14,
            '-o', $path
            or die;
    }
    waitpid $child, 0;
    is($? >> 8, 3, 'a disk that fills up: exit 3');
    like(slurp(scratch('small')), qr/new\.csv/, 'and the name of the file');
    like(slurp($path), qr/^x,y\n1,0\n/, 'the file that was there stays');
}

# Interrupted at any moment, the file is the old or the new one, whole.
sub test_interruption
{
    my $path = scratch('interrupted.f64');
    my (undef, $expected) = run('eval', gallery('chaikin'), '--depth', 17, '--format', 'f64');
    my $good = 1;
    for my $try (1 .. effort(12)) {
        spit($path, 'old');
        my $child = fork // die;
        if ($child == 0) {
            open STDERR, '>', '/dev/null' or die;
            exec $ENV{BCIFS} // 'build/bcifs', 'eval', gallery('chaikin'), '--depth', 17, '-o', $path or die;
        }
        select undef, undef, undef, 0.003 * $try;
        kill 'KILL', $child;
        waitpid $child, 0;
        my $text = slurp($path);
        my $whole = $text eq 'old' || $text eq $expected;
        diag("after $try: " . length $text) unless $whole;
        $good &&= $whole;
    }
    ok($good, 'a killed run leaves the old file or the new one, whole');
}

# Endings of the depth: --range and single points in the other formats.
sub test_parts
{
    my ($status, $text) = run('eval', gallery('chaikin'), '--depth', 3, '--range', '1/4..1/2', '--json');
    my $data = decode_json($text);
    is_deeply([ $status, $data->{points}, $data->{paths}[0]{closed} ? 1 : 0 ], [ 0, 9, 0 ], 'a part of a closed curve is open');
    ($status, $text) = run('eval', gallery('chaikin'), '--at', '1/8', '--at', '1/4', '--json');
    # The middle of the square's first piece is (1/8, 3/4, 1/8) · P, its second piece starts in the middle of a side.
    is_deeply(decode_json($text), { points => [ [ 1.75, 0.25 ], [ 2, 1 ] ] }, 'single points as JSON');
    ($status, $text) = run('eval', gallery('chaikin'), '--at', '1/8');
    is($text, "x,y\n1.75,0.25\n", 'and as csv');
}

test_sample(@$_) for samples();
test_failures();
test_interruption();
test_parts();
done_testing();
