//! One step of the midpoint variational integrator.
//!
//! Unknown is the increment Δq = q1 − q0, not q1: its rounding is that of the motion within a step,
//! so that a residual far below ε·‖q‖‖M‖/h can be reached. The equations are
//!
//! p0 + (h/2)·f(q_mid, v_mid) − p(q_mid, v_mid) − Dh(q0)ᵀλ = 0,  h(q1) = 0,
//!
//! with p = ∂L/∂q̇ and f = ∂L/∂q + F; then p1 = p + (h/2)·f, which the last evaluation already
//! holds. A coordinate that moves no mass has p = 0 and so f = 0: its value at the middle of the step
//! is the unknown that balances the forces there, and is what the state keeps of it. If its rate
//! matters it is an [internal variable](crate::internal) with a rate of its own kind. Newton starts
//! from the polynomial through the last configurations whose degree has lately foretold the motion
//! best, so that a smooth motion needs one iteration.

mod attempt;
mod equations;
mod lanes;
mod renewal;
mod report;

use crate::error::StepError;
use crate::internal;
use crate::lanes::{Courses, EvaluationConstants, Kinds, Lanes, Told};
use crate::layout::{CoordinateKind, Layout};
use crate::model::Model;
use crate::predict::{DEGREES, Differences, Predictor};
use crate::solve::{BlockSystem, Pulls, spans};
use crate::system::System;
use lanes::OnLanes;
pub(crate) use renewal::Renewal;

/// Gaps of constraints below this many units of rounding of the coordinates are closed.
const GAP_FLOOR: f64 = 1.0 * f64::EPSILON;
/// Residuals below this many units of rounding of the coordinates, seen through the Newton matrix,
/// are converged. Below one, because the unknown is the increment: rounding of the coordinates
/// enters through the forces alone.
pub(crate) const FLOOR: f64 = 0.3 * f64::EPSILON;
/// Forces in balance cancel, and their rounding with them: how much more than that of the coordinates
/// is left.
pub(crate) const BALANCE: f64 = 16.0;
/// A Newton correction below this, relative to its coordinate, that hardly lowers the residual has
/// reached the floor.
pub(crate) const STAGNATION: f64 = 1e-12;
/// Factors are used again as long as an iteration brings the residual below this part of it.
pub(crate) const KEEP_FACTORS: f64 = 1e-2;
/// A step may end with a correction that is not evaluated if it changes no impulse by more than this
/// part of its tolerance.
pub(crate) const LINEAR_END: f64 = 0.25;
/// Newton iterations per guess.
const MAX_ITERATIONS: usize = 40;
/// Coordinates, increments and momenta below this are nothing (rad or m, and their momenta). What dies away would
/// otherwise end among numbers so small that processors take a hundred times as long for them.
pub(crate) const NOTHING: f64 = 1e-50;

/// The state of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Steps taken.
    pub step: usize,
    /// Time (s).
    pub t: f64,
    /// Coordinates; those in static equilibrium and internal ones at the middle of the step just
    /// ended.
    pub q: Vec<f64>,
    /// Discrete momenta; zero for kinematic and driven coordinates.
    pub p: Vec<f64>,
    /// Rates of the step just ended; the initial ones before the first.
    pub v: Vec<f64>,
    /// Multipliers of the step just ended (impulses).
    pub lambda: Vec<f64>,
    /// Of which Newton's start is made.
    pub(crate) differences: Differences,
}

impl State {
    /// A state at time zero.
    pub fn new(q: Vec<f64>, p: Vec<f64>, v: Vec<f64>, rows: usize) -> Self {
        let differences = vec![0.0; DEGREES * q.len()];
        State { step: 0, t: 0.0, q, p, v, lambda: vec![0.0; rows], differences }
    }

