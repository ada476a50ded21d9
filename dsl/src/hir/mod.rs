//! The checked model: what a file says once imports are read, components are placed, names are
//! resolved and dimensions agree.
//!
//! This is the one contract between the language and the compiler's lowering. It is flat: an
//! instance `index` of a component contributes frames, joints and strands with dotted names such as
//! `index.mcp`. Component parameters and constants are already substituted into expressions;
//! model parameters, inputs, time and coordinates are not, since they vary at run time.
//! Every number is in SI units. Every item keeps the span of the text that made it, so that later
//! stages can underline it. Nothing here knows mechanics: shapes keep their sizes, joints their kind.

mod expr;
mod load;
mod scenario;
mod tree;

pub use expr::{BinaryOp, Compare, Expr, ExprKind, Function, Own, StrandQuantity, Vector};
pub use load::{
    Constraint, ConstraintKind, Force, Law, Muscle, Point, Strand, Surface, Torque, Wrap,
};
pub use scenario::{Follow, Motion, Pose, Record, Scenario};
pub use tree::{
    Amount, Coordinate, Frame, Joint, JointKind, Mass, MassKind, MotionKind, Owner, Placement,
    Rotation,
};

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
    /// Coordinates in declaration order of their joints, nodes and muscles.
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
    /// Ranges of numbers that depend on parameters.
    pub requirements: Vec<Requirement>,
}

/// A number that depends on parameters and must lie in a range.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Requirement {
    /// What must be, as a sentence without an end.
    pub text: String,
    /// The number; its span is where it is written.
    pub value: Expr,
    /// Least value that is allowed.
    pub least: f64,
    /// Largest.
    pub most: f64,
}
