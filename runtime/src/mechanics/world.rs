//! World transforms of links, and the motion of points fixed in them.

use super::{Mechanics, Workspace};
use crate::mechanism::Point;
use crate::resolved::{Axis, Joint};
use crate::vector::{Mat3, Transform, Vec3};
use handc_core::scalar::Scalar;

/// A link in the world.
#[derive(Clone, Copy, Debug)]
pub struct WorldLink<S> {
    /// `world_from_link`.
    pub transform: Transform<S>,
    /// Axis of its joint in world axes; zero for a joint that does not rotate.
    pub angular: Vec3<S>,
    /// Advance of its joint in world axes per unit of the coordinate.
    pub linear: Vec3<S>,
}

impl<S: Scalar> Default for WorldLink<S> {
    fn default() -> Self {
        WorldLink { transform: Transform::identity(), angular: Vec3::zero(), linear: Vec3::zero() }
    }
}

/// R · Rot(axis, angle).
#[inline]
pub(crate) fn rotate<S: Scalar>(r: Mat3<S>, axis: &Axis<S>, (s, c): (S, S)) -> Mat3<S> {
    let turn = |y: S, z: S| (y * c + z * s, z * c - y * s);
    match axis {
        Axis::X => Mat3(r.0.map(|[x, y, z]| {
            let (y, z) = turn(y, z);
            [x, y, z]
        })),
        Axis::Y => Mat3(r.0.map(|[x, y, z]| {
            let (z, x) = turn(z, x);
            [x, y, z]
        })),
        Axis::Z => Mat3(r.0.map(|[x, y, z]| {
            let (x, y) = turn(x, y);
            [x, y, z]
        })),
        Axis::General(_) => {
            let columns = [0, 1, 2].map(|j| {
                let mut unit = Vec3::zero();
                unit.0[j] = S::one();
                r * rotate_vector(axis, (s, c), unit)
            });
            Mat3([0, 1, 2].map(|i| [columns[0].0[i], columns[1].0[i], columns[2].0[i]]))
        }
    }
}

/// Rot(axis, angle) v (Rodrigues).
#[inline]
pub(crate) fn rotate_vector<S: Scalar>(axis: &Axis<S>, (s, c): (S, S), v: Vec3<S>) -> Vec3<S> {
    let [x, y, z] = v.0;
    match axis {
        Axis::X => Vec3([x, y * c - z * s, z * c + y * s]),
        Axis::Y => Vec3([x * c + z * s, y, z * c - x * s]),
        Axis::Z => Vec3([x * c - y * s, y * c + x * s, z]),
        Axis::General(a) => v.scale(c) + a.cross(v).scale(s) + a.scale(a.dot(v) * (S::one() - c)),
    }
}

/// `parent · parent_from_joint · motion(q)`.
#[inline]
pub(crate) fn compose<S: Scalar>(
    parent: &Transform<S>,
    joint: &Joint<S>,
    sin_cos: (S, S),
    q: S,
) -> Transform<S> {
    let base = match &joint.rotation {
        Some(rotation) => parent.rotation * *rotation,
        None => parent.rotation,
    };
    let mut translation = parent.point(joint.origin);
    if let Some(advance) = joint.advance {
        translation += (base * joint.axis.vector()).scale(q * advance);
    }
    let rotation = if joint.rotates { rotate(base, &joint.axis, sin_cos) } else { base };
    Transform { rotation, translation }
}

impl<S: Scalar> Mechanics<'_, S> {
    /// Fills in the world transforms of the links that are `wanted`, whose ancestors must be wanted
    /// too. Sines and cosines must be prepared.
    pub(crate) fn world_links(
        &self,
        workspace: &mut Workspace<S>,
        q: &[S],
        wanted: impl Fn(usize) -> bool,
    ) {
        for (link, joint) in self.numbers.joints.iter().enumerate() {
            if !wanted(link) {
                continue;
            }
            let parent = match self.structure.parents[link] {
                Some(parent) => workspace.world[parent as usize].transform,
                None => Transform::identity(),
            };
            let coordinate = self.structure.coordinate_of[link];
            let transform = compose(&parent, joint, workspace.sin_cos[link], q[coordinate]);
            let axis = transform.rotation * joint.axis.vector();
            workspace.world[link] = WorldLink {
                transform,
                angular: if joint.rotates { axis } else { Vec3::zero() },
                linear: joint.advance.map_or_else(Vec3::zero, |advance| axis.scale(advance)),
            };
        }
    }

    /// `world_from_link`; the identity for the world.
    #[inline]
    pub(crate) fn world_from(&self, workspace: &Workspace<S>, link: Option<u32>) -> Transform<S> {
        match link {
            Some(link) => workspace.world[link as usize].transform,
            None => Transform::identity(),
        }
    }

    /// Derivative of a world point, fixed below `joint_link`, by that link's coordinate.
    #[inline]
    pub(crate) fn point_dq(
        &self,
        workspace: &Workspace<S>,
        joint_link: u32,
        world_point: Vec3<S>,
    ) -> Vec3<S> {
        let link = &workspace.world[joint_link as usize];
        if self.numbers.joints[joint_link as usize].rotates {
            link.angular.cross(world_point - link.transform.translation) + link.linear
        } else {
            link.linear
        }
    }

    /// Transforms `world_from_link` of all links, in order.
    pub fn link_poses(&self, workspace: &mut Workspace<S>, q: &[S]) -> Vec<Transform<S>> {
        self.prepare(workspace, q);
        self.world_links(workspace, q, |_| true);
        workspace.world.iter().map(|link| link.transform).collect()
    }

    /// The geometric Jacobian of a point fixed in a link, 6 × n by rows in world axes: the motion
    /// ∂p/∂q of the point (m/rad or 1), then the turning of its link (rad/rad or rad/m).
    pub fn point_jacobian(
        &self,
        workspace: &mut Workspace<S>,
        q: &[S],
        point: &Point,
        jacobian: &mut [S],
    ) {
        self.prepare(workspace, q);
        let chain = self.structure.chain(point.link);
        self.world_links(workspace, q, |link| chain.contains(&(link as u32)));
        jacobian.fill(S::zero());
        let position = self.numbers.vector(&point.position);
        let position = self.world_from(workspace, point.link).point(position);
        for &link in &chain {
            let column = self.structure.coordinate_of[link as usize];
            let motion = self.point_dq(workspace, link, position);
            let angular = workspace.world[link as usize].angular;
            for axis in 0..3 {
                jacobian[axis * self.structure.count + column] = motion.0[axis];
                jacobian[(3 + axis) * self.structure.count + column] = angular.0[axis];
            }
        }
    }

    /// Transforms `world_from_frame` of the model's named frames, in order.
    pub fn frame_poses(&self, workspace: &mut Workspace<S>, q: &[S]) -> Vec<Transform<S>> {
        self.prepare(workspace, q);
        self.world_links(workspace, q, |_| true);
        self.mechanism
            .frames
            .iter()
            .map(|frame| {
                self.world_from(workspace, frame.link)
                    * self.numbers.transform(&frame.link_from_frame)
            })
            .collect()
    }
}