    /// Increment of a coordinate in the step just ended.
    pub(crate) fn last_increment(&self, c: usize) -> f64 {
        self.differences[c]
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
    /// Lengths prescribed for strands at the end of the step (m); others are not read.
    pub rest_end: &'a [f64],
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
    /// Dh(q0)ᵀλ.
    pull: Vec<f64>,
    size: Vec<f64>,
    /// Σ|Jᵢⱼ|·size(j) of the matrix at hand.
    sensitivity: Vec<f64>,
    /// Sizes of the terms of Dh(q0)ᵀλ.
    bound: Vec<f64>,
    /// 1 over the tolerance of each residual and each gap.
    per_scale: Vec<f64>,
    per_gap: Vec<f64>,
    newton: Vec<f64>,
    newton_lambda: Vec<f64>,
    condition: f64,
    predictor: Predictor,
    /// The driven coordinates by index.
    driven_list: Vec<usize>,
    /// The coordinates in static equilibrium, by index.
    static_list: Vec<usize>,
    /// The largest sensitivity of each of their equations so far; zero for others.
    stiffest: Vec<f64>,
    /// The internal ones.
    internal_list: Vec<usize>,
    /// What past steps add to the rates of internal coordinates; zero for others.
    past: Vec<f64>,
    on_lanes: OnLanes,
    /// Whether the equations are evaluated on lanes where the step is not taken there.
    evaluates_on_lanes: bool,
    /// What constraints do to coordinates; unknown before the first step.
    pulls: Pulls,
    structure_seen: bool,
    renewal: Renewal,
    lane_constants: EvaluationConstants,
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
                CoordinateKind::Angle | CoordinateKind::Ratio => 1.0,
                CoordinateKind::Length => layout.length_scale,
            })
            .collect();
        let statics = layout.statics(driven);
        let blocks: Vec<BlockSystem> =
            layout.blocks.iter().map(|b| BlockSystem::new(b, driven, &statics)).collect();
        let is_static = (0..n).map(|c| statics.contains(&c)).collect();
        let internals = layout.internals(driven);
        let is_internal = (0..n).map(|c| internals.contains(&c)).collect();
        let lanes = Lanes::new(Kinds { size: floor_scale.clone(), is_static, is_internal });
        let is_free = layout.rows.is_empty()
            && layout.blocks.iter().all(|b| b.coordinates.iter().all(|&c| !driven[c]));
        let predictor = Predictor::new(&floor_scale, driven);
        Stepper {
            blocks,
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
            pull: vec![0.0; n],
            size: vec![0.0; n],
            sensitivity: vec![0.0; n],
            bound: vec![0.0; n],
            per_scale: vec![0.0; n],
            per_gap: vec![0.0; m],
            newton: vec![0.0; n],
            newton_lambda: vec![0.0; m],
            condition: f64::NAN,
            predictor,
            driven_list: (0..n).filter(|&c| driven[c]).collect(),
            stiffest: vec![0.0; n],
            static_list: statics,
            internal_list: internals,
            past: vec![0.0; n],
            on_lanes: OnLanes::new(lanes, is_free),
            evaluates_on_lanes: true,
            pulls: Pulls::default(),
            structure_seen: false,
            renewal: Renewal::new(0.0),
            lane_constants: EvaluationConstants::default(),
        }
    }

    /// Takes one step. On an error the state is untouched.
    pub fn step<M: Model>(
        &mut self,
        model: &mut M,
        state: &mut State,
        around: &Surroundings,
    ) -> Result<(), StepError> {
        let nothing_follows = Courses { poses: &[], motions: &[] };
        let Surroundings { rest, inputs, driven_q, .. } = *around;
        let told = Told { steps: 1, rest, inputs, ends: driven_q };
        if self.steps_on_lanes(model, state, around, nothing_follows, told, 1) > 0 {
            self.pass_time(state, around);
            self.hold(state);
            return Ok(());
        }
        self.step_by_numbers(model, state, around)
    }

    /// As [`Stepper::step`], without lanes.
    pub(crate) fn step_by_numbers<M: Model>(
        &mut self,
        model: &mut M,
        state: &mut State,
        around: &Surroundings,
    ) -> Result<(), StepError> {
        let before = self.iterations;
        self.see_structure(model, state);
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
        self.renewal.forget();
        Err(self.report(model, state, around, last, self.iterations - before))
    }

    /// Puts coordinates in static equilibrium where the forces balance: at the middle of the step,
    /// where the equation was solved, and not beyond it; internal ones likewise. They carry no
    /// momentum.
    fn rest_statics(&self, state: &mut State, h: f64) {
        for &c in &self.static_list {
            state.q[c] -= 0.5 * self.delta[c];
            state.v[c] = 0.5 * self.delta[c] / h;
            state.p[c] = 0.0;
        }
        for &c in &self.internal_list {
            state.q[c] -= 0.5 * self.delta[c];
            state.v[c] = internal::RATE * self.delta[c] / h + self.past[c];
            state.p[c] = 0.0;
        }
    }

    /// Before the first step: which constraints touch which coordinates.
    fn see_structure<M: Model>(&mut self, model: &mut M, state: &State) {
        if self.structure_seen {
            return;
        }
        self.structure_seen = true;
        let mut probe = vec![f64::NAN; self.g0.len()];
        model.constraint_jacobian(&state.q, state.t, &mut probe);
        self.blocks.iter_mut().for_each(|block| block.see_structure(&probe));
        let blocks = &mut self.blocks;
        let is_used = |system: &&'static System| blocks[system.block].use_system(system);
        let systems: Vec<&'static System> = M::systems().iter().filter(is_used).collect();
        let others = model.layout().blocks.iter().enumerate();
        let others = others.filter(|(number, _)| systems.iter().all(|s| s.block != *number));
        let spans = spans(others.map(|(_, block)| block), &self.driven, &probe);
        self.pulls = Pulls::new(spans, systems);
        let costs = self.blocks.iter().map(BlockSystem::costs);
        let [make, serve] = costs.fold([0.0, 1.0], |[a, b], [x, y]| [a + x, b + y]);
        self.renewal = Renewal::new(make / serve);
    }

    fn guess(&mut self, number: usize, state: &State, around: &Surroundings) {
        for &c in &self.internal_list {
            let (last, v) = (state.last_increment(c), state.v[c]);
            self.past[c] = internal::past(state.step, last, v, around.h);
        }
        let rate = match number {
            0 if state.step >= 2 => {
                self.predictor.guess(state.step, &state.differences, &mut self.delta);
                None
            }
            0 | 1 => Some(around.h),
            2 => Some(0.0),
            _ => Some(0.5 * around.h),
        };
        if let Some(rate) = rate {
            self.delta.iter_mut().zip(&state.v).for_each(|(delta, v)| *delta = v * rate);
        }
        for &i in &self.driven_list {
            self.delta[i] = around.driven_q[i] - state.q[i];
        }
        if number <= 2 {
            self.lambda.copy_from_slice(&state.lambda);
        } else {
            self.lambda.fill(0.0);
        }
    }
}
