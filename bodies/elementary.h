/* Elementary functions built from + - x / and square roots alone.
 *
 * The maths library's exp, sin and pow differ in their last bit between C libraries and even between
 * processors with one library (it picks variants with fused multiply-add). A trajectory computed with them would
 * depend on the machine. These do not, they are within about two units of the last place in the ranges
 * stated, and the compiler can evaluate several at once. Whatever a step evaluates uses them; whatever is
 * computed once, when a scene is set up, may use the maths library. */
#ifndef SCREE_BODIES_ELEMENTARY_H
#define SCREE_BODIES_ELEMENTARY_H

#include <math.h>
#include <stdint.h>
#include <string.h>

static inline double scree_bits_to_double(uint64_t bits) {
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline uint64_t scree_double_to_bits(double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* 1.5 x 2^52: adding it to a double rounds that to the nearest integer and leaves the integer in the low bits. */
#define SCREE_ROUNDER 0x1.8p52

/* exp(x): x is cut to [-700, 709], where the result is a normal number, and one still if it is multiplied by a
 * thousandth: what is smaller takes processors a hundred times as long. Cody & Waite 1980 reduction by
 * multiples of ln 2, then the Taylor series, whose first dropped term is below 1e-17. */
static inline double scree_exp(double x) {
    x = x < -700.0 ? -700.0 : x;
    x = x > 709.0 ? 709.0 : x;
    double shifted = x * 0x1.71547652b82fep0 + SCREE_ROUNDER;
    double k = shifted - SCREE_ROUNDER;
    double r = (x - k * 0x1.62e42fefa3800p-1) - k * 0x1.ef35793c76730p-45;
    double p = 1.0 / 6227020800.0;
    p = p * r + 1.0 / 479001600.0;
    p = p * r + 1.0 / 39916800.0;
    p = p * r + 1.0 / 3628800.0;
    p = p * r + 1.0 / 362880.0;
    p = p * r + 1.0 / 40320.0;
    p = p * r + 1.0 / 5040.0;
    p = p * r + 1.0 / 720.0;
    p = p * r + 1.0 / 120.0;
    p = p * r + 1.0 / 24.0;
    p = p * r + 1.0 / 6.0;
    p = p * r + 0.5;
    p = p * r * r + r + 1.0;
    uint64_t scale = (scree_double_to_bits(shifted) + 1023u) << 52;
    return p * scree_bits_to_double(scale);
}

/* Natural logarithm of a normal x > 0: x = 2^k m with m within a factor sqrt 2 of 1, then the series of
 * 2 artanh((m - 1)/(m + 1)), whose first dropped term is below 1e-18 relative. */
static inline double scree_log(double x) {
    uint64_t bits = scree_double_to_bits(x);
    double k = scree_bits_to_double((bits >> 52) | 0x4330000000000000u) - (0x1p52 + 1023.0);
    double m = scree_bits_to_double((bits & 0x000fffffffffffffu) | 0x3ff0000000000000u);
    k = m > 1.4142135623730951 ? k + 1.0 : k;
    m = m > 1.4142135623730951 ? 0.5 * m : m;
    double s = (m - 1.0) / (m + 1.0);
    double z = s * s;
    double p = 1.0 / 23.0;
    p = p * z + 1.0 / 21.0;
    p = p * z + 1.0 / 19.0;
    p = p * z + 1.0 / 17.0;
    p = p * z + 1.0 / 15.0;
    p = p * z + 1.0 / 13.0;
    p = p * z + 1.0 / 11.0;
    p = p * z + 1.0 / 9.0;
    p = p * z + 1.0 / 7.0;
    p = p * z + 1.0 / 5.0;
    p = p * z + 1.0 / 3.0;
    return k * 0x1.62e42fefa3800p-1 + (2.0 * s + (2.0 * s * z * p + k * 0x1.ef35793c76730p-45));
}

/* x to the power p for x >= 0 and p > 0; relative error about |p ln x| units of the last place. */
static inline double scree_pow(double x, double p) {
    int tiny = x < 1e-300;
    double value = scree_exp(p * scree_log(tiny ? 1e-300 : x));
    return tiny ? 0.0 : value;
}

/* x to a whole power >= 0. */
static inline double scree_whole_power(double x, int power) {
    double y = 1.0;
    for (int k = 0; k < power; k++) y *= x;
    return y;
}

/* The first, second or fourth root of x >= 0. */
static inline double scree_whole_root(double x, int root) {
    return root == 2 ? sqrt(x) : root == 4 ? sqrt(sqrt(x)) : x;
}

/* tanh(x). */
static inline double scree_tanh(double x) {
    double a = x < 0.0 ? -x : x;
    double e = scree_exp(-2.0 * a);
    double far = (1.0 - e) / (1.0 + e);
    /* Below 0.1 the quotient would cancel; the series is good to 1e-17 there. */
    double z = x * x;
    double p = -929569.0 / 638512875.0;
    p = p * z + 21844.0 / 6081075.0;
    p = p * z - 1382.0 / 155925.0;
    p = p * z + 62.0 / 2835.0;
    p = p * z - 17.0 / 315.0;
    p = p * z + 2.0 / 15.0;
    p = p * z - 1.0 / 3.0;
    double near = a + a * z * p;
    double value = a < 0.1 ? near : far;
    return x < 0.0 ? -value : value;
}

/* sin(x) and cos(x) for |x| <= 1e5 rad (about 1e-15 absolute there; less exact beyond): Cody & Waite reduction by
 * multiples of pi/2 in three parts, then the Taylor series on [-pi/4, pi/4]. */
static inline void scree_sincos(double x, double *sine, double *cosine) {
    double shifted = x * 0x1.45f306dc9c883p-1 + SCREE_ROUNDER;
    double k = shifted - SCREE_ROUNDER;
    double r = ((x - k * 0x1.921fb54400000p0) - k * 0x1.0b4611a600000p-34) - k * 0x1.3198a2e037073p-69;
    double z = r * r;
    double s = 1.0 / 355687428096000.0;
    s = s * z - 1.0 / 1307674368000.0;
    s = s * z + 1.0 / 6227020800.0;
    s = s * z - 1.0 / 39916800.0;
    s = s * z + 1.0 / 362880.0;
    s = s * z - 1.0 / 5040.0;
    s = s * z + 1.0 / 120.0;
    s = s * z - 1.0 / 6.0;
    s = r + r * z * s;
    double c = -1.0 / 6402373705728000.0;
    c = c * z + 1.0 / 20922789888000.0;
    c = c * z - 1.0 / 87178291200.0;
    c = c * z + 1.0 / 479001600.0;
    c = c * z - 1.0 / 3628800.0;
    c = c * z + 1.0 / 40320.0;
    c = c * z - 1.0 / 720.0;
    c = c * z + 1.0 / 24.0;
    c = 1.0 - (0.5 * z - z * z * c);
    uint64_t quadrant = scree_double_to_bits(shifted) & 3u;
    double first = (quadrant & 1u) ? c : s;
    double second = (quadrant & 1u) ? s : c;
    *sine = (quadrant & 2u) ? -first : first;
    *cosine = (quadrant == 1u || quadrant == 2u) ? -second : second;
}

/* The larger and the smaller of two numbers that are measured: not a number if one of them isn't, so that a check of
 * the result fails. (fmax and fmin would give the other one.) */
static inline double scree_most(double a, double b) { return a >= b || a != a ? a : b; }
static inline double scree_least(double a, double b) { return a <= b || a != a ? a : b; }

#endif
