//! What can be said of a mechanism at a configuration before it runs: rank of its constraints,
//! natural frequencies.
//!
//! Dense decompositions of faer and nalgebra; nothing here is on a step's path.

pub mod equilibrium;
pub mod linear;
pub mod modes;
pub mod rank;
pub mod singular;
pub mod tangent;
