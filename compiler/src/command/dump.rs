//! `handc dump`: what a stage of the compiler sees, as JSON or as Rust.

use super::Stage;
use serde::Serialize;
use std::path::Path;

/// Prints a stage.
pub fn dump(file: &Path, root: Option<&Path>, stage: Stage) -> u8 {
    let (checked, mechanism) = super::load(file, root);
    super::report(&checked);
    let shown = match stage {
        Stage::Ast => checked.file.as_ref().map(json),
        Stage::Hir => checked.model.as_ref().map(json),
        Stage::Mechanism => mechanism.as_ref().map(json),
        Stage::Graph => mechanism.as_ref().map(super::compile::graph_text),
        Stage::Rust => mechanism.as_ref().map(super::compile::rust_text),
    };
    match shown {
        Some(text) => {
            super::print(&text);
            0
        }
        None => 1,
    }
}

fn json<T: Serialize>(value: &T) -> String {
    let mut text = serde_json::to_string_pretty(value).unwrap_or_default();
    text.push('\n');
    text
}
