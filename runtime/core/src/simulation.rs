//! A run of a scenario: parameters set, start found, natural lengths and drives fed, steps taken.

use crate::error::RunError;
use crate::layout::Layout;
use crate::lookup::find_scenario;
use crate::model::{Instant, Model, ScenarioValues};
use crate::motion::pose_at;
use crate::start::{Kinetic, momentum, project};
use crate::step::{State, Stepper, Surroundings};
use std::sync::Arc;

pub use crate::lookup::find_param;

/// Relative tolerance where nothing else is asked for: below rounding, so that the floor decides.
pub const DEFAULT_TOLERANCE: f64 = 1e-15;

/// What a run is asked for beyond its scenario.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    /// Scenario by name; `None`: the only one, or none at all.
    pub scenario: Option<String>,
    /// Parameters by name; they come after the scenario's own `set`.
    pub set: Vec<(String, f64)>,
    /// Step (s) instead of the scenario's.
    pub step: Option<f64>,
    /// Duration (s) instead of the scenario's.
    pub duration: Option<f64>,
    /// Change of the start, per coordinate; empty for none.
    pub start_offset: Vec<f64>,
}

/// A run in progress.
#[derive(Clone, Debug)]
pub struct Simulation<M> {
    /// The model with its parameters set.
    pub model: M,
    /// Where the run is.
    pub state: State,
    /// Step (s).
    pub h: f64,
    /// Steps that make up the duration.
    pub steps: usize,
    /// How far the start had to be moved onto the constraints (rad or m).
    pub start_moved: f64,
    layout: Arc<Layout>,
    scenario: Option<usize>,
    stepper: Stepper,
    driven: Vec<bool>,
    poses: Vec<Vec<f64>>,
    motions: Vec<Vec<(usize, f64)>>,
    inputs: Vec<f64>,
    rest: Vec<f64>,
    followed: Vec<f64>,
    driven_q: Vec<f64>,
    pose: Vec<f64>,
    kinetic: Kinetic,
}

impl<M: Model> Simulation<M> {
    /// Sets parameters, finds the start and everything that a step needs.
    pub fn new(mut model: M, settings: &Settings) -> Result<Self, RunError> {
        let layout = Arc::clone(model.layout());
        let scenario = find_scenario(&layout, settings.scenario.as_deref())?;
        if let Some(scenario) = scenario {
            for (param, value) in model.scenario(scenario).set {
                model.set_param(param, value);
            }
        }
        for (name, value) in &settings.set {
            model.set_param(find_param(&layout, name)?, *value);
        }
        let values = scenario.map(|s| model.scenario(s)).unwrap_or_default();
        let h = positive("step", settings.step.or(values.step))?;
        let duration = positive("duration", settings.duration.or(values.duration))?;
        let n = layout.coordinates.len();
        let mut driven: Vec<bool> = layout.coordinates.iter().map(|c| c.kinematic).collect();
        if let Some(scenario) = scenario {
            layout.scenarios[scenario].driven.iter().for_each(|&c| driven[c] = true);
        }
        let (mut q, mut v) = (vec![0.0; n], vec![0.0; n]);
        model.start(&mut q, &mut v);
        values.start.iter().for_each(|&(c, value)| q[c] = value);
        values.velocity.iter().for_each(|&(c, value)| v[c] = value);
        q.iter_mut().zip(&settings.start_offset).for_each(|(q, offset)| *q += offset);
        let poses = full_poses(&q, &values);
        let mut driven_q = q.clone();
        drives(&mut model, scenario, 0.0, &mut driven_q);
        for i in (0..n).filter(|&i| driven[i]) {
            q[i] = driven_q[i];
            v[i] = 0.0;
        }
        let start_moved = project(&mut model, &mut q, &driven).map_err(|(row, gap)| {
            RunError::Start(format!(
                "the start cannot be moved onto the constraints: `{row}` stays {gap:.3e} away\n  \
                 try: a start nearer to a closed configuration, or check that the constraints can \
                 all hold at once"
            ))
        })?;
        if let Some(i) = (0..n).find(|&i| !q[i].is_finite()) {
            let name = &layout.coordinates[i].name;
            return Err(RunError::Start(format!("the start of `{name}` is not a number")));
        }
        let p = momentum(&mut model, &q, &v, &driven);
        let mut lengths = vec![0.0; layout.strands.len()];
        model.strand_lengths(&q, &mut lengths);
        let tolerance = values.tolerance.unwrap_or(DEFAULT_TOLERANCE);
        let mut simulation = Simulation {
            state: State::new(q, p, v, layout.rows.len()),
            h,
            steps: (duration / h + 1e-6).floor() as usize,
            start_moved,
            scenario,
            stepper: Stepper::new(&layout, &driven, tolerance),
            driven,
            poses,
            motions: values.motions,
            inputs: vec![0.0; layout.inputs.len()],
            rest: lengths.clone(),
            followed: lengths,
            pose: vec![0.0; n],
            driven_q,
            kinetic: Kinetic::default(),
            layout,
            model,
        };
        simulation.feed(0.0);
        Ok(simulation)
    }

