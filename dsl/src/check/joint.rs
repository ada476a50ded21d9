//! Joints: their motions, and the options of each coordinate.

use super::coordinate::{COORDINATE, RATE, of};
use super::depend::May;
use super::scope::ScopeId;
use super::{Checker, constant, number};
use crate::ast::{Argument, DeclKind, Ident};
use crate::diagnostic::Diagnostic;
use crate::dimension::Dimension;
use crate::hir::{
    self, Coordinate, CoordinateId, JointId, JointKind, MotionKind, Name, Owner, Vector,
};
use crate::source::Span;

const OPTIONS: [&str; 9] = [
    "start",
    "velocity",
    "damping",
    "stiffness",
    "rest",
    "limits",
    "limit_stiffness",
    "limit_width",
    "drive",
];

impl<'a> Checker<'a> {
    /// Joints, and their coordinates with their place among all.
    pub(super) fn finish_joints(&mut self) -> (Vec<hir::Joint>, Vec<(usize, Coordinate)>) {
        let mut joints = Vec::new();
        let mut coordinates = Vec::new();
        for index in 0..self.joints.len() {
            let raw = &self.joints[index];
            let (scope, decl, name) = (raw.item.scope, raw.item.decl, raw.item.name.clone());
            let (kind, frame, range) = (raw.kind, raw.frame, raw.coordinates.clone());
            let (word, arguments, block) = match &decl.kind {
                DeclKind::Joint(word, arguments, _, block) => (word, arguments, block),
                DeclKind::Node(_, block) => {
                    let own = self.node(scope, index, &name, block, range.clone());
                    coordinates.extend(range.clone().zip(own));
                    let ids = range.map(|c| CoordinateId(c as u32)).collect();
                    let (frame, kind) = (self.frame_ids[frame], JointKind::Node);
                    joints.push(hir::Joint { name, frame, kind, coordinates: ids });
                    continue;
                }
                _ => continue,
            };
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
            coordinates.extend(range.clone().zip(own));
            let ids = range.map(|c| CoordinateId(c as u32)).collect();
            let frame = self.frame_ids[frame];
            joints.push(hir::Joint { name, frame, kind, coordinates: ids });
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
            JointKind::Free | JointKind::Node => (&[], "free"),
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
            JointKind::Free | JointKind::Node => {
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

    pub(super) fn bare_coordinates(
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
                owner: Owner::Joint(JointId(joint as u32)),
                start: number(0.0, of(COORDINATE, &motion), name.span),
                velocity: number(0.0, of(RATE, &motion), name.span),
                motion,
                axis,
                damping: None,
                stiffness: None,
                rest: None,
                limits: None,
                limit_stiffness: None,
                limit_width: None,
                drive: None,
            })
            .collect()
    }
}
