//! Torques and forces.

use super::Checker;
use super::depend::May;
use crate::ast::DeclKind;
use crate::dimension::Dimension;
use crate::hir::{self, CoordinateId, WORLD};

impl Checker<'_> {
    pub(super) fn finish_torques(&mut self) -> Vec<hir::Torque> {
        let mut torques = Vec::new();
        for item in std::mem::take(&mut self.torques) {
            let DeclKind::Torque(joint, value) = &item.decl.kind else { continue };
            let coordinate = self.coordinate(item.scope, joint);
            let coordinate = coordinate.filter(|&c| {
                let what = "no torque or force can act on it";
                self.of_joint(c, joint.span, what).is_some()
            });
            let Some(coordinate) = coordinate else {
                self.value(item.scope, value);
                continue;
            };
            let (want, what) = match self.coordinate_dimension(coordinate) {
                Some(Dimension::LENGTH) => (Dimension::FORCE, "a torque on a translation"),
                _ => (Dimension::TORQUE, "a torque on a rotation"),
            };
            if let Some(value) = self.expect(item.scope, value, want, what, May::LOAD) {
                let coordinate = CoordinateId(coordinate as u32);
                torques.push(hir::Torque { name: item.name, coordinate, value });
            }
        }
        torques
    }

    pub(super) fn finish_forces(&mut self) -> Vec<hir::Force> {
        let mut forces = Vec::new();
        for item in std::mem::take(&mut self.forces) {
            let DeclKind::Force(point, value, frame) = &item.decl.kind else { continue };
            let point = self.point(item.scope, point);
            let (want, what) = (Dimension::FORCE, "a force");
            let value = self.vector(item.scope, value, want, what, May::LOAD);
            let frame = match frame {
                None => Some(WORLD),
                Some(path) => self.frame(item.scope, path).map(|f| self.frame_ids[f]),
            };
            if let (Some(point), Some(value), Some(frame)) = (point, value, frame) {
                forces.push(hir::Force { name: item.name, point, value, frame });
            }
        }
        forces
    }
}
