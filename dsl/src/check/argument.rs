//! Arguments of instances: what a `place` gives for the parameters of a component.

use super::instance::ComponentId;
use super::scope::{Entry, ScopeId};
use super::value::PROBE;
use super::{Checker, Named, State, Value, number};
use crate::ast::{Argument, Component, DeclKind, UnitExpr};
use crate::diagnostic::Diagnostic;
use crate::dimension::Dimension;
use crate::hir::{Expr, ExprKind, Name};
use crate::source::Span;
use crate::suggest::nearest;

/// Names of dimensions for parameters of components.
#[rustfmt::skip]
const DIMENSIONS: [(&str, Dimension); 15] = [
    ("Number", Dimension::NONE), ("Angle", Dimension::ANGLE), ("Length", Dimension::LENGTH),
    ("Time", Dimension::TIME), ("Mass", Dimension::MASS), ("Density", Dimension::DENSITY),
    ("Inertia", Dimension::INERTIA), ("Velocity", Dimension::VELOCITY),
    ("AngularVelocity", Dimension::ANGULAR_VELOCITY), ("Force", Dimension::FORCE),
    ("Torque", Dimension::TORQUE), ("Stiffness", Dimension::STIFFNESS),
    ("Damping", Dimension::DAMPING), ("Energy", Dimension::ENERGY),
    ("Pressure", Dimension::PRESSURE),
];

impl<'a> Checker<'a> {
    /// The dimension a parameter of a component declares.
    fn declared(&mut self, unit: &UnitExpr) -> Option<Dimension> {
        if let [only] = unit.factors.as_slice()
            && only.exponent == 1
        {
            let name = &only.name;
            if let Some(known) = DIMENSIONS.iter().find(|d| d.0 == name.text) {
                return Some(known.1);
            }
            if crate::unit::Unit::named(&name.text).is_none() {
                let all: Vec<&str> = DIMENSIONS.iter().map(|d| d.0).collect();
                let help = match nearest(&name.text, all.iter().copied()) {
                    Some(near) => format!("did you mean `{near}`?"),
                    None => format!("known are {}, or a unit such as `N*m/rad`", all.join(", ")),
                };
                let message = format!("unknown dimension `{}`", name.text);
                self.report(Diagnostic::error("unknown-dimension", name.span, message).help(help));
                return None;
            }
        }
        self.unit(unit).map(|u| u.dimension)
    }

    fn component(&self, id: ComponentId) -> Option<&'a Component> {
        match &self.components[id.0].decl.kind {
            DeclKind::Component(component) => Some(component),
            _ => None,
        }
    }

    /// Enters the parameters of an instance with what the `place` gives for them.
    pub(super) fn bind_arguments(
        &mut self,
        outer: ScopeId,
        instance: ScopeId,
        id: ComponentId,
        given: &'a [Argument],
        span: Span,
    ) {
        let Some(component) = self.component(id) else { return };
        let component_name = &self.components[id.0].decl.name;
        let known: Vec<&str> = component.parameters.iter().map(|p| p.name.text.as_str()).collect();
        let mut taken: Vec<Option<&'a Argument>> = vec![None; known.len()];
        for argument in given {
            let Some(name) = &argument.name else {
                let error =
                    Diagnostic::error("argument", argument.value.span, "arguments are named");
                self.report(error.help("write `name = value`"));
                continue;
            };
            match known.iter().position(|k| *k == name.text) {
                Some(i) if taken[i].is_none() => taken[i] = Some(argument),
                Some(_) => {
                    let message = format!("the argument `{}` is given twice", name.text);
                    self.report(Diagnostic::error("duplicate", name.span, message));
                }
                None => {
                    let message =
                        format!("`{}` has no parameter `{}`", component_name.text, name.text);
                    let help = match nearest(&name.text, known.iter().copied()) {
                        Some(near) => format!("did you mean `{near}`?"),
                        None if known.is_empty() => "it has none".to_string(),
                        None => format!("it has {}", known.join(", ")),
                    };
                    self.report(
                        Diagnostic::error("unknown-argument", name.span, message).help(help),
                    );
                }
            }
        }
        for (parameter, argument) in component.parameters.iter().zip(taken) {
            let dimension = self.declared(&parameter.dimension);
            let (scope, value) = match argument {
                Some(argument) => (outer, Some(&argument.value)),
                None => (instance, parameter.default.as_ref()),
            };
            if value.is_none() {
                let message = format!(
                    "`{}` needs the argument `{}`",
                    component_name.text, parameter.name.text
                );
                self.report(
                    Diagnostic::error("missing-argument", span, message)
                        .also(parameter.name.span, "declared here without a default"),
                );
            }
            let broken = value.is_none() || dimension.is_none();
            let state = if broken { State::Done(None) } else { State::Pending };
            self.bind(instance, scope, parameter, value, dimension, state);
        }
    }

    fn bind(
        &mut self,
        instance: ScopeId,
        scope: ScopeId,
        parameter: &'a crate::ast::Parameter,
        value: Option<&'a crate::ast::Expr>,
        dimension: Option<Dimension>,
        state: State,
    ) {
        let ident = &parameter.name;
        let name = Name { text: ident.text.clone(), doc: String::new(), span: ident.span };
        let full = format!("{}{}", self.scopes[instance.0].prefix, ident.text);
        let entered = Name { text: full, ..name.clone() };
        self.arguments.push(Named { scope, name, value, dimension, state });
        let entry = Entry::Argument(self.arguments.len() - 1);
        if self.take("name", &entered) {
            self.scopes[instance.0].names.insert(&ident.text, entry);
        }
    }

    /// Enters the parameters of a component that is checked by itself.
    pub(super) fn bind_probe(&mut self, instance: ScopeId, id: ComponentId) {
        let Some(component) = self.component(id) else { return };
        for parameter in &component.parameters {
            let span = parameter.name.span;
            let dimension = self.declared(&parameter.dimension);
            if let (Some(default), Some(want)) = (&parameter.default, dimension) {
                let name = Name { text: parameter.name.text.clone(), doc: String::new(), span };
                let (value, dimension) = (Some(default), Some(want));
                let state = State::Pending;
                self.arguments.push(Named { scope: instance, name, value, dimension, state });
            }
            let value = dimension.map(|dimension| {
                Value::Scalar(Expr { kind: ExprKind::Param(PROBE), ..number(0.0, dimension, span) })
            });
            self.bind(instance, instance, parameter, None, dimension, State::Done(value));
        }
    }
}
