//! A run on lanes, by itself or with others.

use super::{Parts, Simulation};
use crate::lanes::{Around, Courses, Follows, Lanes, TakenUp};
use crate::model::Model;

impl<M: Model> Simulation<M> {
    /// Whether lanes may take the next step.
    pub(crate) fn may_use_lanes(&self) -> bool {
        self.stepper.may_use_lanes(&self.state)
    }

    /// Whether the duration is over.
    pub(crate) fn is_over(&self) -> bool {
        self.state.step >= self.steps
    }

    /// Steps left.
    pub(crate) fn left(&self) -> usize {
        self.steps.saturating_sub(self.state.step)
    }

    /// Takes up to `count` steps on lanes and returns how many: none, with the state untouched, where
    /// that cannot be.
    pub(super) fn steps_on_lanes(&mut self, count: usize) -> usize {
        let count = self.stepper.lanes().reach(count);
        let count = self.look_ahead(count);
        let Parts { model, state, stepper, around, courses, ahead } = self.parts();
        let Some(told) = ahead.told() else { return 0 };
        let taken = stepper.steps_on_lanes(model, state, &around, courses, told, count);
        if taken > 0 {
            self.pass_time(taken);
            self.stepper.hold(&self.state);
            if self.stepper.lanes().leave_followers() {
                self.follow(self.state.t - 0.5 * self.h);
            }
            self.stepper.lanes().write_rest(0, &mut self.rest);
        }
        taken
    }

    /// Strands that follow motions on lanes, and strands whose natural lengths never change.
    pub(super) fn follows(&self) -> Follows {
        let list = self.scenario.map(|s| &self.layout.scenarios[s].follow[..]).unwrap_or_default();
        let list = list.iter().map(|follow| (follow.motion, follow.strands.clone())).collect();
        Follows::new(list, self.layout.strands.iter().map(|strand| !strand.has_rest).collect())
    }

    /// Lanes for several such runs.
    pub(crate) fn fresh_lanes(&mut self) -> Lanes {
        self.stepper.lanes().fresh()
    }

    /// When this run's next step is.
    pub(crate) fn around_on_lanes(&self) -> Around {
        self.stepper.around_on_lanes(&self.state, &self.surroundings())
    }

    /// Poses and motions of this run.
    pub(crate) fn courses(&self) -> Courses<'_> {
        Courses { poses: &self.poses, motions: &self.motions }
    }

    /// This run as shared lanes take it up.
    pub(crate) fn taken_up(&self) -> TakenUp<'_> {
        self.stepper.taken_up(&self.state, &self.rest)
    }

    /// After steps on lanes that are shared: time goes on; the rest of the state stays there.
    pub(crate) fn pass_on_lanes(&mut self, taken: usize, iterations: usize) {
        self.stepper.iterations += iterations;
        self.pass_time(taken);
    }

    /// After so many steps on lanes.
    fn pass_time(&mut self, taken: usize) {
        self.catch_up(taken);
        self.state.step += taken - 1;
        let Parts { state, stepper, around, .. } = self.parts();
        stepper.pass_time(state, &around);
    }

    /// After lanes have failed.
    pub(crate) fn pause_lanes(&mut self) {
        self.stepper.pause_lanes(&self.state);
    }

    /// Where there are no lanes.
    pub(crate) fn leave_lanes(&mut self) {
        self.stepper.leave_lanes();
    }

    /// Writes the state that shared lanes hold.
    pub(crate) fn write_back(&mut self, lanes: &Lanes, lane: usize) {
        self.stepper.write_back(lanes, lane, &mut self.state);
        if lanes.leave_followers() {
            self.follow(self.state.t - 0.5 * self.h);
        }
        lanes.write_rest(lane, &mut self.rest);
    }
}
