//! The graph on numbers: what tests and dumps compare with.

use super::arena::node;
use super::node::{Leaf, Node};
use super::program::reachable;
use super::simplify::{apply_binary, apply_unary};
use super::symbol::Sym;
use handc_core::scalar::Scalar;
use std::collections::HashMap;

/// The values of `outputs` where `read` gives the unknowns.
pub fn evaluate(outputs: &[Sym], read: impl Fn(Leaf) -> f64) -> Vec<f64> {
    let mut values: HashMap<Sym, f64> = HashMap::new();
    for symbol in reachable(outputs) {
        let at = |operand: Sym| values[&operand];
        let value = match node(symbol) {
            Node::Constant(bits) => f64::from_bits(bits),
            Node::Leaf(leaf) => read(leaf),
            Node::Unary(function, a) => apply_unary(function, at(a)),
            Node::Binary(function, a, b) => apply_binary(function, at(a), at(b)),
            Node::Power(a, exponent) => at(a).powi(exponent),
            Node::Select(comparison, [left, right, then, otherwise]) => {
                f64::select(comparison, at(left), at(right), at(then), at(otherwise))
            }
        };
        values.insert(symbol, value);
    }
    outputs.iter().map(|output| values[output]).collect()
}
