//! Powers, elementary functions and choices.

use super::product::{multiply, reciprocal};
use super::sum::negate;
use super::{constant, folded, ordered, value};
use crate::graph::arena::Graph;
use crate::graph::node::{Binary, Node, Unary};
use crate::graph::symbol::Sym;
use handc_core::scalar::{Comparison, Scalar};

/// Powers up to this are expanded into products.
const LARGEST_EXPANDED_POWER: u32 = 16;

/// Elementary functions of one operand.
pub(super) fn unary(graph: &mut Graph, function: Unary, a: Sym) -> Sym {
    if let Some(x) = value(graph, a)
        && let Some(result) = folded(graph, apply_unary(function, x))
    {
        return result;
    }
    match (function, graph.node(a)) {
        (Unary::Cos | Unary::Abs, Node::Unary(Unary::Neg, inner)) => unary(graph, function, inner),
        (Unary::Sin | Unary::Tan | Unary::Atan | Unary::Asin, Node::Unary(Unary::Neg, inner)) => {
            let positive = unary(graph, function, inner);
            negate(graph, positive)
        }
        // √(x·x) = |x|, the length of a vector along an axis.
        (Unary::Sqrt, Node::Binary(Binary::Mul, x, y)) if x == y => unary(graph, Unary::Abs, x),
        (Unary::Abs, Node::Unary(Unary::Abs | Unary::Sqrt, _))
        | (Unary::Floor, Node::Unary(Unary::Floor, _)) => a,
        _ => graph.intern(Node::Unary(function, a)),
    }
}

/// The function on numbers, exactly as at run time.
pub(in crate::graph) fn apply_unary(function: Unary, x: f64) -> f64 {
    match function {
        Unary::Neg => -x,
        Unary::Recip => Scalar::recip(x),
        Unary::Sqrt => Scalar::sqrt(x),
        Unary::Sin => Scalar::sin_cos(x).0,
        Unary::Cos => Scalar::sin_cos(x).1,
        Unary::Tan => Scalar::tan(x),
        Unary::Asin => Scalar::asin(x),
        Unary::Acos => Scalar::acos(x),
        Unary::Atan => Scalar::atan(x),
        Unary::Exp => Scalar::exp(x),
        Unary::Log => Scalar::log(x),
        Unary::Floor => Scalar::floor(x),
        Unary::Abs => Scalar::abs(x),
    }
}

/// As [`apply_unary`] for two operands.
pub(in crate::graph) fn apply_binary(function: Binary, x: f64, y: f64) -> f64 {
    match function {
        Binary::Add => x + y,
        Binary::Sub => x - y,
        Binary::Mul => x * y,
        Binary::Powf => Scalar::powf(x, y),
        Binary::Atan2 => Scalar::atan2(x, y),
        Binary::Min => Scalar::min(x, y),
        Binary::Max => Scalar::max(x, y),
    }
}

/// Atan2, min and max.
pub(super) fn binary(graph: &mut Graph, function: Binary, a: Sym, b: Sym) -> Sym {
    if let (Some(x), Some(y)) = (value(graph, a), value(graph, b)) {
        let result = apply_binary(function, x, y);
        if let Some(result) = folded(graph, result) {
            return result;
        }
    }
    match function {
        Binary::Min | Binary::Max if a == b => a,
        Binary::Min | Binary::Max => {
            let (a, b) = ordered(a, b);
            graph.intern(Node::Binary(function, a, b))
        }
        _ => graph.intern(Node::Binary(function, a, b)),
    }
}

/// aᵇ.
pub(super) fn real_power(graph: &mut Graph, a: Sym, b: Sym) -> Sym {
    if let Some(exponent) = value(graph, b) {
        if let Some(x) = value(graph, a)
            && let Some(result) = folded(graph, x.powf(exponent))
        {
            return result;
        }
        if exponent == 0.5 {
            return unary(graph, Unary::Sqrt, a);
        }
        if exponent.fract() == 0.0 && exponent.abs() <= f64::from(LARGEST_EXPANDED_POWER) {
            return power(graph, a, exponent as i32);
        }
    }
    graph.intern(Node::Binary(Binary::Powf, a, b))
}

/// aⁿ; small powers become products by repeated squaring.
pub(in crate::graph) fn power(graph: &mut Graph, a: Sym, exponent: i32) -> Sym {
    if exponent == 0 {
        return constant(graph, 1.0);
    }
    if let Some(x) = value(graph, a)
        && let Some(result) = folded(graph, x.powi(exponent))
    {
        return result;
    }
    let magnitude = exponent.unsigned_abs();
    if magnitude > LARGEST_EXPANDED_POWER {
        return graph.intern(Node::Power(a, exponent));
    }
    let mut result = None;
    let mut square = a;
    let mut rest = magnitude;
    while rest > 0 {
        if rest & 1 == 1 {
            result = Some(match result {
                Some(product) => multiply(graph, product, square),
                None => square,
            });
        }
        rest >>= 1;
        if rest > 0 {
            square = multiply(graph, square, square);
        }
    }
    let positive = result.unwrap_or(a);
    if exponent < 0 { reciprocal(graph, positive) } else { positive }
}

/// A choice by comparison; decided here if both sides are constants or both branches are equal.
pub(in crate::graph) fn select(graph: &mut Graph, comparison: Comparison, of: [Sym; 4]) -> Sym {
    let [left, right, then, otherwise] = of;
    if then == otherwise {
        return then;
    }
    if let (Some(x), Some(y)) = (value(graph, left), value(graph, right)) {
        let holds = f64::select(comparison, x, y, 1.0, 0.0) == 1.0;
        return if holds { then } else { otherwise };
    }
    graph.intern(Node::Select(comparison, of))
}
