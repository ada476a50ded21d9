//! Declarations of files, models and components.

use super::expr::inner;
use super::split::{Chunk, DECLARATIONS};
use super::{Reader, Rule, did_you_mean};
use crate::ast::{Component, ConstraintKind, Decl, DeclKind, Ident, Parameter, Placement, Shape};
use crate::diagnostic::Diagnostic;
use pest::iterators::Pair;

/// Whether a declaration has a block.
#[derive(PartialEq)]
enum Wants {
    No,
    May,
    Must,
}

impl Reader<'_, '_> {
    /// Reads a declaration of any kind.
    pub(super) fn decl(&mut self, chunk: &Chunk) -> (Decl, Option<Diagnostic>) {
        let span = self.tokens.cover(&chunk.head);
        let nameless = Ident { text: String::new(), span };
        let name = self.word(chunk.head.start + 1).filter(|_| chunk.head.len() > 1);
        let mut decl = Decl {
            doc: chunk.doc.clone(),
            name: name.unwrap_or(nameless),
            kind: DeclKind::Broken,
            span,
        };
        let error = self.decl_kind(chunk, &mut decl).err();
        (decl, error)
    }

    fn decl_kind(&mut self, chunk: &Chunk, decl: &mut Decl) -> Result<(), Diagnostic> {
        let word = self.tokens.text(chunk.head.start);
        let (rule, wants) = match word {
            "model" => (Rule::model_head, Wants::Must),
            "const" => (Rule::const_head, Wants::No),
            "param" => (Rule::param_head, Wants::No),
            "input" => (Rule::input_head, Wants::No),
            "gravity" => (Rule::gravity_head, Wants::No),
            "frame" => (Rule::frame_head, Wants::No),
            "joint" => (Rule::joint_head, Wants::May),
            "mass" => (Rule::mass_head, Wants::Must),
            "strand" => (Rule::strand_head, Wants::Must),
            "node" => (Rule::node_head, Wants::May),
            "constraint" => (Rule::constraint_head, Wants::No),
            "torque" => (Rule::torque_head, Wants::No),
            "force" => (Rule::force_head, Wants::No),
            "component" => (Rule::component_head, Wants::Must),
            "place" => (Rule::place_head, Wants::No),
            "import" => (Rule::import_head, Wants::No),
            "scenario" => (Rule::scenario_head, Wants::Must),
            _ => return Err(self.unknown_declaration(chunk)),
        };
        let pair = self.grammar(rule, chunk)?;
        if wants == Wants::No
            && let Some(error) = self.no_block(chunk, &format!("a `{word}`"))
        {
            return Err(error);
        }
        if wants == Wants::Must && chunk.body.is_none() {
            let at = self.tokens.span(chunk.head.end - 1).end_point();
            let message = format!("a `{word}` needs a block `{{ ... }}`");
            return Err(Diagnostic::error("syntax", at, message).label("expected `{`"));
        }
        self.fill(pair, chunk, decl)
    }

