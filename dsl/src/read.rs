//! A file as text: plain files of a bounded size in UTF-8, and nothing else.

use crate::diagnostic::Diagnostic;
use crate::guard::{MAX_BYTES, too_large};
use crate::source::Span;
use std::io::{Error, ErrorKind, Read};
use std::path::Path;

/// Why a file gives no text.
pub(crate) enum Problem {
    /// Its size in bytes, or what is known of it.
    TooLarge(u64),
    /// The first byte that is no text.
    NotText(usize),
    Io(Error),
}

impl Problem {
    /// The complaint, placed where the file was asked for.
    pub(crate) fn diagnostic(&self, span: Span, path: &str) -> Diagnostic {
        match self {
            Problem::TooLarge(bytes) => too_large(span, &format!("`{path}`"), *bytes),
            Problem::NotText(at) => {
                let message = format!("`{path}` is not UTF-8 text (byte {at})");
                Diagnostic::error("not-text", span, message).help("save the file as UTF-8")
            }
            Problem::Io(error) => {
                let message = format!("cannot read `{path}`: {}", reason(error));
                Diagnostic::error("cannot-read", span, message)
            }
        }
    }
}

/// Why a file cannot be read, in words that are the same on every system.
pub(crate) fn reason(error: &Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => "there is no such file".to_string(),
        ErrorKind::PermissionDenied => "permission denied".to_string(),
        ErrorKind::IsADirectory => "it is a folder".to_string(),
        ErrorKind::NotADirectory => "a part of its path is no folder".to_string(),
        ErrorKind::InvalidInput => "it is not a plain file".to_string(),
        _ => error.to_string(),
    }
}

/// Reads a plain file. Others, such as a pipe that nobody writes to, are not even opened.
pub(crate) fn read(path: &Path) -> Result<String, Problem> {
    let kind = std::fs::metadata(path).map_err(Problem::Io)?.file_type();
    if !kind.is_file() {
        let kind = if kind.is_dir() { ErrorKind::IsADirectory } else { ErrorKind::InvalidInput };
        return Err(Problem::Io(kind.into()));
    }
    let file = std::fs::File::open(path).map_err(Problem::Io)?;
    let size = file.metadata().map(|m| m.len()).unwrap_or(0);
    let mut bytes = Vec::new();
    file.take(MAX_BYTES as u64 + 1).read_to_end(&mut bytes).map_err(Problem::Io)?;
    if bytes.len() > MAX_BYTES {
        return Err(Problem::TooLarge(size.max(bytes.len() as u64)));
    }
    String::from_utf8(bytes).map_err(|e| Problem::NotText(e.utf8_error().valid_up_to()))
}

/// The text of a model file; an error says why there is none.
pub fn read_text(path: &Path) -> Result<String, String> {
    let shown = path.display().to_string();
    read(path).map_err(|problem| problem.diagnostic(Span::default(), &shown).message)
}
