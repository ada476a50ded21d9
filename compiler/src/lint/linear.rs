//! The model linearised at a configuration: mass, stiffness, constraints.

use super::Context;
use handc_core::model::{Midpoint, Model};
use handc_runtime::analysis::rank::{Rank, rank};

/// Matrices over all coordinates, dense by rows.
pub(super) struct Linear {
    pub(super) n: usize,
    pub(super) mass: Vec<f64>,
    pub(super) stiffness: Vec<f64>,
    /// Constraint Jacobian, m × n; columns of driven coordinates are zero.
    pub(super) constraints: Vec<f64>,
    pub(super) free: Vec<bool>,
}

impl Linear {
    /// At q, with natural lengths and inputs given; `driven` coordinates do not move.
    pub(super) fn at(
        context: &mut Context,
        q: &[f64],
        rest: &[f64],
        inputs: &[f64],
        driven: &[bool],
    ) -> Linear {
        let layout = context.interpreter.layout().clone();
        let n = q.len();
        let model = &mut context.interpreter;
        let mut packed_mass = vec![0.0; layout.matrix_size()];
        let mut packed = packed_mass.clone();
        model.mass_matrix(q, &mut packed_mass);
        // With v = 0 the Newton matrix is −M/h − (h/4)K − ½C; a long step leaves the stiffness.
        let h = 1.0;
        let zero = vec![0.0; n];
        let (mut momentum, mut force) = (zero.clone(), zero.clone());
        let at = Midpoint { q, v: &zero, t: 0.0, rest, inputs };
        model.evaluate_with_matrix(&at, h, &mut momentum, &mut force, &mut packed);
        let mut packed_constraints = vec![0.0; layout.constraint_size()];
        if !layout.rows.is_empty() {
            model.constraint_jacobian(q, 0.0, &mut packed_constraints);
        }
        let m = layout.rows.len();
        let mut linear = Linear {
            n,
            mass: vec![0.0; n * n],
            stiffness: vec![0.0; n * n],
            constraints: vec![0.0; m * n],
            free: vec![false; n],
        };
        for block in &layout.blocks {
            let width = block.coordinates.len();
            for (i, &row) in block.coordinates.iter().enumerate() {
                linear.free[row] = !driven[row];
                for (k, &column) in block.coordinates.iter().enumerate() {
                    let slot = block.matrix_offset + i * width + k;
                    linear.mass[row * n + column] = packed_mass[slot];
                    linear.stiffness[row * n + column] =
                        -(packed[slot] + packed_mass[slot] / h) * 4.0 / h;
                }
            }
            for (i, &row) in block.rows.iter().enumerate() {
                for (k, &column) in block.coordinates.iter().enumerate() {
                    if !driven[column] {
                        linear.constraints[row * n + column] =
                            packed_constraints[block.constraint_offset + i * width + k];
                    }
                }
            }
        }
        linear
    }

    /// Rank of the constraints and the directions they leave free.
    pub(super) fn rank(&self) -> Rank {
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
