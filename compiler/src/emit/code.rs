//! Straight-line code: statements over variables, with no syntax yet.

use crate::graph::{Leaf, Sym, Unary};
use handc_core::scalar::Comparison;

/// Where a result goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// An element of an array argument.
    Element {
        /// Name of the argument.
        array: &'static str,
        /// Which element.
        index: usize,
    },
    /// The function's value; the only output of its function.
    Return,
}

/// A result: where it goes, what it is, and the label of what is made for it alone.
#[derive(Clone, Debug)]
pub struct Output {
    /// Where it goes.
    pub place: Place,
    /// What it is.
    pub value: Sym,
    /// Names the variables that have no origin of their own, e.g. `index.mcp`.
    pub label: String,
}

/// An expression; `Variable` refers to a statement before it.
#[derive(Clone, Debug, PartialEq)]
pub enum Expression {
    /// A constant.
    Constant(f64),
    /// An unknown, read from an argument.
    Leaf(Leaf),
    /// The value of an earlier statement.
    Variable(Sym),
    /// −a.
    Neg(Box<Expression>),
    /// a + b.
    Add(Box<[Expression; 2]>),
    /// a − b.
    Sub(Box<[Expression; 2]>),
    /// a·b.
    Mul(Box<[Expression; 2]>),
    /// a/b.
    Div(Box<[Expression; 2]>),
    /// a·b + c, −a·b + c or a·b − c with one rounding where the machine can.
    Fused(Fused, Box<[Expression; 3]>),
    /// A function of one operand other than negation and reciprocal.
    Call(Unary, Box<Expression>),
    /// Real power.
    Powf(Box<[Expression; 2]>),
    /// Angle of the point (x = second, y = first).
    Atan2(Box<[Expression; 2]>),
    /// The smaller.
    Min(Box<[Expression; 2]>),
    /// The larger.
    Max(Box<[Expression; 2]>),
    /// Integer power.
    Powi(Box<Expression>, i32),
    /// Left, right, then, otherwise.
    Select(Comparison, Box<[Expression; 4]>),
}

/// The signs of a product fused with a sum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fused {
    /// a·b + c.
    MulAdd,
    /// a·b − c.
    MulSub,
    /// c − a·b.
    NegMulAdd,
}

/// A statement.
#[derive(Clone, Debug, PartialEq)]
pub enum Statement {
    /// A variable for a node.
    Let(Sym, Expression),
    /// Sine and cosine of one angle at once.
    SinCos(Sym, Sym, Expression),
    /// Square root and its reciprocal at once.
    SqrtRecip(Sym, Sym, Expression),
    /// Output by number.
    Store(usize, Expression),
}

impl Expression {
    /// The operands in order.
    pub fn operands(&self) -> &[Expression] {
        match self {
            Expression::Constant(_) | Expression::Leaf(_) | Expression::Variable(_) => &[],
            Expression::Neg(a) | Expression::Call(_, a) | Expression::Powi(a, _) => {
                std::slice::from_ref(a)
            }
            Expression::Add(two)
            | Expression::Sub(two)
            | Expression::Mul(two)
            | Expression::Div(two)
            | Expression::Powf(two)
            | Expression::Atan2(two)
            | Expression::Min(two)
            | Expression::Max(two) => two.as_slice(),
            Expression::Fused(_, three) => three.as_slice(),
            Expression::Select(_, four) => four.as_slice(),
        }
    }

    /// Calls `visit` on every expression inside, this one included.
    pub fn walk(&self, visit: &mut impl FnMut(&Expression)) {
        visit(self);
        for operand in self.operands() {
            operand.walk(visit);
        }
    }
}

impl Statement {
    /// Its right-hand side.
    pub fn expression(&self) -> &Expression {
        match self {
            Statement::Let(_, e)
            | Statement::SinCos(_, _, e)
            | Statement::SqrtRecip(_, _, e)
            | Statement::Store(_, e) => e,
        }
    }

    /// The variables it makes.
    pub fn defines(&self) -> impl Iterator<Item = Sym> + use<> {
        let two = match self {
            Statement::Let(a, _) => [Some(*a), None],
            Statement::SinCos(a, b, _) | Statement::SqrtRecip(a, b, _) => [Some(*a), Some(*b)],
            Statement::Store(..) => [None, None],
        };
        two.into_iter().flatten()
    }

    /// The variables it reads, possibly more than once.
    pub fn reads(&self) -> Vec<Sym> {
        let mut found = Vec::new();
        self.expression().walk(&mut |e| {
            if let Expression::Variable(symbol) = e {
                found.push(*symbol);
            }
        });
        found
    }
}
