//! The exponential function, from sums and products alone, as sine and cosine are.

use super::Lane;

/// Arguments beyond this are left to the standard library where there is one number, and taken for it
/// on lanes: e^700 is near the largest number.
pub(super) const LARGEST: f64 = 700.0;

/// log 2 in two parts: the first has 32 bits, so that its product with an exponent is exact.
const LOG_2: [f64; 2] = [0.6931471803691238, 1.9082149292705877e-10];

/// Coefficients of (e^r − 1 − r)/r², interpolated at Chebyshev points of |r| ≤ (log 2)/2; relative
/// error of the exponential 2e-17.
const SERIES: [f64; 10] = [
    0.5000000000000001,
    0.16666666666666669,
    0.041666666666624164,
    0.008333333333330065,
    0.0013888888917196736,
    0.00019841269863040559,
    2.480152132234228e-05,
    2.7557268480289716e-06,
    2.7620075892548164e-07,
    2.51003758422237e-08,
];

/// Reduces to |r| ≤ (log 2)/2 and a power of two, then evaluates the series.
#[inline(always)]
pub(super) fn reduced<L: Lane>(x: L) -> L {
    // Adding 1.5·2⁵² rounds to an integer and leaves it in the low bits.
    let shift = L::splat(6755399441055744.0);
    let shifted = x.mul_add(L::splat(std::f64::consts::LOG2_E), shift);
    let n = shifted - shift;
    let exact = n.neg_mul_add(L::splat(LOG_2[0]), x);
    let second = n * L::splat(LOG_2[1]);
    let r = exact - second;
    // What the rounding of r lost is added to first order.
    let tail = (exact - r) - second;
    let a = |k: usize| L::splat(SERIES[k]);
    let square = r * r;
    let fourth = square * square;
    let pair = |k: usize| a(k + 1).mul_add(r, a(k));
    let low = square.mul_add(pair(2), pair(0));
    let high = square.mul_add(pair(6), pair(4));
    let series = fourth.mul_add(fourth.mul_add(pair(8), high), low);
    L::exponent(shifted, L::splat(1.0) + (r + square.mul_add(series, tail)))
}
