//! What is handed over to lanes in the steps to come, so that steps that are told something new each
//! time can be taken in one go too.

use super::Simulation;
use super::drives;
use crate::lanes::Told;
use crate::model::Model;

/// Inputs, natural lengths and driven coordinates of steps to come, step after step.
#[derive(Clone, Debug, Default)]
pub(super) struct Ahead {
    /// How many steps.
    count: usize,
    inputs: Vec<f64>,
    rest: Vec<f64>,
    driven_q: Vec<f64>,
}

/// The numbers of step `k`, of `count` that are in the list.
fn row(list: &[f64], k: usize, count: usize) -> &[f64] {
    let width = list.len() / count;
    &list[k * width..][..width]
}

impl Ahead {
    /// What step `k` is told, if so much is known; where nothing changes only the first.
    pub(super) fn told(&self, k: usize) -> Option<Told<'_>> {
        let of = |list| row(list, k, self.count);
        (k < self.count).then(|| Told {
            inputs: of(&self.inputs),
            rest: of(&self.rest),
            driven_q: of(&self.driven_q),
        })
    }

    fn clear(&mut self) {
        self.count = 0;
        self.inputs.clear();
        self.rest.clear();
        self.driven_q.clear();
    }
}

impl<M: Model> Simulation<M> {
    /// Looks ahead to up to `count` steps; lanes measure what follows motions themselves. Returns how
    /// many steps may be taken in one go: none where the next one cannot be taken.
    pub(crate) fn look_ahead(&mut self, count: usize) -> usize {
        let mut ahead = std::mem::take(&mut self.ahead);
        ahead.clear();
        // What never changes is told once for all steps.
        let rows = if self.is_told { count } else { 1 };
        let mut begin = self.state.t;
        for k in 0..rows {
            let end = (self.state.step + k + 1) as f64 * self.h;
            if self.is_fed {
                self.feed_but_follow(0.5 * (begin + end));
            }
            if self.is_driven {
                drives(&mut self.model, self.scenario, end, &mut self.driven_q);
            }
            if self.is_muscular && self.excitable().is_err() {
                break;
            }
            ahead.inputs.extend_from_slice(&self.inputs);
            ahead.rest.extend_from_slice(&self.rest);
            ahead.driven_q.extend_from_slice(&self.driven_q);
            ahead.count += 1;
            begin = end;
        }
        let possible = if self.is_told { ahead.count } else { ahead.count * count };
        self.ahead = ahead;
        possible
    }

    /// What step `k` from here is told, as [`Ahead::told`].
    pub(crate) fn told(&self, k: usize) -> Option<Told<'_>> {
        self.ahead.told(k)
    }

    /// After so many of the steps: what was told in the last of them is what was last fed.
    pub(super) fn catch_up(&mut self, taken: usize) {
        if !self.is_told {
            return;
        }
        if let Some(before) = taken.checked_sub(2).and_then(|k| self.ahead.told(k)) {
            for (i, &q) in before.driven_q.iter().enumerate().filter(|(i, _)| self.driven[*i]) {
                self.state.q[i] = q;
            }
        }
        let Some(Told { inputs, rest, driven_q }) = self.ahead.told(taken - 1) else { return };
        self.inputs.copy_from_slice(inputs);
        self.rest.copy_from_slice(rest);
        self.driven_q.copy_from_slice(driven_q);
    }
}
