//! Strands.

use super::depend::May;
use super::muscle;
use super::options::Options;
use super::range::{NOT_NEGATIVE, POSITIVE};
use super::scope::{Entry, ScopeId};
use super::{Checker, Item, Named, State, Value};
use crate::ast::{Block, Decl, DeclKind, Expr, ExprKind, Setting};
use crate::diagnostic::Diagnostic;
use crate::dimension::Dimension;
use crate::hir;
use crate::source::Span;

const OPTIONS: [&str; 12] = [
    "stiffness",
    "rest",
    "damping",
    "slack",
    "slack_width",
    "energy",
    "tension",
    "actuated",
    "drive",
    "friction",
    "friction_speed",
    "quasi_static",
];
/// Each of these is a law; a strand has one.
const LAWS: [&str; 5] = ["stiffness", "energy", "tension", "drive", "muscle"];
/// Width of slack where none is given (m).
const SLACK_WIDTH: f64 = 1e-4;
/// Speed that smooths friction where none is given (m/s).
const FRICTION_SPEED: f64 = 1e-3;

/// An option of a strand by name, unless it is switched off.
pub(super) fn wanted<'a>(block: &'a Block, name: &str) -> Option<&'a Setting> {
    let is_named = |s: &&Setting| matches!(&s.name.parts[..], [n] if n.text == name);
    block.settings.iter().find(is_named).filter(|s| word(&s.value) != Some("false"))
}

impl<'a> Checker<'a> {
    /// Enters what a strand brings besides itself: an input, a constraint.
    pub(super) fn enter_strand(
        &mut self,
        scope: ScopeId,
        decl: &'a Decl,
        name: hir::Name,
        block: &'a Block,
    ) {
        let strand = self.strands.len() - 1;
        if wanted(block, "actuated").is_some() {
            let text = format!("{}.rest", name.text);
            let input = hir::Name { text, ..name.clone() };
            self.take("name", &input);
            let default = wanted(block, "rest").map(|s| &s.value);
            // Without a natural length of its own it starts at the length it has: not known here.
            let unknown = super::number(f64::NAN, Dimension::LENGTH, name.span);
            self.inputs.push(Named {
                scope,
                name: input,
                value: default,
                dimension: Some(Dimension::LENGTH),
                state: match default {
                    Some(_) => State::Pending,
                    None => State::Done(Some(Value::Scalar(unknown))),
                },
            });
            self.actuators.push((strand, self.inputs.len() - 1));
        }
        self.enter_muscle(scope, strand, &name, block);
        if wanted(block, "drive").is_some() && self.take("constraint", &name) {
            let index = self.constraints.len();
            self.scopes[scope.0].constraints.insert(&decl.name.text, Entry::Constraint(index));
            self.constraints.push(Item { scope, decl, name });
            self.prescribed.push((strand, index));
        }
    }

    pub(super) fn finish_strands(&mut self) -> Vec<hir::Strand> {
        let mut strands = Vec::new();
        for index in 0..self.strands.len() {
            let item = &self.strands[index];
            let (scope, decl, name) = (item.scope, item.decl, item.name.clone());
            let DeclKind::Strand(paths, block) = &decl.kind else { continue };
            let known = std::iter::once("path").chain(OPTIONS).chain(muscle::OPTIONS);
            let known: Vec<&str> = known.collect();
            let options = self.options(block, "a strand", &known);
            let path = self.path(scope, paths, options.broken, name.span);
            let law = self.law(scope, index, name.span, block, &options);
            let rest = self.rest(scope, index, block, &options);
            let damping = options.get("damping").and_then(|text| {
                let what = "`damping` of a strand";
                self.expect(scope, text, Dimension::DAMPING, what, May::PARAMS)
            });
            if let Some(damping) = &damping {
                let message = "`damping` of a strand cannot be negative";
                self.must(damping, NOT_NEGATIVE, message);
            }
            let slack = self.slack(scope, name.span, block, &options);
            let friction = self.friction(scope, name.span, block, &options);
            if let (Some(_), Some((path, wraps))) = (&friction, &path) {
                self.may_slide(path, wraps, name.span);
            }
            let actuator = self.actuators.iter().find(|a| a.0 == index);
            let actuator = actuator.map(|&(_, input)| hir::InputId(input as u32));
            if let (Some((path, wraps)), Some(law)) = (path, law) {
                strands.push(hir::Strand {
                    name,
                    path,
                    wraps,
                    law,
                    damping,
                    slack,
                    quasi_static: wanted(block, "quasi_static").is_some(),
                    friction,
                    rest,
                    actuator,
                    span: decl.span,
                });
            }
        }
        strands
    }

