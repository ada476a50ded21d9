//! The compiler: from a checked model to a mechanism, from a mechanism to a generated crate.

pub mod command;
pub mod describe;
pub mod emit;
pub mod graph;
pub mod lint;
pub mod lower;
pub mod mjcf;
pub mod stage;
pub mod statics;
