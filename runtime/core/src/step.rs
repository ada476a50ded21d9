//! One step of the midpoint variational integrator.
//!
//! Unknown is the increment Δq = q1 − q0, not q1: its rounding is that of the motion within a step,
//! so that a residual far below ε·‖q‖‖M‖/h can be reached. The equations are
//!
//! p0 + (h/2)·f(q_mid, v_mid) − p(q_mid, v_mid) − Dh(q0)ᵀλ = 0,  h(q1) = 0,
//!
//! with p = ∂L/∂q̇ and f = ∂L/∂q + F; then p1 = p + (h/2)·f, which the last evaluation already
//! holds. Newton starts from the polynomial through the last configurations whose degree has lately
//! foretold the motion best, so that a smooth motion needs one iteration.

use crate::error::{StepError, StepErrorKind};
use crate::lanes::{LaneConstants, LaneRun, LaneStep};
use crate::layout::{CoordinateKind, Layout};
use crate::model::{Midpoint, Model};
use crate::solve::BlockSystem;

/// Gaps of constraints below this many units of rounding of the coordinates are closed.
const GAP_FLOOR: f64 = 1.0 * f64::EPSILON;
/// Residuals below this many units of rounding of the coordinates, seen through the Newton matrix,
/// are converged. Below one, because the unknown is the increment: rounding of the coordinates
/// enters through the forces alone.
pub(crate) const FLOOR: f64 = 0.3 * f64::EPSILON;
/// A Newton correction below this, relative to its coordinate, that hardly lowers the residual has
/// reached the floor.
pub(crate) const STAGNATION: f64 = 1e-12;
/// Factors are used again as long as an iteration brings the residual below this part of it.
pub(crate) const KEEP_FACTORS: f64 = 1e-2;
/// A step may end with a correction that is not evaluated if it changes no impulse by more than this
/// part of its tolerance.
pub(crate) const LINEAR_END: f64 = 0.25;
/// Highest degree of the polynomial through past configurations from which Newton starts.
const DEGREES: usize = 4;
/// Newton iterations per guess.
const MAX_ITERATIONS: usize = 40;

/// The state of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Steps taken.
    pub step: usize,
    /// Time (s).
    pub t: f64,
    /// Coordinates.
    pub q: Vec<f64>,
    /// Discrete momenta; zero for kinematic and driven coordinates.
    pub p: Vec<f64>,
    /// Rates of the step just ended; the initial ones before the first.
    pub v: Vec<f64>,
    /// Multipliers of the step just ended (impulses).
    pub lambda: Vec<f64>,
    /// Last increment and its backward differences, of which the first `step` mean something.
    differences: [Vec<f64>; DEGREES],
}

impl State {
    /// A state at time zero.
    pub fn new(q: Vec<f64>, p: Vec<f64>, v: Vec<f64>, rows: usize) -> Self {
        let differences = std::array::from_fn(|_| vec![0.0; q.len()]);
        State { step: 0, t: 0.0, q, p, v, lambda: vec![0.0; rows], differences }
    }
}

/// What the world does during a step.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings<'a> {
    /// Step (s).
    pub h: f64,
    /// Time at the end of the step (s).
    pub t1: f64,
    /// Inputs at the middle of the step.
    pub inputs: &'a [f64],
    /// Natural lengths at the middle of the step (m).
    pub rest: &'a [f64],
    /// Coordinates at the end of the step; only those of driven coordinates are read.
    pub driven_q: &'a [f64],
}

/// Takes steps; owns all scratch space, so that a step allocates nothing.
#[derive(Clone, Debug)]
pub struct Stepper {
    blocks: Vec<BlockSystem>,
    driven: Vec<bool>,
    floor_scale: Vec<f64>,
    /// Relative tolerance on momenta; rounding sets the floor below it.
    pub tolerance: f64,
    /// Newton iterations since the beginning.
    pub iterations: usize,
    delta: Vec<f64>,
    trial: Vec<f64>,
    lambda: Vec<f64>,
    trial_lambda: Vec<f64>,
    q1: Vec<f64>,
    q_mid: Vec<f64>,
    v_mid: Vec<f64>,
    momentum: Vec<f64>,
    force: Vec<f64>,
    force_before: Vec<f64>,
    matrix: Vec<f64>,
    g0: Vec<f64>,
    g1: Vec<f64>,
    gap: Vec<f64>,
    residual: Vec<f64>,
    size: Vec<f64>,
    scale: Vec<f64>,
    row_scale: Vec<f64>,
    newton: Vec<f64>,
    newton_lambda: Vec<f64>,
    block_step: Vec<f64>,
    block_lambda: Vec<f64>,
    condition: f64,
    /// 1 over the size of each coordinate; 0 where driven.
    guess_weight: Vec<f64>,
    /// Fading sum of the squares by which a guess of each degree has missed.
    missed: [f64; DEGREES],
    /// Whether every block is free of constraints and of drives, so that lanes can take the step.
    on_lanes: bool,
    lane_constants: LaneConstants,
}

