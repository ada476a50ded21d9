//! Steps on lanes, by one run alone.

use super::{State, Stepper, Surroundings};
use crate::lanes::{Around, Courses, Lanes, Outcome, TakenUp, Told};
use crate::model::Model;

/// Steps for which lanes are left alone after they have failed, at most.
const LONGEST_PAUSE: usize = 64;

/// What a stepper keeps of its run on lanes.
#[derive(Clone, Debug)]
pub(super) struct OnLanes {
    lanes: Lanes,
    /// Whether every block is free of constraints and of drives, and lanes are not known to be missing.
    is_possible: bool,
    /// The state that the lanes hold: its step, coordinates and momenta. A state that differs, which
    /// someone may have changed, is taken up anew.
    held: (Option<usize>, Vec<f64>, Vec<f64>),
    /// Before which step lanes are not tried again, and how long the last pause was.
    pause_until: usize,
    pause: usize,
}

impl OnLanes {
    pub(super) fn new(lanes: Lanes, is_possible: bool) -> Self {
        OnLanes {
            lanes,
            is_possible,
            held: (None, Vec::new(), Vec::new()),
            pause_until: 0,
            pause: 0,
        }
    }

    fn holds(&self, state: &State) -> bool {
        self.held.0 == Some(state.step) && self.held.1 == state.q && self.held.2 == state.p
    }

    fn hold(&mut self, state: &State) {
        self.held.0 = Some(state.step);
        self.held.1.clone_from(&state.q);
        self.held.2.clone_from(&state.p);
    }
}

impl Stepper {
    /// Whether lanes may take the next step.
    pub(crate) fn may_use_lanes(&self, state: &State) -> bool {
        self.on_lanes.is_possible && state.step >= self.on_lanes.pause_until
    }

    /// The lanes of this run.
    pub(crate) fn lanes(&mut self) -> &mut Lanes {
        &mut self.on_lanes.lanes
    }

    /// When the next step is, for lanes.
    pub(crate) fn around_on_lanes(&self, state: &State, around: &Surroundings) -> Around {
        Around { t: 0.5 * (state.t + around.t1), h: around.h, tolerance: self.tolerance }
    }

    /// Takes up to `count` steps on lanes, which are `told` what they need, and returns how many: none,
    /// with the state untouched, where the model or the machine has no lanes, or where Newton's method
    /// needs more than they can do. Otherwise there is time to pass and the state to be held.
    pub(crate) fn steps_on_lanes<M: Model>(
        &mut self,
        model: &M,
        state: &mut State,
        around: &Surroundings,
        courses: Courses,
        told: Told,
        count: usize,
    ) -> usize {
        if !self.may_use_lanes(state) {
            return 0;
        }
        let on_lane = [self.around_on_lanes(state, around)];
        let on_lanes = &mut self.on_lanes;
        if !on_lanes.lanes.arrange(&[model]) || !on_lanes.holds(state) {
            let (missed, stiffest) = (&self.predictor.missed, &self.stiffest[..]);
            on_lanes.lanes.take_up(&[TakenUp { state, rest: around.rest, missed, stiffest }]);
        }
        on_lanes.lanes.begin(&on_lane);
        on_lanes.lanes.tell(&[told]);
        match on_lanes.lanes.step(&[model], &[courses], count) {
            Outcome::Unavailable => {
                on_lanes.is_possible = false;
                0
            }
            Outcome::Stepped(taken) => {
                on_lanes.pause = 0;
                self.iterations += on_lanes.lanes.iterations(0);
                on_lanes.lanes.write_state(0, state);
                taken
            }
            Outcome::Failed(_) => {
                let (missed, stiffest) = (&mut self.predictor.missed, &mut self.stiffest[..]);
                on_lanes.lanes.write_experience(0, state, missed, stiffest);
                self.pause_lanes(state);
                0
            }
        }
    }

    /// The lanes hold this state, to which they have led.
    pub(crate) fn hold(&mut self, state: &State) {
        self.on_lanes.hold(state);
    }

    /// From now on this run steps number by number.
    pub(crate) fn leave_lanes(&mut self) {
        self.on_lanes.is_possible = false;
    }

    /// This run as lanes take it up.
    pub(crate) fn taken_up<'a>(&'a self, state: &'a State, rest: &'a [f64]) -> TakenUp<'a> {
        TakenUp { state, rest, missed: &self.predictor.missed, stiffest: &self.stiffest }
    }

    /// Writes a state that has stepped on the lanes of several runs, and what its guesses are made of.
    pub(crate) fn write_back(&mut self, lanes: &Lanes, lane: usize, state: &mut State) {
        lanes.write_state(lane, state);
        lanes.write_experience(lane, state, &mut self.predictor.missed, &mut self.stiffest);
        self.on_lanes.held.0 = None;
    }

    /// After lanes have failed in a step: the next ones are taken number by number, twice as many as
    /// the last time.
    pub(crate) fn pause_lanes(&mut self, state: &State) {
        let on_lanes = &mut self.on_lanes;
        on_lanes.held.0 = None;
        on_lanes.pause_until = state.step + 1 + on_lanes.pause;
        on_lanes.pause = (2 * on_lanes.pause).clamp(1, LONGEST_PAUSE);
    }

    /// Moves kinematic coordinates and time on, after lanes have moved the others.
    pub(crate) fn pass_time(&self, state: &mut State, around: &Surroundings) {
        for &c in &self.driven_list {
            let end = around.driven_q[c];
            state.v[c] = (end - state.q[c]) / around.h;
            (state.q[c], state.p[c]) = (end, 0.0);
        }
        state.t = around.t1;
        state.step += 1;
    }
}
