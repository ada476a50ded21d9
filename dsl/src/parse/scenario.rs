//! Statements of a scenario.

use super::expr::inner;
use super::split::Chunk;
use super::{Reader, Rule, did_you_mean, setting};
use crate::ast::{Ident, Statement, StatementKind};
use crate::diagnostic::Diagnostic;

/// The words that open a statement of a scenario.
pub(crate) const STATEMENTS: [&str; 12] = [
    "step",
    "duration",
    "tolerance",
    "set",
    "start",
    "velocity",
    "input",
    "pose",
    "motion",
    "follow",
    "drive",
    "record",
];

impl Reader<'_, '_> {
    pub(super) fn statement(&mut self, chunk: &Chunk) -> (Statement, Option<Diagnostic>) {
        let span = self.tokens.cover(&chunk.head);
        let (kind, error) = match self.statement_kind(chunk) {
            Ok(kind) => (kind, None),
            Err(error) => (StatementKind::Broken(self.broken_name(chunk)), Some(error)),
        };
        (Statement { doc: chunk.doc.clone(), kind, span }, error)
    }

    /// The name a broken statement would have declared.
    fn broken_name(&self, chunk: &Chunk) -> Option<Ident> {
        match self.tokens.text(chunk.head.start) {
            "pose" => self.word(chunk.head.start + 1),
            "motion" if self.tokens.text(chunk.head.start + 1) == "=" => {
                self.word(chunk.head.start)
            }
            "motion" => self.word(chunk.head.start + 1),
            _ => None,
        }
        .filter(|_| chunk.head.len() > 1)
    }

    fn statement_kind(&mut self, chunk: &Chunk) -> Result<StatementKind, Diagnostic> {
        let word = self.tokens.text(chunk.head.start);
        let build = self.build_or_start(chunk);
        if word == "pose" {
            let pair = self.grammar(Rule::pose_head, chunk)?;
            let name = inner(pair).next().map(|p| build.ident(&p));
            if chunk.body.is_none() {
                let at = self.tokens.span(chunk.head.end - 1).end_point();
                let message = "a `pose` needs a block `{ ... }`";
                return Err(Diagnostic::error("syntax", at, message).label("expected `{`"));
            }
            let block = self.block(chunk.body.clone());
            return Ok(match name {
                Some(name) => StatementKind::Pose(name, block),
                None => StatementKind::Broken(None),
            });
        }
        if let Some(error) = self.no_block(chunk, "this statement") {
            return Err(error);
        }
        let assigns = self.tokens.text(chunk.head.start + 1) == "=" && chunk.head.len() > 1;
        if assigns && word != "motion" {
            let pair = self.grammar(Rule::option_line, chunk)?;
            let setting = inner(pair).next().and_then(|p| setting(build, p));
            return Ok(setting.map_or(StatementKind::Broken(None), StatementKind::Setting));
        }
        let rule = match word {
            "set" | "start" | "velocity" | "input" | "drive" => Rule::set_line,
            "motion" => Rule::motion_line,
            "follow" => Rule::follow_line,
            "record" => Rule::record_line,
            "step" | "duration" | "tolerance" => Rule::option_line,
            _ => return Err(self.unknown_statement(chunk)),
        };
        let pair = self.grammar(rule, chunk)?;
        let mut parts = inner(pair);
        let read = match rule {
            Rule::set_line => {
                parts.nth(1).and_then(|p| setting(build, p)).map(|setting| match word {
                    "set" => StatementKind::Set(setting),
                    "start" => StatementKind::Start(setting),
                    "velocity" => StatementKind::Velocity(setting),
                    "input" => StatementKind::Input(setting),
                    _ => StatementKind::Drive(setting),
                })
            }
            Rule::motion_line => {
                let mut name =
                    Ident { text: "motion".into(), span: self.tokens.span(chunk.head.start) };
                let mut knots = Vec::new();
                for part in parts {
                    if part.as_rule() == Rule::name {
                        name = build.ident(&part);
                        continue;
                    }
                    let mut pieces = inner(part);
                    if let (Some(pose), Some(time)) = (pieces.next(), pieces.next()) {
                        knots.push((build.ident(&pose), build.expr(time)));
                    }
                }
                Some(StatementKind::Motion(name, knots))
            }
            Rule::follow_line => parts.next().map(|motion| {
                let strands: Vec<_> = parts.map(|p| build.path(&p)).collect();
                let strands = (!strands.is_empty()).then_some(strands);
                StatementKind::Follow(build.ident(&motion), strands)
            }),
            _ => match (parts.next(), parts.next()) {
                (Some(value), Some(name)) => {
                    Some(StatementKind::Record(build.expr(value), build.ident(&name)))
                }
                _ => None,
            },
        };
        Ok(read.unwrap_or(StatementKind::Broken(None)))
    }

    fn build_or_start(&self, chunk: &Chunk) -> super::Build {
        let base = self.tokens.list.get(chunk.head.start).map_or(0, |t| t.start);
        super::Build { file: self.tokens.file, base }
    }

    fn unknown_statement(&self, chunk: &Chunk) -> Diagnostic {
        let at = chunk.head.start;
        let span = self.tokens.span(at);
        let text = self.tokens.text(at);
        let message = match super::DECLARATIONS.contains(&text) {
            true => format!("a `{text}` cannot stand in a scenario"),
            false => format!("`{text}` does not open a statement of a scenario"),
        };
        Diagnostic::error("unknown-statement", span, message).help(did_you_mean(text, &STATEMENTS))
    }
}
