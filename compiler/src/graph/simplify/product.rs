//! Products, reciprocals and quotients.

use super::sum::negate;
use super::{constant, folded, negated, ordered, value};
use crate::graph::arena::Graph;
use crate::graph::node::{Binary, Node, Unary};
use crate::graph::symbol::Sym;

/// a·b.
pub(super) fn multiply(graph: &mut Graph, a: Sym, b: Sym) -> Sym {
    // Constants to the left.
    let (a, b) = if value(graph, b).is_some() { (b, a) } else { (a, b) };
    // Signs to the front.
    match (negated(graph, a), negated(graph, b)) {
        (Some(x), Some(y)) => return multiply(graph, x, y),
        (Some(x), None) => {
            let product = multiply(graph, x, b);
            return negate(graph, product);
        }
        (None, Some(y)) => {
            let product = multiply(graph, a, y);
            return negate(graph, product);
        }
        (None, None) => {}
    }
    match value(graph, a) {
        Some(factor) => scale(graph, a, factor, b),
        None => {
            let (a, b) = ordered(a, b);
            graph.intern(Node::Binary(Binary::Mul, a, b))
        }
    }
}

/// The constant `factor`, whose handle is `a`, times b, which is no negation.
fn scale(graph: &mut Graph, a: Sym, factor: f64, b: Sym) -> Sym {
    if factor == 0.0 {
        return a;
    }
    if factor == 1.0 {
        return b;
    }
    match graph.node(b) {
        Node::Constant(bits) => {
            if let Some(product) = folded(graph, factor * f64::from_bits(bits)) {
                return product;
            }
        }
        Node::Binary(Binary::Mul, x, y) => {
            if let Some(x) = value(graph, x)
                && let Some(product) = folded(graph, factor * x)
            {
                return multiply(graph, product, y);
            }
        }
        _ => {}
    }
    if factor < 0.0 {
        let positive = constant(graph, -factor);
        let product = scale(graph, positive, -factor, b);
        return negate(graph, product);
    }
    graph.intern(Node::Binary(Binary::Mul, a, b))
}

/// 1/a.
pub(super) fn reciprocal(graph: &mut Graph, a: Sym) -> Sym {
    match graph.node(a) {
        Node::Constant(bits) => {
            if let Some(reciprocal) = folded(graph, 1.0 / f64::from_bits(bits)) {
                return reciprocal;
            }
        }
        Node::Unary(Unary::Neg, inner) => {
            let positive = reciprocal(graph, inner);
            return negate(graph, positive);
        }
        Node::Unary(Unary::Recip, inner) => return inner,
        // 1/(c·x) = (1/c)·(1/x), since 1/x is likely shared.
        Node::Binary(Binary::Mul, x, y) => {
            if let Some(x) = value(graph, x)
                && let Some(factor) = folded(graph, 1.0 / x)
            {
                let rest = reciprocal(graph, y);
                return multiply(graph, factor, rest);
            }
        }
        _ => {}
    }
    graph.intern(Node::Unary(Unary::Recip, a))
}

/// a/b as a product with the reciprocal.
pub(in crate::graph) fn quotient(graph: &mut Graph, a: Sym, b: Sym) -> Sym {
    // Two constants divide exactly, without the rounding of the reciprocal.
    if let (Some(x), Some(y)) = (value(graph, a), value(graph, b))
        && let Some(result) = folded(graph, x / y)
    {
        return result;
    }
    let reciprocal = reciprocal(graph, b);
    multiply(graph, a, reciprocal)
}