/// How an attempt from one guess ended.
enum Attempt {
    Converged,
    Failed,
    NotFinite,
    Singular(usize),
}

impl Stepper {
    /// For a model whose coordinates marked in `driven` (kinematic ones, and those a scenario
    /// drives) have their path given.
    pub fn new(layout: &Layout, driven: &[bool], tolerance: f64) -> Self {
        let (n, m) = (layout.coordinates.len(), layout.rows.len());
        let floor_scale: Vec<f64> = layout
            .coordinates
            .iter()
            .map(|c| match c.kind {
                CoordinateKind::Angle => 1.0,
                CoordinateKind::Length => layout.length_scale,
            })
            .collect();
        let weight = |(size, driven): (&f64, &bool)| if *driven { 0.0 } else { 1.0 / size };
        let guess_weight = floor_scale.iter().zip(driven).map(weight).collect();
        Stepper {
            blocks: layout.blocks.iter().map(|b| BlockSystem::new(b, driven)).collect(),
            driven: driven.to_vec(),
            floor_scale,
            tolerance,
            iterations: 0,
            delta: vec![0.0; n],
            trial: vec![0.0; n],
            lambda: vec![0.0; m],
            trial_lambda: vec![0.0; m],
            q1: vec![0.0; n],
            q_mid: vec![0.0; n],
            v_mid: vec![0.0; n],
            momentum: vec![0.0; n],
            force: vec![0.0; n],
            force_before: vec![0.0; n],
            matrix: vec![0.0; layout.matrix_size()],
            g0: vec![0.0; layout.constraint_size()],
            g1: vec![0.0; layout.constraint_size()],
            gap: vec![0.0; m],
            residual: vec![0.0; n],
            size: vec![0.0; n],
            scale: vec![0.0; n],
            row_scale: vec![0.0; m],
            newton: vec![0.0; n],
            newton_lambda: vec![0.0; m],
            block_step: vec![0.0; n],
            block_lambda: vec![0.0; m],
            condition: f64::NAN,
            guess_weight,
            missed: [0.0; DEGREES],
            on_lanes: layout.rows.is_empty()
                && layout.blocks.iter().all(|b| b.coordinates.iter().all(|&c| !driven[c])),
            lane_constants: LaneConstants::default(),
        }
    }

    /// Takes one step. On an error the state is untouched.
    pub fn step<M: Model>(
        &mut self,
        model: &mut M,
        state: &mut State,
        around: &Surroundings,
    ) -> Result<(), StepError> {
        if self.on_lanes && self.step_on_lanes(model, state, around) {
            return Ok(());
        }
        let before = self.iterations;
        if !self.lambda.is_empty() {
            model.constraint_jacobian(&state.q, state.t, &mut self.g0);
        }
        let mut last = Attempt::Failed;
        for guess in 0..4 {
            self.guess(guess, state, around);
            last = self.attempt(model, state, around);
            match last {
                Attempt::Converged => {
                    self.accept(state, around);
                    return Ok(());
                }
                Attempt::Singular(_) if guess >= 1 => break,
                _ => {}
            }
        }
        Err(self.report(model, state, around, last, self.iterations - before))
    }

    /// Takes the step on lanes; `false` where the model or the machine has none, or where Newton's
    /// method needs more than lanes can do together.
    fn step_on_lanes<M: Model>(
        &mut self,
        model: &mut M,
        state: &mut State,
        around: &Surroundings,
    ) -> bool {
        self.guess(0, state, around);
        let mut runs = [LaneRun {
            q: &state.q,
            p: &state.p,
            rest: around.rest,
            inputs: around.inputs,
            t: 0.5 * (state.t + around.t1),
            h: around.h,
            tolerance: self.tolerance,
            size: &self.floor_scale,
            delta: &mut self.delta,
            force: &mut self.force,
            iterations: 0,
            failed: false,
        }];
        let mut step = LaneStep::new(&mut runs, &[model.revision()], &mut self.lane_constants);
        if !M::step_on_lanes(&[model], &mut step) {
            self.on_lanes = false;
            return false;
        }
        let [LaneRun { iterations, failed, .. }] = runs;
        self.iterations += iterations;
        if !failed {
            self.accept_increment(state, around);
        }
        !failed
    }

