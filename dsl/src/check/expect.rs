//! Expressions in places that know what they want: a dimension, a size, an axis.

use super::depend::May;
use super::fold::{bare_zero, unit_words};
use super::name::Entity;
use super::scope::ScopeId;
use super::{Checker, Value, constant, number};
use crate::ast::{self, ExprKind as Ast};
use crate::diagnostic::Diagnostic;
use crate::dimension::Dimension;
use crate::hir::{self, Expr};

impl<'a> Checker<'a> {
    /// An expression of known dimension.
    pub(super) fn expect(
        &mut self,
        scope: ScopeId,
        expr: &'a ast::Expr,
        want: Dimension,
        what: &str,
        may: May,
    ) -> Option<Expr> {
        let value = self.scalar(scope, expr)?;
        let value = self.fit(value, want, what, Some(expr))?;
        self.depends(&value, may, what)?;
        Some(value)
    }

    /// Gives a value the dimension it must have, or says what was expected.
    pub(super) fn fit(
        &mut self,
        mut value: Expr,
        want: Dimension,
        what: &str,
        text: Option<&ast::Expr>,
    ) -> Option<Expr> {
        if value.dimension == want {
            return Some(value);
        }
        if bare_zero(&value) {
            value.dimension = want;
            return Some(value);
        }
        let span = text.map_or(value.span, |e| e.span);
        let found = value.dimension;
        // A stiffness against rotation has the dimension of a torque; call it what it is.
        let turns = want == Dimension::TORQUE && what.contains("stiffness");
        // Optimal lengths per second have that of an angular velocity.
        let per_second = want == Dimension::ANGULAR_VELOCITY && what.contains("max_velocity");
        let expected = match (turns, per_second) {
            (true, _) => "a rotational stiffness".into(),
            (_, true) => "optimal lengths per second".into(),
            _ => want.describe(),
        };
        let found_words =
            if found.is_none() { "a plain number".to_string() } else { found.describe() };
        let message = format!("{what}: expected {expected}, found {found_words}");
        let expected = match (turns, per_second) {
            (true, _) => "`N*m/rad`".into(),
            (_, true) => "`Hz`".into(),
            _ => unit_words(want),
        };
        let label = match found.is_none() {
            true => format!("expected {expected}"),
            false => format!("expected {expected}, found {}", unit_words(found)),
        };
        let mut error = Diagnostic::error("dimension", span, message).label(label);
        if found.is_none() && !want.is_none() {
            let quoted = self.sources.slice(span);
            let wrapped = text.is_some_and(|e| matches!(e.kind, Ast::Paren(_) | Ast::Tuple(_)));
            let simple = wrapped || quoted.parse::<f64>().is_ok();
            let quoted = if simple { quoted.to_string() } else { format!("({quoted})") };
            let units = match (turns, per_second) {
                (true, _) => vec!["N*m/rad".to_string()],
                (_, true) => vec!["Hz".to_string()],
                _ => want.usual_units(),
            };
            let written: Vec<String> = units.iter().map(|u| format!("`{quoted} {u}`")).collect();
            if quoted.len() < 60 {
                error = error.help(format!("write {}", written.join(" or ")));
            }
        }
        self.report(error.help_if(sliding_or_turning(want, found)));
        None
    }

    /// A tuple of `N` of known dimension.
    pub(super) fn tuple<const N: usize>(
        &mut self,
        scope: ScopeId,
        expr: &'a ast::Expr,
        want: Dimension,
        what: &str,
        may: May,
    ) -> Option<[Expr; N]> {
        let items = self.items(scope, expr, N, what)?;
        self.fit_items(items, want, what, expr, may)
    }

    /// The elements of a tuple that must have `count` of them.
    pub(super) fn items(
        &mut self,
        scope: ScopeId,
        expr: &'a ast::Expr,
        count: usize,
        what: &str,
    ) -> Option<Vec<Expr>> {
        match self.value(scope, expr)? {
            Value::Vector(items) if items.len() == count => Some(items),
            Value::Vector(items) => {
                let message = format!("{what} has {count} numbers, not {}", items.len());
                self.report(Diagnostic::error("vector", expr.span, message));
                None
            }
            // A bare zero stands for the zero vector.
            Value::Scalar(e) if bare_zero(&e) => Some(vec![e; count]),
            Value::Scalar(_) => {
                let shape = match count {
                    2 => "(a, b)",
                    3 => "(x, y, z)",
                    _ => "(a, b, ...)",
                };
                let message = format!("{what} is a tuple of {count}, not one number");
                let error = Diagnostic::error("vector", expr.span, message);
                self.report(error.help(format!("write it as `{shape}`, a unit behind it")));
                None
            }
        }
    }

