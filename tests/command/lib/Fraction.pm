# Exact fractions on machine integers; a result that does not fit is refused, never rounded.
package Fraction;

use strict;
use warnings;
use overload
    '+'   => sub { my ($a, $b) = pair(@_); fraction($a->[0] * $b->[1] + $b->[0] * $a->[1], $a->[1] * $b->[1]) },
    '-'   => sub { my ($a, $b) = pair(@_); fraction($a->[0] * $b->[1] - $b->[0] * $a->[1], $a->[1] * $b->[1]) },
    '*'   => sub { my ($a, $b) = pair(@_); fraction($a->[0] * $b->[0], $a->[1] * $b->[1]) },
    '/'   => sub { my ($a, $b) = pair(@_); fraction($a->[0] * $b->[1], $a->[1] * $b->[0]) },
    'neg' => sub { fraction(-$_[0][0], $_[0][1]) },
    '=='  => sub { my ($a, $b) = pair(@_); $a->[0] == $b->[0] && $a->[1] == $b->[1] },
    '!='  => sub { my ($a, $b) = pair(@_); $a->[0] != $b->[0] || $a->[1] != $b->[1] },
    '<=>' => sub { my ($a, $b) = pair(@_); $a->[0] * $b->[1] <=> $b->[0] * $a->[1] },
    'abs' => sub { fraction(abs $_[0][0], $_[0][1]) },
    '0+'  => sub { $_[0][0] / $_[0][1] },
    '""'  => sub { $_[0][1] == 1 ? "$_[0][0]" : "$_[0][0]/$_[0][1]" },
    'bool' => sub { $_[0][0] != 0 },
    '='   => sub { bless [ @{ $_[0] } ], 'Fraction' };

sub pair {
    my ($a, $b, $swapped) = @_;
    $b = fraction($b, 1) if !ref $b;
    return $swapped ? ($b, $a) : ($a, $b);
}

sub fraction {
    my ($top, $bottom) = @_;
    die "division by zero\n" if $bottom == 0;
    ($top, $bottom) = (-$top, -$bottom) if $bottom < 0;
    my ($a, $b) = (abs $top, $bottom);
    ($a, $b) = ($b, $a % $b) while $b;
    die "the fraction $top/$bottom does not fit\n" if abs($top) > 2**60 || $bottom > 2**60;
    return bless [ $top / $a, $bottom / $a ], 'Fraction';
}

# From a literal: 3, 0.25, or from 3/4.
sub new {
    my ($class, $text) = @_;
    return fraction($1, $2) if $text =~ m{^(-?\d+)/(\d+)$};
    return fraction($1 . $2, 10**length $2) if $text =~ /^(-?\d*)\.(\d+)$/;
    return fraction($text, 1);
}

1;
