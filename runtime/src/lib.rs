//! The mechanism, its mechanics over a generic scalar, and the interpreter.
//!
//! [`mechanism`] is the model as constant data; [`structure`] is what follows from its shape,
//! [`resolved`] its numbers for given parameters, [`mechanics`] the equations over both. The
//! integrator and everything around a run live in `handc_core`, which generated crates share.
//!
//! Generated crates that hold tables ([`tables`]) link to this crate without its features, `analysis`
//! and `serde`; it then depends on `handc_core` alone.

#[cfg(feature = "analysis")]
pub mod analysis;
pub mod dual;
pub mod expression;
pub mod interpreter;
pub mod mechanics;
pub mod mechanism;
pub mod muscle;
pub mod resolved;
pub mod run;
pub mod structure;
pub mod surface;
pub mod tables;
pub mod vector;

pub use handc_core as core;
