//! Names: what a dotted name stands for, seen from a scope.

use super::Checker;
use super::scope::{Entry, Scope, ScopeId};
use super::value::NamedId;
use crate::ast::{Ident, Path};
use crate::diagnostic::Diagnostic;
use crate::dimension::Dimension;
use crate::hir::{ConstraintId, Own};
use crate::parse::reserved;
use crate::suggest::nearest;

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Entity {
    Time,
    Pi,
    /// What the strand whose law is read does.
    Own(Own),
    Named(NamedId),
    Frame(usize),
    Joint(usize),
    /// Index of a coordinate.
    Coordinate(usize),
    Instance(ScopeId),
    Strand(usize),
    Constraint(usize),
    /// A row of a constraint, with the dimension of its multiplier.
    Multiplier(ConstraintId, u32, Dimension),
}

/// Beyond this many errors no names are suggested: nobody reads them.
const SUGGEST_UP_TO: usize = 100;

impl<'a> Checker<'a> {
    /// What a name stands for; `None` if it is not known (reported) or broken (reported before).
    pub(super) fn entity(&mut self, scope: ScopeId, path: &'a Path) -> Option<Entity> {
        let first = path.parts.first()?;
        let rest = &path.parts[1..];
        match first.text.as_str() {
            "x" if rest.is_empty() && self.in_law => return Some(Entity::Own(Own::Length)),
            "x0" if rest.is_empty() && self.in_law => return Some(Entity::Own(Own::Rest)),
            "world" if rest.is_empty() => return Some(Entity::Frame(0)),
            "t" if rest.is_empty() => return Some(Entity::Time),
            "base" if rest.is_empty() => {
                let base = self.scopes[scope.0].base;
                if base.is_none() {
                    let message =
                        "`base` is the frame an instance is placed in; the model has none";
                    let error = Diagnostic::error("no-base", first.span, message);
                    self.report(error.help("write `world`, or name the instance: `index.base`"));
                }
                return base.map(Entity::Frame);
            }
            _ => {}
        }
        match self.scopes[scope.0].names.get(first.text.as_str()) {
            Some(&entry) => self.follow(entry, first, rest),
            None if first.text == "pi" && rest.is_empty() => Some(Entity::Pi),
            None if first.text == "lambda" && !rest.is_empty() => self.multiplier(scope, path),
            None => {
                self.unknown(scope, first);
                None
            }
        }
    }

    /// As [`Self::entity`], without complaints.
    pub(super) fn peek(&mut self, scope: ScopeId, path: &'a Path) -> Option<Entity> {
        let before = self.out.len();
        let entity = self.entity(scope, path);
        self.out.truncate(before);
        entity
    }

    fn follow(&mut self, entry: Entry, name: &'a Ident, rest: &'a [Ident]) -> Option<Entity> {
        let (entry, name, rest) = match (entry, rest) {
            (Entry::Instance(inner), [next, rest @ ..]) => {
                if next.text == "base" && rest.is_empty() {
                    return self.scopes[inner.0].base.map(Entity::Frame);
                }
                let Some(&found) = self.scopes[inner.0].names.get(next.text.as_str()) else {
                    self.unknown_inside(inner, name, next);
                    return None;
                };
                return self.follow(found, next, rest);
            }
            other => (other.0, name, other.1),
        };
        if let (Entry::Joint(joint), [part]) = (entry, rest) {
            return self.joint_part(joint, name, part);
        }
        if let (Entry::Strand(strand), [part]) = (entry, rest)
            && let Some(found) = self.muscle_part(strand, part)
        {
            return Some(found);
        }
        if let (Entry::Strand(strand), [part]) = (entry, rest)
            && part.text == "rest"
        {
            if let Some(&(_, input)) = self.actuators.iter().find(|a| a.0 == strand) {
                return Some(Entity::Named(NamedId::Input(input)));
            }
            let message = format!("`{}` has no input `rest`", name.text);
            let error = Diagnostic::error("unknown-name", part.span, message);
            self.report(error.help("give it one: `actuated = true;` in the strand's block"));
            return None;
        }
        if let [part, ..] = rest
            && entry != Entry::Broken
        {
            let message = format!("`{}` has no part `{}`", name.text, part.text);
            self.report(Diagnostic::error("unknown-name", part.span, message));
            return None;
        }
        Some(match entry {
            Entry::Const(i) => Entity::Named(NamedId::Const(i)),
            Entry::Param(i) => Entity::Named(NamedId::Param(i)),
            Entry::Input(i) => Entity::Named(NamedId::Input(i)),
            Entry::Argument(i) => Entity::Named(NamedId::Argument(i)),
            Entry::Frame(i) => Entity::Frame(i),
            Entry::Joint(i) => Entity::Joint(i),
            Entry::Instance(i) => Entity::Instance(i),
            Entry::Strand(i) => Entity::Strand(i),
            Entry::Constraint(i) => Entity::Constraint(i),
            Entry::Broken => return None,
        })
    }

