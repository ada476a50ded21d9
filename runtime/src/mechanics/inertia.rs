//! Kinetic energy and gravity: momentum of subtrees and screws of joints, one pass down and one up.
//!
//! Every quantity of a tree is expressed in the axes of its hub and about its origin
//! ([`Structure::trees`](crate::structure::Structure)); the sums below do not depend on that choice.
//! With S_j the screw of joint j, Ṡ_j = V_parent × S_j, I_j the inertia and H_j the momentum of the
//! subtree of j, and k an ancestor of j or j itself,
//!
//! p_j = S_j·H_j, ∂T/∂q_j = Ṡ_j·H_j, F_j = I_j S_j, E_j = I_j Ṡ_j + S_j ×* H_j,
//! M_jk = S_k·F_j, ∂²T/∂q_j∂q̇_k = S_k·E_j, ∂²T/∂q_k∂q̇_j = Ṡ_k·F_j, ∂²T/∂q_j∂q_k = Ṡ_k·E_j
//!
//! (Featherstone 2008, Rigid Body Dynamics Algorithms; Carpentier and Mansard 2018, Analytical
//! derivatives of rigid body dynamics algorithms).

use super::world::{compose, rotate};
use super::{Mechanics, Terms, Workspace};
use crate::resolved::Lump;
use crate::structure::Tree;
use crate::vector::{Mat3, Transform, Vec3};
use handc_core::scalar::Scalar;

/// A motion (angular, linear at the hub's origin) or a force (moment about it, force).
#[derive(Clone, Copy, Debug)]
pub struct Spatial<S> {
    pub(super) angular: Vec3<S>,
    pub(super) linear: Vec3<S>,
}

impl<S: Scalar> Spatial<S> {
    pub(super) fn zero() -> Self {
        Spatial { angular: Vec3::zero(), linear: Vec3::zero() }
    }
    #[inline]
    pub(super) fn dot(&self, other: &Self) -> S {
        self.angular.dot(other.angular) + self.linear.dot(other.linear)
    }
    #[inline]
    pub(super) fn scale(&self, factor: S) -> Self {
        Spatial { angular: self.angular.scale(factor), linear: self.linear.scale(factor) }
    }
    #[inline]
    pub(super) fn plus(&self, other: &Self) -> Self {
        Spatial { angular: self.angular + other.angular, linear: self.linear + other.linear }
    }
    /// This motion in a frame of the hub, at its origin.
    #[inline]
    pub(super) fn seen_from(&self, hub_from_frame: &Transform<S>) -> Self {
        let Transform { rotation, translation } = hub_from_frame;
        let linear = self.linear + self.angular.cross(*translation);
        Spatial {
            angular: rotation.transpose_mul(self.angular),
            linear: rotation.transpose_mul(linear),
        }
    }
    /// This force, given in a frame of the hub, in the hub.
    #[inline]
    pub(super) fn force_carried_to(&self, hub_from_frame: &Transform<S>) -> Self {
        let Transform { rotation, translation } = hub_from_frame;
        let linear = *rotation * self.linear;
        Spatial { angular: *rotation * self.angular + translation.cross(linear), linear }
    }
    /// Motion × motion.
    #[inline]
    fn cross_motion(&self, other: &Self) -> Self {
        Spatial {
            angular: self.angular.cross(other.angular),
            linear: self.angular.cross(other.linear) + self.linear.cross(other.angular),
        }
    }
    /// Motion ×* force.
    #[inline]
    fn cross_force(&self, force: &Self) -> Self {
        Spatial {
            angular: self.angular.cross(force.angular) + self.linear.cross(force.linear),
            linear: self.angular.cross(force.linear),
        }
    }
}

/// Inertia of a body or of a subtree about the hub's origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inertia<S> {
    pub(super) mass: S,
    /// Mass times centre.
    pub(super) moment: Vec3<S>,
    /// xx yy zz xy xz yz.
    pub(super) rotational: [S; 6],
}