    /// Puts the state at the end of the step, p1 = p0 + h·f.
    fn accept_increment(&mut self, state: &mut State, around: &Surroundings) {
        let h = around.h;
        for i in 0..self.delta.len() {
            state.q[i] += self.delta[i];
            state.v[i] = self.delta[i] / h;
            state.p[i] = if self.driven[i] { 0.0 } else { state.p[i] + h * self.force[i] };
        }
        for i in (0..self.delta.len()).filter(|&i| self.driven[i]) {
            state.q[i] = around.driven_q[i];
        }
        self.learn(state);
        state.t = around.t1;
        state.step += 1;
    }

    fn guess(&mut self, number: usize, state: &State, around: &Surroundings) {
        let degree = self.best_degree(state);
        for i in 0..self.delta.len() {
            self.delta[i] = if self.driven[i] {
                around.driven_q[i] - state.q[i]
            } else {
                match number {
                    0 if state.step >= 2 => state.differences[..degree].iter().map(|d| d[i]).sum(),
                    0 | 1 => state.v[i] * around.h,
                    2 => 0.0,
                    _ => 0.5 * state.v[i] * around.h,
                }
            };
        }
        if number <= 2 {
            self.lambda.copy_from_slice(&state.lambda);
        } else {
            self.lambda.fill(0.0);
        }
    }

    /// The degree that has foretold the last steps best; the quadratic until more is known.
    fn best_degree(&self, state: &State) -> usize {
        let mut best = 2;
        for degree in 1..=DEGREES.min(state.step.saturating_sub(1)) {
            if self.missed[degree - 1] < self.missed[best - 1] {
                best = degree;
            }
        }
        best
    }

    /// Takes the new increment into the table of differences. The sum of the first k of them is the
    /// increment that the polynomial of degree k foretells, and the k-th is what it missed.
    fn learn(&mut self, state: &mut State) {
        let mut missed = [0.0; DEGREES];
        for i in 0..self.delta.len() {
            let mut difference = self.delta[i];
            for k in 0..DEGREES {
                let next = difference - state.differences[k][i];
                state.differences[k][i] = difference;
                difference = next;
                missed[k] += (next * self.guess_weight[i]).powi(2);
            }
        }
        for k in 0..DEGREES.min(state.step) {
            let faded = if k + 1 < state.step { 0.5 * self.missed[k] } else { 0.0 };
            self.missed[k] = missed[k] + faded;
        }
    }

    fn attempt<M: Model>(
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

    fn evaluate<M: Model>(
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
            model.constraints(&self.q1, around.t1, &mut self.gap);
            if with_matrix {
                model.constraint_jacobian(&self.q1, around.t1, &mut self.g1);
            }
        }
        for c in 0..self.residual.len() {
            self.residual[c] = state.p[c] + 0.5 * h * self.force[c] - self.momentum[c];
        }
        for block in self.blocks.iter().filter(|block| !block.rows.is_empty()) {
            for (row, &global) in block.rows.iter().enumerate() {
                let lambda = self.lambda[global];
                for (i, &c) in block.coordinates.iter().enumerate() {
                    self.residual[c] -= block.constraint_entry(&self.g0, row, i) * lambda;
                }
            }
        }
    }

