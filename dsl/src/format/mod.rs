//! `handc fmt`: one layout for all files.
//!
//! Tokens and comments stay as they are and in their order; only the space between them changes:
//! four spaces for each block, one statement on a line, at most one blank line in a row. A block
//! that stood on one line stays on one, and a statement broken over lines stays broken there.
//! Comments behind neighbouring lines that stood in one column do so again.
//! Space can carry meaning only around units (`3 rad/s * t`), so units are found as the grammar does.

mod align;
mod units;

use crate::diagnostic::Diagnostic;
use crate::lex::{Kind, Token, lex};
use crate::parse::{DECLARATIONS, parse};
use crate::source::{FileId, Span};
use align::{Remark, align};
use std::collections::BTreeMap;
use units::units;

/// Lays out a text. A text with syntax errors is not touched: the errors come back.
pub fn format_text(text: &str) -> Result<String, Vec<Diagnostic>> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut errors = Vec::new();
    if text.len() > crate::guard::MAX_BYTES {
        return Err(vec![crate::guard::too_large(Span::default(), "the text", text.len() as u64)]);
    }
    parse(text, FileId(0), &mut errors);
    if errors.iter().any(Diagnostic::is_error) {
        return Err(errors);
    }
    let tokens = lex(text);
    let layout =
        Layout { text, units: units(text, &tokens), inline: inline(text, &tokens), tokens };
    Ok(layout.write())
}

/// What stands between two tokens.
#[derive(Clone, Copy, PartialEq)]
enum Gap {
    None,
    Space,
    /// A new line, perhaps behind a blank one.
    Line(bool),
}

struct Layout<'a> {
    text: &'a str,
    tokens: Vec<Token>,
    /// For each token, whether it belongs to a unit.
    units: Vec<bool>,
    /// For each opening brace, whether its block stands on one line.
    inline: BTreeMap<usize, bool>,
}

/// Finds the blocks that stand on one line.
fn inline(text: &str, tokens: &[Token]) -> BTreeMap<usize, bool> {
    let mut result = BTreeMap::new();
    let mut open = Vec::new();
    for (index, token) in tokens.iter().enumerate() {
        match (token.kind, token.text(text)) {
            (Kind::Symbol, "{") => open.push(index),
            (Kind::Symbol, "}") => {
                if let Some(start) = open.pop() {
                    let inside = &text[tokens[start].end..token.start];
                    result.insert(start, !inside.contains('\n'));
                }
            }
            _ => {}
        }
    }
    result
}

