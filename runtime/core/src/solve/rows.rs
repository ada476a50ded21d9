//! Entries of the constraint Jacobian that are not zero by structure.

use crate::layout::Block;
use crate::system::System;

/// Entries side by side: in a row of the packed Jacobian, and of coordinates that follow each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Span {
    /// The row, by its index in the model.
    pub(crate) row: usize,
    /// The first coordinate, by its index in the model.
    pub(crate) coordinate: usize,
    /// Where its entry stands in the packed Jacobian.
    pub(crate) slot: usize,
    /// How many there are.
    pub(crate) count: usize,
}

impl Span {
    /// Adds Gᵀλ to `sum`, which counts coordinates of the model.
    #[inline]
    fn add_forces(&self, jacobian: &[f64], lambda: &[f64], sum: &mut [f64]) {
        let lambda = lambda[self.row];
        let entries = &jacobian[self.slot..][..self.count];
        for (sum, entry) in sum[self.coordinate..][..self.count].iter_mut().zip(entries) {
            *sum += entry * lambda;
        }
    }

    /// As [`Span::add_forces`], all terms positive.
    #[inline]
    fn add_sizes(&self, jacobian: &[f64], lambda: &[f64], sum: &mut [f64]) {
        let lambda = lambda[self.row].abs();
        let entries = &jacobian[self.slot..][..self.count];
        for (sum, entry) in sum[self.coordinate..][..self.count].iter_mut().zip(entries) {
            *sum += entry.abs() * lambda;
        }
    }
}

/// The entries that are there, and compiled code for the blocks that have it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pulls {
    spans: Vec<Span>,
    systems: Vec<&'static System>,
}

impl Pulls {
    /// Of blocks whose compiled code is used, and of spans of the others.
    pub(crate) fn new(spans: Vec<Span>, systems: Vec<&'static System>) -> Self {
        Pulls { spans, systems }
    }

    /// Puts Gᵀλ by coordinates of the model.
    #[inline]
    pub(crate) fn forces(&self, jacobian: &[f64], lambda: &[f64], sum: &mut [f64]) {
        sum.fill(0.0);
        self.systems.iter().for_each(|system| (system.pull)(jacobian, lambda, sum));
        self.spans.iter().for_each(|span| span.add_forces(jacobian, lambda, sum));
    }

    /// As [`Pulls::forces`], all terms positive.
    #[inline]
    pub(crate) fn sizes(&self, jacobian: &[f64], lambda: &[f64], sum: &mut [f64]) {
        sum.fill(0.0);
        self.systems.iter().for_each(|system| (system.pull_sizes)(jacobian, lambda, sum));
        self.spans.iter().for_each(|span| span.add_sizes(jacobian, lambda, sum));
    }
}

/// The entries that are there in a Jacobian which was filled with what is not a number before it
/// was written; those of driven coordinates are left out.
pub(crate) fn spans<'a>(
    blocks: impl Iterator<Item = &'a Block>,
    driven: &[bool],
    jacobian: &[f64],
) -> Vec<Span> {
    let mut spans: Vec<Span> = Vec::new();
    for block in blocks {
        let width = block.coordinates.len();
        for (local, &row) in block.rows.iter().enumerate() {
            let first = block.constraint_offset + local * width;
            let mut open: Option<Span> = None;
            for (slot, &coordinate) in (first..).zip(&block.coordinates) {
                if driven[coordinate] || jacobian[slot].is_nan() {
                    spans.extend(open.take());
                    continue;
                }
                match &mut open {
                    Some(span) if span.coordinate + span.count == coordinate => span.count += 1,
                    _ => {
                        spans.extend(open.replace(Span { row, coordinate, slot, count: 1 }));
                    }
                }
            }
            spans.extend(open);
        }
    }
    spans
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_gathered_up_to_a_gap() {
        let block = Block {
            coordinates: vec![2, 3, 5, 6],
            rows: vec![1],
            parts: vec![4],
            matrix_offset: 0,
            constraint_offset: 10,
        };
        let mut jacobian = vec![f64::NAN; 14];
        jacobian[10..14].copy_from_slice(&[1.0, 2.0, 3.0, 4.0]);
        let driven = [false, false, false, false, false, false, true];
        let found = spans([&block].into_iter(), &driven, &jacobian);
        let span = |coordinate, slot, count| Span { row: 1, coordinate, slot, count };
        assert_eq!(found, [span(2, 10, 2), span(5, 12, 1)]);
        let mut sum = vec![0.0; 7];
        found.iter().for_each(|span| span.add_forces(&jacobian, &[0.0, -2.0], &mut sum));
        assert_eq!(sum, [0.0, 0.0, -2.0, -4.0, 0.0, -6.0, 0.0]);
        found.iter().for_each(|span| span.add_sizes(&jacobian, &[0.0, -2.0], &mut sum));
        assert_eq!(sum, [0.0; 7]);
    }
}