    /// Tolerance of each equation: what rounding of the coordinates does to it, or what is asked
    /// for relative to its momenta, whichever is larger.
    fn set_scales(&mut self, state: &State, around: &Surroundings) {
        for c in 0..self.size.len() {
            self.size[c] = state.q[c].abs().max(self.floor_scale[c]);
            let impulse = 0.5 * around.h * self.force[c];
            let asked = state.p[c].abs() + self.momentum[c].abs() + impulse.abs();
            self.scale[c] = (FLOOR * state.p[c].abs()).max(self.tolerance * asked);
        }
        for block in &self.blocks {
            for (i, &c) in block.coordinates.iter().enumerate() {
                let entries = block.matrix_row(&self.matrix, i);
                let mut row = 0.0;
                for (k, &other) in block.coordinates.iter().enumerate() {
                    row += entries[block.position(k)].abs() * self.size[other];
                }
                for (k, &global) in block.rows.iter().enumerate() {
                    row += (block.constraint_entry(&self.g0, k, i) * self.lambda[global]).abs();
                }
                self.scale[c] = self.scale[c].max(FLOOR * row);
            }
            for (k, &row) in block.rows.iter().enumerate() {
                self.row_scale[row] = GAP_FLOOR
                    * block
                        .coordinates
                        .iter()
                        .enumerate()
                        .map(|(i, &c)| block.constraint_entry(&self.g1, k, i).abs() * self.size[c])
                        .sum::<f64>();
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
        for block in self.blocks.iter().filter(|block| !block.rows.is_empty()) {
            for (row, &global) in block.rows.iter().enumerate() {
                let lambda = self.lambda[global];
                for (i, &c) in block.coordinates.iter().enumerate() {
                    self.momentum[c] -= block.constraint_entry(&self.g0, row, i) * lambda;
                }
            }
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
            for (i, &c) in block.coordinates.iter().enumerate() {
                // The residual at λ = 0: the solve gives the whole multiplier.
                let mut r = self.residual[c];
                for (row, &global) in block.rows.iter().enumerate() {
                    r += block.constraint_entry(&self.g0, row, i) * self.lambda[global];
                }
                step[i] = r;
            }
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

    fn accept(&mut self, state: &mut State, around: &Surroundings) {
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
        state.lambda.copy_from_slice(&self.lambda);
        self.learn(state);
        state.t = around.t1;
        state.step += 1;
    }

    fn report<M: Model>(
        &mut self,
        model: &mut M,
        state: &State,
        around: &Surroundings,
        last: Attempt,
        iterations: usize,
    ) -> StepError {
        // Evaluate where the step began, so that the numbers reported are the model's own.
        self.guess(2, state, around);
        self.evaluate(model, state, around, true);
        self.set_scales(state, around);
        let layout = model.layout();
        let mut worst = (0.0, String::from("none"), 0.0);
        let mut keep = |found: f64, name: &str, r: f64| {
            // The first that is not a number stays.
            if !(found <= worst.0) && !f64::is_nan(worst.0) {
                worst = (found, name.to_string(), r);
            }
        };
        for block in &self.blocks {
            for &c in &block.coordinates {
                let r = self.residual[c];
                keep(ratio(r, self.scale[c]), &layout.coordinates[c].name, r);
            }
            for &row in &block.rows {
                let gap = self.gap[row];
                keep(ratio(gap, self.row_scale[row]), &layout.rows[row].name, gap);
            }
        }
        let mut hints = Vec::new();
        let kind = match last {
            Attempt::Singular(coordinate) => {
                let name = &layout.coordinates[coordinate].name;
                worst.1 = name.clone();
                hints.push(format!(
                    "give `{name}` mass or stiffness: neither a mass, a strand nor a constraint \
                     determines it here"
                ));
                StepErrorKind::Singular
            }
            _ if !worst.0.is_finite() => {
                hints.push(
                    "look for coincident path points or a division by zero in an expression"
                        .to_string(),
                );
                StepErrorKind::NotFinite
            }
            _ => StepErrorKind::NoConvergence,
        };
        if kind == StepErrorKind::NoConvergence {
            let fastest = crate::frequency::fastest(model, &state.q, around);
            if let Some(omega) = fastest.filter(|omega| omega * around.h > 0.5) {
                hints.push(format!(
                    "a smaller step: the stiffest motion has h·ω = {:.2} (ω = {omega:.0} rad/s); \
                     h = {:.1e} s brings it to 0.5",
                    around.h * omega,
                    0.5 / omega
                ));
            } else {
                hints.push(format!("a smaller step than {} s", around.h));
            }
            hints.push("drives, inputs and motions that begin without a jump".to_string());
        }
        StepError {
            kind,
            t: state.t,
            step: state.step + 1,
            equation: worst.1,
            residual: worst.2,
            condition: self.condition,
            iterations,
            hints,
        }
    }
}

/// |r| in units of its tolerance; an equation without any scale must hold exactly.
fn ratio(r: f64, size: f64) -> f64 {
    if r == 0.0 { 0.0 } else { r.abs() / size.max(f64::MIN_POSITIVE) }
}
