//! What a quantity may depend on.

use super::Checker;
use crate::diagnostic::Diagnostic;
use crate::hir::{Expr, ExprKind, Function, Own};
use crate::source::Span;

/// What is allowed in a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct May {
    pub(super) params: bool,
    pub(super) time: bool,
    pub(super) inputs: bool,
    pub(super) coordinates: bool,
    /// Lengths of strands.
    pub(super) lengths: bool,
    pub(super) rates: bool,
    pub(super) multipliers: bool,
    /// Length and natural length of the strand whose law it is.
    pub(super) own: bool,
}

impl May {
    /// Fixed when the model is compiled.
    pub(super) const CONST: May = May {
        params: false,
        time: false,
        inputs: false,
        coordinates: false,
        lengths: false,
        rates: false,
        multipliers: false,
        own: false,
    };
    /// Constants and parameters: what the mechanism is made of.
    pub(super) const PARAMS: May = May { params: true, ..May::CONST };
    /// Given functions of time.
    pub(super) const TIME: May = May { time: true, ..May::PARAMS };
    /// Natural lengths.
    pub(super) const REST: May = May { inputs: true, ..May::TIME };
    /// Constraint equations.
    pub(super) const HOLONOMIC: May = May { coordinates: true, lengths: true, ..May::TIME };
    /// Torques and forces: all but multipliers, which only a recorded column may hold.
    pub(super) const LOAD: May = May { rates: true, inputs: true, ..May::HOLONOMIC };
    /// Commanded tensions: the state, but for lengths of strands, of which there is `x`.
    pub(super) const TENSION: May = May { lengths: false, own: true, ..May::LOAD };
    /// Energies of strands.
    pub(super) const ENERGY: May = May { own: true, ..May::PARAMS };

    fn list(self) -> String {
        let mut words = vec!["constants"];
        for (allowed, word) in [
            (self.params, "parameters"),
            (self.own, "`x`, `x0`"),
            (self.time, "`t`"),
            (self.inputs, "inputs"),
            (self.coordinates && self.lengths, "coordinates and lengths"),
            (self.coordinates && !self.lengths, "coordinates"),
            (self.rates, "rates"),
        ] {
            if allowed {
                words.push(word);
            }
        }
        match words.as_slice() {
            [one] => (*one).to_string(),
            [rest @ .., last] => format!("{} and {last}", rest.join(", ")),
            [] => String::new(),
        }
    }
}

/// The first thing in an expression that is not allowed, and what it is.
fn offender(expr: &Expr, may: May) -> Option<(Span, &'static str)> {
    let here = |what| Some((expr.span, what));
    match &expr.kind {
        ExprKind::Param(_) if !may.params => here("a parameter"),
        ExprKind::Time if !may.time => here("time"),
        ExprKind::Input(_) if !may.inputs => here("an input"),
        ExprKind::Coordinate(_) if !may.coordinates => here("a coordinate"),
        ExprKind::Length(_) if !may.lengths => here("the length of a strand"),
        ExprKind::Own(Own::Rate) if !may.rates => here("a rate"),
        ExprKind::Strand(..) => here("what a strand does; only a recorded column may"),
        ExprKind::Rate(_) if !may.rates => here("a rate"),
        ExprKind::Multiplier(..) if !may.multipliers => here("a multiplier"),
        ExprKind::Call(Function::Ease, _) if !may.time => here("time, through `ease`"),
        ExprKind::Neg(inner) => offender(inner, may),
        ExprKind::Binary(_, left, right) => offender(left, may).or_else(|| offender(right, may)),
        ExprKind::Call(_, arguments) => arguments.iter().find_map(|a| offender(a, may)),
        ExprKind::If { left, right, then, otherwise, .. } => {
            [left, right, then, otherwise].iter().find_map(|e| offender(e, may))
        }
        _ => None,
    }
}

/// Whether an expression depends on nothing but what is allowed.
pub(super) fn is_allowed(expr: &Expr, may: May) -> bool {
    offender(expr, may).is_none()
}

/// Whether all that keeps an expression from being a constant are parameters handed in from outside
/// of `text`, as arguments of a component.
pub(super) fn through_arguments(expr: &Expr, text: Span) -> bool {
    let inside =
        |span: Span| span.file == text.file && text.start <= span.start && span.end <= text.end;
    offender(expr, May::PARAMS).is_none() && !reads_param(expr, &inside)
}

/// Whether an expression reads a parameter at a place for which `here` holds.
fn reads_param(expr: &Expr, here: &impl Fn(Span) -> bool) -> bool {
    match &expr.kind {
        ExprKind::Param(_) => here(expr.span),
        ExprKind::Neg(inner) => reads_param(inner, here),
        ExprKind::Binary(_, left, right) => reads_param(left, here) || reads_param(right, here),
        ExprKind::Call(_, arguments) => arguments.iter().any(|a| reads_param(a, here)),
        ExprKind::If { left, right, then, otherwise, .. } => {
            [left, right, then, otherwise].iter().any(|e| reads_param(e, here))
        }
        _ => false,
    }
}

impl Checker<'_> {
    /// Complains if an expression depends on what it may not.
    pub(super) fn depends(&mut self, expr: &Expr, may: May, what: &str) -> Option<()> {
        let Some((span, on)) = offender(expr, may) else { return Some(()) };
        let message = format!("{what} cannot depend on {on}");
        let mut help = format!("it may depend on {}", may.list());
        if may == May::CONST && on == "a parameter" {
            help = "a `const` is fixed when the model is compiled; make it a `param`".to_string();
        }
        self.report(Diagnostic::error("depends", span, message).help(help));
        None
    }
}
