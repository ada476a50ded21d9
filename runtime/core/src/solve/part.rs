//! A part of a block: coordinates that the Newton matrix couples without the help of constraints.

use crate::linalg::{Lu, Pivots};
use std::ops::Range;

/// Its factors, and what ties it to the rows that touch it.
#[derive(Clone, Debug)]
pub(super) struct Part {
    /// Which of the block's free coordinates.
    pub(super) members: Range<usize>,
    /// Rows that touch it, local to the block.
    pub(super) rows: Vec<usize>,
    /// Of J.
    pub(super) lu: Lu,
    /// Its columns of G₁, row after row.
    pub(super) g1: Vec<f64>,
    /// J⁻¹G₀ᵀ, column after column, before it is solved G₀.
    pub(super) x: Vec<f64>,
}

impl Part {
    pub(super) fn new(members: Range<usize>, rows: Vec<usize>) -> Self {
        let size = members.len();
        Part {
            lu: Lu::new(size),
            g1: vec![0.0; size * rows.len()],
            x: vec![0.0; size * rows.len()],
            members,
            rows,
        }
    }

    /// Factors J and solves for its constraint columns.
    pub(super) fn factor(&mut self) -> Pivots {
        let pivots = self.lu.factor();
        for column in self.x.chunks_exact_mut(self.members.len()) {
            self.lu.solve(column);
        }
        pivots
    }

    /// Adds its share G₁J⁻¹G₀ᵀ to the Schur complement of m rows, handed over row by row.
    pub(super) fn add_schur(&self, mut add: impl FnMut(usize, usize, f64)) {
        let size = self.members.len();
        for (g1, &row) in self.g1.chunks_exact(size).zip(&self.rows) {
            for (x, &column) in self.x.chunks_exact(size).zip(&self.rows) {
                add(row, column, dot(g1, x));
            }
        }
    }

    /// Replaces the residual r in `step` by −J⁻¹r, and takes what G₁ makes of that off the gaps.
    pub(super) fn solve(&mut self, step: &mut [f64], gaps: &mut [f64]) {
        match self.members.len() {
            // As in the factors.
            1 => self.solve_sized::<1>(step, gaps),
            2 => self.solve_sized::<2>(step, gaps),
            3 => self.solve_sized::<3>(step, gaps),
            4 => self.solve_sized::<4>(step, gaps),
            5 => self.solve_sized::<5>(step, gaps),
            6 => self.solve_sized::<6>(step, gaps),
            size => {
                let own = &mut step[self.members.clone()];
                self.lu.solve(own);
                own.iter_mut().for_each(|x| *x = -*x);
                for (g1, &row) in self.g1.chunks_exact(size).zip(&self.rows) {
                    gaps[row] -= dot(g1, own);
                }
            }
        }
    }

    #[inline(always)]
    fn solve_sized<const N: usize>(&mut self, step: &mut [f64], gaps: &mut [f64]) {
        let own = &mut step[self.members.clone()][..N];
        self.lu.solve(own);
        own.iter_mut().for_each(|x| *x = -*x);
        for (g1, &row) in self.g1.as_chunks::<N>().0.iter().zip(&self.rows) {
            gaps[row] -= dot(g1, own);
        }
    }

    /// Adds J⁻¹G₀ᵀλ to the step.
    pub(super) fn pull(&self, step: &mut [f64], lambda: &[f64]) {
        match self.members.len() {
            1 => self.pull_sized::<1>(step, lambda),
            2 => self.pull_sized::<2>(step, lambda),
            3 => self.pull_sized::<3>(step, lambda),
            4 => self.pull_sized::<4>(step, lambda),
            5 => self.pull_sized::<5>(step, lambda),
            6 => self.pull_sized::<6>(step, lambda),
            size => {
                let own = &mut step[self.members.clone()];
                for (x, &row) in self.x.chunks_exact(size).zip(&self.rows) {
                    add_scaled(own, lambda[row], x);
                }
            }
        }
    }

    #[inline(always)]
    fn pull_sized<const N: usize>(&self, step: &mut [f64], lambda: &[f64]) {
        let own = &mut step[self.members.clone()][..N];
        let mut sum = [0.0; N];
        for (x, &row) in self.x.as_chunks::<N>().0.iter().zip(&self.rows) {
            add_scaled(&mut sum, lambda[row], x);
        }
        add_scaled(own, 1.0, &sum);
    }
}

#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

#[inline(always)]
fn add_scaled(to: &mut [f64], factor: f64, x: &[f64]) {
    for (to, x) in to.iter_mut().zip(x) {
        *to += factor * x;
    }
}
