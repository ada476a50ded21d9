//! The linear system of one Newton iteration, block by block:
//!
//! [ J  −G₀ᵀ ] [ δ ]   [ −r ]
//! [ G₁   0  ] [ λ ] = [ −c ]
//!
//! solved for the increment δ of the coordinates and the whole of λ, with r taken at λ = 0. Solving
//! for λ itself rather than for its change makes the answer of least norm where rows are redundant.
//! J falls into parts that only constraints tie together (the five fingers on a ball); each part has
//! its own LU, and the Schur complement G₁J⁻¹G₀ᵀ ties them. Where a pivot is small the whole system
//! is solved by the rank-revealing method. Factors are kept, so that a second right-hand side costs
//! a substitution.

use crate::linalg::{Pivots, lu_factor, lu_solve, solve_least_norm};

/// A pivot below this ratio sends the solve to the rank-revealing method.
const SMALL_PIVOT: f64 = 1e-11;

/// A part of a block, with its LU factors.
#[derive(Clone, Debug)]
struct Part {
    /// Which of the block's free coordinates.
    members: Vec<usize>,
    /// Rows that touch it, local to the block.
    rows: Vec<usize>,
    lu: Vec<f64>,
    order: Vec<usize>,
    /// J⁻¹G₀ᵀ, one column after another, for the rows that touch it.
    x: Vec<f64>,
}

/// How the factors are to be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Method {
    /// LU of the parts, and of the Schur complement if there are rows.
    Regular,
    /// LU of the parts, rank-revealing Schur complement.
    RedundantRows,
    /// Rank-revealing solve of everything.
    Whole,
}

/// An entry of the constraint Jacobian that is not zero by structure.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    /// Free coordinate, counted in the block.
    pub(crate) column: usize,
    /// Where it stands in the packed Jacobian.
    pub(crate) slot: usize,
}

/// One block's system, with the coordinates that are free in this run.
#[derive(Clone, Debug)]
pub(crate) struct BlockSystem {
    /// Free coordinates by index.
    pub(crate) coordinates: Vec<usize>,
    /// Which of them may be held by nothing: massless ones whose strands are slack stay where they are.
    may_rest: Vec<bool>,
    /// Constraint rows by index.
    pub(crate) rows: Vec<usize>,
    /// Where each free coordinate's matrix entries stand: positions local to the packed block.
    local: Vec<usize>,
    width: usize,
    /// Entries of each row of the constraint Jacobian.
    entries: Vec<Vec<Entry>>,
    /// Free coordinates that the Newton matrix couples to each, itself among them, and where the
    /// entries stand in the packed matrix.
    neighbours: Vec<Vec<Entry>>,
    matrix_offset: usize,
    constraint_offset: usize,
    parts: Vec<Part>,
    method: Method,
    /// Schur complement, its LU and the row order.
    schur: Vec<f64>,
    schur_lu: Vec<f64>,
    schur_order: Vec<usize>,
    /// G₁ by rows over the free coordinates.
    g1: Vec<f64>,
    whole: Vec<f64>,
    scratch: Vec<f64>,
    gather: Vec<f64>,
    rhs: Vec<f64>,
}

/// The system is singular: a coordinate that nothing determines.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Singular {
    /// Its index.
    pub(crate) coordinate: usize,
}

impl BlockSystem {
    /// Of a block; coordinates in `statics` may be held by nothing for a while.
    pub(crate) fn new(block: &crate::layout::Block, driven: &[bool], statics: &[usize]) -> Self {
        let mut free_of_local = vec![None; block.coordinates.len()];
        let (mut coordinates, mut local) = (Vec::new(), Vec::new());
        for (position, &c) in block.coordinates.iter().enumerate().filter(|(_, c)| !driven[**c]) {
            free_of_local[position] = Some(coordinates.len());
            coordinates.push(c);
            local.push(position);
        }
        let (n, m) = (coordinates.len(), block.rows.len());
        let members: Vec<Vec<usize>> = block
            .parts
            .iter()
            .map(|part| part.iter().filter_map(|&p| free_of_local[p]).collect::<Vec<_>>())
            .filter(|members| !members.is_empty())
            .collect();
        let width = block.coordinates.len();
        let mut neighbours = vec![Vec::new(); n];
        for part in &members {
            for &i in part {
                let slot = |k: usize| block.matrix_offset + local[i] * width + local[k];
                neighbours[i] = part.iter().map(|&k| Entry { column: k, slot: slot(k) }).collect();
            }
        }
        // Until the structure has been seen, every entry counts.
        let entries = (0..m)
            .map(|row| {
                let slot = |k: usize| block.constraint_offset + row * width + local[k];
                (0..n).map(|k| Entry { column: k, slot: slot(k) }).collect()
            })
            .collect();
        let parts = members
            .into_iter()
            .map(|members| {
                let size = members.len();
                Part {
                    members,
                    rows: (0..m).collect(),
                    lu: vec![0.0; size * size],
                    order: vec![0; size],
                    x: vec![0.0; size * m],
                }
            })
            .collect();
        BlockSystem {
            may_rest: coordinates.iter().map(|c| statics.contains(c)).collect(),
            coordinates,
            rows: block.rows.clone(),
            local,
            width,
            entries,
            neighbours,
            matrix_offset: block.matrix_offset,
            constraint_offset: block.constraint_offset,
            parts,
            method: Method::Regular,
            schur: vec![0.0; m * m],
            schur_lu: vec![0.0; m * m],
            schur_order: vec![0; m],
            g1: vec![0.0; n * m],
            whole: Vec::new(),
            scratch: vec![0.0; n.max(m)],
            gather: vec![0.0; n],
            rhs: vec![0.0; m],
        }
    }

