//! Shared helpers of the integration tests.

pub mod battery;
pub mod chance;
pub mod compare;
pub mod expected;
pub mod grown;
pub mod load;
pub mod neutral;
pub mod probe;
pub mod python;
pub mod random;
pub mod table;
