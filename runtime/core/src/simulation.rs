//! A run of a scenario: natural lengths and drives fed, steps taken. `feed` knows where they come from,
//! `begin` finds the start, `look` is what is written of the run, `lanes` steps it on vectors.

mod ahead;
mod begin;
mod feed;
mod lanes;
mod look;

use crate::error::{RunError, StepError, StepErrorKind};
use crate::follow::Followed;
use crate::lanes::Courses;
use crate::layout::Layout;
use crate::model::Model;
use crate::muscle::{self, Excitations};
use crate::passage::{Blocked, blocked};
use crate::start::Kinetic;
use crate::statics::Statics;
use crate::step::{State, Stepper, Surroundings};
use ahead::Ahead;
use feed::Feed;
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
    feed: Feed,
    rest: Vec<f64>,
    /// Lengths prescribed at the end of the step (m).
    rest_end: Vec<f64>,
    excitations: Excitations,
    statics: Statics,
    /// Coordinates as they are written: those without mass settled at the state's time.
    seen_q: Vec<f64>,
    /// Rates as they are written.
    seen_v: Vec<f64>,
    /// One for each `follow` of the scenario.
    followed: Vec<Followed>,
    driven_q: Vec<f64>,
    ahead: Ahead,
    kinetic: Kinetic,
}

/// What a step needs, side by side.
struct Parts<'a, M> {
    model: &'a mut M,
    state: &'a mut State,
    stepper: &'a mut Stepper,
    around: Surroundings<'a>,
    courses: Courses<'a>,
    ahead: &'a Ahead,
}

impl<M: Model> Simulation<M> {
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
        self.feed.hold(input, value);
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
        self.excitable()?;
        let Parts { model, state, stepper, around, .. } = self.parts();
        Ok(stepper.step_by_numbers(model, state, &around)?)
    }

    /// Feeds what the next step needs.
    fn prepare(&mut self) {
        let t1 = self.next_time();
        if self.feed.is_prescribed {
            self.feed(t1);
            self.rest_end.copy_from_slice(&self.rest);
        }
        self.feed(0.5 * (self.state.t + t1));
        self.feed.paths(&mut self.model, t1, &mut self.driven_q);
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
        Parts { model, state, stepper, around, courses, ahead: &self.ahead }
    }

    /// An error if a muscle is told what it cannot do in the prepared step.
    fn excitable(&self) -> Result<(), RunError> {
        if self.excitations.in_range(&self.inputs, &self.driven_q, 1) == 1 {
            return Ok(());
        }
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
        self.feed.inputs(&mut self.model, t, &mut self.inputs);
        self.feed.rests(&mut self.model, t, &self.inputs, &mut self.rest);
        self.follow(t);
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
}
