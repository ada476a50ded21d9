//! LU factors with scaled partial pivoting.
//!
//! Small matrices are factored by loops whose length the compiler knows; large ones on the lanes of
//! vectors, in rows padded so that no lane is left over. What must not take part in a padded
//! operation is held at zero on the other side of the product.

use crate::lane::{Lane, Work, call};

/// From this size on rows are padded and lanes are used.
const LANES_FROM: usize = 12;
/// Rows are padded to a multiple of the widest vector there is.
const PADDING: usize = 8;

/// How a factorisation went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pivots {
    /// Smallest pivot relative to the largest entry of its row; 0 where a column had none.
    pub smallest: f64,
    /// Largest such ratio.
    pub largest: f64,
}

impl Pivots {
    /// Of no matrix.
    pub const NONE: Pivots = Pivots { smallest: f64::INFINITY, largest: 0.0 };

    /// A cheap lower bound of the condition number.
    pub fn condition(&self) -> f64 {
        self.largest / self.smallest
    }

    /// The range of both.
    pub fn and(self, other: Pivots) -> Pivots {
        Pivots {
            smallest: self.smallest.min(other.smallest),
            largest: self.largest.max(other.largest),
        }
    }
}

/// A square matrix and then its factors, P A = L U, with reciprocals of the pivots on the diagonal.
#[derive(Clone, Debug)]
pub struct Lu {
    n: usize,
    stride: usize,
    a: Vec<f64>,
    /// Original row of each row.
    order: Vec<usize>,
    /// Largest entry of each row.
    scale: Vec<f64>,
    /// A row whose entries beside those in use are zero.
    row: Vec<f64>,
    /// Another.
    other: Vec<f64>,
}

impl Lu {
    /// Of an n×n matrix of zeros.
    pub fn new(n: usize) -> Self {
        let stride = if n < LANES_FROM { n } else { n.next_multiple_of(PADDING) };
        Lu {
            n,
            stride,
            a: vec![0.0; n * stride],
            order: vec![0; n],
            scale: vec![0.0; n],
            row: vec![0.0; stride],
            other: vec![0.0; stride],
        }
    }

    /// Row i of the matrix, to be filled before it is factored.
    #[inline]
    pub fn row_mut(&mut self, i: usize) -> &mut [f64] {
        &mut self.a[i * self.stride..][..self.n]
    }

    /// Row i.
    #[inline]
    pub fn row(&self, i: usize) -> &[f64] {
        &self.a[i * self.stride..][..self.n]
    }

    /// Factors in place. The factors are useless if the smallest pivot is zero or not finite.
    pub fn factor(&mut self) -> Pivots {
        let mut pivots = Pivots::NONE;
        match self.n {
            0 => {}
            // A size known to the compiler unrolls the loops.
            1 => self.factor_small::<1>(&mut pivots),
            2 => self.factor_small::<2>(&mut pivots),
            3 => self.factor_small::<3>(&mut pivots),
            4 => self.factor_small::<4>(&mut pivots),
            5 => self.factor_small::<5>(&mut pivots),
            6 => self.factor_small::<6>(&mut pivots),
            n if n < LANES_FROM => self.eliminate(&mut pivots, eliminate_row),
            _ => {
                if !call(Factor { lu: &mut *self, pivots: &mut pivots }) {
                    self.eliminate(&mut pivots, eliminate_row);
                }
            }
        }
        pivots
    }

    /// Solves A x = b; `x` holds b on entry.
    pub fn solve(&mut self, x: &mut [f64]) {
        match self.n {
            0 => {}
            1 => self.solve_small::<1>(x),
            2 => self.solve_small::<2>(x),
            3 => self.solve_small::<3>(x),
            4 => self.solve_small::<4>(x),
            5 => self.solve_small::<5>(x),
            6 => self.solve_small::<6>(x),
            n if n < LANES_FROM => self.substitute::<f64>(x),
            _ => {
                if !call(Solve { lu: &mut *self, x }) {
                    self.substitute::<f64>(x);
                }
            }
        }
    }

