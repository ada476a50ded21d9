//! Coordinates in static equilibrium at an instant: massless nodes that strands hold, joints whose
//! inertia is left out.
//!
//! Within a step they are unknowns like others and balance at its middle. What is written of an
//! instant, a row of a result file or an energy, shows them balanced at that instant: found here by
//! Newton's method over these coordinates alone. The state of the run is not touched, so that a run
//! does not depend on what is looked at.

use crate::layout::{Block, CoordinateKind, Layout};
use crate::linalg::solve_least_norm;
use crate::model::{Midpoint, Model};

/// Corrections before the search is given up.
const MAX_ITERATIONS: usize = 400;
/// How much of the stiffest entry the first correction adds to all.
const FIRST_FOLLOW: f64 = 1e-3;
/// Longest correction, in units of 1 rad or the model's length.
const FARTHEST: f64 = 0.25;

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
    /// stay. An error is the coordinate that is worst, and the force (N or N·m) left on it.
    ///
    /// Each correction follows the forces, (K + μD)δ = F with K = −∂F/∂q, and is taken if they have
    /// worked on the way: so the search ends in a balance that is stable. μ falls as corrections
    /// succeed, and near the balance they are Newton's.
    pub(crate) fn settle<M: Model>(
        &mut self,
        model: &mut M,
        q: &mut [f64],
        around: (f64, &[f64], &[f64]),
    ) -> Result<(), (usize, f64)> {
        let layout = model.layout().clone();
        let groups = std::mem::take(&mut self.groups);
        let mut outcome = Ok(());
        for (number, members) in &groups {
            let block = &layout.blocks[*number];
            if !self.settle_block(model, &layout, q, around, (block, members)) {
                let force = self.forces(model, q, around);
                let worst = members.iter().map(|&(_, c)| (c, force[c]));
                let worst = worst.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
                outcome = worst.map_or(Ok(()), Err);
                break;
            }
        }
        self.groups = groups;
        outcome
    }

    fn settle_block<M: Model>(
        &mut self,
        model: &mut M,
        layout: &Layout,
        q: &mut [f64],
        around: (f64, &[f64], &[f64]),
        (block, members): (&Block, &[(usize, usize)]),
    ) -> bool {
        let (width, count) = (block.coordinates.len(), members.len());
        let size = |c: usize| match layout.coordinates[c].kind {
            CoordinateKind::Angle => 1.0,
            CoordinateKind::Length => layout.length_scale,
        };
        let pick = |force: &[f64]| members.iter().map(|&(_, c)| force[c]).collect::<Vec<f64>>();
        let mut force = pick(self.forces(model, q, around));
        let (mut follow, mut idle) = (FIRST_FOLLOW, 0);
        for _ in 0..MAX_ITERATIONS {
            if force.iter().all(|f| *f == 0.0) {
                return true;
            }
            let slot = |i: usize, k: usize| block.matrix_offset + i * width + k;
            let mut system = vec![0.0; count * count];
            for (i, &(row, _)) in members.iter().enumerate() {
                for (k, &(column, _)) in members.iter().enumerate() {
                    system[i * count + k] = -self.matrix[slot(row, column)];
                }
            }
            if system.iter().chain(&force).any(|x| !x.is_finite()) {
                return false;
            }
            let stiffest =
                (0..count).map(|i| system[i * count + i].abs() * size(members[i].1).powi(2));
            let stiffest = stiffest.fold(0.0, f64::max);
            // Towards a balance that is stable: the forces must be felt as those of a bowl.
            let bare = system.clone();
            loop {
                system.copy_from_slice(&bare);
                for (i, &(_, c)) in members.iter().enumerate() {
                    system[i * count + i] += follow * stiffest / size(c).powi(2);
                }
                if follow > 1e6 || is_bowl(&system, count) {
                    break;
                }
                follow = (4.0 * follow).max(1e-4);
            }
            let mut step = solve_least_norm(&system, count, count, &force).x;
            let far = members.iter().zip(&step).map(|(&(_, c), x)| x.abs() / size(c));
            let far = far.fold(0.0, f64::max);
            let shorter = (FARTHEST / far).min(1.0);
            step.iter_mut().for_each(|x| *x *= shorter);
            let before: Vec<f64> = members.iter().map(|&(_, c)| q[c]).collect();
            members.iter().zip(&step).for_each(|(&(_, c), x)| q[c] += x);
            let next = pick(self.forces(model, q, around));
            let work: f64 = (0..count).map(|i| 0.5 * (force[i] + next[i]) * step[i]).sum();
            let (old, new) = (largest(&force), largest(&next));
            // Rounding alone is left: corrections that hardly change anything.
            if follow <= FIRST_FOLLOW && far <= 1e-9 && !(new < 0.5 * old) {
                idle += 1;
            }
            if idle == 3 || (follow == 0.0 && far <= 1e-15) {
                return true;
            }
            if (work >= 0.0 || new < 0.5 * old) && new.is_finite() {
                follow = if new < 0.5 * old { follow * 0.1 } else { follow * 0.5 };
                if follow < 1e-6 {
                    follow = 0.0;
                }
                force = next;
            } else {
                members.iter().zip(&before).for_each(|(&(_, c), x)| q[c] = *x);
                follow = (4.0 * follow).max(1e-4);
                // The matrix goes back with the coordinates.
                self.forces(model, q, around);
                if follow > 1e12 {
                    return false;
                }
            }
        }
        false
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

fn largest(force: &[f64]) -> f64 {
    force.iter().fold(0.0, |a: f64, f| if f.abs() <= a { a } else { f.abs() })
}

/// Whether no direction makes xᵀAx negative, by the pivots of the symmetric part.
fn is_bowl(matrix: &[f64], count: usize) -> bool {
    let mut a: Vec<f64> = (0..count * count)
        .map(|slot| 0.5 * (matrix[slot] + matrix[slot % count * count + slot / count]))
        .collect();
    let rounding = 1e-13 * (0..count).map(|i| a[i * count + i].abs()).fold(0.0, f64::max);
    for k in 0..count {
        let pivot = a[k * count + k];
        if pivot < -rounding {
            return false;
        }
        if pivot <= rounding {
            // Nothing resists here, so nothing may be coupled to it either.
            if (k + 1..count).any(|i| a[i * count + k].abs() > rounding) {
                return false;
            }
            continue;
        }
        for i in k + 1..count {
            let factor = a[i * count + k] / pivot;
            for j in k..count {
                a[i * count + j] -= factor * a[k * count + j];
            }
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::is_bowl;

    #[test]
    fn bowls_are_told_from_saddles() {
        assert!(is_bowl(&[2.0, 1.0, 1.0, 2.0], 2));
        assert!(is_bowl(&[2.0, 0.0, 0.0, 0.0], 2));
        assert!(!is_bowl(&[1.0, 2.0, 2.0, 1.0], 2));
        assert!(!is_bowl(&[0.0, 1.0, 1.0, 0.0], 2));
        // A part that turns does not matter.
        assert!(is_bowl(&[1.0, 5.0, -5.0, 1.0], 2));
    }
}
