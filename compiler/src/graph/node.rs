//! The kinds of nodes.

use super::symbol::Sym;
use handc_core::scalar::Comparison;
use handc_runtime::expression::{Own, StrandQuantity};

/// A number that the graph does not know: what generated code reads from its arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Leaf {
    /// A coordinate by index (rad or m).
    Q(u32),
    /// The rate of a coordinate (rad/s or m/s).
    V(u32),
    /// A parameter by index.
    Param(u32),
    /// An input by index.
    Input(u32),
    /// The natural length of a strand by index (m).
    Rest(u32),
    /// Time (s).
    Time,
    /// The step h (s).
    Step,
    /// The multiplier of a constraint row by index.
    Lambda(u32),
    /// A number that depends on parameters alone, kept by index.
    Value(u32),
    /// An entry of the table of constants by which like blocks differ.
    Constant(u32),
    /// An element of an array of a linear system.
    System(SystemArray, u32),
    /// The length of a strand by index (m), opaque: for expressions that mention it.
    Length(u32),
    /// What the strand whose law mentions it does, opaque as [`Leaf::Length`].
    Own(Own),
    /// What a strand by index does, opaque as [`Leaf::Length`].
    Strand(StrandQuantity, u32),
}

/// What the code of a linear system reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum SystemArray {
    /// The packed Newton matrix.
    Matrix,
    /// The packed constraint Jacobian at the beginning of the step.
    Before,
    /// That at its end.
    After,
    /// Sizes of the coordinates.
    Size,
    /// Factors made before.
    Factors,
    /// Residuals of the coordinates.
    Residual,
    /// Gaps of the rows.
    Gaps,
    /// By how much the momentum changes with the step.
    Momentum,
    /// A step that was found.
    Step,
}

impl SystemArray {
    /// Its name as an argument.
    pub fn name(self) -> &'static str {
        match self {
            SystemArray::Matrix => "matrix",
            SystemArray::Before => "before",
            SystemArray::After => "after",
            SystemArray::Size => "size",
            SystemArray::Factors => "factors",
            SystemArray::Residual => "residual",
            SystemArray::Gaps => "gaps",
            SystemArray::Momentum => "momentum_matrix",
            SystemArray::Step => "step",
        }
    }
}

/// Functions of one operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs)]
pub enum Unary {
    Neg,
    Recip,
    Sqrt,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Exp,
    Log,
    Floor,
    Abs,
}

/// Functions of two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs)]
pub enum Binary {
    Add,
    Sub,
    Mul,
    /// Real power.
    Powf,
    /// Angle of the point (x = second, y = first).
    Atan2,
    Min,
    Max,
}

/// A node; its operands were made before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Node {
    /// A finite or non-finite constant, by its bits so that nodes can be compared and hashed.
    Constant(u64),
    /// An unknown.
    Leaf(Leaf),
    /// A function of one operand.
    Unary(Unary, Sym),
    /// A function of two operands.
    Binary(Binary, Sym, Sym),
    /// An integer power that was too large to expand.
    Power(Sym, i32),
    /// Left, right, then, otherwise.
    Select(Comparison, [Sym; 4]),
}

impl Node {
    /// The node of a constant.
    pub fn constant(value: f64) -> Node {
        Node::Constant(value.to_bits())
    }

    /// The value, if it is a constant.
    pub fn as_constant(self) -> Option<f64> {
        match self {
            Node::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    /// The operands in order.
    pub fn operands(&self) -> impl DoubleEndedIterator<Item = Sym> + use<> {
        let (list, count) = match *self {
            Node::Constant(_) | Node::Leaf(_) => ([Sym::NONE; 4], 0),
            Node::Unary(_, a) | Node::Power(a, _) => ([a, Sym::NONE, Sym::NONE, Sym::NONE], 1),
            Node::Binary(_, a, b) => ([a, b, Sym::NONE, Sym::NONE], 2),
            Node::Select(_, four) => (four, 4),
        };
        list.into_iter().take(count)
    }
}
