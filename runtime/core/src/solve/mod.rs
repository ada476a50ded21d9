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

use crate::lane::{Lane, Work, call};
use crate::layout::Block;
use crate::linalg::{Lu, Pivots, solve_least_norm};
use crate::system::System;
use part::Part;
pub(crate) use rows::{Pulls, spans};

/// A pivot below this ratio sends the solve to the rank-revealing method.
const SMALL_PIVOT: f64 = 1e-11;

/// How much a pivot may shrink where rows cannot be exchanged.
const LARGEST_SHRINKAGE: f64 = 1e7;

/// How the factors are to be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Method {
    /// As compiled.
    Compiled,
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
    /// Pivots of the parts.
    range: Pivots,
    /// Compiled code for the block, and its factors.
    system: Option<&'static System>,
    factors: Vec<f64>,
    /// Room for a solution.
    step: Vec<f64>,
    multipliers: Vec<f64>,
}

/// What a correction is found from, by the indices of the model.
pub(crate) struct Residuals<'a> {
    /// r.
    pub(crate) residual: &'a [f64],
    /// c.
    pub(crate) gaps: &'a [f64],
    /// G₀ᵀλ.
    pub(crate) pull: &'a [f64],
    /// λ.
    pub(crate) lambda: &'a [f64],
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
            range: Pivots::NONE,
            system: None,
            factors: Vec::new(),
            step: vec![0.0; coordinates.len()],
            multipliers: vec![0.0; m],
            coordinates,
        }
    }

    /// Uses compiled code from now on, unless a coordinate of the block is driven in this run. Returns
    /// whether it does.
    pub(crate) fn use_system(&mut self, system: &'static System) -> bool {
        let is_free = self.coordinates.len() == self.width;
        if is_free {
            self.system = Some(system);
            self.factors = vec![0.0; system.factors];
        }
        is_free
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
        matches!(self.method, Method::Compiled | Method::Regular)
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

    /// Puts the sum of |Jᵢⱼ|·size(j) for every free coordinate i and that of |G₁|·size for every
    /// constraint row: what rounding of the coordinates does to the equations.
    pub(crate) fn sensitivities(
        &self,
        (matrix, g1): (&[f64], &[f64]),
        size: &[f64],
        to: &mut [f64],
        to_rows: &mut [f64],
    ) {
        if let Some(system) = self.system {
            return (system.sensitivities)(matrix, g1, size, to, to_rows);
        }
        let sum = |start: usize, packed: &[f64], part: &Part| -> f64 {
            let packed = &packed[start..start + self.width];
            let members = part.members.clone().map(|j| (self.local[j], self.coordinates[j]));
            members.map(|(local, c)| packed[local].abs() * size[c]).sum()
        };
        self.rows.iter().for_each(|&row| to_rows[row] = 0.0);
        for part in &self.parts {
            for i in part.members.clone() {
                let start = self.matrix_offset + self.local[i] * self.width;
                to[self.coordinates[i]] = sum(start, matrix, part);
            }
            for &k in &part.rows {
                let start = self.constraint_offset + k * self.width;
                to_rows[self.rows[k]] += sum(start, g1, part);
            }
        }
    }

    /// Factors the system.
    pub(crate) fn factor(
        &mut self,
        matrix: &[f64],
        g0: &[f64],
        g1: &[f64],
    ) -> Result<Pivots, Singular> {
        if let Some(system) = self.system {
            let shrinkage = (system.factor)(matrix, g0, g1, &mut self.factors);
            if shrinkage <= LARGEST_SHRINKAGE {
                self.method = Method::Compiled;
                return Ok(Pivots { smallest: 1.0 / shrinkage, largest: 1.0 });
            }
        }
        self.method = Method::Regular;
        self.take(matrix, g0, g1);
        if !call(4, Factor(self)) {
            Factor(self).run::<f64>();
        }
        if !(self.range.smallest > SMALL_PIVOT) {
            return self.keep_whole(matrix, g0, g1);
        }
        Ok(self.range)
    }

    /// Copies the matrices to where they are factored.
    fn take(&mut self, matrix: &[f64], g0: &[f64], g1: &[f64]) {
        let width = self.width;
        for part in &mut self.parts {
            let local = &self.local[part.members.clone()];
            for (i, &row) in local.iter().enumerate() {
                let packed = &matrix[self.matrix_offset + row * width..][..width];
                for (to, &j) in part.lu.row_mut(i).iter_mut().zip(local) {
                    *to = packed[j];
                }
            }
            for (k, &row) in part.rows.iter().enumerate() {
                let start = self.constraint_offset + row * width;
                let (g0, g1) = (&g0[start..start + width], &g1[start..start + width]);
                for (i, &j) in local.iter().enumerate() {
                    part.x[i * part.stride + k] = g0[j];
                    part.g1[i * part.stride + k] = g1[j];
                }
            }
        }
    }

    /// Keeps the whole system for the rank-revealing method; finds out now whether a coordinate
    /// stays undetermined. Dependent multipliers are no error.
    fn keep_whole(&mut self, matrix: &[f64], g0: &[f64], g1: &[f64]) -> Result<Pivots, Singular> {
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
        let Pivots { smallest, largest } = self.range;
        Ok(Pivots { smallest: smallest.max(f64::EPSILON), largest })
    }

    /// Solves with the factors for δ and μ of the block, from r and c; `pull` is G₀ᵀλ, which is a part
    /// of r. All by the indices of the model. Returns the multipliers' change even where they are found
    /// as a whole.
    pub(crate) fn correct(&mut self, of: &Residuals, step: &mut [f64], change: &mut [f64]) {
        if let (Some(system), Method::Compiled) = (self.system, self.method) {
            return (system.solve)(&self.factors, of.residual, of.gaps, step, change);
        }
        let mut own = std::mem::take(&mut self.step);
        let mut multipliers = std::mem::take(&mut self.multipliers);
        for (r, &c) in own.iter_mut().zip(&self.coordinates) {
            *r = of.residual[c];
        }
        for (gap, &row) in multipliers.iter_mut().zip(&self.rows) {
            *gap = of.gaps[row];
        }
        let is_regular = self.is_regular();
        if !is_regular {
            // The residual at λ = 0: the solve then gives the whole multiplier.
            for (r, &c) in own.iter_mut().zip(&self.coordinates) {
                *r += of.pull[c];
            }
        }
        self.solve(&mut own, &mut multipliers);
        for (x, &c) in own.iter().zip(&self.coordinates) {
            step[c] = *x;
        }
        for (x, &row) in multipliers.iter().zip(&self.rows) {
            change[row] = if is_regular { *x } else { x - of.lambda[row] };
        }
        (self.step, self.multipliers) = (own, multipliers);
    }

    /// Solves with the factors; `step` holds r on entry and δ on return (free coordinates by parts),
    /// `lambda` holds c on entry and μ on return (local rows).
    fn solve(&mut self, step: &mut [f64], lambda: &mut [f64]) {
        let (n, m) = (self.coordinates.len(), self.rows.len());
        if self.method == Method::Whole {
            let rhs: Vec<f64> = step.iter().chain(lambda.iter()).map(|x| -x).collect();
            let solution = solve_least_norm(&self.whole, n + m, n + m, &rhs);
            step.copy_from_slice(&solution.x[..n]);
            lambda.copy_from_slice(&solution.x[n..]);
            return;
        }
        if self.method == Method::Regular {
            if !call(4, Solve(self, &mut *step, &mut *lambda)) {
                Solve(self, step, lambda).run::<f64>();
            }
            return;
        }
        self.reach::<f64>(step, lambda);
        lambda.copy_from_slice(&solve_least_norm(&self.schur, m, m, lambda).x);
        self.parts.iter_mut().for_each(|part| part.pull::<f64>(step, lambda));
    }

    /// Replaces r by −J⁻¹r and c by what is then left of the gaps, with the other sign.
    #[inline(always)]
    fn reach<L: Lane>(&mut self, step: &mut [f64], lambda: &mut [f64]) {
        lambda.iter_mut().for_each(|gap| *gap = -*gap);
        self.parts.iter_mut().for_each(|part| part.solve::<L>(step, lambda));
    }
}

