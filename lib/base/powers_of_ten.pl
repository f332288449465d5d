#!/usr/bin/perl
# Prints powers_of_ten.inc, the tables of decimal.c, and checks what decimal.c takes for granted about them.
#
#     perl powers_of_ten.pl > powers_of_ten.inc
#
# The first table holds every 28th power of ten, rounded up to 128 bits, the second 5^0 to 5^27, which fit 64
# bits. Any power of ten in range is the product of one entry of each, up to a power of two. Takes seconds.
use strict;
use warnings;
use Math::BigInt;

# Reading asks for 10^-342 (19 digits, times that, may still be more than half the smallest double) to 10^308;
# printing for 10^-292 to 10^324. 28 is the longest stride whose powers of five fit 64 bits.
my ($smallest, $largest, $stride) = (-342, 324, 28);
my $bases = int(($largest - $smallest) / $stride) + 1;

sub power { return Math::BigInt->new($_[0])->bpow($_[1]) }

# Bits of a positive integer.
sub width { return length($_[0]->as_bin) - 2 }

# 10^k as a fraction of two integers.
sub fraction
{
    my ($k) = @_;
    return $k < 0 ? (Math::BigInt->bone, power(10, -$k)) : (power(10, $k), Math::BigInt->bone);
}

# (floor, remainder, divisor, s) of 10^k · 2^s, with s such that the floor has 128 bits.
sub scaled
{
    my ($above, $below) = fraction($_[0]);
    my $shift = 128 - width($above) + width($below);
    for my $s ($shift, $shift - 1, $shift + 1) {
        my $divisor = $s < 0 ? $below * power(2, -$s) : $below;
        my ($floor, $rest) = ($s < 0 ? $above->copy : $above * power(2, $s))->bdiv($divisor);
        return ($floor, $rest, $divisor, $s) if width($floor) == 128;
    }
    die "10^$_[0] cannot be scaled";
}

# What power_of_ten() in decimal.c makes of the two entries.
sub rebuilt
{
    my ($base, $five) = @_;
    my $product = $base * $five;
    return $product->brsft(width($product) - 128) + 1;
}

# Claim 1: the formulas for floor(log2(10^k)), floor(log10(2^q)) and floor(log10(3/4 · 2^q)) are right.
sub binary_exponent
{
    use integer; # >> rounds down
    return ($_[0] * 1741647) >> 19;
}

sub decimal_exponent
{
    use integer;
    my ($q, $narrow) = @_;
    return ($q * 1262611 - $narrow * 524031) >> 22;
}

sub check_decimal_exponent
{
    my ($q, $narrow, $k) = @_;
    my ($above, $below) = fraction(-$k);
    $q < 0 ? ($below *= power(2, -$q)) : ($above *= power(2, $q));
    $narrow ? ($above *= 3, $below *= 4) : ();
    die "2^$q has another logarithm" if $above < $below || $above >= 10 * $below;
}

# Claim 2: a rebuilt power lies above the true one by less than 3 in its last place, and adding 1 never carries
# out of the lower word.
sub check_power
{
    my ($k, $rebuilt) = @_;
    my ($floor, $rest, $divisor, $shift) = scaled($k);
    my $above = ($rebuilt - $floor) * $divisor - $rest;
    die "10^$k is rebuilt badly" if $above <= 0 || $above >= 3 * $divisor;
    die "10^$k carries" if $rebuilt % power(2, 64) == 0;
    die "10^$k has another logarithm" if binary_exponent($k) != 127 - $shift;
}

# Claim 3: with q the exponent of a double and k as in shortest(), the products n · 2^q · 10^-k that it needs,
# n <= 2^55 + 2, are integers or at least 3 · 2^-68 away from one. Returns the smallest such distance as a
# fraction; it is found at a denominator of the continued fraction of 2^q · 10^-k.
sub distance
{
    my ($q, $k) = @_;
    my ($above, $below) = fraction(-$k);
    $q < 0 ? ($below *= power(2, -$q)) : ($above *= power(2, $q));
    my ($divisor, $limit) = ($below->copy, power(2, 55) + 2);
    my ($older, $newer) = (Math::BigInt->bzero, Math::BigInt->bone);
    my ($dividend, $rest) = ($below->copy, $above % $below);
    while (!$rest->is_zero) {
        my ($quotient, $next) = $dividend->copy->bdiv($rest);
        my $denominator = $quotient * $newer + $older;
        last if $denominator > $limit || $next->is_zero;
        ($older, $newer, $dividend, $rest) = ($newer, $denominator, $rest, $next);
    }
    return ($rest, $divisor);
}

sub check_distances
{
    for my $q (-1074 .. 971) {
        for my $narrow (0, 1) {
            my $k = decimal_exponent($q, $narrow);
            check_decimal_exponent($q, $narrow, $k);
            my ($rest, $divisor) = distance($q, $k);
            die "2^$q 10^-$k comes too close" if !$rest->is_zero && $rest * power(2, 68) < 3 * $divisor;
        }
    }
}

sub words
{
    my ($high, $low) = (substr(shift->as_hex, 2) =~ /^(.{16})(.{16})$/);
    return "{0x$high, 0x$low}";
}

my @bases = map {
    my ($floor, $rest) = scaled($smallest + $stride * $_);
    $rest->is_zero ? $floor : $floor + 1;
} 0 .. $bases - 1;
my @fives = map { my $five = power(5, $_); $five->blsft(64 - width($five)) } 0 .. $stride - 1;

for my $k ($smallest .. $largest) {
    my ($base, $five) = (int(($k - $smallest) / $stride), ($k - $smallest) % $stride);
    check_power($k, rebuilt($bases[$base], $fives[$five]));
}
check_distances();

print <<"END";
/* Made by powers_of_ten.pl, which says how they combine: every ${stride}th power of ten from 10^$smallest, scaled by a
 * power of two to 128 bits and rounded up; and 5^0 to 5^@{[$stride - 1]}, scaled to 64 bits. */
enum { SMALLEST_POWER = $smallest, STRIDE = $stride };

static const struct wide POWERS_OF_TEN[$bases] = {
END
print "    ", words($_), ",\n" for @bases;
print "};\n\nstatic const uint64_t POWERS_OF_FIVE[STRIDE] = {\n";
print "    ", $_->as_hex, ",\n" for @fives;
print "};\n";
