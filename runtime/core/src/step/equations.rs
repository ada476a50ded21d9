//! The step's equations at an increment: residuals, their tolerances, and corrections.

use super::{Attempt, BALANCE, FLOOR, GAP_FLOOR, State, Stepper, Surroundings};
use crate::internal;
use crate::lanes::{Asked, LaneEvaluation};
use crate::model::{Midpoint, Model};
use crate::solve::Residuals;

impl Stepper {
    /// Evaluates the equations at the increment and sets their tolerances. Returns the largest
    /// residual in units of them.
    pub(super) fn look<M: Model>(
        &mut self,
        model: &mut M,
        state: &State,
        around: &Surroundings,
    ) -> Result<f64, Attempt> {
        self.evaluate(model, state, around, false);
        self.set_scales(state, around);
        let merit = self.merit();
        if merit.is_finite() { Ok(merit) } else { Err(Attempt::NotFinite) }
    }

    /// As [`Stepper::look`], and makes new factors there if the equations do not hold already.
    pub(super) fn renew<M: Model>(
        &mut self,
        model: &mut M,
        state: &State,
        around: &Surroundings,
    ) -> Result<f64, Attempt> {
        self.evaluate(model, state, around, true);
        self.set_sensitivities(state);
        self.set_scales(state, around);
        let merit = self.merit();
        if !merit.is_finite() {
            return Err(Attempt::NotFinite);
        }
        if merit > 1.0 {
            self.renewal.forget();
            self.factor().map_err(Attempt::Singular)?;
            if self.blocks.iter().all(|block| block.is_regular()) {
                self.renewal.made(around.h);
            }
        }
        Ok(merit)
    }