impl<S: Scalar> Inertia<S> {
    pub(super) fn zero() -> Self {
        Inertia { mass: S::zero(), moment: Vec3::zero(), rotational: [S::zero(); 6] }
    }
    #[inline]
    fn add(&mut self, other: &Self) {
        self.mass += other.mass;
        self.moment += other.moment;
        for k in 0..6 {
            self.rotational[k] += other.rotational[k];
        }
    }
    /// Momentum of the motion.
    #[inline]
    pub(super) fn times(&self, motion: &Spatial<S>) -> Spatial<S> {
        let [xx, yy, zz, xy, xz, yz] = self.rotational;
        let rotational = Mat3([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]);
        Spatial {
            angular: rotational * motion.angular + self.moment.cross(motion.linear),
            linear: motion.linear.scale(self.mass) - self.moment.cross(motion.angular),
        }
    }
    /// This inertia, given in a frame of the hub, in the hub.
    pub(super) fn carried_to(&self, hub_from_frame: &Transform<S>) -> Self {
        let Transform { rotation: r, translation: t } = *hub_from_frame;
        let [xx, yy, zz, xy, xz, yz] = self.rotational;
        let turned = r * Mat3([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]);
        let entry = |i: usize, j: usize| Vec3(turned.0[i]).dot(Vec3(r.0[j]));
        let (m, [x, y, z]) = (r * self.moment, t.0);
        let moment = m + t.scale(self.mass);
        // Shifting adds t and the moments before and after, each once.
        let [a, b, c] = (m + moment).0;
        let ([_, my, mz], [nx, ny, _]) = (m.0, moment.0);
        let rotational = [
            entry(0, 0) + (y * b + z * c),
            entry(1, 1) + (x * a + z * c),
            entry(2, 2) + (x * a + y * b),
            entry(0, 1) - (x * my + nx * y),
            entry(0, 2) - (x * mz + nx * z),
            entry(1, 2) - (y * mz + ny * z),
        ];
        Inertia { mass: self.mass, moment, rotational }
    }
    /// The lump of a link placed in the hub.
    #[inline]
    fn of(lump: &Lump<S>, hub_from_link: &Transform<S>) -> Self {
        let c = hub_from_link.point(lump.center);
        let moment = c.scale(lump.mass);
        let [x, y, z] = c.0;
        let [mx, my, mz] = moment.0;
        let (xx, yy, zz) = (mx * x, my * y, mz * z);
        let i = lump.isotropic;
        let mut rotational =
            [yy + zz + i, xx + zz + i, xx + yy + i, -(mx * y), -(mx * z), -(my * z)];
        if !lump.is_isotropic {
            let r = hub_from_link.rotation;
            let rd = r * lump.deviator;
            let entry = |i: usize, j: usize| Vec3(rd.0[i]).dot(Vec3(r.0[j]));
            for (k, (i, j)) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].iter().enumerate() {
                rotational[k] += entry(*i, *j);
            }
        }
        Inertia { mass: lump.mass, moment, rotational }
    }
}

/// Scratch of one evaluation, per link.
#[derive(Clone, Debug)]
pub struct Scratch<S> {
    hub_from_link: Vec<Transform<S>>,
    screw: Vec<Spatial<S>>,
    screw_dot: Vec<Spatial<S>>,
    velocity: Vec<Spatial<S>>,
    inertia: Vec<Inertia<S>>,
    momentum: Vec<Spatial<S>>,
}

impl<S: Scalar> Scratch<S> {
    /// `hub_from_link` of a link and its velocity.
    pub(super) fn placed(&self, link: u32) -> (Transform<S>, Spatial<S>) {
        (self.hub_from_link[link as usize], self.velocity[link as usize])
    }
    /// Screw of a joint and its rate.
    pub(super) fn screws(&self, link: u32) -> (Spatial<S>, Spatial<S>) {
        (self.screw[link as usize], self.screw_dot[link as usize])
    }
    pub(crate) fn new(count: usize) -> Self {
        Scratch {
            hub_from_link: vec![Transform::identity(); count],
            screw: vec![Spatial::zero(); count],
            screw_dot: vec![Spatial::zero(); count],
            velocity: vec![Spatial::zero(); count],
            inertia: vec![Inertia::zero(); count],
            momentum: vec![Spatial::zero(); count],
        }
    }
}

