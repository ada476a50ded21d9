//! Lints of the mechanics: what a biomechanist would want to be told before the first step.
//!
//! The language has already checked what can be checked without mechanics. These look at numbers:
//! masses, routes, and the model at its start. All findings are diagnostics like any other; only
//! what makes a run impossible is an error.

mod body;
mod coordinate;
mod law;
mod node;
mod pose;
mod route;
mod wrap;

use handc_core::model::Model as _;
use handc_core::simulation::Settings;
use handc_dsl::diagnostic::Diagnostic;
use handc_dsl::hir;
use handc_runtime::interpreter::Interpreter;
use handc_runtime::mechanism::Mechanism;
use std::sync::Arc;

/// What the lints look at.
struct Context<'a> {
    model: &'a hir::Model,
    mechanism: &'a Mechanism,
    interpreter: Interpreter,
}

/// Everything worth saying about the mechanics of a model.
pub fn lint(model: &hir::Model, mechanism: &Mechanism) -> Vec<Diagnostic> {
    let mut context =
        Context { model, mechanism, interpreter: Interpreter::new(Arc::new(mechanism.clone())) };
    let mut found = Vec::new();
    body::bodies(&context, &mut found);
    coordinate::limits(&context, &mut found);
    coordinate::half_static(&context, &mut found);
    let held = node::nodes(&context, &mut found) & coordinate::held(&context, &mut found);
    law::energies(&mut context, &mut found);
    route::routes(&mut context, &mut found);
    wrap::wraps(&mut context, &mut found);
    if held && !found.iter().any(Diagnostic::is_error) {
        pose::poses(&mut context, &mut found);
    }
    found
}

impl Context<'_> {
    /// The start of the joints themselves.
    fn start(&mut self) -> Vec<f64> {
        let n = self.mechanism.coordinates.len();
        let (mut q, mut v) = (vec![0.0; n], vec![0.0; n]);
        self.interpreter.start(&mut q, &mut v);
        q
    }
    /// Name of a coordinate.
    fn name(&self, coordinate: usize) -> &str {
        &self.mechanism.coordinates[coordinate].name
    }
}

/// Settings that run a scenario by name, or none.
fn settings(scenario: Option<&str>) -> Settings {
    Settings { scenario: scenario.map(str::to_string), ..Settings::default() }
}
