//! Options of a joint, given to each of its coordinates.

use super::depend::May;
use super::fold::bare_zero;
use super::options::Options;
use super::range::NOT_NEGATIVE;
use super::scope::ScopeId;
use super::{Checker, Value, constant};
use crate::ast;
use crate::diagnostic::Diagnostic;
use crate::dimension::Dimension;
use crate::hir::{Coordinate, Expr, MotionKind};

/// A dimension for rotations and one for translations.
pub(super) type Pair = (Dimension, Dimension);

pub(super) const COORDINATE: Pair = (Dimension::ANGLE, Dimension::LENGTH);
pub(super) const RATE: Pair = (Dimension::ANGULAR_VELOCITY, Dimension::VELOCITY);
const DAMPING: Pair = (Dimension::ANGULAR_DAMPING, Dimension::DAMPING);
const STIFFNESS: Pair = (Dimension::ANGULAR_STIFFNESS, Dimension::STIFFNESS);

/// The dimension of a pair that a motion has.
pub(super) fn of(pair: Pair, motion: &MotionKind) -> Dimension {
    match motion {
        MotionKind::Prismatic | MotionKind::Fibre => pair.1,
        MotionKind::Revolute | MotionKind::Screw { .. } | MotionKind::Activation => pair.0,
    }
}

impl<'a> Checker<'a> {
    pub(super) fn coordinate_options(
        &mut self,
        scope: ScopeId,
        options: &Options<'a>,
        own: &mut [Coordinate],
        joint: &str,
    ) {
        let dimensions = |own: &[Coordinate], pair: Pair| -> Vec<Dimension> {
            own.iter().map(|c| of(pair, &c.motion)).collect()
        };
        let places = dimensions(own, COORDINATE);
        let rates = dimensions(own, RATE);
        for (name, want) in [("start", &places), ("velocity", &rates), ("drive", &places)] {
            let Some(text) = options.get(name) else { continue };
            let may = if name == "drive" { May::TIME } else { May::PARAMS };
            let what = format!("`{name}` of `{joint}`");
            let Some(values) = self.per_coordinate(scope, text, want, &what, may) else { continue };
            for (coordinate, value) in own.iter_mut().zip(values) {
                match name {
                    "start" => coordinate.start = value,
                    "velocity" => coordinate.velocity = value,
                    _ => coordinate.drive = Some(value),
                }
            }
        }
        for (name, pair) in [
            ("damping", DAMPING),
            ("stiffness", STIFFNESS),
            ("rest", COORDINATE),
            ("limit_stiffness", STIFFNESS),
            ("limit_width", COORDINATE),
        ] {
            let Some(text) = options.get(name) else { continue };
            let want = dimensions(own, pair);
            let may = if name == "rest" { May::REST } else { May::PARAMS };
            let what = format!("`{name}` of `{joint}`");
            let Some(values) = self.applied(scope, text, &want, &what, may) else { continue };
            match name {
                "damping" => self.warn_negative(&values, &what),
                "rest" => {}
                _ => {
                    let message = format!("{what} cannot be negative");
                    self.must(&values[0], NOT_NEGATIVE, &message);
                }
            }
            for (coordinate, value) in own.iter_mut().zip(values) {
                match name {
                    "damping" => coordinate.damping = Some(value),
                    "stiffness" => coordinate.stiffness = Some(value),
                    "rest" => coordinate.rest = Some(value),
                    "limit_width" => coordinate.limit_width = Some(value),
                    _ => coordinate.limit_stiffness = Some(value),
                }
            }
        }
        if let Some(text) = options.get("limits") {
            self.limits(scope, text, own, &places, joint);
        }
        for (name, needs) in [
            ("rest", "stiffness"),
            ("limit_stiffness", "limits"),
            ("limit_width", "limit_stiffness"),
        ] {
            if let Some(setting) = options.setting(name)
                && options.get(needs).is_none()
                && !options.broken
            {
                let message = format!("`{name}` does nothing without `{needs}`");
                self.report(Diagnostic::warning("no-effect", setting.name.span, message));
            }
        }
    }

