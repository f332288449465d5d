# A second reading of automaton files, for tests only: a part of the language (cells with matrices, refine, mask,
# affine; params; lets; no rules, no faces) and the equations of the model, in fractions or in doubles. It is
# written from the definitions and shares nothing with the engine.
package Model;

use strict;
use warnings;
use Fraction;

# ---- Reading ---------------------------------------------------------------------------------------------------

# An expression as a perl function of a number maker and a hash of values.
sub compile {
    my ($text, $model) = @_;
    my $code = '';
    for ($text) {
        while ((pos // 0) < length) {
            /\G\s+/gc and next;
            /\G(\d+\.\d+|\.\d+|\d+)/gc and $code .= "\$n->('$1')", next;
            /\G([A-Za-z_]\w*)\(/gc and $code .= "\$call->('$1', \$n, \$v, ", next;
            /\G([A-Za-z_]\w*)/gc and $code .= "\$name->('$1', \$n, \$v)", next;
            /\G([-+*\/(),])/gc and $code .= $1, next;
            last if /\G$/gc;
            die "cannot read '$text'";
        }
    }
    my $name = sub {
        my ($name, $n, $v) = @_;
        return $v->{$name} if exists $v->{$name};
        return $model->{lets}{$name}{code}->($n, $v) if $model->{lets}{$name};
        die "no name '$name'";
    };
    my $call = sub {
        my ($name, $n, $v, @arguments) = @_;
        my $let = $model->{lets}{$name} or die "no function '$name'";
        my %inner = map { $_->[0] => $v->{ $_->[0] } } @{ $model->{parameters} };
        @inner{ @{ $let->{arguments} } } = @arguments;
        return $let->{code}->($n, \%inner);
    };
    my $function = eval "sub { my (\$n, \$v) = \@_; $code }" or die "$text: $code: $@";
    return $function;
}

# Entries of a matrix: rows of { text, at (offset in the file), code }.
sub matrix {
    my ($model, $text, $offset) = @_;
    my @rows = ([]);
    for ($text) {
        pos = 0;
        while (pos() < length) {
            /\G[ \t]+/gc and next;
            /\G[;\n]/gc and do { push @rows, [] if @{ $rows[-1] }; next };
            my $at = pos;
            my $depth = 0;
            while (/\G(.)/gcs) {
                $depth++ if $1 eq '(';
                $depth-- if $1 eq ')';
                pos() -= 1, last if $depth == 0 && $1 =~ /[\s;]/;
            }
            my $entry = substr $text, $at, pos() - $at;
            push @{ $rows[-1] }, { text => $entry, at => $offset + $at, code => compile($entry, $model) };
        }
    }
    pop @rows if !@{ $rows[-1] };
    return \@rows;
}

sub reference {
    my ($model, $name, $arguments) = @_;
    my @arguments = map { compile($_, $model) } defined $arguments ? split /,/, $arguments : ();
    return { name => $name, arguments => \@arguments };
}

sub skip_block {
    my ($text) = @_; # a reference; pos stands behind the "{"
    my $depth = 1;
    while ($depth && $$text =~ /\G[^{}]*([{}])/gc) { $depth += $1 eq '{' ? 1 : -1 }
}

# Reads the text of a file, or returns undef where it uses what this reader does not know.
sub new {
    my ($class, $file) = @_;
    my $text = $file;
    $text =~ s/(#.*)/' ' x length $1/ge;
    my $model = bless { cells => {}, order => [], parameters => [], lets => {}, text => $file }, $class;
    my $arguments = qr/(?:\(([\w, ]*)\))?/;
    for ($text) {
        pos = 0;
        while (!/\G\s*\z/gc) {
            if (/\G\s*automaton\s+\w+\s*("[^"]*")?/gc) {
            } elsif (/\G\s*param\s+(\w+)\s*=\s*(.*?)(?:\s+in\s.*)?$/gcm) {
                push @{ $model->{parameters} }, [ $1, compile($2, $model) ];
            } elsif (/\G\s*let\s+(\w+)$arguments\s*=\s*(.*)$/gcm) {
                $model->{lets}{$1} = { arguments => [ split /,/, $2 // '' ], code => compile($3, $model) };
            } elsif (/\G\s*(?:figure|wavelet)\s[^{]*\{/gc) {
                skip_block(\$text);
            } elsif (/\G\s*(vertex|edge|cell)\s+(\w+)$arguments\s*(\d*)(?:affine\s+(\d+))?\s*\{/gc) {
                my $cell = { kind => $1, name => $2, arguments => [ split /\s*,\s*/, $3 // '' ],
                             points => $4, affine => $5, subs => [] };
                $model->{cells}{$2} = $cell;
                push @{ $model->{order} }, $2;
                my $target = qr/([\w.]+)(?:\(([^()]*)\))?/;
                while (!/\G\s*\}/gc) {
                    if (/\G\s*(start|end)\s+$target\s+at((?:\s+\d+)+)/gc) {
                        $cell->{$1} = { state => reference($model, $2, $3), at => [ split ' ', $4 ] };
                    } elsif (/\G\s*sub\s+$target\s*\[/gc) {
                        my ($name, $list) = ($1, $2);
                        my $from = pos;
                        /\G([^\]]*)\]/gc;
                        push @{ $cell->{subs} },
                            { state => reference($model, $name, $list), matrix => matrix($model, $1, $from) };
                    } elsif (/\G\s*(refine|mask)\s+(\d+)\s*\[/gc) {
                        my ($kind, $n) = ($1, $2);
                        my $from = pos;
                        /\G([^\]]*)\]/gc;
                        $cell->{$kind} = { n => $n, matrix => matrix($model, $1, $from) };
                    } else {
                        return undef;
                    }
                }
            } else {
                return undef;
            }
        }
    }
    return $model;
}

# All matrices of maps: lists of { cell, matrix }.
sub matrices {
    my ($model) = @_;
    my @list;
    for my $name (@{ $model->{order} }) {
        my $cell = $model->{cells}{$name};
        push @list, map { { cell => $name, affine => $cell->{affine}, matrix => $_->{matrix} } }
            @{ $cell->{subs} }, grep { $_ } @$cell{qw(refine mask)};
    }
    return @list;
}

# ---- Numbers ---------------------------------------------------------------------------------------------------

sub fraction_maker { return sub { Fraction->new($_[0]) } }
sub double_maker { return sub { 0 + $_[0] } }

# Values of the params: their own.
sub defaults {
    my ($model, $n) = @_;
    my %values;
    $values{ $_->[0] } = $_->[1]->($n, \%values) for @{ $model->{parameters} };
    return \%values;
}

sub multiply {
    my ($a, $b, $zero) = @_;
    my @c;
    for my $row (@$a) {
        my @sums = ($zero) x @{ $b->[0] };
        for my $k (0 .. $#$row) {
            next if $row->[$k] == 0;
            $b->[$k][$_] != 0 and $sums[$_] = $sums[$_] + $row->[$k] * $b->[$k][$_] for 0 .. $#sums;
        }
        push @c, \@sums;
    }
    return \@c;
}

# ---- States ----------------------------------------------------------------------------------------------------

# T_÷ of an edge by refine or mask, as numbers, with N, m_a and m_s.
sub refinement {
    my ($cell, $n, $v) = @_;
    my $part = $cell->{refine} // $cell->{mask};
    my @rows = map { [ map { $_->{code}->($n, $v) } @$_ ] } @{ $part->{matrix} };
    my $count = $part->{n};
    if ($cell->{refine}) {
        my $m = @rows;
        my $joint = ($count * $m - @{ $rows[0] }) / ($count - 1);
        return (\@rows, $count, $m, $joint);
    }
    # m_a = ceil((l - 1)/(N - 1)), T_i[j][j'] = c[i + N(m_a-1-j) - (m_a-1-j')]; column i + j' of T_÷ is
    # column j' of T_i, so it depends on i + j' only.
    my @c = @{ $rows[0] };
    my $m = int((@c - 1 + $count - 2) / ($count - 1));
    my @whole;
    for my $j (0 .. $m - 1) {
        for my $k (0 .. $count + $m - 2) {
            my $index = $k + $count * ($m - 1 - $j) - ($m - 1);
            $whole[$j][$k] = $index >= 0 && $index < @c ? $c[$index] : $n->('0');
        }
    }
    return (\@whole, $count, $m, $m - 1);
}

sub selection {
    my ($n, $rows, @indices) = @_;
    my @matrix = map { my $i = $_; [ map { $n->($_ == $i ? '1' : '0') } @indices ] } 0 .. $rows - 1;
    return \@matrix;
}

# A state with the values of its arguments: { points, children: [{ key, map }], boundaries: { start, end } }.
sub state {
    my ($model, $n, $v, $name, @arguments) = @_;
    my %values = (map { $_->[0] => $v->{ $_->[0] } } @{ $model->{parameters} });
    if ($name =~ /^(.*)\.joint$/) {
        my $edge = $model->{cells}{$1};
        @values{ @{ $edge->{arguments} } } = @arguments;
        my ($whole, undef, undef, $joint) = refinement($edge, $n, \%values);
        my @map = map { [ @{ $whole->[$_] }[ 0 .. $joint - 1 ] ] } 0 .. $joint - 1;
        return { kind => 'vertex', points => $joint, boundaries => {},
                 children => [ { key => [ $name, @arguments ], map => \@map } ] };
    }
    my $cell = $model->{cells}{$name} or die "no state '$name'";
    @values{ @{ $cell->{arguments} } } = @arguments;
    my $key = sub { [ $_[0]{name}, map { $_->($n, \%values) } @{ $_[0]{arguments} } ] };
    my $state = { kind => $cell->{kind}, children => [], boundaries => {} };
    if ($cell->{refine} || $cell->{mask}) {
        my ($whole, $count, $m, $joint) = refinement($cell, $n, \%values);
        my $step = $m - $joint;
        $state->{points} = $m;
        for my $i (0 .. $count - 1) {
            my @map = map { [ @$_[ $i * $step .. $i * $step + $m - 1 ] ] } @$whole;
            push @{ $state->{children} }, { key => [ $name, @arguments ], map => \@map };
        }
        my %at = (start => [ 0 .. $joint - 1 ], end => [ $step .. $m - 1 ]);
        $state->{boundaries}{$_} = { key => [ "$name.joint", @arguments ], operator => selection($n, $m, @{ $at{$_} }) }
            for keys %at;
        return $state;
    }
    for my $sub (@{ $cell->{subs} }) {
        my @map = map { [ map { $_->{code}->($n, \%values) } @$_ ] } @{ $sub->{matrix} };
        if ($cell->{affine}) { # columns: the images b, A e_1 + b, …
            my $d = $cell->{affine};
            my @points = ([ map { $_->[$d] } @map ], map { my $j = $_; [ map { $_->[$j] + $_->[$d] } @map ] } 0 .. $d - 1);
            @map = ([ map { my $rest = $n->('1'); $rest = $rest - $_ for @$_; $rest } @points ],
                    map { my $i = $_; [ map { $_->[$i] } @points ] } 0 .. $d - 1);
        }
        push @{ $state->{children} }, { key => $key->($sub->{state}), map => \@map };
    }
    $state->{points} = $cell->{affine} ? $cell->{affine} + 1 : $cell->{points} ne '' ? $cell->{points}
        : scalar @{ $state->{children}[0]{map} };
    push @{ $state->{children} }, { key => [ $name, @arguments ], map => [ [ $n->('1') ] ] }
        if $cell->{kind} eq 'vertex' && !@{ $state->{children} };
    for my $side (grep { $cell->{$_} } qw(start end)) {
        $state->{boundaries}{$side} = { key => $key->($cell->{$side}{state}),
            operator => selection($n, $state->{points}, @{ $cell->{$side}{at} }) };
    }
    return $state;
}

# Names of all states, and the arguments they take.
sub state_names {
    my ($model) = @_;
    return map { my $cell = $model->{cells}{$_}; ($_, $cell->{refine} || $cell->{mask} ? "$_.joint" : ()) }
        @{ $model->{order} };
}

sub arguments_of {
    my ($model, $name) = @_;
    $name =~ s/\.joint$//;
    return @{ $model->{cells}{$name}{arguments} };
}

# ---- Equations -------------------------------------------------------------------------------------------------

sub same_key {
    my ($a, $b) = @_;
    return 0 if $a->[0] ne $b->[0];
    for (1 .. $#$a) { return 0 if abs($a->[$_] - $b->[$_]) > (ref $a->[$_] ? 0 : 1e-9) }
    return 1;
}

# The equations of a state: { "kind|text" => [left, right], or a string where the two sides have different states }.
sub equations {
    my ($model, $n, $v, $name, @arguments) = @_;
    my $zero = $n->('0');
    my $state = $model->state($n, $v, $name, @arguments);
    my @children = @{ $state->{children} };
    my %found;
    my $sums = sub {
        my ($matrix) = @_;
        my @sums = ($zero) x @{ $matrix->[0] };
        for my $row (@$matrix) { $sums[$_] = $sums[$_] + $row->[$_] for 0 .. $#sums }
        return [ [ \@sums ], [ [ ($n->('1')) x @sums ] ] ];
    };
    for my $i (0 .. $#children) {
        my $symbol = $state->{kind} eq 'vertex' ? 'T' : "T$i";
        $found{"barycentric|1\x{b7}$symbol = 1"} = $sums->($children[$i]{map});
    }
    $found{"barycentric|1\x{b7}$_ = 1"} = $sums->($state->{boundaries}{$_}{operator}) for keys %{ $state->{boundaries} };
    return \%found if $state->{kind} ne 'edge';
    my @states = map { $model->state($n, $v, @{ $_->{key} }) } @children;
    for my $side ('start', 'end') {
        my $i = $side eq 'start' ? 0 : $#children;
        my $boundary = $state->{boundaries}{$side};
        my $vertex = $model->state($n, $v, @{ $boundary->{key} });
        my $inner = $states[$i]{boundaries}{$side};
        my $text = "incidence|T$i\x{b7}$side = $side\x{b7}T($boundary->{key}[0])";
        $found{$text} = same_key($inner->{key}, $vertex->{children}[0]{key})
            ? [ multiply($children[$i]{map}, $inner->{operator}, $zero),
                multiply($boundary->{operator}, $vertex->{children}[0]{map}, $zero) ]
            : 'states';
    }
    for my $i (0 .. $#children - 1) {
        my ($end, $start) = ($states[$i]{boundaries}{end}, $states[ $i + 1 ]{boundaries}{start});
        $found{ "adjacency|T$i\x{b7}end = T" . ($i + 1) . "\x{b7}start" } = same_key($end->{key}, $start->{key})
            ? [ multiply($children[$i]{map}, $end->{operator}, $zero),
                multiply($children[ $i + 1 ]{map}, $start->{operator}, $zero) ]
            : 'states';
    }
    return \%found;
}

# Whether both sides agree entry by entry.
sub agree {
    my ($sides) = @_;
    return 0 if !ref $sides;
    my ($left, $right) = @$sides;
    for my $i (0 .. $#$left) {
        $left->[$i][$_] == $right->[$i][$_] or return 0 for 0 .. $#{ $left->[$i] };
    }
    return 1;
}

1;
