//! Forward-mode dual numbers, an independent way to the same derivatives.

use handc_core::scalar::{Comparison, Scalar};
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

#[derive(Clone, Copy, Debug)]
pub(super) struct Dual {
    pub(super) value: f64,
    pub(super) derivative: f64,
}

impl Dual {
    fn chain(self, value: f64, slope: f64) -> Dual {
        Dual { value, derivative: slope * self.derivative }
    }
}

impl Add for Dual {
    type Output = Dual;
    fn add(self, o: Dual) -> Dual {
        Dual { value: self.value + o.value, derivative: self.derivative + o.derivative }
    }
}
impl Sub for Dual {
    type Output = Dual;
    fn sub(self, o: Dual) -> Dual {
        self + -o
    }
}
impl Mul for Dual {
    type Output = Dual;
    fn mul(self, o: Dual) -> Dual {
        let derivative = self.derivative * o.value + self.value * o.derivative;
        Dual { value: self.value * o.value, derivative }
    }
}
impl Div for Dual {
    type Output = Dual;
    fn div(self, o: Dual) -> Dual {
        let value = self.value / o.value;
        Dual { value, derivative: (self.derivative - value * o.derivative) / o.value }
    }
}
impl Neg for Dual {
    type Output = Dual;
    fn neg(self) -> Dual {
        self.chain(-self.value, -1.0)
    }
}
impl AddAssign for Dual {
    fn add_assign(&mut self, o: Dual) {
        *self = *self + o;
    }
}
impl SubAssign for Dual {
    fn sub_assign(&mut self, o: Dual) {
        *self = *self - o;
    }
}

impl Scalar for Dual {
    fn constant(value: f64) -> Self {
        Dual { value, derivative: 0.0 }
    }
    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = self.value.sin_cos();
        (self.chain(s, c), self.chain(c, -s))
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, 0.5 / root)
    }
    fn recip(self) -> Self {
        self.chain(1.0 / self.value, -1.0 / (self.value * self.value))
    }
    fn exp(self) -> Self {
        self.chain(self.value.exp(), self.value.exp())
    }
    fn log(self) -> Self {
        self.chain(self.value.ln(), 1.0 / self.value)
    }
    fn tan(self) -> Self {
        self.chain(self.value.tan(), 1.0 / self.value.cos().powi(2))
    }
    fn asin(self) -> Self {
        self.chain(self.value.asin(), 1.0 / (1.0 - self.value * self.value).sqrt())
    }
    fn acos(self) -> Self {
        self.chain(self.value.acos(), -1.0 / (1.0 - self.value * self.value).sqrt())
    }
    fn atan(self) -> Self {
        self.chain(self.value.atan(), 1.0 / (1.0 + self.value * self.value))
    }
    fn atan2(self, x: Self) -> Self {
        let square = self.value * self.value + x.value * x.value;
        let derivative = (self.derivative * x.value - self.value * x.derivative) / square;
        Dual { value: self.value.atan2(x.value), derivative }
    }
    fn powi(self, n: i32) -> Self {
        self.chain(self.value.powi(n), f64::from(n) * self.value.powi(n - 1))
    }
    fn powf(self, e: Self) -> Self {
        let value = self.value.powf(e.value);
        let slope = e.value * self.value.powf(e.value - 1.0);
        let log = if e.derivative == 0.0 { 0.0 } else { e.derivative * value * self.value.ln() };
        Dual { value, derivative: slope * self.derivative + log }
    }
    fn floor(self) -> Self {
        Dual::constant(self.value.floor())
    }
    fn abs(self) -> Self {
        if self.value < 0.0 { -self } else { self }
    }
    fn min(self, o: Self) -> Self {
        if self.value < o.value { self } else { o }
    }
    fn max(self, o: Self) -> Self {
        if self.value < o.value { o } else { self }
    }
    fn select(c: Comparison, l: Self, r: Self, then: Self, otherwise: Self) -> Self {
        if f64::select(c, l.value, r.value, 1.0, 0.0) == 1.0 { then } else { otherwise }
    }
}
