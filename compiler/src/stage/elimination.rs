//! Gaussian elimination on symbols, in a fixed order.
//!
//! What is left of it is straight-line code that touches no entry that is zero by structure. Of the
//! unknowns that may come next the one with the fewest neighbours does. No two rows are exchanged:
//! matrices of motion are definite but for terms in the step, and how far a pivot has shrunk is known to
//! the caller.

use crate::graph::Sym;
use handc_core::scalar::Scalar;
use std::collections::BTreeMap;

/// A matrix on its way to factors. Unknowns count its coordinates, then its multipliers.
pub(super) struct Elimination {
    /// How many of the unknowns are coordinates.
    coordinates: usize,
    /// Entries that are not zero by structure, row by row.
    rows: Vec<BTreeMap<usize, Sym>>,
    /// The pivots so far, in order: unknown, its reciprocal among the factors.
    order: Vec<(usize, usize)>,
    /// Entries below each pivot: unknown and place among the factors; and beside it.
    below: Vec<Vec<(usize, usize)>>,
    beside: Vec<Vec<(usize, usize)>>,
    pub(super) factors: Vec<Sym>,
    /// What each diagonal entry was before it began to shrink.
    scale: Vec<Option<Sym>>,
    /// By how much the smallest pivot has shrunk.
    pub(super) shrinkage: Sym,
    products: usize,
}

impl Elimination {
    /// Of these rows, of which the first belong to coordinates.
    pub(super) fn new(coordinates: usize, rows: Vec<BTreeMap<usize, Sym>>) -> Self {
        let count = rows.len();
        Elimination {
            coordinates,
            order: Vec::new(),
            below: vec![Vec::new(); count],
            beside: vec![Vec::new(); count],
            scale: (0..count).map(|i| rows[i].get(&i).copied()).collect(),
            rows,
            factors: Vec::new(),
            shrinkage: Sym::one(),
            products: 0,
        }
    }

    /// What an unknown's row still holds.
    pub(super) fn neighbours(&self, unknown: usize) -> impl Iterator<Item = usize> {
        self.rows[unknown].keys().copied()
    }

    /// Products that have changed entries so far, and those of a solution; the factors of rows are not
    /// counted a second time.
    pub(super) fn products(&self) -> usize {
        self.products + self.factors.len()
    }

    pub(super) fn is_done(&self, unknown: usize) -> bool {
        self.order.iter().any(|&(done, _)| done == unknown)
    }

    /// Eliminates some unknowns; `None` where that takes more than `most` products or meets a structural
    /// zero.
    pub(super) fn eliminate(&mut self, mut unknowns: Vec<usize>, most: usize) -> Option<()> {
        while !unknowns.is_empty() {
            let with_pivot =
                unknowns.iter().enumerate().filter(|(_, u)| self.rows[**u].contains_key(u));
            let (next, _) = with_pivot.min_by_key(|(_, u)| self.rows[**u].len())?;
            self.pivot(unknowns.remove(next));
            if self.products > most {
                return None;
            }
        }
        Some(())
    }

    fn keep(&mut self, value: Sym) -> usize {
        self.factors.push(value);
        self.factors.len() - 1
    }

    fn pivot(&mut self, pivot: usize) {
        let is_coordinate = pivot < self.coordinates;
        let row = std::mem::take(&mut self.rows[pivot]);
        let diagonal = row[&pivot];
        let reciprocal = diagonal.recip();
        if let Some(scale) = self.scale[pivot].filter(|&scale| scale != diagonal) {
            self.shrinkage = self.shrinkage.max((scale * reciprocal).abs());
        }
        let place = self.keep(reciprocal);
        self.order.push((pivot, place));
        let beside: Vec<(usize, Sym)> = row.into_iter().filter(|&(j, _)| j != pivot).collect();
        for &(j, value) in &beside {
            let place = self.keep(value);
            self.beside[pivot].push((j, place));
        }
        for other in 0..self.rows.len() {
            let Some(entry) = self.rows[other].remove(&pivot) else { continue };
            let factor = entry * reciprocal;
            let place = self.keep(factor);
            self.below[pivot].push((other, place));
            for &(j, value) in &beside {
                self.products += 1;
                let entry = self.rows[other].entry(j).or_insert_with(Sym::zero);
                *entry -= factor * value;
            }
            // A multiplier's pivot is made by coordinates and unmade by other multipliers.
            if is_coordinate && other >= self.coordinates {
                self.scale[other] = self.rows[other].get(&other).copied();
            }
        }
    }

    /// The unknowns for one right-hand side, with the factors that have been made.
    pub(super) fn solution(&self, mut x: Vec<Sym>, factor: impl Fn(usize) -> Sym) -> Vec<Sym> {
        for &(pivot, _) in &self.order {
            for &(other, place) in &self.below[pivot] {
                x[other] = x[other] - factor(place) * x[pivot];
            }
        }
        for &(pivot, reciprocal) in self.order.iter().rev() {
            for &(other, place) in &self.beside[pivot] {
                x[pivot] = x[pivot] - factor(place) * x[other];
            }
            x[pivot] = x[pivot] * factor(reciprocal);
        }
        x
    }
}

/// For the tests of those who eliminate.
#[cfg(test)]
pub(super) mod testing {
    use crate::emit::Place;
    use crate::graph::{Leaf, Sym, evaluate};
    use crate::stage::Task;

    /// A number without pattern.
    pub(in crate::stage) fn number(index: usize, salt: usize) -> f64 {
        ((index * 7919 + salt * 104_729 + 13) % 1009) as f64 / 1009.0 - 0.5
    }

    /// What tasks compute one after another; `read` is given the results of the last one called
    /// `factor`.
    pub(in crate::stage) fn results(
        tasks: &[Task],
        read: impl Fn(Leaf, &[f64]) -> f64,
    ) -> Vec<(Place, f64)> {
        let (mut factors, mut found) = (Vec::new(), Vec::new());
        for task in tasks {
            let values: Vec<Sym> = task.outputs.iter().map(|output| output.value).collect();
            let values = evaluate(&values, |leaf| read(leaf, &factors));
            if task.name == "factor" {
                factors.clone_from(&values);
            }
            found.extend(task.outputs.iter().map(|output| output.place.clone()).zip(values));
        }
        found
    }
}