    /// Names, counts and blocks of the model.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }
    /// Which coordinates have their path given.
    pub fn driven(&self) -> &[bool] {
        &self.driven
    }
    /// Newton iterations since the beginning.
    pub fn iterations(&self) -> usize {
        self.stepper.iterations
    }
    /// Natural lengths that were last fed (m).
    pub fn rest(&self) -> &[f64] {
        &self.rest
    }
    /// Inputs that were last fed.
    pub fn inputs(&self) -> &[f64] {
        &self.inputs
    }
    /// Index of the scenario that runs.
    pub fn scenario(&self) -> Option<usize> {
        self.scenario
    }

    /// Takes one step. On an error the state is untouched.
    pub fn step(&mut self) -> Result<(), RunError> {
        let t0 = self.state.t;
        let t1 = (self.state.step + 1) as f64 * self.h;
        self.feed(0.5 * (t0 + t1));
        drives(&mut self.model, self.scenario, t1, &mut self.driven_q);
        let around = Surroundings {
            h: self.h,
            t1,
            inputs: &self.inputs,
            rest: &self.rest,
            driven_q: &self.driven_q,
        };
        self.stepper.step(&mut self.model, &mut self.state, &around)?;
        Ok(())
    }

    /// Inputs and natural lengths at time t.
    fn feed(&mut self, t: f64) {
        if !self.inputs.is_empty() {
            self.model.inputs(t, &mut self.inputs);
            if let Some(scenario) = self.scenario {
                self.model.scenario_inputs(scenario, t, &mut self.inputs);
            }
        }
        if self.rest.is_empty() {
            return;
        }
        self.model.rests(t, &self.inputs, &mut self.rest);
        let Some(scenario) = self.scenario else { return };
        for follow in &self.layout.scenarios[scenario].follow {
            pose_at(&self.poses, &self.motions[follow.motion], t, &mut self.pose);
            self.model.strand_lengths(&self.pose, &mut self.followed);
            for &strand in &follow.strands {
                self.rest[strand] = self.followed[strand];
            }
        }
    }

    /// Energy (J) at the state: kinetic from p, projected onto the constraints' tangent space, plus
    /// potential with the natural lengths at the state's time.
    pub fn energy(&mut self) -> f64 {
        self.feed(self.state.t);
        let state = &self.state;
        let kinetic =
            self.kinetic.energy(&mut self.model, &state.q, state.t, &state.p, &self.driven);
        kinetic + self.model.potential(&state.q, &self.rest)
    }

    /// Values of the scenario's recorded columns at the state.
    pub fn records(&mut self, values: &mut [f64]) {
        let Some(scenario) = self.scenario.filter(|_| !values.is_empty()) else { return };
        let state = &self.state;
        // Inputs are those of the step just ended.
        self.feed(if state.step == 0 { 0.0 } else { state.t - 0.5 * self.h });
        let at = Instant {
            t: self.state.t,
            q: &self.state.q,
            v: &self.state.v,
            inputs: &self.inputs,
            lambda: &self.state.lambda,
        };
        self.model.scenario_records(scenario, &at, values);
    }
}

fn drives<M: Model>(model: &mut M, scenario: Option<usize>, t: f64, q: &mut [f64]) {
    model.drives(t, q);
    if let Some(scenario) = scenario {
        model.scenario_drives(scenario, t, q);
    }
}

fn full_poses(start: &[f64], values: &ScenarioValues) -> Vec<Vec<f64>> {
    let fill = |pose: &Vec<(usize, f64)>| {
        let mut q = start.to_vec();
        pose.iter().for_each(|&(c, value)| q[c] = value);
        q
    };
    values.poses.iter().map(fill).collect()
}

fn positive(what: &str, value: Option<f64>) -> Result<f64, RunError> {
    match value {
        Some(value) if value > 0.0 && value.is_finite() => Ok(value),
        Some(value) => Err(RunError::Usage(format!("the {what} must be positive, not {value}"))),
        None => Err(RunError::Usage(format!(
            "no {what}: give `--{what} SECONDS`, or `{what} = …;` in a scenario"
        ))),
    }
}
