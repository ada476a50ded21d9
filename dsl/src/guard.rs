//! What is looked at before anything is parsed.
//!
//! Recursion of parser and checker is bounded by the nesting and the operators allowed here, so no
//! text can overflow the stack; the size budget bounds the time.

use crate::diagnostic::Diagnostic;
use crate::lex::{Kind, Token};
use crate::source::{FileId, Span};

/// Largest file read.
pub(crate) const MAX_BYTES: usize = 4 << 20;
/// Deepest nesting of brackets.
const MAX_DEPTH: usize = 64;
/// Most operators in one statement, or in one point of a path.
const MAX_OPERATORS: usize = 400;

/// The complaint about a file over the size budget.
pub(crate) fn too_large(span: Span, what: &str, bytes: u64) -> Diagnostic {
    let size = bytes as f64 / f64::from(1 << 20);
    Diagnostic::error("file-too-large", span, format!("{what} is too large: {size:.1} MB"))
        .help("at most 4 MB are read; use components for what repeats")
}

/// Finds unknown characters, open comments, and nesting that is too deep. `true` if parsing is safe.
pub(crate) fn guard(
    source: &str,
    file: FileId,
    tokens: &[Token],
    out: &mut Vec<Diagnostic>,
) -> bool {
    let span = |t: &Token| Span::new(file, t.start, t.end);
    let mut depth = 0usize;
    let mut operators = 0usize;
    for token in tokens {
        match (token.kind, token.text(source)) {
            (Kind::Bad, text) => out.push(bad(text, span(token), file)),
            (Kind::Symbol, "(" | "{") => {
                depth += 1;
                if depth > MAX_DEPTH {
                    let message = format!("brackets are nested more than {MAX_DEPTH} deep");
                    out.push(Diagnostic::error("too-deep", span(token), message));
                    return false;
                }
            }
            (Kind::Symbol, ")" | "}") => depth = depth.saturating_sub(1),
            (Kind::Symbol, "+" | "-" | "*" | "/" | "^") => {
                operators += 1;
                if operators > MAX_OPERATORS {
                    let message = format!("a statement has more than {MAX_OPERATORS} operators");
                    out.push(
                        Diagnostic::error("too-long", span(token), message)
                            .help("name parts of it with `const`"),
                    );
                    return false;
                }
            }
            _ => {}
        }
        if token.kind == Kind::Symbol && matches!(token.text(source), ";" | "{" | "}" | "->") {
            operators = 0;
        }
    }
    true
}

fn bad(text: &str, span: Span, file: FileId) -> Diagnostic {
    let start = span.start as usize;
    if text.starts_with("/*") {
        let span = Span::new(file, start, start + 2);
        return Diagnostic::error("open-comment", span, "this comment is never closed")
            .help("close it with `*/`");
    }
    if text.starts_with('"') {
        return Diagnostic::error("open-text", span, "this text is never closed")
            .help("close it with `\"` on the same line");
    }
    let first = text.chars().next().unwrap_or(' ');
    let shown = if first.is_control() {
        format!("U+{:04X}", u32::from(first))
    } else {
        format!("`{first}`")
    };
    let span = Span::new(file, start, start + first.len_utf8());
    let error = Diagnostic::error("unknown-character", span, format!("unknown character {shown}"));
    match replacement(first) {
        Some(plain) => error.help(format!("write `{plain}`")),
        None if first.is_alphabetic() => error.help("names are made of a-z, A-Z, 0-9 and `_`"),
        None => error,
    }
}

/// What was probably meant by a character pasted from elsewhere.
fn replacement(character: char) -> Option<&'static str> {
    Some(match character {
        '−' | '–' | '—' => "-",
        '×' | '·' => "*",
        '°' => "deg",
        '→' => "->",
        '#' | '%' => "//",
        '“' | '”' | '\'' | '‘' | '’' => "\"",
        '[' => "(",
        ']' => ")",
        'π' => "pi",
        'µ' | 'μ' => "u",
        '²' => "^2",
        '³' => "^3",
        _ => return None,
    })
}
