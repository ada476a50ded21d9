//! Replacing nodes inside expressions.

use super::arena::node;
use super::node::{Binary, Node, Unary};
use super::program::reachable;
use super::symbol::Sym;
use handc_core::scalar::Scalar;
use std::collections::HashMap;

/// `outputs` with every node that is a key of `replacements` replaced, rebuilt through the same
/// simplifications.
pub fn substitute(outputs: &[Sym], replacements: &HashMap<Sym, Sym>) -> Vec<Sym> {
    let mut rebuilt: HashMap<Sym, Sym> = HashMap::new();
    for symbol in reachable(outputs) {
        let new = match replacements.get(&symbol) {
            Some(&replacement) => replacement,
            None => rebuild(symbol, |operand| rebuilt[&operand]),
        };
        rebuilt.insert(symbol, new);
    }
    outputs.iter().map(|output| rebuilt[output]).collect()
}

fn rebuild(symbol: Sym, of: impl Fn(Sym) -> Sym) -> Sym {
    let of_this = node(symbol);
    if of_this.operands().all(|operand| of(operand) == operand) {
        return symbol;
    }
    match of_this {
        Node::Constant(_) | Node::Leaf(_) => symbol,
        Node::Power(a, exponent) => of(a).powi(exponent),
        Node::Select(comparison, [left, right, then, otherwise]) => {
            Sym::select(comparison, of(left), of(right), of(then), of(otherwise))
        }
        Node::Unary(function, a) => rebuild_unary(function, of(a)),
        Node::Binary(function, a, b) => rebuild_binary(function, of(a), of(b)),
    }
}

/// The function of one operand.
pub fn rebuild_unary(function: Unary, a: Sym) -> Sym {
    match function {
        Unary::Neg => -a,
        Unary::Recip => a.recip(),
        Unary::Sqrt => a.sqrt(),
        Unary::Sin => a.sin_cos().0,
        Unary::Cos => a.sin_cos().1,
        Unary::Tan => a.tan(),
        Unary::Asin => a.asin(),
        Unary::Acos => a.acos(),
        Unary::Atan => a.atan(),
        Unary::Exp => a.exp(),
        Unary::Log => a.log(),
        Unary::Floor => a.floor(),
        Unary::Abs => a.abs(),
    }
}

/// The function of two operands.
pub fn rebuild_binary(function: Binary, a: Sym, b: Sym) -> Sym {
    match function {
        Binary::Add => a + b,
        Binary::Sub => a - b,
        Binary::Mul => a * b,
        Binary::Powf => a.powf(b),
        Binary::Atan2 => a.atan2(b),
        Binary::Min => a.min(b),
        Binary::Max => a.max(b),
    }
}
