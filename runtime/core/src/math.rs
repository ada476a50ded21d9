//! The functions that generated code calls.
//!
//! One place for what differs between machines. A product fused with a sum is one instruction where
//! the target has it and two operations elsewhere: the library's software replacement would be a
//! hundred times slower.

use crate::lane::Lane;

/// a·b + c, with one rounding where the target can.
#[inline(always)]
pub fn mul_add(a: f64, b: f64, c: f64) -> f64 {
    Lane::mul_add(a, b, c)
}

/// a·b − c, see [`mul_add`].
#[inline(always)]
pub fn mul_sub(a: f64, b: f64, c: f64) -> f64 {
    Lane::mul_sub(a, b, c)
}

/// c − a·b, see [`mul_add`].
#[inline(always)]
pub fn neg_mul_add(a: f64, b: f64, c: f64) -> f64 {
    Lane::neg_mul_add(a, b, c)
}

/// Sine and cosine (rad), each within one unit in the last place, one and a half beyond ten radians.
#[inline(always)]
pub fn sin_cos(x: f64) -> (f64, f64) {
    Lane::sin_cos(x)
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

/// Square root and 1 over it.
#[inline(always)]
pub fn sqrt_recip(x: f64) -> (f64, f64) {
    Lane::sqrt_recip(x)
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
    /// Natural logarithm.
    log => ln;
    /// Largest integer not above.
    floor => floor;
    /// Absolute value.
    abs => abs;
}

/// Exponential, within one unit in the last place.
#[inline(always)]
pub fn exp(x: f64) -> f64 {
    Lane::exp(x)
}

/// Angle of the point (x, y) (rad), within two units in the last place.
#[inline(always)]
pub fn atan2(y: f64, x: f64) -> f64 {
    Lane::atan2(y, x)
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
            let most = if x.abs() < 10.0 { 1.0 } else { 1.5 };
            assert!(error(found.0, expected.0) <= most, "sin {x}");
            assert!(error(found.1, expected.1) <= most, "cos {x}");
        }
        for n in -1000..1000 {
            let x = f64::from(n) * std::f64::consts::FRAC_PI_2;
            let (found, expected) = (sin_cos(x), x.sin_cos());
            assert!((found.0 - expected.0).abs() <= 1e-16 * expected.0.abs().max(1e-12), "{x}");
            assert!((found.1 - expected.1).abs() <= 1e-16 * expected.1.abs().max(1e-12), "{x}");
        }
    }

    #[test]
    fn exponentials_are_those_of_the_standard_library() {
        let mut worst: f64 = 0.0;
        for i in -700_000..=700_000 {
            let x = f64::from(i) * 1e-3 * (1.0 + 1e-9 * f64::from(i % 7));
            let (found, expected) = (exp(x), x.exp());
            worst = worst.max((found / expected - 1.0).abs());
        }
        assert!(worst <= 2.5e-16, "{worst:e}");
        for x in [0.0, 1e-300, -1e-20, 1.0, 709.0, 800.0, -800.0, f64::INFINITY, f64::NEG_INFINITY]
        {
            assert!((exp(x) - x.exp()).abs() <= 3e-16 * x.exp() || exp(x) == x.exp(), "{x}");
        }
        assert!(exp(f64::NAN).is_nan());
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
