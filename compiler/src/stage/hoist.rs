//! Taking out what depends on parameters alone.
//!
//! Parameters change between runs, not within a step: whatever is made of them and of constants is
//! computed once per change and read as a value. A model whose parameters are all plain stiffnesses
//! has few such values or none; one with geometry in its parameters would else recompute its bones
//! in every step.

use super::{Module, Task};
use crate::emit::{Output, Place};
use crate::graph::{Leaf, Node, Sym, node, reachable, substitute};
use std::collections::{HashMap, HashSet};

/// Replaces nodes of parameters alone in all `tasks` and `numbers` by values, adds the task that
/// computes them, and returns how many there are.
pub(super) fn hoist(tasks: &mut Vec<Task>, mut numbers: Vec<&mut Vec<Sym>>) -> usize {
    let mut roots: Vec<Sym> =
        tasks.iter().flat_map(|task| task.outputs.iter().map(|output| output.value)).collect();
    roots.extend(numbers.iter().flat_map(|list| list.iter()));
    let hoisted = frontier(&roots);
    let values: Vec<Sym> =
        (0..hoisted.len()).map(|index| Sym::leaf(Leaf::Value(index as u32))).collect();
    let replacements: HashMap<Sym, Sym> = hoisted.iter().copied().zip(values).collect();
    if hoisted.is_empty() {
        return 0;
    }
    let mut replaced = substitute(&roots, &replacements).into_iter();
    let outputs = tasks.iter_mut().flat_map(|task| &mut task.outputs);
    let places = outputs
        .map(|output| &mut output.value)
        .chain(numbers.iter_mut().flat_map(|list| list.iter_mut()));
    for (place, new) in places.zip(&mut replaced) {
        *place = new;
    }
    tasks.push(Task {
        module: Module::Values,
        name: "update",
        doc: vec!["Numbers that follow from the parameters alone.".to_owned()],
        outputs: hoisted
            .iter()
            .enumerate()
            .map(|(index, &value)| Output {
                place: Place::Element { array: "values", index },
                value,
                label: "value".to_owned(),
            })
            .collect(),
    });
    hoisted.len()
}

/// The largest expressions in parameters alone, in order of creation.
fn frontier(roots: &[Sym]) -> Vec<Sym> {
    let nodes = reachable(roots);
    // Constants are made of parameters alone too, but worth a value only with a parameter inside.
    let mut constant: HashSet<Sym> = HashSet::new();
    let mut from_params: HashSet<Sym> = HashSet::new();
    for &symbol in &nodes {
        let mut operands = node(symbol).operands().peekable();
        match node(symbol) {
            Node::Constant(_) => drop(constant.insert(symbol)),
            Node::Leaf(Leaf::Param(_)) => drop(from_params.insert(symbol)),
            Node::Leaf(_) => {}
            _ if operands.all(|o| constant.contains(&o) || from_params.contains(&o)) => {
                let of = if node(symbol).operands().any(|o| from_params.contains(&o)) {
                    &mut from_params
                } else {
                    &mut constant
                };
                of.insert(symbol);
            }
            _ => {}
        }
    }
    let is_known = |symbol: &Sym| constant.contains(symbol) || from_params.contains(symbol);
    let mut wanted: HashSet<Sym> = roots.iter().copied().collect();
    for symbol in nodes.iter().filter(|symbol| !is_known(symbol)) {
        wanted.extend(node(*symbol).operands());
    }
    nodes
        .into_iter()
        .filter(|symbol| wanted.contains(symbol) && from_params.contains(symbol))
        .filter(|&symbol| !matches!(node(symbol), Node::Leaf(_)))
        .collect()
}
