//! Muscles: a strand with `muscle = thelen2003;` and the numbers of its fibres and its tendon.
//!
//! A muscle brings two coordinates that move no joint, `N.fibre` and `N.activation`, which stand
//! among the coordinates where the strand is declared, and an input `N.excitation`.

use super::depend::May;
use super::name::Entity;
use super::options::Options;
use super::range::{NOT_NEGATIVE, POSITIVE};
use super::scope::ScopeId;
use super::strand::{wanted, word};
use super::value::NamedId;
use super::{Checker, Named, State, Value, number, zero_vector};
use crate::ast::{Block, Expr as Text, Ident};
use crate::diagnostic::Diagnostic;
use crate::dimension::Dimension;
use crate::hir::{self, Coordinate, CoordinateId, Expr, InputId, MotionKind, Name, Owner};
use crate::source::Span;
use crate::suggest::nearest;
use std::f64::consts::FRAC_PI_2;

/// Models of muscles.
const MODELS: [&str; 1] = ["thelen2003"];
const FREQUENCY: Dimension = Dimension::ANGULAR_VELOCITY;
/// Numbers of a muscle: name, dimension, what stands where it is left out, an example.
#[rustfmt::skip]
const NUMBERS: [(&str, Dimension, Option<f64>, &str); 11] = [
    ("max_force", Dimension::FORCE, None, "max_force = 100 N;"),
    ("optimal_fibre", Dimension::LENGTH, None, "optimal_fibre = 60 mm;"),
    ("tendon_slack", Dimension::LENGTH, None, "tendon_slack = 250 mm;"),
    ("pennation", Dimension::ANGLE, Some(0.0), ""),
    ("max_velocity", FREQUENCY, Some(10.0), ""),
    ("tendon_strain", Dimension::NONE, Some(0.033), ""),
    ("passive_strain", Dimension::NONE, Some(0.6), ""),
    ("eccentric_force", Dimension::NONE, Some(1.4), ""),
    ("fibre_damping", Dimension::NONE, Some(0.01), ""),
    ("activation_time", Dimension::TIME, Some(0.015), ""),
    ("deactivation_time", Dimension::TIME, Some(0.050), ""),
];
/// Options of a strand that only a muscle has.
pub(super) const OPTIONS: [&str; 14] = [
    "muscle",
    "max_force",
    "optimal_fibre",
    "tendon_slack",
    "pennation",
    "max_velocity",
    "tendon_strain",
    "passive_strain",
    "eccentric_force",
    "fibre_damping",
    "activation_time",
    "deactivation_time",
    "excitation",
    "activation",
];
/// Options of a strand that a muscle has not, and why.
const OTHERS: [(&str, &str); 4] = [
    ("rest", "a muscle has no natural length: write `tendon_slack` and `optimal_fibre`"),
    ("slack", "the tendon of a muscle goes slack by itself"),
    ("slack_width", "the tendon of a muscle goes slack by itself"),
    ("actuated", "a muscle is told its `excitation`, not a natural length"),
];

/// A muscle on the way.
pub(super) struct RawMuscle {
    pub(super) strand: usize,
    /// Its first coordinate, the fibre length; the activation follows.
    pub(super) fibre: usize,
    /// Its input.
    pub(super) excitation: usize,
}

impl<'a> Checker<'a> {
    /// Enters coordinates and input of a strand that is a muscle.
    pub(super) fn enter_muscle(
        &mut self,
        scope: ScopeId,
        strand: usize,
        name: &Name,
        block: &'a Block,
    ) {
        if wanted(block, "muscle").is_none() {
            return;
        }
        let part = |part: &str| Name { text: format!("{}.{part}", name.text), ..name.clone() };
        let fibre = self.coordinate_names.len();
        for coordinate in ["fibre", "activation"].map(part) {
            self.take("name", &coordinate);
            self.coordinate_names.push(coordinate.text);
        }
        let input = part("excitation");
        self.take("name", &input);
        let default = wanted(block, "excitation").map(|s| &s.value);
        let none = Value::Scalar(number(0.0, Dimension::NONE, name.span));
        self.inputs.push(Named {
            scope,
            name: input,
            value: default,
            dimension: Some(Dimension::NONE),
            state: if default.is_some() { State::Pending } else { State::Done(Some(none)) },
        });
        self.muscles.push(RawMuscle { strand, fibre, excitation: self.inputs.len() - 1 });
    }

