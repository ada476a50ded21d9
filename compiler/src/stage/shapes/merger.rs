//! Like parts' expressions walked side by side, into the one of which all are instances.

use super::local::{Local, View, is_commutative};
use super::{Shape, shared};
use crate::emit::Output;
use crate::graph::{Leaf, Node, Sym, label_of, rebuild_binary, rebuild_unary, with_origin};
use crate::stage::{Module, Task};
use handc_core::scalar::Scalar;
use std::collections::{HashMap, HashSet};

/// Walks the expressions of like parts side by side.
pub(super) struct Merger<'a, 'b> {
    parts: &'b [&'b Local<'a>],
    known: HashMap<Vec<Sym>, Sym>,
    constants: HashMap<Vec<Sym>, Sym>,
    table: Vec<Vec<Sym>>,
}

impl<'a, 'b> Merger<'a, 'b> {
    /// The shape of the parts and its tasks; `None` if they are not alike.
    pub(super) fn merge(parts: &'b [&'b Local<'a>], number: usize) -> Option<(Shape, Vec<Task>)> {
        let mut merger = Merger {
            parts,
            known: HashMap::new(),
            constants: HashMap::new(),
            table: vec![Vec::new(); parts.len()],
        };
        let first = parts[0];
        for tuple in merger.reachable()? {
            let operands = merger.operands(&tuple)?;
            let labels: Vec<String> = tuple.iter().map(|&s| label_of(s)).collect();
            let labels: Vec<&str> = labels.iter().map(String::as_str).collect();
            let made = with_origin(&shared(&labels), || merger.make(&tuple, &operands))?;
            merger.known.insert(tuple, made);
        }
        let mut tasks = Vec::new();
        for (t, task) in first.tasks.iter().enumerate() {
            let mut outputs = Vec::new();
            for (o, output) in task.outputs.iter().enumerate() {
                let values: Vec<Sym> =
                    parts.iter().map(|part| part.tasks[t].outputs[o].value).collect();
                let labels: Vec<&str> =
                    parts.iter().map(|part| part.tasks[t].outputs[o].label.as_str()).collect();
                outputs.push(Output {
                    place: first.output(&output.place),
                    value: merger.known[&values],
                    label: shared(&labels),
                });
            }
            let module = Module::Part(number);
            tasks.push(Task { module, name: task.name, doc: task.doc.clone(), outputs });
        }
        let shape = Shape {
            unknowns: first.unknowns,
            places: parts.iter().map(|part| part.place.clone()).collect(),
            constants: merger.table,
        };
        Some((shape, tasks))
    }

    /// What is to be merged, over all results of all tasks, in the order in which the mechanics made
    /// it for the first part. Emission goes by this order, term by term; result by result it would be
    /// lost. Operands stand before their uses, as they do there.
    fn reachable(&self) -> Option<Vec<Vec<Sym>>> {
        let results = |(t, task): (usize, &&Task)| {
            let tuple = move |o: usize| {
                self.parts.iter().map(|part| part.tasks[t].outputs[o].value).collect()
            };
            (0..task.outputs.len()).map(tuple).collect::<Vec<Vec<Sym>>>()
        };
        let mut open: Vec<Vec<Sym>> =
            self.parts[0].tasks.iter().enumerate().flat_map(results).collect();
        let mut seen: HashSet<Vec<Sym>> = HashSet::new();
        while let Some(tuple) = open.pop() {
            if seen.insert(tuple.clone()) {
                open.extend(self.operands(&tuple)?);
            }
        }
        let mut all: Vec<Vec<Sym>> = seen.into_iter().collect();
        all.sort_unstable_by_key(|tuple| tuple.iter().map(|s| s.index()).collect::<Vec<_>>());
        Some(all)
    }

    /// Operands that are to be merged first, tuple by tuple.
    fn operands(&self, symbols: &[Sym]) -> Option<Vec<Vec<Sym>>> {
        let lists: Vec<Vec<Sym>> = symbols
            .iter()
            .zip(self.parts)
            .map(|(&symbol, part)| match part.view(symbol) {
                View::Constant(_) => Vec::new(),
                View::Scaled(_, other) => vec![other],
                View::Other(Node::Binary(function, a, b)) if is_commutative(function) => {
                    let hash = |s: &Sym| part.hashes.get(s).copied().unwrap_or(1);
                    let mut pair = vec![a, b];
                    pair.sort_by_key(hash);
                    pair
                }
                View::Other(node) => node.operands().collect(),
            })
            .collect();
        let count = lists[0].len();
        lists
            .iter()
            .all(|list| list.len() == count)
            .then(|| (0..count).map(|k| lists.iter().map(|list| list[k]).collect()).collect())
    }

    fn make(&mut self, symbols: &[Sym], operands: &[Vec<Sym>]) -> Option<Sym> {
        let merged: Vec<Sym> = operands.iter().map(|tuple| self.known[tuple]).collect();
        let views: Vec<View> =
            symbols.iter().zip(self.parts).map(|(&s, part)| part.view(s)).collect();
        let constants = |views: &[View]| -> Option<Vec<Sym>> {
            let of = |view: &View| match view {
                View::Constant(c) | View::Scaled(c, _) => Some(*c),
                View::Other(_) => None,
            };
            views.iter().map(of).collect()
        };
        match &views[0] {
            View::Constant(_) => constants(&views).map(|all| self.constant(all)),
            View::Scaled(..) => {
                let factor = constants(&views).map(|all| self.constant(all))?;
                Some(factor * merged[0])
            }
            View::Other(first) => {
                let same = |test: &dyn Fn(&Node, &Local) -> bool| {
                    views.iter().zip(self.parts).all(|(view, part)| match view {
                        View::Other(node) => test(node, part),
                        _ => false,
                    })
                };
                match *first {
                    Node::Constant(_) => None,
                    Node::Leaf(leaf) => {
                        let leaf = self.parts[0].leaf(leaf);
                        same(&|n, b| matches!(n, Node::Leaf(l) if b.leaf(*l) == leaf))
                            .then(|| Sym::leaf(leaf))
                    }
                    Node::Unary(function, _) => {
                        same(&|n, _| matches!(n, Node::Unary(f, _) if *f == function))
                            .then(|| rebuild_unary(function, merged[0]))
                    }
                    Node::Binary(function, ..) => {
                        same(&|n, _| matches!(n, Node::Binary(f, ..) if *f == function))
                            .then(|| rebuild_binary(function, merged[0], merged[1]))
                    }
                    Node::Power(_, exponent) => {
                        same(&|n, _| matches!(n, Node::Power(_, e) if *e == exponent))
                            .then(|| merged[0].powi(exponent))
                    }
                    Node::Select(comparison, _) => same(
                        &|n, _| matches!(n, Node::Select(c, _) if *c == comparison),
                    )
                    .then(|| Sym::select(comparison, merged[0], merged[1], merged[2], merged[3])),
                }
            }
        }
    }

    /// A constant that all parts share, or an entry of the table.
    fn constant(&mut self, all: Vec<Sym>) -> Sym {
        let first = all[0];
        if first.as_constant().is_some() && all.iter().all(|&symbol| symbol == first) {
            return first;
        }
        if let Some(&known) = self.constants.get(&all) {
            return known;
        }
        let index = self.table[0].len() as u32;
        for (list, &constant) in self.table.iter_mut().zip(&all) {
            list.push(constant);
        }
        let made = Sym::leaf(Leaf::Constant(index));
        self.constants.insert(all, made);
        made
    }
}
