//! Arithmetic on checked expressions: dimensions agree, and constants are folded.

use super::{Checker, Value, constant, number};
use crate::diagnostic::Diagnostic;
use crate::dimension::Dimension;
use crate::hir::{BinaryOp, Compare, Expr, ExprKind, Function};
use crate::source::Span;

/// Whether an expression is a zero written without a unit: it fits any dimension.
pub(super) fn bare_zero(expr: &Expr) -> bool {
    expr.dimension.is_none() && constant(expr) == Some(0.0)
}

/// Applies an operator to numbers.
pub(super) fn apply(op: BinaryOp, a: f64, b: f64) -> f64 {
    match op {
        BinaryOp::Add => a + b,
        BinaryOp::Sub => a - b,
        BinaryOp::Mul => a * b,
        BinaryOp::Div => a / b,
        BinaryOp::Pow => a.powf(b),
    }
}

/// Compares numbers.
pub(super) fn holds(compare: Compare, a: f64, b: f64) -> bool {
    match compare {
        Compare::Less => a < b,
        Compare::LessEqual => a <= b,
        Compare::Greater => a > b,
        Compare::GreaterEqual => a >= b,
        Compare::Equal => a == b,
        Compare::NotEqual => a != b,
    }
}

/// Applies a function to numbers; `ease` depends on time and gives `None`.
pub(super) fn call(function: Function, x: &[f64]) -> Option<f64> {
    let at = |i: usize| x.get(i).copied().unwrap_or(f64::NAN);
    let (a, b, c) = (at(0), at(1), at(2));
    Some(match function {
        Function::Sin => a.sin(),
        Function::Cos => a.cos(),
        Function::Tan => a.tan(),
        Function::Asin => a.asin(),
        Function::Acos => a.acos(),
        Function::Atan => a.atan(),
        Function::Atan2 => a.atan2(b),
        Function::Sqrt => a.sqrt(),
        Function::Exp => a.exp(),
        Function::Log => a.ln(),
        Function::Abs => a.abs(),
        Function::Min => a.min(b),
        Function::Max => a.max(b),
        Function::Floor => a.floor(),
        Function::Clamp => a.max(b).min(c),
        Function::Smoothstep => {
            let s = ((c - a) / (b - a)).clamp(0.0, 1.0);
            s * s * (3.0 - 2.0 * s)
        }
        Function::Ease => return None,
    })
}

