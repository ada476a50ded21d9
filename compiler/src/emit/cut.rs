//! Cutting long code into parts.
//!
//! The time that rustc needs for a function grows faster than its length. What crosses a cut is
//! kept in a workspace array, so a cut is placed where few values cross it.

use super::code::Statement;
use crate::graph::Sym;
use std::collections::HashMap;
use std::ops::Range;

/// A piece of the code that becomes a function of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Its statements.
    pub statements: Range<usize>,
    /// Values of earlier parts that it reads, with their places in the workspace.
    pub loads: Vec<(Sym, usize)>,
    /// Values that later parts read, with their places in the workspace.
    pub stores: Vec<(Sym, usize)>,
}

/// Parts in order, and the size of the workspace.
#[derive(Clone, Debug, PartialEq)]
pub struct Cut {
    /// Parts; one if the code is short.
    pub parts: Vec<Part>,
    /// Numbers in the workspace.
    pub workspace: usize,
}

/// Cuts `statements` into parts of at most `limit` statements.
pub fn cut(statements: &[Statement], limit: usize) -> Cut {
    let boundaries = boundaries(statements, limit.max(1));
    let mut defined_in = HashMap::new();
    for (part, pair) in boundaries.windows(2).enumerate() {
        for statement in &statements[pair[0]..pair[1]] {
            for symbol in statement.defines() {
                defined_in.insert(symbol, part);
            }
        }
    }
    let mut parts: Vec<Part> = boundaries
        .windows(2)
        .map(|pair| Part { statements: pair[0]..pair[1], loads: vec![], stores: vec![] })
        .collect();
    let mut places: HashMap<Sym, usize> = HashMap::new();
    for part in 0..parts.len() {
        for statement in &statements[parts[part].statements.clone()] {
            for symbol in statement.reads() {
                let home = defined_in[&symbol];
                if home == part || parts[part].loads.iter().any(|(s, _)| *s == symbol) {
                    continue;
                }
                let next = places.len();
                let place = *places.entry(symbol).or_insert(next);
                if place == next {
                    parts[home].stores.push((symbol, place));
                }
                parts[part].loads.push((symbol, place));
            }
        }
    }
    Cut { parts, workspace: places.len() }
}

/// Where parts begin and end: in the last quarter of what fits, where fewest values cross.
fn boundaries(statements: &[Statement], limit: usize) -> Vec<usize> {
    let mut list = vec![0];
    let crossing = if statements.len() > limit { crossing(statements) } else { Vec::new() };
    let mut start = 0;
    while statements.len() - start > limit {
        let latest = start + limit;
        let earliest = (latest - limit / 4).max(start + 1);
        // Of equals the latest, so that parts are few.
        let best = (earliest..=latest).rev().min_by_key(|&at| crossing[at]).unwrap_or(latest);
        list.push(best);
        start = best;
    }
    list.push(statements.len());
    list
}

/// For each position, how many values made before it are read at or behind it.
fn crossing(statements: &[Statement]) -> Vec<i64> {
    let mut last_read = HashMap::new();
    for (position, statement) in statements.iter().enumerate() {
        for symbol in statement.reads() {
            last_read.insert(symbol, position);
        }
    }
    let mut change = vec![0i64; statements.len() + 1];
    for (position, statement) in statements.iter().enumerate() {
        for symbol in statement.defines() {
            if let Some(&last) = last_read.get(&symbol) {
                change[position + 1] += 1;
                change[last + 1] -= 1;
            }
        }
    }
    let mut sum = 0;
    change
        .into_iter()
        .map(|step| {
            sum += step;
            sum
        })
        .collect()
}
