//! Strands.

use super::Checker;
use super::depend::May;
use crate::ast::{DeclKind, Expr, ExprKind};
use crate::diagnostic::Diagnostic;
use crate::dimension::Dimension;
use crate::hir;

const OPTIONS: [&str; 8] =
    ["stiffness", "rest", "damping", "slack", "slack_width", "energy", "tension", "actuated"];
/// Options a back end does not know yet.
const LATER: [&str; 6] = ["damping", "slack", "slack_width", "energy", "tension", "actuated"];

impl Checker<'_> {
    pub(super) fn finish_strands(&mut self) -> Vec<hir::Strand> {
        let mut strands = Vec::new();
        for index in 0..self.strands.len() {
            let item = &self.strands[index];
            let (scope, decl, name) = (item.scope, item.decl, item.name.clone());
            let DeclKind::Strand(paths, block) = &decl.kind else { continue };
            let known: Vec<&str> = std::iter::once("path").chain(OPTIONS).collect();
            let mut options = self.options(block, "a strand", &known);
            let path = self.path(scope, paths, options.broken, name.span);
            for later in LATER {
                let Some(setting) = options.setting(later) else { continue };
                if says_no(&setting.value) && matches!(later, "slack" | "actuated") {
                    continue;
                }
                let message = format!("`{later}` of a strand is not supported yet");
                self.report(Diagnostic::error("unsupported", setting.span, message));
                options.broken = true;
            }
            let stiffness = match options.get("stiffness") {
                Some(text) => {
                    let what = "`stiffness` of a strand";
                    self.expect(scope, text, Dimension::STIFFNESS, what, May::PARAMS)
                }
                None => {
                    self.missing(
                        &options,
                        name.span,
                        "a strand",
                        "stiffness",
                        "stiffness = 200 N/m;",
                    );
                    None
                }
            };
            if let Some(stiffness) = &stiffness {
                self.must(stiffness, |x| x >= 0.0, "`stiffness` of a strand cannot be negative");
            }
            let rest = options.get("rest").and_then(|text| {
                self.expect(scope, text, Dimension::LENGTH, "`rest` of a strand", May::REST)
            });
            if let Some(rest) = &rest {
                self.must(rest, |x| x >= 0.0, "a natural length cannot be negative");
            }
            if let (Some((path, wraps)), Some(stiffness)) = (path, stiffness) {
                strands.push(hir::Strand { name, path, wraps, stiffness, rest, span: decl.span });
            }
        }
        strands
    }
}

/// Whether an option is switched off: then it asks for nothing.
fn says_no(value: &Expr) -> bool {
    matches!(&value.kind, ExprKind::Path(path)
        if path.parts.len() == 1 && path.parts[0].text == "false")
}