    #[inline(always)]
    fn factor_small<const N: usize>(&mut self, pivots: &mut Pivots) {
        // The optimiser cannot know it from the match alone.
        (self.n, self.stride) = (N, N);
        self.eliminate(pivots, eliminate_row);
    }

    /// Goes through the columns; `eliminate(row, factor, pivot, from)` takes `factor` times the pivot's
    /// row off a row from column `from` on.
    #[inline(always)]
    fn eliminate(
        &mut self,
        pivots: &mut Pivots,
        eliminate: impl Fn(&mut [f64], f64, &[f64], usize),
    ) {
        let (n, stride) = (self.n, self.stride);
        let (a, order, scale) =
            (&mut self.a[..n * stride], &mut self.order[..n], &mut self.scale[..n]);
        let pivot_row = &mut self.row[..stride];
        for i in 0..n {
            order[i] = i;
            let row = &a[i * stride..i * stride + n];
            scale[i] = row.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        }
        for k in 0..n {
            let (mut best, mut best_ratio) = (k, -1.0);
            for i in k..n {
                let ratio = if scale[i] > 0.0 { a[i * stride + k].abs() / scale[i] } else { 0.0 };
                if ratio > best_ratio {
                    (best, best_ratio) = (i, ratio);
                }
            }
            // A NaN compares false above and is caught here.
            if !(best_ratio > 0.0) {
                pivots.smallest = 0.0;
                return;
            }
            if best != k {
                for j in 0..n {
                    a.swap(k * stride + j, best * stride + j);
                }
                order.swap(k, best);
                scale.swap(k, best);
            }
            pivots.smallest = pivots.smallest.min(best_ratio);
            pivots.largest = pivots.largest.max(best_ratio);
            let reciprocal = 1.0 / a[k * stride + k];
            let (upper, lower) = a.split_at_mut((k + 1) * stride);
            let pivot = &mut upper[k * stride..];
            pivot[k] = reciprocal;
            pivot_row[..=k].fill(0.0);
            pivot_row[k + 1..].copy_from_slice(&pivot[k + 1..]);
            for row in lower.chunks_exact_mut(stride) {
                let factor = row[k] * reciprocal;
                row[k] = factor;
                if factor != 0.0 {
                    eliminate(row, factor, pivot_row, k + 1);
                }
            }
        }
    }

    #[inline(always)]
    fn solve_small<const N: usize>(&mut self, x: &mut [f64]) {
        let (a, order) = (&self.a[..N * N], &self.order[..N]);
        let (x, y) = (&mut x[..N], &mut self.row[..N]);
        for i in 0..N {
            let mut sum = x[order[i]];
            for j in 0..i {
                sum -= a[i * N + j] * y[j];
            }
            y[i] = sum;
        }
        for i in (0..N).rev() {
            let mut sum = y[i];
            for j in i + 1..N {
                sum -= a[i * N + j] * x[j];
            }
            x[i] = sum * a[i * N + i];
        }
    }

    /// Substitution with sums over whole vectors: what a sum is not to reach is zero.
    #[inline(always)]
    fn substitute<L: Lane>(&mut self, x: &mut [f64]) {
        let (n, stride) = (self.n, self.stride);
        let (y, z) = (&mut self.row[..stride], &mut self.other[..stride]);
        y.fill(0.0);
        z.fill(0.0);
        for (i, row) in self.a.chunks_exact(stride).enumerate() {
            let end = i.next_multiple_of(L::WIDTH);
            y[i] = x[self.order[i]] - product::<L>(&row[..end], &y[..end]);
        }
        for (i, row) in self.a.chunks_exact(stride).enumerate().rev() {
            let first = (i + 1) / L::WIDTH * L::WIDTH;
            z[i] = (y[i] - product::<L>(&row[first..], &z[first..])) * row[i];
        }
        x[..n].copy_from_slice(&z[..n]);
    }
}

/// Takes `factor` times the pivot's row off a row, number by number.
#[inline(always)]
fn eliminate_row(row: &mut [f64], factor: f64, pivot: &[f64], from: usize) {
    for (x, y) in row[from..].iter_mut().zip(&pivot[from..]) {
        *x -= factor * y;
    }
}

