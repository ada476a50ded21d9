//! Making nodes in their simplest form.
//!
//! Rules look at a node and its operands' operands only, so that each costs constant time and
//! recursion stays shallow. The normal form: constants to the left of sums and products, factors
//! positive with the sign in front, no negation below a sum or difference, no division.
//!
//! Constants are folded only to finite values: what overflows or is undefined is left for run
//! time to meet. The rules x·0 → 0 and x − x → 0 hold for finite x, and are what makes the sparsity
//! of a mechanism visible.

mod function;
mod product;
mod sum;

use super::arena::Graph;
use super::node::{Binary, Node, Unary};
use super::symbol::Sym;
pub(super) use function::{apply_binary, apply_unary, power, select};
pub(super) use product::quotient;

/// The node of a constant; the sign of zero is dropped.
pub(super) fn constant(graph: &mut Graph, value: f64) -> Sym {
    graph.intern(Node::constant(if value == 0.0 { 0.0 } else { value }))
}

/// The constant `value` if it is finite.
fn folded(graph: &mut Graph, value: f64) -> Option<Sym> {
    value.is_finite().then(|| constant(graph, value))
}

/// The value of a constant operand.
fn value(graph: &Graph, symbol: Sym) -> Option<f64> {
    graph.node(symbol).as_constant()
}

/// The operand of a negation.
fn negated(graph: &Graph, symbol: Sym) -> Option<Sym> {
    match graph.node(symbol) {
        Node::Unary(Unary::Neg, inner) => Some(inner),
        _ => None,
    }
}

/// Two operands in the one order in which they are kept.
fn ordered(a: Sym, b: Sym) -> (Sym, Sym) {
    if a.index() <= b.index() { (a, b) } else { (b, a) }
}

/// A function of one operand.
pub(super) fn unary(graph: &mut Graph, function: Unary, a: Sym) -> Sym {
    match function {
        Unary::Neg => sum::negate(graph, a),
        Unary::Recip => product::reciprocal(graph, a),
        _ => function::unary(graph, function, a),
    }
}

/// A function of two operands.
pub(super) fn binary(graph: &mut Graph, function: Binary, a: Sym, b: Sym) -> Sym {
    match function {
        Binary::Add => sum::add(graph, a, b),
        Binary::Sub => sum::subtract(graph, a, b),
        Binary::Mul => product::multiply(graph, a, b),
        Binary::Powf => function::real_power(graph, a, b),
        Binary::Atan2 | Binary::Min | Binary::Max => function::binary(graph, function, a, b),
    }
}
