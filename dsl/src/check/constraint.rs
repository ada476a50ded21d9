//! Constraints and the rows of their multipliers.

use super::depend::May;
use super::range::POSITIVE;
use super::scope::ScopeId;
use super::{Checker, constant, zero_vector};
use crate::ast::{self, Argument, ConstraintKind as Ast, DeclKind};
use crate::diagnostic::Diagnostic;
use crate::dimension::Dimension;
use crate::hir::{self, ConstraintKind, Vector};
use crate::source::Span;

/// Impulse times length: a multiplier times what its row measures.
const ACTION: Dimension = Dimension::ANGULAR_DAMPING;
const MOMENTUM: Dimension = Dimension { length: 1, mass: 1, time: -1 };
const AXES: [&str; 3] = ["x", "y", "z"];

impl<'a> Checker<'a> {
    pub(super) fn finish_constraints(&mut self) -> Vec<hir::Constraint> {
        let mut constraints = Vec::new();
        for index in 0..self.constraints.len() {
            let item = &self.constraints[index];
            let (scope, decl, name) = (item.scope, item.decl, item.name.clone());
            let kind = match &decl.kind {
                DeclKind::Constraint(kind) => kind,
                _ => {
                    let strand = self.prescribed.iter().find(|p| p.1 == index);
                    if let Some(&(strand, _)) = strand {
                        let kind = ConstraintKind::Length(hir::StrandId(strand as u32));
                        constraints.push(hir::Constraint { name, kind, span: decl.span });
                    }
                    continue;
                }
            };
            if let Some(kind) = self.constraint(scope, kind, name.span) {
                constraints.push(hir::Constraint { name, kind, span: decl.span });
            }
        }
        constraints
    }

    fn constraint(&mut self, scope: ScopeId, kind: &'a Ast, span: Span) -> Option<ConstraintKind> {
        match kind {
            Ast::Coincident(first, second, axes) => {
                let (first, second) = (self.point(scope, first), self.point(scope, second));
                let axes = match axes {
                    None => [true; 3],
                    Some(axes) => self.axes(axes)?,
                };
                Some(ConstraintKind::Coincident { first: first?, second: second?, axes })
            }
            Ast::Distance(first, second, distance) => {
                let (first, second) = (self.point(scope, first), self.point(scope, second));
                let (want, what) = (Dimension::LENGTH, "a distance");
                let distance = self.expect(scope, distance, want, what, May::PARAMS)?;
                let rule = "a distance must be positive";
                self.must(&distance, POSITIVE, rule);
                if constant(&distance) == Some(0.0) {
                    let last = self.out.last_mut();
                    if let Some(error) = last {
                        error.help = Some("for no distance at all write `coincident(P, P)`".into());
                    }
                }
                Some(ConstraintKind::Distance { first: first?, second: second?, distance })
            }
            Ast::OnPlane(point, frame, arguments) => {
                let point = self.point(scope, point);
                let frame = self.frame(scope, frame);
                let (normal, through) = self.plane(scope, arguments, span)?;
                let frame = self.frame_ids[frame?];
                Some(ConstraintKind::OnPlane { point: point?, frame, normal, through })
            }
            Ast::Weld(first, second) => {
                let (a, b) = (self.frame(scope, first), self.frame(scope, second));
                let (first, second) = (self.frame_ids[a?], self.frame_ids[b?]);
                Some(ConstraintKind::Weld { first, second })
            }
            Ast::Equation(left, right) => {
                let (a, b) = (self.scalar(scope, left), self.scalar(scope, right));
                let (mut left, mut right) = (a?, b?);
                self.depends(&left, May::HOLONOMIC, "a constraint")?;
                self.depends(&right, May::HOLONOMIC, "a constraint")?;
                let what = "a constraint cannot hold it";
                self.without_muscles(&left, what).and(self.without_muscles(&right, what))?;
                self.agree(&mut left, &mut right, "equate")?;
                if constant(&left).is_some() && constant(&right).is_some() {
                    let message = "this equation holds no coordinate";
                    self.report(Diagnostic::error("constraint", left.span.to(right.span), message));
                }
                Some(ConstraintKind::Equation { left, right })
            }
        }
    }