impl Checker<'_> {
    /// A folded number, if it is one.
    pub(super) fn finite(&mut self, value: f64, dimension: Dimension, span: Span) -> Option<Expr> {
        if value.is_finite() {
            return Some(number(value, dimension, span));
        }
        let message = if value.is_nan() { "this is not a number" } else { "this is not finite" };
        self.report(
            Diagnostic::error("not-finite", span, message)
                .help("a constant must be a finite number of at most about 1e308"),
        );
        None
    }

    pub(super) fn negate(&mut self, operand: Expr, span: Span) -> Expr {
        match constant(&operand) {
            Some(value) => number(-value, operand.dimension, span),
            None => {
                Expr { dimension: operand.dimension, kind: ExprKind::Neg(Box::new(operand)), span }
            }
        }
    }

    /// Makes two operands that must agree agree: a bare zero takes the other's dimension.
    pub(super) fn agree(&mut self, a: &mut Expr, b: &mut Expr, doing: &str) -> Option<Dimension> {
        if a.dimension != b.dimension {
            if bare_zero(a) {
                a.dimension = b.dimension;
            } else if bare_zero(b) {
                b.dimension = a.dimension;
            } else {
                let (left, right) = (a.dimension, b.dimension);
                let message =
                    format!("cannot {doing} {} and {}", left.describe(), right.describe());
                self.report(
                    Diagnostic::error("dimension", b.span, message)
                        .label(format!("in {}", unit_words(right)))
                        .also(a.span, format!("in {}", unit_words(left))),
                );
                return None;
            }
        }
        Some(a.dimension)
    }

    pub(super) fn binary(
        &mut self,
        op: BinaryOp,
        mut a: Expr,
        mut b: Expr,
        span: Span,
    ) -> Option<Expr> {
        let dimension = match op {
            BinaryOp::Add => self.agree(&mut a, &mut b, "add")?,
            BinaryOp::Sub => self.agree(&mut a, &mut b, "subtract")?,
            BinaryOp::Mul => self.in_range(a.dimension.times(b.dimension), span)?,
            BinaryOp::Div => {
                if constant(&b) == Some(0.0) {
                    self.report(Diagnostic::error("not-finite", b.span, "division by zero"));
                    return None;
                }
                self.in_range(a.dimension.over(b.dimension), span)?
            }
            BinaryOp::Pow => self.power_dimension(&a, &b, span)?,
        };
        if let (Some(x), Some(y)) = (constant(&a), constant(&b)) {
            return self.finite(apply(op, x, y), dimension, span);
        }
        Some(Expr { kind: ExprKind::Binary(op, Box::new(a), Box::new(b)), dimension, span })
    }

    fn in_range(&mut self, dimension: Option<Dimension>, span: Span) -> Option<Dimension> {
        if dimension.is_none() {
            let message = "the powers of units grow too large here";
            self.report(Diagnostic::error("dimension", span, message));
        }
        dimension
    }

    /// A quantity with a dimension may be raised to a constant integer, or to a half where it fits.
    fn power_dimension(&mut self, a: &Expr, b: &Expr, span: Span) -> Option<Dimension> {
        if !b.dimension.is_none() {
            let message = format!("an exponent is a plain number, not {}", b.dimension.describe());
            self.report(Diagnostic::error("dimension", b.span, message));
            return None;
        }
        if a.dimension.is_none() {
            return Some(Dimension::NONE);
        }
        let Some(exponent) = constant(b) else {
            let message = format!("{} can only be raised to a constant", a.dimension.describe());
            self.report(
                Diagnostic::error("dimension", b.span, message)
                    .help("divide it by a quantity of its kind first"),
            );
            return None;
        };
        let twice = exponent * 2.0;
        let result = if twice != twice.round() || twice.abs() > 256.0 {
            None
        } else if twice as i32 % 2 == 0 {
            return self.in_range(a.dimension.power(exponent as i32), span);
        } else {
            a.dimension.power(twice as i32).and_then(Dimension::root)
        };
        if result.is_none() {
            let message = format!("{} cannot be raised to {exponent}", a.dimension.describe());
            self.report(Diagnostic::error("dimension", span, message));
        }
        result
    }

    /// Applies an operator to values: vectors add to vectors and scale by numbers.
    pub(super) fn binary_value(
        &mut self,
        op: BinaryOp,
        a: Value,
        b: Value,
        span: Span,
    ) -> Option<Value> {
        match (op, a, b) {
            (_, Value::Scalar(a), Value::Scalar(b)) => {
                self.binary(op, a, b, span).map(Value::Scalar)
            }
            (BinaryOp::Add | BinaryOp::Sub, Value::Vector(a), Value::Vector(b))
                if a.len() == b.len() =>
            {
                let sum: Vec<Option<Expr>> =
                    a.into_iter().zip(b).map(|(a, b)| self.binary(op, a, b, span)).collect();
                sum.into_iter().collect::<Option<Vec<Expr>>>().map(Value::Vector)
            }
            (BinaryOp::Mul, Value::Scalar(k), Value::Vector(v)) => {
                self.each(v, |checker, e| checker.binary(op, k.clone(), e, span))
            }
            (BinaryOp::Mul | BinaryOp::Div, Value::Vector(v), Value::Scalar(k)) => {
                self.each(v, |checker, e| checker.binary(op, e, k.clone(), span))
            }
            _ => {
                let message = "this operator does not go with these vectors";
                self.report(
                    Diagnostic::error("vector", span, message)
                        .help("vectors of one size can be added, and scaled by a number"),
                );
                None
            }
        }
    }

    pub(super) fn each(
        &mut self,
        vector: Vec<Expr>,
        mut f: impl FnMut(&mut Self, Expr) -> Option<Expr>,
    ) -> Option<Value> {
        // Every element is looked at before giving up, so that each gets its message.
        let all: Vec<Option<Expr>> = vector.into_iter().map(|e| f(self, e)).collect();
        all.into_iter().collect::<Option<Vec<Expr>>>().map(Value::Vector)
    }
}

/// `N*m`, or `no unit`.
pub(super) fn unit_words(dimension: Dimension) -> String {
    if dimension.is_none() { "no unit, or `rad`".to_string() } else { format!("`{dimension}`") }
}