    /// The one law of a strand.
    fn law(
        &mut self,
        scope: ScopeId,
        index: usize,
        span: Span,
        block: &'a Block,
        options: &Options<'a>,
    ) -> Option<hir::Law> {
        let given: Vec<&'a Setting> = LAWS.iter().filter_map(|law| wanted(block, law)).collect();
        if let [first, second, ..] = given[..] {
            let message = "a strand has one law";
            self.report(
                Diagnostic::error("two-laws", second.span, message)
                    .also(first.span, "the first is here")
                    .help("keep one of `stiffness`, `energy`, `tension`, `drive` and `muscle`"),
            );
        }
        let Some(law) = given.first() else {
            if !options.broken {
                let error = Diagnostic::error("missing-option", span, "a strand needs a law");
                self.report(error.help(
                    "add `stiffness = 200 N/m;` to its block; other laws are `energy`, `tension`, \
                     `drive` and `muscle`",
                ));
            }
            return None;
        };
        let text = &law.value;
        if law.name.parts[0].text != "muscle" {
            self.not_a_muscle(options);
        }
        match law.name.parts[0].text.as_str() {
            "stiffness" => {
                let what = "`stiffness` of a strand";
                let stiffness =
                    self.expect(scope, text, Dimension::STIFFNESS, what, May::PARAMS)?;
                let message = "`stiffness` of a strand cannot be negative";
                self.must(&stiffness, NOT_NEGATIVE, message);
                Some(hir::Law::Stiffness(stiffness))
            }
            "energy" => {
                self.in_law = true;
                let what = "`energy` of a strand";
                let energy = self.expect(scope, text, Dimension::ENERGY, what, May::ENERGY);
                self.in_law = false;
                Some(hir::Law::Energy(energy?))
            }
            "tension" => {
                self.in_law = true;
                let what = "`tension` of a strand";
                let tension = self.expect(scope, text, Dimension::FORCE, what, May::TENSION);
                self.in_law = false;
                let tension = tension?;
                let message = "a strand pulls: its tension cannot be negative";
                self.must(&tension, NOT_NEGATIVE, message);
                Some(hir::Law::Tension(tension))
            }
            "muscle" => {
                let muscle = self.muscle(scope, index, text, span, options)?;
                Some(hir::Law::Muscle(Box::new(muscle)))
            }
            _ => {
                let &(_, constraint) = self.prescribed.iter().find(|p| p.0 == index)?;
                Some(hir::Law::Prescribed(hir::ConstraintId(constraint as u32)))
            }
        }
    }

    /// Natural length: what is given, the strand's own input, or the length that is prescribed.
    fn rest(
        &mut self,
        scope: ScopeId,
        index: usize,
        block: &'a Block,
        options: &Options<'a>,
    ) -> Option<hir::Expr> {
        let drive = wanted(block, "drive").filter(|s| word(&s.value) != Some("true"));
        if let (Some(rest), Some(drive)) = (options.setting("rest"), wanted(block, "drive")) {
            let message = "a strand whose length is prescribed has no natural length";
            self.report(
                Diagnostic::error("two-laws", rest.span, message)
                    .also(drive.span, "its length is prescribed here"),
            );
        }
        let (text, what) = match drive {
            Some(drive) => (Some(&drive.value), "`drive` of a strand"),
            None => (options.get("rest"), "`rest` of a strand"),
        };
        let given =
            text.and_then(|text| self.expect(scope, text, Dimension::LENGTH, what, May::REST));
        if let Some(given) = &given {
            self.must(given, NOT_NEGATIVE, "a natural length cannot be negative");
        }
        let actuator = self.actuators.iter().find(|a| a.0 == index);
        match actuator {
            Some(&(_, input)) => {
                let span = self.inputs[input].name.span;
                let kind = hir::ExprKind::Input(hir::InputId(input as u32));
                Some(hir::Expr { kind, dimension: Dimension::LENGTH, span })
            }
            None => given,
        }
    }

