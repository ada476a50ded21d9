//! Runs made from texts and models, for tests that take steps themselves.
#![allow(dead_code, reason = "each test uses a part")]

use handc_core::simulation::{Settings, Simulation};
use handc_runtime::interpreter::Interpreter;
use handc_tests::load;
use std::sync::Arc;

pub(crate) type Run = Simulation<Interpreter>;

/// A run at its start; one second unless told otherwise.
pub(crate) fn start(model: Interpreter, scenario: Option<&str>, h: f64) -> Run {
    start_for(model, scenario, h, 1.0)
}

/// A run at its start, of the given duration.
pub(crate) fn start_for(model: Interpreter, scenario: Option<&str>, h: f64, duration: f64) -> Run {
    let settings = Settings {
        scenario: scenario.map(str::to_string),
        step: Some(h),
        duration: Some(duration),
        ..Settings::default()
    };
    Simulation::new(model, &settings).unwrap()
}

/// The model of the given declarations.
pub(crate) fn text(body: &str) -> Interpreter {
    let mechanism = load::mechanism_of_text("m", &format!("model m {{\n{body}\n}}\n"));
    Interpreter::new(Arc::new(mechanism.unwrap_or_else(|said| panic!("{said}"))))
}

/// A model of the repository.
pub(crate) fn model(name: &str) -> Interpreter {
    load::interpreter(&load::repository("models").join(format!("{name}.hdl")))
}

/// Takes steps that must succeed.
pub(crate) fn advance(run: &mut Run, steps: usize) {
    for _ in 0..steps {
        run.step().unwrap();
    }
}

/// Largest difference of two lists.
pub(crate) fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
