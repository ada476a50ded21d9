//! The model linearised at a configuration at rest: force, mass, stiffness, constraints.

use super::rank::{Rank, rank};
use handc_core::model::{Midpoint, Model};

/// The step for which stiffness is all of the Newton matrix −M/h + ½F_v + (h/4)(L_qq + F_q) that
/// rounding leaves; a power of two, by which nothing is rounded.
const LONG_STEP: f64 = (1u64 << 50) as f64;

/// What stays as it is while the configuration varies.
#[derive(Clone, Copy, Debug)]
pub struct Held<'a> {
    /// Time (s), for what is given as a function of it.
    pub t: f64,
    /// Natural length of every strand (m), length s.
    pub rest: &'a [f64],
    /// Value of every input, length u.
    pub inputs: &'a [f64],
    /// Coordinates whose value is given, length n.
    pub driven: &'a [bool],
}

/// Vectors and matrices over all coordinates, dense by rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Linear {
    /// Coordinates.
    pub n: usize,
    /// Generalised force f at rest (N·m or N), length n: all but that of the constraints.
    pub force: Vec<f64>,
    /// Mass matrix, n × n.
    pub mass: Vec<f64>,
    /// Stiffness −∂f/∂q at rest, n × n.
    pub stiffness: Vec<f64>,
    /// Constraint Jacobian, m × n; columns of driven coordinates are zero.
    pub constraints: Vec<f64>,
    /// Coordinates that move.
    pub free: Vec<bool>,
}

impl Linear {
    /// Linearises at q.
    pub fn at<M: Model>(model: &mut M, q: &[f64], held: &Held) -> Linear {
        let layout = model.layout().clone();
        let (n, m) = (q.len(), layout.rows.len());
        let mut packed_mass = vec![0.0; layout.matrix_size()];
        let mut packed = packed_mass.clone();
        model.mass_matrix(q, &mut packed_mass);
        let zero = vec![0.0; n];
        let (mut momentum, mut force) = (zero.clone(), zero.clone());
        let at = Midpoint { q, v: &zero, t: held.t, rest: held.rest, inputs: held.inputs };
        model.evaluate_with_matrix(&at, LONG_STEP, &mut momentum, &mut force, &mut packed);
        let mut packed_constraints = vec![0.0; layout.constraint_size()];
        if m > 0 {
            model.constraint_jacobian(q, held.t, &mut packed_constraints);
        }
        let mut linear = Linear {
            n,
            force,
            mass: vec![0.0; n * n],
            stiffness: vec![0.0; n * n],
            constraints: vec![0.0; m * n],
            free: vec![false; n],
        };
        for block in &layout.blocks {
            let width = block.coordinates.len();
            for (i, &row) in block.coordinates.iter().enumerate() {
                linear.free[row] = !held.driven[row];
                for (k, &column) in block.coordinates.iter().enumerate() {
                    let slot = block.matrix_offset + i * width + k;
                    linear.mass[row * n + column] = packed_mass[slot];
                    // No more than the mass leaves is no stiffness.
                    let stiffness = -packed[slot] * (4.0 / LONG_STEP);
                    let left = packed_mass[slot].abs() * (8.0 / LONG_STEP / LONG_STEP);
                    linear.stiffness[row * n + column] =
                        if stiffness.abs() > left { stiffness } else { 0.0 };
                }
            }
            for (i, &row) in block.rows.iter().enumerate() {
                for (k, &column) in block.coordinates.iter().enumerate() {
                    if !held.driven[column] {
                        linear.constraints[row * n + column] =
                            packed_constraints[block.constraint_offset + i * width + k];
                    }
                }
            }
        }
        linear
    }

    /// Rank of the constraints and the directions they leave free.
    pub fn rank(&self) -> Rank {
        let m = self.constraints.len() / self.n.max(1);
        let mut found = rank(&self.constraints, m, self.n);
        // Driven coordinates are not directions.
        let held: Vec<usize> = (0..self.n).filter(|&i| !self.free[i]).collect();
        if !held.is_empty() {
            let rows = m + held.len();
            let mut all = self.constraints.clone();
            all.resize(rows * self.n, 0.0);
            for (k, &i) in held.iter().enumerate() {
                all[(m + k) * self.n + i] = 1.0;
            }
            found.null_space = rank(&all, rows, self.n).null_space;
        }
        found
    }
}