    /// Friction coefficient, and the speed that smooths its sign.
    fn friction(
        &mut self,
        scope: ScopeId,
        span: Span,
        block: &'a Block,
        options: &Options<'a>,
    ) -> Option<[hir::Expr; 2]> {
        let speed = options.setting("friction_speed");
        let Some(coefficient) = options.setting("friction") else {
            if let Some(speed) = speed {
                let message = "`friction_speed` does nothing without `friction`";
                self.report(Diagnostic::warning("no-effect", speed.name.span, message));
            }
            return None;
        };
        if let Some(drive) = wanted(block, "drive") {
            let message = "a strand whose length is prescribed has no friction";
            self.report(
                Diagnostic::error("two-laws", coefficient.span, message)
                    .also(drive.span, "its length is prescribed here"),
            );
        }
        let what = "`friction` of a strand";
        let coefficient =
            self.expect(scope, &coefficient.value, Dimension::NONE, what, May::PARAMS)?;
        self.must(&coefficient, NOT_NEGATIVE, "a friction coefficient cannot be negative");
        let speed = match speed {
            None => super::number(FRICTION_SPEED, Dimension::VELOCITY, span),
            Some(speed) => {
                let what = "`friction_speed` of a strand";
                self.expect(scope, &speed.value, Dimension::VELOCITY, what, May::PARAMS)?
            }
        };
        self.must(&speed, POSITIVE, "`friction_speed` of a strand must be positive");
        Some([coefficient, speed])
    }

    /// Complains about friction of a path that has no point to slide over, or surfaces.
    fn may_slide(&mut self, path: &[hir::Point], wraps: &[hir::Wrap], span: Span) {
        if let Some(wrap) = wraps.first() {
            let message = "friction acts at points, not over surfaces";
            let error = Diagnostic::error("friction", wrap.span, message);
            self.report(
                error.help("replace the surface by points along the arc, or leave friction out"),
            );
        } else if path.len() < 3 {
            let message = "this strand has friction, but no point between its ends to slide over";
            let error = Diagnostic::warning("no-effect", span, message);
            self.report(error.help("add a point to its path"));
        }
    }

    /// The width over which a strand goes slack, if it does.
    fn slack(
        &mut self,
        scope: ScopeId,
        span: Span,
        block: &'a Block,
        options: &Options<'a>,
    ) -> Option<hir::Expr> {
        for name in ["slack", "actuated", "quasi_static"] {
            if let Some(setting) = options.setting(name)
                && !matches!(word(&setting.value), Some("true" | "false"))
            {
                let message = format!("`{name}` of a strand is `true` or `false`");
                self.report(Diagnostic::error("value", setting.value.span, message));
            }
        }
        let slack = wanted(block, "slack");
        if let (Some(slack), Some(drive)) = (slack, wanted(block, "drive")) {
            let message = "a strand whose length is prescribed is never slack";
            self.report(
                Diagnostic::error("two-laws", slack.span, message)
                    .also(drive.span, "its length is prescribed here"),
            );
        }
        let Some(width) = options.setting("slack_width") else {
            return slack.map(|_| super::number(SLACK_WIDTH, Dimension::LENGTH, span));
        };
        if slack.is_none() {
            let message = "`slack_width` does nothing without `slack = true`";
            self.report(Diagnostic::warning("no-effect", width.name.span, message));
        }
        let what = "`slack_width` of a strand";
        let width = self.expect(scope, &width.value, Dimension::LENGTH, what, May::PARAMS)?;
        self.must(&width, POSITIVE, "`slack_width` of a strand must be positive");
        slack.map(|_| width)
    }
}

/// The single word that a value is, if it is one.
pub(super) fn word(value: &Expr) -> Option<&str> {
    match &value.kind {
        ExprKind::Path(path) if path.parts.len() == 1 => Some(&path.parts[0].text),
        _ => None,
    }
}
