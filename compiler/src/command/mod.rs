//! The commands of `handc`, one file each. Each returns the process's exit code: 0 done, 1 the model
//! is wrong, 2 the command line is wrong, 3 the run failed.

pub mod atlas;
pub mod check;
pub mod compile;
mod core_source;
pub mod dump;
pub mod export;
pub mod fmt;
pub mod info;
pub mod new;
pub mod plot;
pub mod pose;
pub mod posture;
pub mod run;
pub mod strength;

use crate::lower::lower;
use handc_dsl::diagnostic::{Diagnostic, Severity, render, render_within};
use handc_dsl::{Checked, check_file};
use handc_runtime::mechanism::Mechanism;
use std::path::Path;

/// Stages of the compiler that can be printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Syntax tree.
    Ast,
    /// Checked model.
    Hir,
    /// Mechanism.
    Mechanism,
    /// Symbolic graph.
    Graph,
    /// Generated Rust.
    Rust,
}

/// Writes text to standard output; a closed pipe ends quietly.
pub(crate) fn print(text: &str) {
    use std::io::Write;
    let _ = std::io::stdout().write_all(text.as_bytes());
}

/// Reads a model and adds the lints of the mechanics to what the language found.
pub(crate) fn load(file: &Path, root: Option<&Path>) -> (Checked, Option<Mechanism>) {
    let mut checked = check_file(file, root);
    let mut mechanism = None;
    if let Some(model) = &checked.model {
        let lowered = lower(model, &checked.sources);
        checked.diagnostics.extend(crate::lint::lint(model, &lowered));
        mechanism = Some(lowered);
    }
    if has_error(&checked.diagnostics) {
        mechanism = None;
    }
    (checked, mechanism)
}

fn has_error(diagnostics: &[Diagnostic]) -> bool {
    diagnostics.iter().any(|d| d.severity == Severity::Error)
}

/// Shows diagnostics on standard error.
pub(crate) fn report(checked: &Checked) {
    if checked.diagnostics.is_empty() {
        return;
    }
    let terminal = console::Term::stderr();
    let text = match terminal.size_checked() {
        Some((_, columns)) if terminal.is_term() => {
            let color = std::env::var_os("NO_COLOR").is_none();
            let columns = usize::from(columns).clamp(40, 140);
            render_within(&checked.diagnostics, &checked.sources, color, columns)
        }
        _ => render(&checked.diagnostics, &checked.sources, false),
    };
    eprint!("{text}");
}

/// `1 error`, `2 errors`.
pub(crate) fn count(n: usize, noun: &str) -> String {
    if n == 1 { format!("1 {noun}") } else { format!("{n} {noun}s") }
}

/// Reads a model for a command that needs one: diagnostics are shown, and the exit code is 1 if
/// there is an error.
pub(crate) fn mechanism(file: &Path, root: Option<&Path>) -> Result<(Checked, Mechanism), u8> {
    let (checked, mechanism) = load(file, root);
    report(&checked);
    mechanism.map(|mechanism| (checked, mechanism)).ok_or(1)
}
