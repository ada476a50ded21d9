//! Like parts: one set of equations where they differ in constants alone.
//!
//! Every part is looked at in its own numbering of coordinates, strands and inputs. Parts whose
//! expressions then agree but for constants and parameters are one [`Shape`]; what differs becomes
//! an entry of a table. Parts that agree only up to a term that vanishes in one of them stay apart.

mod local;
mod merger;

use super::Task;
use crate::graph::{Sym, substitute};
use handc_runtime::structure::Structure;
use local::Local;
use merger::Merger;
use std::collections::HashMap;

/// Where the numbers of one part of a block stand in the model's vectors.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PartPlace {
    /// Which part, over all blocks.
    pub part: usize,
    /// Where its first matrix entry stands in packed storage, and how far rows are apart.
    pub matrix: [usize; 2],
    /// Its own coordinates, then others that it reads.
    pub coordinates: Vec<usize>,
    /// Strands whose natural length or length it reads.
    pub strands: Vec<usize>,
    /// Inputs it reads.
    pub inputs: Vec<usize>,
}

/// Like parts.
#[derive(Clone, Debug, Default)]
pub struct Shape {
    /// Coordinates of each part, kinematic ones not counted.
    pub unknowns: usize,
    /// The parts.
    pub places: Vec<PartPlace>,
    /// Constants of each part: made of numbers and parameters alone.
    pub constants: Vec<Vec<Sym>>,
}

/// The tasks of all parts become those of their shapes. `alike` holds them staged with unknowns
/// where like parts differ, and the values of those unknowns.
pub(super) fn merge(
    tasks: &[Task],
    alike: &[Task],
    unknowns: &HashMap<Sym, Sym>,
    structure: &Structure,
) -> (Vec<Shape>, Vec<Task>) {
    let all = crate::stage::parts(&structure.blocks);
    let locals = |tasks| -> Vec<Local> {
        all.iter()
            .enumerate()
            .map(|(number, part)| Local::new(number, part, tasks, structure))
            .collect()
    };
    let (by_itself, parts) = (locals(tasks), locals(alike));
    let count = all.len();
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for part in 0..count {
        match groups.iter_mut().find(|g| parts[g[0]].skeleton == parts[part].skeleton) {
            Some(group) => group.push(part),
            None => groups.push(vec![part]),
        }
    }
    let (mut shapes, mut merged) = (Vec::new(), Vec::new());
    let mut add = |group: &[usize], from: &[Local]| {
        let members: Vec<&Local> = group.iter().map(|&part| &from[part]).collect();
        let Some((mut shape, tasks)) = Merger::merge(&members, shapes.len()) else { return false };
        for list in &mut shape.constants {
            *list = substitute(list, unknowns);
        }
        shapes.push(shape);
        merged.extend(tasks);
        true
    };
    for group in groups {
        // Equal by hash alone, or single: each part by itself.
        if group.len() < 2 || !add(&group, &parts) {
            for part in group {
                add(&[part], &by_itself);
            }
        }
    }
    (shapes, merged)
}

/// What names of like things have in common: `mcp` of `index.mcp` and `ring.mcp`.
pub fn shared(names: &[&str]) -> String {
    let first = names[0];
    if names.iter().all(|name| *name == first) {
        return first.to_owned();
    }
    let parts: Vec<Vec<&str>> = names.iter().map(|name| name.split('.').collect()).collect();
    let mut count = 0;
    while parts.iter().all(|p| p.len() > count + 1)
        && parts.iter().all(|p| p[p.len() - 1 - count] == parts[0][parts[0].len() - 1 - count])
    {
        count += 1;
    }
    match count {
        0 => first.to_owned(),
        _ => parts[0][parts[0].len() - count..].join("."),
    }
}
