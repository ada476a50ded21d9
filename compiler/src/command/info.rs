//! `handc info`: what a model consists of.

use std::path::Path;

/// Prints tree, coordinates, strands, masses and degrees of freedom.
pub fn info(file: &Path, root: Option<&Path>) -> u8 {
    match super::mechanism(file, root) {
        Ok((checked, mechanism)) => {
            let Some(model) = &checked.model else { return 1 };
            super::print(&crate::describe::describe(model, mechanism));
            0
        }
        Err(code) => code,
    }
}