    /// `S.fibre`, `S.activation`, `S.excitation` of a muscle.
    pub(super) fn muscle_part(&self, strand: usize, part: &Ident) -> Option<Entity> {
        let muscle = self.muscles.iter().find(|m| m.strand == strand)?;
        match part.text.as_str() {
            "fibre" => Some(Entity::Coordinate(muscle.fibre)),
            "activation" => Some(Entity::Coordinate(muscle.fibre + 1)),
            "excitation" => Some(Entity::Named(NamedId::Input(muscle.excitation))),
            _ => None,
        }
    }

    /// The muscle that a coordinate belongs to, and which of its two it is.
    pub(super) fn muscle_of(&self, coordinate: usize) -> Option<(&RawMuscle, usize)> {
        let has = |m: &&RawMuscle| (m.fibre..m.fibre + 2).contains(&coordinate);
        self.muscles.iter().find(has).map(|m| (m, coordinate - m.fibre))
    }

    /// Complains where a coordinate must be one of a joint.
    pub(super) fn of_joint(&mut self, coordinate: usize, span: Span, what: &str) -> Option<()> {
        if self.muscle_of(coordinate).is_none() {
            return Some(());
        }
        let name = &self.coordinate_names[coordinate];
        let message = format!("`{name}` is of a muscle: {what}");
        self.report(Diagnostic::error("of-a-muscle", span, message));
        None
    }

    /// Complains about a coordinate of a muscle in an expression.
    pub(super) fn without_muscles(&mut self, expr: &Expr, what: &str) -> Option<()> {
        let found = expr.find(&|kind| match kind {
            hir::ExprKind::Coordinate(id) => self.muscle_of(id.index()).is_some(),
            _ => false,
        });
        let Some(Expr { kind: hir::ExprKind::Coordinate(id), span, .. }) = found else {
            return Some(());
        };
        let (id, span) = (id.index(), *span);
        self.of_joint(id, span, what)
    }

    /// Coordinates of the muscles, with their place among all.
    pub(super) fn muscle_coordinates(&self) -> Vec<(usize, Coordinate)> {
        let mut coordinates = Vec::new();
        for muscle in &self.muscles {
            let owner = Owner::Muscle(hir::StrandId(muscle.strand as u32));
            let name = &self.strands[muscle.strand].name;
            let parts =
                [(MotionKind::Fibre, Dimension::LENGTH), (MotionKind::Activation, Dimension::NONE)];
            for (part, (motion, dimension)) in parts.into_iter().enumerate() {
                let index = muscle.fibre + part;
                let text = self.coordinate_names[index].clone();
                let rate = dimension.over(Dimension::TIME).unwrap_or(dimension);
                coordinates.push((
                    index,
                    Coordinate {
                        name: Name { text, ..name.clone() },
                        owner,
                        motion,
                        axis: zero_vector(Dimension::NONE, name.span),
                        start: number(0.0, dimension, name.span),
                        velocity: number(0.0, rate, name.span),
                        damping: None,
                        stiffness: None,
                        rest: None,
                        limits: None,
                        limit_stiffness: None,
                        limit_width: None,
                        drive: None,
                    },
                ));
            }
        }
        coordinates
    }

