//! Coordinates that move no mass, at an instant: those in static equilibrium, massless nodes that
//! strands hold and joints whose inertia is left out; and internal variables.
//!
//! Within a step they are unknowns like others and balance at its middle. What is written of an
//! instant, a row of a result file or an energy, shows them balanced at that instant: found here by
//! Newton's method over these coordinates alone. An internal variable is taken from the middle of the
//! step just ended to the instant by one implicit step of half the length, which is exact to second
//! order and forgets what is fast. The state of the run is not touched, so that a run does not depend
//! on what is looked at. A run begins with all of them at rest.

use crate::internal::RATE;
use crate::layout::{CoordinateKind, Layout};
use crate::linalg::solve_least_norm;
use crate::model::{Midpoint, Model};

/// Corrections before the search is given up.
const MAX_ITERATIONS: usize = 400;
/// How much of the stiffest entry the first correction adds to all.
const FIRST_FOLLOW: f64 = 1e-3;
/// Longest correction, in units of 1 rad or the model's length.
const FARTHEST: f64 = 0.25;

/// The step for which a Newton matrix holds stiffness alone, and the one for which it holds damping
/// alone: powers of two, by which nothing is rounded.
const LONG_STEP: f64 = (1u64 << 50) as f64;
const SHORT_STEP: f64 = 1.0 / LONG_STEP;
/// The first step of internal variables towards rest (s).
const FIRST_STEP: f64 = 0.01;

/// What is given at an instant: time (s), natural lengths (m), inputs.
type Given<'a> = (f64, &'a [f64], &'a [f64]);

/// Coordinates of one block.
#[derive(Clone, Debug)]
struct Group {
    /// The block by number.
    block: usize,
    /// Position in the block and index of each.
    members: Vec<(usize, usize)>,
    /// Whether any is internal.
    has_internal: bool,
}

/// Finds the balance; owns its scratch.
#[derive(Clone, Debug, Default)]
pub(crate) struct Statics {
    groups: Vec<Group>,
    /// Which coordinates are internal.
    is_internal: Vec<bool>,
    /// Where coordinates were at the middle of the step.
    middle: Vec<f64>,
    v: Vec<f64>,
    momentum: Vec<f64>,
    force: Vec<f64>,
    matrix: Vec<f64>,
    /// What the last balance was found for, and where it was: a row of results asks several times.
    asked: Vec<f64>,
    answer: Vec<f64>,
}

impl Statics {
    /// For a model whose coordinates marked in `driven` have their path given.
    pub(crate) fn new(layout: &Layout, driven: &[bool]) -> Self {
        let mut list = layout.statics(driven);
        let internals = layout.internals(driven);
        list.extend(&internals);
        let mut statics = Statics::default();
        if list.is_empty() {
            return statics;
        }
        let n = layout.coordinates.len();
        statics.is_internal = (0..n).map(|c| internals.contains(&c)).collect();
        for block in 0..layout.blocks.len() {
            statics.groups.extend(statics.group(layout, block, |c| list.contains(&c)));
        }
        statics.middle = vec![0.0; n];
        statics.v = vec![0.0; n];
        statics.momentum = vec![0.0; n];
        statics.force = vec![0.0; n];
        statics.matrix = vec![0.0; layout.matrix_size()];
        statics
    }

    /// Whether there are none.
    pub(crate) fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    /// Those of a block that are `wanted`, if there are any.
    fn group(
        &self,
        layout: &Layout,
        block: usize,
        wanted: impl Fn(usize) -> bool,
    ) -> Option<Group> {
        let all = layout.blocks[block].coordinates.iter().copied().enumerate();
        let members: Vec<_> = all.filter(|&(_, c)| wanted(c)).collect();
        let has_internal = members.iter().any(|&(_, c)| self.is_internal[c]);
        (!members.is_empty()).then_some(Group { block, members, has_internal })
    }

    /// Moves the coordinates of `q` to where the forces on them vanish at rest, but those in `held`;
    /// those that nothing pulls stay. An error is the coordinate that is worst, and the force (N or
    /// N·m) left on it.
    pub(crate) fn rest<M: Model>(
        &mut self,
        model: &mut M,
        q: &mut [f64],
        held: &[usize],
        given: Given,
    ) -> Result<(), (usize, f64)> {
        let layout = model.layout().clone();
        let groups: Vec<Group> = self
            .groups
            .iter()
            .filter_map(|group| {
                let wanted = |c| group.members.iter().any(|m| m.1 == c) && !held.contains(&c);
                self.group(&layout, group.block, wanted)
            })
            .collect();
        for group in &groups {
            if group.has_internal {
                self.relax(model, q, group, given);
            }
            self.settle_group(model, q, f64::INFINITY, group, given)?;
        }
        Ok(())
    }

