//! Coordinates in static equilibrium at an instant: massless nodes that strands hold.
//!
//! Within a step they are unknowns like others and balance at its middle. What is written of an
//! instant, a row of a result file or an energy, shows them balanced at that instant: found here by
//! Newton's method over these coordinates alone. The state of the run is not touched, so that a run
//! does not depend on what is looked at.

use crate::layout::Layout;
use crate::linalg::solve_least_norm;
use crate::model::{Midpoint, Model};

/// Newton iterations before the search is given up.
const MAX_ITERATIONS: usize = 60;

/// Finds the balance; owns its scratch.
#[derive(Clone, Debug, Default)]
pub(crate) struct Statics {
    /// Per block: positions in the block and coordinates by index.
    groups: Vec<(usize, Vec<(usize, usize)>)>,
    zero: Vec<f64>,
    momentum: Vec<f64>,
    force: Vec<f64>,
    matrix: Vec<f64>,
}

impl Statics {
    /// For a model whose coordinates marked in `driven` have their path given.
    pub(crate) fn new(layout: &Layout, driven: &[bool]) -> Self {
        let list = layout.statics(driven);
        let mut statics = Statics::default();
        if list.is_empty() {
            return statics;
        }
        for (number, block) in layout.blocks.iter().enumerate() {
            let members = block.coordinates.iter().copied().enumerate();
            let members: Vec<_> = members.filter(|(_, c)| list.contains(c)).collect();
            if !members.is_empty() {
                statics.groups.push((number, members));
            }
        }
        let n = layout.coordinates.len();
        statics.zero = vec![0.0; n];
        statics.momentum = vec![0.0; n];
        statics.force = vec![0.0; n];
        statics.matrix = vec![0.0; layout.matrix_size()];
        statics
    }

    /// Whether there are none.
    pub(crate) fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    /// Moves the coordinates of `q` to where the forces on them vanish; those that nothing pulls
    /// stay. An error is the coordinate that is worst, and the force (N) left on it.
    pub(crate) fn settle<M: Model>(
        &mut self,
        model: &mut M,
        q: &mut [f64],
        (t, rest, inputs): (f64, &[f64], &[f64]),
    ) -> Result<(), (usize, f64)> {
        let layout = model.layout().clone();
        let groups = std::mem::take(&mut self.groups);
        let mut outcome = Ok(());
        for (number, members) in &groups {
            let block = &layout.blocks[*number];
            let width = block.coordinates.len();
            let count = members.len();
            let mut before = f64::INFINITY;
            let mut last = vec![0.0; count];
            let mut fraction = 1.0;
            let mut settled = false;
            for _ in 0..MAX_ITERATIONS {
                let found = self.forces(model, q, (t, rest, inputs));
                let norm = members.iter().map(|&(_, c)| found[c].powi(2)).sum::<f64>().sqrt();
                if norm == 0.0 {
                    settled = true;
                    break;
                }
                if !(norm < before) && fraction > 1e-3 && before.is_finite() {
                    // Too far along the last correction, or as near as rounding lets it come.
                    let size = last.iter().fold(0.0, |a: f64, x: &f64| a.max((x * fraction).abs()));
                    if size <= 1e-13 * layout.length_scale {
                        settled = true;
                        break;
                    }
                    fraction *= 0.5;
                    for (&(_, c), step) in members.iter().zip(&last) {
                        q[c] -= fraction * step;
                    }
                    continue;
                }
                before = norm;
                fraction = 1.0;
                let entry = |i: usize, j: usize| self.matrix[block.matrix_offset + i * width + j];
                let pairs =
                    members.iter().flat_map(|&(i, _)| members.iter().map(move |&(j, _)| (i, j)));
                let system: Vec<f64> = pairs.map(|(i, j)| entry(i, j)).collect();
                let rhs: Vec<f64> = members.iter().map(|&(_, c)| -self.force[c]).collect();
                if system.iter().chain(&rhs).any(|x| !x.is_finite()) {
                    break;
                }
                last = solve_least_norm(&system, count, count, &rhs).x;
                let size = last.iter().fold(0.0, |a: f64, x| a.max(x.abs()));
                for (&(_, c), step) in members.iter().zip(&last) {
                    q[c] += step;
                }
                if size <= 1e-15 * layout.length_scale {
                    settled = true;
                    break;
                }
            }
            if !settled {
                let force = self.forces(model, q, (t, rest, inputs));
                let worst = members.iter().map(|&(_, c)| (c, force[c]));
                let worst = worst.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
                outcome = worst.map_or(Ok(()), Err);
                break;
            }
        }
        self.groups = groups;
        outcome
    }

    /// Forces at rest; with a step of 4 the Newton matrix is their derivative.
    fn forces<M: Model>(
        &mut self,
        model: &mut M,
        q: &[f64],
        (t, rest, inputs): (f64, &[f64], &[f64]),
    ) -> &[f64] {
        let at = Midpoint { q, v: &self.zero, t, rest, inputs };
        let (momentum, force) = (&mut self.momentum, &mut self.force);
        model.evaluate_with_matrix(&at, 4.0, momentum, force, &mut self.matrix);
        force
    }
}
