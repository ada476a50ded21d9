//! Expressions: names resolved, units applied, dimensions checked.

use super::name::Entity;
use super::scope::ScopeId;
use super::{Checker, Value, constant, number};
use crate::ast::{self, ExprKind as Ast, Operator};
use crate::diagnostic::Diagnostic;
use crate::dimension::Dimension;
use crate::hir::{BinaryOp, CoordinateId, Expr, ExprKind};
use crate::source::Span;
use crate::suggest::nearest;
use crate::unit::{UNITS, Unit};

/// Deepest evaluation, through constants that use constants.
const MAX_DEPTH: usize = 700;

impl<'a> Checker<'a> {
    /// The value of an expression.
    pub(super) fn value(&mut self, scope: ScopeId, expr: &'a ast::Expr) -> Option<Value> {
        if self.depth >= MAX_DEPTH {
            let message =
                "this is nested too deeply, or uses constants that use constants too often";
            self.report(Diagnostic::error("too-deep", expr.span, message));
            return None;
        }
        self.depth += 1;
        let value = self.value_inside(scope, expr);
        self.depth -= 1;
        value
    }

    fn value_inside(&mut self, scope: ScopeId, expr: &'a ast::Expr) -> Option<Value> {
        let span = expr.span;
        match &expr.kind {
            Ast::Number(value) => self.finite(*value, Dimension::NONE, span).map(Value::Scalar),
            Ast::Path(path) => self.path_value(scope, path),
            Ast::Paren(inner) => self.value(scope, inner),
            Ast::Tuple(items) => {
                let all: Vec<Option<Expr>> = items.iter().map(|e| self.scalar(scope, e)).collect();
                all.into_iter().collect::<Option<Vec<Expr>>>().map(Value::Vector)
            }
            Ast::WithUnit(inner, unit) => {
                let unit = self.unit(unit);
                let value = self.value(scope, inner)?;
                let unit = unit?;
                match value {
                    Value::Scalar(e) => self.with_unit(e, unit, span).map(Value::Scalar),
                    Value::Vector(v) => self.each(v, |checker, e| {
                        let span = e.span;
                        checker.with_unit(e, unit, span)
                    }),
                }
            }
            Ast::Neg(inner) => match self.value(scope, inner)? {
                Value::Scalar(e) => Some(Value::Scalar(self.negate(e, span))),
                Value::Vector(v) => self.each(v, |checker, e| {
                    let span = e.span;
                    Some(checker.negate(e, span))
                }),
            },
            Ast::Binary(operator, left, right) => {
                let op = match operator {
                    Operator::Add => BinaryOp::Add,
                    Operator::Sub => BinaryOp::Sub,
                    Operator::Mul => BinaryOp::Mul,
                    Operator::Div => BinaryOp::Div,
                    Operator::Pow => BinaryOp::Pow,
                    _ => {
                        let message = "a comparison is not a number";
                        self.report(Diagnostic::error("comparison", span, message));
                        return None;
                    }
                };
                let left = self.value(scope, left);
                let right = self.value(scope, right);
                self.binary_value(op, left?, right?, span)
            }
            Ast::Call(name, arguments) => {
                self.call(scope, name, arguments, span).map(Value::Scalar)
            }
        }
    }

    /// A single number.
    pub(super) fn scalar(&mut self, scope: ScopeId, expr: &'a ast::Expr) -> Option<Expr> {
        match self.value(scope, expr)? {
            Value::Scalar(value) => Some(value),
            Value::Vector(items) => {
                let message = format!("expected one number, found {} in a tuple", items.len());
                self.report(Diagnostic::error("vector", expr.span, message));
                None
            }
        }
    }

    fn with_unit(&mut self, value: Expr, unit: Unit, span: Span) -> Option<Expr> {
        match constant(&value) {
            Some(x) if value.dimension.is_none() => {
                self.finite(unit.to_si(x), unit.dimension, span)
            }
            _ => {
                let unit = number(unit.to_si(1.0), unit.dimension, span);
                self.binary(BinaryOp::Mul, value, unit, span)
            }
        }
    }