struct Factor<'a>(&'a mut BlockSystem);

impl Work for Factor<'_> {
    #[inline(always)]
    fn run<L: Lane>(self) {
        let Factor(system) = self;
        let m = system.rows.len();
        for i in 0..m {
            system.schur_lu.row_mut(i).fill(0.0);
        }
        system.range = Pivots::NONE;
        for part in &mut system.parts {
            system.range = system.range.and(part.factor::<L>(&mut system.schur_lu));
        }
        if m == 0 || !(system.range.smallest > SMALL_PIVOT) {
            return;
        }
        for (i, row) in system.schur.chunks_exact_mut(m).enumerate() {
            row.copy_from_slice(system.schur_lu.row(i));
        }
        if !(system.schur_lu.factor_on::<L>().smallest > SMALL_PIVOT) {
            system.method = Method::RedundantRows;
        }
    }
}

struct Solve<'a>(&'a mut BlockSystem, &'a mut [f64], &'a mut [f64]);

impl Work for Solve<'_> {
    #[inline(always)]
    fn run<L: Lane>(self) {
        let Solve(system, step, lambda) = self;
        system.reach::<L>(step, lambda);
        if !lambda.is_empty() {
            system.schur_lu.solve_on::<L>(lambda);
            system.parts.iter_mut().for_each(|part| part.pull::<L>(step, lambda));
        }
    }
}
