//! Where Newton starts: the polynomial through past configurations.
//!
//! A state keeps its last increment and that one's backward differences. The sum of the first k of
//! them is the increment that the polynomial of degree k foretells, and the k-th is what it missed
//! in the step before. The degree that has lately missed least foretells the next step: a smooth
//! motion is foretold by the highest, a jerky one by the lowest. A run that steps number by number
//! has one degree for all its coordinates, one on lanes one for every block.

use crate::lane::sweep::{Sweep, sweep};
use crate::lane::{Lane, WIDEST};

/// Highest degree.
pub(crate) const DEGREES: usize = 5;

/// How far a guess of each degree has lately missed: a fading sum of squares.
pub(crate) type Missed = [f64; DEGREES];

/// Last increments of all coordinates, then their backward differences, degree after degree; the
/// first `step` of these mean something.
pub(crate) type Differences = Vec<f64>;

/// Which degree foretells best.
#[derive(Clone, Debug)]
pub(crate) struct Predictor {
    /// 1 over the size of each coordinate; 0 where driven.
    weight: Vec<f64>,
    pub(crate) missed: Missed,
}

impl Predictor {
    /// For coordinates of these sizes (1 rad or a length), zero weight for driven ones.
    pub(crate) fn new(size: &[f64], driven: &[bool]) -> Self {
        let weight = size.iter().zip(driven).map(|(s, &d)| if d { 0.0 } else { 1.0 / s });
        Predictor { weight: weight.collect(), missed: [0.0; DEGREES] }
    }

    /// The increment of step number `step` (from zero, at least 2).
    pub(crate) fn guess(&self, step: usize, differences: &Differences, delta: &mut [f64]) {
        let count = delta.len();
        let differences = &differences[..self.best_degree(step) * count];
        sweep(count, &mut Guess { differences, delta });
    }

    /// The degree that has foretold the last steps best; the quadratic until more is known.
    fn best_degree(&self, step: usize) -> usize {
        let mut best = 2;
        for degree in 1..=DEGREES.min(step.saturating_sub(1)) {
            if self.missed[degree - 1] < self.missed[best - 1] {
                best = degree;
            }
        }
        best
    }

    /// Takes the increment of step number `step` (from zero) into the differences.
    pub(crate) fn learn(&mut self, step: usize, delta: &[f64], differences: &mut Differences) {
        let mut learn =
            Learn { weight: &self.weight, delta, differences, missed: [0.0; DEGREES * WIDEST] };
        sweep(delta.len(), &mut learn);
        for (k, missed) in learn.missed.chunks_exact(WIDEST).enumerate().take(step) {
            let faded = if k + 1 < step { FADING * self.missed[k] } else { 0.0 };
            self.missed[k] = missed.iter().sum::<f64>() + faded;
        }
    }
}

/// What is left of an earlier miss after a step.
pub(crate) const FADING: f64 = 0.5;

/// Takes the increment of one coordinate into its differences, which stand `stride` apart; returns
/// the next differences, by which the guess of each degree has missed.
#[inline(always)]
pub(crate) fn shift<L: Lane>(increment: L, differences: &mut [f64], stride: usize) -> [L; DEGREES] {
    let mut missed = [increment; DEGREES];
    let mut difference = increment;
    for k in 0..DEGREES {
        let place = &mut differences[k * stride..];
        let next = difference - L::load(place);
        difference.store(place);
        difference = next;
        missed[k] = next;
    }
    missed
}

/// Lanes in which each degree is best, as bits, with `known` increments (at least 2) behind the step;
/// and how far the best has lately missed.
#[inline(always)]
pub(crate) fn best_degrees<L: Lane>(known: usize, missed: &[f64]) -> ([u8; DEGREES], L) {
    let missed = &missed[..DEGREES * L::WIDTH];
    let missed_by = |degree: usize| L::load(&missed[(degree - 1) * L::WIDTH..]);
    // The quadratic unless another is better.
    let mut least = missed_by(2);
    let mut best = [0; DEGREES];
    best[1] = L::ALL;
    for degree in 1..=DEGREES {
        if degree != 2 && degree < known {
            let better = missed_by(degree).less(least);
            least = least.min(missed_by(degree));
            for other in &mut best {
                *other &= !better;
            }
            best[degree - 1] = better;
        }
    }
    (best, least)
}

/// The increments of a step on lanes by the degree that is best in each lane.
#[inline(always)]
pub(crate) fn guess<L: Lane, const N: usize>(best: [u8; DEGREES], differences: &[f64]) -> [L; N] {
    let differences = &differences[..DEGREES * N * L::WIDTH];
    let mut sums = [L::splat(0.0); N];
    let mut beyond = L::ALL;
    for (k, bits) in best.into_iter().enumerate() {
        for i in 0..N {
            let sum = sums[i] + L::load(&differences[(k * N + i) * L::WIDTH..]);
            sums[i] = L::choose(beyond, sum, sums[i]);
        }
        beyond &= !bits;
    }
    sums
}

struct Guess<'a> {
    differences: &'a [f64],
    delta: &'a mut [f64],
}

impl Sweep for Guess<'_> {
    #[inline(always)]
    fn at<L: Lane>(&mut self, i: usize) {
        let mut sum = L::load(&self.differences[i..]);
        let mut next = i + self.delta.len();
        while next < self.differences.len() {
            sum = sum + L::load(&self.differences[next..]);
            next += self.delta.len();
        }
        sum.store(&mut self.delta[i..]);
    }
}

struct Learn<'a> {
    weight: &'a [f64],
    delta: &'a [f64],
    differences: &'a mut Differences,
    missed: [f64; DEGREES * WIDEST],
}

impl Sweep for Learn<'_> {
    #[inline(always)]
    fn at<L: Lane>(&mut self, i: usize) {
        let weight = L::load(&self.weight[i..]);
        let (increment, stride) = (L::load(&self.delta[i..]), self.delta.len());
        let next = shift(increment, &mut self.differences[i..], stride);
        for k in 0..DEGREES {
            let (size, missed) = (next[k] * weight, &mut self.missed[k * WIDEST..]);
            size.mul_add(size, L::load(missed)).store(missed);
        }
    }
}
