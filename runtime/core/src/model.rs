//! What a mechanical model must answer so that it can be simulated.
//!
//! The interpreter and every generated crate implement [`Model`]; the integrator, the scenarios,
//! the trajectories and the command line are written once against it. All vectors over coordinates
//! are indexed by the coordinate's position in the model, kinematic ones included, so that one
//! index means one thing everywhere. Matrices are packed by [`Block`](crate::layout::Block).

use crate::lanes::LaneVisitor;
use crate::layout::{Layout, ScenarioLayout};
use crate::system::System;
use std::sync::Arc;

/// Where a step's forces are evaluated: the midpoint rule's point.
#[derive(Clone, Copy, Debug)]
pub struct Midpoint<'a> {
    /// Coordinates (q0 + q1)/2 (rad or m), length n.
    pub q: &'a [f64],
    /// Rates (q1 − q0)/h, length n.
    pub v: &'a [f64],
    /// Time t0 + h/2 (s).
    pub t: f64,
    /// Natural length of every strand (m), length s.
    pub rest: &'a [f64],
    /// Value of every input, length u.
    pub inputs: &'a [f64],
}

/// The two vectors of which residual and next momentum are made.
#[derive(Clone, Copy, Debug)]
pub struct Derivatives<'a> {
    /// Momentum ∂L/∂q̇ per coordinate, length n; entries of kinematic coordinates are not read.
    pub momentum: &'a [f64],
    /// Force ∂L/∂q + F per coordinate, length n.
    pub force: &'a [f64],
}

/// The numbers at an instant that a recorded expression may read.
#[derive(Clone, Copy, Debug)]
pub struct Instant<'a> {
    /// Time (s).
    pub t: f64,
    /// Coordinates.
    pub q: &'a [f64],
    /// Rates of the step just ended; of internal coordinates those with which they balance.
    pub v: &'a [f64],
    /// Inputs of the step just ended.
    pub inputs: &'a [f64],
    /// Multipliers of the step just ended, length m.
    pub lambda: &'a [f64],
    /// Natural length of every strand at this time (m), length s.
    pub rest: &'a [f64],
    /// Step (s), by which a multiplier becomes a force.
    pub h: f64,
}

/// A model: a discrete Lagrangian, forces and constraints, and the functions of time that feed it.
///
/// n coordinates, s strands, u inputs, m constraint rows; see [`Layout`].
pub trait Model {
    /// Names, counts and blocks.
    fn layout(&self) -> &Arc<Layout>;
    /// Values of the parameters in declaration order.
    fn params(&self) -> &[f64];
    /// Sets a parameter by index.
    fn set_param(&mut self, index: usize, value: f64);

    /// Momentum and force at a midpoint, lengths n.
    fn evaluate(&mut self, at: &Midpoint, momentum: &mut [f64], force: &mut [f64]);

    /// As [`Model::evaluate`], and the Newton matrix
    /// −M/h + ½(L_qv − L_vq) + (h/4)(L_qq + F_q) + ½F_v, packed by block: entry (i, j) of block b at
    /// `b.matrix_offset + i * b.coordinates.len() + j` with i, j local to the block.
    /// Entries that are zero by structure are not written; the caller clears the matrix once.
    fn evaluate_with_matrix(
        &mut self,
        at: &Midpoint,
        h: f64,
        momentum: &mut [f64],
        force: &mut [f64],
        matrix: &mut [f64],
    );

    /// Values of all constraint rows at q, length m. Rows may depend on time, and on the lengths that
    /// `rest` prescribes for strands (m), length s.
    fn constraints(&mut self, q: &[f64], t: f64, rest: &[f64], values: &mut [f64]);

    /// Constraint Jacobian ∂h/∂q, packed by block: row i, column j of block b at
    /// `b.constraint_offset + i * b.coordinates.len() + j`. Structural zeros are not written.
    fn constraint_jacobian(&mut self, q: &[f64], t: f64, jacobian: &mut [f64]);

    /// Mass matrix at q, packed like the Newton matrix.
    fn mass_matrix(&mut self, q: &[f64], matrix: &mut [f64]);

    /// Potential energy (J) at q with the given natural lengths.
    fn potential(&mut self, q: &[f64], rest: &[f64]) -> f64;

