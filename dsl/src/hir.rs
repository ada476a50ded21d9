//! The checked model: what a file says once imports are read, components are placed, names are
//! resolved and dimensions agree.
//!
//! This is the one contract between the language and the compiler's lowering. It is flat: an
//! instance `index` of a component contributes frames, joints and strands with dotted names such as
//! `index.mcp`. Component parameters and constants are already substituted into expressions;
//! model parameters, inputs, time and coordinates are not, since they vary at run time.
//! Every number is in SI units. Every item keeps the span of the text that made it, so that later
//! stages can underline it. Nothing here knows mechanics: shapes keep their sizes, joints their kind.

use crate::dimension::Dimension;
use crate::source::Span;
use serde::Serialize;

macro_rules! ids {
    ($($(#[$doc:meta])* $name:ident;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
        pub struct $name(pub u32);
        impl $name {
            /// Position in the model's vector of this kind.
            pub fn index(self) -> usize { self.0 as usize }
        }
    )*};
}

ids! {
    /// Index into [`Model::frames`]; `FrameId(0)` is `world`.
    FrameId;
    /// Index into [`Model::joints`].
    JointId;
    /// Index into [`Model::coordinates`].
    CoordinateId;
    /// Index into [`Model::params`].
    ParamId;
    /// Index into [`Model::inputs`].
    InputId;
    /// Index into [`Model::strands`].
    StrandId;
    /// Index into [`Model::constraints`].
    ConstraintId;
}

/// The frame every tree starts from.
pub const WORLD: FrameId = FrameId(0);

/// A name (dotted where it came from a component) with its doc comment and the text that declared it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Name {
    /// Full dotted name, unique among the model's items.
    pub text: String,
    /// Text of the `///` lines above the declaration, joined by newlines; empty if none.
    pub doc: String,
    /// Where the name stands in the source.
    pub span: Span,
}

/// A checked expression. Its value is in SI units of `dimension`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Expr {
    /// What it computes.
    pub kind: ExprKind,
    /// Its dimension; angles are dimensionless.
    pub dimension: Dimension,
    /// The text it came from.
    pub span: Span,
}

/// The forms of an expression.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum ExprKind {
    /// A constant in SI units.
    Number(f64),
    /// A model parameter.
    Param(ParamId),
    /// An external input.
    Input(InputId),
    /// Time.
    Time,
    /// A joint coordinate.
    Coordinate(CoordinateId),
    /// Time derivative of a coordinate, `rate(J)`.
    Rate(CoordinateId),
    /// Length of a strand, `length(S)`.
    Length(StrandId),
    /// Multiplier of one row of a constraint, `lambda.C.x`; only in `record`.
    Multiplier(ConstraintId, u32),
    /// Negation.
    Neg(Box<Expr>),
    /// `+ - * / ^`.
    Binary(BinaryOp, Box<Expr>, Box<Expr>),
    /// A function of one to five arguments.
    Call(Function, Vec<Expr>),
    /// `if(left OP right, then, otherwise)`.
    If {
        /// The comparison.
        compare: Compare,
        /// Its left side.
        left: Box<Expr>,
        /// Its right side.
        right: Box<Expr>,
        /// Value where it holds.
        then: Box<Expr>,
        /// Value where it does not.
        otherwise: Box<Expr>,
    },
}

/// Arithmetic on two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[allow(missing_docs)]
pub enum BinaryOp {
    Add,
    Sub,
    Mul,
    Div,
    /// Power; the exponent of a quantity with a dimension is a constant integer (or a half).
    Pow,
}

/// Comparisons of `if`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[allow(missing_docs)]
pub enum Compare {
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Equal,
    NotEqual,
}

/// The functions of the language.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[allow(missing_docs)]
pub enum Function {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    /// `atan2(y, x)`.
    Atan2,
    Sqrt,
    Exp,
    Log,
    Abs,
    Min,
    Max,
    Floor,
    /// `clamp(x, lo, hi)`.
    Clamp,
    /// `smoothstep(a, b, x)`: 0 below a, 1 above b, 3s² − 2s³ between.
    Smoothstep,
    /// `ease(t0, t1, a, b)`: half-cosine in time from a at t0 to b at t1, constant outside.
    Ease,
}

