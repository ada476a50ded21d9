//! Identifiers: from the names of a model to names that Rust accepts and no two items share.

use std::collections::BTreeSet;

/// Words that cannot be identifiers, with those that editions reserve, and primitive names that
/// would confuse.
const RESERVED: &[&str] = &[
    "abstract", "as", "async", "await", "become", "bool", "box", "break", "const", "continue",
    "core", "crate", "do", "dyn", "else", "enum", "extern", "f64", "false", "final", "fn", "for",
    "gen", "if", "impl", "in", "let", "loop", "macro", "main", "match", "mod", "move", "mut",
    "override", "priv", "pub", "ref", "return", "self", "static", "std", "str", "struct", "super",
    "trait", "true", "try", "type", "typeof", "union", "unsafe", "unsized", "use", "usize",
    "virtual", "where", "while", "yield",
];

/// Letters, digits and single underscores; empty text becomes `x`.
fn words(text: &str) -> Vec<String> {
    let words: Vec<String> = text
        .split(|c: char| !c.is_ascii_alphanumeric())
        .filter(|word| !word.is_empty())
        .map(str::to_owned)
        .collect();
    if words.is_empty() { vec!["x".to_owned()] } else { words }
}

/// `index.FDP` becomes `index_fdp`.
pub fn snake(text: &str) -> String {
    let joined = words(text).join("_").to_ascii_lowercase();
    match joined.starts_with(|c: char| c.is_ascii_digit()) {
        true => format!("n{joined}"),
        false => joined,
    }
}

/// `index.fdp` becomes `INDEX_FDP`.
pub fn upper(text: &str) -> String {
    snake(text).to_ascii_uppercase()
}

/// `index_finger` becomes `IndexFinger`.
pub fn camel(text: &str) -> String {
    let joined: String = words(text)
        .iter()
        .map(|word| {
            let (first, rest) = word.split_at(1);
            first.to_ascii_uppercase() + rest
        })
        .collect();
    match joined.starts_with(|c: char| c.is_ascii_digit()) {
        true => format!("N{joined}"),
        false => joined,
    }
}

/// Hands out names, each once.
#[derive(Clone, Debug, Default)]
pub struct Taken {
    names: BTreeSet<String>,
}

impl Taken {
    /// With `names` taken already.
    pub fn with<'a>(names: impl IntoIterator<Item = &'a str>) -> Taken {
        Taken { names: names.into_iter().map(str::to_owned).collect() }
    }

    /// Whether Rust accepts the name.
    pub fn is_legal(name: &str) -> bool {
        !RESERVED.contains(&name) && name != "Self" && name != "_"
    }

    /// `wanted`, or with the smallest suffix that makes it free and legal.
    pub fn take(&mut self, wanted: &str) -> String {
        if Self::is_legal(wanted) && self.names.insert(wanted.to_owned()) {
            return wanted.to_owned();
        }
        let mut number = 2;
        loop {
            let name = format!("{wanted}_{number}");
            if self.names.insert(name.clone()) {
                return name;
            }
            number += 1;
        }
    }

    /// As [`Taken::take`] for each of `wanted`.
    pub fn take_all<'a>(&mut self, wanted: impl IntoIterator<Item = &'a str>) -> Vec<String> {
        wanted.into_iter().map(|name| self.take(name)).collect()
    }
}
