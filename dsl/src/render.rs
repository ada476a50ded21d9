//! Diagnostics as text: the source underlined, what was expected, what to do.
//!
//! Only the lines that matter are handed to the renderer, and a span over many lines is cut to its
//! first, so that a model of any size is shown quickly and legibly.

use crate::diagnostic::{Diagnostic, Label, Severity};
use crate::source::{FileId, SourceMap};
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet, normalize_untrusted_str};
use std::ops::Range;

/// How many diagnostics of one file are shown.
const SHOWN_PER_FILE: usize = 50;

/// Renders diagnostics one after the other, separated by blank lines, with a count at the end.
/// At most fifty of one file are shown; how many more there are is said. Lines of the source are cut
/// to 140 columns.
pub fn render(diagnostics: &[Diagnostic], sources: &SourceMap, color: bool) -> String {
    render_within(diagnostics, sources, color, 140)
}

/// As [`render`], for a terminal of so many columns.
pub fn render_within(
    diagnostics: &[Diagnostic],
    sources: &SourceMap,
    color: bool,
    columns: usize,
) -> String {
    let renderer = if color { Renderer::styled() } else { Renderer::plain() };
    let renderer = renderer.term_width(columns);
    let mut shown: Vec<(FileId, usize)> = Vec::new();
    let mut blocks = Vec::new();
    for diagnostic in diagnostics {
        let file = diagnostic.primary.span.file;
        let count = match shown.iter_mut().find(|s| s.0 == file) {
            Some(entry) => {
                entry.1 += 1;
                entry.1
            }
            None => {
                shown.push((file, 1));
                1
            }
        };
        if count <= SHOWN_PER_FILE {
            blocks.push(renderer.render(&[group(diagnostic, sources)]).to_string());
        }
    }
    for (file, count) in shown.iter().filter(|s| s.1 > SHOWN_PER_FILE) {
        let path = normalize_untrusted_str(sources.path(*file));
        blocks.push(format!("... and {} more in {path}", count - SHOWN_PER_FILE));
    }
    // A single remark without a text to point into needs no counting.
    let alone = matches!(diagnostics, [d] if sources.text(d.primary.span.file).is_empty());
    if let Some(summary) = summary(diagnostics).filter(|_| !alone) {
        blocks.push(summary);
    }
    let mut text = blocks.join("\n\n");
    if !text.is_empty() {
        text.push('\n');
    }
    text
}

/// `2 errors and 1 warning`, if there is anything.
fn summary(diagnostics: &[Diagnostic]) -> Option<String> {
    let errors = diagnostics.iter().filter(|d| d.is_error()).count();
    let count = |n: usize, what: &str| match n {
        0 => None,
        1 => Some(format!("1 {what}")),
        n => Some(format!("{n} {what}s")),
    };
    let parts: Vec<String> = [count(errors, "error"), count(diagnostics.len() - errors, "warning")]
        .into_iter()
        .flatten()
        .collect();
    (!parts.is_empty()).then(|| parts.join(" and "))
}

fn group<'a>(diagnostic: &'a Diagnostic, sources: &'a SourceMap) -> Group<'a> {
    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let title = level.primary_title(diagnostic.message.as_str()).id(diagnostic.code);
    let mut group = Group::with_title(title);
    let mut files = vec![diagnostic.primary.span.file];
    for label in &diagnostic.secondary {
        if !files.contains(&label.span.file) {
            files.push(label.span.file);
        }
    }
    for file in files.into_iter().filter(|&file| !sources.text(file).is_empty()) {
        group = group.element(snippet(diagnostic, file, sources));
    }
    if let Some(help) = &diagnostic.help {
        group = group.element(Level::HELP.message(help.as_str()));
    }
    group
}

fn snippet<'a>(
    diagnostic: &'a Diagnostic,
    file: FileId,
    sources: &'a SourceMap,
) -> Snippet<'a, annotate_snippets::Annotation<'a>> {
    let primary = std::iter::once((AnnotationKind::Primary, &diagnostic.primary));
    let secondary = diagnostic.secondary.iter().map(|l| (AnnotationKind::Context, l));
    let labels: Vec<(AnnotationKind, &Label)> =
        primary.chain(secondary).filter(|l| l.1.span.file == file).collect();
    let text = sources.text(file);
    let first = labels.iter().map(|l| sources.line_col(l.1.span).0).min().unwrap_or(1);
    let last = labels.iter().map(|l| sources.line_col(l.1.span).0).max().unwrap_or(1);
    let from = sources.line_start(file, first);
    let to = sources.line_start(file, last + 1);
    let mut snippet = Snippet::source(text.get(from..to).unwrap_or(""))
        .line_start(first)
        .path(normalize_untrusted_str(sources.path(file)));
    for (kind, label) in labels {
        let range = first_line(text, label.span.range());
        let range = range.start.saturating_sub(from)..range.end.saturating_sub(from);
        let annotation = kind.span(range);
        snippet = snippet.annotation(match label.text.as_str() {
            "" => annotation,
            text => annotation.label(text),
        });
    }
    snippet
}

/// The part of a range on its first line, within the text.
fn first_line(text: &str, range: Range<usize>) -> Range<usize> {
    let start = range.start.min(text.len());
    let end = range.end.clamp(start, text.len());
    let Some(inside) = text.get(start..end) else { return start..start };
    match inside.find('\n') {
        Some(0) | None => start..end,
        Some(length) => start..start + inside[..length].trim_end().len(),
    }
}