    pub(super) fn fit_items<const N: usize>(
        &mut self,
        items: Vec<Expr>,
        want: Dimension,
        what: &str,
        expr: &'a ast::Expr,
        may: May,
    ) -> Option<[Expr; N]> {
        // One message for the whole tuple where all of it is wrong in one way.
        let mut wrong = items.iter().filter(|e| !bare_zero(e));
        if let Some(first) = wrong.next()
            && first.dimension != want
            && wrong.all(|e| e.dimension == first.dimension)
            && matches!(expr.kind, Ast::Tuple(_) | Ast::WithUnit(..))
        {
            let first = first.clone();
            return self.fit(first, want, what, Some(expr)).and(None);
        }
        let mut fitted = Vec::new();
        for item in items {
            let item = self.fit(item, want, what, None);
            fitted.push(item.and_then(|e| self.depends(&e, may, what).map(|()| e)));
        }
        let fitted: Vec<Expr> = fitted.into_iter().collect::<Option<_>>()?;
        fitted.try_into().ok()
    }

    /// A vector of known dimension.
    pub(super) fn vector(
        &mut self,
        scope: ScopeId,
        expr: &'a ast::Expr,
        want: Dimension,
        what: &str,
        may: May,
    ) -> Option<hir::Vector> {
        self.tuple(scope, expr, want, what, may)
    }

    /// A direction: `x`, `y`, `z`, one of these negative, or a vector of any one dimension.
    pub(super) fn axis(
        &mut self,
        scope: ScopeId,
        expr: &'a ast::Expr,
        what: &str,
    ) -> Option<hir::Vector> {
        if let Some(axis) = named_axis(expr) {
            return Some(axis.map(|value| number(value, Dimension::NONE, expr.span)));
        }
        if let Ast::Path(path) = &expr.kind
            && !matches!(self.peek(scope, path), Some(Entity::Named(_)))
        {
            let message = format!("{what} is `x`, `y`, `z` or a vector");
            self.report(Diagnostic::error("axis", expr.span, message));
            return None;
        }
        let mut items = self.items(scope, expr, 3, what)?;
        let want = items.iter().find(|e| !bare_zero(e)).map_or(Dimension::NONE, |e| e.dimension);
        if items.iter().all(|e| constant(e) == Some(0.0)) {
            let message = format!("{what} has no direction: it is zero");
            self.report(Diagnostic::error("axis", expr.span, message));
            return None;
        }
        let mut axis =
            self.fit_items::<3>(std::mem::take(&mut items), want, what, expr, May::PARAMS)?;
        for e in &mut axis {
            if constant(e).is_some() {
                e.dimension = want;
            }
        }
        Some(axis)
    }
}

/// A named axis, with its sign.
pub(super) fn named_axis(expr: &ast::Expr) -> Option<[f64; 3]> {
    match &expr.kind {
        Ast::Path(path) => match path.parts.as_slice() {
            [only] => match only.text.as_str() {
                "x" => Some([1.0, 0.0, 0.0]),
                "y" => Some([0.0, 1.0, 0.0]),
                "z" => Some([0.0, 0.0, 1.0]),
                _ => None,
            },
            _ => None,
        },
        Ast::Neg(inner) => named_axis(inner).map(|a| a.map(|v| if v == 0.0 { 0.0 } else { -v })),
        Ast::Paren(inner) => named_axis(inner),
        _ => None,
    }
}

/// Advice where the stiffness or damping of a length stands for that of an angle, or the other way
/// round.
fn sliding_or_turning(want: Dimension, found: Dimension) -> Option<String> {
    let both = [want, found];
    let is = |a: Dimension, b: Dimension| both == [a, b] || both == [b, a];
    let (sliding, turning) = if is(Dimension::STIFFNESS, Dimension::ANGULAR_STIFFNESS) {
        ("N/m", "N*m/rad")
    } else if is(Dimension::DAMPING, Dimension::ANGULAR_DAMPING) {
        ("N*s/m", "N*m*s/rad")
    } else {
        return None;
    };
    Some(format!(
        "it is `{sliding}` for a length and `{turning}` for an angle; a parameter of a component \
         may be given by its unit: `name: {turning}`"
    ))
}
