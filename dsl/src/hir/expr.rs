//! Expressions of a checked model.

use super::{ConstraintId, CoordinateId, InputId, ParamId, StrandId};
use crate::dimension::Dimension;
use crate::source::Span;
use serde::Serialize;

/// A checked expression. Its value is in SI units of `dimension`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Expr {
    /// What it computes.
    pub kind: ExprKind,
    /// Its dimension; angles are dimensionless.
    pub dimension: Dimension,
    /// The text it came from.
    pub span: Span,
}

/// The forms of an expression.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum ExprKind {
    /// A constant in SI units.
    Number(f64),
    /// A model parameter.
    Param(ParamId),
    /// An external input.
    Input(InputId),
    /// Time.
    Time,
    /// A joint coordinate.
    Coordinate(CoordinateId),
    /// Time derivative of a coordinate, `rate(J)`.
    Rate(CoordinateId),
    /// Length of a strand, `length(S)`.
    Length(StrandId),
    /// What the strand whose law this is does: `x`, `x0`, `rate(x)`.
    Own(Own),
    /// What a strand does at an instant: `tension(S)` and the like; only in `record`.
    Strand(StrandQuantity, StrandId),
    /// Multiplier of one row of a constraint, `lambda.C.x`; only in `record`.
    Multiplier(ConstraintId, u32),
    /// Negation.
    Neg(Box<Expr>),
    /// `+ - * / ^`.
    Binary(BinaryOp, Box<Expr>, Box<Expr>),
    /// A function of one to five arguments.
    Call(Function, Vec<Expr>),
    /// `if(left OP right, then, otherwise)`.
    If {
        /// The comparison.
        compare: Compare,
        /// Its left side.
        left: Box<Expr>,
        /// Its right side.
        right: Box<Expr>,
        /// Value where it holds.
        then: Box<Expr>,
        /// Value where it does not.
        otherwise: Box<Expr>,
    },
}

impl Expr {
    /// The first part of the expression, itself included, for whose kind `wanted` holds.
    pub fn find(&self, wanted: &impl Fn(&ExprKind) -> bool) -> Option<&Expr> {
        if wanted(&self.kind) {
            return Some(self);
        }
        match &self.kind {
            ExprKind::Neg(inner) => inner.find(wanted),
            ExprKind::Binary(_, left, right) => left.find(wanted).or_else(|| right.find(wanted)),
            ExprKind::Call(_, arguments) => arguments.iter().find_map(|a| a.find(wanted)),
            ExprKind::If { left, right, then, otherwise, .. } => {
                [left, right, then, otherwise].into_iter().find_map(|e| e.find(wanted))
            }
            _ => None,
        }
    }
}

/// What a strand's own law may read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Own {
    /// Its length `x`.
    Length,
    /// Its natural length `x0`.
    Rest,
    /// The rate of its length, `rate(x)`.
    Rate,
}

/// What a recorded column may read of a strand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum StrandQuantity {
    /// `rate(S)`: the rate of its length.
    Rate,
    /// `tension(S)`.
    Tension,
    /// `taut(S)`: 1 where it pulls, 0 where it is slack.
    Taut,
    /// `dissipation(S)`: the power that its damping takes.
    Dissipation,
    /// `fibre_length(S)` of a muscle.
    FibreLength,
    /// `fibre_force(S)` of a muscle, along its fibres.
    FibreForce,
    /// `fibre_power(S)`: the power that the active fibres of a muscle give.
    FibrePower,
}

/// Arithmetic on two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[allow(missing_docs)]
pub enum BinaryOp {
    Add,
    Sub,
    Mul,
    Div,
    /// Power; the exponent of a quantity with a dimension is a constant integer (or a half).
    Pow,
}

/// Comparisons of `if`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[allow(missing_docs)]
pub enum Compare {
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Equal,
    NotEqual,
}

/// The functions of the language.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[allow(missing_docs)]
pub enum Function {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    /// `atan2(y, x)`.
    Atan2,
    Sqrt,
    Exp,
    Log,
    Abs,
    Min,
    Max,
    Floor,
    /// `clamp(x, lo, hi)`.
    Clamp,
    /// `smoothstep(a, b, x)`: 0 below a, 1 above b, 3s² − 2s³ between.
    Smoothstep,
    /// `ease(t0, t1, a, b)`: half-cosine in time from a at t0 to b at t1, constant outside.
    Ease,
}

/// Three expressions, a vector in some frame.
pub type Vector = [Expr; 3];
