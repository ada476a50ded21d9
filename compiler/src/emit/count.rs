//! How many operations a piece of code executes.

use super::code::{Expression, Statement};
use crate::graph::Unary;
use std::fmt;
use std::ops::AddAssign;

/// Counts by kind. Negations are free: they vanish into the operation beside them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// Sums and differences.
    pub additions: usize,
    /// Products.
    pub products: usize,
    /// Products fused with a sum; each counts as two operations.
    pub fused: usize,
    /// Divisions.
    pub divisions: usize,
    /// Square roots.
    pub roots: usize,
    /// Sines, cosines or both of one angle.
    pub angles: usize,
    /// Everything else: choices, exponentials, ….
    pub others: usize,
}

impl Operations {
    /// Counts statements.
    pub fn of(statements: &[Statement]) -> Operations {
        let mut counts = Operations::default();
        for statement in statements {
            match statement {
                Statement::SinCos(..) => counts.angles += 1,
                Statement::SqrtRecip(..) => {
                    counts.roots += 1;
                    counts.divisions += 1;
                }
                Statement::Let(..) | Statement::Store(..) => {}
            }
            statement.expression().walk(&mut |expression| counts.add(expression));
        }
        counts
    }

    /// All of them, a fused product and sum as two.
    pub fn total(&self) -> usize {
        self.additions
            + self.products
            + 2 * self.fused
            + self.divisions
            + self.roots
            + self.angles
            + self.others
    }

    fn add(&mut self, expression: &Expression) {
        match expression {
            Expression::Constant(_)
            | Expression::Leaf(_)
            | Expression::Variable(_)
            | Expression::Neg(_) => {}
            Expression::Add(_) | Expression::Sub(_) => self.additions += 1,
            Expression::Mul(_) => self.products += 1,
            Expression::Div(_) => self.divisions += 1,
            Expression::Fused(..) => self.fused += 1,
            Expression::Call(Unary::Sqrt, _) => self.roots += 1,
            Expression::Call(Unary::Sin | Unary::Cos, _) => self.angles += 1,
            _ => self.others += 1,
        }
    }
}

impl AddAssign for Operations {
    fn add_assign(&mut self, other: Operations) {
        self.additions += other.additions;
        self.products += other.products;
        self.fused += other.fused;
        self.divisions += other.divisions;
        self.roots += other.roots;
        self.angles += other.angles;
        self.others += other.others;
    }
}

impl fmt::Display for Operations {
    /// `57 operations: 12 sums, 21 products, 11 fused, 1 division, 1 root, …`, zeros left out.
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        let total = self.total();
        write!(formatter, "{total} operation{}", if total == 1 { "" } else { "s" })?;
        let kinds = [
            (self.additions, "sum", "sums"),
            (self.products, "product", "products"),
            (self.fused, "product with sum", "products with sum"),
            (self.divisions, "division", "divisions"),
            (self.roots, "root", "roots"),
            (self.angles, "sine and cosine", "sines and cosines"),
            (self.others, "other", "others"),
        ];
        let mut separator = ": ";
        for (count, one, many) in kinds {
            if count > 0 {
                write!(formatter, "{separator}{count} {}", if count == 1 { one } else { many })?;
                separator = ", ";
            }
        }
        Ok(())
    }
}
