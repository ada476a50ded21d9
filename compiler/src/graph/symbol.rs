//! The handle, and its arithmetic.

use super::arena;
use super::node::{Binary, Leaf, Node, Unary};
use super::simplify;
use handc_core::scalar::{Comparison, Scalar};
use std::fmt;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A handle to a node of the current thread's graph.
///
/// It has no `Ord`, whose `min` and `max` would shadow those of `Scalar`; order by [`Sym::index`].
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Sym(u32);

impl Sym {
    /// Fills unused operand places.
    pub(super) const NONE: Sym = Sym(u32::MAX);

    pub(super) fn new(index: usize) -> Sym {
        Sym(index as u32)
    }

    /// Position in the graph: ascending positions are a topological order.
    pub fn index(self) -> usize {
        self.0 as usize
    }

    /// The unknown `leaf`.
    pub fn leaf(leaf: Leaf) -> Sym {
        arena::with(|graph| graph.intern(Node::Leaf(leaf)))
    }

    /// The value, if it is a constant.
    pub fn as_constant(self) -> Option<f64> {
        arena::node(self).as_constant()
    }

    fn unary(self, function: Unary) -> Sym {
        arena::with(|graph| simplify::unary(graph, function, self))
    }

    fn binary(self, function: Binary, other: Sym) -> Sym {
        arena::with(|graph| simplify::binary(graph, function, self, other))
    }
}

impl fmt::Debug for Sym {
    /// The node alone, since whole expressions can be huge.
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        write!(formatter, "s{}", self.0)
    }
}

impl Add for Sym {
    type Output = Sym;
    fn add(self, other: Sym) -> Sym {
        self.binary(Binary::Add, other)
    }
}

impl Sub for Sym {
    type Output = Sym;
    fn sub(self, other: Sym) -> Sym {
        self.binary(Binary::Sub, other)
    }
}

impl Mul for Sym {
    type Output = Sym;
    fn mul(self, other: Sym) -> Sym {
        self.binary(Binary::Mul, other)
    }
}

impl Div for Sym {
    type Output = Sym;
    fn div(self, other: Sym) -> Sym {
        arena::with(|graph| simplify::quotient(graph, self, other))
    }
}

impl Neg for Sym {
    type Output = Sym;
    fn neg(self) -> Sym {
        self.unary(Unary::Neg)
    }
}

impl AddAssign for Sym {
    fn add_assign(&mut self, other: Sym) {
        *self = *self + other;
    }
}

impl SubAssign for Sym {
    fn sub_assign(&mut self, other: Sym) {
        *self = *self - other;
    }
}

impl Scalar for Sym {
    fn constant(value: f64) -> Self {
        arena::with(|graph| simplify::constant(graph, value))
    }
    fn sin_cos(self) -> (Self, Self) {
        (self.unary(Unary::Sin), self.unary(Unary::Cos))
    }
    fn sqrt(self) -> Self {
        self.unary(Unary::Sqrt)
    }
    fn recip(self) -> Self {
        self.unary(Unary::Recip)
    }
    fn exp(self) -> Self {
        self.unary(Unary::Exp)
    }
    fn log(self) -> Self {
        self.unary(Unary::Log)
    }
    fn tan(self) -> Self {
        self.unary(Unary::Tan)
    }
    fn asin(self) -> Self {
        self.unary(Unary::Asin)
    }
    fn acos(self) -> Self {
        self.unary(Unary::Acos)
    }
    fn atan(self) -> Self {
        self.unary(Unary::Atan)
    }
    fn atan2(self, x: Self) -> Self {
        self.binary(Binary::Atan2, x)
    }
    fn powi(self, exponent: i32) -> Self {
        arena::with(|graph| simplify::power(graph, self, exponent))
    }
    fn powf(self, exponent: Self) -> Self {
        self.binary(Binary::Powf, exponent)
    }
    fn floor(self) -> Self {
        self.unary(Unary::Floor)
    }
    fn abs(self) -> Self {
        self.unary(Unary::Abs)
    }
    fn min(self, other: Self) -> Self {
        self.binary(Binary::Min, other)
    }
    fn max(self, other: Self) -> Self {
        self.binary(Binary::Max, other)
    }
    fn select(
        comparison: Comparison,
        left: Self,
        right: Self,
        then: Self,
        otherwise: Self,
    ) -> Self {
        arena::with(|graph| simplify::select(graph, comparison, [left, right, then, otherwise]))
    }
    fn is_known_zero(self) -> bool {
        self.as_constant() == Some(0.0)
    }
}
