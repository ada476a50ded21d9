//! What a function of the state is made of: the variables it reads, and its slopes where they are
//! constant.

use super::Exporter;
use handc_runtime::expression::{Function, Operation, Program, Variable};
use std::collections::BTreeSet;

/// A function that is affine in the state.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Affine {
    /// Value where every coordinate, rate and length is zero, at the start's time and inputs.
    pub(super) constant: f64,
    /// Whether that value depends on time or inputs.
    pub(super) varies: bool,
    /// The slopes that are not zero.
    pub(super) slopes: Vec<(Variable, f64)>,
}

/// Variables that an output of a program depends on.
pub(super) fn reads(program: &Program, output: usize) -> BTreeSet<Variable> {
    let mut seen = vec![false; program.operations.len()];
    let mut found = BTreeSet::new();
    // An explicit stack: sums can be long.
    let mut open = vec![program.outputs[output]];
    while let Some(index) = open.pop() {
        if std::mem::replace(&mut seen[index as usize], true) {
            continue;
        }
        match program.operations[index as usize] {
            Operation::Constant(_) => {}
            Operation::Read(variable) => {
                found.insert(variable);
            }
            Operation::Neg(a)
            | Operation::Powi(a, _)
            | Operation::Sin(a)
            | Operation::Cos(a)
            | Operation::Tan(a)
            | Operation::Asin(a)
            | Operation::Acos(a)
            | Operation::Atan(a)
            | Operation::Sqrt(a)
            | Operation::Exp(a)
            | Operation::Log(a)
            | Operation::Abs(a)
            | Operation::Floor(a) => open.push(a),
            Operation::Add(a, b)
            | Operation::Sub(a, b)
            | Operation::Mul(a, b)
            | Operation::Div(a, b)
            | Operation::Powf(a, b)
            | Operation::Atan2(a, b)
            | Operation::Min(a, b)
            | Operation::Max(a, b) => open.extend([a, b]),
            Operation::IfLess(a, b, c, d)
            | Operation::IfLessEqual(a, b, c, d)
            | Operation::IfEqual(a, b, c, d) => open.extend([a, b, c, d]),
        }
    }
    found
}

fn is_state(variable: &Variable) -> bool {
    !matches!(variable, Variable::Param(_) | Variable::Time | Variable::Input(_))
}

/// Whether an expression changes in time or with an input.
pub(super) fn varies(variables: &BTreeSet<Variable>) -> bool {
    variables.iter().any(|v| matches!(v, Variable::Time | Variable::Input(_)))
}

impl Exporter<'_> {
    /// The function as an affine one, if that is what it is.
    pub(super) fn affine(&self, function: &Function) -> Option<Affine> {
        let read = reads(&function.program, 0);
        let has_slope = |v: &Variable| function.gradient.contains(v);
        if !read.iter().filter(|v| is_state(v)).all(has_slope) {
            return None;
        }
        let mut slopes = Vec::new();
        for (index, &variable) in function.gradient.iter().enumerate() {
            let read = reads(&function.program, 1 + index);
            if read.iter().any(|v| !matches!(v, Variable::Param(_))) {
                return None;
            }
            slopes.push((variable, self.at_zero(function, 1 + index)));
        }
        slopes.retain(|(_, slope)| *slope != 0.0);
        Some(Affine { constant: self.at_zero(function, 0), varies: varies(&read), slopes })
    }

    /// An output at the start's time and inputs, with zero for the state.
    fn at_zero(&self, function: &Function, output: usize) -> f64 {
        self.evaluate(function, output, |_| 0.0)
    }

    /// The value at the start.
    pub(super) fn at_start(&self, function: &Function) -> f64 {
        self.evaluate(function, 0, |variable| match variable {
            Variable::Coordinate(i) => self.start.q[i as usize],
            Variable::Rate(i) => self.start.v[i as usize],
            Variable::Length(i) => self.start.lengths[i as usize],
            _ => 0.0,
        })
    }

    fn evaluate(&self, f: &Function, output: usize, state: impl Fn(Variable) -> f64) -> f64 {
        let mut values = Vec::new();
        let read = |variable| match variable {
            Variable::Time => 0.0,
            Variable::Param(i) => self.numbers.params[i as usize],
            Variable::Input(i) => self.start.inputs[i as usize],
            other => state(other),
        };
        f.program.evaluate(read, &mut values);
        f.program.output(&values, output)
    }
}