    /// `normal = v [, through = v]`.
    fn plane(
        &mut self,
        scope: ScopeId,
        arguments: &'a [Argument],
        span: Span,
    ) -> Option<(Vector, Vector)> {
        let mut normal = None;
        let mut through = Some(zero_vector(Dimension::LENGTH, span));
        let mut seen: Vec<&str> = Vec::new();
        for argument in arguments {
            let Some(name) = &argument.name else { continue };
            if seen.contains(&name.text.as_str()) {
                let message = format!("`{}` is given twice", name.text);
                self.report(Diagnostic::error("duplicate", name.span, message));
            }
            seen.push(&name.text);
            match name.text.as_str() {
                "normal" => normal = self.axis(scope, &argument.value, "the normal of a plane"),
                "through" => {
                    let (want, what) = (Dimension::LENGTH, "`through`");
                    through = self.vector(scope, &argument.value, want, what, May::PARAMS);
                }
                _ => {
                    let message = format!("`on_plane` has no option `{}`", name.text);
                    let error = Diagnostic::error("unknown-option", name.span, message);
                    self.report(error.help("known are normal, through"));
                }
            }
        }
        if !seen.contains(&"normal") {
            let error = Diagnostic::error("missing-option", span, "`on_plane` needs `normal`");
            self.report(error.help("write `on_plane(P, F, normal = (0, 1, 0))`"));
        }
        normal.zip(through)
    }

    /// `axes = (x, z)`.
    fn axes(&mut self, text: &ast::Expr) -> Option<[bool; 3]> {
        let axes = named_axes(text);
        if axes.is_none() {
            let message = "`axes` lists one to three of `x`, `y`, `z`, each once";
            let error = Diagnostic::error("axis", text.span, message);
            self.report(error.help("write `axes = (x, z)`"));
        }
        axes
    }

    /// The rows of a constraint: their names, and what their multipliers measure.
    pub(super) fn constraint_rows(
        &mut self,
        index: usize,
    ) -> Option<Vec<(&'static str, Dimension)>> {
        let item = self.constraints.get(index)?;
        let (scope, decl) = (item.scope, item.decl);
        let DeclKind::Constraint(kind) = &decl.kind else { return Some(vec![("", MOMENTUM)]) };
        Some(match kind {
            Ast::Coincident(_, _, axes) => {
                let axes = match axes {
                    None => [true; 3],
                    Some(axes) => named_axes(axes)?,
                };
                AXES.iter().zip(axes).filter(|a| a.1).map(|a| (*a.0, MOMENTUM)).collect()
            }
            Ast::Distance(..) => vec![("", Dimension::DAMPING)],
            Ast::OnPlane(..) => vec![("", MOMENTUM)],
            Ast::Weld(..) => {
                let turns = ["xy", "yz", "zx"].map(|row| (row, ACTION));
                AXES.map(|row| (row, MOMENTUM)).into_iter().chain(turns).collect()
            }
            Ast::Equation(left, _) => {
                // The equation itself is reported where it is checked.
                let before = self.out.len();
                let dimension = self.scalar(scope, left).map(|e| e.dimension);
                self.out.truncate(before);
                vec![("", ACTION.over(dimension?)?)]
            }
        })
    }
}

fn named_axes(text: &ast::Expr) -> Option<[bool; 3]> {
    let items: &[ast::Expr] = match &text.kind {
        ast::ExprKind::Tuple(items) => items,
        ast::ExprKind::Paren(inner) => std::slice::from_ref(&**inner),
        _ => std::slice::from_ref(text),
    };
    let mut axes = [false; 3];
    for item in items {
        let ast::ExprKind::Path(path) = &item.kind else { return None };
        let [word] = path.parts.as_slice() else { return None };
        let index = AXES.iter().position(|a| *a == word.text)?;
        if std::mem::replace(&mut axes[index], true) {
            return None;
        }
    }
    Some(axes)
}
