//! Which tokens belong to a unit, as the grammar finds them.

use crate::lex::{Kind, Token};

/// Marks the tokens of units.
pub(super) fn units(text: &str, tokens: &[Token]) -> Vec<bool> {
    let mut marks = vec![false; tokens.len()];
    let glued = |i: usize| i > 0 && i < tokens.len() && tokens[i - 1].end == tokens[i].start;
    let word = |i: usize| tokens.get(i).map_or("", |t| t.text(text));
    let kind = |i: usize| tokens.get(i).map(|t| t.kind);
    let named = |i: usize| kind(i) == Some(Kind::Word) && !never_unit(word(i));
    let mut at = 0;
    // The parameters of a component are declared with units: `k: N*m/rad`.
    let mut parameters = false;
    while at < tokens.len() {
        parameters = match word(at) {
            "component" => true,
            "{" | ";" => false,
            _ => parameters,
        };
        if !named(at) {
            at += 1;
            continue;
        }
        let before = (0..at).rev().find(|&i| !tokens[i].is_comment());
        let follows = before.is_some_and(|i| {
            kind(i) == Some(Kind::Number) || word(i) == ")" || (parameters && word(i) == ":")
        });
        if !follows {
            at += 1;
            continue;
        }
        marks[at] = true;
        at += 1;
        loop {
            if word(at) == "^" && glued(at) {
                let minus = usize::from(word(at + 1) == "-" && glued(at + 1));
                let power = at + 1 + minus;
                let whole = word(power).bytes().all(|b| b.is_ascii_digit());
                if kind(power) == Some(Kind::Number) && glued(power) && whole {
                    marks[at..=power].fill(true);
                    at = power + 1;
                    continue;
                }
            }
            let joins =
                matches!(word(at), "*" | "/") && glued(at) && glued(at + 1) && named(at + 1);
            let called = matches!(word(at + 2), "(" | ".") && glued(at + 2);
            if !joins || called {
                break;
            }
            marks[at..=at + 1].fill(true);
            at += 2;
        }
    }
    marks
}

/// Words that are never a unit.
fn never_unit(word: &str) -> bool {
    crate::parse::reserved(word) || matches!(word, "pi" | "with")
}
