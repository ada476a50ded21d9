//! Shared helpers of the integration tests.

pub mod neutral;
pub mod table;
