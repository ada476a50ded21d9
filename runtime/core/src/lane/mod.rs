//! Numbers side by side: one `f64`, or four or eight in a vector register.
//!
//! Equations that a model repeats, and runs that go side by side, are computed on the lanes of a
//! vector. The code is written once, generic over [`Lane`]. Which width runs is decided when the
//! program runs, by asking the processor, so that one program is right everywhere and fast where it
//! can be.
//!
//! The one place with `unsafe`: a vector's instructions exist only on processors that have them, so
//! the types are private to this crate and every value of them lives within [`call`], which asks the
//! processor first.

mod arc;
#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod exponential;
mod machine;
#[cfg(target_arch = "x86_64")]
mod root;
mod sine;
pub(crate) mod sweep;
#[cfg(target_arch = "x86_64")]
mod vector;
pub use machine::use_at_most;
pub(crate) use machine::{available, call};

use std::ops::{Add, Div, Mul, Neg, Sub};

mod sealed {
    /// Only this crate makes lanes: the vector type is sound only behind a question to the processor.
    pub trait Sealed {}
    impl Sealed for f64 {}
}

/// Lanes of the widest vector.
pub(crate) const WIDEST: usize = 8;

/// Something to be done with as many lanes as the processor has.
pub(crate) trait Work {
    /// Does it. To be inlined: only inside [`call`] is code made of the vector's instructions.
    fn run<L: Lane>(self);
}

/// A number in every lane.
pub trait Lane:
    sealed::Sealed
    + Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// How many lanes.
    const WIDTH: usize;

    /// The same number in every lane.
    fn splat(x: f64) -> Self;
    /// Lane by lane.
    fn from_lanes(of: impl Fn(usize) -> f64) -> Self;
    /// The first `WIDTH` numbers of `from`.
    fn load(from: &[f64]) -> Self;
    /// Writes the lanes to the first `WIDTH` numbers of `to`.
    fn store(self, to: &mut [f64]);
    /// The number of one lane.
    fn lane(self, index: usize) -> f64;
    /// self·b + c, with one rounding where the machine can.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// self·b − c, as [`Lane::mul_add`].
    fn mul_sub(self, b: Self, c: Self) -> Self;
    /// c − self·b, as [`Lane::mul_add`].
    fn neg_mul_add(self, b: Self, c: Self) -> Self;
    /// Square root, within one unit in the last place. A vector may answer NaN for what is infinite.
    fn sqrt(self) -> Self;
    /// Square root and 1 over it, as [`Lane::sqrt`]; the reciprocal of the root of zero is infinite.
    #[inline(always)]
    fn sqrt_recip(self) -> (Self, Self) {
        let root = self.sqrt();
        (root, Self::splat(1.0) / root)
    }
    /// 1 over it, to 26 bits at least: for what steers and does not enter results.
    #[inline(always)]
    fn rough_recip(self) -> Self {
        Self::splat(1.0) / self
    }
    /// Absolute value.
    fn abs(self) -> Self;
    /// The smaller of two.
    fn min(self, other: Self) -> Self;
    /// The larger of two; the second where either is not a number.
    fn max(self, other: Self) -> Self;
    /// Which lanes are below those of `other`, as bits; a lane that is not a number is not.
    fn less(self, other: Self) -> u8;
    /// As [`Lane::less`], or equal.
    fn less_equal(self, other: Self) -> u8;
    /// Which lanes equal those of `other`, as bits.
    fn equal(self, other: Self) -> u8;
    /// `then` in the lanes whose bit is set, else `otherwise`.
    fn choose(bits: u8, then: Self, otherwise: Self) -> Self;
    /// `then` where this is less than `right`, else `otherwise`.
    #[inline(always)]
    fn if_less(left: Self, right: Self, then: Self, otherwise: Self) -> Self {
        Self::choose(left.less(right), then, otherwise)
    }
    /// As [`Lane::if_less`], or equal.
    #[inline(always)]
    fn if_less_equal(left: Self, right: Self, then: Self, otherwise: Self) -> Self {
        Self::choose(left.less_equal(right), then, otherwise)
    }
    /// The absolute value with the sign of `other`, that of zero too.
    fn with_sign_of(self, other: Self) -> Self;
    /// Sine and cosine in the quadrant that the low bits of `shifted` count.
    fn turn(shifted: Self, sine: Self, cosine: Self) -> (Self, Self);

    /// x times two to the power that the low bits of `shifted` count.
    fn exponent(shifted: Self, x: Self) -> Self;
    /// Exponential, within one unit in the last place; on lanes that of ±700 for what is beyond.
    #[inline(always)]
    fn exp(self) -> Self {
        // In this order what is not a number stays so.
        let bounded = Self::splat(exponential::LARGEST).min(self);
        exponential::reduced(Self::splat(-exponential::LARGEST).max(bounded))
    }

    /// The function of every lane.
    #[inline(always)]
    fn map(self, function: impl Fn(f64) -> f64) -> Self {
        Self::from_lanes(|i| function(self.lane(i)))
    }
    /// The function of every pair of lanes.
    #[inline(always)]
    fn map_two(self, other: Self, function: impl Fn(f64, f64) -> f64) -> Self {
        Self::from_lanes(|i| function(self.lane(i), other.lane(i)))
    }
    /// Sine and cosine (rad), each within one unit in the last place, one and a half beyond ten
    /// radians. A vector answers NaN where the angle is beyond [`sine::LARGEST_ANGLE`]: a call of the
    /// library amid the equations would cost every value that waits in a register.
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        sine::reduced(self)
    }
    /// Angle of the point (x = `x`, y = `self`) (rad), within two units in the last place.
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        arc::angle(self, x)
    }
    /// Bits of all lanes.
    const ALL: u8 = ((1u16 << Self::WIDTH) - 1) as u8;
}

