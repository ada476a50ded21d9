//! Like blocks: one set of equations where they differ in constants alone.
//!
//! Every block is looked at in its own numbering of coordinates, strands and inputs. Blocks whose
//! expressions then agree but for constants and parameters are one [`Shape`]; what differs becomes
//! an entry of a table. Blocks that agree only up to a term that vanishes in one of them stay apart.

use super::{Module, Task};
use crate::emit::{Output, Place};
use crate::graph::{
    Binary, Leaf, Node, Sym, Unary, label_of, node, reachable, rebuild_binary, rebuild_unary,
    substitute, with_origin,
};
use handc_core::scalar::Scalar;
use handc_runtime::structure::Structure;
use std::collections::{HashMap, HashSet};
use std::hash::{DefaultHasher, Hash, Hasher};

/// Where the numbers of one block stand in the model's vectors.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BlockPlace {
    /// Which block of the structure.
    pub block: usize,
    /// Its own coordinates, then the kinematic ones it reads.
    pub coordinates: Vec<usize>,
    /// Strands whose natural length or length it reads.
    pub strands: Vec<usize>,
    /// Inputs it reads.
    pub inputs: Vec<usize>,
}

/// Like blocks.
#[derive(Clone, Debug, Default)]
pub struct Shape {
    /// Coordinates of each block, kinematic ones not counted.
    pub unknowns: usize,
    /// The blocks.
    pub places: Vec<BlockPlace>,
    /// Constants of each block: made of numbers and parameters alone.
    pub constants: Vec<Vec<Sym>>,
}

/// The tasks of all blocks become those of their shapes. `alike` holds them staged with unknowns
/// where like blocks differ, and the values of those unknowns.
pub(super) fn merge(
    tasks: &[Task],
    alike: &[Task],
    unknowns: &HashMap<Sym, Sym>,
    structure: &Structure,
) -> (Vec<Shape>, Vec<Task>) {
    let count = structure.blocks.len();
    let by_itself: Vec<Local> = (0..count).map(|b| Local::new(b, tasks, structure)).collect();
    let blocks: Vec<Local> = (0..count).map(|b| Local::new(b, alike, structure)).collect();
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for block in 0..count {
        match groups.iter_mut().find(|g| blocks[g[0]].skeleton == blocks[block].skeleton) {
            Some(group) => group.push(block),
            None => groups.push(vec![block]),
        }
    }
    let (mut shapes, mut merged) = (Vec::new(), Vec::new());
    let mut add = |group: &[usize], from: &[Local]| {
        let members: Vec<&Local> = group.iter().map(|&block| &from[block]).collect();
        let Some((mut shape, tasks)) = Merger::merge(&members, shapes.len()) else { return false };
        for list in &mut shape.constants {
            *list = substitute(list, unknowns);
        }
        shapes.push(shape);
        merged.extend(tasks);
        true
    };
    for group in groups {
        // Equal by hash alone, or single: each block by itself.
        if group.len() < 2 || !add(&group, &blocks) {
            for block in group {
                add(&[block], &by_itself);
            }
        }
    }
    (shapes, merged)
}

/// A block in its own numbering.
struct Local<'a> {
    place: BlockPlace,
    unknowns: usize,
    tasks: Vec<&'a Task>,
    hashes: HashMap<Sym, u64>,
    /// What is made of numbers and parameters alone.
    fixed: HashSet<Sym>,
    /// Sizes, places of results and hashes of their expressions.
    skeleton: Vec<u64>,
    matrix_offset: usize,
}

/// A node as blocks are compared by it.
enum View {
    /// Made of numbers and parameters alone.
    Constant(Sym),
    /// The product of such a one and something else.
    Scaled(Sym, Sym),
    Other(Node),
}

fn is_commutative(function: Binary) -> bool {
    matches!(function, Binary::Add | Binary::Mul | Binary::Min | Binary::Max)
}

impl<'a> Local<'a> {
    fn view(&self, symbol: Sym) -> View {
        if self.fixed.contains(&symbol) {
            return View::Constant(symbol);
        }
        let scaled = |symbol: Sym| match node(symbol) {
            Node::Binary(Binary::Mul, a, b) if self.fixed.contains(&a) => Some((a, b)),
            Node::Binary(Binary::Mul, a, b) if self.fixed.contains(&b) => Some((b, a)),
            _ => None,
        };
        if let Some((factor, other)) = scaled(symbol) {
            return View::Scaled(factor, other);
        }
        match node(symbol) {
            Node::Unary(Unary::Neg, inner) => match scaled(inner) {
                Some((factor, other)) => View::Scaled(-factor, other),
                None => View::Other(node(symbol)),
            },
            other => View::Other(other),
        }
    }

