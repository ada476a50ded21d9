//! Strands, constraints, torques and forces of a checked model.

use super::{ConstraintId, CoordinateId, Expr, FrameId, InputId, Name, StrandId, Vector};
use crate::source::Span;
use serde::Serialize;

/// A point fixed in a frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// The frame.
    pub frame: FrameId,
    /// Offset in the frame's axes (m).
    pub offset: Vector,
    /// The text of the point.
    pub span: Span,
}

/// The form of a surface that a strand wraps.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Surface {
    /// A sphere about its centre.
    Sphere,
    /// A cylinder without ends about an axis through its centre.
    Cylinder {
        /// Axis in the frame's axes, not necessarily of unit length.
        axis: Vector,
    },
}

/// A surface that a strand wraps between two points of its path.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Wrap {
    /// Number of the path's point before it; the next one stands behind it.
    pub gap: usize,
    /// Its form.
    pub surface: Surface,
    /// Where it stands.
    pub center: Point,
    /// Radius (m).
    pub radius: Expr,
    /// On which side the strand passes: a direction from the centre in the frame's axes, not
    /// necessarily of unit length; `None`: the shorter way.
    pub side: Option<Vector>,
    /// The text of the surface.
    pub span: Span,
}

/// How a strand's tension follows from its length x and natural length x₀.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Law {
    /// Stiffness k of V = ½k(x−x₀)² (N/m).
    Stiffness(Expr),
    /// V itself (J), a function of `x`, `x0` and parameters.
    Energy(Expr),
    /// A commanded tension (N).
    Tension(Expr),
    /// The length is prescribed; the multiplier of the constraint is the tension.
    Prescribed(ConstraintId),
    /// The tension is that of a muscle's tendon.
    Muscle(Box<Muscle>),
}

/// A muscle with an elastic tendon, after Thelen (2003).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Muscle {
    /// Coordinate `N.fibre`: length of the fibres along the tendon.
    pub fibre: CoordinateId,
    /// Coordinate `N.activation`.
    pub activation: CoordinateId,
    /// Input `N.excitation`.
    pub excitation: InputId,
    /// Activation at the start; `None`: the excitation there.
    pub start: Option<Expr>,
    /// Largest isometric force (N), optimal fibre length (m), slack length of the tendon (m),
    /// pennation at the optimum (rad), largest velocity (1/s), strain of the tendon and of passive
    /// fibres at the largest force, largest force of lengthening, damping of the fibres, time
    /// constants of activation and deactivation (s).
    pub numbers: [Expr; 11],
}

/// An elastic path.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Strand {
    /// Name.
    pub name: Name,
    /// Two or more points.
    pub path: Vec<Point>,
    /// Surfaces wrapped, at most one between two points.
    pub wraps: Vec<Wrap>,
    /// Its law.
    pub law: Law,
    /// Coefficient c of the damping −c·ẋ along the strand (N·s/m), if given.
    pub damping: Option<Expr>,
    /// Width (m) over which it goes slack; `None` for one that can push.
    pub slack: Option<Expr>,
    /// Whether the joints that it spans balance at every step, their inertia left out.
    pub quasi_static: bool,
    /// Friction coefficient and smoothing speed (m/s) where it slides over its points, if any.
    pub friction: Option<[Expr; 2]>,
    /// Natural length; `None`: the length at the start, on the constraints. Of a prescribed strand,
    /// its length.
    pub rest: Option<Expr>,
    /// The input `N.rest` of an actuated strand.
    pub actuator: Option<InputId>,
    /// The whole declaration.
    pub span: Span,
}

/// A holonomic constraint as written.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[allow(missing_docs)]
pub enum ConstraintKind {
    /// p₁ − p₂ = 0 in world axes, one row per axis that is true in `axes` (x, y, z).
    Coincident { first: Point, second: Point, axes: [bool; 3] },
    /// ‖p₁ − p₂‖² − d² = 0.
    Distance { first: Point, second: Point, distance: Expr },
    /// (R_F n)·(p − (p_F + R_F through)) = 0.
    OnPlane { point: Point, frame: FrameId, normal: Vector, through: Vector },
    /// p₁ − p₂ in world axes, then x₁·y₂, y₁·z₂, z₁·x₂.
    Weld { first: FrameId, second: FrameId },
    /// left − right = 0.
    Equation { left: Expr, right: Expr },
    /// The length of a strand, less the one prescribed for it.
    Length(StrandId),
}

/// A holonomic constraint.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Constraint {
    /// Name.
    pub name: Name,
    /// Its form.
    pub kind: ConstraintKind,
    /// The whole declaration.
    pub span: Span,
}

/// A generalized force on one coordinate.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Torque {
    /// Name.
    pub name: Name,
    /// The coordinate.
    pub coordinate: CoordinateId,
    /// Its value (N·m or N).
    pub value: Expr,
}

/// A force at a point.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Force {
    /// Name.
    pub name: Name,
    /// Where it acts.
    pub point: Point,
    /// Components (N) in the axes of `frame`.
    pub value: Vector,
    /// The frame whose axes the components refer to; `world` unless `in` says otherwise.
    pub frame: FrameId,
}
