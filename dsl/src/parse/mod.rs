//! Text to syntax tree, statement by statement.
//!
//! [`parse`] never gives up: a statement that cannot be read becomes a broken node that still knows
//! the name it would have declared, and everything else is read as usual.

// An error is made once and moved once: its size does not matter here.
#![allow(clippy::result_large_err)]

mod decl;
mod error;
mod expr;
mod scenario;
mod split;

use crate::ast::{Block, Decl, DeclKind, File, Ident, PathOption, Setting};
use crate::diagnostic::Diagnostic;
use crate::guard::guard;
use crate::lex::{Kind, lex};
use crate::source::FileId;
use crate::suggest::nearest;
pub(crate) use error::reserved;
use expr::{Build, inner};
use pest::Parser;
use pest::iterators::Pair;
use pest_derive::Parser;
pub(crate) use split::DECLARATIONS;
use split::{Chunk, Tokens};
use std::ops::Range;

#[derive(Parser)]
#[grammar = "hdl.pest"]
struct Grammar;

/// Parses a file; what is wrong is added to `out`.
pub(crate) fn parse(source: &str, file: FileId, out: &mut Vec<Diagnostic>) -> File {
    let all = lex(source);
    if !guard(source, file, &all, out) {
        return File { items: Vec::new() };
    }
    let tokens = Tokens::new(source, file, &all, out);
    let mut reader = Reader { tokens: &tokens, out };
    let whole = 0..tokens.list.len();
    let mut items = reader.each(whole, Reader::decl);
    if tokens.unbalanced() {
        adopt(&mut items);
    }
    File { items }
}

/// Moves declarations that stand behind a model into it: a stray brace ended it too early.
fn adopt(items: &mut Vec<Decl>) {
    let at_home = |d: &Decl| {
        use DeclKind::{Component, Import, Model, Scenario};
        matches!(d.kind, Import(_) | Component(_) | Model(_) | Scenario(_))
    };
    let Some(model) = items.iter().position(|d| matches!(d.kind, DeclKind::Model(_))) else {
        return;
    };
    let mut kept = Vec::new();
    let mut adopted = Vec::new();
    for (index, item) in items.drain(..).enumerate() {
        if index > model && !at_home(&item) {
            adopted.push(item);
        } else {
            kept.push(item);
        }
    }
    *items = kept;
    if let Some(Decl { kind: DeclKind::Model(body), .. }) = items.get_mut(model) {
        body.extend(adopted);
    }
}

/// Reads chunks with the grammar.
struct Reader<'r, 'a> {
    tokens: &'r Tokens<'a>,
    out: &'r mut Vec<Diagnostic>,
}