impl<S: Scalar> Mechanics<'_, S> {
    /// Adds kinetic energy and gravity.
    pub(crate) fn add_inertia(
        &self,
        workspace: &mut Workspace<S>,
        q: &[S],
        v: &[S],
        terms: &mut Terms<S>,
    ) {
        for tree in &self.structure.trees {
            let hub_from_world = self.place_tree(workspace, tree, q);
            // Where inertia is left out nothing of the motion is felt, but weight is.
            let zero = if tree.is_static { vec![S::zero(); v.len()] } else { Vec::new() };
            let v = if tree.is_static { &zero } else { v };
            self.move_tree(workspace, tree, v);
            self.place_lumps(workspace, tree);
            let gravity = self.numbers.gravity.map(|g| hub_from_world * g);
            for &run in &tree.runs {
                self.move_run(workspace, run, tree.base == Some(run), v);
                self.add_run(workspace, run, gravity, tree.is_static, terms);
                self.load_parent(workspace, run);
            }
            self.sum_subtrees(workspace, tree);
            for &link in &tree.links {
                self.add_link(workspace, link, gravity, tree.is_static, terms);
            }
        }
    }

    /// Adds M/h + ½∂p/∂q at the prepared coordinates, packed.
    pub(crate) fn add_momentum_matrix(
        &self,
        workspace: &mut Workspace<S>,
        q: &[S],
        v: &[S],
        by_h: S,
        matrix: &mut [S],
    ) {
        let half = S::constant(0.5);
        for tree in self.structure.trees.iter().filter(|tree| !tree.is_static) {
            self.place_tree(workspace, tree, q);
            self.move_tree(workspace, tree, v);
            self.place_lumps(workspace, tree);
            let mut write = |row: usize, column: usize, value: S| {
                if let Some(slot) = self.structure.slot(row, column) {
                    matrix[slot] = value;
                }
            };
            for &run in &tree.runs {
                self.move_run(workspace, run, tree.base == Some(run), v);
                self.write_run_momentum_matrix(workspace, run, by_h, &mut write);
                self.load_parent(workspace, run);
            }
            self.sum_subtrees(workspace, tree);
            let scratch = &workspace.inertia;
            for &j in &tree.links {
                let l = j as usize;
                let (inertia, screw) = (&scratch.inertia[l], &scratch.screw[l]);
                let f = inertia.times(screw);
                let e = inertia.times(&scratch.screw_dot[l]);
                let e = e.plus(&screw.cross_force(&scratch.momentum[l]));
                let row = self.structure.coordinate_of[l];
                let mut at = Some(j);
                while let Some(k) = at {
                    let column = self.structure.coordinate_of[k as usize];
                    let (s, s_dot) = (&scratch.screw[k as usize], &scratch.screw_dot[k as usize]);
                    let mass = s.dot(&f) * by_h;
                    write(row, column, mass + half * s_dot.dot(&f));
                    if k != j {
                        write(column, row, mass + half * s.dot(&e));
                    }
                    at = self.structure.parents[k as usize];
                }
            }
        }
    }

    /// Transforms and screws in the hub; returns the rotation `hub_from_world`.
    fn place_tree(&self, workspace: &mut Workspace<S>, tree: &Tree, q: &[S]) -> Mat3<S> {
        let mut hub_from = match tree.base {
            Some(run) => self.numbers.runs[run].parent_from_run.inverse(),
            None => Transform::identity(),
        };
        for &link in tree.trunk.iter().rev() {
            let l = link as usize;
            workspace.inertia.hub_from_link[l] = hub_from;
            if self.structure.parents[l].is_none() && self.numbers.gravity.is_none() {
                // Nothing asks for the world.
                break;
            }
            let joint = &self.numbers.joints[l];
            // Up the trunk: hub_from_parent = hub_from_link · (parent_from_joint · motion)⁻¹.
            let mut rotation = hub_from.rotation;
            let mut translation = hub_from.translation;
            if joint.rotates {
                let (s, c) = workspace.sin_cos[l];
                rotation = rotate(rotation, &joint.axis, (-s, c));
            }
            if let Some(advance) = joint.advance {
                let q = q[self.structure.coordinate_of[l]];
                translation -= (rotation * joint.axis.vector()).scale(q * advance);
            }
            if let Some(parent_from_joint) = joint.rotation {
                rotation = rotation * parent_from_joint.transpose();
            }
            translation -= rotation * joint.origin;
            hub_from = Transform { rotation, translation };
        }
        for &link in &tree.links {
            let l = link as usize;
            let joint = &self.numbers.joints[l];
            if !tree.trunk.contains(&link) {
                let parent = match self.structure.parents[l] {
                    Some(parent) => workspace.inertia.hub_from_link[parent as usize],
                    None => hub_from,
                };
                let q = q[self.structure.coordinate_of[l]];
                workspace.inertia.hub_from_link[l] =
                    compose(&parent, joint, workspace.sin_cos[l], q);
            }
            let at = &workspace.inertia.hub_from_link[l];
            let axis = at.rotation * joint.axis.vector();
            let mut screw = Spatial::zero();
            if joint.rotates {
                screw.angular = axis;
                screw.linear = at.translation.cross(axis);
            }
            if let Some(advance) = joint.advance {
                screw.linear += axis.scale(advance);
            }
            workspace.inertia.screw[l] = screw;
        }
        hub_from.rotation
    }

    /// Velocities of the links and rates of the screws.
    fn move_tree(&self, workspace: &mut Workspace<S>, tree: &Tree, v: &[S]) {
        let scratch = &mut workspace.inertia;
        for &link in &tree.links {
            let l = link as usize;
            let parent = self.structure.parents[l]
                .map_or_else(Spatial::zero, |p| scratch.velocity[p as usize]);
            let rate = v[self.structure.coordinate_of[l]];
            scratch.screw_dot[l] = parent.cross_motion(&scratch.screw[l]);
            scratch.velocity[l] = parent.plus(&scratch.screw[l].scale(rate));
        }
    }

    /// Inertia and momentum of every link alone.
    fn place_lumps(&self, workspace: &mut Workspace<S>, tree: &Tree) {
        let scratch = &mut workspace.inertia;
        for &link in &tree.links {
            let l = link as usize;
            match &self.numbers.lumps[l] {
                Some(lump) => {
                    let inertia = Inertia::of(lump, &scratch.hub_from_link[l]);
                    scratch.momentum[l] = inertia.times(&scratch.velocity[l]);
                    scratch.inertia[l] = inertia;
                }
                None => {
                    scratch.momentum[l] = Spatial::zero();
                    scratch.inertia[l] = Inertia::zero();
                }
            }
        }
    }

    /// Lets what carries a run feel it.
    fn load_parent(&self, workspace: &mut Workspace<S>, run: usize) {
        if let Some(parent) = self.structure.runs[run].parent {
            let (inertia, momentum) = self.sum_run(workspace, run);
            let scratch = &mut workspace.inertia;
            scratch.inertia[parent as usize].add(&inertia);
            let sum = scratch.momentum[parent as usize].plus(&momentum);
            scratch.momentum[parent as usize] = sum;
        }
    }

    /// Inertia and momentum of every subtree.
    fn sum_subtrees(&self, workspace: &mut Workspace<S>, tree: &Tree) {
        let scratch = &mut workspace.inertia;
        for &link in tree.links.iter().rev() {
            let l = link as usize;
            if let Some(parent) = self.structure.parents[l] {
                let (inertia, momentum) = (scratch.inertia[l], scratch.momentum[l]);
                scratch.inertia[parent as usize].add(&inertia);
                scratch.momentum[parent as usize] =
                    scratch.momentum[parent as usize].plus(&momentum);
            }
        }
    }

    fn add_link(
        &self,
        workspace: &Workspace<S>,
        j: u32,
        gravity: Option<Vec3<S>>,
        is_static: bool,
        terms: &mut Terms<S>,
    ) {
        let scratch = &workspace.inertia;
        let l = j as usize;
        let row = self.structure.coordinate_of[l];
        let (screw, screw_dot) = (&scratch.screw[l], &scratch.screw_dot[l]);
        let momentum = &scratch.momentum[l];
        terms.momentum[row] += screw.dot(momentum);
        terms.force[row] += screw_dot.dot(momentum);
        let inertia = &scratch.inertia[l];
        if let Some(g) = gravity {
            let weight =
                Spatial { angular: inertia.moment.cross(g), linear: g.scale(inertia.mass) };
            terms.force[row] += screw.dot(&weight);
        }
        let Some((h, _)) = terms.matrix else { return };
        if self.structure.slots[row].is_none() {
            return;
        }
        let f = inertia.times(screw);
        let e = inertia.times(screw_dot).plus(&screw.cross_force(momentum));
        let (quarter, half) = (h.scale(0.25), S::constant(0.5));
        let f_by_h = f.scale(if is_static { S::zero() } else { -h.recip() });
        let e_quarter = e.scale(quarter);
        let lean = gravity.map(|g| f.linear.cross(g).scale(quarter));
        let mut at = Some(j);
        while let Some(k) = at {
            let column = self.structure.coordinate_of[k as usize];
            let (s, s_dot) = (&scratch.screw[k as usize], &scratch.screw_dot[k as usize]);
            let mut even = s.dot(&f_by_h) + s_dot.dot(&e_quarter);
            if let Some(lean) = lean {
                even += s.angular.dot(lean);
            }
            if k == j {
                terms.add(self.structure, row, row, even);
            } else {
                let odd = half * (s.dot(&e) - s_dot.dot(&f));
                terms.add_pair(self.structure.pair(row, column), even, odd);
            }
            at = self.structure.parents[k as usize];
        }
    }
}
