//! Model files by the way of the language: text, checked model, mechanism, interpreter.

use handc::lower::lower;
use handc_dsl::diagnostic::render;
use handc_dsl::{Checked, check_file, check_text};
use handc_runtime::interpreter::Interpreter;
use handc_runtime::mechanism::Mechanism;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A folder of the repository.
pub fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

/// All model files of a folder of the repository, by name.
pub fn models(folder: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(repository(folder)).expect("a folder of models");
    let mut files: Vec<PathBuf> = entries
        .map(|entry| entry.expect("a readable folder").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "hdl"))
        .collect();
    files.sort();
    files
}

/// What is said about a checked model.
pub fn said(checked: &Checked) -> String {
    render(&checked.diagnostics, &checked.sources, false)
}

/// The mechanism of a file, or what is wrong with it. A file of components alone has none.
pub fn mechanism(path: &Path) -> Result<Mechanism, String> {
    let checked = check_file(path, None);
    match &checked.model {
        Some(model) if !checked.diagnostics.iter().any(|d| d.is_error()) => {
            Ok(lower(model, &checked.sources))
        }
        _ => Err(said(&checked)),
    }
}

/// The interpreter of a file that must be right.
pub fn interpreter(path: &Path) -> Interpreter {
    let mechanism = mechanism(path).unwrap_or_else(|said| panic!("{}\n{said}", path.display()));
    Interpreter::new(Arc::new(mechanism))
}

/// The mechanism of a text.
pub fn mechanism_of_text(name: &str, text: &str) -> Result<Mechanism, String> {
    let checked = check_text(&format!("{name}.hdl"), text);
    match &checked.model {
        Some(model) if !checked.diagnostics.iter().any(|d| d.is_error()) => {
            Ok(lower(model, &checked.sources))
        }
        _ => Err(said(&checked)),
    }
}
