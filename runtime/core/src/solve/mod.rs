//! The linear system of one Newton iteration, block by block:
//!
//! [ J  −G₀ᵀ ] [ δ ]   [ −r ]
//! [ G₁   0  ] [ μ ] = [ −c ]
//!
//! for the corrections δ of the coordinates and μ of the multipliers. J falls into parts that only
//! constraints tie together (the five fingers on a ball); each part has its own LU, and the Schur
//! complement G₁J⁻¹G₀ᵀ ties them. Where a pivot is small the whole system is solved by the
//! rank-revealing method. Factors are kept: they serve for further right-hand sides, and in later
//! steps for systems that have changed little.
//!
//! Where rows are redundant the multipliers are to be of least norm. Corrections of least norm do not
//! add up to that; there r must be taken at λ = 0, and μ is λ itself ([`BlockSystem::is_regular`]).

mod part;
mod rows;

use crate::layout::Block;
use crate::linalg::{Lu, Pivots, solve_least_norm};
use part::Part;
pub(crate) use rows::{Span, spans};
use std::ops::Range;

/// A pivot below this ratio sends the solve to the rank-revealing method.
const SMALL_PIVOT: f64 = 1e-11;

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

/// One block's system, with the coordinates that are free in this run.
#[derive(Clone, Debug)]
pub(crate) struct BlockSystem {
    /// Free coordinates by index, part by part.
    pub(crate) coordinates: Vec<usize>,
    /// Which of them may be held by nothing: massless ones whose strands are slack stay where they are.
    may_rest: Vec<bool>,
    /// Constraint rows by index.
    pub(crate) rows: Vec<usize>,
    /// Where each free coordinate's matrix entries stand: positions local to the packed block.
    local: Vec<usize>,
    width: usize,
    matrix_offset: usize,
    constraint_offset: usize,
    parts: Vec<Part>,
    method: Method,
    /// Schur complement by rows, and its factors.
    schur: Vec<f64>,
    schur_lu: Lu,
    /// The whole system by rows, where that is solved.
    whole: Vec<f64>,
}

/// The system is singular: a coordinate that nothing determines.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Singular {
    /// Its index.
    pub(crate) coordinate: usize,
}

impl BlockSystem {
    /// Of a block; coordinates in `statics` may be held by nothing for a while.
    pub(crate) fn new(block: &Block, driven: &[bool], statics: &[usize]) -> Self {
        let m = block.rows.len();
        let (mut coordinates, mut local, mut parts) = (Vec::new(), Vec::new(), Vec::new());
        for part in block.part_ranges() {
            let first = local.len();
            local.extend(part.filter(|&position| !driven[block.coordinates[position]]));
            coordinates.extend(local[first..].iter().map(|&p: &usize| block.coordinates[p]));
            if local.len() > first {
                // Until the structure has been seen, every row counts.
                parts.push(Part::new(first..local.len(), (0..m).collect()));
            }
        }
        BlockSystem {
            may_rest: coordinates.iter().map(|c| statics.contains(c)).collect(),
            coordinates,
            rows: block.rows.clone(),
            local,
            width: block.coordinates.len(),
            matrix_offset: block.matrix_offset,
            constraint_offset: block.constraint_offset,
            parts,
            method: Method::Regular,
            schur: vec![0.0; m * m],
            schur_lu: Lu::new(m),
            whole: Vec::new(),
        }
    }

    /// Learns which rows touch which part, from a constraint Jacobian that was filled with what is not
    /// a number before it was written.
    pub(crate) fn see_structure(&mut self, jacobian: &[f64]) {
        let mut parts = std::mem::take(&mut self.parts);
        for part in &mut parts {
            let is_there =
                |&j: &usize, row: usize| !self.constraint_entry(jacobian, row, j).is_nan();
            let touches = |row: &usize| part.members.clone().any(|j| is_there(&j, *row));
            *part = Part::new(part.members.clone(), (0..self.rows.len()).filter(touches).collect());
        }
        self.parts = parts;
    }

    /// Entry (i, j) of the packed matrix, i and j counting free coordinates.
    #[inline]
    fn entry(&self, matrix: &[f64], i: usize, j: usize) -> f64 {
        matrix[self.matrix_offset + self.local[i] * self.width + self.local[j]]
    }

    /// Entry (row, j) of the packed constraint Jacobian, row local, j counting free coordinates.
    #[inline]
    fn constraint_entry(&self, jacobian: &[f64], row: usize, j: usize) -> f64 {
        jacobian[self.constraint_offset + row * self.width + self.local[j]]
    }

    /// Whether pivots are large, so that the solution may be built up by corrections.
    pub(crate) fn is_regular(&self) -> bool {
        self.method == Method::Regular
    }

    /// Operations that making the factors costs, evaluation of the matrix included, and those of one
    /// evaluation of the equations and a solve. Rough: they weigh one against the other.
    pub(crate) fn costs(&self) -> [f64; 2] {
        let m = self.rows.len() as f64;
        let (mut make, mut serve) = (m.powi(3) * 2.0 / 3.0, 2.0 * m * m);
        for part in &self.parts {
            let (n, rows) = (part.members.len() as f64, part.rows.len() as f64);
            let evaluate = 100.0 * n;
            make += evaluate + 20.0 * n * n + n.powi(3) * 2.0 / 3.0;
            make += rows * 2.0 * n * n + rows * rows * 2.0 * n + 20.0 * rows * n;
            serve += evaluate + 2.0 * n * n + 6.0 * n * rows;
        }
        [make, serve]
    }