    fn fill(
        &mut self,
        pair: Pair<'_, Rule>,
        chunk: &Chunk,
        decl: &mut Decl,
    ) -> Result<(), Diagnostic> {
        let build = self.build(chunk);
        let rule = pair.as_rule();
        let mut parts: Vec<Pair<'_, Rule>> = inner(pair).collect();
        let named = !matches!(rule, Rule::gravity_head | Rule::import_head | Rule::place_head);
        if named && !parts.is_empty() {
            decl.name = build.ident(&parts.remove(0));
        }
        let body = chunk.body.clone();
        let mut parts = parts.into_iter();
        let mut next = || {
            parts.next().ok_or_else(|| {
                Diagnostic::error("syntax", decl.span, "this declaration is not complete")
            })
        };
        decl.kind = match rule {
            Rule::model_head => DeclKind::Model(self.each(body.unwrap_or_default(), Reader::decl)),
            Rule::const_head => DeclKind::Const(build.expr(next()?)),
            Rule::param_head => DeclKind::Param(build.expr(next()?)),
            Rule::input_head => DeclKind::Input(build.expr(next()?)),
            Rule::gravity_head => DeclKind::Gravity(build.expr(next()?)),
            Rule::frame_head => DeclKind::Frame(build.placement(next()?)),
            Rule::joint_head => {
                let kind = build.ident(&next()?);
                let mut part = next()?;
                let mut arguments = Vec::new();
                if part.as_rule() == Rule::arguments {
                    arguments = build.arguments(part);
                    part = next()?;
                }
                DeclKind::Joint(kind, arguments, build.placement(part), self.block(body))
            }
            Rule::mass_head => {
                let frame = build.path(&next()?);
                let shape = next().ok().map(|p| Shape { name: build.ident(&p) });
                DeclKind::Mass(frame, shape, self.block(body))
            }
            Rule::strand_head => {
                let (block, paths) = self.block_with_paths(body);
                DeclKind::Strand(paths, block)
            }
            Rule::node_head => {
                let (first, second) = (next()?, next()?);
                let (at, parent) = match first.as_rule() {
                    Rule::expr => (first, second),
                    _ => (second, first),
                };
                let (parent, at) = (build.path(&parent), Some(build.expr(at)));
                let placement = Placement { parent, at, rotations: Vec::new() };
                DeclKind::Node(placement, self.block(body))
            }
            Rule::constraint_head => DeclKind::Constraint(self.constraint(next()?, chunk)?),
            Rule::torque_head => DeclKind::Torque(build.path(&next()?), build.expr(next()?)),
            Rule::force_head => {
                let point = build.point(next()?);
                let value = build.expr(next()?);
                DeclKind::Force(point, value, next().ok().map(|p| build.path(&p)))
            }
            Rule::place_head => {
                let component = build.ident(&next()?);
                let mut part = next()?;
                let mut arguments = Vec::new();
                if part.as_rule() == Rule::arguments {
                    arguments = build.arguments(part);
                    part = next()?;
                }
                let name = build.ident(&part);
                let placement = build.placement(next()?);
                decl.name = name;
                DeclKind::Place(component, arguments, placement)
            }
            Rule::import_head => DeclKind::Import(next()?.as_str().trim_matches('"').to_string()),
            Rule::component_head => {
                let parameters = parts.filter_map(|p| parameter(build, p)).collect();
                let body = self.each(body.unwrap_or_default(), Reader::decl);
                DeclKind::Component(Component { parameters, body })
            }
            _ => DeclKind::Scenario(self.each(body.unwrap_or_default(), Reader::statement)),
        };
        Ok(())
    }

    fn constraint(
        &self,
        pair: Pair<'_, Rule>,
        chunk: &Chunk,
    ) -> Result<ConstraintKind, Diagnostic> {
        let build = self.build(chunk);
        let span = build.span(&pair);
        let rule = pair.as_rule();
        let mut parts = inner(pair);
        let mut next = || {
            parts
                .next()
                .ok_or_else(|| Diagnostic::error("syntax", span, "this constraint is not complete"))
        };
        Ok(match rule {
            Rule::coincident => ConstraintKind::Coincident(
                build.point(next()?),
                build.point(next()?),
                next().ok().map(|p| build.expr(p)),
            ),
            Rule::distance => ConstraintKind::Distance(
                build.point(next()?),
                build.point(next()?),
                build.expr(next()?),
            ),
            Rule::on_plane => {
                let point = build.point(next()?);
                let frame = build.path(&next()?);
                ConstraintKind::OnPlane(
                    point,
                    frame,
                    parts.filter_map(|p| build.argument(p)).collect(),
                )
            }
            Rule::weld => ConstraintKind::Weld(build.path(&next()?), build.path(&next()?)),
            _ => ConstraintKind::Equation(build.expr(next()?), build.expr(next()?)),
        })
    }

    fn unknown_declaration(&self, chunk: &Chunk) -> Diagnostic {
        let at = chunk.head.start;
        let span = self.tokens.span(at);
        match self.word(at).filter(|_| !chunk.head.is_empty()) {
            Some(word) => {
                let message = format!("`{}` does not open a declaration", word.text);
                Diagnostic::error("unknown-declaration", span, message)
                    .help(did_you_mean(&word.text, &DECLARATIONS))
            }
            None => {
                let message = format!("expected a declaration, found `{}`", self.tokens.text(at));
                Diagnostic::error("syntax", span, message)
            }
        }
    }
}

fn parameter(build: super::Build, pair: Pair<'_, Rule>) -> Option<Parameter> {
    let mut parts = inner(pair);
    let name = build.ident(&parts.next()?);
    let dimension = build.unit(parts.next()?.into_inner().next()?);
    let default = parts.next().map(|p| build.expr(p));
    Some(Parameter { name, dimension, default })
}
