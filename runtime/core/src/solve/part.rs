//! A part of a block: coordinates that the Newton matrix couples without the help of constraints.
//!
//! What ties it to constraint rows stands by coordinates, the rows that touch it side by side in
//! padded vectors: so all of them are worked on together.

use crate::lane::Lane;
use crate::linalg::{Lu, PADDING, Pivots};
use std::ops::Range;

/// Its factors, and what ties it to the rows that touch it.
#[derive(Clone, Debug)]
pub(super) struct Part {
    /// Which of the block's free coordinates.
    pub(super) members: Range<usize>,
    /// Rows that touch it, local to the block.
    pub(super) rows: Vec<usize>,
    /// How many, with padding.
    pub(super) stride: usize,
    /// Of J.
    pub(super) lu: Lu,
    /// Its columns of G₁, one after another.
    pub(super) g1: Vec<f64>,
    /// Rows of J⁻¹G₀ᵀ one after another; before they are solved for, the columns of G₀.
    pub(super) x: Vec<f64>,
    /// Numbers of the rows side by side.
    of_rows: Vec<f64>,
}

impl Part {
    pub(super) fn new(members: Range<usize>, rows: Vec<usize>) -> Self {
        let (size, stride) = (members.len(), rows.len().next_multiple_of(PADDING));
        Part {
            lu: Lu::new(size),
            g1: vec![0.0; size * stride],
            x: vec![0.0; size * stride],
            of_rows: vec![0.0; stride],
            members,
            rows,
            stride,
        }
    }

    /// Factors J, solves for J⁻¹G₀ᵀ and adds G₁J⁻¹G₀ᵀ to the Schur complement.
    #[inline(always)]
    pub(super) fn factor<L: Lane>(&mut self, schur: &mut Lu) -> Pivots {
        let pivots = self.lu.factor_on::<L>();
        if self.rows.is_empty() || !(pivots.smallest > 0.0) {
            return pivots;
        }
        self.lu.solve_rows::<L>(&mut self.x, self.stride);
        for (i, &row) in self.rows.iter().enumerate() {
            self.of_rows.fill(0.0);
            for (x, g1) in self.x.chunks_exact(self.stride).zip(self.g1.chunks_exact(self.stride)) {
                add_scaled::<L>(&mut self.of_rows, g1[i], x);
            }
            let to = schur.row_mut(row);
            for (&column, value) in self.rows.iter().zip(&self.of_rows) {
                to[column] += value;
            }
        }
        pivots
    }

    /// Replaces the residual r in `step` by −J⁻¹r, and takes what G₁ makes of that off the gaps.
    #[inline(always)]
    pub(super) fn solve<L: Lane>(&mut self, step: &mut [f64], gaps: &mut [f64]) {
        let own = &mut step[self.members.clone()];
        self.lu.solve_on::<L>(own);
        own.iter_mut().for_each(|x| *x = -*x);
        if self.rows.is_empty() {
            return;
        }
        self.of_rows.fill(0.0);
        for (g1, &x) in self.g1.chunks_exact(self.stride).zip(&*own) {
            add_scaled::<L>(&mut self.of_rows, x, g1);
        }
        for (&row, value) in self.rows.iter().zip(&self.of_rows) {
            gaps[row] -= value;
        }
    }

    /// Adds J⁻¹G₀ᵀλ to the step.
    #[inline(always)]
    pub(super) fn pull<L: Lane>(&mut self, step: &mut [f64], lambda: &[f64]) {
        if self.rows.is_empty() {
            return;
        }
        for (&row, place) in self.rows.iter().zip(&mut self.of_rows) {
            *place = lambda[row];
        }
        let own = &mut step[self.members.clone()];
        for (x, own) in self.x.chunks_exact(self.stride).zip(own) {
            *own += product::<L>(x, &self.of_rows);
        }
    }
}

/// Adds a multiple, over whole vectors.
#[inline(always)]
fn add_scaled<L: Lane>(to: &mut [f64], factor: f64, x: &[f64]) {
    let factor = L::splat(factor);
    for (to, x) in to.chunks_exact_mut(L::WIDTH).zip(x.chunks_exact(L::WIDTH)) {
        factor.mul_add(L::load(x), L::load(to)).store(to);
    }
}

/// Σ a·b over whole vectors.
#[inline(always)]
fn product<L: Lane>(a: &[f64], b: &[f64]) -> f64 {
    let mut sum = L::splat(0.0);
    for (a, b) in a.chunks_exact(L::WIDTH).zip(b.chunks_exact(L::WIDTH)) {
        sum = L::load(a).mul_add(L::load(b), sum);
    }
    let mut total = 0.0;
    for lane in 0..L::WIDTH {
        total += sum.lane(lane);
    }
    total
}
