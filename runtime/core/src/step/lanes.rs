//! Steps on lanes, by one run alone or by several together.

use super::{State, Stepper, Surroundings};
use crate::lane::Lane;
use crate::lane::sweep::{Sweep, sweep};
use crate::lanes::{LaneConstants, LaneRun, LaneStep};
use crate::model::Model;

impl Stepper {
    /// Whether lanes have not been found wanting yet.
    pub(crate) fn is_on_lanes(&self) -> bool {
        self.on_lanes
    }

    /// From now on this run steps number by number.
    pub(crate) fn leave_lanes(&mut self) {
        self.on_lanes = false;
    }

    /// Constants laid out for lanes, for others who work on the same model's lanes.
    pub(crate) fn lane_constants(&mut self) -> &mut LaneConstants {
        &mut self.lane_constants
    }

    /// What lanes need of this run, its guess made; and the constants that it has laid out.
    pub(crate) fn lane_run<'a>(
        &'a mut self,
        state: &'a State,
        around: &Surroundings<'a>,
    ) -> (LaneRun<'a>, &'a mut LaneConstants) {
        self.guess(0, state, around);
        let run = LaneRun {
            q: &state.q,
            p: &state.p,
            rest: around.rest,
            inputs: around.inputs,
            t: 0.5 * (state.t + around.t1),
            h: around.h,
            tolerance: self.tolerance,
            past: &self.past,
            delta: &mut self.delta,
            force: &mut self.force,
            iterations: 0,
            failed: false,
        };
        (run, &mut self.lane_constants)
    }

    /// Takes the step on lanes; `false` where the model or the machine has none, or where Newton's
    /// method needs more than lanes can do together.
    pub(super) fn step_on_lanes<M: Model>(
        &mut self,
        model: &mut M,
        state: &mut State,
        around: &Surroundings,
    ) -> bool {
        let (run, constants) = self.lane_run(state, around);
        let mut runs = [run];
        let mut step = LaneStep::new(&mut runs, &[model.revision()], constants);
        let complete = M::on_lanes(&[model], &mut step);
        let [LaneRun { iterations, failed, .. }] = runs;
        if !complete {
            self.leave_lanes();
            return false;
        }
        self.iterations += iterations;
        if !failed {
            self.accept_increment(state, around);
        }
        !failed
    }

    /// Puts the state at the end of the step, p1 = p0 + h·f.
    pub(crate) fn accept_increment(&mut self, state: &mut State, around: &Surroundings) {
        let count = self.delta.len();
        let (State { q, v, p, .. }, delta, force) = (&mut *state, &self.delta, &self.force);
        sweep(count, &mut Accept { q, v, p, delta, force, h: around.h });
        for &i in &self.driven_list {
            (state.q[i], state.p[i]) = (around.driven_q[i], 0.0);
        }
        self.rest_statics(state, around.h);
        self.predictor.learn(state.step, &self.delta, &mut state.differences);
        state.t = around.t1;
        state.step += 1;
    }
}

/// The end of a step by its increment and force.
struct Accept<'a> {
    q: &'a mut [f64],
    v: &'a mut [f64],
    p: &'a mut [f64],
    delta: &'a [f64],
    force: &'a [f64],
    h: f64,
}

impl Sweep for Accept<'_> {
    #[inline(always)]
    fn at<L: Lane>(&mut self, i: usize) {
        let (delta, h) = (L::load(&self.delta[i..]), L::splat(self.h));
        (L::load(&self.q[i..]) + delta).store(&mut self.q[i..]);
        (delta / h).store(&mut self.v[i..]);
        h.mul_add(L::load(&self.force[i..]), L::load(&self.p[i..])).store(&mut self.p[i..]);
    }
}
