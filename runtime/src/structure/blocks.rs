//! Blocks of the step equations: which coordinates a step couples.

use super::Structure;
use crate::expression::{Function, Variable};
use crate::mechanism::{ConstraintKind, Law, Mechanism};
use crate::resolved::constraint_points;
use handc_core::layout::Block;

impl Structure {
    /// Coordinates that a function of the state moves with.
    pub fn function_coordinates(&self, function: &Function) -> Vec<usize> {
        let mut coordinates = Vec::new();
        for variable in &function.gradient {
            match *variable {
                Variable::Coordinate(i) | Variable::Rate(i) => coordinates.push(i as usize),
                Variable::Length(s) => {
                    coordinates.extend(&self.strands[s as usize].coordinates);
                }
                _ => {}
            }
        }
        coordinates.sort_unstable();
        coordinates.dedup();
        coordinates
    }

    /// Coordinates that each row of a constraint moves with.
    pub fn constraint_coordinates(&self, kind: &ConstraintKind) -> Vec<usize> {
        let mut coordinates = match kind {
            ConstraintKind::Equation(function) => self.function_coordinates(function),
            ConstraintKind::Length(strand) => self.strands[*strand as usize].coordinates.clone(),
            other => constraint_points(other)
                .iter()
                .flat_map(|point| self.chain_coordinates(point.link))
                .collect(),
        };
        coordinates.sort_unstable();
        coordinates.dedup();
        coordinates
    }

    pub(super) fn find_blocks(&mut self, mechanism: &Mechanism) {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for link in 0..self.links() {
            if self.has_mass_below[link] {
                groups.push(self.chain_coordinates(Some(link as u32)));
            }
        }
        for (strand, path) in mechanism.strands.iter().zip(&self.strands) {
            let mut group = match &strand.law {
                Law::Prescribed => continue,
                Law::Tension(function) => self.function_coordinates(function),
                Law::Muscle(muscle) => vec![muscle.fibre as usize, muscle.activation as usize],
                Law::Linear { .. } | Law::Energy(_) => Vec::new(),
            };
            group.extend(&path.coordinates);
            groups.push(group);
        }
        for torque in &mechanism.torques {
            let mut group = self.function_coordinates(&torque.value);
            group.push(torque.coordinate as usize);
            groups.push(group);
        }
        for force in &mechanism.forces {
            let mut group = self.chain_coordinates(force.point.link);
            group.extend(self.chain_coordinates(force.axes));
            for component in &force.value {
                group.extend(self.function_coordinates(component));
            }
            groups.push(group);
        }
        let rows: Vec<Vec<usize>> =
            mechanism.constraints.iter().map(|c| self.constraint_coordinates(&c.kind)).collect();
        let unconstrained = groups.len();
        groups.extend(rows.iter().cloned());
        let dynamic: Vec<bool> = mechanism.coordinates.iter().map(|c| c.drive.is_none()).collect();
        for group in &mut groups {
            group.retain(|&c| dynamic[c]);
        }
        let root = components(self.count, &groups);
        let part_root = components(self.count, &groups[..unconstrained]);
        let mut block_of_root = vec![usize::MAX; self.count];
        for coordinate in (0..self.count).filter(|&c| dynamic[c]) {
            let block = &mut block_of_root[root[coordinate]];
            if *block == usize::MAX {
                *block = self.blocks.len();
                self.blocks.push(Block {
                    coordinates: Vec::new(),
                    rows: Vec::new(),
                    parts: Vec::new(),
                    matrix_offset: 0,
                    constraint_offset: 0,
                });
            }
            self.blocks[*block].coordinates.push(coordinate);
        }
        for (number, block) in self.blocks.iter_mut().enumerate() {
            // Representatives are the first of each part, so that parts keep the model's order.
            block.coordinates.sort_by_key(|&c| (part_root[c], c));
            for (position, &coordinate) in block.coordinates.iter().enumerate() {
                self.slots[coordinate] = Some((number, position));
            }
            let parts = block.coordinates.chunk_by(|&a, &b| part_root[a] == part_root[b]);
            block.parts = parts.map(<[usize]>::len).collect();
        }
        for (constraint, coordinates) in rows.iter().enumerate() {
            let Some(first) = coordinates.iter().find(|&&c| dynamic[c]) else { continue };
            let block = block_of_root[root[*first]];
            for row in self.first_row[constraint]..self.first_row[constraint + 1] {
                self.row_slots[row] = Some((block, self.blocks[block].rows.len()));
                self.blocks[block].rows.push(row);
            }
        }
        let (mut matrix_offset, mut constraint_offset) = (0, 0);
        for block in &mut self.blocks {
            block.matrix_offset = matrix_offset;
            block.constraint_offset = constraint_offset;
            matrix_offset += block.coordinates.len() * block.coordinates.len();
            constraint_offset += block.coordinates.len() * block.rows.len();
        }
        for (constraint, coordinates) in rows.iter().enumerate() {
            for row in self.first_row[constraint]..self.first_row[constraint + 1] {
                let slots = coordinates.iter().filter_map(|&c| self.row_slot(row, c));
                let slots: Vec<usize> = slots.collect();
                self.row_entries.extend(slots);
            }
        }
    }
}

/// Connected components of coordinates that share a group: a representative per coordinate.
fn components(count: usize, groups: &[Vec<usize>]) -> Vec<usize> {
    let mut parent: Vec<usize> = (0..count).collect();
    fn find(parent: &mut [usize], mut i: usize) -> usize {
        while parent[i] != i {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        i
    }
    for group in groups {
        for pair in group.windows(2) {
            let (a, b) = (find(&mut parent, pair[0]), find(&mut parent, pair[1]));
            parent[a.max(b)] = a.min(b);
        }
    }
    (0..count).map(|i| find(&mut parent, i)).collect()
}
