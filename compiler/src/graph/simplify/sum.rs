//! Sums, differences and negations.

use super::product::multiply;
use super::{constant, folded, negated, ordered, value};
use crate::graph::arena::Graph;
use crate::graph::node::{Binary, Node, Unary};
use crate::graph::symbol::Sym;

/// −a. The negation of a difference stays in front of it, so that a − b and b − a share a node.
pub(super) fn negate(graph: &mut Graph, a: Sym) -> Sym {
    match graph.node(a) {
        Node::Constant(bits) => constant(graph, -f64::from_bits(bits)),
        Node::Unary(Unary::Neg, inner) => inner,
        // −(c + x) = −c − x and −(c − x) = −c + x.
        Node::Binary(function @ (Binary::Add | Binary::Sub), x, y) if value(graph, x).is_some() => {
            let minus = negate(graph, x);
            match function {
                Binary::Add => subtract(graph, minus, y),
                _ => add(graph, minus, y),
            }
        }
        _ => graph.intern(Node::Unary(Unary::Neg, a)),
    }
}

/// A term as factor times rest: c·x, −x or x.
fn term(graph: &Graph, a: Sym) -> (f64, Sym) {
    match graph.node(a) {
        Node::Unary(Unary::Neg, inner) => {
            let (factor, rest) = term(graph, inner);
            (-factor, rest)
        }
        Node::Binary(Binary::Mul, x, y) => match value(graph, x) {
            Some(factor) => (factor, y),
            None => (1.0, a),
        },
        _ => (1.0, a),
    }
}

/// a + b.
pub(super) fn add(graph: &mut Graph, a: Sym, b: Sym) -> Sym {
    // Constants to the left.
    let (a, b) = if value(graph, b).is_some() { (b, a) } else { (a, b) };
    if let Some(x) = value(graph, a) {
        if x == 0.0 {
            return b;
        }
        return add_constant(graph, a, x, b);
    }
    match (negated(graph, a), negated(graph, b)) {
        (Some(x), Some(y)) => {
            let sum = add(graph, x, y);
            return negate(graph, sum);
        }
        (None, Some(y)) => return subtract(graph, a, y),
        (Some(x), None) => return subtract(graph, b, x),
        (None, None) => {}
    }
    if let Some(merged) = merge_terms(graph, a, b, 1.0) {
        return merged;
    }
    // (x − b) + b = x and a + (x − a) = x.
    if let Node::Binary(Binary::Sub, x, y) = graph.node(a)
        && y == b
    {
        return x;
    }
    if let Node::Binary(Binary::Sub, x, y) = graph.node(b)
        && y == a
    {
        return x;
    }
    if is_circle(graph, a, b) {
        return constant(graph, 1.0);
    }
    if let Some(factored) = factored(graph, a, b, 1.0) {
        return factored;
    }
    let (a, b) = ordered(a, b);
    graph.intern(Node::Binary(Binary::Add, a, b))
}

/// The constant x, whose handle is `a`, plus b.
fn add_constant(graph: &mut Graph, a: Sym, x: f64, b: Sym) -> Sym {
    match graph.node(b) {
        Node::Constant(bits) => {
            if let Some(sum) = folded(graph, x + f64::from_bits(bits)) {
                return sum;
            }
        }
        Node::Unary(Unary::Neg, inner) => return subtract(graph, a, inner),
        Node::Binary(function @ (Binary::Add | Binary::Sub), y, z) => {
            if let Some(y) = value(graph, y)
                && let Some(sum) = folded(graph, x + y)
            {
                return match function {
                    Binary::Add => add(graph, sum, z),
                    _ => subtract(graph, sum, z),
                };
            }
        }
        _ => {}
    }
    graph.intern(Node::Binary(Binary::Add, a, b))
}