    /// Entry (i, j) of the packed matrix, i and j counting free coordinates.
    #[inline]
    pub(crate) fn entry(&self, matrix: &[f64], i: usize, j: usize) -> f64 {
        matrix[self.matrix_offset + self.local[i] * self.width + self.local[j]]
    }

    /// Entries of row i of the Newton matrix that are not zero by structure.
    #[inline]
    pub(crate) fn neighbours(&self, i: usize) -> &[Entry] {
        &self.neighbours[i]
    }

    /// Entries of a constraint row that are not zero by structure.
    #[inline]
    pub(crate) fn entries(&self, row: usize) -> &[Entry] {
        &self.entries[row]
    }

    /// Learns which entries of the constraint Jacobian are zero by structure, from one that was
    /// filled with what is not a number before it was written.
    pub(crate) fn see_structure(&mut self, jacobian: &[f64]) {
        for entries in &mut self.entries {
            entries.retain(|entry| !jacobian[entry.slot].is_nan());
        }
        for part in &mut self.parts {
            let touches = |row: &usize| {
                self.entries[*row].iter().any(|entry| part.members.contains(&entry.column))
            };
            part.rows = (0..self.rows.len()).filter(touches).collect();
        }
    }

    /// Adds Gᵀλ to `forces`, which counts free coordinates; λ by the model's rows.
    pub(crate) fn add_constraint_forces(
        &self,
        jacobian: &[f64],
        lambda: &[f64],
        mut add: impl FnMut(usize, f64),
    ) {
        for (entries, &row) in self.entries.iter().zip(&self.rows) {
            let lambda = lambda[row];
            for entry in entries {
                add(entry.column, jacobian[entry.slot] * lambda);
            }
        }
    }

    /// Entry (row, j) of the packed constraint Jacobian, row local, j counting free coordinates.
    #[inline]
    pub(crate) fn constraint_entry(&self, jacobian: &[f64], row: usize, j: usize) -> f64 {
        jacobian[self.constraint_offset + row * self.width + self.local[j]]
    }

    /// Factors the system.
    pub(crate) fn factor(
        &mut self,
        matrix: &[f64],
        g0: &[f64],
        g1: &[f64],
    ) -> Result<Pivots, Singular> {
        let (n, m) = (self.coordinates.len(), self.rows.len());
        for (row, entries) in self.entries.iter().enumerate() {
            for entry in entries {
                self.g1[row * n + entry.column] = g1[entry.slot];
            }
        }
        self.schur.fill(0.0);
        self.method = Method::Regular;
        let mut range = Pivots { smallest: f64::INFINITY, largest: 0.0 };
        let mut parts = std::mem::take(&mut self.parts);
        for part in &mut parts {
            let pivots = self.factor_part(part, matrix, g0);
            range.smallest = range.smallest.min(pivots.smallest);
            range.largest = range.largest.max(pivots.largest);
        }
        self.parts = parts;
        if n > 0 && !(range.smallest > SMALL_PIVOT) {
            return self.keep_whole(matrix, g0, range);
        }
        if m > 0 {
            self.schur_lu.copy_from_slice(&self.schur);
            let schur = lu_factor(&mut self.schur_lu, m, &mut self.schur_order, &mut self.scratch);
            if !(schur.smallest > SMALL_PIVOT) {
                self.method = Method::RedundantRows;
            }
        }
        Ok(range)
    }

