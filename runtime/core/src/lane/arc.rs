//! The angle of a point, from sums, products and one quotient, so that its bits do not depend on a
//! system library and so that every lane does the same.

use super::Lane;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// The larger coordinate of points that are looked at here; others, and those that are not finite, are
/// left to the standard library.
const SIZES: [f64; 2] = [1e-280, 1e280];

/// tan π/8.
const NEAR: f64 = 0.414_213_562_373_095_03;

/// What rounding takes from π.
const PI_TAIL: f64 = 1.224_646_799_147_353_2e-16;

/// Coefficients of (atan √z/√z − 1)/z, interpolated at Chebyshev points of 0 ≤ z ≤ tan²(π/8);
/// relative error of the angle 7e-18.
const ARC: [f64; 11] = [
    -0.3333333333333333,
    0.1999999999999552,
    -0.14285714284666542,
    0.11111111015256292,
    -0.09090904578121085,
    0.07692183190760651,
    -0.0666451144646022,
    0.05858148904795124,
    -0.050854496960392584,
    0.039231657085083686,
    -0.019176885636589053,
];

/// Angle of the point (x, y) (rad), within two units in the last place.
///
/// With the smaller coordinate over the larger one, t ≤ 1, and u = t, or (t − 1)/(t + 1) where t is
/// above tan π/8, the angle is a multiple of π/4 plus or minus atan u, |u| ≤ tan π/8.
#[inline(always)]
pub(super) fn angle<L: Lane>(y: L, x: L) -> L {
    let (width, height) = (x.abs(), y.abs());
    let larger = width.max(height);
    let [least, most] = SIZES.map(L::splat);
    if least.less(larger) & (height + width).less(most) != L::ALL {
        return y.map_two(x, f64::atan2);
    }
    let smaller = width.min(height);
    let is_steep = |then: L, otherwise: L| L::if_less(width, height, then, otherwise);
    let limit = L::splat(NEAR) * larger;
    let is_far = |then: L, otherwise: L| L::if_less(limit, smaller, then, otherwise);
    let u = is_far(smaller - larger, smaller) / is_far(larger + smaller, larger);
    let z = u * u;
    // The sign of zero counts, as in the standard library.
    let sign = L::splat(1.0).with_sign_of(x);
    let is_left = |then: L, otherwise: L| L::if_less(sign, L::splat(0.0), then, otherwise);
    let constant = |a: f64| L::splat(a);
    let base = is_far(
        is_left(constant(3.0 * FRAC_PI_4), constant(FRAC_PI_4)),
        is_steep(constant(FRAC_PI_2), is_left(constant(PI), constant(0.0))),
    );
    // Parts of π, so that its tail is in proportion.
    let tail = base * constant(PI_TAIL / PI);
    let direction = sign * is_steep(constant(-1.0), constant(1.0));
    let u = u * direction;
    let result = base + (u + (u * z).mul_add(series(z), tail));
    result.with_sign_of(y)
}

/// A polynomial of degree ten, split so that the steps overlap.
#[inline(always)]
fn series<L: Lane>(z: L) -> L {
    let a = |k: usize| L::splat(ARC[k]);
    let square = z * z;
    let fourth = square * square;
    let pair = |k: usize| a(k + 1).mul_add(z, a(k));
    let low = square.mul_add(pair(2), pair(0));
    let middle = square.mul_add(pair(6), pair(4));
    let high = square.mul_add(a(10), pair(8));
    fourth.mul_add(fourth.mul_add(high, middle), low)
}

#[cfg(test)]
mod tests {
    use crate::math::atan2;
    use std::f64::consts::{FRAC_PI_4, PI};

    #[test]
    fn angles_are_those_of_the_standard_library() {
        let mut worst: f64 = 0.0;
        let mut check = |y: f64, x: f64| {
            let (found, expected) = (atan2(y, x), y.atan2(x));
            let unit = expected.abs() * f64::EPSILON;
            let off = (found - expected).abs() / unit.max(f64::MIN_POSITIVE);
            assert!(off <= 2.0, "atan2({y:e}, {x:e}): {found:e} for {expected:e}");
            worst = worst.max(off);
        };
        for i in 0..200_000 {
            let turn = (f64::from(i) + 0.37) * 2.0 * PI / 200_000.0;
            let size = (f64::from(i % 41) - 20.0).exp();
            check(size * turn.sin(), size * turn.cos());
        }
        for i in 0..300 {
            let small = 10f64.powi(-i);
            for (y, x) in [(small, 1.0), (1.0, small), (1.0, 1.0 + small)] {
                for (a, b) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
                    check(a * y, b * x);
                }
            }
        }
        eprintln!("atan2: at most {worst:.2} units in the last place from the library's");
    }

    #[test]
    fn special_points() {
        assert_eq!(atan2(1.0, 1.0), FRAC_PI_4);
        for y in [0.0, -0.0, 1.0, -1.0, f64::INFINITY, f64::MIN_POSITIVE, 1e300, f64::NAN] {
            for x in [0.0, -0.0, 1.0, -1.0, f64::NEG_INFINITY, -f64::MIN_POSITIVE, 1e300] {
                let (found, expected) = (atan2(y, x), y.atan2(x));
                assert!(found == expected || found.is_nan() && expected.is_nan(), "{y} {x}");
                assert_eq!(found.is_sign_negative(), expected.is_sign_negative(), "{y} {x}");
            }
        }
    }
}
