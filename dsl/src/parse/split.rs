//! Cuts a file into statements and blocks before the grammar sees it.
//!
//! A statement ends at `;`, at the end of its block, or where the block around it ends. Only braces
//! and semicolons count here, so a mistake inside a statement stays inside it.

use crate::diagnostic::Diagnostic;
use crate::lex::{Kind, Token};
use crate::source::{FileId, Span};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// The words that open a declaration.
pub(crate) const DECLARATIONS: [&str; 17] = [
    "model",
    "const",
    "param",
    "input",
    "gravity",
    "frame",
    "joint",
    "mass",
    "strand",
    "node",
    "constraint",
    "torque",
    "force",
    "component",
    "place",
    "import",
    "scenario",
];

/// The tokens of a file without comments, and which braces belong together.
pub(crate) struct Tokens<'a> {
    pub(crate) source: &'a str,
    pub(crate) file: FileId,
    pub(crate) list: Vec<Token>,
    /// Doc comments by the index of the token they stand before.
    docs: BTreeMap<usize, String>,
    /// Where the block opened at a token ends: the index of its `}`, or of the token before which
    /// it should have stood.
    ends: BTreeMap<usize, usize>,
    /// Where unknown characters stand, in order.
    bad: Vec<usize>,
    /// Closing braces that close nothing.
    stray: BTreeSet<usize>,
}

/// One statement.
#[derive(Clone, Debug)]
pub(crate) struct Chunk {
    pub(crate) doc: String,
    /// Its tokens up to `;` or `{`.
    pub(crate) head: Range<usize>,
    /// The tokens between its braces.
    pub(crate) body: Option<Range<usize>>,
    /// Whether neither `;` nor a block ends it.
    pub(crate) open: bool,
}

