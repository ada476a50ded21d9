//! What strands can hold at a pose: tensions against a load, and the strength at a point.

pub(crate) mod balance;
pub(crate) mod hold;
pub(crate) mod natural;
pub mod program;
pub mod strength;