    /// Moves the coordinates of `q` from the middle of a step of length `h` to the instant at its
    /// end. An error is as that of [`Statics::rest`].
    pub(crate) fn settle<M: Model>(
        &mut self,
        model: &mut M,
        q: &mut [f64],
        h: f64,
        given: Given,
    ) -> Result<(), (usize, f64)> {
        let (t, rest, inputs) = given;
        let numbers = [&[h, t], &*q, rest, inputs, model.params()];
        if self.asked.iter().eq(numbers.iter().copied().flatten()) {
            q.copy_from_slice(&self.answer);
            return Ok(());
        }
        self.asked.clear();
        let asked = numbers.concat();
        let groups = std::mem::take(&mut self.groups);
        self.middle.copy_from_slice(q);
        let mut ends =
            groups.iter().map(|group| self.settle_group(model, q, 0.5 * h, group, given));
        let outcome = ends.find(Result::is_err).unwrap_or(Ok(()));
        self.groups = groups;
        if outcome.is_ok() {
            (self.asked, self.answer) = (asked, q.to_vec());
        }
        outcome
    }

    /// Rates of the internal coordinates at q, into `v`; as they are where none balances them.
    pub(crate) fn rates<M: Model>(
        &mut self,
        model: &mut M,
        q: &[f64],
        v: &mut [f64],
        given: Given,
    ) {
        let layout = model.layout().clone();
        for block in 0..layout.blocks.len() {
            let Some(group) = self.group(&layout, block, |c| self.is_internal[c]) else { continue };
            self.v.fill(0.0);
            let mut before = f64::INFINITY;
            for _ in 0..MAX_ITERATIONS {
                self.evaluate(model, q, SHORT_STEP, given);
                let force = self.forces(&group);
                let largest = largest(&force);
                if !(largest < before) {
                    break;
                }
                before = largest;
                group.members.iter().for_each(|&(_, c)| v[c] = self.v[c]);
                let Some(change) = self.solve(&layout, &group, 0.5 * RATE, &force) else { break };
                group.members.iter().zip(change).for_each(|(&(_, c), x)| self.v[c] += x);
            }
        }
    }

    /// Goes towards rest by implicit steps that grow, each of one Newton iteration: an internal
    /// variable far from its balance, where it may have no stiffness at all, goes as its own rate
    /// lets it.
    fn relax<M: Model>(&mut self, model: &mut M, q: &mut [f64], group: &Group, given: Given) {
        let layout = model.layout().clone();
        self.v.fill(0.0);
        let (mut step, mut before) = (FIRST_STEP, f64::INFINITY);
        let mut last = q.to_vec();
        for _ in 0..MAX_ITERATIONS {
            self.evaluate(model, q, step, given);
            let force = self.forces(group);
            let found = largest(&force);
            if found == 0.0 || step > LONG_STEP {
                return;
            }
            if !found.is_finite() {
                q.copy_from_slice(&last);
                step *= 0.125;
                continue;
            }
            last.copy_from_slice(q);
            let Some(change) = self.solve(&layout, group, 0.25 * step, &force) else { return };
            group.members.iter().zip(change).for_each(|(&(_, c), x)| q[c] += x);
            step = if found < before { 2.0 * step } else { (0.5 * step).max(FIRST_STEP) };
            before = found;
        }
    }

