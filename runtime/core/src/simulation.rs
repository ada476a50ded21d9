//! A run of a scenario: parameters set, start found, natural lengths and drives fed, steps taken.

mod lanes;

use crate::error::{RunError, StepError, StepErrorKind};
use crate::follow::Followed;
use crate::lanes::Courses;
use crate::layout::Layout;
use crate::lookup::find_scenario;
use crate::model::{Instant, Model, ScenarioValues};
use crate::muscle;
use crate::passage::{Blocked, blocked};
use crate::requirement;
use crate::start::{Kinetic, momentum, project};
use crate::statics::Statics;
use crate::step::{State, Stepper, Surroundings};
use std::sync::Arc;

pub use crate::lookup::{find_coordinate, find_name, find_param};

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
    /// Where coordinates start (rad or m), by name; after the scenario's own `start`.
    pub start: Vec<(String, f64)>,
    /// Their rates at the start (rad/s or m/s), by name.
    pub velocity: Vec<(String, f64)>,
    /// Change of the start, per coordinate; empty for none.
    pub start_offset: Vec<f64>,
    /// Inputs by name that are held instead of what model and scenario give
    /// ([`Simulation::hold_input`]).
    pub inputs: Vec<(String, f64)>,
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
    /// Inputs that are held at a value.
    held: Vec<Option<f64>>,
    rest: Vec<f64>,
    /// Lengths prescribed at the end of the step (m).
    rest_end: Vec<f64>,
    /// Lengths at the start (m), for inputs that stand for natural lengths.
    start_lengths: Vec<f64>,
    /// Whether any strand's length is prescribed.
    is_prescribed: bool,
    /// Whether there are inputs or natural lengths that the model gives.
    is_fed: bool,
    /// Whether any coordinate has its path given.
    is_driven: bool,
    /// Whether any strand is a muscle.
    is_muscular: bool,
    statics: Statics,
    /// Coordinates as they are written: those without mass settled at the state's time.
    seen_q: Vec<f64>,
    /// Rates as they are written.
    seen_v: Vec<f64>,
    /// One for each `follow` of the scenario.
    followed: Vec<Followed>,
    driven_q: Vec<f64>,
    kinetic: Kinetic,
}

