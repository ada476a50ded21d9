//! What muscles are told: excitations and activations lie between 0 and 1, and the numbers that a
//! muscle is made of in their ranges.

use crate::model::Model;

/// The numbers of a muscle that must be positive, in the order of [`Model::muscle_numbers`].
pub const NUMBERS: [&str; 11] = [
    "max_force",
    "optimal_fibre",
    "tendon_slack",
    "90 deg - pennation",
    "max_velocity",
    "tendon_strain",
    "passive_strain",
    "eccentric_force - 1",
    "fibre_damping",
    "activation_time",
    "deactivation_time",
];

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

/// The first muscle with a number out of its range.
pub(crate) fn wrong_number<M: Model>(model: &mut M) -> Option<String> {
    let layout = model.layout().clone();
    let mut numbers = vec![1.0; NUMBERS.len() * layout.muscles().count()];
    model.muscle_numbers(&mut numbers);
    let mut muscles = layout.muscles().zip(numbers.chunks(NUMBERS.len()));
    muscles.find_map(|((name, _), numbers)| {
        let mut numbers = NUMBERS.iter().zip(numbers);
        let (what, value) = numbers.find(|(what, value)| {
            // Without damping a muscle is as it was published.
            if **what == "fibre_damping" { !(**value >= 0.0) } else { !(**value > 0.0) }
        })?;
        let need = if *what == "fibre_damping" { "not negative" } else { "positive" };
        Some(format!("muscle `{name}`: `{what}` is {value} and must be {need}"))
    })
}
