//! Expressions of the text as symbols.

use super::Lowering;
use crate::graph::{Leaf, Sym};
use handc_core::scalar::{Comparison, Scalar};
use handc_dsl::hir::{self, BinaryOp, Compare, Expr, ExprKind, Function};
use handc_runtime::expression::{Own, StrandQuantity};

impl Lowering<'_> {
    /// An expression as a symbol; everything in SI units.
    pub(super) fn expr(&self, expr: &Expr) -> Sym {
        match &expr.kind {
            ExprKind::Number(value) => Sym::constant(*value),
            ExprKind::Param(id) => Sym::leaf(Leaf::Param(id.0)),
            ExprKind::Input(id) => Sym::leaf(Leaf::Input(id.0)),
            ExprKind::Time => Sym::leaf(Leaf::Time),
            ExprKind::Coordinate(id) => Sym::leaf(Leaf::Q(id.0)),
            ExprKind::Rate(id) => Sym::leaf(Leaf::V(id.0)),
            ExprKind::Length(id) => Sym::leaf(Leaf::Length(id.0)),
            ExprKind::Own(own) => Sym::leaf(Leaf::Own(match own {
                hir::Own::Length => Own::Length,
                hir::Own::Rest => Own::Rest,
                hir::Own::Rate => Own::Rate,
            })),
            ExprKind::Strand(quantity, id) => {
                let quantity = match quantity {
                    hir::StrandQuantity::Rate => StrandQuantity::Rate,
                    hir::StrandQuantity::Tension => StrandQuantity::Tension,
                    hir::StrandQuantity::Taut => StrandQuantity::Taut,
                    hir::StrandQuantity::Dissipation => StrandQuantity::Dissipation,
                    hir::StrandQuantity::FibreLength => StrandQuantity::FibreLength,
                    hir::StrandQuantity::FibreForce => StrandQuantity::FibreForce,
                    hir::StrandQuantity::FibrePower => StrandQuantity::FibrePower,
                };
                Sym::leaf(Leaf::Strand(quantity, id.0))
            }
            ExprKind::Multiplier(id, row) => {
                Sym::leaf(Leaf::Lambda(self.first_row[id.index()] + row))
            }
            ExprKind::Neg(a) => -self.expr(a),
            ExprKind::Binary(op, a, b) => self.binary(*op, a, b),
            ExprKind::Call(function, arguments) => {
                let arguments: Vec<Sym> = arguments.iter().map(|a| self.expr(a)).collect();
                call(*function, &arguments)
            }
            ExprKind::If { compare, left, right, then, otherwise } => {
                let (a, b) = (self.expr(left), self.expr(right));
                let (x, y) = (self.expr(then), self.expr(otherwise));
                match compare {
                    Compare::Less => Sym::select(Comparison::Less, a, b, x, y),
                    Compare::LessEqual => Sym::select(Comparison::LessEqual, a, b, x, y),
                    Compare::Greater => Sym::select(Comparison::Less, b, a, x, y),
                    Compare::GreaterEqual => Sym::select(Comparison::LessEqual, b, a, x, y),
                    Compare::Equal => Sym::select(Comparison::Equal, a, b, x, y),
                    Compare::NotEqual => Sym::select(Comparison::Equal, a, b, y, x),
                }
            }
        }
    }

    fn binary(&self, op: BinaryOp, a: &Expr, b: &Expr) -> Sym {
        let (x, y) = (self.expr(a), self.expr(b));
        match op {
            BinaryOp::Add => x + y,
            BinaryOp::Sub => x - y,
            BinaryOp::Mul => x * y,
            BinaryOp::Div => x / y,
            BinaryOp::Pow => match y.as_constant() {
                Some(n) if n == n.trunc() && n.abs() <= 1024.0 => x.powi(n as i32),
                Some(0.5) => x.sqrt(),
                _ => x.powf(y),
            },
        }
    }
}

fn call(function: Function, arguments: &[Sym]) -> Sym {
    let (zero, one) = (Sym::zero(), Sym::one());
    match (function, arguments) {
        (Function::Sin, &[x]) => x.sin_cos().0,
        (Function::Cos, &[x]) => x.sin_cos().1,
        (Function::Tan, &[x]) => x.tan(),
        (Function::Asin, &[x]) => x.asin(),
        (Function::Acos, &[x]) => x.acos(),
        (Function::Atan, &[x]) => x.atan(),
        (Function::Atan2, &[y, x]) => y.atan2(x),
        (Function::Sqrt, &[x]) => x.sqrt(),
        (Function::Exp, &[x]) => x.exp(),
        (Function::Log, &[x]) => x.log(),
        (Function::Abs, &[x]) => x.abs(),
        (Function::Min, xs) => fold(xs, Sym::min),
        (Function::Max, xs) => fold(xs, Sym::max),
        (Function::Floor, &[x]) => x.floor(),
        (Function::Clamp, &[x, low, high]) => x.max(low).min(high),
        (Function::Smoothstep, &[a, b, x]) => {
            let s = ((x - a) / (b - a)).max(zero).min(one);
            s * s * (Sym::constant(3.0) - s.scale(2.0))
        }
        (Function::Ease, &[t0, t1, a, b]) => {
            let t = Sym::leaf(Leaf::Time);
            let s = ((t - t0) / (t1 - t0)).max(zero).min(one);
            let (_, cosine) = s.scale(std::f64::consts::PI).sin_cos();
            a + (b - a) * (one - cosine).scale(0.5)
        }
        // The checker has counted arguments; a wrong count yields what cannot pass for a value.
        _ => Sym::constant(f64::NAN),
    }
}

fn fold(xs: &[Sym], pick: fn(Sym, Sym) -> Sym) -> Sym {
    xs.iter().copied().reduce(pick).unwrap_or_else(|| Sym::constant(f64::NAN))
}