/// Three expressions, a vector in some frame.
pub type Vector = [Expr; 3];

/// A run-time parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Param {
    /// Name.
    pub name: Name,
    /// Default value (SI). It may use constants and earlier parameters' defaults.
    pub default: f64,
    /// Its dimension.
    pub dimension: Dimension,
}

/// An external input, piecewise constant over a step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Input {
    /// Name.
    pub name: Name,
    /// Default; may use time and parameters.
    pub default: Expr,
}

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
}

/// One generalized coordinate.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Coordinate {
    /// `N` for a joint of one coordinate, else `N.a`, `N.tx`, …
    pub name: Name,
    /// The joint it belongs to.
    pub joint: JointId,
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

/// An elastic path.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Strand {
    /// Name.
    pub name: Name,
    /// Two or more points.
    pub path: Vec<Point>,
    /// Stiffness k of V = ½k(x−x₀)² (N/m).
    pub stiffness: Expr,
    /// Natural length; `None`: the length at the start, on the constraints.
    pub rest: Option<Expr>,
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

/// A named pose: the coordinates that differ from the start.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pose {
    /// Name.
    pub name: Name,
    /// Values (rad or m).
    pub values: Vec<(CoordinateId, Expr)>,
}

/// A motion through poses at given times.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Motion {
    /// Name; `motion` if none was given.
    pub name: Name,
    /// Index into the scenario's poses, and the time (s); times increase.
    pub knots: Vec<(usize, Expr)>,
}

/// Strands whose natural lengths follow a motion.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Follow {
    /// Index into the scenario's motions.
    pub motion: usize,
    /// Which strands; all of the model's if `with` was left out.
    pub strands: Vec<StrandId>,
    /// The statement.
    pub span: Span,
}

/// An extra output column.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Record {
    /// Column name.
    pub name: Name,
    /// What it holds.
    pub value: Expr,
}

/// An experiment on the model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scenario {
    /// Name.
    pub name: Name,
    /// Step (s); `None` if left to the command line.
    pub step: Option<Expr>,
    /// Duration (s); `None` if left to the command line.
    pub duration: Option<Expr>,
    /// Relative tolerance of the step equations.
    pub tolerance: Option<Expr>,
    /// Parameters set.
    pub set: Vec<(ParamId, Expr)>,
    /// Starts overridden.
    pub start: Vec<(CoordinateId, Expr)>,
    /// Initial rates overridden.
    pub velocity: Vec<(CoordinateId, Expr)>,
    /// Inputs as functions of time.
    pub inputs: Vec<(InputId, Expr)>,
    /// Coordinates driven as functions of time.
    pub drives: Vec<(CoordinateId, Expr)>,
    /// Poses.
    pub poses: Vec<Pose>,
    /// Motions.
    pub motions: Vec<Motion>,
    /// What follows a motion.
    pub follow: Vec<Follow>,
    /// Extra columns.
    pub records: Vec<Record>,
}

/// A compile-time constant, kept for tools; its uses are already substituted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Const {
    /// Name.
    pub name: Name,
    /// Value (SI).
    pub value: f64,
    /// Its dimension.
    pub dimension: Dimension,
}

/// A whole checked model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Model {
    /// Name.
    pub name: Name,
    /// Constants, for tools.
    pub consts: Vec<Const>,
    /// Parameters in declaration order.
    pub params: Vec<Param>,
    /// Inputs in declaration order.
    pub inputs: Vec<Input>,
    /// Uniform gravity in world axes (m/s²); zero if not given.
    pub gravity: Vector,
    /// Frames, `world` first, parents before children.
    pub frames: Vec<Frame>,
    /// Joints in declaration order.
    pub joints: Vec<Joint>,
    /// Coordinates in declaration order of their joints.
    pub coordinates: Vec<Coordinate>,
    /// Masses in declaration order.
    pub masses: Vec<Mass>,
    /// Strands in declaration order.
    pub strands: Vec<Strand>,
    /// Constraints in declaration order.
    pub constraints: Vec<Constraint>,
    /// Torques in declaration order.
    pub torques: Vec<Torque>,
    /// Forces in declaration order.
    pub forces: Vec<Force>,
    /// Scenarios in declaration order.
    pub scenarios: Vec<Scenario>,
}
