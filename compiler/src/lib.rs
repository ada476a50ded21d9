//! The compiler: from a checked model to a mechanism, from a mechanism to a generated crate.

pub mod graph;
