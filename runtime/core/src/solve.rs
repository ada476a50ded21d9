//! The linear system of one Newton iteration, block by block:
//!
//! [ J  −G₀ᵀ ] [ δ ]   [ −r ]
//! [ G₁   0  ] [ λ ] = [ −c ]
//!
//! solved for the increment δ of the coordinates and the whole of λ, with r taken at λ = 0. Solving
//! for λ itself rather than for its change makes the answer of least norm where rows are redundant.
//! The ordinary way is LU of J and of the Schur complement; where a pivot is small the whole system
//! is solved by the rank-revealing method.

use crate::linalg::{Pivots, lu_factor, lu_solve, solve_least_norm};

/// A pivot below this ratio sends the solve to the rank-revealing method.
const SMALL_PIVOT: f64 = 1e-11;

/// One block's system, with the coordinates that are free in this run.
#[derive(Clone, Debug)]
pub(crate) struct BlockSystem {
    /// Free coordinates by index.
    pub(crate) coordinates: Vec<usize>,
    /// Constraint rows by index.
    pub(crate) rows: Vec<usize>,
    /// Where each free coordinate's matrix entries stand: positions local to the packed block.
    local: Vec<usize>,
    width: usize,
    matrix_offset: usize,
    constraint_offset: usize,
    j: Vec<f64>,
    order: Vec<usize>,
    scratch: Vec<f64>,
    x: Vec<f64>,
    schur: Vec<f64>,
    schur_order: Vec<usize>,
    rhs: Vec<f64>,
}

/// The system is singular: the coordinates or rows that are left undetermined.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Singular {
    /// Index of a coordinate that nothing determines.
    pub(crate) coordinate: usize,
}

impl BlockSystem {
    pub(crate) fn new(block: &crate::layout::Block, driven: &[bool]) -> Self {
        let free = |&(_, c): &(usize, usize)| !driven[c];
        let pairs: Vec<_> = block.coordinates.iter().copied().enumerate().filter(free).collect();
        let (n, m) = (pairs.len(), block.rows.len());
        BlockSystem {
            coordinates: pairs.iter().map(|p| p.1).collect(),
            rows: block.rows.clone(),
            local: pairs.iter().map(|p| p.0).collect(),
            width: block.coordinates.len(),
            matrix_offset: block.matrix_offset,
            constraint_offset: block.constraint_offset,
            j: vec![0.0; n * n],
            order: vec![0; n.max(m)],
            scratch: vec![0.0; n.max(m)],
            x: vec![0.0; n * m],
            schur: vec![0.0; m * m],
            schur_order: vec![0; m],
            rhs: vec![0.0; m],
        }
    }

    /// Entry (i, j) of the packed matrix, i and j counting free coordinates.
    #[inline]
    pub(crate) fn entry(&self, matrix: &[f64], i: usize, j: usize) -> f64 {
        matrix[self.matrix_offset + self.local[i] * self.width + self.local[j]]
    }

    /// Entry (row, j) of the packed constraint Jacobian, row local, j counting free coordinates.
    #[inline]
    pub(crate) fn constraint_entry(&self, jacobian: &[f64], row: usize, j: usize) -> f64 {
        jacobian[self.constraint_offset + row * self.width + self.local[j]]
    }

    /// Solves; `step` holds r on entry and δ on return (free coordinates, local order), `lambda`
    /// holds c on entry and λ on return (local rows).
    pub(crate) fn solve(
        &mut self,
        matrix: &[f64],
        g0: &[f64],
        g1: &[f64],
        step: &mut [f64],
        lambda: &mut [f64],
    ) -> Result<Pivots, Singular> {
        let (n, m) = (self.coordinates.len(), self.rows.len());
        for i in 0..n {
            for k in 0..n {
                self.j[i * n + k] = self.entry(matrix, i, k);
            }
        }
        let pivots = lu_factor(&mut self.j, n, &mut self.order, &mut self.scratch);
        if n > 0 && !(pivots.smallest > SMALL_PIVOT) {
            return self.solve_whole(matrix, g0, g1, step, lambda, pivots);
        }
        lu_solve(&self.j, n, &self.order, step, &mut self.scratch);
        if m == 0 {
            step.iter_mut().for_each(|x| *x = -*x);
            return Ok(pivots);
        }
        // x: column r holds J⁻¹G₀ᵀ of constraint row r, stored one after another.
        for row in 0..m {
            for k in 0..n {
                self.x[row * n + k] = self.constraint_entry(g0, row, k);
            }
            let column = &mut self.x[row * n..(row + 1) * n];
            lu_solve(&self.j, n, &self.order, column, &mut self.scratch);
        }
        for row in 0..m {
            let mut sum = -lambda[row];
            for k in 0..n {
                sum += self.constraint_entry(g1, row, k) * step[k];
            }
            self.rhs[row] = sum;
            for column in 0..m {
                self.schur[row * m + column] = (0..n)
                    .map(|k| self.constraint_entry(g1, row, k) * self.x[column * n + k])
                    .sum();
            }
        }
        let kept = self.schur.clone();
        let schur = lu_factor(&mut self.schur, m, &mut self.schur_order, &mut self.scratch);
        if schur.smallest > SMALL_PIVOT {
            lu_solve(&self.schur, m, &self.schur_order, &mut self.rhs, &mut self.scratch);
            lambda.copy_from_slice(&self.rhs);
        } else {
            lambda.copy_from_slice(&solve_least_norm(&kept, m, m, &self.rhs).x);
        }
        for k in 0..n {
            let pull: f64 = (0..m).map(|row| self.x[row * n + k] * lambda[row]).sum();
            step[k] = pull - step[k];
        }
        Ok(pivots)
    }

    /// Where J alone is singular: the whole system, rank-revealing. A coordinate that stays
    /// undetermined is an error; dependent multipliers are not.
    fn solve_whole(
        &mut self,
        matrix: &[f64],
        g0: &[f64],
        g1: &[f64],
        step: &mut [f64],
        lambda: &mut [f64],
        pivots: Pivots,
    ) -> Result<Pivots, Singular> {
        let (n, m) = (self.coordinates.len(), self.rows.len());
        let size = n + m;
        let mut whole = vec![0.0; size * size];
        let mut rhs = vec![0.0; size];
        for i in 0..n {
            for k in 0..n {
                whole[i * size + k] = self.entry(matrix, i, k);
            }
            for row in 0..m {
                whole[i * size + n + row] = -self.constraint_entry(g0, row, i);
                whole[(n + row) * size + i] = self.constraint_entry(g1, row, i);
            }
            rhs[i] = -step[i];
        }
        for row in 0..m {
            rhs[n + row] = -lambda[row];
        }
        if whole.iter().chain(&rhs).any(|x| !x.is_finite()) {
            return Err(Singular { coordinate: self.coordinates[0] });
        }
        let solution = solve_least_norm(&whole, size, size, &rhs);
        // A dependent column among the multipliers is redundancy, unless it hides behind one of
        // the coordinates; ask each coordinate's column in turn to be independent.
        let free = solution.dependent.iter().find(|&&column| column < n);
        if let Some(&column) = free {
            return Err(Singular { coordinate: self.coordinates[column] });
        }
        step.copy_from_slice(&solution.x[..n]);
        lambda.copy_from_slice(&solution.x[n..]);
        Ok(Pivots { smallest: pivots.smallest.max(f64::EPSILON), largest: pivots.largest })
    }
}
