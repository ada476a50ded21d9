//! What the grammar's complaint means in words.

use super::Rule;
use super::split::{Chunk, DECLARATIONS, Tokens};
use crate::diagnostic::Diagnostic;
use pest::error::{Error, ErrorVariant, InputLocation};

/// Turns a failure to parse the head of a chunk into a diagnostic.
pub(super) fn syntax_error(error: &Error<Rule>, tokens: &Tokens, chunk: &Chunk) -> Diagnostic {
    let base = tokens.list[chunk.head.start].start;
    let at = base
        + match error.location {
            InputLocation::Pos(at) => at,
            InputLocation::Span((at, _)) => at,
        };
    let found = chunk.head.clone().find(|&i| tokens.list[i].end > at).unwrap_or(chunk.head.end);
    let inside = found < chunk.head.end;
    let end = if chunk.body.is_some() { "`{`" } else { "`;`" };
    let expected = match &error.variant {
        ErrorVariant::ParsingError { positives, .. } => expected(positives, end),
        ErrorVariant::CustomError { .. } => Vec::new(),
    };
    let word = tokens.text(found);
    let names = expected.iter().any(|e| e == "a name");
    let span = match inside {
        true => tokens.span(found),
        false => tokens.span(chunk.head.end - 1).end_point(),
    };
    if inside && names && reserved(word) {
        let message = format!("`{word}` is a reserved word and cannot be a name here");
        return Diagnostic::error("reserved-word", span, message);
    }
    let wanted = list(&expected);
    let what = if inside {
        format!("found `{}`", clip(word))
    } else if chunk.body.is_some() || !chunk.open {
        format!("found `{}`", tokens.text(chunk.head.end))
    } else {
        "found the end of the block".to_string()
    };
    let message = match wanted.is_empty() {
        true => format!("cannot read this statement: {what}"),
        false => format!("expected {wanted}, {what}"),
    };
    let diagnostic = Diagnostic::error("syntax", span, message);
    match wanted.is_empty() {
        true => diagnostic,
        false => diagnostic.label(format!("expected {wanted}")),
    }
    .help_if(hint(tokens, chunk, found))
}

/// Whether a word can never be a name.
pub(crate) fn reserved(word: &str) -> bool {
    DECLARATIONS.contains(&word)
        || matches!(
            word,
            "in" | "at" | "rotate" | "as" | "on" | "through" | "if" | "world" | "base" | "t"
        )
}

/// Advice for mistakes that are easy to make.
fn hint(tokens: &Tokens, chunk: &Chunk, found: usize) -> Option<String> {
    let head = tokens.text(chunk.head.start);
    let previous = found.checked_sub(1).map_or("", |i| tokens.text(i));
    let word = tokens.text(found);
    match (head, previous, word) {
        ("model", _, _) => Some("a model is `model NAME { ... }`; a name is one plain word".into()),
        ("torque", _, "=") => Some("write `torque NAME on JOINT = ...`".into()),
        ("force", _, "=" | "on") => Some("write `force NAME at FRAME (x, y, z) = ...`".into()),
        ("joint", _, "in") if !has(tokens, chunk, ":") => {
            Some("write `joint NAME: KIND in FRAME ...`".into())
        }
        ("frame" | "joint", _, ";" | "{" | "at") if !has(tokens, chunk, "in") => {
            Some("say which frame it stands in: `in world`".into())
        }
        ("frame" | "joint" | "place", _, "at") => Some("`at` stands before `rotate`, once".into()),
        ("import", _, _) => Some("write `import \"file.hdl\";`".into()),
        ("constraint", _, "=") if previous != ")" => {
            Some("an equation is written with `==`".into())
        }
        ("constraint", _, _) if tokens.text(chunk.head.start + 4) == "(" => Some(
            "a constraint is coincident(P, P), distance(P, P) = d, on_plane(P, F, normal = v), \
             weld(F, F) or an equation `a == b`"
                .into(),
        ),
        ("path", _, "(" | "=" | "->") | ("path", ",", _) if found > chunk.head.start + 2 => {
            surface_hint(tokens, chunk, found)
        }
        (_, _, "=")
            if !previous.is_empty() && tokens.list[found - 1].kind == crate::lex::Kind::Word =>
        {
            Some("is a `;` missing before this?".into())
        }
        (_, _, "==" | "<" | ">" | "<=" | ">=" | "!=") => {
            Some("comparisons stand inside `if(condition, a, b)`".into())
        }
        _ => None,
    }
}

/// How a surface is written, where one seems to be meant.
fn surface_hint(tokens: &Tokens, chunk: &Chunk, found: usize) -> Option<String> {
    let meant = |i: usize| matches!(tokens.text(i), "wrap" | "sphere" | "cylinder");
    (chunk.head.start..found).any(meant).then(|| {
        "a surface is written `via wrap sphere(F, radius = 5 mm)` or `via wrap cylinder(F, axis = z, \
         radius = 5 mm)`"
            .into()
    })
}

fn has(tokens: &Tokens, chunk: &Chunk, word: &str) -> bool {
    chunk.head.clone().any(|i| tokens.text(i) == word)
}

fn clip(word: &str) -> String {
    match word.char_indices().nth(40) {
        Some((end, _)) => format!("{}...", &word[..end]),
        None => word.to_string(),
    }
}

/// What would have fitted, the likeliest first, without what could always follow.
fn expected(rules: &[Rule], end: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    for rule in rules {
        let word = match rule {
            Rule::EOI => end,
            Rule::name | Rule::any_word | Rule::segment | Rule::dotted | Rule::setting_name => {
                "a name"
            }
            Rule::setting | Rule::knot => "a name",
            Rule::equals => "`=`",
            Rule::comma => "`,`",
            Rule::open | Rule::arguments => "`(`",
            Rule::close => "`)`",
            Rule::colon => "`:`",
            Rule::arrow => "`->`",
            Rule::sign_at => "`@`",
            Rule::word_in | Rule::placement => "`in`",
            Rule::word_at => "`at`",
            Rule::word_as => "`as`",
            Rule::word_on => "`on`",
            Rule::word_with => "`with`",
            Rule::word_rotate | Rule::rotation => "`rotate`",
            Rule::both => "`==`",
            Rule::axes => "`axes`",
            Rule::axis | Rule::axis_name => "an axis (`x`, `y`, `z` or a vector)",
            Rule::kind => "a kind of joint",
            Rule::shape => "a shape",
            Rule::surface => "a surface",
            Rule::dimension => "a dimension such as `Length`",
            Rule::string => "a path in quotes",
            Rule::compare => "a comparison",
            Rule::point => "a point",
            Rule::expr | Rule::number | Rule::quantity | Rule::parens | Rule::call => {
                "an expression"
            }
            Rule::choice | Rule::word_if | Rule::condition | Rule::neg => "an expression",
            Rule::equation | Rule::argument => "an expression",
            Rule::parameter | Rule::option => "a name",
            Rule::coincident | Rule::distance | Rule::on_plane | Rule::weld => "a constraint",
            Rule::exponent => "an integer",
            // An operator, a unit or an offset may follow almost anything: naming them helps nobody.
            _ => continue,
        };
        if !words.iter().any(|w| w == word) {
            words.push(word.to_string());
        }
    }
    // A name is an expression too.
    if words.iter().any(|w| w == "an expression") {
        words.retain(|w| w != "a name" || rules.contains(&Rule::name));
    }
    words.sort_by_key(|w| w != end);
    words
}

fn list(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [one] => one.clone(),
        [rest @ .., last] => format!("{} or {last}", rest.join(", ")),
    }
}
