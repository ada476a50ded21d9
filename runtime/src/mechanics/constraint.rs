//! Holonomic constraints: values and first derivatives, in world axes.
//!
//! A step needs Dh at its two ends and no second derivative: the multiplier force Dh(q0)ᵀλ is
//! constant within the step's Newton iterations.

use super::segment::Order;
use super::{Mechanics, Workspace};
use crate::expression::{Function, Variable};
use crate::mechanism::{ConstraintKind, Point};
use crate::vector::{Mat3, Vec3};
use handc_core::scalar::Scalar;

impl<S: Scalar> Mechanics<'_, S> {
    /// Values of all rows at q, with the lengths `rest` that prescribed strands are to have.
    pub fn constraints(
        &self,
        workspace: &mut Workspace<S>,
        q: &[S],
        t: S,
        rest: &[S],
        values: &mut [S],
    ) {
        self.prepare_constraints(workspace, q);
        for (index, constraint) in self.mechanism.constraints.iter().enumerate() {
            let first = self.structure.first_row[index];
            match &constraint.kind {
                ConstraintKind::Coincident { first: a, second: b, axes } => {
                    let gap = self.place(workspace, a) - self.place(workspace, b);
                    let held = (0..3).filter(|&axis| axes[axis]);
                    for (row, axis) in held.enumerate() {
                        values[first + row] = gap.0[axis];
                    }
                }
                ConstraintKind::Distance { first: a, second: b, distance } => {
                    let gap = self.place(workspace, a) - self.place(workspace, b);
                    let d = self.numbers.number(*distance);
                    values[first] = gap.norm_squared() - d * d;
                }
                ConstraintKind::OnPlane { point, through, normal } => {
                    let gap = self.place(workspace, point) - self.place(workspace, through);
                    let normal = self.turn(workspace, through.link, self.numbers.vector(normal));
                    values[first] = normal.dot(gap);
                }
                ConstraintKind::Weld { .. } => {
                    let weld = self.weld(workspace, &constraint.kind);
                    for axis in 0..3 {
                        values[first + axis] = (weld.points[0] - weld.points[1]).0[axis];
                        let [x, y] = weld.pair(axis);
                        values[first + 3 + axis] = x.dot(y);
                    }
                }
                ConstraintKind::Equation(function) => {
                    values[first] = self.equation(workspace, q, t, function, false).0;
                }
                ConstraintKind::Length(strand) => {
                    let strand = *strand as usize;
                    values[first] = workspace.strand.lengths[strand] - rest[strand];
                }
            }
        }
    }

    /// Derivatives of all rows at q, packed by block; entries that are zero by structure are not
    /// written.
    pub fn constraint_jacobian(
        &self,
        workspace: &mut Workspace<S>,
        q: &[S],
        t: S,
        jacobian: &mut [S],
    ) {
        for &slot in &self.structure.row_entries {
            jacobian[slot] = S::zero();
        }
        self.prepare_constraints(workspace, q);
        for (index, constraint) in self.mechanism.constraints.iter().enumerate() {
            let first = self.structure.first_row[index];
            let mut add = |row: usize, coordinate: usize, value: S| {
                if let Some(slot) = self.structure.row_slot(first + row, coordinate) {
                    jacobian[slot] += value;
                }
            };
            match &constraint.kind {
                ConstraintKind::Coincident { first: a, second: b, axes } => {
                    for (coordinate, dq) in self.gap_dq(workspace, a, b) {
                        let held = (0..3).filter(|&axis| axes[axis]);
                        for (row, axis) in held.enumerate() {
                            add(row, coordinate, dq.0[axis]);
                        }
                    }
                }
                ConstraintKind::Distance { first: a, second: b, .. } => {
                    let gap = self.place(workspace, a) - self.place(workspace, b);
                    let twice = gap.scale(S::constant(2.0));
                    for (coordinate, dq) in self.gap_dq(workspace, a, b) {
                        add(0, coordinate, twice.dot(dq));
                    }
                }
                ConstraintKind::OnPlane { point, through, normal } => {
                    let gap = self.place(workspace, point) - self.place(workspace, through);
                    let normal = self.turn(workspace, through.link, self.numbers.vector(normal));
                    for (coordinate, dq) in self.gap_dq(workspace, point, through) {
                        add(0, coordinate, normal.dot(dq));
                    }
                    for link in self.structure.chain(through.link) {
                        let turned = workspace.world[link as usize].angular.cross(normal);
                        add(0, self.structure.coordinate_of[link as usize], turned.dot(gap));
                    }
                }
                ConstraintKind::Weld { first: a, second: b, .. } => {
                    let weld = self.weld(workspace, &constraint.kind);
                    for (side, link) in [a, b].into_iter().enumerate() {
                        for joint in self.structure.chain(*link) {
                            let coordinate = self.structure.coordinate_of[joint as usize];
                            let dq = self.point_dq(workspace, joint, weld.points[side]);
                            let dq = if side == 0 { dq } else { -dq };
                            let angular = workspace.world[joint as usize].angular;
                            for axis in 0..3 {
                                add(axis, coordinate, dq.0[axis]);
                                let pair = weld.pair(axis);
                                let other = pair[1 - side];
                                let turned = angular.cross(pair[side]).dot(other);
                                add(3 + axis, coordinate, turned);
                            }
                        }
                    }
                }
                ConstraintKind::Equation(function) => {
                    for (coordinate, dq) in self.equation(workspace, q, t, function, true).1 {
                        add(0, coordinate, dq);
                    }
                }
                ConstraintKind::Length(strand) => {
                    let path = &self.structure.strands[*strand as usize];
                    let length_dq = &workspace.strand.length_dq[path.span.clone()];
                    for (&coordinate, &dq) in path.coordinates.iter().zip(length_dq) {
                        add(0, coordinate, dq);
                    }
                }
            }
        }
    }

    fn prepare_constraints(&self, workspace: &mut Workspace<S>, q: &[S]) {
        self.prepare(workspace, q);
        self.world_links(workspace, q, |link| self.structure.world_links[link]);
        for constraint in &self.mechanism.constraints {
            match &constraint.kind {
                ConstraintKind::Equation(function) => {
                    for strand in lengths_read(function) {
                        self.strand_length(workspace, q, strand, Order::First);
                    }
                }
                ConstraintKind::Length(strand) => {
                    self.strand_length(workspace, q, *strand as usize, Order::First);
                }
                _ => {}
            }
        }
    }

    /// A point in the world.
    fn place(&self, workspace: &Workspace<S>, point: &Point) -> Vec3<S> {
        let position = self.numbers.vector(&point.position);
        self.world_from(workspace, point.link).point(position)
    }

    fn turn(&self, workspace: &Workspace<S>, link: Option<u32>, v: Vec3<S>) -> Vec3<S> {
        self.world_from(workspace, link).rotation * v
    }

    /// Derivative of p₁ − p₂ by every coordinate of either chain; a joint that carries both points
    /// moves their difference as a whole.
    fn gap_dq(
        &self,
        workspace: &Workspace<S>,
        first: &Point,
        second: &Point,
    ) -> Vec<(usize, Vec3<S>)> {
        let (a, b) = (self.place(workspace, first), self.place(workspace, second));
        let (up, down) = (self.structure.chain(first.link), self.structure.chain(second.link));
        let coordinate = |link: u32| self.structure.coordinate_of[link as usize];
        let mut found = Vec::with_capacity(up.len() + down.len());
        for &link in &up {
            let dq = if down.contains(&link) {
                workspace.world[link as usize].angular.cross(a - b)
            } else {
                self.point_dq(workspace, link, a)
            };
            found.push((coordinate(link), dq));
        }
        for &link in down.iter().filter(|link| !up.contains(link)) {
            found.push((coordinate(link), -self.point_dq(workspace, link, b)));
        }
        found
    }

    fn weld(&self, workspace: &Workspace<S>, kind: &ConstraintKind) -> Weld<S> {
        let ConstraintKind::Weld { first, first_from_frame, second, second_from_frame } = kind
        else {
            unreachable!("called for welds only");
        };
        let place = |link: Option<u32>, frame| {
            self.world_from(workspace, link) * self.numbers.transform(frame)
        };
        let (a, b) = (place(*first, first_from_frame), place(*second, second_from_frame));
        Weld { points: [a.translation, b.translation], axes: [a.rotation, b.rotation] }
    }
}

/// The two frames of a weld in the world.
struct Weld<S> {
    points: [Vec3<S>; 2],
    axes: [Mat3<S>; 2],
}

impl<S: Scalar> Weld<S> {
    /// The pair of axes whose product is row 3 + i: x₁·y₂, y₁·z₂, z₁·x₂.
    fn pair(&self, i: usize) -> [Vec3<S>; 2] {
        [self.axes[0].column(i), self.axes[1].column((i + 1) % 3)]
    }
}

fn lengths_read(function: &Function) -> impl Iterator<Item = usize> {
    function.program.variables().into_iter().filter_map(|variable| match variable {
        Variable::Length(strand) => Some(strand as usize),
        _ => None,
    })
}
