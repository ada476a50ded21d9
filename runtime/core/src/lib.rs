//! What a generated model links to: the integrator, scenarios, trajectories and the runner.
//!
//! This crate has no dependencies, so that a generated crate builds in seconds. It knows nothing of
//! text, of expressions or of how a model's equations came about: a model is whatever implements
//! [`model::Model`].

pub mod layout;
pub mod math;
pub mod model;
pub mod scalar;
