//! Words, numbers, symbols and comments with their places.
//!
//! The grammar reads statements; this reads what lies around them. The guard, the splitter and the
//! formatter all work on these tokens, so they agree on where comments and blocks begin and end.

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A word.
    Word,
    /// A number.
    Number,
    /// A quoted text, quotes included.
    Text,
    /// An operator or punctuation.
    Symbol,
    /// A comment to the end of the line.
    Line,
    /// A `///` comment.
    Doc,
    /// A comment between `/*` and `*/`.
    Block,
    /// Something the language does not know, or a comment or text that is not closed.
    Bad,
}

/// A token with its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Token {
    pub(crate) kind: Kind,
    pub(crate) start: usize,
    pub(crate) end: usize,
}

impl Token {
    /// Its text.
    pub(crate) fn text<'a>(&self, source: &'a str) -> &'a str {
        &source[self.start..self.end]
    }

    /// Whether it is a comment.
    pub(crate) fn is_comment(&self) -> bool {
        matches!(self.kind, Kind::Line | Kind::Doc | Kind::Block)
    }
}

const PAIRS: [&str; 5] = ["->", "==", "!=", "<=", ">="];
const SINGLES: &[u8] = b"+-*/^()=,;:{}<>@.";

/// Reads all tokens; whitespace is left out.
pub(crate) fn lex(source: &str) -> Vec<Token> {
    let bytes = source.as_bytes();
    let mut tokens: Vec<Token> = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let byte = bytes[at];
        if matches!(byte, b' ' | b'\t' | b'\r' | b'\n') {
            at += 1;
            continue;
        }
        let (kind, end) = next(source, at);
        // Neighbouring unknown characters are one token: garbage gives one message, not thousands.
        match tokens.last_mut() {
            Some(last) if kind == Kind::Bad && last.kind == Kind::Bad && last.end == at => {
                last.end = end;
            }
            _ => tokens.push(Token { kind, start: at, end }),
        }
        at = end;
    }
    tokens
}

fn next(source: &str, at: usize) -> (Kind, usize) {
    let rest = &source[at..];
    let bytes = rest.as_bytes();
    let line_end = || at + rest.find('\n').unwrap_or(rest.len());
    let byte = bytes[0];
    let second = bytes.get(1).copied().unwrap_or(0);
    match byte {
        b'/' if second == b'/' => {
            let doc = rest.starts_with("///") && !rest.starts_with("////");
            (if doc { Kind::Doc } else { Kind::Line }, line_end())
        }
        b'/' if second == b'*' => match rest[2..].find("*/") {
            Some(length) => (Kind::Block, at + length + 4),
            None => (Kind::Bad, source.len()),
        },
        b'"' => match rest[1..].find(['"', '\n']) {
            Some(length) if bytes[length + 1] == b'"' => (Kind::Text, at + length + 2),
            _ => (Kind::Bad, line_end()),
        },
        b'.' if second.is_ascii_digit() => (Kind::Number, at + number(bytes)),
        _ if byte.is_ascii_digit() => (Kind::Number, at + number(bytes)),
        _ if byte.is_ascii_alphabetic() || byte == b'_' => {
            let tail = |b: &u8| !(b.is_ascii_alphanumeric() || *b == b'_');
            (Kind::Word, at + bytes.iter().position(tail).unwrap_or(bytes.len()))
        }
        _ if PAIRS.iter().any(|p| rest.starts_with(p)) => (Kind::Symbol, at + 2),
        _ if SINGLES.contains(&byte) => (Kind::Symbol, at + 1),
        _ => (Kind::Bad, at + rest.chars().next().map_or(1, char::len_utf8)),
    }
}

/// Length of the number at the start.
fn number(bytes: &[u8]) -> usize {
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let mut length = digits(0);
    if bytes.get(length) == Some(&b'.') {
        length += 1;
        length += digits(length);
    }
    if matches!(bytes.get(length), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(length + 1), Some(b'+' | b'-')));
        let size = digits((length + 1 + sign).min(bytes.len()));
        if size > 0 {
            length += 1 + sign + size;
        }
    }
    length
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(source: &str) -> Vec<&str> {
        lex(source).iter().map(|t| t.text(source)).collect()
    }

    #[test]
    fn cuts_numbers_and_symbols() {
        assert_eq!(
            texts("a->b 1.5e-3mm .5 2.e"),
            ["a", "->", "b", "1.5e-3", "mm", ".5", "2.", "e"]
        );
        assert_eq!(texts("a==b<=-c"), ["a", "==", "b", "<=", "-", "c"]);
    }

    #[test]
    fn keeps_comments() {
        let source = "/// doc\n// line\n/* a\nb */ x /* open";
        let kinds: Vec<Kind> = lex(source).iter().map(|t| t.kind).collect();
        assert_eq!(kinds, [Kind::Doc, Kind::Line, Kind::Block, Kind::Word, Kind::Bad]);
    }

    #[test]
    fn garbage_is_one_token() {
        assert_eq!(texts("§§§§ ??\u{0}"), ["§§§§", "??\u{0}"]);
    }
}