/// Σ a·b over whole vectors.
#[inline(always)]
fn product<L: Lane>(a: &[f64], b: &[f64]) -> f64 {
    let (mut even, mut odd) = (L::splat(0.0), L::splat(0.0));
    let (a, b) = (a.chunks_exact(2 * L::WIDTH), b.chunks_exact(2 * L::WIDTH));
    let (last_a, last_b) = (a.remainder(), b.remainder());
    for (a, b) in a.zip(b) {
        even = L::load(a).mul_add(L::load(b), even);
        odd = L::load(&a[L::WIDTH..]).mul_add(L::load(&b[L::WIDTH..]), odd);
    }
    if last_a.len() >= L::WIDTH {
        even = L::load(last_a).mul_add(L::load(last_b), even);
    }
    let sum = even + odd;
    let mut total = 0.0;
    for lane in 0..L::WIDTH {
        total += sum.lane(lane);
    }
    total
}

struct Factor<'a> {
    lu: &'a mut Lu,
    pivots: &'a mut Pivots,
}

impl Work for Factor<'_> {
    #[inline(always)]
    fn run<L: Lane>(self) {
        self.lu.eliminate(
            self.pivots,
            #[inline(always)]
            |row, factor, pivot, from| {
                // Columns before `from` are zero in the pivot's row.
                let first = from / L::WIDTH * L::WIDTH;
                let factor = L::splat(factor);
                let rows = row[first..].chunks_exact_mut(L::WIDTH);
                for (x, y) in rows.zip(pivot[first..].chunks_exact(L::WIDTH)) {
                    factor.neg_mul_add(L::load(y), L::load(x)).store(x);
                }
            },
        );
    }
}

struct Solve<'a> {
    lu: &'a mut Lu,
    x: &'a mut [f64],
}

impl Work for Solve<'_> {
    #[inline(always)]
    fn run<L: Lane>(self) {
        self.lu.substitute::<L>(self.x);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix without any structure, by a linear congruence.
    fn matrix(n: usize) -> Vec<f64> {
        let mut seed = 1_u64;
        let mut next = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963);
            (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        (0..n * n).map(|_| next()).collect()
    }

    fn factored(a: &[f64], n: usize) -> (Lu, Pivots) {
        let mut lu = Lu::new(n);
        for i in 0..n {
            lu.row_mut(i).copy_from_slice(&a[i * n..(i + 1) * n]);
        }
        let pivots = lu.factor();
        (lu, pivots)
    }

    #[test]
    fn solves_at_every_size() {
        for n in 1..40 {
            let a = matrix(n);
            let truth: Vec<f64> = (0..n).map(|i| 1.0 + i as f64).collect();
            let mut x: Vec<f64> =
                (0..n).map(|i| (0..n).map(|j| a[i * n + j] * truth[j]).sum()).collect();
            let (mut lu, pivots) = factored(&a, n);
            assert!(pivots.smallest > 0.0);
            // Twice: a solve leaves the factors as they were.
            let mut again = x.clone();
            lu.solve(&mut x);
            lu.solve(&mut again);
            assert_eq!(x, again);
            for i in 0..n {
                let error = (x[i] - truth[i]).abs();
                assert!(error < 1e-10 * pivots.condition(), "size {n}: {error:e}");
            }
        }
    }

    #[test]
    fn rows_are_exchanged() {
        let (mut lu, pivots) = factored(&[0.0, 2.0, 1.0, 1.0, 1.0, 0.0, 3.0, 0.0, 1e6], 3);
        assert!(pivots.smallest > 0.0);
        let mut x = [-1.0, -1.0, 3e6 + 3.0];
        lu.solve(&mut x);
        for (x, truth) in x.iter().zip([1.0, -2.0, 3.0]) {
            assert!((x - truth).abs() < 1e-14);
        }
    }

    #[test]
    fn what_is_singular_or_not_a_number_has_no_pivot() {
        assert_eq!(factored(&[f64::NAN, 1.0, 1.0, f64::NAN], 2).1.smallest, 0.0);
        let mut a = matrix(20);
        for i in 0..20 {
            a[i * 20 + 7] = 0.0;
        }
        assert_eq!(factored(&a, 20).1.smallest, 0.0);
    }
}