    /// The unit a text stands for.
    pub(super) fn unit(&mut self, unit: &ast::UnitExpr) -> Option<Unit> {
        let mut product = Some(Unit::ONE);
        for (index, factor) in unit.factors.iter().enumerate() {
            let name = &factor.name;
            let Some(known) = Unit::named(&name.text) else {
                let near = nearest(&name.text, UNITS.iter().map(|u| u.0));
                let all: Vec<&str> = UNITS.iter().map(|u| u.0).collect();
                let help = match near {
                    _ if index > 0 => format!(
                        "a unit is written without spaces; if `{}` is a name, put spaces around the operator",
                        name.text
                    ),
                    Some(near) => format!("did you mean `{near}`?"),
                    None => format!("known are {}", all.join(" ")),
                };
                let help = match near {
                    Some(near) if index > 0 => format!("did you mean `{near}`? {help}"),
                    _ => help,
                };
                let message = format!("unknown unit `{}`", name.text);
                self.report(Diagnostic::error("unknown-unit", name.span, message).help(help));
                product = None;
                continue;
            };
            if let Some(so_far) = product {
                product = so_far.times_power(known, factor.exponent);
                if product.is_none() {
                    let message = "the powers of this unit are too large";
                    self.report(Diagnostic::error("dimension", unit.span, message));
                }
            }
        }
        product
    }

    /// What a name in an expression stands for.
    fn path_value(&mut self, scope: ScopeId, path: &'a ast::Path) -> Option<Value> {
        let span = path.span;
        let word = || path.parts.iter().map(|p| p.text.as_str()).collect::<Vec<_>>().join(".");
        let at = |kind, dimension| Some(Value::Scalar(Expr { kind, dimension, span }));
        let what = match self.entity(scope, path)? {
            Entity::Time => return at(ExprKind::Time, Dimension::TIME),
            Entity::Own(own) => return at(ExprKind::Own(own), Dimension::LENGTH),
            Entity::Pi => return at(ExprKind::Number(std::f64::consts::PI), Dimension::NONE),
            Entity::Named(named) => {
                let value = self.named(named, span)?;
                return Some(match value {
                    Value::Scalar(e) if constant(&e).is_some() => Value::Scalar(Expr { span, ..e }),
                    other => other,
                });
            }
            Entity::Multiplier(constraint, row, dimension) => {
                return at(ExprKind::Multiplier(constraint, row), dimension);
            }
            Entity::Coordinate(index) => {
                let dimension = self.coordinate_dimension(index)?;
                return at(ExprKind::Coordinate(CoordinateId(index as u32)), dimension);
            }
            Entity::Joint(joint) => {
                let range = self.joints[joint].coordinates.clone();
                match range.len() {
                    0 => return None,
                    1 => {
                        let dimension = self.coordinate_dimension(range.start)?;
                        let id = CoordinateId(range.start as u32);
                        return at(ExprKind::Coordinate(id), dimension);
                    }
                    _ => {}
                }
                let help = self.parts_help(joint, &word());
                let message =
                    format!("`{}` has {} coordinates: name one of them", word(), range.len());
                self.report(Diagnostic::error("which-coordinate", span, message).help(help));
                return None;
            }
            Entity::Frame(_) => "a frame",
            Entity::Instance(_) => "an instance of a component",
            Entity::Strand(_) => "a strand",
            Entity::Constraint(_) => "a constraint",
        };
        let message = format!("`{}` is {what}, not a number", word());
        let mut error = Diagnostic::error("not-a-value", span, message);
        if what == "a strand" {
            error = error.help(format!("its length is `length({})`", word()));
        }
        self.report(error);
        None
    }

    pub(super) fn parts_help(&self, joint: usize, name: &str) -> String {
        let range = self.joints[joint].coordinates.clone();
        let last = |n: &String| n.rsplit('.').next().unwrap_or("").to_string();
        let parts: Vec<String> =
            self.coordinate_names[range].iter().map(|n| format!("`{name}.{}`", last(n))).collect();
        format!("its coordinates are {}", parts.join(", "))
    }
}
