//! Files put together: which is the model, and which components each file sees.

use crate::ast::{Decl, DeclKind};
use crate::check::{FileComponents, Program};
use crate::diagnostic::Diagnostic;
use crate::load::Parsed;
use crate::source::{FileId, SourceMap, Span};

/// Collects what is to be checked; says what stands in the wrong place.
pub(crate) fn assemble<'a>(
    parsed: &'a [Parsed],
    sources: &'a SourceMap,
    out: &mut Vec<Diagnostic>,
) -> Program<'a> {
    let mut program =
        Program { model: None, scenarios: Vec::new(), components: Vec::new(), sources };
    for index in 0..parsed.len() {
        let declared = parsed[index].file.items.iter();
        let declared = declared.filter(|d| matches!(d.kind, DeclKind::Component(_))).collect();
        program.components.push(FileComponents { declared, visible: reachable(parsed, index) });
    }
    let Some(first) = parsed.first() else { return program };
    let mut broken = false;
    for item in &first.file.items {
        match &item.kind {
            DeclKind::Model(_) => match program.model {
                None => program.model = Some(item),
                Some(model) => out.push(
                    Diagnostic::error("two-models", item.name.span, "a file holds one model")
                        .also(model.name.span, "the first one"),
                ),
            },
            DeclKind::Scenario(_) => program.scenarios.push(item),
            DeclKind::Component(_) | DeclKind::Import(_) => {}
            DeclKind::Broken => broken = true,
            _ => out.push(misplaced(item, sources)),
        }
    }
    for other in &parsed[1..] {
        for item in &other.file.items {
            let fine = matches!(
                item.kind,
                DeclKind::Model(_)
                    | DeclKind::Scenario(_)
                    | DeclKind::Component(_)
                    | DeclKind::Import(_)
                    | DeclKind::Broken
            );
            if !fine {
                out.push(misplaced(item, sources));
            }
        }
    }
    let silent = broken || out.iter().any(|d| d.code == "too-deep" || d.code == "too-long");
    if program.model.is_none() && !silent {
        let span = Span::new(FileId(0), 0, 0);
        let message = format!("`{}` declares no model", sources.path(FileId(0)));
        let help = match program.components[0].declared.len() {
            0 => "a model is `model NAME { ... }`",
            _ => "it holds components: import it in the file of a model",
        };
        out.push(Diagnostic::error("no-model", span, message).help(help));
    }
    program
}

fn misplaced(item: &Decl, sources: &SourceMap) -> Diagnostic {
    let word = sources.slice(item.span).split(|c: char| !c.is_ascii_alphanumeric()).next();
    let message = format!("a `{}` stands in a model or a component", word.unwrap_or_default());
    Diagnostic::error("misplaced", item.span, message)
}

/// The files whose components a file sees: those it imports, and those they import.
fn reachable(parsed: &[Parsed], from: usize) -> Vec<usize> {
    let mut seen = Vec::new();
    let mut queue = parsed[from].imports.clone();
    while let Some(next) = queue.pop() {
        if next != from && !seen.contains(&next) {
            seen.push(next);
            queue.extend(&parsed[next].imports);
        }
    }
    seen.sort_unstable();
    seen
}
