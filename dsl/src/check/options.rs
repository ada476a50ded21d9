//! Options of blocks: each known, each given once.

use super::Checker;
use crate::ast::{self, Block, Setting};
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::suggest::nearest;
use std::collections::BTreeMap;

/// The options of one block by name.
pub(super) struct Options<'a> {
    given: BTreeMap<&'a str, &'a Setting>,
    /// Whether something could not be read or was not known: then nothing is missing.
    pub(super) broken: bool,
}

impl<'a> Options<'a> {
    /// The value of an option.
    pub(super) fn get(&self, name: &str) -> Option<&'a ast::Expr> {
        self.given.get(name).map(|s| &s.value)
    }

    /// The whole option.
    pub(super) fn setting(&self, name: &str) -> Option<&'a Setting> {
        self.given.get(name).copied()
    }
}

impl<'a> Checker<'a> {
    /// Sorts the options of a block; complains about unknown and repeated ones.
    pub(super) fn options(&mut self, block: &'a Block, what: &str, known: &[&str]) -> Options<'a> {
        let mut options = Options { given: BTreeMap::new(), broken: block.broken };
        for setting in &block.settings {
            let [name] = setting.name.parts.as_slice() else {
                let message = "an option is one word";
                self.report(Diagnostic::error("unknown-option", setting.name.span, message));
                options.broken = true;
                continue;
            };
            if !known.contains(&name.text.as_str()) {
                let message = format!("{what} has no option `{}`", name.text);
                let help = match nearest(&name.text, known.iter().copied()) {
                    Some(near) => format!("did you mean `{near}`? Known are {}", known.join(", ")),
                    None => format!("known are {}", known.join(", ")),
                };
                self.report(Diagnostic::error("unknown-option", name.span, message).help(help));
                options.broken = true;
            } else if let Some(first) = options.given.get(name.text.as_str()) {
                let message = format!("`{}` is given twice", name.text);
                self.report(
                    Diagnostic::error("duplicate", name.span, message)
                        .also(first.name.span, "first given here"),
                );
            } else {
                options.given.insert(&name.text, setting);
            }
        }
        options
    }

    /// Complains that an option is missing, unless the block is broken anyway.
    pub(super) fn missing(
        &mut self,
        options: &Options<'_>,
        span: Span,
        what: &str,
        name: &str,
        example: &str,
    ) {
        if !options.broken {
            let message = format!("{what} needs `{name}`");
            let error = Diagnostic::error("missing-option", span, message);
            self.report(error.help(format!("add `{example}` to its block")));
        }
    }
}
