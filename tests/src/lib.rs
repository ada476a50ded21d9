//! Shared helpers of the integration tests.

pub mod load;
pub mod neutral;
pub mod table;
