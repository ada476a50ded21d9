//! Dual numbers: a value and its derivative by one variable.
//!
//! `Dual<f64>` carries a first derivative through any code over [`Scalar`], `Dual<Dual<f64>>` a
//! second one. They are exact to rounding, so that the mechanics' hand-derived matrices can be held
//! to them.

use handc_core::scalar::{Comparison, Scalar};
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// `value + slope·ε` with ε² = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<S> {
    /// The number.
    pub value: S,
    /// Its derivative.
    pub slope: S,
}

impl<S: Scalar> Dual<S> {
    /// The variable by which is differentiated, at `value`.
    pub fn variable(value: S) -> Self {
        Dual { value, slope: S::one() }
    }
    /// A number that does not depend on the variable.
    pub fn fixed(value: S) -> Self {
        Dual { value, slope: S::zero() }
    }
    /// f(self) from f and f' at the value.
    #[inline]
    fn chain(self, value: S, derivative: S) -> Self {
        Dual { value, slope: derivative * self.slope }
    }
}

impl<S: Scalar> Add for Dual<S> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Dual { value: self.value + other.value, slope: self.slope + other.slope }
    }
}
impl<S: Scalar> Sub for Dual<S> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Dual { value: self.value - other.value, slope: self.slope - other.slope }
    }
}
impl<S: Scalar> Mul for Dual<S> {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        Dual {
            value: self.value * other.value,
            slope: self.slope * other.value + self.value * other.slope,
        }
    }
}
impl<S: Scalar> Div for Dual<S> {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Dual { value, slope: (self.slope - value * other.slope) / other.value }
    }
}
impl<S: Scalar> Neg for Dual<S> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Dual { value: -self.value, slope: -self.slope }
    }
}
impl<S: Scalar> AddAssign for Dual<S> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
impl<S: Scalar> SubAssign for Dual<S> {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<S: Scalar> Scalar for Dual<S> {
    fn constant(value: f64) -> Self {
        Dual::fixed(S::constant(value))
    }
    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = self.value.sin_cos();
        (self.chain(s, c), self.chain(c, -s))
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, root.recip().scale(0.5))
    }
    fn recip(self) -> Self {
        let r = self.value.recip();
        self.chain(r, -(r * r))
    }
    fn exp(self) -> Self {
        let e = self.value.exp();
        self.chain(e, e)
    }
    fn log(self) -> Self {
        self.chain(self.value.log(), self.value.recip())
    }
    fn tan(self) -> Self {
        let t = self.value.tan();
        self.chain(t, S::one() + t * t)
    }
    fn asin(self) -> Self {
        let x = self.value;
        self.chain(x.asin(), (S::one() - x * x).sqrt().recip())
    }
    fn acos(self) -> Self {
        let x = self.value;
        self.chain(x.acos(), -(S::one() - x * x).sqrt().recip())
    }
    fn atan(self) -> Self {
        let x = self.value;
        self.chain(x.atan(), (S::one() + x * x).recip())
    }
    fn atan2(self, x: Self) -> Self {
        let (a, b) = (self.value, x.value);
        let slope = (b * self.slope - a * x.slope) / (a * a + b * b);
        Dual { value: a.atan2(b), slope }
    }
    fn powi(self, exponent: i32) -> Self {
        if exponent == 0 {
            return Self::one();
        }
        let lower = self.value.powi(exponent - 1);
        self.chain(self.value.powi(exponent), lower.scale(f64::from(exponent)))
    }
    fn powf(self, exponent: Self) -> Self {
        let (x, n) = (self.value, exponent.value);
        let value = x.powf(n);
        let by_base = n * x.powf(n - S::one()) * self.slope;
        // A fixed exponent needs no logarithm, which the base may not have.
        let by_exponent = value * x.log() * exponent.slope;
        let zero = S::zero();
        let by_exponent = S::select(Comparison::Equal, exponent.slope, zero, zero, by_exponent);
        Dual { value, slope: by_base + by_exponent }
    }
    fn floor(self) -> Self {
        Dual::fixed(self.value.floor())
    }
    fn abs(self) -> Self {
        Self::select(Comparison::Less, self, Self::zero(), -self, self)
    }
    fn min(self, other: Self) -> Self {
        Self::select(Comparison::Less, other, self, other, self)
    }
    fn max(self, other: Self) -> Self {
        Self::select(Comparison::Less, self, other, other, self)
    }
    fn select(
        comparison: Comparison,
        left: Self,
        right: Self,
        then: Self,
        otherwise: Self,
    ) -> Self {
        let pick = |a: S, b: S| S::select(comparison, left.value, right.value, a, b);
        Dual { value: pick(then.value, otherwise.value), slope: pick(then.slope, otherwise.slope) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// f' and f'' by nested duals against central differences of f.
    fn holds(f: impl Fn(Dual<Dual<f64>>) -> Dual<Dual<f64>>, x: f64) {
        let at = |x: f64| f(Dual::constant(x)).value.value;
        let out = f(Dual::variable(Dual::variable(x)));
        let d = 1e-4;
        let first = (at(x + d) - at(x - d)) / (2.0 * d);
        let second = (at(x + d) - 2.0 * at(x) + at(x - d)) / (d * d);
        assert_eq!(out.value.slope, out.slope.value);
        assert!((out.slope.value - first).abs() < 1e-6 * (1.0 + first.abs()), "{out:?} {first}");
        assert!((out.slope.slope - second).abs() < 1e-5 * (1.0 + second.abs()), "{out:?} {second}");
    }

    #[test]
    fn every_operation() {
        let c = Dual::constant;
        for x in [0.3, 0.7] {
            holds(|x| x.sin_cos().0 * x.sin_cos().1 - x.tan() / (x + c(2.0)), x);
            holds(|x| x.sqrt() + x.recip() + x.exp() * x.log(), x);
            holds(|x| x.asin() + x.acos() * x + x.atan(), x);
            holds(|x| (x * x).atan2(c(1.0) - x) + c(2.0).atan2(x), x);
            holds(|x| x.powi(3) + x.powi(-2) + x.powi(0) + x.powi(1), x);
            holds(|x| x.powf(c(2.5)) + c(3.0).powf(x) + x.powf(x), x);
            holds(|x| (-x).powf(c(2.0)) + (c(0.5) - x).abs() * x, x);
            holds(|x| x.floor() + (x * x).min(x.scale(0.5)) * (x * x).max(x.scale(0.5)), x);
        }
    }
}
