//! Emission: from symbols to the text of straight-line Rust.
//!
//! Steps, each a module: [`plan`] decides which nodes become variables, which are written inside
//! the expression that uses them, and which products are fused with a sum; [`schedule`] orders the
//! statements so that values are made shortly before their use; [`cut`] splits what is too long for
//! one function; [`name`] gives every variable a name that says where it came from; [`print`](mod@print) makes
//! tokens, and [`count`] counts what will be executed.
//!
//! What stands between those steps is [`code`]: a list of statements that knows nothing of Rust, so
//! that another target needs another printer only.

pub mod code;
pub mod count;
pub mod cut;
pub mod data;
pub mod function;
pub mod literal;
pub mod name;
pub mod package;
pub mod plan;
pub mod print;
pub mod schedule;
#[cfg(test)]
mod tests;

pub use code::{Output, Place};
pub use count::Operations;
pub use function::{Argument, Emitted, Function};
