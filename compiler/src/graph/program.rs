//! From symbols to programs, the form in which expressions are kept in a mechanism.

use super::arena::node;
use super::node::{Binary, Leaf, Node, Unary};
use super::symbol::Sym;
use handc_core::scalar::Comparison;
use handc_runtime::expression::{Operation, Program, Variable};
use std::collections::HashMap;

/// The nodes that `outputs` depend on and themselves, ascending, so operands before uses.
pub fn reachable(outputs: &[Sym]) -> Vec<Sym> {
    let end = outputs.iter().map(|symbol| symbol.index() + 1).max().unwrap_or(0);
    let mut seen = vec![false; end];
    let mut found = Vec::new();
    let mut open: Vec<Sym> = outputs.to_vec();
    while let Some(symbol) = open.pop() {
        if !std::mem::replace(&mut seen[symbol.index()], true) {
            found.push(symbol);
            open.extend(node(symbol).operands());
        }
    }
    found.sort_unstable_by_key(|symbol| symbol.index());
    found
}

/// The leaves that `outputs` depend on, ascending.
pub fn leaves(outputs: &[Sym]) -> Vec<Leaf> {
    let mut found: Vec<Leaf> = reachable(outputs)
        .into_iter()
        .filter_map(|symbol| match node(symbol) {
            Node::Leaf(leaf) => Some(leaf),
            _ => None,
        })
        .collect();
    found.sort_unstable();
    found
}

/// The variable of a leaf; natural lengths, the step and tables of constants have none.
pub fn variable(leaf: Leaf) -> Option<Variable> {
    Some(match leaf {
        Leaf::Q(i) => Variable::Coordinate(i),
        Leaf::V(i) => Variable::Rate(i),
        Leaf::Param(i) => Variable::Param(i),
        Leaf::Input(i) => Variable::Input(i),
        Leaf::Time => Variable::Time,
        Leaf::Lambda(i) => Variable::Multiplier(i),
        Leaf::Length(i) => Variable::Length(i),
        Leaf::Own(own) => Variable::Own(own),
        Leaf::Strand(quantity, i) => Variable::Strand(quantity, i),
        Leaf::Rest(_) | Leaf::Step | Leaf::Value(_) | Leaf::Constant(_) | Leaf::System(..) => {
            return None;
        }
    })
}

/// The leaf of a variable, the inverse of [`variable`].
pub fn leaf(variable: Variable) -> Leaf {
    match variable {
        Variable::Coordinate(i) => Leaf::Q(i),
        Variable::Rate(i) => Leaf::V(i),
        Variable::Param(i) => Leaf::Param(i),
        Variable::Input(i) => Leaf::Input(i),
        Variable::Time => Leaf::Time,
        Variable::Multiplier(i) => Leaf::Lambda(i),
        Variable::Length(i) => Leaf::Length(i),
        Variable::Own(own) => Leaf::Own(own),
        Variable::Strand(quantity, i) => Leaf::Strand(quantity, i),
    }
}

/// The program that computes `outputs`, without what they do not need.
///
/// # Panics
/// If an output depends on a leaf that no expression of a model can mention, see [`variable`].
pub fn to_program(outputs: &[Sym]) -> Program {
    let mut place: HashMap<Sym, u32> = HashMap::new();
    let mut operations = Vec::new();
    for symbol in reachable(outputs) {
        let at = |operand: Sym| place[&operand];
        let operation = match node(symbol) {
            Node::Constant(bits) => Operation::Constant(f64::from_bits(bits)),
            Node::Leaf(leaf) => match variable(leaf) {
                Some(variable) => Operation::Read(variable),
                None => panic!("an expression cannot read {leaf:?}"),
            },
            Node::Unary(function, a) => unary(function, at(a)),
            Node::Binary(function, a, b) => binary(function, at(a), at(b)),
            Node::Power(a, exponent) => Operation::Powi(at(a), exponent),
            Node::Select(comparison, [left, right, then, otherwise]) => {
                let (a, b, x, y) = (at(left), at(right), at(then), at(otherwise));
                match comparison {
                    Comparison::Less => Operation::IfLess(a, b, x, y),
                    Comparison::LessEqual => Operation::IfLessEqual(a, b, x, y),
                    Comparison::Equal => Operation::IfEqual(a, b, x, y),
                }
            }
        };
        place.insert(symbol, operations.len() as u32);
        operations.push(operation);
    }
    Program { operations, outputs: outputs.iter().map(|symbol| place[symbol]).collect() }
}

fn unary(function: Unary, a: u32) -> Operation {
    match function {
        Unary::Neg => Operation::Neg(a),
        // The power −1 is the reciprocal, exactly rounded, and needs no constant.
        Unary::Recip => Operation::Powi(a, -1),
        Unary::Sqrt => Operation::Sqrt(a),
        Unary::Sin => Operation::Sin(a),
        Unary::Cos => Operation::Cos(a),
        Unary::Tan => Operation::Tan(a),
        Unary::Asin => Operation::Asin(a),
        Unary::Acos => Operation::Acos(a),
        Unary::Atan => Operation::Atan(a),
        Unary::Exp => Operation::Exp(a),
        Unary::Log => Operation::Log(a),
        Unary::Floor => Operation::Floor(a),
        Unary::Abs => Operation::Abs(a),
    }
}

fn binary(function: Binary, a: u32, b: u32) -> Operation {
    match function {
        Binary::Add => Operation::Add(a, b),
        Binary::Sub => Operation::Sub(a, b),
        Binary::Mul => Operation::Mul(a, b),
        Binary::Powf => Operation::Powf(a, b),
        Binary::Atan2 => Operation::Atan2(a, b),
        Binary::Min => Operation::Min(a, b),
        Binary::Max => Operation::Max(a, b),
    }
}
