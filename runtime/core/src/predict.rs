//! Where Newton starts: the polynomial through past configurations.
//!
//! A state keeps its last increment and that one's backward differences. The sum of the first k of
//! them is the increment that the polynomial of degree k foretells, and the k-th is what it missed
//! in the step before. The degree that has lately missed least foretells the next step: a smooth
//! motion is foretold by the highest, a jerky one by the lowest.

use crate::lane::sweep::{Sweep, sweep};
use crate::lane::{Lane, WIDEST};

/// Highest degree.
pub(crate) const DEGREES: usize = 4;

/// Last increment and its backward differences, of which the first `step` mean something.
pub(crate) type Differences = [Vec<f64>; DEGREES];

/// Which degree foretells best.
#[derive(Clone, Debug)]
pub(crate) struct Predictor {
    /// 1 over the size of each coordinate; 0 where driven.
    weight: Vec<f64>,
    /// Fading sum of the squares by which a guess of each degree has missed.
    missed: [f64; DEGREES],
}

impl Predictor {
    /// For coordinates of these sizes (1 rad or a length), zero weight for driven ones.
    pub(crate) fn new(size: &[f64], driven: &[bool]) -> Self {
        let weight = size.iter().zip(driven).map(|(s, &d)| if d { 0.0 } else { 1.0 / s });
        Predictor { weight: weight.collect(), missed: [0.0; DEGREES] }
    }

    /// The increment of step number `step` (from zero, at least 2).
    pub(crate) fn guess(&self, step: usize, differences: &Differences, delta: &mut [f64]) {
        let degree = self.best_degree(step);
        sweep(delta.len(), &mut Guess { terms: &differences[..degree], delta });
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
            let faded = if k + 1 < step { 0.5 * self.missed[k] } else { 0.0 };
            self.missed[k] = missed.iter().sum::<f64>() + faded;
        }
    }
}

struct Guess<'a> {
    terms: &'a [Vec<f64>],
    delta: &'a mut [f64],
}

impl Sweep for Guess<'_> {
    #[inline(always)]
    fn at<L: Lane>(&mut self, i: usize) {
        let mut sum = L::load(&self.terms[0][i..]);
        for term in &self.terms[1..] {
            sum = sum + L::load(&term[i..]);
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
        let mut difference = L::load(&self.delta[i..]);
        for k in 0..DEGREES {
            let place = &mut self.differences[k][i..];
            let next = difference - L::load(place);
            difference.store(place);
            difference = next;
            let (size, missed) = (next * weight, &mut self.missed[k * WIDEST..]);
            size.mul_add(size, L::load(missed)).store(missed);
        }
    }
}