    fn new(block: usize, tasks: &'a [Task], structure: &Structure) -> Self {
        let tasks: Vec<&Task> = tasks.iter().filter(|t| t.module == Module::Block(block)).collect();
        let roots: Vec<Sym> =
            tasks.iter().flat_map(|task| task.outputs.iter().map(|output| output.value)).collect();
        let nodes = reachable(&roots);
        let of = &structure.blocks[block];
        let mut place =
            BlockPlace { block, coordinates: of.coordinates.clone(), ..BlockPlace::default() };
        let (mut around, mut strands, mut inputs) = (Vec::new(), Vec::new(), Vec::new());
        for &symbol in &nodes {
            if let Node::Leaf(leaf) = node(symbol) {
                match leaf {
                    Leaf::Q(i) | Leaf::V(i) => around.push(i as usize),
                    Leaf::Rest(i) | Leaf::Length(i) => strands.push(i as usize),
                    Leaf::Input(i) => inputs.push(i as usize),
                    _ => {}
                }
            }
        }
        for task in &tasks {
            for output in &task.outputs {
                if let Place::Element { array: "lengths", index } = output.place {
                    strands.push(index);
                }
            }
        }
        around.retain(|c| !of.coordinates.contains(c));
        for list in [&mut around, &mut strands, &mut inputs] {
            list.sort_unstable();
            list.dedup();
        }
        place.coordinates.extend(around);
        (place.strands, place.inputs) = (strands, inputs);
        let mut local = Local {
            unknowns: of.coordinates.len(),
            place,
            tasks,
            hashes: HashMap::new(),
            fixed: HashSet::new(),
            skeleton: Vec::new(),
            matrix_offset: of.matrix_offset,
        };
        for symbol in nodes {
            let is_fixed = match node(symbol) {
                Node::Constant(_) | Node::Leaf(Leaf::Param(_)) => true,
                Node::Leaf(_) => false,
                other => other.operands().all(|operand| local.fixed.contains(&operand)),
            };
            if is_fixed {
                local.fixed.insert(symbol);
            }
            let hash = local.hash(symbol);
            local.hashes.insert(symbol, hash);
        }
        local.skeleton = local.skeleton();
        local
    }

    fn leaf(&self, leaf: Leaf) -> Leaf {
        let find = |list: &[usize], i: u32| {
            list.iter().position(|&index| index == i as usize).unwrap_or_default() as u32
        };
        match leaf {
            Leaf::Q(i) => Leaf::Q(find(&self.place.coordinates, i)),
            Leaf::V(i) => Leaf::V(find(&self.place.coordinates, i)),
            Leaf::Rest(i) => Leaf::Rest(find(&self.place.strands, i)),
            Leaf::Length(i) => Leaf::Length(find(&self.place.strands, i)),
            Leaf::Input(i) => Leaf::Input(find(&self.place.inputs, i)),
            other => other,
        }
    }

    /// Where a result goes, in the block's numbering.
    fn output(&self, place: &Place) -> Place {
        let Place::Element { array, index } = place else { return place.clone() };
        let find = |list: &[usize]| list.iter().position(|i| i == index).unwrap_or_default();
        let index = match *array {
            "matrix" => index - self.matrix_offset,
            "lengths" => find(&self.place.strands),
            _ => find(&self.place.coordinates),
        };
        Place::Element { array, index }
    }

    fn hash(&self, symbol: Sym) -> u64 {
        let mut hasher = DefaultHasher::new();
        let of = |symbol: &Sym| match self.view(*symbol) {
            View::Constant(_) => 1,
            _ => self.hashes[symbol],
        };
        match self.view(symbol) {
            View::Constant(_) => return 1,
            View::Scaled(_, other) => (2, of(&other)).hash(&mut hasher),
            View::Other(Node::Leaf(leaf)) => (3, self.leaf(leaf)).hash(&mut hasher),
            View::Other(Node::Unary(function, a)) => (4, function, of(&a)).hash(&mut hasher),
            View::Other(Node::Binary(function, a, b)) => {
                let (mut a, mut b) = (of(&a), of(&b));
                if is_commutative(function) && b < a {
                    std::mem::swap(&mut a, &mut b);
                }
                (5, function, a, b).hash(&mut hasher);
            }
            View::Other(Node::Power(a, exponent)) => (6, of(&a), exponent).hash(&mut hasher),
            View::Other(Node::Select(comparison, four)) => {
                (7, comparison, four.map(|s| of(&s))).hash(&mut hasher);
            }
            View::Other(Node::Constant(_)) => return 1,
        }
        hasher.finish()
    }

