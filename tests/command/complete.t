#!/usr/bin/env perl
# bcifs complete: the open entries of an automaton. What is expected comes from the equations worked out by hand ([SI]
# "Résolution des contraintes", [IM] 4.3) and from exact fractions in Perl, never from the program.
use strict;
use warnings;
use utf8;
use FindBin;
use lib "$FindBin::Bin/lib";
use Bcifs;
use JSON::PP ();
use Math::BigRat;
use Encode qw(decode_utf8);
use Test::More;

binmode $_, ':utf8' for map { Test::More->builder->$_ } qw(output failure_output todo_output);

srand 20101118;

# ---- Running it ----------------------------------------------------------------------------------------------

sub complete_json {
    my ($file, @options) = @_;
    my ($status, $out, $err) = bcifs([ 'complete', $file, '--json', @options ]);
    my $json = eval { JSON::PP->new->utf8->decode($out) } // {};
    $json->{status} = $status;
    diag($err) if $status > 1 || $status < 0;
    return $json;
}

sub is_proved {
    my ($text, $what) = @_;
    my $file = scratch(undef, $text);
    my $check = check_json($file);
    my @bad = grep { !$_->{exact} || !$_->{holds} } @{ $check->{equations} // [{}] };
    my ($status) = bcifs([ 'fmt', '--check', $file ]);
    return ok($check->{valid} && !@bad && $status == 0, "$what: proved exactly, in canonical layout")
        || diag($text);
}

sub text_of {
    my ($rows) = @_;
    return join '; ', map { join ' ', @$_ } @$rows;
}

# All entries open, or some: those where `$open->()` is true.
sub opened {
    my ($rows, $open) = @_;
    return [ map { [ map { $open->() ? '?' : $_ } @$_ ] } @$rows ];
}

sub all_open {
    my ($rows, $columns) = @_;
    return [ map { [ ('?') x $columns ] } 1 .. $rows ];
}

# The matrices of an answer, in order, as rows of expressions.
sub matrices_of {
    my ($text) = @_;
    my @matrices;
    $text =~ s/#.*//g;
    while ($text =~ /(?:sub \w+|refine \d+|mask \d+) \[(.*?)\]/gs) {
        my $body = $1;
        $body =~ s/^\s+|\s+$//g;
        push @matrices, [ map { [ split ' ' ] } split /\s*(?:;|\n)\s*/, $body ];
    }
    return @matrices;
}

# The value of an entry such as 1-3/4*a-b/2 for given names, in exact fractions.
sub value_of {
    my ($entry, $values) = @_;
    my $sum = Math::BigRat->new(0);
    while ($entry =~ /\G([-+]?)([\w\/*.]+)/g) {
        my ($sign, $product) = ($1, Math::BigRat->new(1));
        my ($first, @rest) = split /([*\/])/, $2;
        $product = Math::BigRat->new($values->{$first} // $first);
        while (my ($mark, $factor) = splice @rest, 0, 2) {
            $factor = Math::BigRat->new($values->{$factor} // $factor);
            $product = $mark eq '*' ? $product * $factor : $product / $factor;
        }
        $sum = $sign eq '-' ? $sum - $product : $sum + $product;
    }
    return $sum;
}

# Whether given matrices are one member of the answer: every name stands alone in some entry, which tells its value.
sub is_member {
    my ($text, @originals) = @_;
    my @found = matrices_of($text);
    return 0 if @found != @originals;
    my %values;
    for my $m (0 .. $#found) {
        for my $i (0 .. $#{ $found[$m] }) {
            for my $j (0 .. $#{ $found[$m][$i] }) {
                $values{ $found[$m][$i][$j] } = "$originals[$m][$i][$j]" if $found[$m][$i][$j] =~ /^[a-z]\w*$/;
            }
        }
    }
    for my $m (0 .. $#found) {
        for my $i (0 .. $#{ $found[$m] }) {
            for my $j (0 .. $#{ $found[$m][$i] }) {
                my $wanted = Math::BigRat->new("$originals[$m][$i][$j]");
                next if value_of($found[$m][$i][$j], \%values) == $wanted;
                diag("matrix $m, entry ($i, $j): $found[$m][$i][$j], wanted $wanted");
                return 0;
            }
        }
    }
    return 1;
}

# A random column of `height` fractions that sum to 1, `above` zeros above it and `below` below.
sub column {
    my ($above, $height, $below) = @_;
    my @free = map { Math::BigRat->new((int(rand 25) - 12) . '/12') } 2 .. $height;
    my $last = Math::BigRat->new(1);
    $last -= $_ for @free;
    return [ (0) x $above, @free, $last, (0) x $below ];
}

sub from_columns {
    my @columns = @_;
    return [ map { my $i = $_; [ map { "$_->[$i]" } @columns ] } 0 .. $#{ $columns[0] } ];
}

sub moved {
    my ($column, $by) = @_;
    my @moved = ((0) x $by, @$column);
    return [ @moved[ 0 .. $#$column ] ];
}

# ---- The family of the slides --------------------------------------------------------------------------------

sub quadratic {
    my ($joint, $first, $second, $more) = @_;
    return "automaton quadratic\nvertex joint 2 { sub joint [ " . text_of($joint) . " ] }\n"
        . "edge arc 3 {\n  start joint at 0 1\n  end joint at 1 2\n  sub arc [ " . text_of($first)
        . " ]\n  sub arc [ " . text_of($second) . " ]\n}\n" . ($more // '');
}

# Corner cutting with ratios a and b, [SI] "Cas des courbes construites par élimination des coins".
sub cutting {
    my ($a, $b) = map { Math::BigRat->new($_) } @_;
    my ($c, $d) = (1 - $a, 1 - $b);
    return ([ [ $c, $b ], [ $a, $d ] ], [ [ $c, $b, 0 ], [ $a, $d, $c ], [ 0, 0, $a ] ],
        [ [ $b, 0, 0 ], [ $d, $c, $b ], [ 0, $a, $d ] ]);
}

{
    my $file = scratch('slides.bcifs', quadratic(all_open(2, 2), all_open(3, 3), all_open(3, 3)));
    my $json = complete_json($file);
    is($json->{status}, 0, 'the quadratic curve of the slides is completed');
    is($json->{unknowns}, 4 + 9 + 9, 'unknowns');
    # Sums of 2 + 3 + 3 columns of maps and 2 + 2 of boundaries, incidence 2 · 3 × 2, adjacency 3 × 2.
    is($json->{equations}, 12 + 12 + 6, 'equations');
    is($json->{degrees_of_freedom}, 2, '"il ne reste que 2 degrés de liberté"');
    ok($json->{consistent}, 'consistent');
    is_deeply($json->{parameters}, [ 'a', 'b' ], 'called a and b');
    is_deeply(
        [ matrices_of($json->{automaton}) ],
        [   [ [ '1-a', 'b' ], [ 'a', '1-b' ] ],
            [ [ '1-a', 'b', '0' ], [ 'a', '1-b', '1-a' ], [ '0', '0', 'a' ] ],
            [ [ 'b', '0', '0' ], [ '1-b', '1-a', 'b' ], [ '0', 'a', '1-b' ] ],
        ],
        'as the slides write it'
    );
    is_proved($json->{automaton}, 'the family');
    my ($status, $out) = bcifs([ 'complete', $file ]);
    ok($status == 0 && $out eq $json->{automaton}, 'the same on standard output');
    my $again = check_json(scratch(undef, $out));
    ok($again->{contraction}{upper} < 1, 'its values make it contractive');
    my $copy = scratch(undef, $out);
    ok(is_member($out, cutting(@$_)), "a = $_->[0], b = $_->[1] is a member")
        for [ '1/4', '1/4' ], [ '1/3', '1/3' ], [ '-5/7', '9/2' ];
    ($status, my $report) = bcifs([ 'complete', $copy ]);
    my ($check_status, $check_report) = bcifs([ 'check', $copy ]);
    ok($status == 0 && $check_status == 0 && $report eq $check_report, 'completing the answer is checking it');
}

{
    my $wrong = 0;
    for my $round (1 .. 25 * ($ENV{TEST_EFFORT} // 1)) {
        my @matrices = cutting(map { (int(rand 19) - 9) . '/' . (1 + int rand 9) } 1 .. 2);
        my $share = rand;
        my $text = quadratic(map { opened($_, sub { rand() < $share }) } @matrices);
        next if $text !~ /\?/;
        my $json = complete_json(scratch(undef, $text));
        $wrong++, diag($text) if $json->{status} != 0 || !is_member($json->{automaton}, @matrices);
        my $check = check_json(scratch(undef, $json->{automaton} // ''));
        $wrong++, diag($text) if !$check->{valid} || grep { !$_->{exact} } @{ $check->{equations} };
    }
    is($wrong, 0, 'random corner cutting with random entries open: proved, and the original is a member');
}

# ---- The classes of [IM] 4.3 ---------------------------------------------------------------------------------

# (N, Δ, m_s), all entries of T_÷ open. Case 1: T^s keeps m_s (m_s - 1), the N - 1 joints between children (m_a - 1) m_s
# each, the N blocks between joints (m_a - 1)(Δ - m_s) each. Case 2: T^s and the one block of NΔ - m_s columns between.
# Case 3: NΔ masks; by hand, 4 × 5 has r_0 r_1 and s_0 s_1 s_2, and 5 × 6 two masks of three entries.
my @classes = (
    [ 2, 2, 1, 0 + 2 + 2 * 2 ],
    [ 2, 1, 1, 0 + 1 + 0 ],
    [ 3, 1, 1, 0 + 2 * 1 ],
    [ 3, 2, 2, 2 + 2 * 3 * 2 ],
    [ 2, 3, 2, 2 + 4 * 2 + 2 * 4 ],
    [ 2, 2, 3, 6 + 4 ],
    [ 2, 1, 2, 2 ],
    [ 3, 2, 4, 12 + 5 * 2 ],
    [ 2, 1, 3, 1 + 2 ],
    [ 2, 1, 4, 2 + 2 ],
);
for my $class (@classes) {
    my ($n, $step, $joint, $freedom) = @$class;
    my ($points, $columns) = ($step + $joint, $n * $step + $joint);
    my $json = complete_json(
        scratch(undef, "automaton class\nedge arc { refine $n [ " . text_of(all_open($points, $columns)) . " ] }\n"));
    is($json->{degrees_of_freedom}, $freedom, "($n, $step, $joint): $freedom degrees of freedom");
    is($json->{unknowns}, $points * $columns, "($n, $step, $joint): each entry counts once");
    is_proved($json->{automaton}, "($n, $step, $joint)");
}

# The three refinement matrices that are printed there, with random numbers in them.
sub three_by_five {
    return from_columns([ 1, 0, 0 ], column(0, 3, 0), column(0, 3, 0), column(0, 3, 0), [ 0, 0, 1 ]);
}

sub five_by_seven {
    my @joint = map { column(0, 3, 2) } 1 .. 3;
    return from_columns(@joint, column(0, 5, 0), map { moved($_, 2) } @joint);
}

sub four_by_five {
    my ($r, $s) = (column(0, 2, 2), column(0, 3, 1));
    return from_columns($r, $s, moved($r, 1), moved($s, 1), moved($r, 2));
}

for my $shape ([ '3 x 5', \&three_by_five ], [ '5 x 7', \&five_by_seven ], [ '4 x 5', \&four_by_five ]) {
    my ($name, $make) = @$shape;
    my $wrong = 0;
    for my $round (1 .. 12 * ($ENV{TEST_EFFORT} // 1)) {
        my $matrix = $make->();
        my $share = $round == 1 ? 1 : rand;
        my $open = opened($matrix, sub { rand() < $share });
        next if text_of($open) !~ /\?/;
        my $text = "automaton class\nedge arc { refine 2 [ " . text_of($open) . " ] }\n";
        my $json = complete_json(scratch(undef, $text));
        my $check = check_json(scratch(undef, $json->{automaton} // ''));
        my $good = $json->{status} == 0 && $check->{valid} && is_member($json->{automaton}, $matrix)
            && !grep { !$_->{exact} } @{ $check->{equations} };
        $wrong++, diag($text) if !$good;
    }
    is($wrong, 0, "$name: random members with random entries open");
}

{
    my $json = complete_json(scratch(undef, "automaton m\nedge arc { mask 2 [ ? ? ? ? ? ] }\n"));
    is($json->{degrees_of_freedom}, 3, 'a mask of five: its even and its odd coefficients sum to 1');
    ok(is_member($json->{automaton}, [ [qw(1/8 1/2 3/4 1/2 1/8)] ]), 'the cubic B-spline is a member');
}

# ---- Takagi and Bézier, params -------------------------------------------------------------------------------

my $interpolating = "vertex end 1 { }\nedge arc 3 {\n  start end at 0\n  end end at 2\n";
{
    my $text = "automaton takagi\nparam w = 1/2 in 0..1\n$interpolating"
        . "  sub arc [ ? ? 1/4; ? 1/4+w 1/2; ? 1/8-w/2 ? ]\n  sub arc [ 1/4 1/8-w/2 ?; ? ? ?; 1/4 5/8-w/2 ? ]\n}\n";
    my $json = complete_json(scratch('takagi.bcifs', $text));
    is($json->{degrees_of_freedom}, 0, 'the Takagi family is determined');
    like($json->{automaton}, qr/^param w = 1\/2 in 0\.\.1$/m, 'and keeps its param');
    is_proved($json->{automaton}, 'for all w');
    for my $w ('1/2', '1/4', '7/5') {
        my @expected = map { [ map { [ map { value_of($_, { w => $w }) } split ' ' ] } split /; / ] }
            '1 5/8-w/2 1/4; 0 1/4+w 1/2; 0 1/8-w/2 1/4', '1/4 1/8-w/2 0; 1/2 1/4+w 0; 1/4 5/8-w/2 1';
        my @found = map { [ map { [ map { value_of($_, { w => $w }) } @$_ ] } @$_ ] } matrices_of($json->{automaton});
        is_deeply([ map { map { map { "$_" } @$_ } @$_ } @found ], [ map { map { map { "$_" } @$_ } @$_ } @expected ],
            "w = $w");
    }
    my $set = complete_json(scratch(undef, $text), '--set', 'w=1/4');
    like($set->{automaton}, qr/^let w = 1\/4$/m, 'a param that was set is fixed in the answer');
    is_proved($set->{automaton}, 'w = 1/4');

    (my $square = $text) =~ s/1\/4\+w/w*w/;
    $json = complete_json(scratch(undef, $square));
    like($json->{automaton}, qr/^let w = 1\/2$/m, 'a param that entries are not linear in is fixed, too');
    is_proved($json->{automaton}, 'its value');
}

{
    # Quadratic Bézier: the middle control points of the halves are mid-points, [1 1/2 1/4; 0 1/2 1/2; 0 0 1/4].
    my $text = "automaton bezier\n$interpolating  sub arc [ ? ? ?; ? ? ?; ? ? ? ]\n  sub arc [ ? ? ?; ? ? ?; ? ? ? ]\n}\n";
    my $json = complete_json(scratch(undef, $text));
    is($json->{degrees_of_freedom}, 6, 'arcs of three points that share one: three free columns');
    ok(is_member($json->{automaton}, [ [ 1, '1/2', '1/4' ], [ 0, '1/2', '1/2' ], [ 0, 0, '1/4' ] ],
            [ [ '1/4', 0, 0 ], [ '1/2', '1/2', 0 ], [ '1/4', '1/2', 1 ] ]), 'Bézier is a member');
    is_proved($json->{automaton}, 'the family');
}

# ---- Several states, arguments, faces, affine maps -----------------------------------------------------------

{
    my $text = <<'END';
automaton nonuniform
let f(u,v) = u/(2*(u+v))
let g(u,v) = v/(2*(u+v))
vertex k(u,v) 2 { sub k(u,v) [ 1-f(u,v) g(u,v); f(u,v) 1-g(u,v) ] }
vertex joint 2 { sub joint [ ? ?; ? ? ] }
edge left(u,v) 3 {
  start k(u,v) at 0 1
  end joint at 1 2
  sub left(u,v) [ 1-f(u,v) g(u,v) 0; f(u,v) 1-g(u,v) ?; 0 0 ? ]
  sub uniform [ g(u,v) ? 0; 1-g(u,v) ? ?; 0 ? ? ]
}
edge uniform 3 {
  start joint at 0 1
  end joint at 1 2
  sub uniform [ ? ? ?; ? ? ?; ? ? ? ]
  sub uniform [ ? ? ?; ? ? ?; ? ? ? ]
}
END
    my $json = complete_json(scratch(undef, $text));
    is($json->{degrees_of_freedom}, 2, 'states with arguments: the uniform part is corner cutting');
    is_proved($json->{automaton}, 'for all arguments');
    like($json->{automaton}, qr/sub uniform \[ g\(u,v\) 0 0; 1-g\(u,v\) 1-a b; 0 a 1-b \]/,
        'and joins the other part');
    (my $bad = $text) =~ s/1-f\(u,v\) g\(u,v\) 0/1-f(u,v) ? 0/;
    my ($status, $out, $err) = bcifs([ 'complete', scratch(undef, $bad) ]);
    ok($status == 2 && $err =~ /'left': .* depends on the state's arguments/,
        'an entry that must depend on arguments is refused in words');
}

{
    my $face = <<'END';
automaton triangle
vertex corner 1 { }
edge side 2 {
  start corner at 0
  end corner at 1
  sub side [ 1 1/2; 0 1/2 ]
  sub side [ 1/2 0; 1/2 1 ]
}
face t 3 {
  boundary ab = side at 0 1
  boundary bc = side at 1 2
  boundary ca = side at 2 0
  sub t [ 1 1/2 1/2; 0 1/2 0; 0 0 1/2 ]
  sub t [ 1/2 0 0; 1/2 1 1/2; 0 0 1/2 ]
  sub t [ 1/2 0 0; 0 1/2 0; 1/2 1/2 1 ]
  sub t [ ? ? ?; ? ? ?; ? ? ? ]
  join 0.bc = 3.bc
  join 2.ab = 3.ca reversed
}
END
    # 3.bc: columns 1 and 2 are (1/2, 1/2, 0) and (1/2, 0, 1/2). 2.ab is (1/2, 0, 1/2), (0, 1/2, 1/2), reversed the
    # columns 2 and 0 of child 3 would be (0, 1/2, 1/2) and (1/2, 0, 1/2): column 2 contradicts.
    my $json = complete_json(scratch(undef, $face));
    is($json->{status}, 1, 'a face with joins that contradict');
    is_deeply([ map { $_->{equation} } @{ $json->{conflicts} } ], [ 'T0·bc = T3·bc', 'T2·ab = T3·ca reversed' ],
        'which are named');
    $face =~ s/\n  join 2.*//;
    $json = complete_json(scratch(undef, $face));
    is($json->{degrees_of_freedom}, 2, 'one join leaves a free column');
    is_proved($json->{automaton}, 'the face');
    ok(is_member($json->{automaton}, [ [ 1, '1/2' ], [ 0, '1/2' ] ], [ [ '1/2', 0 ], [ '1/2', 1 ] ],
            [ [ 1, '1/2', '1/2' ], [ 0, '1/2', 0 ], [ 0, 0, '1/2' ] ],
            [ [ '1/2', 0, 0 ], [ '1/2', 1, '1/2' ], [ 0, 0, '1/2' ] ],
            [ [ '1/2', 0, 0 ], [ 0, '1/2', 0 ], [ '1/2', '1/2', 1 ] ],
            [ [ 0, '1/2', '1/2' ], [ '1/2', '1/2', 0 ], [ '1/2', 0, '1/2' ] ]), 'the middle triangle is a member');
    $face =~ s/\n  join 0.*//;
    $face =~ s/sub t \[ 1 .*?\]/sub t [ ? ? ?; ? ? ?; ? ? ? ]/;
    my ($status, $out, $err) = bcifs([ 'complete', scratch(undef, $face) ]);
    ok($status == 2 && $err =~ /could carry a part of the boundary/, 'an undetermined gluing is refused in words');
}

{
    my $json = complete_json(scratch(undef, "automaton fern\ncell leaf affine 2 {\n  sub leaf [ 1/2 0 ?; 0 ? 0 ]\n"
                . "  sub leaf [ ? 0 1; 0 1/2 0 ]\n}\n"));
    is($json->{degrees_of_freedom}, 3, 'affine maps are barycentric whatever their entries');
    is_proved($json->{automaton}, 'affine');
    # Ends at the frame's points O and X: T0 keeps O, T1 keeps X, and T0 X = T1 O is one free point of the plane; the
    # images of Y are two more.
    $json = complete_json(scratch(undef, "automaton dragon\nvertex v 1 { }\nedge arc affine 2 {\n  start v at 0\n"
                . "  end v at 1\n  sub arc [ ? ? ?; ? ? ? ]\n  sub arc [ ? ? ?; ? ? ? ]\n}\n"));
    is($json->{degrees_of_freedom}, 6, 'an affine edge');
    is_proved($json->{automaton}, 'the affine edge');
}

# ---- No answer -----------------------------------------------------------------------------------------------

sub opened_quadratic {
    my (%known) = @_;
    my @matrices = (all_open(2, 2), all_open(3, 3), all_open(3, 3));
    for my $place (keys %known) {
        my ($matrix, $row, $column) = split /,/, $place;
        $matrices[$matrix][$row][$column] = $known{$place};
    }
    return quadratic(@matrices);
}

{
    # T^s_00 stands in T0 at (0, 0) and in T1 at (1, 1).
    my $file = scratch('conflict.bcifs', opened_quadratic('1,0,0' => '1/2', '2,1,1' => '1/3'));
    my $json = complete_json($file);
    is($json->{status}, 1, 'contradicting entries: exit status 1');
    ok(!$json->{consistent} && !defined $json->{automaton}, 'inconsistent, no automaton');
    is_deeply([ map {"$_->{equation} $_->{row} $_->{column}"} @{ $json->{conflicts} } ],
        [ 'T0·start = start·T(joint) 0 0', 'T1·end = end·T(joint) 1 0' ], 'exactly the two equations that contradict');
    like($json->{contradiction}, qr/^0 = -?1\/6$/, 'their difference is 1/2 - 1/3');
    my ($status, $out, $err) = map { decode_utf8($_) } bcifs([ 'complete', $file ]);
    ok($status == 1 && $out eq '' && $err =~ /0 = -?1\/6/ && $err =~ /T0·start = start·T\(joint\), entry \(0, 0\)/,
        'the same in words, nothing on standard output');
    ($status, $out, $err) = bcifs([ 'complete', $file, '--quiet' ]);
    ok($status == 1 && $out eq '' && $err eq '', '--quiet');

    # The same two values around the long way: T0_00 = T^s_00, T^s_00 + T^s_10 = 1, T1_21 = T^s_10. (Or the column of T1
    # sums to 1, and T1_01 = 0, T1_11 = T^s_00.)
    $json = complete_json(scratch(undef, opened_quadratic('1,0,0' => '1/2', '2,2,1' => '1/3')));
    my $count = @{ $json->{conflicts} };
    ok($count == 3 || $count == 4, 'a contradiction of three or four equations');
    like($json->{contradiction}, qr/^0 = -?1\/6$/, '1/2 + 1/3 - 1');

    $json = complete_json(scratch(undef, opened_quadratic('1,0,0' => '1/2', '1,1,0' => '1/2', '1,2,0' => '1/2')));
    my ($only) = @{ $json->{conflicts} };
    ok(@{ $json->{conflicts} } == 1 && $only->{equation} eq '1·T0 = 1' && $json->{contradiction} =~ /^0 = -?1\/2$/,
        'a known column that does not sum to 1');

    my $states = "automaton s\nvertex u 1 { }\nvertex v 1 { }\nedge arc 2 {\n  start u at 0\n  end v at 1\n"
        . "  sub arc [ ? ?; ? ? ]\n  sub arc [ ? ?; ? ? ]\n}\n";
    $json = complete_json(scratch(undef, $states));
    ok($json->{status} == 1 && $json->{conflicts}[0]{equation} eq 'T0·end = T1·start'
            && $json->{conflicts}[0]{reason}, 'states that do not meet are a reason in words');

    my $free = "automaton p\nparam w = 1/2\n$interpolating  sub arc [ w ? ?; ? ? ?; ? ? ? ]\n"
        . "  sub arc [ ? ? ?; ? ? ?; ? ? ? ]\n}\n";
    $json = complete_json(scratch(undef, $free));
    ok($json->{status} == 1 && $json->{contradiction} =~ /^0 = (?:w-1|1-w)$/, 'what would fix a param contradicts');
    $json = complete_json(scratch(undef, $free), '--set', 'w=1');
    is($json->{status}, 0, 'and is no contradiction when it is set to that');
}

{
    my ($status, $out, $err) = bcifs([ 'complete', "$ROOT/automata/chaikin.bcifs", '--json' ]);
    my $json = JSON::PP->new->utf8->decode($out);
    ok($status == 0 && $json->{unknowns} == 0 && $json->{consistent} && $json->{degrees_of_freedom} == 0,
        'without ? and valid');
    my $bad = scratch(undef, quadratic(map { opened($_, sub {0}) } (cutting('1/4', '1/4'))[ 0, 1, 1 ]));
    my ($check_status, $check_out) = bcifs([ 'check', $bad ]);
    ($status, $out) = bcifs([ 'complete', $bad ]);
    ok($status == 1 && $check_status == 1 && $out eq $check_out, 'without ? and not valid: as check');
}

sub refused {
    my ($text, $words, $what, @files) = @_;
    my ($status, $out, $err) = bcifs([ 'complete', scratch(undef, $text) ]);
    return ok($status == 2 && $out eq '' && $err =~ $words, "$what is refused") || diag("$status\n$out$err");
}

refused(opened_quadratic('1,0,0' => 'sqrt(2)'), qr/known entry 1\.41421356\d+ is known as a rounded number/, 'a root');
refused(opened_quadratic('1,0,0' => '0.123456789012345'), qr/rounded number/, 'a decimal of 15 digits');
refused(opened_quadratic('1,0,0' => '12345678901/98765432101'), qr/known entry 0\.1249\d+ is a fraction too large/,
    'a fraction that is not recovered');
refused("automaton b\nvertex v 1 { }\nedge arc 2 {\n  start v [ ?; ? ]\n  end v at 1\n  sub arc [ 1 ?; 0 ? ]\n  sub arc [ ? 0; ? 1 ]\n}\n",
    qr/boundary must be known/, 'an open boundary');
refused(quadratic(cutting('1/4', '1/4')) . "figure f {\n  open arc\n  points [ 0 0; ? 1; 1 0 ]\n}\n",
    qr/'\?'/, 'an open control point');
refused("automaton n\nedge arc { refine 2 [ " . text_of(all_open(64, 65)) . " ] }\n", qr/4160 entries.*limit is 4096/,
    'more than 4096 unknowns');
{
    my $used = scratch('used.bcifs', opened_quadratic());
    refused("automaton u\nuse \"used.bcifs\"\nedge e { mask 2 [ 1/2 1 1/2 ] }\n", qr/complete it on its own/,
        '? in another file');
}
{
    # T0 start = start: with start (p, 1-p) fractions of 2^40 the solution needs products of them.
    my $big = "automaton big\nvertex v 1 { }\nedge arc 2 {\n  start v [ 1/1000003; 1000002/1000003 ]\n"
        . "  end v [ 1000032/1000033; 1/1000033 ]\n"
        . join('', map {"  sub arc [ ? ?; ? ? ]\n"} 1 .. 6) . "}\n";
    my ($status, $out, $err) = bcifs([ 'complete', scratch(undef, $big) ]);
    ok($status == 0 || ($status == 2 && $err =~ /do not fit in 64 bits|too large for 64-bit/),
        'large fractions are solved exactly or refused');
    is_proved($out, 'large fractions') if $status == 0;
}

# ---- The text ------------------------------------------------------------------------------------------------

{
    my $text = <<'END';
# A comment first.
automaton a "title"  # behind the header
param b = 1/3  # a param of the file

vertex joint 2 { sub joint [ ? ?; ? ? ] }
edge arc 3 {
  start joint at 0 1  # where it begins
  end joint at 1 2
  sub arc [ ? ? ?  # first row
            ? ? ?
            ? ? ? ]
  sub arc [ ? ? ?; ? ? ?; ? ? ? ]
}
let c = b
figure d { open arc points [ 0 0; b 1; 1 0 ] }
# and last
END
    my $file = scratch('text.bcifs', $text);
    my $answer = scratch('answer.bcifs');
    my ($status) = bcifs([ 'complete', $file, '-o', $answer ]);
    is($status, 0, '-o');
    my $out = file_text($answer);
    is(join('', sort $out =~ /# (?!Degrees).*/g), join('', sort $text =~ /# .*/g), 'every comment is kept');
    like($out, qr/^param e = \S+$/m, 'names in use are skipped: a, b, c and d are taken');
    like($out, qr/^param b = 1\/3/m, 'params of the file stay');
    is_proved($out, 'the text');
    my ($same, $first) = bcifs([ 'complete', $file ]);
    is($first, $out, 'the same every time');
    ($status, $first) = bcifs([ 'complete', '-' ], stdin => $text);
    is($first, $out, 'from standard input');
}

done_testing;
