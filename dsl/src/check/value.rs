//! Named values: constants, parameters, inputs and the arguments of instances.
//!
//! They are evaluated when first needed, in any order; one that needs itself is reported.

use super::depend::{May, through_arguments};
use super::fold::{apply, call, holds};
use super::{Checker, Named, State, Value, constant};
use crate::diagnostic::Diagnostic;
use crate::hir::{self, Expr, ExprKind, InputId, Name, ParamId};
use crate::source::Span;

/// Stands for an argument of any value while a component is checked by itself.
pub(super) const PROBE: ParamId = ParamId(u32::MAX);
/// Its value where one is needed: nothing a model would single out.
const PROBE_VALUE: f64 = 0.739_085_133;
/// Most nodes of an argument or an open constant, since every use repeats it.
const MAX_NODES: usize = 4000;

/// A named value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NamedId {
    Const(usize),
    Param(usize),
    Input(usize),
    Argument(usize),
}

impl<'a> Checker<'a> {
    fn slot(&mut self, id: NamedId) -> &mut Named<'a> {
        match id {
            NamedId::Const(i) => &mut self.consts[i],
            NamedId::Param(i) => &mut self.params[i],
            NamedId::Input(i) => &mut self.inputs[i],
            NamedId::Argument(i) => &mut self.arguments[i],
        }
    }

    /// What stands for a named value in an expression.
    pub(super) fn named(&mut self, id: NamedId, span: Span) -> Option<Value> {
        let value = self.evaluate(id, span)?;
        let kind = match id {
            NamedId::Const(_) | NamedId::Argument(_) => return Some(value),
            NamedId::Param(i) => ExprKind::Param(ParamId(i as u32)),
            NamedId::Input(i) => ExprKind::Input(InputId(i as u32)),
        };
        match value {
            Value::Scalar(e) => Some(Value::Scalar(Expr { kind, dimension: e.dimension, span })),
            Value::Vector(_) => None,
        }
    }

    /// The value or default of a named value.
    fn evaluate(&mut self, id: NamedId, span: Span) -> Option<Value> {
        match &self.slot(id).state {
            State::Done(value) => return value.clone(),
            State::Busy => {
                let name = self.slot(id).name.clone();
                let message = format!("`{}` is defined by itself", name.text);
                let mut error = Diagnostic::error("cycle", name.span, message);
                if span != name.span {
                    error = error.also(span, "which leads back to it");
                }
                self.report(error);
                return None;
            }
            State::Pending => {}
        }
        self.slot(id).state = State::Busy;
        // What a value is made of does not belong to the law that mentions it.
        let in_law = std::mem::replace(&mut self.in_law, false);
        let value = self.evaluate_now(id);
        self.in_law = in_law;
        self.slot(id).state = State::Done(value.clone());
        value
    }

    fn evaluate_now(&mut self, id: NamedId) -> Option<Value> {
        let slot = self.slot(id);
        let (scope, text, name, dimension) =
            (slot.scope, slot.value?, slot.name.clone(), slot.dimension);
        match id {
            NamedId::Const(_) => {
                let value = self.value(scope, text)?;
                let items = match &value {
                    Value::Scalar(e) => std::slice::from_ref(e),
                    Value::Vector(items) => items,
                };
                // An argument of a component may be open; then so is what is computed from it.
                for e in items.iter().filter(|e| !through_arguments(e, text.span)) {
                    self.depends(e, May::CONST, "a `const`")?;
                }
                items.iter().try_for_each(|e| self.small(e, "constant", text.span))?;
                Some(value)
            }
            NamedId::Param(i) => {
                let value = self.scalar(scope, text)?;
                self.depends(&value, May::PARAMS, "the default of a `param`")?;
                let default = self.default_of(&value);
                let default = self.finite(default, value.dimension, text.span)?;
                if self.param_values.len() <= i {
                    self.param_values.resize(self.params.len(), 0.0);
                }
                self.param_values[i] = constant(&default)?;
                Some(Value::Scalar(default))
            }
            NamedId::Input(_) => {
                let value = self.scalar(scope, text)?;
                let value = match dimension {
                    Some(want) => self.fit(value, want, "a natural length", Some(text))?,
                    None => value,
                };
                self.depends(&value, May::TIME, "the default of an `input`")?;
                Some(Value::Scalar(value))
            }
            NamedId::Argument(_) => {
                let value = self.scalar(scope, text)?;
                let what = format!("`{}`", name.text);
                let value = match dimension {
                    Some(want) => self.fit(value, want, &what, Some(text))?,
                    None => value,
                };
                self.small(&value, "argument", text.span)?;
                Some(Value::Scalar(value))
            }
        }
    }

    /// Complains about a substituted expression that has grown too large.
    fn small(&mut self, value: &Expr, what: &str, span: Span) -> Option<()> {
        if nodes(value) <= MAX_NODES {
            return Some(());
        }
        let error =
            Diagnostic::error("too-large", span, format!("this {what} has grown too large"));
        self.report(
            error.help(format!("open values in it are repeated wherever the {what} is used")),
        );
        None
    }

    /// Value of an expression with every parameter at its default.
    fn default_of(&self, expr: &Expr) -> f64 {
        match &expr.kind {
            ExprKind::Number(value) => *value,
            ExprKind::Param(PROBE) => PROBE_VALUE,
            ExprKind::Param(id) => self.param_values.get(id.index()).copied().unwrap_or(f64::NAN),
            ExprKind::Neg(inner) => -self.default_of(inner),
            ExprKind::Binary(op, a, b) => apply(*op, self.default_of(a), self.default_of(b)),
            ExprKind::Call(function, arguments) => {
                let values: Vec<f64> = arguments.iter().map(|a| self.default_of(a)).collect();
                call(*function, &values).unwrap_or(f64::NAN)
            }
            ExprKind::If { compare, left, right, then, otherwise } => {
                match holds(*compare, self.default_of(left), self.default_of(right)) {
                    true => self.default_of(then),
                    false => self.default_of(otherwise),
                }
            }
            _ => f64::NAN,
        }
    }

    pub(super) fn finish_consts(&mut self) -> Vec<hir::Const> {
        let mut consts = Vec::new();
        for i in 0..self.consts.len() {
            let name = self.consts[i].name.clone();
            match self.evaluate(NamedId::Const(i), name.span) {
                Some(Value::Scalar(e)) => consts.extend(constant(&e).map(|value| hir::Const {
                    name,
                    value,
                    dimension: e.dimension,
                })),
                // A vector is kept as its components.
                Some(Value::Vector(items)) => {
                    for (e, axis) in items.iter().zip(["x", "y", "z"]) {
                        let name = Name { text: format!("{}.{axis}", name.text), ..name.clone() };
                        consts.extend(constant(e).map(|value| hir::Const {
                            name,
                            value,
                            dimension: e.dimension,
                        }));
                    }
                }
                None => {}
            }
        }
        consts
    }

    pub(super) fn finish_params(&mut self) -> Vec<hir::Param> {
        let mut params = Vec::new();
        for i in 0..self.params.len() {
            let name = self.params[i].name.clone();
            if let Some(Value::Scalar(e)) = self.evaluate(NamedId::Param(i), name.span)
                && let Some(default) = constant(&e)
            {
                params.push(hir::Param { name, default, dimension: e.dimension });
            }
        }
        params
    }

    pub(super) fn finish_inputs(&mut self) -> Vec<hir::Input> {
        let mut inputs = Vec::new();
        for i in 0..self.inputs.len() {
            let name = self.inputs[i].name.clone();
            if let Some(Value::Scalar(default)) = self.evaluate(NamedId::Input(i), name.span) {
                inputs.push(hir::Input { name, default });
            }
        }
        inputs
    }

    /// Arguments nothing used are still checked.
    pub(super) fn finish_arguments(&mut self) {
        for i in 0..self.arguments.len() {
            let span = self.arguments[i].name.span;
            self.evaluate(NamedId::Argument(i), span);
        }
    }
}

fn nodes(expr: &Expr) -> usize {
    1 + match &expr.kind {
        ExprKind::Neg(inner) => nodes(inner),
        ExprKind::Binary(_, a, b) => nodes(a) + nodes(b),
        ExprKind::Call(_, arguments) => arguments.iter().map(nodes).sum(),
        ExprKind::If { left, right, then, otherwise, .. } => {
            [left, right, then, otherwise].iter().map(|e| nodes(e)).sum()
        }
        _ => 0,
    }
}