    /// Lengths of all strands (m), length s.
    fn strand_lengths(&mut self, q: &[f64], lengths: &mut [f64]);

    /// Commanded tensions at a midpoint (N), length s; those of strands with another law are not
    /// written.
    fn commands(&mut self, _at: &Midpoint, _tensions: &mut [f64]) {}

    /// How far each surface is from being impassable, [`CLEARANCES`](crate::passage::CLEARANCES)
    /// numbers each: how far the point before it and the point behind it are outside (m); on a sphere
    /// that the strand touches, how far its centre is from the line between them, less 10⁻⁹ of the
    /// radius (m); and a number without a unit that is negative where the points have come so far
    /// round that the strand would jump to the other side. Where one is negative or not a number, the
    /// strand's length or its derivative is not a number. Not called for a model whose strands wrap
    /// nothing.
    fn clearances(&mut self, _q: &[f64], _clearances: &mut [f64]) {}

    /// Default inputs at time t, length u.
    fn inputs(&mut self, t: f64, inputs: &mut [f64]);

    /// Natural lengths that the model gives (m), length s; those of strands whose rest is left out
    /// are not written.
    fn rests(&mut self, t: f64, inputs: &[f64], rest: &mut [f64]);

    /// Values at time t of the coordinates that the model itself drives; others are not written.
    fn drives(&mut self, t: f64, q: &mut [f64]);

    /// Start and initial rate of every coordinate, lengths n (`start`, `velocity` of the joints).
    fn start(&mut self, q: &mut [f64], v: &mut [f64]);

    /// The scenario's numbers that may depend on parameters, after its `set`s are applied.
    fn scenario(&mut self, scenario: usize) -> ScenarioValues;

    /// Writes the scenario's own inputs at time t.
    fn scenario_inputs(&mut self, scenario: usize, t: f64, inputs: &mut [f64]);

    /// Writes the coordinates that the scenario drives at time t.
    fn scenario_drives(&mut self, scenario: usize, t: f64, q: &mut [f64]);

    /// Writes the lengths that the scenario prescribes for strands at time t (m).
    fn scenario_rests(&mut self, _scenario: usize, _t: f64, _rest: &mut [f64]) {}

    /// Values of the scenario's records, in order.
    fn scenario_records(&mut self, scenario: usize, at: &Instant, values: &mut [f64]);

    /// The numbers that the layout's requirements are about, in their order.
    fn required_numbers(&mut self, _numbers: &mut [f64]) {}

    /// Straight-line code for the linear systems of constrained blocks, in order of the blocks, as far
    /// as there is such code.
    fn systems() -> &'static [System]
    where
        Self: Sized,
    {
        &[]
    }

    /// A stamp of the parameters: no two sets of them, in this model or another of its kind, bear
    /// the same.
    fn revision(&self) -> u64 {
        0
    }

    /// Shows all blocks to a visitor that works on the lanes of vectors, for several runs with their
    /// own parameters at once. `false`, and nothing done, for a model that is not written for lanes
    /// or a processor that has none.
    fn on_lanes(_models: &[&Self], _visitor: &mut impl LaneVisitor) -> bool
    where
        Self: Sized,
    {
        false
    }

    /// The names and shape of a scenario.
    fn scenario_layout(&self, scenario: usize) -> &ScenarioLayout {
        &self.layout().scenarios[scenario]
    }
}

/// Numbers of a scenario, evaluated with the current parameters.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScenarioValues {
    /// Parameters that the scenario sets: index, value.
    pub set: Vec<(usize, f64)>,
    /// Step (s), if given.
    pub step: Option<f64>,
    /// Duration (s), if given.
    pub duration: Option<f64>,
    /// Relative tolerance, if given.
    pub tolerance: Option<f64>,
    /// Overridden starts: coordinate, value.
    pub start: Vec<(usize, f64)>,
    /// Overridden initial rates: coordinate, value.
    pub velocity: Vec<(usize, f64)>,
    /// Poses: the values that differ from the start, per pose.
    pub poses: Vec<Vec<(usize, f64)>>,
    /// Motions: pose index and time (s) of each knot, per motion.
    pub motions: Vec<Vec<(usize, f64)>>,
}
