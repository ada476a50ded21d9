//! Sine and cosine together, from sums and products alone, so that their bits do not depend on a
//! system library and so that every lane does the same.

use super::Lane;

/// Angles beyond this (rad) are left to the standard library, whose reduction never loses digits.
pub(super) const LARGEST_ANGLE: f64 = 1e6;

/// π/2 in three parts: the first two have 33 bits, so that their products with a quadrant number
/// below 2²⁰ are exact.
const HALF_PI: [f64; 3] = [1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21];

/// Coefficients of (sin √z/√z − 1)/z, interpolated at Chebyshev points of 0 ≤ z ≤ (π/4)²;
/// relative error of the sine 2e-17.
const SINE: [f64; 6] = [
    -0.16666666666666666,
    0.008333333333330946,
    -0.0001984126983675497,
    2.755731610068303e-06,
    -2.5051131455427946e-08,
    1.591810123027412e-10,
];

/// Coefficients of (cos √z − 1 + z/2)/z², as [`SINE`]; error of the cosine 8e-19.
const COSINE: [f64; 6] = [
    0.041666666666666664,
    -0.0013888888888887395,
    2.4801587298763433e-05,
    -2.7557317270560326e-07,
    2.0876146024689747e-09,
    -1.1382614868556325e-11,
];

/// Reduces to |r| ≤ π/4 and a quadrant, then evaluates both series.
#[inline(always)]
pub(super) fn reduced<L: Lane>(x: L) -> (L, L) {
    // Adding 1.5·2⁵² rounds to an integer and leaves it in the low bits.
    let shift = L::splat(6755399441055744.0);
    let shifted = x.mul_add(L::splat(std::f64::consts::FRAC_2_PI), shift);
    let n = shifted - shift;
    // Exact, then rounded once; the last part tells only where r is small.
    let r = n.neg_mul_add(L::splat(HALF_PI[0]), x);
    let r = n.neg_mul_add(L::splat(HALF_PI[1]), r);
    let r = n.neg_mul_add(L::splat(HALF_PI[2]), r);
    let r = L::if_less_equal(x.abs(), L::splat(LARGEST_ANGLE), r, L::splat(f64::NAN));
    let z = r * r;
    let (s, c) = (series(&SINE, z), series(&COSINE, z));
    let sine = (r * z).mul_add(s, r);
    let cosine = L::splat(1.0) - (z * z).neg_mul_add(c, L::splat(0.5) * z);
    L::turn(shifted, sine, cosine)
}

/// A polynomial of degree five, split in three so that the steps overlap.
#[inline(always)]
fn series<L: Lane>(a: &[f64; 6], z: L) -> L {
    // An array of vectors would go through memory.
    let a = |k: usize| L::splat(a[k]);
    let square = z * z;
    let low = a(1).mul_add(z, a(0));
    let middle = a(3).mul_add(z, a(2));
    let high = a(5).mul_add(z, a(4));
    square.mul_add(square.mul_add(high, middle), low)
}
