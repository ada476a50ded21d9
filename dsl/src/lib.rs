//! The .hdl language: text to checked model, with every diagnostic at once.
//!
//! ```text
//! text ─guard→ tokens ─split→ statements ─pest→ ast::File ─load→ files ─check→ hir::Model
//! ```
//!
//! A statement that cannot be read does not hide the errors of the others: each is parsed by itself.
//! The checker reports all it finds and keeps silent about what merely follows from a reported error.
//! The crate knows no mechanics beyond the rules a user can break.

pub mod ast;
pub mod diagnostic;
pub mod dimension;
pub mod format;
pub mod hir;
pub mod source;
pub mod unit;

mod check;
mod guard;
mod lex;
mod load;
mod parse;
mod program;
mod read;
mod render;
mod suggest;

pub use read::read_text;

use diagnostic::Diagnostic;
use load::Loader;
use source::SourceMap;
use std::collections::BTreeSet;
use std::path::Path;

/// What checking a file gives.
#[derive(Clone, Debug)]
pub struct Checked {
    /// The model; present only if there is no error.
    pub model: Option<hir::Model>,
    /// All that was found, in the order of the text.
    pub diagnostics: Vec<Diagnostic>,
    /// The texts that were read.
    pub sources: SourceMap,
    /// The syntax tree of the file given, as far as it could be read.
    pub file: Option<ast::File>,
}

/// Reads and checks a file and what it imports. Imports never leave `root`, or the file's folder.
pub fn check_file(path: &Path, root: Option<&Path>) -> Checked {
    finish(Loader::from_file(path, root))
}

/// Checks a text that imports nothing.
pub fn check_text(name: &str, text: &str) -> Checked {
    finish(Loader::from_text(name, text))
}

fn finish(loader: Loader) -> Checked {
    let Loader { sources, parsed, out: mut diagnostics, .. } = loader;
    let program = program::assemble(&parsed, &sources, &mut diagnostics);
    let model = check::check(&program, &mut diagnostics);
    // An instance repeats the errors of its component: once is enough.
    let mut seen = BTreeSet::new();
    diagnostics.retain(|d| seen.insert((d.code, d.primary.span, d.message.clone())));
    diagnostics.sort_by_key(|d| (d.primary.span.file, d.primary.span.start));
    let wrong = diagnostics.iter().any(Diagnostic::is_error);
    let model = model.filter(|_| !wrong);
    let file = parsed.into_iter().next().map(|p| p.file);
    Checked { model, diagnostics, sources, file }
}