    pub(super) fn evaluate<M: Model>(
        &mut self,
        model: &mut M,
        state: &State,
        around: &Surroundings,
        with_matrix: bool,
    ) {
        let h = around.h;
        let count = self.delta.len();
        let (q, q_mid, v_mid) =
            (&state.q[..count], &mut self.q_mid[..count], &mut self.v_mid[..count]);
        for ((i, delta), q1) in self.delta.iter().enumerate().zip(&mut self.q1) {
            q_mid[i] = q[i] + 0.5 * delta;
            v_mid[i] = delta / h;
            *q1 = q[i] + delta;
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
        let asked = Asked {
            at,
            momentum: &mut self.momentum,
            force: &mut self.force,
            matrix: with_matrix.then_some((h, &mut self.matrix)),
        };
        self.evaluates_on_lanes = self.evaluates_on_lanes && {
            let constants = &mut self.lane_constants;
            let mut evaluation = LaneEvaluation::new(asked, model.revision(), constants);
            M::on_lanes(&[model], &mut evaluation)
        };
        let is_finite = |numbers: &[f64]| numbers.iter().all(|x| x.is_finite());
        // Vectors do without what is rare, such as the sine of an angle beyond measure.
        let is_done = self.evaluates_on_lanes
            && is_finite(&self.momentum[..count])
            && is_finite(&self.force[..count]);
        if !is_done {
            let (momentum, force) = (&mut self.momentum, &mut self.force);
            match with_matrix {
                true => model.evaluate_with_matrix(&at, h, momentum, force, &mut self.matrix),
                false => model.evaluate(&at, momentum, force),
            }
        }
        if !self.lambda.is_empty() {
            model.constraints(&self.q1, around.t1, around.rest_end, &mut self.gap);
            if with_matrix {
                model.constraint_jacobian(&self.q1, around.t1, &mut self.g1);
            }
        }
        self.pulls.forces(&self.g0, &self.lambda, &mut self.pull);
        let (p, momentum) = (&state.p[..count], &self.momentum[..count]);
        let (force, pull) = (&self.force[..count], &self.pull[..count]);
        for (c, residual) in self.residual.iter_mut().enumerate() {
            *residual = p[c] + (0.5 * h * force[c] - pull[c]) - momentum[c];
        }
        for &c in &self.driven_list {
            self.residual[c] = 0.0;
        }
    }

    /// What rounding of the coordinates does to each equation, by the matrices at hand.
    pub(super) fn set_sensitivities(&mut self, state: &State) {
        for c in 0..self.size.len() {
            self.size[c] = state.q[c].abs().max(self.floor_scale[c]);
        }
        let matrices = (&self.matrix[..], &self.g1[..]);
        for block in &self.blocks {
            block.sensitivities(matrices, &self.size, &mut self.sensitivity, &mut self.per_gap);
            for &row in &block.rows {
                self.per_gap[row] = per(GAP_FLOOR * self.per_gap[row]);
            }
        }
        // Where its strands go slack nothing is left of a balance's stiffness but what it has been.
        for &c in &self.static_list {
            self.stiffest[c] = self.stiffest[c].max(self.sensitivity[c]);
            self.sensitivity[c] = BALANCE * self.stiffest[c];
        }
    }

    /// Tolerance of each equation: what rounding of the coordinates does to it, or what is asked
    /// for relative to its momenta, whichever is larger.
    pub(super) fn set_scales(&mut self, state: &State, around: &Surroundings) {
        self.pulls.sizes(&self.g0, &self.lambda, &mut self.bound);
        let count = self.per_scale.len();
        let (momentum, force) = (&self.momentum[..count], &self.force[..count]);
        let (p, bound) = (&state.p[..count], &self.bound[..count]);
        let sensitivity = &self.sensitivity[..count];
        for (c, place) in self.per_scale.iter_mut().enumerate() {
            let (p, impulse) = (p[c].abs(), 0.5 * around.h * force[c]);
            let asked = p + momentum[c].abs() + impulse.abs();
            let floor = FLOOR * p.max(sensitivity[c] + bound[c]);
            *place = per(floor.max(self.tolerance * asked));
        }
    }

    /// Largest residual in units of its tolerance; NaN where any is not finite.
    pub(super) fn merit(&self) -> f64 {
        let (mut worst, mut finite) = (0.0, true);
        let mut keep = |(residual, per_scale): (&f64, &f64)| {
            let ratio = residual.abs() * per_scale;
            finite &= ratio < f64::INFINITY;
            worst = if ratio > worst { ratio } else { worst };
        };
        self.residual.iter().zip(&self.per_scale).for_each(&mut keep);
        self.gap.iter().zip(&self.per_gap).for_each(&mut keep);
        if finite { worst } else { f64::NAN }
    }

    /// How far the last correction moved the half step's impulse, in units of tolerance. The next
    /// correction will move it by as much less as the residual has fallen.
    pub(super) fn linear_end_error(&self, h: f64) -> f64 {
        let forces = self.force.iter().zip(&self.force_before);
        let moved =
            forces.zip(&self.per_scale).map(|((now, before), per)| (now - before).abs() * per);
        0.5 * h * moved.fold(0.0, f64::max)
    }

    /// A last correction with the factors at hand and no further evaluation: the impulse of the
    /// force would change by less than its tolerance, and the step's equation itself gives the
    /// momentum, p0 + h·f − Dh(q0)ᵀλ.
    pub(super) fn end_linearly(&mut self, state: &State, around: &Surroundings) {
        self.trial.copy_from_slice(&self.delta);
        self.trial_lambda.copy_from_slice(&self.lambda);
        self.newton_step();
        self.move_by(1.0);
        self.residual.fill(0.0);
        self.pulls.forces(&self.g0, &self.lambda, &mut self.pull);
        let h = around.h;
        for c in 0..self.delta.len() {
            self.q1[c] = state.q[c] + self.delta[c];
            self.v_mid[c] = self.delta[c] / h;
            self.momentum[c] = state.p[c] + 0.5 * h * self.force[c] - self.pull[c];
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
    pub(super) fn newton_step(&mut self) {
        let of = Residuals {
            residual: &self.residual,
            gaps: &self.gap,
            pull: &self.pull,
            lambda: &self.lambda,
        };
        for block in &mut self.blocks {
            block.correct(&of, &mut self.newton, &mut self.newton_lambda);
        }
    }

    /// Puts the increment at a fraction of the correction beyond the last one.
    pub(super) fn move_by(&mut self, fraction: f64) {
        let moves = self.trial.iter().zip(&self.newton);
        for (to, (from, step)) in self.delta.iter_mut().zip(moves) {
            *to = from + fraction * step;
        }
        let moves = self.trial_lambda.iter().zip(&self.newton_lambda);
        for (to, (from, step)) in self.lambda.iter_mut().zip(moves) {
            *to = from + fraction * step;
        }
    }

    /// The largest correction relative to its coordinate; NaN where any is not a number.
    pub(super) fn correction_size(&self, state: &State) -> f64 {
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
}

/// 1 over a tolerance; an equation without any scale must hold exactly.
fn per(scale: f64) -> f64 {
    1.0 / scale.max(f64::MIN_POSITIVE)
}