impl Layout<'_> {
    fn write(&self) -> String {
        let mut out = String::with_capacity(self.text.len());
        let mut blocks: Vec<bool> = Vec::new();
        let mut remarks: Vec<Remark> = Vec::new();
        // Whether a statement is about to begin.
        let mut fresh = true;
        for (index, token) in self.tokens.iter().enumerate() {
            let text = token.text(self.text);
            let symbol = token.kind == Kind::Symbol;
            let on_one_line = blocks.last().copied().unwrap_or(false);
            let gap = self.gap(index, fresh, on_one_line);
            if symbol && text == "}" {
                blocks.pop();
                fresh = true;
            }
            match gap {
                Gap::None => {}
                Gap::Space if token.kind == Kind::Line => {
                    remarks.push(Remark { at: out.len(), column: self.column(token.start) });
                    out.push(' ');
                }
                Gap::Space => out.push(' '),
                Gap::Line(blank) => {
                    out.push_str(if blank { "\n\n" } else { "\n" });
                    let depth = blocks.iter().filter(|inline| !**inline).count();
                    let closes = symbol && text == ")";
                    let more = usize::from(!fresh && !closes);
                    out.push_str(&"    ".repeat(depth + more));
                }
            }
            match token.kind {
                Kind::Line | Kind::Doc => out.push_str(text.trim_end()),
                Kind::Block => out.push_str(&text.replace('\r', "")),
                _ => out.push_str(text),
            }
            if symbol && text == "{" {
                blocks.push(self.inline.get(&index).copied().unwrap_or(false));
            }
            if !token.is_comment() {
                fresh = symbol && matches!(text, "{" | "}" | ";");
            }
        }
        if !out.is_empty() {
            out.push('\n');
        }
        align(&out, &remarks)
    }

    /// Characters between the start of the line and a place in the text.
    fn column(&self, at: usize) -> usize {
        let before = &self.text[..at];
        before[before.rfind('\n').map_or(0, |i| i + 1)..].chars().count()
    }

    fn gap(&self, index: usize, fresh: bool, on_one_line: bool) -> Gap {
        let Some(before) = index.checked_sub(1) else { return Gap::None };
        let (last, token) = (&self.tokens[before], &self.tokens[index]);
        let lines = self.text[last.end..token.start].matches('\n').count();
        let symbol = |t: &Token| match t.kind {
            Kind::Symbol => t.text(self.text),
            _ => "",
        };
        let (left, right) = (symbol(last), symbol(token));
        let blank = lines >= 2 && fresh && left != "{" && right != "}";
        if matches!(last.kind, Kind::Line | Kind::Doc) {
            return Gap::Line(blank);
        }
        if token.is_comment() || last.kind == Kind::Block {
            return match lines {
                0 if right == "}" && !on_one_line => Gap::Line(false),
                0 => Gap::Space,
                _ => Gap::Line(blank),
            };
        }
        if left == "}" && right == ";" {
            return Gap::None;
        }
        if matches!(left, "{" | "}" | ";") || right == "}" {
            return if on_one_line { Gap::Space } else { Gap::Line(blank) };
        }
        if right == "{" {
            return Gap::Space;
        }
        if lines > 0 && !matches!(right, ";" | ",") {
            return Gap::Line(false);
        }
        if self.tight(before, index, left, right) { Gap::None } else { Gap::Space }
    }

    /// Whether two neighbours on a line stand without a space.
    fn tight(&self, before: usize, index: usize, left: &str, right: &str) -> bool {
        if self.units[index] {
            // Inside a unit nothing stands apart; its first word stands apart from the number.
            return self.units[before];
        }
        if left == "(" || matches!(right, ")" | "," | ";" | ":" | ".") || left == "." {
            return true;
        }
        if right == "(" {
            // `sin(` and `universal(`, but `world (1, 2, 3) mm`: as it was, unless a word forbids it.
            let word = self.tokens[before].text(self.text);
            let name = self.tokens[before].kind == Kind::Word;
            let glued = self.tokens[before].end == self.tokens[index].start;
            let keyword = DECLARATIONS.contains(&word)
                || matches!(word, "in" | "at" | "rotate" | "as" | "on" | "with");
            return name && (glued || word == "if") && !keyword || self.negates(before);
        }
        if right == "^" || left == "^" {
            let at = if right == "^" { index } else { before };
            // `2 m ^ 2` squares the quantity, `2 m^2` the unit.
            return at == 0 || !self.units[at - 1];
        }
        self.negates(before)
    }

    /// Whether a token is a sign rather than a difference.
    fn negates(&self, index: usize) -> bool {
        if self.tokens[index].kind != Kind::Symbol || self.tokens[index].text(self.text) != "-" {
            return false;
        }
        let Some(before) = (0..index).rev().find(|&i| !self.tokens[i].is_comment()) else {
            return true;
        };
        let word = self.tokens[before].text(self.text);
        match self.tokens[before].kind {
            Kind::Symbol => word != ")" || self.axis_ends(before),
            Kind::Word => {
                matches!(word, "in" | "at" | "rotate" | "as" | "on" | "record")
                    || self.axis_ends(before)
            }
            _ => false,
        }
    }

    /// Whether the axis of a `rotate` ends at a token: a sign behind it begins the angle.
    fn axis_ends(&self, index: usize) -> bool {
        let mut at = index;
        if self.tokens[at].text(self.text) == ")" {
            let mut depth = 0usize;
            loop {
                match self.tokens[at].text(self.text) {
                    ")" => depth += 1,
                    "(" => depth -= 1,
                    _ => {}
                }
                if depth == 0 || at == 0 {
                    break;
                }
                at -= 1;
            }
        }
        let word = |i: usize| self.tokens[i].text(self.text);
        let back = |i: usize| (0..i).rev().find(|&j| !self.tokens[j].is_comment());
        let mut previous = back(at);
        if previous.is_some_and(|i| word(i) == "-") {
            previous = previous.and_then(back);
        }
        previous.is_some_and(|i| word(i) == "rotate")
    }
}

#[cfg(test)]
mod tests {
    use super::format_text;

    #[track_caller]
    fn check(text: &str, expected: &str) {
        let once = format_text(text).unwrap();
        assert_eq!(once, expected);
        assert_eq!(format_text(&once).unwrap(), once, "not idempotent");
    }

    #[test]
    fn lays_out_blocks() {
        check(
            "model a{const x=1;const y=2*x;\n\n\n\njoint j:revolute( z )in world{start=0.1;}\n}",
            "model a {\n    const x = 1;\n    const y = 2 * x;\n\n    joint j: revolute(z) in world { start = 0.1; }\n}\n",
        );
    }

    #[test]
    fn keeps_units_and_signs() {
        check(
            "model a {\nparam a=3   rad/s*t;\nparam b = 2 m ^2; param c=-1e-5N*m*s/rad/2; frame f in world at -(1,2,3)mm rotate x -3 deg rotate (0,0,1) - 2;\n}\n",
            "model a {\n    param a = 3 rad/s * t;\n    param b = 2 m ^ 2;\n    param c = -1e-5 N*m*s/rad / 2;\n    frame f in world at -(1, 2, 3) mm rotate x -3 deg rotate (0, 0, 1) -2;\n}\n",
        );
    }

    #[test]
    fn comments_in_one_column_stay_in_one() {
        check(
            "model a {\n  const x = 1;     // one\n  const long = 12;  // two\n  param y=3   ;     // three\n  param z = 4;      // four\n\n  param w = 5;      // five\n}\n",
            "model a {\n    const x = 1; // one\n    const long = 12; // two\n    param y = 3;     // three\n    param z = 4;     // four\n\n    param w = 5; // five\n}\n",
        );
    }

    #[test]
    fn keeps_comments_and_broken_lines() {
        check(
            "// top\n\n\n/// doc\nmodel a { // here\n  strand s { path = world\n-> world (1,0,0) mm ; // end\n /* last */ }\n}",
            "// top\n\n/// doc\nmodel a { // here\n    strand s {\n        path = world\n            -> world (1, 0, 0) mm; // end\n        /* last */\n    }\n}\n",
        );
    }
}
