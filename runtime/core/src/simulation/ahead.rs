//! What is handed over to lanes in the steps to come, so that steps that are told something new each
//! time can be taken in one go too.

use super::Simulation;
use crate::lanes::Told;
use crate::model::Model;

/// Inputs, natural lengths and kinematic coordinates of steps to come, step after step; lists of what
/// is not fed are empty.
#[derive(Clone, Debug, Default)]
pub(super) struct Ahead {
    /// How many steps.
    steps: usize,
    inputs: Vec<f64>,
    rest: Vec<f64>,
    ends: Vec<f64>,
}

/// The numbers of step `k`, of `steps` that are in the list.
fn row(list: &[f64], k: usize, steps: usize) -> &[f64] {
    let width = list.len() / steps;
    &list[k * width..][..width]
}

/// Makes a list that many rows of numbers, which are written over where they change.
fn repeat(list: &mut Vec<f64>, row: &[f64], rows: usize, is_fed: bool) {
    list.clear();
    for _ in 0..if is_fed { rows } else { 0 } {
        list.extend_from_slice(row);
    }
}

impl Ahead {
    /// What the steps are told, if any may be taken; where nothing changes there is one row for all.
    pub(super) fn told(&self) -> Option<Told<'_>> {
        let Ahead { steps, inputs, rest, ends } = self;
        (*steps > 0).then_some(Told { steps: *steps, inputs, rest, ends })
    }
}

impl<M: Model> Simulation<M> {
    /// Looks ahead to up to `count` steps; lanes measure what follows motions themselves. Returns how
    /// many steps may be taken in one go: none where the next one cannot be taken.
    pub(crate) fn look_ahead(&mut self, count: usize) -> usize {
        self.ahead.steps = 0;
        if count == 0 {
            return 0;
        }
        let Simulation { model, feed, excitations, ahead, state, h, .. } = self;
        // What never changes is told once for all steps.
        let rows = if feed.varies { count } else { 1 };
        let Ahead { steps, inputs, rest, ends } = ahead;
        // Inputs are written whole, row by row; of the others what is given.
        inputs.resize(rows * self.inputs.len(), 0.0);
        repeat(rest, &self.rest, rows, feed.has_rests);
        repeat(ends, &self.driven_q, rows, feed.has_paths);
        let [of_inputs, of_rest, of_ends] = [&*inputs, &*rest, &*ends].map(|l| l.len() / rows);
        let mut begin = state.t;
        for k in 0..rows {
            let end = (state.step + k + 1) as f64 * *h;
            let t = 0.5 * (begin + end);
            let inputs = &mut inputs[k * of_inputs..][..of_inputs];
            let ends = &mut ends[k * of_ends..][..of_ends];
            feed.inputs(model, t, inputs);
            feed.rests(model, t, inputs, &mut rest[k * of_rest..][..of_rest]);
            feed.paths(model, end, ends);
            begin = end;
        }
        *steps = excitations.in_range(inputs, ends, rows);
        for list in [inputs, rest, ends] {
            list.truncate(list.len() / rows * *steps);
        }
        if feed.varies { *steps } else { *steps * count }
    }

    /// What the next steps are told, as [`Simulation::look_ahead`] has found it.
    pub(crate) fn told(&self) -> Option<Told<'_>> {
        self.ahead.told()
    }

    /// After so many of the steps: what was told in the last of them is what was last fed.
    pub(super) fn catch_up(&mut self, taken: usize) {
        if !self.feed.varies {
            return;
        }
        let Some(Told { steps, inputs, rest, ends }) = self.ahead.told() else { return };
        let last = taken - 1;
        if self.feed.has_paths {
            if let Some(before) = last.checked_sub(1) {
                let before = row(ends, before, steps);
                let driven = self.state.q.iter_mut().zip(before).zip(&self.driven);
                driven.filter(|(_, driven)| **driven).for_each(|((q, &end), _)| *q = end);
            }
            self.driven_q.copy_from_slice(row(ends, last, steps));
        }
        if self.feed.has_rests {
            self.rest.copy_from_slice(row(rest, last, steps));
        }
        self.inputs.copy_from_slice(row(inputs, last, steps));
    }
}
