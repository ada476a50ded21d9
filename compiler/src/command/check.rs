//! `handc check`: every diagnostic.

use std::path::Path;

/// Checks a model file.
pub fn check(file: &Path, root: Option<&Path>) -> u8 {
    match super::mechanism(file, root) {
        Ok((checked, _)) => {
            if checked.diagnostics.is_empty() {
                super::print(&format!("{}: no diagnostics\n", file.display()));
            }
            0
        }
        Err(code) => code,
    }
}
