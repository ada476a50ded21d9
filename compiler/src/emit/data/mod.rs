//! Constant data as Rust: whatever can be serialised becomes the expression that makes it again.
//!
//! A serialiser that builds a tree, and a printer that breaks it into lines. Serde does not tell arrays
//! from tuples; what has elements of one kind is taken for an array.

mod print;
mod serial;

use serde::Serialize;

/// An expression that makes a value.
#[derive(Clone, Debug, PartialEq)]
pub enum Data {
    /// A number or a truth value, as it is written.
    Plain(String),
    /// A string.
    Text(String),
    /// `None`, or `Some` of something.
    Option(Option<Box<Data>>),
    /// A vector.
    List(Vec<Data>),
    /// An array or a tuple.
    Tuple(Vec<Data>),
    /// A structure, or a variant with fields, by its name.
    Fields(String, Vec<(&'static str, Data)>),
    /// A structure or variant over values without names; a variant without any.
    Call(String, Vec<Data>),
}

impl Data {
    /// The data of a value.
    ///
    /// # Panics
    /// For maps and bytes, of which models have none.
    pub fn of(value: &impl Serialize) -> Data {
        match value.serialize(serial::Serial) {
            Ok(data) => data,
            Err(error) => panic!("a model that cannot be written down: {error}"),
        }
    }
}