    /// One value for each coordinate: a number for one, a tuple for several.
    pub(super) fn per_coordinate(
        &mut self,
        scope: ScopeId,
        text: &'a ast::Expr,
        want: &[Dimension],
        what: &str,
        may: May,
    ) -> Option<Vec<Expr>> {
        if let [only] = want {
            return self.expect(scope, text, *only, what, may).map(|e| vec![e]);
        }
        let items = match self.value(scope, text)? {
            Value::Vector(items) if items.len() == want.len() => items,
            Value::Scalar(e) if bare_zero(&e) => vec![e; want.len()],
            Value::Vector(items) => {
                let message = format!("{what} has {} numbers, not {}", want.len(), items.len());
                self.report(Diagnostic::error("vector", text.span, message));
                return None;
            }
            Value::Scalar(_) => {
                let message =
                    format!("{what} is a tuple: the joint has {} coordinates", want.len());
                let error = Diagnostic::error("vector", text.span, message);
                let shape = match (want.len(), want[want.len() - 1]) {
                    (2, _) => "(a, b)",
                    (3, Dimension::NONE) => "(u, v, r)",
                    (3, _) => "(x, y, z)",
                    _ => "(tx, ty, tz, rx, ry, rz)",
                };
                self.report(error.help(format!("write `{shape}`")));
                return None;
            }
        };
        let mut fitted = Vec::new();
        for (item, want) in items.into_iter().zip(want) {
            let item = self.fit(item, *want, what, None);
            fitted.push(item.and_then(|e| self.depends(&e, may, what).map(|()| e)));
        }
        fitted.into_iter().collect()
    }

    /// A value that applies to each coordinate: one number, fitting some of them, or a tuple.
    fn applied(
        &mut self,
        scope: ScopeId,
        text: &'a ast::Expr,
        want: &[Dimension],
        what: &str,
        may: May,
    ) -> Option<Vec<Expr>> {
        let value = match self.value(scope, text)? {
            Value::Scalar(value) if want.len() > 1 => value,
            _ => return self.per_coordinate(scope, text, want, what, may),
        };
        let fits = want.iter().find(|w| **w == value.dimension).unwrap_or(&want[0]);
        let value = self.fit(value, *fits, what, Some(text))?;
        self.depends(&value, may, what)?;
        // Where translations and rotations mix, the one number serves both.
        Some(want.iter().map(|&dimension| Expr { dimension, ..value.clone() }).collect())
    }

    fn warn_negative(&mut self, values: &[Expr], what: &str) {
        if let Some(value) = values.iter().find(|e| constant(e).is_some_and(|x| x < 0.0)) {
            let message = format!("{what} is negative: it feeds energy into the motion");
            self.report(Diagnostic::warning("negative-damping", value.span, message));
        }
    }

    fn limits(
        &mut self,
        scope: ScopeId,
        text: &'a ast::Expr,
        own: &mut [Coordinate],
        want: &[Dimension],
        joint: &str,
    ) {
        let what = format!("`limits` of `{joint}`");
        let Some(items) = self.items(scope, text, 2, &what) else { return };
        let given = items.iter().find(|e| !bare_zero(e)).map_or(want[0], |e| e.dimension);
        let fits = want.iter().find(|w| **w == given).unwrap_or(&want[0]);
        let Some([low, high]) = self.fit_items::<2>(items, *fits, &what, text, May::PARAMS) else {
            return;
        };
        let bounds = constant(&low).zip(constant(&high));
        if let Some((a, b)) = bounds
            && a >= b
        {
            let message = "the lower limit is not below the upper one";
            let error = Diagnostic::error("limits", text.span, message);
            self.report(error.help("write `(low, high)`"));
            return;
        }
        for coordinate in own.iter_mut() {
            let dimension = of(COORDINATE, &coordinate.motion);
            if dimension != *fits {
                continue;
            }
            if let (Some((a, b)), Some(start)) = (bounds, constant(&coordinate.start))
                && !(a..=b).contains(&start)
            {
                let message = format!("`{}` starts outside its limits", coordinate.name.text);
                self.report(
                    Diagnostic::warning("start-outside-limits", coordinate.start.span, message)
                        .also(text.span, "the limits"),
                );
            }
            coordinate.limits = Some([low.clone(), high.clone()]);
        }
    }
}
