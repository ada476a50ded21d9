//! Frames: parents found, ordered parents first, placements checked.

use super::depend::May;
use super::scope::ScopeId;
use super::{Checker, zero_vector};
use crate::ast;
use crate::diagnostic::Diagnostic;
use crate::dimension::Dimension;
use crate::hir::{self, FrameId, JointId, Placement, Rotation, Vector};
use crate::source::Span;

impl<'a> Checker<'a> {
    /// Finds parents and numbers the frames so that parents stand first. Answers the order.
    pub(super) fn order_frames(&mut self) -> Vec<(usize, Option<usize>)> {
        let count = self.frames.len();
        let mut parents: Vec<Option<usize>> = vec![None; count];
        for index in 1..count {
            let frame = &self.frames[index];
            let Some(placement) = frame.placement else {
                parents[index] = Some(0);
                continue;
            };
            let scope = frame.scope;
            parents[index] = Some(self.frame(scope, &placement.parent).unwrap_or(0));
        }
        let mut order: Vec<(usize, Option<usize>)> = Vec::with_capacity(count);
        // 0: not seen, 1: on the way up from a frame, 2: numbered.
        let mut mark = vec![0u8; count];
        self.frame_ids = vec![FrameId(0); count];
        for start in 0..count {
            let mut trail = Vec::new();
            let mut at = start;
            while mark[at] == 0 {
                mark[at] = 1;
                trail.push(at);
                match parents[at] {
                    Some(parent) if mark[parent] == 1 => {
                        self.frame_cycle(&trail, parent);
                        parents[at] = Some(0);
                        break;
                    }
                    Some(parent) => at = parent,
                    None => break,
                }
            }
            for &index in trail.iter().rev() {
                mark[index] = 2;
                self.frame_ids[index] = FrameId(order.len() as u32);
                order.push((index, parents[index]));
            }
        }
        order
    }

    fn frame_cycle(&mut self, trail: &[usize], back: usize) {
        let start = trail.iter().position(|&i| i == back).unwrap_or(0);
        let mut names: Vec<&str> =
            trail[start..].iter().map(|&i| self.frames[i].name.text.as_str()).collect();
        names.push(&self.frames[back].name.text);
        let message = format!("frames stand in each other: {}", names.join(" in "));
        let span = self.frames[back].name.span;
        self.report(Diagnostic::error("cycle", span, message));
    }

    pub(super) fn finish_frames(&mut self, order: &[(usize, Option<usize>)]) -> Vec<hir::Frame> {
        let mut frames = Vec::with_capacity(order.len());
        for &(index, parent) in order {
            let raw = &self.frames[index];
            let (scope, name, joint) = (raw.scope, raw.name.clone(), raw.joint);
            let placement = match raw.placement {
                Some(placement) => {
                    let own = self.placement(scope, placement);
                    joint.map_or(own.clone(), |joint| self.node_placement(joint, own))
                }
                None => Placement {
                    at: zero_vector(Dimension::LENGTH, name.span),
                    rotations: Vec::new(),
                },
            };
            let parent = parent.map(|p| self.frame_ids[p]);
            let joint = joint.map(|j| JointId(j as u32));
            frames.push(hir::Frame { name, parent, placement, joint });
        }
        frames
    }

    fn placement(&mut self, scope: ScopeId, placement: &'a ast::Placement) -> Placement {
        let at = self.position(scope, placement.at.as_ref(), "`at`", placement.parent.span);
        let mut rotations = Vec::new();
        for rotation in &placement.rotations {
            let axis = self.axis(scope, &rotation.axis, "the axis of `rotate`");
            let what = "the angle of `rotate`";
            let angle = self.expect(scope, &rotation.angle, Dimension::ANGLE, what, May::PARAMS);
            if let (Some(axis), Some(angle)) = (axis, angle) {
                rotations.push(Rotation { axis, angle });
            }
        }
        Placement { at, rotations }
    }

    /// A position in a frame; its origin if left out or wrong.
    pub(super) fn position(
        &mut self,
        scope: ScopeId,
        text: Option<&'a ast::Expr>,
        what: &str,
        span: Span,
    ) -> Vector {
        text.and_then(|e| self.vector(scope, e, Dimension::LENGTH, what, May::PARAMS))
            .unwrap_or_else(|| zero_vector(Dimension::LENGTH, span))
    }

    /// A point fixed in a frame.
    pub(super) fn point(&mut self, scope: ScopeId, point: &'a ast::Point) -> Option<hir::Point> {
        let frame = self.frame(scope, &point.frame);
        let offset = self.position(scope, point.offset.as_ref(), "a point", point.span);
        let frame = self.frame_ids[frame?];
        Some(hir::Point { frame, offset, span: point.span })
    }
}
