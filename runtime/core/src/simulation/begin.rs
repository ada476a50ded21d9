//! How a run begins: parameters, the start on the constraints, what moves no mass at rest.

use super::ahead::Ahead;
use super::feed::Feed;
use super::{DEFAULT_TOLERANCE, Settings, Simulation, find_coordinate, find_name, find_param};
use crate::error::RunError;
use crate::follow::Followed;
use crate::lookup::find_scenario;
use crate::model::{Model, ScenarioValues};
use crate::muscle::{self, Excitations};
use crate::passage::{Blocked, blocked};
use crate::requirement;
use crate::start::{Kinetic, momentum, project};
use crate::statics::Statics;
use crate::step::{State, Stepper};
use std::sync::Arc;

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
        let mut feed = Feed::new(&layout, scenario, driven.contains(&true));
        feed.paths(&mut model, 0.0, &mut driven_q);
        for i in (0..n).filter(|&i| driven[i]) {
            q[i] = driven_q[i];
            v[i] = 0.0;
        }
        let mut lengths = vec![0.0; layout.strands.len()];
        model.strand_lengths(&q, &mut lengths);
        feed.begin(&layout, &lengths);
        let tolerance = values.tolerance.unwrap_or(DEFAULT_TOLERANCE);
        let mut simulation = Simulation {
            state: State::new(q, vec![0.0; n], v, layout.rows.len()),
            h,
            steps: (duration / h + 1e-6).floor() as usize,
            start_moved: 0.0,
            scenario,
            stepper: Stepper::new(&layout, &driven, tolerance),
            statics: Statics::new(&layout, &driven),
            poses,
            motions: values.motions,
            inputs: vec![0.0; layout.inputs.len()],
            feed,
            followed: vec![
                Followed::new(n, layout.strands.len());
                scenario.map_or(0, |s| layout.scenarios[s].follow.len())
            ],
            rest_end: lengths.clone(),
            rest: lengths,
            excitations: Excitations::new(&layout, &driven),
            driven,
            seen_q: vec![0.0; n],
            seen_v: vec![0.0; n],
            driven_q,
            ahead: Ahead::default(),
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
        let mut lengths = vec![0.0; self.layout.strands.len()];
        model.strand_lengths(q, &mut lengths);
        for (strand, layout) in self.layout.strands.iter().enumerate() {
            if !layout.is_prescribed {
                self.rest[strand] = lengths[strand];
            }
        }
        self.feed.begin(&self.layout, &lengths);
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
