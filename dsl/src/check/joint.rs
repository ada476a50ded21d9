//! Joints: their motions, and the options of each coordinate.

use super::depend::May;
use super::fold::bare_zero;
use super::options::Options;
use super::scope::ScopeId;
use super::{Checker, Value, constant, number};
use crate::ast::{self, Argument, DeclKind, Ident};
use crate::diagnostic::Diagnostic;
use crate::dimension::Dimension;
use crate::hir::{
    self, Coordinate, CoordinateId, Expr, JointId, JointKind, MotionKind, Name, Vector,
};
use crate::source::Span;

const OPTIONS: [&str; 8] =
    ["start", "velocity", "damping", "stiffness", "rest", "limits", "limit_stiffness", "drive"];

/// A dimension for rotations and one for translations.
type Pair = (Dimension, Dimension);

const COORDINATE: Pair = (Dimension::ANGLE, Dimension::LENGTH);
const RATE: Pair = (Dimension::ANGULAR_VELOCITY, Dimension::VELOCITY);
const DAMPING: Pair = (Dimension::ANGULAR_DAMPING, Dimension::DAMPING);
const STIFFNESS: Pair = (Dimension::ANGULAR_STIFFNESS, Dimension::STIFFNESS);

fn of(pair: Pair, motion: &MotionKind) -> Dimension {
    match motion {
        MotionKind::Prismatic => pair.1,
        MotionKind::Revolute | MotionKind::Screw { .. } => pair.0,
    }
}

impl<'a> Checker<'a> {
    pub(super) fn finish_joints(&mut self) -> (Vec<hir::Joint>, Vec<Coordinate>) {
        let mut joints = Vec::new();
        let mut coordinates = Vec::new();
        for index in 0..self.joints.len() {
            let raw = &self.joints[index];
            let (scope, decl, name) = (raw.item.scope, raw.item.decl, raw.item.name.clone());
            let (kind, frame, range) = (raw.kind, raw.frame, raw.coordinates.clone());
            let DeclKind::Joint(word, arguments, _, block) = &decl.kind else { continue };
            let options = self.options(block, "a joint", &OPTIONS);
            let Some(kind) = kind else {
                // Names in its options are looked at all the same.
                for setting in &block.settings {
                    self.value(scope, &setting.value);
                }
                continue;
            };
            let motions = self.motions(scope, kind, word, arguments);
            let mut own = self.bare_coordinates(index, &name, motions, range.start);
            self.coordinate_options(scope, &options, &mut own, &name.text);
            let ids = range.map(|c| CoordinateId(c as u32)).collect();
            let frame = self.frame_ids[frame];
            joints.push(hir::Joint { name, frame, kind, coordinates: ids });
            coordinates.extend(own);
        }
        (joints, coordinates)
    }

    /// The motions of a joint in order.
    fn motions(
        &mut self,
        scope: ScopeId,
        kind: JointKind,
        word: &'a Ident,
        arguments: &'a [Argument],
    ) -> Vec<(MotionKind, Vector)> {
        let unit = |axis: usize| -> Vector {
            std::array::from_fn(|i| {
                number(if i == axis { 1.0 } else { 0.0 }, Dimension::NONE, word.span)
            })
        };
        let (want, shape): (&[&str], &str) = match kind {
            JointKind::Revolute => (&["axis"], "revolute(axis)"),
            JointKind::Prismatic => (&["axis"], "prismatic(axis)"),
            JointKind::Screw => (&["axis", "pitch"], "screw(axis, pitch)"),
            JointKind::Universal => (&["a", "b"], "universal(a, b)"),
            JointKind::Planar => (&["normal"], "planar(normal)"),
            JointKind::Free => (&[], "free"),
        };
        let wrong_name = arguments
            .iter()
            .zip(want)
            .find_map(|(a, w)| a.name.as_ref().filter(|n| n.text != **w).map(|n| n.span));
        let mut axes: Vec<Option<Vector>> = Vec::new();
        if arguments.len() != want.len() || wrong_name.is_some() {
            let span = arguments.iter().fold(word.span, |s, a| s.to(a.value.span));
            let message = format!("`{}` is written `{shape}`", word.text);
            let mut error =
                Diagnostic::error("joint-arguments", wrong_name.unwrap_or(span), message);
            if !want.is_empty() && want[0] != "pitch" {
                error = error.help("an axis is `x`, `y`, `z` or a vector such as `(1, 0, 1)`");
            }
            self.report(error);
        } else {
            for (argument, want) in arguments.iter().zip(want) {
                if *want != "pitch" {
                    axes.push(self.axis(scope, &argument.value, "the axis of a joint"));
                }
            }
        }
        let mut axes = axes.into_iter().map(|a| a.unwrap_or_else(|| unit(2)));
        let mut next = || axes.next().unwrap_or_else(|| unit(2));
        match kind {
            JointKind::Revolute => vec![(MotionKind::Revolute, next())],
            JointKind::Prismatic => vec![(MotionKind::Prismatic, next())],
            JointKind::Screw => {
                let axis = next();
                let pitch = arguments.get(1).and_then(|a| {
                    let what = "the pitch of a screw (its advance per radian)";
                    self.expect(scope, &a.value, Dimension::LENGTH, what, May::PARAMS)
                });
                let pitch = pitch.unwrap_or_else(|| number(0.0, Dimension::LENGTH, word.span));
                vec![(MotionKind::Screw { pitch }, axis)]
            }
            JointKind::Universal => {
                vec![(MotionKind::Revolute, next()), (MotionKind::Revolute, next())]
            }
            JointKind::Planar => self.planar(next(), word.span, unit),
            JointKind::Free => {
                let mut motions: Vec<_> =
                    (0..3).map(|axis| (MotionKind::Prismatic, unit(axis))).collect();
                motions.extend((0..3).map(|axis| (MotionKind::Revolute, unit(axis))));
                motions
            }
        }
    }

