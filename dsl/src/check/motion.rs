//! Poses, motions through them, and the strands that follow.

use super::depend::May;
use super::scenario::{Draft, Seen};
use super::scope::ScopeId;
use super::{Checker, constant};
use crate::ast::{self, Block, Ident, Path, Statement};
use crate::diagnostic::Diagnostic;
use crate::dimension::Dimension;
use crate::hir::{CoordinateId, Expr, Follow, Motion, Name, Pose, StrandId};
use crate::source::Span;
use crate::suggest::nearest;

impl<'a> Checker<'a> {
    pub(super) fn pose(
        &mut self,
        root: ScopeId,
        draft: &mut Draft,
        statement: &'a Statement,
        name: &'a Ident,
        block: &'a Block,
    ) {
        if let Some(first) = draft.scenario.poses.iter().find(|p| p.name.text == name.text) {
            let message = format!("the pose `{}` is given twice", name.text);
            self.report(
                Diagnostic::error("duplicate", name.span, message)
                    .also(first.name.span, "first given here"),
            );
        }
        let mut values: Vec<(CoordinateId, Expr)> = Vec::new();
        let mut seen = Seen::new();
        for setting in &block.settings {
            for (id, value) in self.on_coordinates(root, setting, "pose", May::PARAMS, 0) {
                let what = format!("`{}`", self.coordinate_names[id.index()]);
                if self.once(&mut seen, ("pose", id.index()), setting.name.span, &what) {
                    values.push((id, value));
                }
            }
        }
        let name = Name { text: name.text.clone(), doc: statement.doc.clone(), span: name.span };
        draft.scenario.poses.push(Pose { name, values });
    }

    pub(super) fn motion(
        &mut self,
        root: ScopeId,
        draft: &mut Draft,
        statement: &'a Statement,
        name: &'a Ident,
        knots: &'a [(Ident, ast::Expr)],
    ) {
        if let Some(first) = draft.scenario.motions.iter().find(|m| m.name.text == name.text) {
            let message = format!("the motion `{}` is given twice", name.text);
            self.report(
                Diagnostic::error("duplicate", name.span, message)
                    .also(first.name.span, "first given here"),
            );
        }
        let mut read = Vec::new();
        let mut before: Option<(f64, Span)> = None;
        for (pose, time) in knots {
            let index = self.pose_named(draft, pose);
            let what = "the time of a pose";
            let time = self.expect(root, time, Dimension::TIME, what, May::PARAMS);
            if let Some(now) = time.as_ref().and_then(constant) {
                let span = time.as_ref().map_or(pose.span, |e| e.span);
                if let Some((last, first)) = before
                    && now <= last
                {
                    let message = "the times of a motion must increase";
                    self.report(
                        Diagnostic::error("times", span, message).also(first, "the time before"),
                    );
                }
                before = Some((now, span));
            }
            read.extend(index.zip(time));
        }
        let name = Name { text: name.text.clone(), doc: statement.doc.clone(), span: name.span };
        draft.scenario.motions.push(Motion { name, knots: read });
    }

    fn pose_named(&mut self, draft: &Draft, pose: &Ident) -> Option<usize> {
        let poses = &draft.scenario.poses;
        let index = poses.iter().position(|p| p.name.text == pose.text);
        if index.is_none() && !draft.nameless && !draft.broken.contains(&pose.text) {
            let message = format!("there is no pose `{}`", pose.text);
            let near = nearest(&pose.text, poses.iter().map(|p| p.name.text.as_str()))
                .map(|n| format!("did you mean `{n}`?"));
            self.report(
                Diagnostic::error("unknown-name", pose.span, message)
                    .help("declare it in this scenario: `pose NAME { JOINT = value; }`")
                    .help_if(near),
            );
        }
        index
    }

    pub(super) fn follow_motion(
        &mut self,
        root: ScopeId,
        draft: &mut Draft,
        span: Span,
        motion: &'a Ident,
        strands: Option<&'a [Path]>,
    ) {
        let motions = &draft.scenario.motions;
        let index = motions.iter().position(|m| m.name.text == motion.text);
        if index.is_none() && !draft.nameless && !draft.broken.contains(&motion.text) {
            let message = format!("there is no motion `{}`", motion.text);
            let near = nearest(&motion.text, motions.iter().map(|m| m.name.text.as_str()))
                .map(|n| format!("did you mean `{n}`?"));
            self.report(
                Diagnostic::error("unknown-name", motion.span, message)
                    .help("declare it in this scenario: `motion = POSE @ 0 s -> POSE @ 1 s;`")
                    .help_if(near),
            );
        }
        let mut list: Vec<StrandId> = Vec::new();
        match strands {
            None => {
                for id in 0..self.strands.len() {
                    if self.once(
                        &mut draft.seen,
                        ("follow", id),
                        span,
                        "the motion of every strand",
                    ) {
                        list.push(StrandId(id as u32));
                    } else {
                        break;
                    }
                }
            }
            Some(paths) => {
                for path in paths {
                    let Some(id) = self.strand(root, path) else { continue };
                    let what = format!("the motion of `{}`", self.strands[id].name.text);
                    if self.once(&mut draft.seen, ("follow", id), path.span, &what) {
                        list.push(StrandId(id as u32));
                    }
                }
            }
        }
        if let Some(motion) = index {
            draft.scenario.follow.push(Follow { motion, strands: list, span });
        }
    }
}