impl<'a> Tokens<'a> {
    /// Sorts out comments and braces; says which braces have no partner.
    pub(crate) fn new(
        source: &'a str,
        file: FileId,
        all: &[Token],
        out: &mut Vec<Diagnostic>,
    ) -> Tokens<'a> {
        let mut list: Vec<Token> = Vec::with_capacity(all.len());
        let mut docs: BTreeMap<usize, String> = BTreeMap::new();
        let mut bad = Vec::new();
        for token in all {
            if token.kind == Kind::Doc {
                let line = token.text(source)[3..].trim_end();
                let line = line.strip_prefix(' ').unwrap_or(line);
                let doc = docs.entry(list.len()).or_default();
                if !doc.is_empty() {
                    doc.push('\n');
                }
                doc.push_str(line);
            } else if token.kind == Kind::Bad {
                bad.push(token.start);
            } else if !token.is_comment() {
                list.push(*token);
            }
        }
        let (ends, stray) = (BTreeMap::new(), BTreeSet::new());
        let mut tokens = Tokens { source, file, list, docs, ends, bad, stray };
        tokens.match_braces(out);
        tokens
    }

    /// Text of a token; empty beyond the end.
    pub(crate) fn text(&self, index: usize) -> &'a str {
        self.list.get(index).map_or("", |t| &self.source[t.start..t.end])
    }

    /// Place of a token; the end of the file beyond the end.
    pub(crate) fn span(&self, index: usize) -> Span {
        match self.list.get(index) {
            Some(token) => Span::new(self.file, token.start, token.end),
            None => Span::new(self.file, self.source.len(), self.source.len()),
        }
    }

    /// Whether a token is the first on its line.
    pub(crate) fn starts_line(&self, index: usize) -> bool {
        index == 0 || self.source[self.list[index - 1].end..self.list[index].start].contains('\n')
    }

    /// Whether a declaration seems to begin at a token: its word, then not `=`.
    pub(crate) fn declares(&self, index: usize) -> bool {
        DECLARATIONS.contains(&self.text(index))
            && (self.text(index + 1) != "=" || self.text(index) == "gravity")
    }

    /// Whether some brace has no partner, so that what stands inside what is a guess.
    pub(crate) fn unbalanced(&self) -> bool {
        !self.stray.is_empty() || self.ends.values().any(|&e| self.text(e) != "}")
    }

    fn match_braces(&mut self, out: &mut Vec<Diagnostic>) {
        let count = |brace: &str| (0..self.list.len()).filter(|&i| self.text(i) == brace).count();
        let missing = count("{") > count("}");
        let mut open: Vec<usize> = Vec::new();
        for index in 0..self.list.len() {
            match self.text(index) {
                "{" => open.push(index),
                "}" => match open.pop() {
                    Some(start) => {
                        self.ends.insert(start, index);
                    }
                    None => {
                        // After some nobody reads on.
                        if self.stray.len() < 100 {
                            let message = "this `}` closes nothing";
                            out.push(
                                Diagnostic::error("unmatched-brace", self.span(index), message)
                                    .help("a block above it may end too early"),
                            );
                        }
                        self.stray.insert(index);
                    }
                },
                _ if missing && self.declares(index) && self.starts_line(index) => {
                    // A declaration cannot stand in a block of options: its `}` is missing.
                    while let Some(&start) = open.last()
                        && self.holds_options(start, index)
                    {
                        open.pop();
                        self.ends.insert(start, index);
                        out.push(self.unclosed(start));
                    }
                }
                _ => {}
            }
        }
        for start in open.into_iter().rev() {
            self.ends.insert(start, self.list.len());
            out.push(self.unclosed(start));
        }
    }

    fn unclosed(&self, start: usize) -> Diagnostic {
        Diagnostic::error("unclosed-brace", self.span(start), "this `{` is never closed")
            .help("add the missing `}`")
    }

    /// Whether the block opened at `start` cannot hold the declaration at `index`.
    fn holds_options(&self, start: usize, index: usize) -> bool {
        let first = (0..start)
            .rev()
            .find(|&i| matches!(self.text(i), ";" | "{" | "}"))
            .map_or(0, |i| i + 1);
        match self.text(first) {
            "joint" | "mass" | "strand" | "node" | "pose" => true,
            "scenario" => self.text(index) != "input",
            _ => false,
        }
    }

    /// The statements in a range of tokens.
    pub(crate) fn chunks(&self, range: Range<usize>) -> Vec<Chunk> {
        let mut chunks = Vec::new();
        let mut at = range.start;
        while at < range.end {
            if self.text(at) == ";" || self.stray.contains(&at) {
                at += 1;
                continue;
            }
            let start = at;
            while at < range.end && !matches!(self.text(at), ";" | "{" | "}") {
                at += 1;
            }
            let head = start..at;
            let doc = self.docs.get(&start).cloned().unwrap_or_default();
            let chunk = Chunk { doc, head, body: None, open: false };
            match self.ends.get(&at) {
                Some(&end) if self.text(at) == "{" && at < range.end => {
                    let end = end.min(range.end);
                    chunks.push(Chunk { body: Some(at + 1..end), ..chunk });
                    at = if self.text(end) == "}" && end < range.end { end + 1 } else { end };
                }
                _ if at < range.end && self.text(at) == ";" => {
                    chunks.push(chunk);
                    at += 1;
                }
                _ => chunks.push(Chunk { open: true, ..chunk }),
            }
        }
        chunks
    }

    /// A chunk cut where a new statement seems to begin on a new line: what a missing `;` ran together.
    pub(crate) fn cut(&self, chunk: &Chunk) -> Vec<Chunk> {
        let begins = |&i: &usize| {
            let setting = self.list[i].kind == Kind::Word && self.text(i + 1) == "=";
            self.starts_line(i) && (setting || self.declares(i))
        };
        let mut starts: Vec<usize> = vec![chunk.head.start];
        starts.extend((chunk.head.start + 1..chunk.head.end).filter(begins));
        let mut pieces = Vec::new();
        for (n, &start) in starts.iter().enumerate() {
            let doc = self.docs.get(&start).cloned().unwrap_or_default();
            pieces.push(match starts.get(n + 1) {
                Some(&end) => Chunk { doc, head: start..end, body: None, open: true },
                None => Chunk { doc, head: start..chunk.head.end, ..chunk.clone() },
            });
        }
        pieces
    }

    /// Whether an unknown character stands in a range of tokens, or right behind it.
    pub(crate) fn holds_bad(&self, range: &Range<usize>) -> bool {
        let Some(first) = self.list.get(range.start) else { return false };
        let end = self.list.get(range.end).map_or(self.source.len(), |t| t.start);
        let after = self.bad.partition_point(|&b| b < first.start);
        self.bad.get(after).is_some_and(|&b| b < end)
    }

    /// From the first to the last token of a range.
    pub(crate) fn cover(&self, range: &Range<usize>) -> Span {
        match range.is_empty() {
            true => self.span(range.start),
            false => self.span(range.start).to(self.span(range.end - 1)),
        }
    }
}