    /// Two translations along the axes that follow the normal in the order x, y, z, x, then the
    /// rotation about it. The normal is an axis, either way round.
    fn planar(
        &mut self,
        normal: Vector,
        span: Span,
        unit: impl Fn(usize) -> Vector,
    ) -> Vec<(MotionKind, Vector)> {
        let values: Vec<f64> = normal.iter().map(|e| constant(e).unwrap_or(f64::NAN)).collect();
        let main = match values.as_slice() {
            [x, y, z] if *y == 0.0 && *z == 0.0 && *x != 0.0 => 0,
            [x, y, z] if *x == 0.0 && *z == 0.0 && *y != 0.0 => 1,
            [x, y, z] if *x == 0.0 && *y == 0.0 && *z != 0.0 => 2,
            _ => {
                let span = normal.iter().fold(span, |s, e| s.to(e.span));
                let message = "the normal of a planar joint is `x`, `y` or `z`";
                let error = Diagnostic::error("axis", span, message);
                self.report(error.help("turn the joint with `rotate` for another plane"));
                2
            }
        };
        vec![
            (MotionKind::Prismatic, unit((main + 1) % 3)),
            (MotionKind::Prismatic, unit((main + 2) % 3)),
            (MotionKind::Revolute, normal),
        ]
    }

    fn bare_coordinates(
        &mut self,
        joint: usize,
        name: &Name,
        motions: Vec<(MotionKind, Vector)>,
        first: usize,
    ) -> Vec<Coordinate> {
        motions
            .into_iter()
            .enumerate()
            .map(|(part, (motion, axis))| Coordinate {
                name: Name { text: self.coordinate_names[first + part].clone(), ..name.clone() },
                joint: JointId(joint as u32),
                start: number(0.0, of(COORDINATE, &motion), name.span),
                velocity: number(0.0, of(RATE, &motion), name.span),
                motion,
                axis,
                damping: None,
                stiffness: None,
                rest: None,
                limits: None,
                limit_stiffness: None,
                drive: None,
            })
            .collect()
    }

    fn coordinate_options(
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
                    self.must(&values[0], |x| x >= 0.0, &message);
                }
            }
            for (coordinate, value) in own.iter_mut().zip(values) {
                match name {
                    "damping" => coordinate.damping = Some(value),
                    "stiffness" => coordinate.stiffness = Some(value),
                    "rest" => coordinate.rest = Some(value),
                    _ => coordinate.limit_stiffness = Some(value),
                }
            }
        }
        if let Some(text) = options.get("limits") {
            self.limits(scope, text, own, &places, joint);
        }
        for name in ["rest", "limit_stiffness"] {
            let needs = if name == "rest" { "stiffness" } else { "limits" };
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
                let shape = match want.len() {
                    2 => "(a, b)",
                    3 => "(u, v, r)",
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