    /// Moves the coordinates of a group to where the forces vanish a time `ahead` of the middle, at
    /// rest if that is infinite.
    ///
    /// Each correction follows the forces, (K + μD)δ = F with K = −∂F/∂q, and is taken if they have
    /// worked on the way: so the search ends in a balance that is stable. μ falls as corrections
    /// succeed, and near the balance they are Newton's.
    fn settle_group<M: Model>(
        &mut self,
        model: &mut M,
        q: &mut [f64],
        ahead: f64,
        group: &Group,
        given: Given,
    ) -> Result<(), (usize, f64)> {
        let layout = model.layout().clone();
        let (block, members) = (&layout.blocks[group.block], &group.members);
        let (width, count) = (block.coordinates.len(), members.len());
        let size = |c: usize| match layout.coordinates[c].kind {
            CoordinateKind::Angle | CoordinateKind::Ratio => 1.0,
            CoordinateKind::Length => layout.length_scale,
        };
        // With this step the Newton matrix is the derivative by q where internal rates follow it.
        let step_size = if group.has_internal { (2.0 * RATE * ahead).min(LONG_STEP) } else { 4.0 };
        let mut force = self.look(model, q, (ahead, step_size), group, given);
        // Internal variables come from near.
        let (mut follow, mut idle) = (if group.has_internal { 0.0 } else { FIRST_FOLLOW }, 0);
        for _ in 0..MAX_ITERATIONS {
            if force.iter().all(|f| *f == 0.0) {
                return Ok(());
            }
            let slot = |i: usize, k: usize| block.matrix_offset + i * width + k;
            let mut system = vec![0.0; count * count];
            for (i, &(row, _)) in members.iter().enumerate() {
                for (k, &(column, _)) in members.iter().enumerate() {
                    system[i * count + k] = -self.matrix[slot(row, column)] * (4.0 / step_size);
                }
            }
            if system.iter().chain(&force).any(|x| !x.is_finite()) {
                break;
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
            let next = self.look(model, q, (ahead, step_size), group, given);
            let work: f64 = (0..count).map(|i| 0.5 * (force[i] + next[i]) * step[i]).sum();
            let (old, new) = (largest(&force), largest(&next));
            // Rounding alone is left: corrections that hardly change anything.
            if follow <= FIRST_FOLLOW && far <= 1e-9 && !(new < 0.5 * old) {
                idle += 1;
            }
            // What Newton's method has moved so little it does not move again.
            let enough = if group.has_internal { 1e-9 } else { 1e-15 };
            if idle == 3 || (follow == 0.0 && far <= enough) {
                return Ok(());
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
                self.look(model, q, (ahead, step_size), group, given);
                if follow > 1e12 {
                    break;
                }
            }
        }
        let force = self.look(model, q, (ahead, step_size), group, given);
        let worst = members.iter().zip(force).map(|(&(_, c), force)| (c, force));
        worst.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).map_or(Ok(()), Err)
    }

    /// Forces on a group a time `ahead` of the middle, where internal rates lead there; and the Newton
    /// matrix of a step.
    fn look<M: Model>(
        &mut self,
        model: &mut M,
        q: &[f64],
        (ahead, step): (f64, f64),
        group: &Group,
        given: Given,
    ) -> Vec<f64> {
        self.v.fill(0.0);
        for &(_, c) in group.members.iter().filter(|(_, c)| self.is_internal[*c]) {
            self.v[c] = (q[c] - self.middle[c]) / ahead;
        }
        self.evaluate(model, q, step, given);
        self.forces(group)
    }

    /// Solves Newton matrix · x = −`weight`·force; `None` if something is not finite.
    fn solve(
        &self,
        layout: &Layout,
        group: &Group,
        weight: f64,
        force: &[f64],
    ) -> Option<Vec<f64>> {
        let (block, members) = (&layout.blocks[group.block], &group.members);
        let width = block.coordinates.len();
        let entry = |i: usize, j: usize| self.matrix[block.matrix_offset + i * width + j];
        let pairs = members.iter().flat_map(|&(i, _)| members.iter().map(move |&(j, _)| (i, j)));
        let system: Vec<f64> = pairs.map(|(i, j)| entry(i, j)).collect();
        let rhs: Vec<f64> = force.iter().map(|f| -weight * f).collect();
        let is_finite = system.iter().chain(&rhs).all(|x| x.is_finite());
        is_finite.then(|| solve_least_norm(&system, members.len(), members.len(), &rhs).x)
    }

    fn forces(&self, group: &Group) -> Vec<f64> {
        group.members.iter().map(|&(_, c)| self.force[c]).collect()
    }

    /// Forces at q with the rates at hand, and the Newton matrix of a step.
    fn evaluate<M: Model>(&mut self, model: &mut M, q: &[f64], step: f64, given: Given) {
        let (t, rest, inputs) = given;
        let at = Midpoint { q, v: &self.v, t, rest, inputs };
        let (momentum, force) = (&mut self.momentum, &mut self.force);
        model.evaluate_with_matrix(&at, step, momentum, force, &mut self.matrix);
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
