//! `handc compile`: a crate of specialised Rust.

use handc_runtime::mechanism::Mechanism;
use std::path::Path;

/// Compiles a model file.
pub fn compile(_file: &Path, _root: Option<&Path>, _out: Option<&Path>, _force: bool) -> u8 {
    2
}

pub(crate) fn graph_text(_mechanism: &Mechanism) -> String {
    String::new()
}

pub(crate) fn rust_text(_mechanism: &Mechanism) -> String {
    String::new()
}
