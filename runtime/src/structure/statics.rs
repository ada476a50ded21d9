//! Coordinates in static equilibrium.

use super::Structure;
use crate::expression::{Function, Variable};
use crate::mechanism::Mechanism;

impl Structure {
    /// Coordinates of nodes that carry no mass, have no damping, are held by no constraint and of
    /// whose rates no force depends: nothing of them is left in a step but that forces balance.
    pub(super) fn find_statics(&mut self, mechanism: &Mechanism) {
        let mut is_static: Vec<bool> = mechanism
            .coordinates
            .iter()
            .enumerate()
            .map(|(c, coordinate)| {
                let has_mass = self.has_mass_below[self.link_of[c] as usize];
                coordinate.is_node && !has_mass && coordinate.damping.is_zero()
            })
            .collect();
        let mut moving = Vec::new();
        for (strand, path) in mechanism.strands.iter().zip(&self.strands) {
            if strand.has_rate() {
                moving.extend(&path.coordinates);
            }
        }
        for constraint in &mechanism.constraints {
            moving.extend(self.constraint_coordinates(&constraint.kind));
        }
        let functions = mechanism.torques.iter().map(|torque| &torque.value);
        let functions = functions.chain(mechanism.forces.iter().flat_map(|force| &force.value));
        moving.extend(functions.chain(tensions(mechanism)).flat_map(rates));
        moving.into_iter().for_each(|c| is_static[c] = false);
        self.is_static = is_static;
    }
}

fn tensions(mechanism: &Mechanism) -> impl Iterator<Item = &Function> {
    mechanism.strands.iter().filter_map(|strand| match &strand.law {
        crate::mechanism::Law::Tension(function) => Some(function),
        _ => None,
    })
}

/// Coordinates whose rates a function depends on.
fn rates(function: &Function) -> impl Iterator<Item = usize> {
    function.gradient.iter().filter_map(|variable| match variable {
        Variable::Rate(i) => Some(*i as usize),
        _ => None,
    })
}