/// What a step needs, side by side.
struct Parts<'a, M> {
    model: &'a mut M,
    state: &'a mut State,
    stepper: &'a mut Stepper,
    around: Surroundings<'a>,
    courses: Courses<'a>,
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
        if let Some(what) = requirement::broken(&mut model) {
            let hint = "try: parameters within their range";
            return Err(RunError::Start(format!("{what}\n  {hint}")));
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
        let mut started: Vec<usize> = values.start.iter().map(|&(c, _)| c).collect();
        for (name, value) in &settings.start {
            let coordinate = find_coordinate(&layout, name)?;
            q[coordinate] = *value;
            started.push(coordinate);
        }
        for (name, value) in &settings.velocity {
            v[find_coordinate(&layout, name)?] = *value;
        }
        for ((q, offset), c) in q.iter_mut().zip(&settings.start_offset).zip(&layout.coordinates) {
            // Internal variables follow from the rest.
            *q += if c.is_internal { 0.0 } else { *offset };
        }
        let poses = full_poses(&q, &values);
        let mut driven_q = q.clone();
        drives(&mut model, scenario, 0.0, &mut driven_q);
        for i in (0..n).filter(|&i| driven[i]) {
            q[i] = driven_q[i];
            v[i] = 0.0;
        }
        let mut lengths = vec![0.0; layout.strands.len()];
        model.strand_lengths(&q, &mut lengths);
        let tolerance = values.tolerance.unwrap_or(DEFAULT_TOLERANCE);
        let is_driven = driven.contains(&true);
        let mut simulation = Simulation {
            state: State::new(q, vec![0.0; n], v, layout.rows.len()),
            h,
            steps: (duration / h + 1e-6).floor() as usize,
            start_moved: 0.0,
            scenario,
            stepper: Stepper::new(&layout, &driven, tolerance),
            statics: Statics::new(&layout, &driven),
            driven,
            poses,
            motions: values.motions,
            inputs: vec![0.0; layout.inputs.len()],
            held: vec![None; layout.inputs.len()],
            followed: vec![
                Followed::new(n, layout.strands.len());
                scenario.map_or(0, |s| layout.scenarios[s].follow.len())
            ],
            rest_end: lengths.clone(),
            start_lengths: lengths.clone(),
            rest: lengths,
            is_prescribed: layout.strands.iter().any(|s| s.is_prescribed),
            is_fed: !layout.inputs.is_empty() || layout.strands.iter().any(|s| s.has_rest),
            is_driven,
            is_muscular: layout.strands.iter().any(|s| s.muscle.is_some()),
            seen_q: vec![0.0; n],
            seen_v: vec![0.0; n],
            driven_q,
            kinetic: Kinetic::default(),
            layout,
            model,
        };
        for (name, value) in &settings.inputs {
            let known = simulation.layout.inputs.iter().map(|i| i.name.as_str());
            let input = find_name(&simulation.layout.name, "input", name, known)?;
            simulation.hold_input(input, Some(*value));
        }
        simulation.find_start(&started)?;
        let follows = simulation.follows();
        simulation.stepper.lanes().follow(follows);
        Ok(simulation)
    }

    /// Puts the start on the constraints, measures natural lengths that are left out, and settles
    /// what moves no mass; `started` are the coordinates whose start the scenario gives.
    fn find_start(&mut self, started: &[usize]) -> Result<(), RunError> {
        self.feed(0.0);
        let (model, driven) = (&mut self.model, &self.driven);
        let State { q, v, p, .. } = &mut self.state;
        let given = q.clone();
        let moved = project(model, q, &self.rest, driven);
        if let Some(i) = (0..q.len()).find(|&i| moved.is_ok() && !q[i].is_finite()) {
            let name = &self.layout.coordinates[i].name;
            return Err(RunError::Start(format!("the start of `{name}` is not a number")));
        }
        // Where the search for a start fails it ends anywhere: then the start as it was given tells.
        let seen = if moved.is_ok() { &*q } else { &given };
        if let Some(Blocked { what, hint }) = blocked(model, seen) {
            return Err(RunError::Start(format!("at the start {what}\n  try: {hint}")));
        }
        self.start_moved = moved.map_err(|(row, gap)| {
            RunError::Start(format!(
                "the start cannot be moved onto the constraints: `{row}` is {gap:.3e} away there\n  \
                 try: a start nearer to a closed configuration, or check that the constraints can \
                 all hold at once"
            ))
        })?;
        *p = momentum(model, q, v, driven);
        model.strand_lengths(q, &mut self.start_lengths);
        for (strand, layout) in self.layout.strands.iter().enumerate() {
            if !layout.is_prescribed {
                self.rest[strand] = self.start_lengths[strand];
            }
        }
        self.feed(0.0);
        self.begin_muscles(started)?;
        if self.statics.is_empty() {
            return Ok(());
        }
        let given = (0.0, &self.rest[..], &self.inputs[..]);
        // Activations are given, and fibre lengths that the scenario gives.
        let muscles = self.layout.muscles();
        let held = muscles.flat_map(|(_, muscle)| {
            let fibre = Some(muscle.fibre).filter(|fibre| started.contains(fibre));
            [Some(muscle.activation), fibre]
        });
        let held: Vec<usize> = held.flatten().collect();
        let settled = self.statics.rest(&mut self.model, &mut self.state.q, &held, given);
        settled.map_err(|(coordinate, force)| {
            let name = &self.layout.coordinates[coordinate].name;
            RunError::Start(format!(
                "`{name}` finds no balance at the start: {force:.3e} N is left on it\n  \
                 try: a start nearer to where its strands balance, or natural lengths at which they \
                 pull"
            ))
        })?;
        let State { q, v, .. } = &mut self.state;
        self.statics.rates(&mut self.model, q, v, given);
        Ok(())
    }

    /// Muscles begin with the activation that is given, or else in balance with their excitation.
    fn begin_muscles(&mut self, started: &[usize]) -> Result<(), RunError> {
        let layout = Arc::clone(&self.layout);
        let fail = |what: String| {
            RunError::Start(format!("at the start {what}\n  try: parameters within their range"))
        };
        if layout.muscles().next().is_none() {
            return Ok(());
        }
        for (_, muscle) in layout.muscles() {
            let a = muscle.activation;
            if !(muscle.has_start || self.driven[a] || started.contains(&a)) {
                self.state.q[a] = self.inputs[muscle.excitation];
            }
        }
        let given = vec![true; self.driven.len()];
        let fault = muscle::out_of_range(&self.model, (&self.state.q, &given), &self.inputs);
        fault.map_or(Ok(()), |what| Err(fail(what)))
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
    /// Holds an input at a value over the steps that follow, instead of what model and scenario give;
    /// `None` lets go of it. A controller calls this between steps.
    pub fn hold_input(&mut self, input: usize, value: Option<f64>) {
        self.held[input] = value;
    }
    /// Index of the scenario that runs.
    pub fn scenario(&self) -> Option<usize> {
        self.scenario
    }

    /// Takes one step. On an error the state is untouched.
    pub fn step(&mut self) -> Result<(), RunError> {
        self.advance(1).map(|_| ())
    }

    /// Takes up to `steps` steps, at least one, as many as go without a look at the state, and returns
    /// how many. On an error the state is untouched.
    pub fn advance(&mut self, steps: usize) -> Result<usize, RunError> {
        if self.may_use_lanes() {
            let taken = self.steps_on_lanes(steps);
            if taken > 0 {
                return Ok(taken);
            }
        }
        self.step_by_numbers().map(|()| 1)
    }

    /// As [`Simulation::step`], without lanes.
    pub(crate) fn step_by_numbers(&mut self) -> Result<(), RunError> {
        self.prepare();
        if self.is_muscular {
            self.excitable()?;
        }
        let Parts { model, state, stepper, around, .. } = self.parts();
        Ok(stepper.step_by_numbers(model, state, &around)?)
    }

    /// Feeds what the next step needs.
    fn prepare(&mut self) {
        let t1 = self.next_time();
        if self.is_prescribed {
            self.feed(t1);
            self.rest_end.copy_from_slice(&self.rest);
        }
        self.feed(0.5 * (self.state.t + t1));
        drives(&mut self.model, self.scenario, t1, &mut self.driven_q);
    }

    fn next_time(&self) -> f64 {
        (self.state.step + 1) as f64 * self.h
    }

    fn surroundings(&self) -> Surroundings<'_> {
        Surroundings {
            h: self.h,
            t1: self.next_time(),
            inputs: &self.inputs,
            rest: &self.rest,
            rest_end: &self.rest_end,
            driven_q: &self.driven_q,
        }
    }

    fn parts(&mut self) -> Parts<'_, M> {
        let around = Surroundings {
            h: self.h,
            t1: self.next_time(),
            inputs: &self.inputs,
            rest: &self.rest,
            rest_end: &self.rest_end,
            driven_q: &self.driven_q,
        };
        let courses = Courses { poses: &self.poses, motions: &self.motions };
        let (model, state, stepper) = (&mut self.model, &mut self.state, &mut self.stepper);
        Parts { model, state, stepper, around, courses }
    }

    /// An error if a muscle is told what it cannot do in the prepared step.
    fn excitable(&self) -> Result<(), RunError> {
        let told = (&self.driven_q[..], &self.driven[..]);
        let Some(what) = muscle::out_of_range(&self.model, told, &self.inputs) else {
            return Ok(());
        };
        Err(RunError::Step(StepError {
            kind: StepErrorKind::Blocked,
            t: self.state.t,
            step: self.state.step + 1,
            equation: "none".to_string(),
            residual: 0.0,
            condition: f64::NAN,
            iterations: 0,
            blocked: what,
            hints: vec!["`clamp(e, 0, 1)` where the excitation is computed".to_string()],
        }))
    }

    /// An error if a strand cannot pass its surface where the run is.
    pub fn passable(&mut self) -> Result<(), RunError> {
        let Some(Blocked { what, hint }) = blocked(&mut self.model, &self.state.q) else {
            return Ok(());
        };
        Err(RunError::Step(StepError {
            kind: StepErrorKind::Blocked,
            t: self.state.t,
            step: self.state.step,
            equation: "none".to_string(),
            residual: 0.0,
            condition: f64::NAN,
            iterations: 0,
            blocked: what,
            hints: vec![hint.to_string()],
        }))
    }

    /// Inputs and natural lengths at time t.
    fn feed(&mut self, t: f64) {
        self.feed_but_follow(t);
        self.follow(t);
    }

    fn feed_but_follow(&mut self, t: f64) {
        if !self.inputs.is_empty() {
            self.model.inputs(t, &mut self.inputs);
            if let Some(scenario) = self.scenario {
                self.model.scenario_inputs(scenario, t, &mut self.inputs);
            }
            for (input, held) in self.inputs.iter_mut().zip(&self.held) {
                *input = held.unwrap_or(*input);
            }
            for (strand, &length) in self.layout.strands.iter().zip(&self.start_lengths) {
                if let Some(input) = strand.actuator.filter(|&input| self.inputs[input].is_nan()) {
                    self.inputs[input] = length;
                }
            }
        }
        if self.rest.is_empty() {
            return;
        }
        self.model.rests(t, &self.inputs, &mut self.rest);
        if let Some(scenario) = self.scenario.filter(|_| self.is_prescribed) {
            self.model.scenario_rests(scenario, t, &mut self.rest);
        }
    }

    /// Natural lengths that follow motions.
    fn follow(&mut self, t: f64) {
        let Some(scenario) = self.scenario else { return };
        let follows = &self.layout.scenarios[scenario].follow;
        for (follow, followed) in follows.iter().zip(&mut self.followed) {
            followed.move_to(&mut self.model, &self.poses, &self.motions[follow.motion], t);
            for &strand in &follow.strands {
                self.rest[strand] = followed.lengths()[strand];
            }
        }
    }

    /// Coordinates at the state's time: those in static equilibrium are balanced there, where the
    /// state itself has them at the middle of the step.
    pub fn coordinates(&mut self) -> &[f64] {
        self.seen_q.copy_from_slice(&self.state.q);
        if !self.statics.is_empty() && self.state.step > 0 {
            self.feed(self.state.t);
            let given = (self.state.t, &self.rest[..], &self.inputs[..]);
            let (statics, q) = (&mut self.statics, &mut self.seen_q);
            // Before the first step all is where it rests, and internal variables where they were
            // put. Where no balance is found the next step will say so.
            if statics.settle(&mut self.model, q, self.h, given).is_err() {
                self.seen_q.copy_from_slice(&self.state.q);
            }
        }
        &self.seen_q
    }

    /// Energy (J) at the state: kinetic from p, projected onto the constraints' tangent space, plus
    /// potential with the natural lengths at the state's time.
    pub fn energy(&mut self) -> f64 {
        self.coordinates();
        self.feed(self.state.t);
        let (q, state) = (&self.seen_q, &self.state);
        let kinetic = self.kinetic.energy(&mut self.model, q, state.t, &state.p, &self.driven);
        kinetic + self.model.potential(q, &self.rest)
    }

    /// Values of the scenario's recorded columns at the state.
    pub fn records(&mut self, values: &mut [f64]) {
        if let Some(scenario) = self.scenario.filter(|_| !values.is_empty()) {
            self.look(|model, at| model.scenario_records(scenario, at, values));
        }
    }

    /// Shows the model the instant that the state has reached.
    pub fn look<T>(&mut self, see: impl FnOnce(&mut M, &Instant) -> T) -> T {
        self.coordinates();
        self.seen_v.copy_from_slice(&self.state.v);
        if self.state.step > 0 {
            for (_, muscle) in self.layout.muscles() {
                for c in [muscle.fibre, muscle.activation].into_iter().filter(|&c| !self.driven[c])
                {
                    self.seen_v[c] = (self.seen_q[c] - self.state.q[c]) / (0.5 * self.h);
                }
            }
        }
        self.feed(self.state.t);
        let rest = std::mem::take(&mut self.rest);
        self.rest.clone_from(&rest);
        // Inputs are those of the step just ended.
        self.feed(if self.state.step == 0 { 0.0 } else { self.state.t - 0.5 * self.h });
        let at = Instant {
            t: self.state.t,
            q: &self.seen_q,
            v: &self.seen_v,
            inputs: &self.inputs,
            lambda: &self.state.lambda,
            rest: &rest,
            h: self.h,
        };
        see(&mut self.model, &at)
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