    fn factor_part(&mut self, part: &mut Part, matrix: &[f64], g0: &[f64]) -> Pivots {
        let (n, m, size) = (self.coordinates.len(), self.rows.len(), part.members.len());
        for (i, &a) in part.members.iter().enumerate() {
            for (k, &b) in part.members.iter().enumerate() {
                part.lu[i * size + k] = self.entry(matrix, a, b);
            }
        }
        let pivots = lu_factor(&mut part.lu, size, &mut part.order, &mut self.scratch);
        if !(pivots.smallest > SMALL_PIVOT) {
            return pivots;
        }
        for (column, &row) in part.x.chunks_exact_mut(size).zip(&part.rows) {
            for (x, &member) in column.iter_mut().zip(&part.members) {
                *x = self.constraint_entry(g0, row, member);
            }
            lu_solve(&part.lu, size, &part.order, column, &mut self.scratch);
        }
        for &row in &part.rows {
            let g1 = &self.g1[row * n..(row + 1) * n];
            for (column, &other) in part.x.chunks_exact(size).zip(&part.rows) {
                let sum: f64 = part.members.iter().zip(column).map(|(&k, x)| g1[k] * x).sum();
                self.schur[row * m + other] += sum;
            }
        }
        pivots
    }

    /// Keeps the whole system for the rank-revealing method; finds out now whether a coordinate
    /// stays undetermined. Dependent multipliers are no error.
    fn keep_whole(
        &mut self,
        matrix: &[f64],
        g0: &[f64],
        range: Pivots,
    ) -> Result<Pivots, Singular> {
        let (n, m) = (self.coordinates.len(), self.rows.len());
        let size = n + m;
        self.whole.clear();
        self.whole.resize(size * size, 0.0);
        for i in 0..n {
            for k in 0..n {
                self.whole[i * size + k] = self.entry(matrix, i, k);
            }
            for row in 0..m {
                self.whole[i * size + n + row] = -self.constraint_entry(g0, row, i);
                self.whole[(n + row) * size + i] = self.g1[row * n + i];
            }
        }
        if self.whole.iter().any(|x| !x.is_finite()) {
            return Err(Singular { coordinate: self.coordinates[0] });
        }
        let trial = solve_least_norm(&self.whole, size, size, &vec![0.0; size]);
        let is_free = |&&column: &&usize| column < n && !self.may_rest[column];
        if let Some(&column) = trial.dependent.iter().find(is_free) {
            return Err(Singular { coordinate: self.coordinates[column] });
        }
        self.method = Method::Whole;
        Ok(Pivots { smallest: range.smallest.max(f64::EPSILON), largest: range.largest })
    }

    /// Solves with the factors; `step` holds r at λ = 0 on entry and δ on return (free coordinates,
    /// local order), `lambda` holds c on entry and λ on return (local rows).
    pub(crate) fn solve(&mut self, step: &mut [f64], lambda: &mut [f64]) {
        let (n, m) = (self.coordinates.len(), self.rows.len());
        if self.method == Method::Whole {
            let rhs: Vec<f64> = step.iter().chain(lambda.iter()).map(|x| -x).collect();
            let solution = solve_least_norm(&self.whole, n + m, n + m, &rhs);
            step.copy_from_slice(&solution.x[..n]);
            lambda.copy_from_slice(&solution.x[n..]);
            return;
        }
        for part in &self.parts {
            let size = part.members.len();
            let gather = &mut self.gather[..size];
            for (x, &member) in gather.iter_mut().zip(&part.members) {
                *x = step[member];
            }
            lu_solve(&part.lu, size, &part.order, gather, &mut self.scratch);
            for (x, &member) in gather.iter().zip(&part.members) {
                step[member] = -x;
            }
        }
        if m == 0 {
            return;
        }
        for (row, entries) in self.entries.iter().enumerate() {
            let g1 = &self.g1[row * n..(row + 1) * n];
            let reached: f64 = entries.iter().map(|e| g1[e.column] * step[e.column]).sum();
            self.rhs[row] = -lambda[row] - reached;
        }
        if self.method == Method::Regular {
            lu_solve(&self.schur_lu, m, &self.schur_order, &mut self.rhs, &mut self.scratch);
            lambda.copy_from_slice(&self.rhs);
        } else {
            lambda.copy_from_slice(&solve_least_norm(&self.schur, m, m, &self.rhs).x);
        }
        for part in &self.parts {
            let size = part.members.len();
            for (column, &row) in part.x.chunks_exact(size).zip(&part.rows) {
                for (x, &member) in column.iter().zip(&part.members) {
                    step[member] += x * lambda[row];
                }
            }
        }
    }
}
