//! Newton's method from one guess, for all blocks at once, with constraints and a line search.

use super::{
    Attempt, LINEAR_END, MAX_ITERATIONS, NOTHING, STAGNATION, State, Stepper, Surroundings,
};
use crate::model::Model;

impl Stepper {
    pub(super) fn attempt<M: Model>(
        &mut self,
        model: &mut M,
        state: &State,
        around: &Surroundings,
    ) -> Attempt {
        // Factors at hand serve as long as they make a step converge fast enough. They are this step's
        // own if made in it, and fresh if made where the increment is now.
        let mut fresh = self.renewal.begin(around.h);
        let mut is_own = fresh;
        let start = match fresh {
            true => self.renew(model, state, around),
            false => self.look(model, state, around),
        };
        let mut merit = match start {
            Ok(merit) => merit,
            Err(attempt) => return attempt,
        };
        let (mut corrections, mut last) = (0, f64::NAN);
        for _ in 0..MAX_ITERATIONS {
            if merit <= 1.0 {
                self.renewal.end(corrections);
                return Attempt::Converged;
            }
            self.iterations += 1;
            corrections += 1;
            self.newton_step();
            self.trial.copy_from_slice(&self.delta);
            self.trial_lambda.copy_from_slice(&self.lambda);
            let (earlier, before) = (last, merit);
            last = before;
            let mut fraction = 1.0;
            loop {
                self.force_before.copy_from_slice(&self.force);
                self.move_by(fraction);
                self.evaluate(model, state, around, false);
                let next = self.merit();
                // The next correction leaves this part of the residual, and of how far the last one
                // moved the impulse. Of factors made elsewhere one correction says too little.
                let rate = match is_own {
                    true => next / before,
                    false => (next / before).max(before / earlier.max(before)),
                };
                let left = self.linear_end_error(around.h).max(next) * rate;
                if fraction == 1.0 && next > 1.0 && left <= LINEAR_END {
                    self.iterations += 1;
                    self.renewal.end(corrections + 1);
                    self.end_linearly(state, around);
                    return Attempt::Converged;
                }
                let is_slow = is_own && next > 0.1 * before && next.is_finite();
                if is_slow && self.correction_size(state) <= STAGNATION {
                    // The residual hardly falls and the correction is rounding: the floor.
                    self.renewal.end(corrections);
                    return Attempt::Converged;
                }
                // Factors that are not fresh are judged below, by more than one correction.
                if !fresh || next <= 1.0 || next < merit * (1.0 - 1e-4 * fraction) {
                    merit = next;
                    break;
                }
                fraction *= 0.5;
                if fraction < 1e-3 {
                    return Attempt::Failed;
                }
            }
            fresh = false;
            if !(merit <= 1.0) && !self.renewal.goes_on([earlier, before, merit]) {
                if !(merit < before) {
                    self.delta.copy_from_slice(&self.trial);
                    self.lambda.copy_from_slice(&self.trial_lambda);
                }
                (fresh, is_own) = (true, true);
                (corrections, last) = (0, f64::NAN);
                merit = match self.renew(model, state, around) {
                    Ok(merit) => merit,
                    Err(attempt) => return attempt,
                };
            }
        }
        if merit <= 1.0 { Attempt::Converged } else { Attempt::Failed }
    }

    pub(super) fn accept(&mut self, state: &mut State, around: &Surroundings) {
        for i in 0..self.delta.len() {
            if self.delta[i].abs() < NOTHING {
                (self.delta[i], self.q1[i]) = (0.0, state.q[i]);
            }
            state.q[i] = self.q1[i];
            state.v[i] = self.v_mid[i];
            // What is left of the residual goes into the momentum: p1 = p0 + h·f − Dh(q0)ᵀλ, so that
            // an increment known to rounding leaves no trace in what forces do not change.
            state.p[i] = if self.driven[i] {
                0.0
            } else {
                let p = self.momentum[i] + 0.5 * around.h * self.force[i] + self.residual[i];
                if p.abs() < NOTHING { 0.0 } else { p }
            };
        }
        // A driven coordinate ends exactly where it was told to.
        for i in (0..self.delta.len()).filter(|&i| self.driven[i]) {
            state.q[i] = around.driven_q[i];
        }
        self.rest_statics(state, around.h);
        state.lambda.copy_from_slice(&self.lambda);
        self.predictor.learn(state.step, &self.delta, &mut state.differences);
        state.t = around.t1;
        state.step += 1;
    }
}