/// The first numbers of a list, each in all lanes.
#[inline(always)]
pub(crate) fn load<L: Lane, const N: usize>(list: &[f64]) -> [L; N] {
    let list = &list[..N * L::WIDTH];
    let mut all = [L::splat(0.0); N];
    for i in 0..N {
        all[i] = L::load(&list[i * L::WIDTH..]);
    }
    all
}

/// The other way.
#[inline(always)]
pub(crate) fn store<L: Lane, const N: usize>(all: &[L; N], list: &mut [f64]) {
    let list = &mut list[..N * L::WIDTH];
    for i in 0..N {
        all[i].store(&mut list[i * L::WIDTH..]);
    }
}

impl Lane for f64 {
    const WIDTH: usize = 1;

    #[inline(always)]
    fn splat(x: f64) -> f64 {
        x
    }
    #[inline(always)]
    fn from_lanes(of: impl Fn(usize) -> f64) -> f64 {
        of(0)
    }
    #[inline(always)]
    fn load(from: &[f64]) -> f64 {
        from[0]
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        to[0] = self;
    }
    #[inline(always)]
    fn lane(self, _index: usize) -> f64 {
        self
    }
    #[inline(always)]
    fn mul_add(self, b: f64, c: f64) -> f64 {
        if cfg!(target_feature = "fma") { f64::mul_add(self, b, c) } else { self * b + c }
    }
    #[inline(always)]
    fn mul_sub(self, b: f64, c: f64) -> f64 {
        if cfg!(target_feature = "fma") { f64::mul_add(self, b, -c) } else { self * b - c }
    }
    #[inline(always)]
    fn neg_mul_add(self, b: f64, c: f64) -> f64 {
        if cfg!(target_feature = "fma") { f64::mul_add(-self, b, c) } else { c - self * b }
    }
    #[inline(always)]
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> f64 {
        f64::abs(self)
    }
    #[inline(always)]
    fn min(self, other: f64) -> f64 {
        if self < other { self } else { other }
    }
    #[inline(always)]
    fn max(self, other: f64) -> f64 {
        if self > other { self } else { other }
    }
    #[inline(always)]
    fn less(self, other: f64) -> u8 {
        u8::from(self < other)
    }
    #[inline(always)]
    fn less_equal(self, other: f64) -> u8 {
        u8::from(self <= other)
    }
    #[inline(always)]
    fn equal(self, other: f64) -> u8 {
        u8::from(self == other)
    }
    #[inline(always)]
    fn choose(bits: u8, then: f64, otherwise: f64) -> f64 {
        if bits & 1 == 1 { then } else { otherwise }
    }
    #[inline(always)]
    fn with_sign_of(self, other: f64) -> f64 {
        self.copysign(other)
    }
    #[inline(always)]
    fn sin_cos(self) -> (f64, f64) {
        match self.abs() <= sine::LARGEST_ANGLE {
            true => sine::reduced(self),
            false => (self.sin(), self.cos()),
        }
    }
    #[inline(always)]
    fn turn(shifted: f64, sine: f64, cosine: f64) -> (f64, f64) {
        let quadrant = shifted.to_bits();
        let flip = |x: f64, second_bit: u64| f64::from_bits(x.to_bits() ^ (second_bit << 62));
        let (a, b) = if quadrant & 1 == 0 { (sine, cosine) } else { (cosine, sine) };
        (flip(a, quadrant & 2), flip(b, quadrant.wrapping_add(1) & 2))
    }
    #[inline(always)]
    fn exponent(shifted: f64, x: f64) -> f64 {
        f64::from_bits(x.to_bits().wrapping_add(shifted.to_bits() << 52))
    }
    #[inline(always)]
    fn exp(self) -> f64 {
        match f64::abs(self) <= exponential::LARGEST {
            true => exponential::reduced(self),
            false => f64::exp(self),
        }
    }
}

