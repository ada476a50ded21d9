//! Frames, joints, coordinates and masses of a checked model.

use super::{CoordinateId, Expr, FrameId, JointId, Name, StrandId, Vector};
use crate::source::Span;
use serde::Serialize;

/// One rotation about an axis given in the current frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rotation {
    /// Axis, not necessarily of unit length.
    pub axis: Vector,
    /// Angle (rad).
    pub angle: Expr,
}

/// `at v rotate …`: translate by `at`, then each rotation in turn about the current frame's axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Placement {
    /// Translation in the parent frame (m).
    pub at: Vector,
    /// Rotations, first applied first.
    pub rotations: Vec<Rotation>,
}

/// A frame: `world`, a constant one, the moving frame of a joint, or the `base` of an instance.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Frame {
    /// Name; a joint's frame has the joint's name, an instance's base is `N.base`.
    pub name: Name,
    /// Parent; `None` for `world` alone. Parents stand before their children.
    pub parent: Option<FrameId>,
    /// Constant transform in the parent.
    pub placement: Placement,
    /// The joint whose motion follows the placement, if any.
    pub joint: Option<JointId>,
}

/// The kind of a joint as written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[allow(missing_docs)]
pub enum JointKind {
    Revolute,
    Prismatic,
    Screw,
    Universal,
    Planar,
    Free,
    /// A `node`: translations along the axes of the frame it is in.
    Node,
}

/// A joint: one to six coordinates between its placement and its frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Joint {
    /// Name.
    pub name: Name,
    /// The frame it moves.
    pub frame: FrameId,
    /// Kind as written.
    pub kind: JointKind,
    /// Its coordinates in the order in which their motions are applied.
    pub coordinates: Vec<CoordinateId>,
}

/// The motion of one coordinate, in the frame the motion before it made.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum MotionKind {
    /// Rotation by the coordinate (rad).
    Revolute,
    /// Translation by the coordinate (m).
    Prismatic,
    /// Rotation by the coordinate and advance by `pitch` per radian (m/rad).
    Screw {
        /// Advance per radian.
        pitch: Expr,
    },
    /// None: the length of a muscle's fibres along its tendon (m).
    Fibre,
    /// None: the activation of a muscle.
    Activation,
}

/// What a coordinate belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Owner {
    /// A joint or a node.
    Joint(JointId),
    /// A strand that is a muscle.
    Muscle(StrandId),
}

/// One generalized coordinate.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Coordinate {
    /// `N` for a joint of one coordinate, else `N.a`, `N.tx`, …
    pub name: Name,
    /// What it belongs to.
    pub owner: Owner,
    /// What it does.
    pub motion: MotionKind,
    /// Axis of the motion, not necessarily of unit length.
    pub axis: Vector,
    /// Value at the start (rad or m); zero if not given.
    pub start: Expr,
    /// Rate at the start; zero if not given.
    pub velocity: Expr,
    /// Viscous coefficient c of the force −c·q̇, if given.
    pub damping: Option<Expr>,
    /// Stiffness k of V = ½k(q−rest)², if given.
    pub stiffness: Option<Expr>,
    /// Rest of the joint spring; zero if not given.
    pub rest: Option<Expr>,
    /// Range of motion, low then high.
    pub limits: Option<[Expr; 2]>,
    /// Stiffness of elastic limits, if given.
    pub limit_stiffness: Option<Expr>,
    /// Width over which elastic limits begin, if given.
    pub limit_width: Option<Expr>,
    /// Path of a kinematic joint, a function of time.
    pub drive: Option<Expr>,
}

/// How much matter a shape holds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Amount {
    /// Total mass (kg).
    Mass(Expr),
    /// Density (kg/m³).
    Density(Expr),
}

/// A mass as written.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[allow(missing_docs)]
pub enum MassKind {
    /// Numbers. `inertia` about the centre in the frame's axes: Ixx Iyy Izz Ixy Ixz Iyz; `None` is a point mass.
    Explicit { mass: Expr, at: Vector, inertia: Option<Box<[Expr; 6]>> },
    /// Centred at `at`.
    Sphere { at: Vector, radius: Expr, amount: Amount },
    /// A cylinder between two centres with a half sphere on each end.
    Capsule { from: Vector, to: Vector, radius: Expr, amount: Amount },
    /// Flat ends.
    Cylinder { from: Vector, to: Vector, radius: Expr, amount: Amount },
    /// Edges along the frame's axes, centred at `at`.
    Box { at: Vector, size: Vector, amount: Amount },
}

/// A rigid body fixed in a frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Mass {
    /// Name.
    pub name: Name,
    /// The frame that carries it.
    pub frame: FrameId,
    /// Its distribution.
    pub kind: MassKind,
    /// The whole declaration.
    pub span: Span,
}
