//! One part of a block in its own numbering, and the skeleton by which parts are compared.

use super::PartPlace;
use crate::emit::Place;
use crate::graph::{Binary, Leaf, Node, Sym, Unary, node, reachable};
use crate::stage::parts::Part;
use crate::stage::{Module, Task};
use handc_runtime::structure::Structure;
use std::collections::{HashMap, HashSet};
use std::hash::{DefaultHasher, Hash, Hasher};

/// A part in its own numbering.
pub(super) struct Local<'a> {
    pub(super) place: PartPlace,
    pub(super) unknowns: usize,
    pub(super) tasks: Vec<&'a Task>,
    pub(super) hashes: HashMap<Sym, u64>,
    /// What is made of numbers and parameters alone.
    fixed: HashSet<Sym>,
    /// Sizes, places of results and hashes of their expressions.
    pub(super) skeleton: Vec<u64>,
    part: Part<'a>,
    /// Internal coordinates of the whole model.
    is_internal: &'a [bool],
}

/// A node as parts are compared by it.
pub(super) enum View {
    /// Made of numbers and parameters alone.
    Constant(Sym),
    /// The product of such a one and something else.
    Scaled(Sym, Sym),
    Other(Node),
}

pub(super) fn is_commutative(function: Binary) -> bool {
    matches!(function, Binary::Add | Binary::Mul | Binary::Min | Binary::Max)
}

impl<'a> Local<'a> {
    pub(super) fn view(&self, symbol: Sym) -> View {
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

    pub(super) fn new(
        number: usize,
        of: &Part<'a>,
        tasks: &'a [Task],
        structure: &'a Structure,
    ) -> Self {
        let is_own = |task: &&Task| task.module == Module::Part(number);
        let tasks: Vec<&Task> = tasks.iter().filter(is_own).collect();
        let roots: Vec<Sym> =
            tasks.iter().flat_map(|task| task.outputs.iter().map(|output| output.value)).collect();
        let nodes = reachable(&roots);
        let mut place = PartPlace {
            part: number,
            matrix: [of.matrix, of.width],
            coordinates: of.coordinates.to_vec(),
            ..PartPlace::default()
        };
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
            part: *of,
            is_internal: &structure.is_internal,
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

    pub(super) fn leaf(&self, leaf: Leaf) -> Leaf {
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

    /// Where a result goes, in the part's numbering.
    pub(super) fn output(&self, place: &Place) -> Place {
        let Place::Element { array, index } = place else { return place.clone() };
        let find = |list: &[usize]| list.iter().position(|i| i == index).unwrap_or_default();
        let index = match *array {
            "matrix" => {
                let (row, column) = self.part.entry(*index);
                row * self.unknowns + column
            }
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
        // Which coordinates are internal is part of a shape.
        let own = self.place.coordinates[..self.unknowns].iter();
        skeleton.extend(own.map(|&c| u64::from(self.is_internal[c])));
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
