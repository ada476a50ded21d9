//! The symbolic graph: what staging builds and what everything behind it reads.
//!
//! A [`Sym`] is a handle to a node of a graph that belongs to the current thread. It implements
//! [`handc_core::scalar::Scalar`], so the mechanics of the runtime, run on symbols instead of
//! numbers, leaves behind the expression that it would have computed. Three things hold always:
//!
//! - operands stand before their uses, so that ascending handles are a topological order;
//! - equal nodes are one node (hash consing), so that common subexpressions are shared for free;
//! - a node is simplified when it is made and never changed afterwards.
//!
//! What the graph is not: it holds no loops, no vectors and no memory. Vectors and matrices are
//! unrolled by the code that runs on symbols; where results are stored is decided by emission.
//!
//! Divisions exist only as products with a reciprocal, and negative factors only as negations in
//! front of a product, since both are shared and absorbed more often that way.
//!
//! [`with_new`] scopes a graph: handles made inside mean nothing outside.

mod arena;
mod derivative;
mod evaluate;
mod node;
mod origin;
mod program;
mod simplify;
mod substitute;
mod symbol;
#[cfg(test)]
mod tests;

pub use arena::{node, node_count, with_new};
pub use derivative::{differentiate, gradient};
pub use evaluate::evaluate;
pub use node::{Binary, Leaf, Node, SystemArray, Unary};
pub use origin::{Origin, label_of, origin_of, with_origin};
pub use program::{leaf, leaves, reachable, to_program, variable};
pub use substitute::{rebuild_binary, rebuild_unary, substitute};
pub use symbol::Sym;