impl<'a> Reader<'_, 'a> {
    /// Reads every statement of a range. One that fails is tried again in pieces, since a missing
    /// `;` runs two together.
    fn each<T>(
        &mut self,
        range: Range<usize>,
        read: impl Fn(&mut Self, &Chunk) -> (T, Option<Diagnostic>),
    ) -> Vec<T> {
        let mut result = Vec::new();
        for chunk in self.tokens.chunks(range) {
            let before = self.out.len();
            let (item, error) = read(self, &chunk);
            let pieces = match &error {
                Some(_) if !chunk.head.is_empty() => self.tokens.cut(&chunk),
                _ => Vec::new(),
            };
            if pieces.len() < 2 {
                if error.is_none() && chunk.open {
                    self.missing_end(&chunk);
                }
                self.complain(error, &chunk);
                result.push(item);
                continue;
            }
            self.out.truncate(before);
            for piece in &pieces {
                let (item, error) = read(self, piece);
                if error.is_none() && piece.open {
                    self.missing_end(piece);
                }
                self.complain(error, piece);
                result.push(item);
            }
        }
        result
    }

    /// Adds an error, unless an unknown character in the statement explains it.
    fn complain(&mut self, error: Option<Diagnostic>, chunk: &Chunk) {
        if !self.tokens.holds_bad(&chunk.head) {
            self.out.extend(error);
        }
    }

    fn missing_end(&mut self, chunk: &Chunk) {
        let last = self.tokens.span(chunk.head.end.saturating_sub(1));
        self.out.push(
            Diagnostic::error(
                "syntax",
                last.end_point(),
                "expected `;` at the end of this statement",
            )
            .label("expected `;`"),
        );
    }

    /// Parses the head of a chunk by a rule.
    fn grammar(&self, rule: Rule, chunk: &Chunk) -> Result<Pair<'a, Rule>, Diagnostic> {
        let start = self.tokens.list[chunk.head.start].start;
        let end = self.tokens.list[chunk.head.end - 1].end;
        let text: &'a str = &self.tokens.source[start..end];
        let wrong = |e: &pest::error::Error<Rule>| error::syntax_error(e, self.tokens, chunk);
        match Grammar::parse(rule, text) {
            Ok(mut pairs) => pairs.next().ok_or_else(|| {
                let span = self.tokens.cover(&chunk.head);
                Diagnostic::error("syntax", span, "cannot read this statement")
            }),
            Err(error) => Err(wrong(&error)),
        }
    }

    fn build(&self, chunk: &Chunk) -> Build {
        Build { file: self.tokens.file, base: self.tokens.list[chunk.head.start].start }
    }

    /// The word at a token as an identifier, if it is one.
    fn word(&self, index: usize) -> Option<Ident> {
        let token = self.tokens.list.get(index)?;
        let text = self.tokens.text(index).to_string();
        (token.kind == Kind::Word).then(|| Ident { text, span: self.tokens.span(index) })
    }

    /// Reads the options of a block.
    fn block(&mut self, body: Option<Range<usize>>) -> Block {
        self.block_with_paths(body).0
    }

    /// Reads the options of a block of which some are paths.
    fn block_with_paths(&mut self, body: Option<Range<usize>>) -> (Block, Vec<PathOption>) {
        let mut block = Block::default();
        let mut paths = Vec::new();
        let Some(body) = body else { return (block, paths) };
        for option in self.each(body, Reader::option) {
            match option {
                Some(AnyOption::Setting(setting)) => block.settings.push(setting),
                Some(AnyOption::Path(path)) => paths.push(path),
                None => block.broken = true,
            }
        }
        (block, paths)
    }

    fn option(&mut self, chunk: &Chunk) -> (Option<AnyOption>, Option<Diagnostic>) {
        if let Some(error) = self.no_block(chunk, "an option") {
            return (None, Some(error));
        }
        let first = self.tokens.text(chunk.head.start);
        let build = self.build(chunk);
        let span = self.tokens.cover(&chunk.head);
        if first == "path" {
            return match self.grammar(Rule::path_line, chunk) {
                Ok(pair) => {
                    let stations = inner(pair).map(|p| build.station(p)).collect();
                    (Some(AnyOption::Path(PathOption { stations, span })), None)
                }
                Err(error) => (None, Some(error)),
            };
        }
        match self.grammar(Rule::option_line, chunk) {
            Ok(pair) => {
                (inner(pair).next().and_then(|p| setting(build, p)).map(AnyOption::Setting), None)
            }
            Err(error) => (None, Some(error)),
        }
    }

    /// An error if the chunk has a block it should not have, or no head at all.
    fn no_block(&mut self, chunk: &Chunk, what: &str) -> Option<Diagnostic> {
        if chunk.head.is_empty() {
            let span = self.tokens.span(chunk.head.start);
            let message =
                format!("expected {what}, found `{}`", self.tokens.text(chunk.head.start));
            return Some(Diagnostic::error("syntax", span, message));
        }
        let body = chunk.body.as_ref()?;
        let span = self.tokens.span(body.start - 1);
        let first = self.tokens.text(chunk.head.start);
        let stray = DECLARATIONS.contains(&first) && !what.contains(first);
        let help = match stray {
            true => format!("a `{first}` cannot stand in here; is a `}}` missing above?"),
            false => "end it with `;`".to_string(),
        };
        Some(Diagnostic::error("syntax", span, format!("{what} has no block")).help(help))
    }
}

/// An option of a block.
enum AnyOption {
    Setting(Setting),
    Path(PathOption),
}

fn setting(build: Build, pair: Pair<'_, Rule>) -> Option<Setting> {
    let span = build.span(&pair);
    let mut parts = inner(pair);
    let name = build.path(&parts.next()?);
    let value = build.expr(parts.next()?);
    Some(Setting { name, value, span })
}

/// Help for a word that should have been one of a list.
fn did_you_mean(word: &str, known: &[&str]) -> String {
    match nearest(word, known.iter().copied()) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("known are {}", known.join(", ")),
    }
}
