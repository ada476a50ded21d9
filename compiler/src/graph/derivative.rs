//! Derivatives on the graph.
//!
//! Reverse accumulation: the derivative of the output with respect to every node between it and
//! the leaves, from the output down. One pass gives the whole gradient, and factors that are common
//! to several entries are shared nodes.

use super::arena::node;
use super::node::{Binary, Node, Unary};
use super::program::reachable;
use super::symbol::Sym;
use handc_core::scalar::{Comparison, Scalar};
use std::collections::HashMap;

/// The derivative of `output` with respect to the node `with_respect_to`, usually a leaf.
///
/// A choice differentiates its branches; `floor` and the conditions of choices have derivative
/// zero.
pub fn differentiate(output: Sym, with_respect_to: Sym) -> Sym {
    gradient(output, &[with_respect_to])[0]
}

/// The derivatives of `output` with respect to each of `variables`.
pub fn gradient(output: Sym, variables: &[Sym]) -> Vec<Sym> {
    let nodes = reachable(&[output]);
    // Only nodes above a variable matter; the others would leave dead products behind.
    let mut matters = HashMap::new();
    for &symbol in &nodes {
        let above =
            variables.contains(&symbol) || node(symbol).operands().any(|operand| matters[&operand]);
        matters.insert(symbol, above);
    }
    let mut adjoints: HashMap<Sym, Sym> = HashMap::new();
    adjoints.insert(output, Sym::one());
    for &symbol in nodes.iter().rev() {
        let Some(&adjoint) = adjoints.get(&symbol) else { continue };
        if variables.contains(&symbol) {
            continue;
        }
        let wanted = |operand: Sym| matters[&operand];
        for (operand, contribution) in contributions(symbol, adjoint, wanted) {
            let sum = match adjoints.get(&operand) {
                Some(&former) => former + contribution,
                None => contribution,
            };
            adjoints.insert(operand, sum);
        }
    }
    variables.iter().map(|v| adjoints.get(v).copied().unwrap_or_else(Sym::zero)).collect()
}

/// What a node hands to each wanted operand: its adjoint times the partial derivative.
fn contributions(symbol: Sym, adjoint: Sym, wanted: impl Fn(Sym) -> bool) -> Vec<(Sym, Sym)> {
    let mut list = Vec::new();
    let mut give = |operand: Sym, value: &dyn Fn() -> Sym| {
        if wanted(operand) {
            list.push((operand, value()));
        }
    };
    match node(symbol) {
        Node::Constant(_) => {}
        Node::Leaf(_) => {}
        Node::Unary(function, a) => give(a, &|| adjoint * unary_derivative(function, a, symbol)),
        Node::Power(a, n) => give(a, &|| (adjoint * a.powi(n - 1)).scale(f64::from(n))),
        Node::Binary(function, a, b) => match function {
            Binary::Add => {
                give(a, &|| adjoint);
                give(b, &|| adjoint);
            }
            Binary::Sub => {
                give(a, &|| adjoint);
                give(b, &|| -adjoint);
            }
            Binary::Mul => {
                give(a, &|| adjoint * b);
                give(b, &|| adjoint * a);
            }
            Binary::Powf => {
                give(a, &|| adjoint * b * a.powf(b - Sym::one()));
                give(b, &|| adjoint * symbol * a.log());
            }
            Binary::Atan2 => {
                let over = || (a * a + b * b).recip();
                give(a, &|| adjoint * b * over());
                give(b, &|| -(adjoint * a * over()));
            }
            // As `if a < b { a } else { b }` and its mirror.
            Binary::Min => {
                give(a, &|| choose(Comparison::Less, a, b, adjoint, Sym::zero()));
                give(b, &|| choose(Comparison::Less, a, b, Sym::zero(), adjoint));
            }
            Binary::Max => {
                give(a, &|| choose(Comparison::Less, a, b, Sym::zero(), adjoint));
                give(b, &|| choose(Comparison::Less, a, b, adjoint, Sym::zero()));
            }
        },
        Node::Select(comparison, [left, right, then, otherwise]) => {
            give(then, &|| choose(comparison, left, right, adjoint, Sym::zero()));
            give(otherwise, &|| choose(comparison, left, right, Sym::zero(), adjoint));
        }
    }
    list
}

fn choose(comparison: Comparison, left: Sym, right: Sym, then: Sym, otherwise: Sym) -> Sym {
    Sym::select(comparison, left, right, then, otherwise)
}

/// f'(a), where `value` is f(a).
fn unary_derivative(function: Unary, a: Sym, value: Sym) -> Sym {
    let one = Sym::one();
    match function {
        Unary::Neg => -one,
        Unary::Recip => -(value * value),
        Unary::Sqrt => value.recip().scale(0.5),
        Unary::Sin => a.sin_cos().1,
        Unary::Cos => -a.sin_cos().0,
        Unary::Tan => one + value * value,
        Unary::Asin => (one - a * a).sqrt().recip(),
        Unary::Acos => -(one - a * a).sqrt().recip(),
        Unary::Atan => (one + a * a).recip(),
        Unary::Exp => value,
        Unary::Log => a.recip(),
        Unary::Floor => Sym::zero(),
        Unary::Abs => choose(Comparison::Less, a, Sym::zero(), -one, one),
    }
}
