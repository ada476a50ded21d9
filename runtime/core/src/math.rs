//! The functions that generated code calls.
//!
//! One place for what differs between machines. A product fused with a sum is one instruction where
//! the target has it and two operations elsewhere: the library's software replacement would be a
//! hundred times slower. Sine and cosine are computed together, inline and without a branch on the
//! angle, and from sums and products alone, so that their bits do not depend on a system library.

/// Angles beyond this (rad) are left to the standard library, whose reduction never loses digits.
const LARGEST_ANGLE: f64 = 1e6;

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

/// a·b + c, with one rounding where the target can.
#[inline(always)]
pub fn mul_add(a: f64, b: f64, c: f64) -> f64 {
    if cfg!(target_feature = "fma") { a.mul_add(b, c) } else { a * b + c }
}

/// a·b − c, see [`mul_add`].
#[inline(always)]
pub fn mul_sub(a: f64, b: f64, c: f64) -> f64 {
    if cfg!(target_feature = "fma") { a.mul_add(b, -c) } else { a * b - c }
}

/// c − a·b, see [`mul_add`].
#[inline(always)]
pub fn neg_mul_add(a: f64, b: f64, c: f64) -> f64 {
    if cfg!(target_feature = "fma") { (-a).mul_add(b, c) } else { c - a * b }
}

/// Sine and cosine (rad), each within one unit in the last place.
#[inline(always)]
pub fn sin_cos(x: f64) -> (f64, f64) {
    if x.abs() <= LARGEST_ANGLE { reduced_sin_cos(x) } else { x.sin_cos() }
}

/// Reduces to |r| ≤ π/4 and a quadrant, then evaluates both series.
#[inline(always)]
fn reduced_sin_cos(x: f64) -> (f64, f64) {
    // Adding 1.5·2⁵² rounds to an integer and leaves it in the low bits.
    const SHIFT: f64 = 6755399441055744.0;
    let shifted = x * std::f64::consts::FRAC_2_PI + SHIFT;
    let quadrant = shifted.to_bits();
    let n = shifted - SHIFT;
    let exact = x - n * HALF_PI[0];
    let second = n * HALF_PI[1];
    let r = exact - second;
    // What the rounding of r lost is handed to both results to first order.
    let tail = neg_mul_add(n, HALF_PI[2], (exact - r) - second);
    let z = r * r;
    let (s, c) = (series(&SINE, z), series(&COSINE, z));
    let sine = r + mul_add(r * z, s, tail);
    let cosine = 1.0 - (0.5 * z - neg_mul_add(r, tail, z * z * c));
    let (a, b) = if quadrant & 1 == 0 { (sine, cosine) } else { (cosine, sine) };
    (flip(a, quadrant & 2), flip(b, quadrant.wrapping_add(1) & 2))
}

/// −x if `second_bit` is set.
#[inline(always)]
fn flip(x: f64, second_bit: u64) -> f64 {
    f64::from_bits(x.to_bits() ^ (second_bit << 62))
}

/// A polynomial of degree five, split in three so that the steps overlap.
#[inline(always)]
fn series(a: &[f64; 6], z: f64) -> f64 {
    let square = z * z;
    let low = mul_add(a[1], z, a[0]);
    let middle = mul_add(a[3], z, a[2]);
    let high = mul_add(a[5], z, a[4]);
    mul_add(square, mul_add(square, high, middle), low)
}

/// Sine.
#[inline(always)]
pub fn sin(x: f64) -> f64 {
    sin_cos(x).0
}

/// Cosine.
#[inline(always)]
pub fn cos(x: f64) -> f64 {
    sin_cos(x).1
}

macro_rules! of_one {
    ($($(#[$doc:meta])* $name:ident => $method:ident;)*) => {$(
        $(#[$doc])*
        #[inline(always)]
        pub fn $name(x: f64) -> f64 {
            x.$method()
        }
    )*};
}

of_one! {
    /// Square root.
    sqrt => sqrt;
    /// 1/x.
    recip => recip;
    /// Tangent.
    tan => tan;
    /// Inverse sine.
    asin => asin;
    /// Inverse cosine.
    acos => acos;
    /// Inverse tangent.
    atan => atan;
    /// Exponential.
    exp => exp;
    /// Natural logarithm.
    log => ln;
    /// Largest integer not above.
    floor => floor;
    /// Absolute value.
    abs => abs;
}

/// Angle of the point (x, y).
#[inline(always)]
pub fn atan2(y: f64, x: f64) -> f64 {
    y.atan2(x)
}

/// Real power.
#[inline(always)]
pub fn powf(x: f64, exponent: f64) -> f64 {
    x.powf(exponent)
}

/// Integer power.
#[inline(always)]
pub fn powi(x: f64, exponent: i32) -> f64 {
    x.powi(exponent)
}

/// The smaller of two.
#[inline(always)]
pub fn min(x: f64, y: f64) -> f64 {
    x.min(y)
}

/// The larger of two.
#[inline(always)]
pub fn max(x: f64, y: f64) -> f64 {
    x.max(y)
}

/// `then` if left < right, else `otherwise`.
#[inline(always)]
pub fn if_less(left: f64, right: f64, then: f64, otherwise: f64) -> f64 {
    if left < right { then } else { otherwise }
}

/// `then` if left ≤ right, else `otherwise`.
#[inline(always)]
pub fn if_less_equal(left: f64, right: f64, then: f64, otherwise: f64) -> f64 {
    if left <= right { then } else { otherwise }
}

/// `then` if left = right, else `otherwise`.
#[inline(always)]
pub fn if_equal(left: f64, right: f64, then: f64, otherwise: f64) -> f64 {
    if left == right { then } else { otherwise }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distance in units in the last place of the larger of 1e-3 and the expected value: near a
    /// zero of the sine the last place of the angle itself is worth more than that of the sine.
    fn error(found: f64, expected: f64) -> f64 {
        (found - expected).abs() / (expected.abs().max(1e-3) * f64::EPSILON)
    }

    #[test]
    fn sine_and_cosine_are_those_of_the_standard_library() {
        for i in -200_000..200_000 {
            let x = f64::from(i) * 0.000_617 * (1.0 + f64::from(i).abs() * 1e-3);
            let (found, expected) = (sin_cos(x), x.sin_cos());
            assert!(error(found.0, expected.0) <= 1.0, "sin {x}");
            assert!(error(found.1, expected.1) <= 1.0, "cos {x}");
        }
        for n in -1000..1000 {
            let x = f64::from(n) * std::f64::consts::FRAC_PI_2;
            let (found, expected) = (sin_cos(x), x.sin_cos());
            assert!((found.0 - expected.0).abs() <= 1e-16 * expected.0.abs().max(1e-12), "{x}");
            assert!((found.1 - expected.1).abs() <= 1e-16 * expected.1.abs().max(1e-12), "{x}");
        }
    }

    #[test]
    fn special_angles() {
        assert_eq!(sin_cos(0.0), (0.0, 1.0));
        assert!(sin_cos(f64::NAN).0.is_nan());
        assert!(sin_cos(f64::INFINITY).1.is_nan());
        assert_eq!(sin_cos(1e300), 1e300f64.sin_cos());
    }

    #[test]
    fn fused_forms() {
        assert_eq!(mul_add(2.0, 3.0, 4.0), 10.0);
        assert_eq!(mul_sub(2.0, 3.0, 4.0), 2.0);
        assert_eq!(neg_mul_add(2.0, 3.0, 4.0), -2.0);
    }
}
