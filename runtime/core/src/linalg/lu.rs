//! LU factors with scaled partial pivoting.
//!
//! Small matrices are factored by loops whose length the compiler knows; large ones on the lanes of
//! vectors, in rows padded so that no lane is left over. What must not take part in a padded
//! operation is held at zero on the other side of the product.

use crate::lane::{Lane, Work, call};

/// From this size on rows are padded and lanes are used.
const LANES_FROM: usize = 12;
/// Rows are padded to a multiple of the widest vector there is.
pub(crate) const PADDING: usize = 8;

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
    /// With which later row each was exchanged when its turn came.
    moves: Vec<usize>,
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
            moves: vec![0; n],
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
        if self.n < LANES_FROM || !call(4, Factor { lu: &mut *self, pivots: &mut pivots }) {
            pivots = self.factor_on::<f64>();
        }
        pivots
    }

    /// As [`Lu::factor`], for those who are on lanes already.
    #[inline(always)]
    pub(crate) fn factor_on<L: Lane>(&mut self) -> Pivots {
        match self.n {
            // A size known to the compiler unrolls the loops.
            1 => self.factor_small::<1>(),
            2 => self.factor_small::<2>(),
            3 => self.factor_small::<3>(),
            4 => self.factor_small::<4>(),
            5 => self.factor_small::<5>(),
            6 => self.factor_small::<6>(),
            n if n < LANES_FROM => self.eliminate::<f64>(),
            _ => self.eliminate::<L>(),
        }
    }

    /// Solves A x = b; `x` holds b on entry.
    pub fn solve(&mut self, x: &mut [f64]) {
        if self.n < LANES_FROM || !call(4, Solve { lu: &mut *self, x: &mut *x }) {
            self.solve_on::<f64>(x);
        }
    }

    /// As [`Lu::solve`], for those who are on lanes already.
    #[inline(always)]
    pub(crate) fn solve_on<L: Lane>(&mut self, x: &mut [f64]) {
        match self.n {
            0 => {}
            1 => self.solve_small::<1>(x),
            2 => self.solve_small::<2>(x),
            3 => self.solve_small::<3>(x),
            4 => self.solve_small::<4>(x),
            5 => self.solve_small::<5>(x),
            6 => self.solve_small::<6>(x),
            n if n < LANES_FROM => self.substitute::<f64>(x),
            _ => self.substitute::<L>(x),
        }
    }

    /// Solves A X = B for many columns at once; row i of B, then of X, stands at `i * stride` of `x`,
    /// where `stride` is a multiple of all widths of lanes.
    #[inline(always)]
    pub(crate) fn solve_rows<L: Lane>(&mut self, x: &mut [f64], stride: usize) {
        // Rows exchanged one by one, as the factors' were.
        self.moves.iter().enumerate().for_each(|(k, &other)| {
            if other != k {
                let (upper, lower) = x.split_at_mut(other * stride);
                upper[k * stride..][..stride].swap_with_slice(&mut lower[..stride]);
            }
        });
        for i in 0..self.n {
            let (before, rest) = x.split_at_mut(i * stride);
            let row = &self.a[i * self.stride..][..i];
            subtract_rows::<L>(&mut rest[..stride], row, before);
        }
        for i in (0..self.n).rev() {
            let (before, after) = x.split_at_mut((i + 1) * stride);
            let own = &mut before[i * stride..];
            let row = &self.a[i * self.stride..][i..self.n];
            subtract_rows::<L>(own, &row[1..], after);
            let reciprocal = L::splat(row[0]);
            for x in own.chunks_exact_mut(L::WIDTH) {
                (L::load(x) * reciprocal).store(x);
            }
        }
    }

    #[inline(always)]
    fn factor_small<const N: usize>(&mut self) -> Pivots {
        // The optimiser cannot know it from the match alone.
        (self.n, self.stride) = (N, N);
        self.eliminate::<f64>()
    }

    /// Goes through the columns.
    #[inline(always)]
    fn eliminate<L: Lane>(&mut self) -> Pivots {
        let mut pivots = Pivots::NONE;
        let (n, stride) = (self.n, self.stride);
        let (a, order, scale) =
            (&mut self.a[..n * stride], &mut self.order[..n], &mut self.scale[..n]);
        let moves = &mut self.moves[..n];
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
                return pivots;
            }
            moves[k] = best;
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
                    // Columns before are zero in the pivot's row.
                    let first = (k + 1) / L::WIDTH * L::WIDTH;
                    let factor = L::splat(factor);
                    let rows = row[first..].chunks_exact_mut(L::WIDTH);
                    for (x, y) in rows.zip(pivot_row[first..].chunks_exact(L::WIDTH)) {
                        factor.neg_mul_add(L::load(y), L::load(x)).store(x);
                    }
                }
            }
        }
        pivots
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

/// Takes multiples of `rows` off another row, over whole vectors.
#[inline(always)]
fn subtract_rows<L: Lane>(to: &mut [f64], factors: &[f64], rows: &[f64]) {
    for (&factor, row) in factors.iter().zip(rows.chunks_exact(to.len())) {
        let factor = L::splat(factor);
        for (to, x) in to.chunks_exact_mut(L::WIDTH).zip(row.chunks_exact(L::WIDTH)) {
            factor.neg_mul_add(L::load(x), L::load(to)).store(to);
        }
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
        *self.pivots = self.lu.factor_on::<L>();
    }
}

struct Solve<'a> {
    lu: &'a mut Lu,
    x: &'a mut [f64],
}

impl Work for Solve<'_> {
    #[inline(always)]
    fn run<L: Lane>(self) {
        self.lu.solve_on::<L>(self.x);
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
    fn many_columns_are_solved_as_one() {
        for n in [1, 3, 5, 9, 14, 23] {
            let (mut lu, _) = factored(&matrix(n), n);
            let columns = 16;
            let b = matrix(columns.max(n));
            let mut many = b[..n * columns].to_vec();
            struct Rows<'a>(&'a mut Lu, &'a mut [f64], usize);
            impl Work for Rows<'_> {
                #[inline(always)]
                fn run<L: Lane>(self) {
                    self.0.solve_rows::<L>(self.1, self.2);
                }
            }
            let mut plain = many.clone();
            lu.solve_rows::<f64>(&mut plain, columns);
            if !call(4, Rows(&mut lu, &mut many, columns)) {
                many.clone_from(&plain);
            }
            for column in 0..columns {
                let mut one: Vec<f64> = (0..n).map(|i| b[i * columns + column]).collect();
                lu.solve(&mut one);
                for i in 0..n {
                    let size = 1.0 + one[i].abs();
                    assert!((plain[i * columns + column] - one[i]).abs() < 1e-11 * size);
                    assert!((many[i * columns + column] - one[i]).abs() < 1e-11 * size);
                }
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
