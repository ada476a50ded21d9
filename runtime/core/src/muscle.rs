//! What muscles are told: excitations and activations lie between 0 and 1.

use crate::layout::{Layout, Muscle};
use crate::model::Model;

/// Rounding that an excitation may be out of its range by.
const ROUNDING: f64 = 1e-12;

fn is_out(share: f64) -> bool {
    !(-ROUNDING..=1.0 + ROUNDING).contains(&share)
}

/// The first muscle whose excitation, or activation where that is given, is not between 0 and 1.
pub(crate) fn out_of_range<M: Model>(
    model: &M,
    (q, driven): (&[f64], &[bool]),
    inputs: &[f64],
) -> Option<String> {
    let mut muscles = model.layout().muscles();
    muscles.find_map(|(name, muscle)| {
        let (is_given, a) = (driven[muscle.activation], q[muscle.activation]);
        let (what, share) = match is_given && is_out(a) {
            true => ("activation", a),
            false => ("excitation", inputs[muscle.excitation]),
        };
        is_out(share)
            .then(|| format!("the {what} of muscle `{name}` is {share}, not between 0 and 1"))
    })
}

/// What a run tells its muscles: for each the input that excites it, and the coordinate that is its
/// activation where that is given instead.
#[derive(Clone, Debug, Default)]
pub(crate) struct Excitations(Vec<(usize, Option<usize>)>);

impl Excitations {
    /// Where the coordinates marked in `driven` are given.
    pub(crate) fn new(layout: &Layout, driven: &[bool]) -> Self {
        let of = |(_, muscle): (_, &Muscle)| {
            (muscle.excitation, Some(muscle.activation).filter(|&a| driven[a]))
        };
        Excitations(layout.muscles().map(of).collect())
    }

    /// How many steps can be told so until one of them is not between 0 and 1; lists of as many rows as
    /// there are `steps`. [`out_of_range`] says what is not.
    #[inline]
    pub(crate) fn in_range(&self, inputs: &[f64], q: &[f64], steps: usize) -> usize {
        let until = |list: &[f64], column: usize| {
            let of_muscle = list.iter().skip(column).step_by((list.len() / steps).max(1));
            of_muscle.take(steps).position(|&share| is_out(share)).unwrap_or(steps)
        };
        let of = |&(excitation, activation): &(usize, Option<usize>)| {
            let given = activation.map_or(steps, |a| until(q, a));
            until(inputs, excitation).min(given)
        };
        self.0.iter().map(of).min().unwrap_or(steps)
    }
}
