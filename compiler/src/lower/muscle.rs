//! Muscles.

use super::Lowering;
use handc_dsl::hir;
use handc_runtime::mechanism::{Mechanism, Muscle, Number};

impl Lowering<'_> {
    pub(super) fn muscle(&mut self, muscle: &hir::Muscle) -> Muscle {
        let [
            max_force,
            optimal_fibre,
            tendon_slack,
            pennation,
            max_velocity,
            tendon_strain,
            passive_strain,
            eccentric_force,
            fibre_damping,
            activation_time,
            deactivation_time,
        ] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10].map(|i: usize| self.number(&muscle.numbers[i]));
        Muscle {
            fibre: muscle.fibre.0,
            activation: muscle.activation.0,
            excitation: muscle.excitation.0,
            start: muscle.start.as_ref().map(|start| self.number(start)),
            max_force,
            optimal_fibre,
            tendon_slack,
            pennation,
            max_velocity,
            tendon_strain,
            passive_strain,
            eccentric_force,
            fibre_damping,
            activation_time,
            deactivation_time,
        }
    }
}

/// Where muscles begin: with their activation if it is given, and from the optimal fibre length, from
/// which a run seeks the balance.
pub(super) fn begin(mechanism: &mut Mechanism) {
    for strand in &mechanism.strands {
        let Some(muscle) = strand.muscle() else { continue };
        mechanism.coordinates[muscle.fibre as usize].start = muscle.optimal_fibre;
        mechanism.coordinates[muscle.activation as usize].start =
            muscle.start.unwrap_or(Number::ZERO);
    }
}
