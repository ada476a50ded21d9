//! Scenarios of a checked model.

use super::{CoordinateId, Expr, InputId, Name, ParamId, StrandId};
use crate::source::Span;
use serde::Serialize;

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
    /// Lengths prescribed for strands as functions of time.
    pub lengths: Vec<(StrandId, Expr)>,
    /// Poses.
    pub poses: Vec<Pose>,
    /// Motions.
    pub motions: Vec<Motion>,
    /// What follows a motion.
    pub follow: Vec<Follow>,
    /// Extra columns.
    pub records: Vec<Record>,
}
