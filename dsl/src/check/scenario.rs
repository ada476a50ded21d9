//! Scenarios.

use super::depend::May;
use super::name::Entity;
use super::range::POSITIVE;
use super::scope::ScopeId;
use super::value::NamedId;
use super::{Checker, constant};
use crate::ast::{DeclKind, Ident, Setting, Statement, StatementKind};
use crate::diagnostic::Diagnostic;
use crate::dimension::Dimension;
use crate::hir::{CoordinateId, Expr, InputId, Name, ParamId, Record, Scenario, StrandId};
use crate::source::Span;
use crate::suggest::nearest;
use std::collections::BTreeMap;

/// Where things were first given in a scenario, to find repetitions.
pub(super) type Seen = BTreeMap<(&'static str, usize), Span>;

/// A scenario on the way.
pub(super) struct Draft {
    pub(super) scenario: Scenario,
    pub(super) seen: Seen,
    /// Names of poses and motions that could not be read.
    pub(super) broken: Vec<String>,
    /// Whether some `pose` or `motion` had no readable name.
    pub(super) nameless: bool,
}

impl<'a> Checker<'a> {
    pub(super) fn finish_scenarios(&mut self, root: ScopeId) -> Vec<Scenario> {
        let mut scenarios = Vec::new();
        for decl in std::mem::take(&mut self.scenarios) {
            let DeclKind::Scenario(statements) = &decl.kind else { continue };
            let (text, span) = (decl.name.text.clone(), decl.name.span);
            let name = Name { text, doc: decl.doc.clone(), span };
            self.take("scenario", &name);
            scenarios.push(self.scenario(root, name, statements));
        }
        scenarios
    }

    fn scenario(&mut self, root: ScopeId, name: Name, statements: &'a [Statement]) -> Scenario {
        let mut draft = Draft {
            scenario: Scenario {
                name,
                step: None,
                duration: None,
                tolerance: None,
                set: Vec::new(),
                start: Vec::new(),
                velocity: Vec::new(),
                inputs: Vec::new(),
                drives: Vec::new(),
                lengths: Vec::new(),
                poses: Vec::new(),
                motions: Vec::new(),
                follow: Vec::new(),
                records: Vec::new(),
            },
            seen: Seen::new(),
            broken: Vec::new(),
            nameless: false,
        };
        // Poses come first, then motions, so that the order of statements does not matter.
        for statement in statements {
            match &statement.kind {
                StatementKind::Pose(name, block) => {
                    self.pose(root, &mut draft, statement, name, block)
                }
                StatementKind::Broken(Some(name)) => draft.broken.push(name.text.clone()),
                StatementKind::Broken(None) => draft.nameless = true,
                _ => {}
            }
        }
        for statement in statements {
            if let StatementKind::Motion(name, knots) = &statement.kind {
                self.motion(root, &mut draft, statement, name, knots);
            }
        }
        for statement in statements {
            self.statement(root, &mut draft, statement);
        }
        self.step_fits(&draft.scenario);
        draft.scenario
    }

    /// `true` the first time; else complains.
    pub(super) fn once(
        &mut self,
        seen: &mut Seen,
        key: (&'static str, usize),
        span: Span,
        what: &str,
    ) -> bool {
        match seen.get(&key) {
            None => {
                seen.insert(key, span);
                true
            }
            Some(&first) => {
                let message = format!("{what} is given twice");
                self.report(
                    Diagnostic::error("duplicate", span, message).also(first, "first given here"),
                );
                false
            }
        }
    }

    fn statement(&mut self, root: ScopeId, draft: &mut Draft, statement: &'a Statement) {
        match &statement.kind {
            StatementKind::Setting(setting) => self.setting(root, draft, setting),
            StatementKind::Set(setting) => self.set(root, draft, setting),
            StatementKind::Start(setting) => {
                let values = self.on_coordinates(root, setting, "start", May::PARAMS, 0);
                let values = self.first_only(draft, "start", setting, values);
                draft.scenario.start.extend(values);
            }
            StatementKind::Velocity(setting) => {
                let values = self.on_coordinates(root, setting, "velocity", May::PARAMS, 1);
                if let Some((id, _)) = values.first() {
                    let what = "its rate follows from what the muscle is told";
                    self.of_joint(id.index(), setting.name.span, what);
                }
                let values = self.first_only(draft, "velocity", setting, values);
                draft.scenario.velocity.extend(values);
            }
            StatementKind::Drive(setting)
                if matches!(self.peek(root, &setting.name), Some(Entity::Strand(_))) =>
            {
                self.drive_strand(root, draft, setting);
            }
            StatementKind::Drive(setting) => {
                let values = self.on_coordinates(root, setting, "drive", May::TIME, 0);
                let values = self.first_only(draft, "drive", setting, values);
                draft.scenario.drives.extend(values);
            }
            StatementKind::Input(setting) => self.input(root, draft, setting),
            StatementKind::Follow(motion, strands) => {
                self.follow_motion(root, draft, statement.span, motion, strands.as_deref());
            }
            StatementKind::Record(value, name) => {
                let name = self.column(draft, statement, name);
                let value = self.scalar(root, value);
                if let (Some(name), Some(value)) = (name, value) {
                    draft.scenario.records.push(Record { name, value });
                }
            }
            StatementKind::Pose(..) | StatementKind::Motion(..) | StatementKind::Broken(_) => {}
        }
    }

    fn setting(&mut self, root: ScopeId, draft: &mut Draft, setting: &'a Setting) {
        let word = setting.name.parts.first().map_or("", |p| p.text.as_str());
        let known = ["step", "duration", "tolerance"];
        let key = known.iter().position(|k| *k == word && setting.name.parts.len() == 1);
        let Some(key) = key else {
            let message =
                format!("a scenario has no setting `{}`", self.sources.slice(setting.name.span));
            let mut error = Diagnostic::error("unknown-option", setting.name.span, message);
            if self.peek(root, &setting.name).is_some() {
                error = error.help(format!("to set it write `set {word} = ...`, `start {word} = ...` or `input {word} = ...`"));
            } else {
                let near = nearest(word, known).map(|n| format!("did you mean `{n}`?"));
                error = error.help("known are step, duration, tolerance").help_if(near);
            }
            self.report(error);
            return;
        };
        if !self.once(&mut draft.seen, ("setting", key), setting.span, &format!("`{word}`")) {
            return;
        }
        let want = if key == 2 { Dimension::NONE } else { Dimension::TIME };
        let what = format!("`{word}`");
        let value = self.expect(root, &setting.value, want, &what, May::PARAMS);
        // One of another scenario does not matter to a run.
        if let Some(value) = value.as_ref().filter(|value| constant(value).is_some()) {
            self.must(value, POSITIVE, &format!("`{word}` must be positive"));
        }
        match key {
            0 => draft.scenario.step = value,
            1 => draft.scenario.duration = value,
            _ => draft.scenario.tolerance = value,
        }
    }

    fn step_fits(&mut self, scenario: &Scenario) {
        let (Some(step), Some(duration)) = (&scenario.step, &scenario.duration) else { return };
        if let (Some(h), Some(d)) = (constant(step), constant(duration))
            && h > d
            && d > 0.0
        {
            let message = "the step is longer than the duration";
            self.report(
                Diagnostic::error("times", step.span, message).also(duration.span, "the duration"),
            );
        }
    }

    fn set(&mut self, root: ScopeId, draft: &mut Draft, setting: &'a Setting) {
        let id = match self.entity(root, &setting.name) {
            Some(Entity::Named(NamedId::Param(id))) => id,
            Some(Entity::Named(NamedId::Const(_))) => {
                let message = "a `const` cannot be set: it is fixed when the model is compiled";
                let error = Diagnostic::error("not-a-param", setting.name.span, message);
                self.report(error.help("declare it with `param`"));
                return;
            }
            Some(other) => return self.wrong_kind(&setting.name, other, "a param", "not-a-param"),
            None => return,
        };
        let name = self.params[id].name.text.clone();
        let Some(super::Value::Scalar(param)) = self.named(NamedId::Param(id), setting.name.span)
        else {
            return;
        };
        let what = format!("`{name}`");
        let value = self.expect(root, &setting.value, param.dimension, &what, May::PARAMS);
        if self.once(&mut draft.seen, ("set", id), setting.span, &what)
            && let Some(value) = value
        {
            draft.scenario.set.push((ParamId(id as u32), value));
        }
    }

    /// `drive STRAND = e;` for a strand whose length is prescribed.
    fn drive_strand(&mut self, root: ScopeId, draft: &mut Draft, setting: &'a Setting) {
        let Some(strand) = self.strand(root, &setting.name) else { return };
        let what = format!("`drive` of `{}`", self.strands[strand].name.text);
        let value = self.expect(root, &setting.value, Dimension::LENGTH, &what, May::TIME);
        if !self.prescribed.iter().any(|p| p.0 == strand) {
            let message =
                format!("the length of `{}` is not prescribed", self.strands[strand].name.text);
            let error = Diagnostic::error("not-prescribed", setting.name.span, message);
            self.report(error.help("write `drive = true;` in its block instead of its law"));
            return;
        }
        if self.once(&mut draft.seen, ("length", strand), setting.span, &what)
            && let Some(value) = value
        {
            draft.scenario.lengths.push((StrandId(strand as u32), value));
        }
    }

    fn input(&mut self, root: ScopeId, draft: &mut Draft, setting: &'a Setting) {
        let id = match self.entity(root, &setting.name) {
            Some(Entity::Named(NamedId::Input(id))) => id,
            Some(other) => {
                return self.wrong_kind(&setting.name, other, "an input", "not-an-input");
            }
            None => return,
        };
        let what = format!("`{}`", self.inputs[id].name.text);
        let Some(super::Value::Scalar(input)) = self.named(NamedId::Input(id), setting.name.span)
        else {
            return;
        };
        let value = self.expect(root, &setting.value, input.dimension, &what, May::TIME);
        if self.once(&mut draft.seen, ("input", id), setting.span, &what)
            && let Some(value) = value
        {
            draft.scenario.inputs.push((InputId(id as u32), value));
        }
    }

    /// Values for one coordinate or all of a joint's; `order` counts time derivatives.
    pub(super) fn on_coordinates(
        &mut self,
        root: ScopeId,
        setting: &'a Setting,
        word: &str,
        may: May,
        order: usize,
    ) -> Vec<(CoordinateId, Expr)> {
        let Some(range) = self.coordinates(root, &setting.name) else { return Vec::new() };
        let mut want = Vec::new();
        for index in range.clone() {
            let Some(mut dimension) = self.coordinate_dimension(index) else { return Vec::new() };
            if order == 1 {
                dimension = dimension.over(Dimension::TIME).unwrap_or(dimension);
            }
            want.push(dimension);
        }
        let name = self.sources.slice(setting.name.span);
        let what = match word {
            "pose" => format!("the pose of `{name}`"),
            _ => format!("`{word}` of `{name}`"),
        };
        let values = self.per_coordinate(root, &setting.value, &want, &what, may);
        range.map(|c| CoordinateId(c as u32)).zip(values.unwrap_or_default()).collect()
    }

    fn first_only(
        &mut self,
        draft: &mut Draft,
        word: &'static str,
        setting: &Setting,
        values: Vec<(CoordinateId, Expr)>,
    ) -> Vec<(CoordinateId, Expr)> {
        let mut kept = Vec::new();
        for (id, value) in values {
            let what = format!("`{word}` of `{}`", self.coordinate_names[id.index()]);
            if self.once(&mut draft.seen, (word, id.index()), setting.name.span, &what) {
                kept.push((id, value));
            }
        }
        kept
    }

    /// The name of a recorded column, if it is new.
    fn column(&mut self, draft: &Draft, statement: &Statement, name: &Ident) -> Option<Name> {
        if let Some(first) = draft.scenario.records.iter().find(|r| r.name.text == name.text) {
            let message = format!("the column `{}` is recorded twice", name.text);
            self.report(
                Diagnostic::error("duplicate", name.span, message)
                    .also(first.name.span, "first given here"),
            );
            return None;
        }
        let own = name.text == "energy" || self.coordinate_names.contains(&name.text);
        if own {
            let message = format!("the column `{}` is written anyway", name.text);
            let error = Diagnostic::warning("duplicate-column", name.span, message);
            self.report(error.help("give the recorded column another name"));
        }
        Some(Name { text: name.text.clone(), doc: statement.doc.clone(), span: name.span })
    }
}
