//! The number that the mechanics is written over.
//!
//! The equations stand once, generic over [`Scalar`]. With `f64` they are the interpreter, with the
//! compiler's symbols they are what is staged into straight-line code, with dual numbers they check
//! derivatives. The trait therefore has no ordering and no conversion back to `f64`: code over it
//! may branch on the structure of a mechanism but never on a value. A choice by value is
//! [`Scalar::select`].

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// How [`Scalar::select`] compares.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Comparison {
    /// `left < right`.
    Less,
    /// `left <= right`.
    LessEqual,
    /// `left == right`.
    Equal,
}

/// A real number, or something that computes like one.
pub trait Scalar:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
{
    /// The constant `value`.
    fn constant(value: f64) -> Self;
    /// Sine and cosine (argument in rad).
    fn sin_cos(self) -> (Self, Self);
    /// Square root.
    fn sqrt(self) -> Self;
    /// 1/x.
    fn recip(self) -> Self;
    /// Exponential.
    fn exp(self) -> Self;
    /// Natural logarithm.
    fn log(self) -> Self;
    /// Tangent.
    fn tan(self) -> Self;
    /// Inverse sine.
    fn asin(self) -> Self;
    /// Inverse cosine.
    fn acos(self) -> Self;
    /// Inverse tangent.
    fn atan(self) -> Self;
    /// Angle of the point (x = `x`, y = `self`).
    fn atan2(self, x: Self) -> Self;
    /// Integer power.
    fn powi(self, exponent: i32) -> Self;
    /// Real power.
    fn powf(self, exponent: Self) -> Self;
    /// Largest integer not above.
    fn floor(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// The smaller of two.
    fn min(self, other: Self) -> Self;
    /// The larger of two.
    fn max(self, other: Self) -> Self;
    /// `then` where the comparison holds, else `otherwise`.
    fn select(comparison: Comparison, left: Self, right: Self, then: Self, otherwise: Self)
    -> Self;

    /// Zero.
    #[inline]
    fn zero() -> Self {
        Self::constant(0.0)
    }
    /// One.
    #[inline]
    fn one() -> Self {
        Self::constant(1.0)
    }
    /// Product with a constant.
    #[inline]
    fn scale(self, factor: f64) -> Self {
        self * Self::constant(factor)
    }
    /// Whether the value is known to be zero before anything runs; `f64` never knows.
    #[inline]
    fn is_known_zero(self) -> bool {
        false
    }
}

impl Scalar for f64 {
    #[inline]
    fn constant(value: f64) -> Self {
        value
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        crate::math::sin_cos(self)
    }
    #[inline]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline]
    fn recip(self) -> Self {
        1.0 / self
    }
    #[inline]
    fn exp(self) -> Self {
        crate::math::exp(self)
    }
    #[inline]
    fn log(self) -> Self {
        f64::ln(self)
    }
    #[inline]
    fn tan(self) -> Self {
        f64::tan(self)
    }
    #[inline]
    fn asin(self) -> Self {
        f64::asin(self)
    }
    #[inline]
    fn acos(self) -> Self {
        f64::acos(self)
    }
    #[inline]
    fn atan(self) -> Self {
        f64::atan(self)
    }
    #[inline]
    fn atan2(self, x: Self) -> Self {
        crate::math::atan2(self, x)
    }
    #[inline]
    fn powi(self, exponent: i32) -> Self {
        f64::powi(self, exponent)
    }
    #[inline]
    fn powf(self, exponent: Self) -> Self {
        f64::powf(self, exponent)
    }
    #[inline]
    fn floor(self) -> Self {
        f64::floor(self)
    }
    #[inline]
    fn abs(self) -> Self {
        f64::abs(self)
    }
    #[inline]
    fn min(self, other: Self) -> Self {
        f64::min(self, other)
    }
    #[inline]
    fn max(self, other: Self) -> Self {
        f64::max(self, other)
    }
    #[inline]
    fn select(
        comparison: Comparison,
        left: Self,
        right: Self,
        then: Self,
        otherwise: Self,
    ) -> Self {
        let holds = match comparison {
            Comparison::Less => left < right,
            Comparison::LessEqual => left <= right,
            Comparison::Equal => left == right,
        };
        if holds { then } else { otherwise }
    }
}
