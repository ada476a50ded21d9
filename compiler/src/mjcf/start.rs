//! The start of a scenario: what a run of handc would begin with.

use handc_core::error::RunError;
use handc_core::model::Model;
use handc_core::simulation::{Settings, Simulation};
use handc_runtime::interpreter::Interpreter;
use handc_runtime::mechanism::Mechanism;
use std::sync::Arc;

/// Step where neither scenario nor options give one (s): MuJoCo's default.
const STEP: f64 = 0.002;

/// A start with everything that an export reads from it.
#[derive(Clone, Debug)]
pub(super) struct Start {
    /// The model with the scenario's parameters.
    pub(super) model: Interpreter,
    /// Index of the scenario.
    pub(super) scenario: Option<usize>,
    /// Step (s).
    pub(super) step: f64,
    /// Coordinates (rad or m), on the constraints.
    pub(super) q: Vec<f64>,
    /// Rates.
    pub(super) v: Vec<f64>,
    /// Natural lengths at t = 0 (m).
    pub(super) rest: Vec<f64>,
    /// Lengths of the strands (m).
    pub(super) lengths: Vec<f64>,
    /// Inputs at t = 0.
    pub(super) inputs: Vec<f64>,
    /// Coordinates whose path is given.
    pub(super) driven: Vec<bool>,
    /// What a reader should know about the choice of the start.
    pub(super) notes: Vec<String>,
}

/// Finds the start; an error means that the options are wrong.
pub(super) fn start(mechanism: &Arc<Mechanism>, settings: &Settings) -> Result<Start, RunError> {
    let mut settings = settings.clone();
    let mut notes = Vec::new();
    let scenarios = &mechanism.scenarios;
    if settings.scenario.is_none()
        && let [first, _, ..] = scenarios.as_slice()
    {
        settings.scenario = Some(first.name.clone());
        notes.push(format!("Start and step are those of the first scenario, `{}`.", first.name));
    }
    let wanted = |name: &String| scenarios.iter().find(|s| s.name == *name);
    let scenario = settings.scenario.as_ref().map_or(scenarios.first(), wanted);
    if scenario.is_none_or(|s| s.step.is_none()) {
        settings.step.get_or_insert(STEP);
    }
    settings.duration = Some(1.0);
    let model = Interpreter::new(Arc::clone(mechanism));
    match Simulation::new(model.clone(), &settings) {
        Ok(mut run) => {
            let q = run.state.q.clone();
            let mut lengths = vec![0.0; mechanism.strands.len()];
            run.model.strand_lengths(&q, &mut lengths);
            Ok(Start {
                scenario: run.scenario(),
                step: run.h,
                v: run.state.v.clone(),
                rest: run.rest().to_vec(),
                inputs: run.inputs().to_vec(),
                driven: run.driven().to_vec(),
                model: run.model,
                lengths,
                q,
                notes,
            })
        }
        Err(RunError::Start(reason)) => {
            let reason = reason.lines().next().unwrap_or_default();
            notes.push(format!("The start is off the constraints: {reason}."));
            let index = scenario.and_then(|s| scenarios.iter().position(|other| other == s));
            Ok(unprojected(model, &settings, index, notes))
        }
        Err(error) => Err(error),
    }
}

/// The start as it is written, with nothing moved.
fn unprojected(
    mut model: Interpreter,
    settings: &Settings,
    scenario: Option<usize>,
    notes: Vec<String>,
) -> Start {
    let layout = Arc::clone(model.layout());
    let given = scenario.map(|index| model.scenario(index)).unwrap_or_default();
    for (param, value) in given.set {
        model.set_param(param, value);
    }
    for (name, value) in &settings.set {
        if let Some(param) = layout.params.iter().position(|p| p.name == *name) {
            model.set_param(param, *value);
        }
    }
    let (n, s) = (layout.coordinates.len(), layout.strands.len());
    let (mut q, mut v) = (vec![0.0; n], vec![0.0; n]);
    model.start(&mut q, &mut v);
    given.start.iter().for_each(|&(c, value)| q[c] = value);
    given.velocity.iter().for_each(|&(c, value)| v[c] = value);
    model.drives(0.0, &mut q);
    let mut inputs = vec![0.0; layout.inputs.len()];
    model.inputs(0.0, &mut inputs);
    let mut driven: Vec<bool> = layout.coordinates.iter().map(|c| c.kinematic).collect();
    if let Some(index) = scenario {
        model.scenario_drives(index, 0.0, &mut q);
        model.scenario_inputs(index, 0.0, &mut inputs);
        layout.scenarios[index].driven.iter().for_each(|&c| driven[c] = true);
    }
    let mut lengths = vec![0.0; s];
    model.strand_lengths(&q, &mut lengths);
    let mut rest = lengths.clone();
    model.rests(0.0, &inputs, &mut rest);
    Start {
        scenario,
        step: settings.step.or(given.step).unwrap_or(STEP),
        driven,
        model,
        q,
        v,
        rest,
        lengths,
        inputs,
        notes,
    }
}