    fn joint_part(&mut self, joint: usize, name: &Ident, part: &Ident) -> Option<Entity> {
        let raw = &self.joints[joint];
        raw.kind?;
        let range = raw.coordinates.clone();
        let own = format!("{}.{}", raw.item.name.text, part.text);
        if let Some(index) = self.coordinate_names[range.clone()].iter().position(|n| *n == own) {
            return Some(Entity::Coordinate(range.start + index));
        }
        let message = format!("`{}` has no coordinate `{}`", name.text, part.text);
        let help = match range.len() {
            1 => {
                let only = &self.coordinate_names[range.start];
                let last = only.strip_prefix(&raw.item.name.text).unwrap_or_default();
                format!("it has one, called `{}{last}`", name.text)
            }
            _ => self.parts_help(joint, &name.text),
        };
        self.report(Diagnostic::error("unknown-name", part.span, message).help(help));
        None
    }

    fn unknown(&mut self, scope: ScopeId, name: &Ident) {
        let message = format!("unknown name `{}`", name.text);
        let mut error = Diagnostic::error("unknown-name", name.span, message);
        if self.out.len() < SUGGEST_UP_TO {
            let outside =
                std::iter::successors(self.scopes[scope.0].outer, |s| self.scopes[s.0].outer)
                    .any(|s| self.scopes[s.0].names.contains_key(name.text.as_str()));
            let here = &self.scopes[scope.0];
            let near =
                nearest(&name.text, here.names.keys().copied().chain(std::iter::once("world")));
            let within: Vec<String> = self.homes(scope, &name.text);
            error = if outside {
                error.help(format!(
                    "`{}` stands outside: a component sees only its parameters and its own names; \
                     pass it as a parameter",
                    name.text
                ))
            } else if let Some(near) = near {
                error.help(format!("did you mean `{near}`?"))
            } else if let [home, ..] = within.as_slice() {
                error.help(format!("did you mean `{home}`?"))
            } else if reserved(&name.text) {
                error.help(format!("`{}` is a reserved word", name.text))
            } else {
                error
            };
        }
        self.report(error);
    }

    /// Instances of a scope that know a name.
    fn homes(&self, scope: ScopeId, name: &str) -> Vec<String> {
        let here = &self.scopes[scope.0];
        here.names
            .iter()
            .filter_map(|(instance, entry)| match entry {
                Entry::Instance(inner) if self.scopes[inner.0].names.contains_key(name) => {
                    Some(format!("{instance}.{name}"))
                }
                _ => None,
            })
            .collect()
    }

    fn unknown_inside(&mut self, inner: ScopeId, name: &Ident, part: &Ident) {
        let message = format!("`{}` has no `{}`", name.text, part.text);
        let names: Vec<&str> = self.scopes[inner.0].names.keys().copied().collect();
        let help = match nearest(&part.text, names.iter().copied()) {
            Some(near) => format!("did you mean `{}.{near}`?", name.text),
            None if names.is_empty() => "it declares no names".to_string(),
            None => {
                let shown: Vec<&str> = names.iter().take(12).copied().collect();
                let more = if names.len() > 12 { ", ..." } else { "" };
                format!("it has {}{more}", shown.join(", "))
            }
        };
        self.report(Diagnostic::error("unknown-name", part.span, message).help(help));
    }

    /// `lambda.C` or `lambda.C.row`.
    fn multiplier(&mut self, scope: ScopeId, path: &'a Path) -> Option<Entity> {
        let mut here = scope;
        let mut parts = path.parts[1..].iter();
        let mut name = parts.next()?;
        let index = loop {
            let level: &Scope<'a> = &self.scopes[here.0];
            match (level.constraints.get(name.text.as_str()), level.names.get(name.text.as_str())) {
                (Some(Entry::Constraint(index)), _) => break *index,
                (Some(_), _) | (_, Some(Entry::Broken)) => return None,
                (None, Some(Entry::Instance(inner))) if parts.len() > 0 => {
                    here = *inner;
                    name = parts.next()?;
                }
                _ => {
                    let near = nearest(&name.text, level.constraints.keys().copied())
                        .map(|n| format!("did you mean `{n}`?"));
                    let message = format!("there is no constraint `{}`", name.text);
                    self.report(
                        Diagnostic::error("unknown-name", name.span, message).help_if(near),
                    );
                    return None;
                }
            }
        };
        let rows = self.constraint_rows(index)?;
        let row = match parts.as_slice() {
            [] if rows.len() == 1 => 0,
            [row] => rows.iter().position(|r| r.0 == row.text).unwrap_or(usize::MAX),
            _ => usize::MAX,
        };
        let Some(&(_, dimension)) = rows.get(row) else {
            let known: Vec<String> =
                rows.iter().map(|r| format!("`lambda.{}.{}`", name.text, r.0)).collect();
            let help = match rows.len() {
                1 if rows[0].0.is_empty() => format!("it has one row: `lambda.{}`", name.text),
                _ => format!("its rows are {}", known.join(", ")),
            };
            let message = format!("this is not a row of the constraint `{}`", name.text);
            self.report(Diagnostic::error("unknown-name", path.span, message).help(help));
            return None;
        };
        Some(Entity::Multiplier(ConstraintId(index as u32), row as u32, dimension))
    }
}
