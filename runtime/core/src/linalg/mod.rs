//! Small dense linear algebra: [`Lu`] with scaled partial pivoting, and a rank-revealing least-norm
//! solve for the systems that LU must refuse.
//!
//! Written here because a generated crate has no dependencies; blocks are small (4 unknowns for a
//! finger, 41 for a grasp). Matrices are by rows.

mod least_norm;
mod lu;

pub use least_norm::{LeastNorm, RANK_TOLERANCE, solve_least_norm};
pub(crate) use lu::PADDING;
pub use lu::{Lu, Pivots};
