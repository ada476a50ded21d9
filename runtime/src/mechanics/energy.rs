//! Potential energy and the mass matrix.

use super::segment::Order;
use super::{Mechanics, Workspace};
use crate::vector::Vec3;
use handc_core::scalar::Scalar;

impl<S: Scalar> Mechanics<'_, S> {
    /// Potential energy (J) at q: gravity −m g·p of every body, strands, springs and stops.
    pub fn potential(&self, workspace: &mut Workspace<S>, q: &[S], rest: &[S]) -> S {
        self.prepare(workspace, q);
        let mut energy = self.joint_potential(q);
        for index in 0..self.numbers.strands.len() {
            self.strand_length(workspace, q, index, Order::Length);
            energy += self.strand_energy(index, q, workspace.strand.lengths[index], rest[index]);
        }
        let Some(gravity) = self.numbers.gravity else { return energy };
        self.world_links(workspace, q, |link| self.structure.has_mass_below[link]);
        for (link, lump) in self.numbers.lumps.iter().enumerate() {
            if let Some(lump) = lump {
                let center = workspace.world[link].transform.point(lump.center);
                energy -= lump.mass * gravity.dot(center);
            }
        }
        for body in self.mechanism.bodies.iter().filter(|b| b.link.is_none()) {
            let center: Vec3<S> = self.numbers.vector(&body.center);
            energy -= self.numbers.number(body.mass) * gravity.dot(center);
        }
        energy
    }

    /// Mass matrix at q over the dynamic coordinates, packed by block (kg·m², kg·m or kg).
    pub fn mass_matrix(&self, workspace: &mut Workspace<S>, q: &[S], matrix: &mut [S]) {
        // At rest momenta do not change with the coordinates.
        let rest = vec![S::zero(); self.structure.count];
        self.momentum_matrix(workspace, q, &rest, S::one(), matrix);
    }

    /// By how much momenta change with the increment of a step 1/`by_h` at its midpoint: M/h + ½∂p/∂q,
    /// packed as the mass matrix.
    pub fn momentum_matrix(
        &self,
        workspace: &mut Workspace<S>,
        q: &[S],
        v: &[S],
        by_h: S,
        matrix: &mut [S],
    ) {
        matrix.fill(S::zero());
        self.prepare(workspace, q);
        self.add_momentum_matrix(workspace, q, v, by_h, matrix);
    }
}