/// a − b.
pub(super) fn subtract(graph: &mut Graph, a: Sym, b: Sym) -> Sym {
    if a == b {
        return constant(graph, 0.0);
    }
    if let Some(y) = value(graph, b) {
        let minus = constant(graph, -y);
        return add(graph, minus, a);
    }
    if let Some(y) = negated(graph, b) {
        return add(graph, a, y);
    }
    if let Some(x) = value(graph, a) {
        if x == 0.0 {
            return negate(graph, b);
        }
        // c − (d ± y) = (c − d) ∓ y.
        if let Node::Binary(function @ (Binary::Add | Binary::Sub), y, z) = graph.node(b)
            && let Some(y) = value(graph, y)
            && let Some(rest) = folded(graph, x - y)
        {
            return match function {
                Binary::Add => subtract(graph, rest, z),
                _ => add(graph, rest, z),
            };
        }
        return graph.intern(Node::Binary(Binary::Sub, a, b));
    }
    if let Some(x) = negated(graph, a) {
        let sum = add(graph, x, b);
        return negate(graph, sum);
    }
    if let Some(merged) = merge_terms(graph, a, b, -1.0) {
        return merged;
    }
    if let Some(rest) = cancelled(graph, a, b) {
        return rest;
    }
    if let Some(factored) = factored(graph, a, b, -1.0) {
        return factored;
    }
    // a − b where b − a exists: share it.
    if graph.find(&Node::Binary(Binary::Sub, b, a)).is_some() {
        let other = graph.intern(Node::Binary(Binary::Sub, b, a));
        return graph.intern(Node::Unary(Unary::Neg, other));
    }
    graph.intern(Node::Binary(Binary::Sub, a, b))
}

/// a − b where one contains the other: (x + b) − b, (x − y) − x, a − (a + y), a − (a − y).
fn cancelled(graph: &mut Graph, a: Sym, b: Sym) -> Option<Sym> {
    match graph.node(a) {
        Node::Binary(Binary::Add, x, y) if y == b => return Some(x),
        Node::Binary(Binary::Add, x, y) if x == b => return Some(y),
        Node::Binary(Binary::Sub, x, y) if x == b => return Some(negate(graph, y)),
        _ => {}
    }
    match graph.node(b) {
        Node::Binary(Binary::Add, x, y) if x == a => Some(negate(graph, y)),
        Node::Binary(Binary::Add, x, y) if y == a => Some(negate(graph, x)),
        Node::Binary(Binary::Sub, x, y) if x == a => Some(y),
        _ => None,
    }
}

/// c·x ± d·x = (c ± d)·x.
fn merge_terms(graph: &mut Graph, a: Sym, b: Sym, sign: f64) -> Option<Sym> {
    let ((c, x), (d, y)) = (term(graph, a), term(graph, b));
    if x != y {
        return None;
    }
    let factor = folded(graph, c + sign * d)?;
    Some(multiply(graph, factor, x))
}

/// f·x ± f·y = f·(x ± y) where x ± y is something that exists already: x + (z − x) = z, and the like.
fn factored(graph: &mut Graph, a: Sym, b: Sym, sign: f64) -> Option<Sym> {
    let (Node::Binary(Binary::Mul, a0, a1), Node::Binary(Binary::Mul, b0, b1)) =
        (graph.node(a), graph.node(b))
    else {
        return None;
    };
    let pairs = [(a0, a1, b0, b1), (a0, a1, b1, b0), (a1, a0, b0, b1), (a1, a0, b1, b0)];
    for (factor, x, other, y) in pairs {
        if factor != other {
            continue;
        }
        let rest = match (sign > 0.0, graph.node(x), graph.node(y)) {
            (true, Node::Binary(Binary::Sub, z, less), _) if less == y => Some(z),
            (true, _, Node::Binary(Binary::Sub, z, less)) if less == x => Some(z),
            (false, ..) => cancelled(graph, x, y),
            _ => None,
        };
        if let Some(rest) = rest {
            return Some(multiply(graph, factor, rest));
        }
    }
    None
}

/// Whether a + b is sin² + cos² of one angle.
fn is_circle(graph: &Graph, a: Sym, b: Sym) -> bool {
    let square = |s: Sym| match graph.node(s) {
        Node::Binary(Binary::Mul, x, y) if x == y => Some(graph.node(x)),
        _ => None,
    };
    matches!(
        (square(a), square(b)),
        (Some(Node::Unary(Unary::Sin, x)), Some(Node::Unary(Unary::Cos, y)))
        | (Some(Node::Unary(Unary::Cos, x)), Some(Node::Unary(Unary::Sin, y))) if x == y
    )
}
