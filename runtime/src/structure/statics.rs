//! Coordinates that move no mass: in static equilibrium, or internal.

use super::{Structure, Tree};
use crate::expression::{Function, Variable};
use crate::mechanism::{Mechanism, Role};

impl Structure {
    /// Dynamic coordinates of a tree.
    fn tree_coordinates(&self, mechanism: &Mechanism, tree: &Tree) -> Vec<usize> {
        let of_runs = tree.runs.iter().flat_map(|&run| &self.runs[run].links);
        let links = tree.links.iter().chain(of_runs);
        let coordinates = links.map(|&link| self.coordinate_of[link as usize]);
        coordinates.filter(|&c| mechanism.coordinates[c].drive.is_none()).collect()
    }

    /// Coordinates that quasi-static strands span.
    fn quasi_static(&self, mechanism: &Mechanism) -> Vec<bool> {
        let mut spanned = vec![false; self.count];
        for (strand, path) in mechanism.strands.iter().zip(&self.strands) {
            if strand.quasi_static {
                path.coordinates.iter().for_each(|&c| spanned[c] = true);
            }
        }
        spanned
    }

    /// Coordinates that keep their inertia though a quasi-static strand spans them, since another
    /// coordinate that moves the same matter is spanned by none: of each tree, one of the first kind
    /// and all of the second.
    pub fn half_static(&self, mechanism: &Mechanism) -> Vec<(usize, Vec<usize>)> {
        let spanned = self.quasi_static(mechanism);
        let mut found = Vec::new();
        for tree in self.trees.iter().filter(|tree| !tree.is_static) {
            let own = self.tree_coordinates(mechanism, tree);
            if let Some(&first) = own.iter().find(|&&c| spanned[c]) {
                found.push((first, own.into_iter().filter(|&c| !spanned[c]).collect()));
            }
        }
        found
    }

    /// Coordinates that move matter whose inertia is left out.
    pub fn without_inertia(&self, mechanism: &Mechanism) -> Vec<usize> {
        let trees = self.trees.iter().filter(|tree| tree.is_static);
        trees.flat_map(|tree| self.tree_coordinates(mechanism, tree)).collect()
    }

    /// Coordinates of nodes that carry no mass and of trees whose inertia is left out, that have no
    /// damping, are held by no constraint and of whose rates no force depends: nothing of them is
    /// left in a step but that forces balance.
    pub(super) fn find_statics(&mut self, mechanism: &Mechanism) {
        let spanned = self.quasi_static(mechanism);
        let mut is_still = vec![false; self.count];
        for index in 0..self.trees.len() {
            let own = self.tree_coordinates(mechanism, &self.trees[index]);
            if !own.is_empty() && own.iter().all(|&c| spanned[c]) {
                self.trees[index].is_static = true;
                own.into_iter().for_each(|c| is_still[c] = true);
            }
        }
        let mut is_static: Vec<bool> = mechanism
            .coordinates
            .iter()
            .enumerate()
            .map(|(c, coordinate)| {
                let has_mass = self.link_of[c].is_some_and(|l| self.has_mass_below[l as usize]);
                let weightless = is_still[c] || (coordinate.role == Role::Node && !has_mass);
                weightless && coordinate.damping.is_zero()
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

    /// Coordinates of the muscles.
    pub(super) fn find_internals(&mut self, mechanism: &Mechanism) {
        for muscle in mechanism.strands.iter().filter_map(|strand| strand.muscle()) {
            for c in [muscle.fibre, muscle.activation] {
                self.is_internal[c as usize] = true;
            }
        }
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
