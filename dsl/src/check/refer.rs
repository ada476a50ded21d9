//! Names in places that know what they name: a frame, a joint, a coordinate, a strand.

use super::Checker;
use super::name::Entity;
use super::scope::ScopeId;
use super::value::NamedId;
use crate::ast::{self, Path};
use crate::diagnostic::Diagnostic;
use crate::dimension::Dimension;
use crate::hir::JointKind;

impl<'a> Checker<'a> {
    /// The frame a name stands for.
    pub(super) fn frame(&mut self, scope: ScopeId, path: &'a Path) -> Option<usize> {
        match self.entity(scope, path)? {
            Entity::Frame(index) => Some(index),
            Entity::Joint(index) => Some(self.joints[index].frame),
            Entity::Instance(inner) => self.scopes[inner.0].base,
            other => {
                self.wrong_kind(path, other, "a frame", "not-a-frame");
                None
            }
        }
    }

    /// The coordinates a name stands for: one, or all of a joint's.
    pub(super) fn coordinates(
        &mut self,
        scope: ScopeId,
        path: &'a Path,
    ) -> Option<std::ops::Range<usize>> {
        match self.entity(scope, path)? {
            Entity::Coordinate(index) => Some(index..index + 1),
            Entity::Joint(joint) => {
                let range = self.joints[joint].coordinates.clone();
                (!range.is_empty()).then_some(range)
            }
            other => {
                self.wrong_kind(path, other, "a joint", "not-a-joint");
                None
            }
        }
    }

    /// The single coordinate a name stands for.
    pub(super) fn coordinate(&mut self, scope: ScopeId, path: &'a Path) -> Option<usize> {
        let range = self.coordinates(scope, path)?;
        if range.len() == 1 {
            return Some(range.start);
        }
        let name = path.parts.iter().map(|p| p.text.as_str()).collect::<Vec<_>>().join(".");
        let joint = self.joint_of(range.start);
        let help = self.parts_help(joint, &name);
        let message = format!("`{name}` has {} coordinates: name one of them", range.len());
        self.report(Diagnostic::error("which-coordinate", path.span, message).help(help));
        None
    }

    pub(super) fn joint_of(&self, coordinate: usize) -> usize {
        self.joints.partition_point(|j| j.coordinates.end <= coordinate)
    }

    /// The dimension of a coordinate: none for a rotation, a length for a translation.
    pub(super) fn coordinate_dimension(&self, coordinate: usize) -> Option<Dimension> {
        if let Some((_, part)) = self.muscle_of(coordinate) {
            return Some(if part == 0 { Dimension::LENGTH } else { Dimension::NONE });
        }
        let joint = self.joints.get(self.joint_of(coordinate))?;
        let part = coordinate - joint.coordinates.start;
        let translates = match joint.kind? {
            JointKind::Prismatic | JointKind::Node => true,
            JointKind::Planar => part < 2,
            JointKind::Free => part < 3,
            JointKind::Revolute | JointKind::Screw | JointKind::Universal => false,
        };
        Some(if translates { Dimension::LENGTH } else { Dimension::NONE })
    }

    pub(super) fn wrong_kind(
        &mut self,
        path: &Path,
        found: Entity,
        want: &str,
        code: &'static str,
    ) {
        let what = match found {
            Entity::Time => "time",
            Entity::Own(_) => "a number",
            Entity::Pi => "a number",
            Entity::Named(NamedId::Const(_)) => "a const",
            Entity::Named(NamedId::Param(_)) => "a param",
            Entity::Named(NamedId::Input(_)) => "an input",
            Entity::Named(NamedId::Argument(_)) => "a parameter of the component",
            Entity::Frame(_) => "a frame",
            Entity::Joint(_) => "a joint",
            Entity::Coordinate(_) => "a coordinate",
            Entity::Instance(_) => "an instance of a component",
            Entity::Strand(_) => "a strand",
            Entity::Constraint(_) => "a constraint",
            Entity::Multiplier(..) => "a multiplier",
        };
        let name = path.parts.iter().map(|p| p.text.as_str()).collect::<Vec<_>>().join(".");
        let message = format!("expected {want}, but `{name}` is {what}");
        self.report(Diagnostic::error(code, path.span, message));
    }

    /// The strand a name stands for.
    pub(super) fn strand(&mut self, scope: ScopeId, path: &'a ast::Path) -> Option<usize> {
        match self.entity(scope, path)? {
            Entity::Strand(index) => Some(index),
            other => {
                self.wrong_kind(path, other, "a strand", "not-a-strand");
                None
            }
        }
    }
}
