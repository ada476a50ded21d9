//! What a generated model links to: the integrator, scenarios, trajectories and the runner.
//!
//! This crate has no dependencies, so that a generated crate builds in seconds. It knows nothing of
//! text, of expressions or of how a model's equations came about: a model is whatever implements
//! [`model::Model`].
//!
//! [`simulation`] runs a scenario by [`step`]s, a private module does the linear algebra of a
//! step, [`trajectory`] writes the result, [`runner`] is the command line of it all.

pub mod array;
pub mod ensemble;
pub mod error;
mod follow;
pub mod frequency;
pub mod internal;
pub mod lane;
pub mod lanes;
pub mod layout;
pub mod linalg;
mod lookup;
pub mod math;
pub mod model;
pub mod motion;
pub mod muscle;
mod newton;
pub mod passage;
mod predict;
mod requirement;
pub mod runner;
pub mod scalar;
pub mod shape;
pub mod simulation;
mod solve;
pub mod start;
mod statics;
pub mod step;
mod suggest;
pub mod system;
pub mod together;
pub mod trajectory;