/// The functions that straight-line code over lanes calls, in the manner of [`crate::math`].
pub mod functions {
    use super::Lane;

    /// a·b + c.
    #[inline(always)]
    pub fn mul_add<L: Lane>(a: L, b: L, c: L) -> L {
        a.mul_add(b, c)
    }
    /// a·b − c.
    #[inline(always)]
    pub fn mul_sub<L: Lane>(a: L, b: L, c: L) -> L {
        a.mul_sub(b, c)
    }
    /// c − a·b.
    #[inline(always)]
    pub fn neg_mul_add<L: Lane>(a: L, b: L, c: L) -> L {
        a.neg_mul_add(b, c)
    }
    /// Sine and cosine (rad).
    #[inline(always)]
    pub fn sin_cos<L: Lane>(x: L) -> (L, L) {
        x.sin_cos()
    }
    /// Sine.
    #[inline(always)]
    pub fn sin<L: Lane>(x: L) -> L {
        x.sin_cos().0
    }
    /// Cosine.
    #[inline(always)]
    pub fn cos<L: Lane>(x: L) -> L {
        x.sin_cos().1
    }
    /// Square root.
    #[inline(always)]
    pub fn sqrt<L: Lane>(x: L) -> L {
        x.sqrt()
    }
    /// Square root and 1 over it.
    #[inline(always)]
    pub fn sqrt_recip<L: Lane>(x: L) -> (L, L) {
        x.sqrt_recip()
    }
    /// Exponential.
    #[inline(always)]
    pub fn exp<L: Lane>(x: L) -> L {
        x.exp()
    }
    /// 1/x, to 26 bits at least: see [`Lane::rough_recip`].
    #[inline(always)]
    pub fn rough_recip<L: Lane>(x: L) -> L {
        x.rough_recip()
    }
    /// Absolute value.
    #[inline(always)]
    pub fn abs<L: Lane>(x: L) -> L {
        x.abs()
    }
    /// The smaller of two.
    #[inline(always)]
    pub fn min<L: Lane>(x: L, y: L) -> L {
        x.min(y)
    }
    /// The larger of two.
    #[inline(always)]
    pub fn max<L: Lane>(x: L, y: L) -> L {
        x.max(y)
    }
    /// Angle of the point (x, y).
    #[inline(always)]
    pub fn atan2<L: Lane>(y: L, x: L) -> L {
        y.atan2(x)
    }
    /// Real power.
    #[inline(always)]
    pub fn powf<L: Lane>(x: L, exponent: L) -> L {
        x.map_two(exponent, f64::powf)
    }
    /// Integer power.
    #[inline(always)]
    pub fn powi<L: Lane>(x: L, exponent: i32) -> L {
        x.map(|x| x.powi(exponent))
    }
    /// `then` if left < right, else `otherwise`.
    #[inline(always)]
    pub fn if_less<L: Lane>(left: L, right: L, then: L, otherwise: L) -> L {
        L::if_less(left, right, then, otherwise)
    }
    /// `then` if left ≤ right, else `otherwise`.
    #[inline(always)]
    pub fn if_less_equal<L: Lane>(left: L, right: L, then: L, otherwise: L) -> L {
        L::if_less_equal(left, right, then, otherwise)
    }
    /// `then` if left = right, else `otherwise`.
    #[inline(always)]
    pub fn if_equal<L: Lane>(left: L, right: L, then: L, otherwise: L) -> L {
        L::choose(left.equal(right), then, otherwise)
    }

    macro_rules! of_one {
        ($($(#[$doc:meta])* $name:ident => $method:ident;)*) => {$(
            $(#[$doc])*
            #[inline(always)]
            pub fn $name<L: Lane>(x: L) -> L {
                x.map(f64::$method)
            }
        )*};
    }

    of_one! {
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
    }
}