    /// The law of a muscle.
    pub(super) fn muscle(
        &mut self,
        scope: ScopeId,
        strand: usize,
        model: &'a Text,
        span: Span,
        options: &Options<'a>,
    ) -> Option<hir::Muscle> {
        self.muscle_model(model);
        for (name, why) in OTHERS {
            if let Some(setting) = options.setting(name) {
                self.report(Diagnostic::error("two-laws", setting.span, why));
            }
        }
        let mut numbers = Vec::new();
        for (name, dimension, default, example) in NUMBERS {
            let value = match (options.get(name), default) {
                (Some(text), _) => {
                    let what = format!("`{name}` of muscle `{}`", self.strands[strand].name.text);
                    let value = self.expect(scope, text, dimension, &what, May::PARAMS);
                    if let Some(value) = &value {
                        self.muscle_range(strand, name, value);
                    }
                    value
                }
                (None, Some(default)) => Some(number(default, dimension, span)),
                (None, None) => {
                    self.missing(options, span, "a muscle", name, example);
                    None
                }
            };
            numbers.push(value);
        }
        // The default is looked at where inputs are; here only its range.
        if let Some(value) = options.get("excitation").and_then(|text| self.quietly(scope, text)) {
            self.muscle_range(strand, "excitation", &value);
        }
        let start = options.get("activation").map(|text| {
            let what = "`activation` of a muscle at the start";
            let value = self.expect(scope, text, Dimension::NONE, what, May::PARAMS);
            if let Some(value) = &value {
                self.muscle_range(strand, "activation", value);
            }
            value
        });
        let raw = self.muscles.iter().find(|m| m.strand == strand)?;
        let (fibre, excitation) = (raw.fibre as u32, InputId(raw.excitation as u32));
        let numbers: Option<Vec<Expr>> = numbers.into_iter().collect();
        Some(hir::Muscle {
            fibre: CoordinateId(fibre),
            activation: CoordinateId(fibre + 1),
            excitation,
            start: match start {
                None => None,
                Some(start) => Some(start?),
            },
            numbers: numbers?.try_into().ok()?,
        })
    }

    fn muscle_model(&mut self, text: &Text) {
        let given = word(text);
        if given.is_some_and(|given| MODELS.contains(&given)) {
            return;
        }
        let message = match given {
            Some(given) => format!("unknown model of a muscle `{given}`"),
            None => "`muscle` of a strand is the name of a model".to_string(),
        };
        let near = given.and_then(|given| nearest(given, MODELS.iter().copied()));
        let help = match near {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("write `muscle = {};`", MODELS[0]),
        };
        self.report(Diagnostic::error("unknown-muscle", text.span, message).help(help));
    }

    /// Complains about muscle options of a strand that is none.
    pub(super) fn not_a_muscle(&mut self, options: &Options<'a>) {
        let given = OPTIONS.iter().find_map(|name| options.setting(name));
        if let Some(setting) = given.filter(|s| s.name.parts[0].text != "muscle") {
            let message = format!("`{}` is an option of muscles", setting.name.parts[0].text);
            let error = Diagnostic::error("not-a-muscle", setting.name.span, message);
            self.report(error.help(format!("add `muscle = {};`", MODELS[0])));
        }
    }

    /// What an expression says, without complaints.
    fn quietly(&mut self, scope: ScopeId, text: &'a Text) -> Option<Expr> {
        let before = self.out.len();
        let value = self.scalar(scope, text);
        self.out.truncate(before);
        value
    }

    /// Complains about a constant out of its range.
    fn muscle_range(&mut self, strand: usize, name: &str, value: &Expr) {
        let what = format!("`{name}` of muscle `{}`", self.strands[strand].name.text);
        match name {
            "excitation" | "activation" => {
                let message = format!("{what} lies between 0 and 1");
                self.must(value, 0.0..=1.0, &message);
            }
            "pennation" => {
                let message = format!("{what} lies between 0 and 90 deg");
                self.must(value, 0.0..=FRAC_PI_2.next_down(), &message);
            }
            "eccentric_force" => {
                let message = format!("{what} is above 1: lengthening fibres resist more");
                self.must(value, 1f64.next_up()..=f64::INFINITY, &message);
            }
            "fibre_damping" => {
                self.must(value, NOT_NEGATIVE, &format!("{what} cannot be negative"));
            }
            _ => self.must(value, POSITIVE, &format!("{what} must be positive")),
        }
    }
}