    /// Hands over the sum of |Jᵢⱼ|·size(j) for every free coordinate i and that of |G₁|·size for
    /// every constraint row: what rounding of the coordinates does to the equations.
    pub(crate) fn sensitivities(
        &self,
        (matrix, g1): (&[f64], &[f64]),
        size: &[f64],
        mut coordinate: impl FnMut(usize, f64),
        mut row: impl FnMut(usize, f64),
    ) {
        let width = self.width;
        let sum = |start: usize, packed: &[f64], members: Range<usize>| -> f64 {
            let packed = &packed[start..start + width];
            members.map(|j| packed[self.local[j]].abs() * size[self.coordinates[j]]).sum()
        };
        for part in &self.parts {
            for i in part.members.clone() {
                let start = self.matrix_offset + self.local[i] * width;
                coordinate(self.coordinates[i], sum(start, matrix, part.members.clone()));
            }
        }
        for (k, &index) in self.rows.iter().enumerate() {
            let touched = self.parts.iter().filter(|part| part.rows.contains(&k));
            let start = self.constraint_offset + k * width;
            row(index, touched.map(|part| sum(start, g1, part.members.clone())).sum());
        }
    }

    /// Factors the system.
    pub(crate) fn factor(
        &mut self,
        matrix: &[f64],
        g0: &[f64],
        g1: &[f64],
    ) -> Result<Pivots, Singular> {
        let m = self.rows.len();
        self.method = Method::Regular;
        self.schur.fill(0.0);
        let mut parts = std::mem::take(&mut self.parts);
        let mut range = Pivots::NONE;
        for part in &mut parts {
            self.fill(part, matrix, g0, g1);
            range = range.and(part.factor());
            part.add_schur(|row, column, value| self.schur[row * m + column] += value);
        }
        self.parts = parts;
        if !(range.smallest > SMALL_PIVOT) {
            return self.keep_whole(matrix, g0, g1, range);
        }
        if m > 0 {
            for (i, row) in self.schur.chunks_exact(m).enumerate() {
                self.schur_lu.row_mut(i).copy_from_slice(row);
            }
            if !(self.schur_lu.factor().smallest > SMALL_PIVOT) {
                self.method = Method::RedundantRows;
            }
        }
        Ok(range)
    }

    /// Copies what concerns a part.
    fn fill(&self, part: &mut Part, matrix: &[f64], g0: &[f64], g1: &[f64]) {
        let (local, width) = (&self.local[part.members.clone()], self.width);
        let copy = |start: usize, packed: &[f64], to: &mut [f64]| {
            let packed = &packed[start..start + width];
            for (to, &j) in to.iter_mut().zip(local) {
                *to = packed[j];
            }
        };
        for (i, &row) in local.iter().enumerate() {
            copy(self.matrix_offset + row * width, matrix, part.lu.row_mut(i));
        }
        let size = local.len();
        for ((&row, to_g1), to_g0) in
            part.rows.iter().zip(part.g1.chunks_exact_mut(size)).zip(part.x.chunks_exact_mut(size))
        {
            copy(self.constraint_offset + row * width, g1, to_g1);
            copy(self.constraint_offset + row * width, g0, to_g0);
        }
    }

    /// Keeps the whole system for the rank-revealing method; finds out now whether a coordinate
    /// stays undetermined. Dependent multipliers are no error.
    fn keep_whole(
        &mut self,
        matrix: &[f64],
        g0: &[f64],
        g1: &[f64],
        range: Pivots,
    ) -> Result<Pivots, Singular> {
        let (n, m) = (self.coordinates.len(), self.rows.len());
        let size = n + m;
        self.whole.clear();
        self.whole.resize(size * size, 0.0);
        for part in &self.parts {
            for i in part.members.clone() {
                for k in part.members.clone() {
                    self.whole[i * size + k] = self.entry(matrix, i, k);
                }
                for &row in &part.rows {
                    self.whole[i * size + n + row] = -self.constraint_entry(g0, row, i);
                    self.whole[(n + row) * size + i] = self.constraint_entry(g1, row, i);
                }
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

    /// Solves with the factors; `step` holds r on entry and δ on return (free coordinates by parts),
    /// `lambda` holds c on entry and μ on return (local rows).
    pub(crate) fn solve(&mut self, step: &mut [f64], lambda: &mut [f64]) {
        let (n, m) = (self.coordinates.len(), self.rows.len());
        if self.method == Method::Whole {
            let rhs: Vec<f64> = step.iter().chain(lambda.iter()).map(|x| -x).collect();
            let solution = solve_least_norm(&self.whole, n + m, n + m, &rhs);
            step.copy_from_slice(&solution.x[..n]);
            lambda.copy_from_slice(&solution.x[n..]);
            return;
        }
        lambda.iter_mut().for_each(|gap| *gap = -*gap);
        for part in &mut self.parts {
            part.solve(step, lambda);
        }
        if m == 0 {
            return;
        }
        if self.method == Method::Regular {
            self.schur_lu.solve(lambda);
        } else {
            lambda.copy_from_slice(&solve_least_norm(&self.schur, m, m, lambda).x);
        }
        for part in &self.parts {
            part.pull(step, lambda);
        }
    }
}
