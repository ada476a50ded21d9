//! Expressions of the model as data: a straight-line program over named variables.
//!
//! The compiler folds, differentiates and flattens the text's expressions into these; the
//! interpreter evaluates them over `f64`, the compiler's staging over symbols. Derivatives are not
//! computed here: a [`Function`] carries them as further outputs of its program, so that every
//! scalar type gets exact ones.

use handc_core::scalar::{Comparison, Scalar};
#[cfg(feature = "serde")]
use serde::{Deserialize, Serialize};

/// What an expression may read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub enum Variable {
    /// Time (s).
    Time,
    /// A run-time parameter by index.
    Param(u32),
    /// An external input by index.
    Input(u32),
    /// A coordinate by index (rad or m).
    Coordinate(u32),
    /// The rate of a coordinate (rad/s or m/s).
    Rate(u32),
    /// The length of a strand by index (m).
    Length(u32),
    /// The multiplier of a constraint row by index (an impulse).
    Multiplier(u32),
    /// What the strand whose law reads it does.
    Own(Own),
    /// What a strand by index does at an instant; only recorded columns read it.
    Strand(StrandQuantity, u32),
}

/// What a strand's own law may read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub enum Own {
    /// Its length x (m).
    Length,
    /// Its natural length x₀ (m).
    Rest,
    /// Its rate ẋ (m/s).
    Rate,
}

/// What a strand does at an instant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub enum StrandQuantity {
    /// Rate of its length ẋ (m/s).
    Rate,
    /// Its tension (N), of law and damping together.
    Tension,
    /// 1 where it pulls, 0 where it is slack, between them within the width of slack.
    Taut,
    /// Power that its damping takes (W), that of a muscle's fibres included.
    Dissipation,
    /// Length of a muscle's fibres (m).
    FibreLength,
    /// Force of a muscle's fibres along themselves (N).
    FibreForce,
    /// Power that a muscle's active fibres give (W).
    FibrePower,
}

impl StrandQuantity {
    /// How many there are.
    pub const COUNT: usize = 7;
}

/// What a strand does at an instant, by [`StrandQuantity`].
pub type StrandState<S> = [S; StrandQuantity::COUNT];

/// One operation; operands are positions of earlier operations in the same program.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[allow(missing_docs)]
pub enum Operation {
    Constant(f64),
    Read(Variable),
    Neg(u32),
    Add(u32, u32),
    Sub(u32, u32),
    Mul(u32, u32),
    Div(u32, u32),
    Powi(u32, i32),
    Powf(u32, u32),
    Sin(u32),
    Cos(u32),
    Tan(u32),
    Asin(u32),
    Acos(u32),
    Atan(u32),
    Atan2(u32, u32),
    Sqrt(u32),
    Exp(u32),
    Log(u32),
    Abs(u32),
    Min(u32, u32),
    Max(u32, u32),
    Floor(u32),
    /// `if left < right { then } else { otherwise }`.
    IfLess(u32, u32, u32, u32),
    /// `if left <= right { then } else { otherwise }`.
    IfLessEqual(u32, u32, u32, u32),
    /// `if left == right { then } else { otherwise }`.
    IfEqual(u32, u32, u32, u32),
}

/// A straight-line program with one or more outputs.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub struct Program {
    /// Operations, operands before uses.
    pub operations: Vec<Operation>,
    /// Which operations are the results.
    pub outputs: Vec<u32>,
}

impl Program {
    /// Whether it reads time or inputs.
    pub fn varies(&self) -> bool {
        self.operations.iter().any(|operation| {
            matches!(operation, Operation::Read(Variable::Time | Variable::Input(_)))
        })
    }

    /// Evaluates every operation in turn; `values` is scratch and holds all of them afterwards.
    pub fn evaluate<S: Scalar>(&self, read: impl Fn(Variable) -> S, values: &mut Vec<S>) {
        values.clear();
        values.reserve(self.operations.len());
        for operation in &self.operations {
            let at = |index: u32| values[index as usize];
            let value = match *operation {
                Operation::Constant(value) => S::constant(value),
                Operation::Read(variable) => read(variable),
                Operation::Neg(a) => -at(a),
                Operation::Add(a, b) => at(a) + at(b),
                Operation::Sub(a, b) => at(a) - at(b),
                Operation::Mul(a, b) => at(a) * at(b),
                Operation::Div(a, b) => at(a) / at(b),
                Operation::Powi(a, n) => at(a).powi(n),
                Operation::Powf(a, b) => at(a).powf(at(b)),
                Operation::Sin(a) => at(a).sin_cos().0,
                Operation::Cos(a) => at(a).sin_cos().1,
                Operation::Tan(a) => at(a).tan(),
                Operation::Asin(a) => at(a).asin(),
                Operation::Acos(a) => at(a).acos(),
                Operation::Atan(a) => at(a).atan(),
                Operation::Atan2(a, b) => at(a).atan2(at(b)),
                Operation::Sqrt(a) => at(a).sqrt(),
                Operation::Exp(a) => at(a).exp(),
                Operation::Log(a) => at(a).log(),
                Operation::Abs(a) => at(a).abs(),
                Operation::Min(a, b) => at(a).min(at(b)),
                Operation::Max(a, b) => at(a).max(at(b)),
                Operation::Floor(a) => at(a).floor(),
                Operation::IfLess(a, b, x, y) => {
                    S::select(Comparison::Less, at(a), at(b), at(x), at(y))
                }
                Operation::IfLessEqual(a, b, x, y) => {
                    S::select(Comparison::LessEqual, at(a), at(b), at(x), at(y))
                }
                Operation::IfEqual(a, b, x, y) => {
                    S::select(Comparison::Equal, at(a), at(b), at(x), at(y))
                }
            };
            values.push(value);
        }
    }

    /// The `index`-th result after [`Program::evaluate`].
    pub fn output<S: Scalar>(&self, values: &[S], index: usize) -> S {
        values[self.outputs[index] as usize]
    }

    /// Evaluates and returns the first result.
    pub fn value<S: Scalar>(&self, read: impl Fn(Variable) -> S) -> S {
        let mut values = Vec::new();
        self.evaluate(read, &mut values);
        self.output(&values, 0)
    }

    /// The variables it reads, each once, in order of first use.
    pub fn variables(&self) -> Vec<Variable> {
        let mut found = Vec::new();
        for operation in &self.operations {
            if let Operation::Read(variable) = operation
                && !found.contains(variable)
            {
                found.push(*variable);
            }
        }
        found
    }
}

/// A scalar function of the state with its first derivatives.
///
/// Output 0 of `program` is the value; output 1 + i is the derivative with respect to
/// `gradient[i]`, a coordinate, a rate or a strand length.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub struct Function {
    /// Value and derivatives.
    pub program: Program,
    /// The variables of the derivatives, in output order.
    pub gradient: Vec<Variable>,
}
