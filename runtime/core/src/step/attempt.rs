//! Newton's method from one guess, for all blocks at once, with constraints and a line search.

use super::{
    Attempt, FLOOR, GAP_FLOOR, KEEP_FACTORS, LINEAR_END, MAX_ITERATIONS, STAGNATION, State,
    Stepper, Surroundings, ratio,
};
use crate::internal;
use crate::model::{Midpoint, Model};

impl Stepper {
    pub(super) fn attempt<M: Model>(
        &mut self,
        model: &mut M,
        state: &State,
        around: &Surroundings,
    ) -> Attempt {
        self.evaluate(model, state, around, true);
        self.set_scales(state, around);
        let mut merit = self.merit();
        if !merit.is_finite() {
            return Attempt::NotFinite;
        }
        // While the residual falls fast enough the factors of an earlier iteration serve again: near
        // the solution they are as good as new and cost no matrix.
        let mut keep = false;
        'newton: for iteration in 0..MAX_ITERATIONS {
            if merit <= 1.0 {
                return Attempt::Converged;
            }
            self.iterations += 1;
            if !keep {
                if iteration > 0 {
                    self.evaluate(model, state, around, true);
                    self.set_scales(state, around);
                    merit = self.merit();
                }
                if let Err(coordinate) = self.factor() {
                    return Attempt::Singular(coordinate);
                }
            }
            self.newton_step();
            let correction = self.correction_size(state);
            if !correction.is_finite() {
                return Attempt::NotFinite;
            }
            self.trial.copy_from_slice(&self.delta);
            self.trial_lambda.copy_from_slice(&self.lambda);
            let before = merit;
            let mut fraction = 1.0;
            loop {
                self.force_before.copy_from_slice(&self.force);
                self.move_by(fraction);
                self.evaluate(model, state, around, false);
                let next = self.merit();
                // The next correction leaves next²/before of the residual and moves the impulse by
                // next/before of what this one did.
                let left = self.linear_end_error(around.h).max(next) * next;
                if fraction == 1.0 && next > 1.0 && left <= LINEAR_END * before {
                    self.iterations += 1;
                    self.end_linearly(state, around);
                    return Attempt::Converged;
                }
                if next > 0.1 * merit && correction <= STAGNATION && next.is_finite() {
                    // The residual hardly falls and the correction is rounding: the floor.
                    return Attempt::Converged;
                }
                if next <= 1.0 || next < merit * (1.0 - 1e-4 * fraction) {
                    merit = next;
                    break;
                }
                fraction *= 0.5;
                if fraction < 1e-3 {
                    if !keep {
                        return Attempt::Failed;
                    }
                    self.delta.copy_from_slice(&self.trial);
                    self.lambda.copy_from_slice(&self.trial_lambda);
                    keep = false;
                    continue 'newton;
                }
            }
            keep = merit < KEEP_FACTORS * before;
        }
        if merit <= 1.0 { Attempt::Converged } else { Attempt::Failed }
    }

    pub(super) fn evaluate<M: Model>(
        &mut self,
        model: &mut M,
        state: &State,
        around: &Surroundings,
        with_matrix: bool,
    ) {
        let h = around.h;
        for i in 0..self.delta.len() {
            self.q_mid[i] = state.q[i] + 0.5 * self.delta[i];
            self.v_mid[i] = self.delta[i] / h;
            self.q1[i] = state.q[i] + self.delta[i];
        }
        for &c in &self.internal_list {
            self.v_mid[c] = internal::RATE * self.delta[c] / h + self.past[c];
        }
        let at = Midpoint {
            q: &self.q_mid,
            v: &self.v_mid,
            t: 0.5 * (state.t + around.t1),
            rest: around.rest,
            inputs: around.inputs,
        };
        if with_matrix {
            let matrix = &mut self.matrix;
            model.evaluate_with_matrix(&at, h, &mut self.momentum, &mut self.force, matrix);
        } else {
            model.evaluate(&at, &mut self.momentum, &mut self.force);
        }
        if !self.lambda.is_empty() {
            model.constraints(&self.q1, around.t1, around.rest_end, &mut self.gap);
            if with_matrix {
                model.constraint_jacobian(&self.q1, around.t1, &mut self.g1);
            }
        }
        for c in 0..self.residual.len() {
            self.residual[c] = state.p[c] + 0.5 * h * self.force[c] - self.momentum[c];
        }
        let residual = &mut self.residual;
        for block in &self.blocks {
            block.add_constraint_forces(&self.g0, &self.lambda, |i, force| {
                residual[block.coordinates[i]] -= force;
            });
        }
    }

    /// Tolerance of each equation: what rounding of the coordinates does to it, or what is asked
    /// for relative to its momenta, whichever is larger.
    pub(super) fn set_scales(&mut self, state: &State, around: &Surroundings) {
        for c in 0..self.size.len() {
            self.size[c] = state.q[c].abs().max(self.floor_scale[c]);
            let impulse = 0.5 * around.h * self.force[c];
            let asked = state.p[c].abs() + self.momentum[c].abs() + impulse.abs();
            self.scale[c] = (FLOOR * state.p[c].abs()).max(self.tolerance * asked);
        }
        for block in &self.blocks {
            let step = &mut self.block_step[..block.coordinates.len()];
            step.fill(0.0);
            block.add_constraint_forces(&self.g0, &self.lambda, |i, force| step[i] += force.abs());
            for (i, &c) in block.coordinates.iter().enumerate() {
                let mut row = step[i];
                for entry in block.neighbours(i) {
                    let size = self.size[block.coordinates[entry.column]];
                    row += self.matrix[entry.slot].abs() * size;
                }
                self.scale[c] = self.scale[c].max(FLOOR * row);
            }
            for (k, &row) in block.rows.iter().enumerate() {
                let terms = block.entries(k).iter().map(|entry| {
                    self.g1[entry.slot].abs() * self.size[block.coordinates[entry.column]]
                });
                self.row_scale[row] = GAP_FLOOR * terms.sum::<f64>();
            }
        }
    }

    /// Largest residual in units of its tolerance; NaN where any is not a number.
    fn merit(&self) -> f64 {
        let mut worst = 0.0;
        // Once not a number, always not a number.
        let mut keep = |ratio: f64| {
            if !(worst >= ratio) && !f64::is_nan(worst) {
                worst = ratio;
            }
        };
        for block in &self.blocks {
            for &c in &block.coordinates {
                keep(ratio(self.residual[c], self.scale[c]));
            }
            for &row in &block.rows {
                keep(ratio(self.gap[row], self.row_scale[row]));
            }
        }
        worst
    }

    /// How far the last correction moved the half step's impulse, in units of tolerance. The next
    /// correction will move it by as much less as the residual has fallen.
    fn linear_end_error(&self, h: f64) -> f64 {
        let mut worst = 0.0f64;
        for block in &self.blocks {
            for &c in &block.coordinates {
                let change = 0.5 * h * (self.force[c] - self.force_before[c]);
                worst = worst.max(ratio(change, self.scale[c]));
            }
        }
        worst
    }

    /// A last correction with the factors at hand and no further evaluation: the impulse of the
    /// force would change by less than its tolerance, and the step's equation itself gives the
    /// momentum, p0 + h·f − Dh(q0)ᵀλ.
    fn end_linearly(&mut self, state: &State, around: &Surroundings) {
        self.trial.copy_from_slice(&self.delta);
        self.trial_lambda.copy_from_slice(&self.lambda);
        self.newton_step();
        self.move_by(1.0);
        self.residual.fill(0.0);
        let h = around.h;
        for c in 0..self.delta.len() {
            self.q1[c] = state.q[c] + self.delta[c];
            self.v_mid[c] = self.delta[c] / h;
            self.momentum[c] = state.p[c] + 0.5 * h * self.force[c];
        }
        let momentum = &mut self.momentum;
        for block in &self.blocks {
            block.add_constraint_forces(&self.g0, &self.lambda, |i, force| {
                momentum[block.coordinates[i]] -= force;
            });
        }
    }

    fn factor(&mut self) -> Result<(), usize> {
        self.condition = 0.0;
        for block in &mut self.blocks {
            match block.factor(&self.matrix, &self.g0, &self.g1) {
                Ok(pivots) => self.condition = self.condition.max(pivots.condition()),
                Err(singular) => {
                    self.condition = f64::INFINITY;
                    return Err(singular.coordinate);
                }
            }
        }
        Ok(())
    }

    /// The full correction, from the residual at hand and the factors kept.
    fn newton_step(&mut self) {
        for block in &mut self.blocks {
            let (n, m) = (block.coordinates.len(), block.rows.len());
            let step = &mut self.block_step[..n];
            let lambda = &mut self.block_lambda[..m];
            // The residual at λ = 0: the solve gives the whole multiplier.
            for (r, &c) in step.iter_mut().zip(&block.coordinates) {
                *r = self.residual[c];
            }
            block.add_constraint_forces(&self.g0, &self.lambda, |i, force| step[i] += force);
            for (k, &row) in block.rows.iter().enumerate() {
                lambda[k] = self.gap[row];
            }
            block.solve(step, lambda);
            for (i, &c) in block.coordinates.iter().enumerate() {
                self.newton[c] = step[i];
            }
            for (k, &row) in block.rows.iter().enumerate() {
                self.newton_lambda[row] = lambda[k];
            }
        }
    }

    /// Puts the increment at a fraction of the correction beyond the last one.
    fn move_by(&mut self, fraction: f64) {
        for i in 0..self.delta.len() {
            self.delta[i] = self.trial[i] + fraction * self.newton[i];
        }
        for i in 0..self.lambda.len() {
            let change = self.newton_lambda[i] - self.trial_lambda[i];
            self.lambda[i] = self.trial_lambda[i] + fraction * change;
        }
    }

    fn correction_size(&self, state: &State) -> f64 {
        let mut worst = 0.0;
        for block in &self.blocks {
            for &c in &block.coordinates {
                let size = self.newton[c].abs() / state.q[c].abs().max(self.floor_scale[c]);
                if !(worst >= size) && !f64::is_nan(worst) {
                    worst = size;
                }
            }
        }
        worst
    }

    pub(super) fn accept(&mut self, state: &mut State, around: &Surroundings) {
        for i in 0..self.delta.len() {
            state.q[i] = self.q1[i];
            state.v[i] = self.v_mid[i];
            // What is left of the residual goes into the momentum: p1 = p0 + h·f − Dh(q0)ᵀλ, so that
            // an increment known to rounding leaves no trace in what forces do not change.
            state.p[i] = if self.driven[i] {
                0.0
            } else {
                self.momentum[i] + 0.5 * around.h * self.force[i] + self.residual[i]
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
