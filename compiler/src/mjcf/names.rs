//! Names that are taken once in their kind.

use std::collections::BTreeSet;

/// The names of one kind of MJCF element.
#[derive(Clone, Debug, Default)]
pub(super) struct Names(BTreeSet<String>);

impl Names {
    /// The wanted name, or the first of `wanted_2`, `wanted_3`, … that is free.
    pub(super) fn take(&mut self, wanted: &str) -> String {
        let mut name = wanted.to_string();
        let mut number = 2;
        while !self.0.insert(name.clone()) {
            name = format!("{wanted}_{number}");
            number += 1;
        }
        name
    }
}
