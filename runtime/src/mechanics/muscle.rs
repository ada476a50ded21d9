//! Muscles: the balance of fibres and tendon, and the activation.
//!
//! A muscle's strand pulls with the force of its tendon, whose length is that of the strand less s,
//! the fibres' length along it. What is added here are the equations of the two coordinates without
//! mass: T(x − s) − F(s, ṡ, a) = 0 and ȧ = (u − a)/τ(u, a), solved by a step with all others.

use super::law::Pull;
use super::{At, Mechanics, Terms, Workspace};
use crate::expression::{StrandQuantity, StrandState};
use crate::mechanism::Muscle;
use handc_core::internal::RATE;
use handc_core::scalar::Scalar;

impl<S: Scalar> Mechanics<'_, S> {
    /// The tendon of a muscle whose strand has length x.
    pub(super) fn pull_of_tendon(
        &self,
        at: &At<S>,
        index: usize,
        muscle: &Muscle,
        length: S,
        pull: &mut Pull<S>,
    ) {
        let Some(numbers) = self.numbers.strands[index].muscle else { return };
        let s = at.q[muscle.fibre as usize];
        let tendon = numbers.tendon(length - s);
        pull.tension = tendon.value;
        pull.length_slope = tendon.slope;
        pull.dq.push((muscle.fibre as usize, -tendon.slope));
        pull.taut = numbers.tendon_taut(length - s);
    }

    /// Adds the forces on fibre lengths and activations; strand lengths must be current.
    pub(super) fn add_muscles(&self, workspace: &Workspace<S>, at: &At<S>, terms: &mut Terms<S>) {
        for (index, strand) in self.mechanism.strands.iter().enumerate() {
            let (Some(muscle), Some(numbers)) =
                (strand.muscle(), self.numbers.strands[index].muscle)
            else {
                continue;
            };
            let (fibre, activation) = (muscle.fibre as usize, muscle.activation as usize);
            let (s, a) = (at.q[fibre], at.q[activation]);
            let tendon = numbers.tendon(workspace.strand.lengths[index] - s);
            let fibres = numbers.fibres(s, at.v[fibre], a);
            let rate = numbers.activation(at.inputs[muscle.excitation as usize], a);
            terms.force[fibre] += tendon.value - fibres.force;
            let action = numbers.action();
            terms.force[activation] += action * (rate.value - at.v[activation]);
            let Some((h, _)) = terms.matrix else { continue };
            let (quarter, half) = (h.scale(0.25), S::constant(0.5 * RATE));
            let [by_s, by_rate, by_a] = fibres.by;
            let own = -(quarter * (tendon.slope + by_s) + half * by_rate);
            self.add_entry(fibre, fibre, own, terms);
            self.add_entry(activation, activation, action * (quarter * rate.slope - half), terms);
            self.add_entry(fibre, activation, -(quarter * by_a), terms);
            let path = &self.structure.strands[index];
            let length_dq = &workspace.strand.length_dq[path.span.clone()];
            for (&column, &dq) in path.coordinates.iter().zip(length_dq) {
                self.add_entry(fibre, column, quarter * tendon.slope * dq, terms);
            }
        }
    }

    /// What a strand's state tells of its muscle, if it is one; the tension is that of the tendon.
    pub(super) fn see_muscle(&self, at: &At<S>, index: usize, state: &mut StrandState<S>) {
        let (Some(muscle), Some(numbers)) =
            (self.mechanism.strands[index].muscle(), self.numbers.strands[index].muscle)
        else {
            return;
        };
        let (fibre, a) = (muscle.fibre as usize, at.q[muscle.activation as usize]);
        let fibres = numbers.fibres(at.q[fibre], at.v[fibre], a);
        state[StrandQuantity::FibreLength as usize] = fibres.length;
        state[StrandQuantity::FibreForce as usize] = fibres.pull;
        state[StrandQuantity::FibrePower as usize] = fibres.power;
        state[StrandQuantity::Dissipation as usize] += fibres.dissipation;
    }
}