    fn skeleton(&self) -> Vec<u64> {
        let mut skeleton = vec![
            self.unknowns as u64,
            self.place.coordinates.len() as u64,
            self.place.strands.len() as u64,
            self.place.inputs.len() as u64,
        ];
        for task in &self.tasks {
            for output in &task.outputs {
                let mut hasher = DefaultHasher::new();
                if let Place::Element { array, index } = self.output(&output.place) {
                    (task.name, array, index).hash(&mut hasher);
                }
                skeleton.push(hasher.finish());
                skeleton.push(match self.view(output.value) {
                    View::Constant(_) => 1,
                    _ => self.hashes[&output.value],
                });
            }
        }
        skeleton
    }
}

/// Walks the expressions of like blocks side by side.
struct Merger<'a, 'b> {
    blocks: &'b [&'b Local<'a>],
    known: HashMap<Vec<Sym>, Sym>,
    constants: HashMap<Vec<Sym>, Sym>,
    table: Vec<Vec<Sym>>,
}

impl<'a, 'b> Merger<'a, 'b> {
    fn merge(blocks: &'b [&'b Local<'a>], number: usize) -> Option<(Shape, Vec<Task>)> {
        let mut merger = Merger {
            blocks,
            known: HashMap::new(),
            constants: HashMap::new(),
            table: vec![Vec::new(); blocks.len()],
        };
        let first = blocks[0];
        let mut tasks = Vec::new();
        for (t, task) in first.tasks.iter().enumerate() {
            let mut outputs = Vec::new();
            for (o, output) in task.outputs.iter().enumerate() {
                let values = blocks.iter().map(|block| block.tasks[t].outputs[o].value).collect();
                let labels: Vec<&str> =
                    blocks.iter().map(|block| block.tasks[t].outputs[o].label.as_str()).collect();
                outputs.push(Output {
                    place: first.output(&output.place),
                    value: merger.symbol(values)?,
                    label: shared(&labels),
                });
            }
            let module = Module::Block(number);
            tasks.push(Task { module, name: task.name, doc: task.doc.clone(), outputs });
        }
        let shape = Shape {
            unknowns: first.unknowns,
            places: blocks.iter().map(|block| block.place.clone()).collect(),
            constants: merger.table,
        };
        Some((shape, tasks))
    }

    /// The one expression of which the blocks' are instances.
    fn symbol(&mut self, symbols: Vec<Sym>) -> Option<Sym> {
        // Deep expressions are built from below.
        let mut open = vec![symbols.clone()];
        while let Some(top) = open.last().cloned() {
            if self.known.contains_key(&top) {
                open.pop();
                continue;
            }
            let operands = self.operands(&top)?;
            let before = open.len();
            open.extend(operands.iter().filter(|o| !self.known.contains_key(*o)).cloned());
            if open.len() == before {
                let labels: Vec<String> = top.iter().map(|&s| label_of(s)).collect();
                let labels: Vec<&str> = labels.iter().map(String::as_str).collect();
                let made = with_origin(&shared(&labels), || self.make(&top, &operands))?;
                self.known.insert(top, made);
                open.pop();
            }
        }
        self.known.get(&symbols).copied()
    }

    /// Operands that are to be merged first, tuple by tuple.
    fn operands(&self, symbols: &[Sym]) -> Option<Vec<Vec<Sym>>> {
        let lists: Vec<Vec<Sym>> = symbols
            .iter()
            .zip(self.blocks)
            .map(|(&symbol, block)| match block.view(symbol) {
                View::Constant(_) => Vec::new(),
                View::Scaled(_, other) => vec![other],
                View::Other(Node::Binary(function, a, b)) if is_commutative(function) => {
                    let hash = |s: &Sym| block.hashes.get(s).copied().unwrap_or(1);
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
            symbols.iter().zip(self.blocks).map(|(&s, block)| block.view(s)).collect();
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
                    views.iter().zip(self.blocks).all(|(view, block)| match view {
                        View::Other(node) => test(node, block),
                        _ => false,
                    })
                };
                match *first {
                    Node::Constant(_) => None,
                    Node::Leaf(leaf) => {
                        let leaf = self.blocks[0].leaf(leaf);
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

    /// A constant that all blocks share, or an entry of the table.
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
