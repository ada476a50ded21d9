//! Linear systems of constrained blocks, eliminated on symbols.
//!
//! Part by part: a part whose coordinates can satisfy all rows that touch it is eliminated together
//! with them, those touched by the fewest rows first; so the fingertips on a ball leave six equations
//! for the ball. What is left are rows of parts that are all gone. Within a part the coordinate comes
//! next that has the fewest neighbours. No two rows are exchanged: matrices of motion are definite but
//! for terms in the step, and how far a pivot has shrunk is returned to the caller.

use super::parts::{Part, parts};
use super::{Module, Task};
use crate::emit::{Output, Place};
use crate::graph::{Leaf, Sym, SystemArray};
use handc_core::layout::Block;
use handc_core::scalar::Scalar;
use handc_runtime::structure::Structure;
use std::collections::{BTreeMap, BTreeSet};

/// Products in the elimination of a system that is written out at most.
const LARGEST: usize = 5000;

/// The system of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct System {
    /// Its block.
    pub block: usize,
    /// How many numbers its factors are.
    pub factors: usize,
}

/// The systems of all constrained blocks that are small enough, and their functions. `tasks` are those
/// of the parts and of the constraints: what they write is what there is.
pub(super) fn systems(structure: &Structure, tasks: &[Task]) -> (Vec<System>, Vec<Task>) {
    let written = |name: &str| -> BTreeSet<usize> {
        let outputs = tasks.iter().filter(|task| task.name == name).flat_map(|t| &t.outputs);
        let index = |output: &Output| match output.place {
            Place::Element { array: "matrix" | "jacobian", index } => Some(index),
            _ => None,
        };
        outputs.filter_map(index).collect()
    };
    let there = [written("evaluate_with_matrix"), written("jacobian")];
    let (mut systems, mut made) = (Vec::new(), Vec::new());
    for (number, block) in structure.blocks.iter().enumerate() {
        if block.rows.is_empty() {
            continue;
        }
        let Some(elimination) = Elimination::run(block, &there) else { continue };
        let tasks = elimination.tasks(systems.len());
        systems.push(System { block: number, factors: elimination.factors.len() });
        made.push(sensitivities(systems.len() - 1, block, &there));
        made.extend(tasks);
    }
    (systems, made)
}

fn leaf(array: SystemArray, index: usize) -> Sym {
    Sym::leaf(Leaf::System(array, index as u32))
}

fn output(array: &'static str, index: usize, value: Sym, label: &str) -> Output {
    Output { place: Place::Element { array, index }, value, label: label.to_owned() }
}

fn task(system: usize, name: &'static str, doc: &str, outputs: Vec<Output>) -> Task {
    Task { module: Module::System(system), name, doc: vec![doc.to_owned()], outputs }
}

/// Sums of sizes, row by row.
fn sensitivities(system: usize, block: &Block, [matrix, jacobian]: &[BTreeSet<usize>; 2]) -> Task {
    let width = block.coordinates.len();
    let sum = |first: usize, array, there: &BTreeSet<usize>| {
        let terms = there.range(first..first + width).map(|&slot| {
            let coordinate = block.coordinates[slot - first];
            leaf(array, slot).abs() * leaf(SystemArray::Size, coordinate)
        });
        terms.fold(Sym::zero(), |sum, term| sum + term)
    };
    let mut outputs = Vec::new();
    for (i, &c) in block.coordinates.iter().enumerate() {
        let sum = sum(block.matrix_offset + i * width, SystemArray::Matrix, matrix);
        outputs.push(output("sensitivity", c, sum, "sum"));
    }
    for (k, &row) in block.rows.iter().enumerate() {
        let sum = sum(block.constraint_offset + k * width, SystemArray::After, jacobian);
        outputs.push(output("row_sensitivity", row, sum, "sum"));
    }
    task(
        system,
        "sensitivities",
        "Sums of |Jᵢⱼ|·size(j) by coordinates and of |G₁|·size by rows.",
        outputs,
    )
}

/// A system on its way to factors. Unknowns count the block's coordinates, then its rows.
struct Elimination<'a> {
    block: &'a Block,
    /// Entries that are not zero by structure, row by row.
    rows: Vec<BTreeMap<usize, Sym>>,
    /// The pivots so far, in order: unknown, its reciprocal among the factors.
    order: Vec<(usize, usize)>,
    /// Entries below each pivot: unknown and place among the factors; and beside it.
    below: Vec<Vec<(usize, usize)>>,
    beside: Vec<Vec<(usize, usize)>>,
    factors: Vec<Sym>,
    /// What each diagonal entry was before it began to shrink.
    scale: Vec<Option<Sym>>,
    shrinkage: Sym,
    products: usize,
}

impl<'a> Elimination<'a> {
    /// Eliminates everything; `None` where that is too long or meets a structural zero.
    fn run(block: &'a Block, there: &[BTreeSet<usize>; 2]) -> Option<Self> {
        let mut elimination = Self::new(block, there);
        let first_row = block.coordinates.len();
        let mut open: Vec<(Part, usize)> = Vec::new();
        for (range, part) in block.part_ranges().zip(parts(std::slice::from_ref(block))) {
            open.push((part, range.start));
        }
        while !open.is_empty() {
            let held = |&(part, first): &(Part, usize)| -> Vec<usize> {
                let mut rows: Vec<usize> = (first..first + part.coordinates.len())
                    .flat_map(|i| elimination.rows[i].keys().copied())
                    .filter(|&unknown| unknown >= first_row)
                    .collect();
                rows.sort_unstable();
                rows.dedup();
                rows.retain(|&row| !elimination.is_done(row));
                rows
            };
            let counts = open.iter().map(|part| held(part).len());
            let (next, _) = counts.enumerate().min_by_key(|&(_, count)| count)?;
            let (part, first) = open[next];
            let rows = held(&open[next]);
            open.remove(next);
            elimination.eliminate((first..first + part.coordinates.len()).collect())?;
            if rows.len() <= part.coordinates.len() {
                elimination.eliminate(rows)?;
            }
        }
        let last = (first_row..first_row + block.rows.len()).collect::<Vec<_>>();
        let left = last.into_iter().filter(|&row| !elimination.is_done(row)).collect();
        elimination.eliminate(left)?;
        Some(elimination)
    }

    fn new(block: &'a Block, [matrix, jacobian]: &[BTreeSet<usize>; 2]) -> Self {
        let (n, m) = (block.coordinates.len(), block.rows.len());
        let mut rows = vec![BTreeMap::new(); n + m];
        for &slot in matrix.range(block.matrix_offset..block.matrix_offset + n * n) {
            let (i, j) = ((slot - block.matrix_offset) / n, (slot - block.matrix_offset) % n);
            rows[i].insert(j, leaf(SystemArray::Matrix, slot));
        }
        for &slot in jacobian.range(block.constraint_offset..block.constraint_offset + n * m) {
            let (k, j) = ((slot - block.constraint_offset) / n, (slot - block.constraint_offset) % n);
            rows[j].insert(n + k, -leaf(SystemArray::Before, slot));
            rows[n + k].insert(j, leaf(SystemArray::After, slot));
        }
        let scale = (0..n + m).map(|i| rows[i].get(&i).copied()).collect();
        Elimination {
            block,
            order: Vec::new(),
            below: vec![Vec::new(); n + m],
            beside: vec![Vec::new(); n + m],
            rows,
            factors: Vec::new(),
            scale,
            shrinkage: Sym::one(),
            products: 0,
        }
    }

    fn is_done(&self, unknown: usize) -> bool {
        self.order.iter().any(|&(done, _)| done == unknown)
    }

    /// Eliminates some unknowns, those with the fewest neighbours first.
    fn eliminate(&mut self, mut unknowns: Vec<usize>) -> Option<()> {
        while !unknowns.is_empty() {
            let with_pivot = unknowns.iter().enumerate().filter(|(_, u)| self.rows[**u].contains_key(u));
            let (next, _) = with_pivot.min_by_key(|(_, u)| self.rows[**u].len())?;
            self.pivot(unknowns.remove(next));
            if self.products > LARGEST {
                return None;
            }
        }
        Some(())
    }

    fn keep(&mut self, value: Sym) -> usize {
        self.factors.push(value);
        self.factors.len() - 1
    }

    fn pivot(&mut self, pivot: usize) {
        let is_coordinate = pivot < self.block.coordinates.len();
        let row = std::mem::take(&mut self.rows[pivot]);
        let diagonal = row[&pivot];
        let reciprocal = diagonal.recip();
        if let Some(scale) = self.scale[pivot].filter(|&scale| scale != diagonal) {
            self.shrinkage = self.shrinkage.max((scale * reciprocal).abs());
        }
        let place = self.keep(reciprocal);
        self.order.push((pivot, place));
        let beside: Vec<(usize, Sym)> = row.into_iter().filter(|&(j, _)| j != pivot).collect();
        for &(j, value) in &beside {
            let place = self.keep(value);
            self.beside[pivot].push((j, place));
        }
        for other in 0..self.rows.len() {
            let Some(entry) = self.rows[other].remove(&pivot) else { continue };
            let factor = entry * reciprocal;
            let place = self.keep(factor);
            self.below[pivot].push((other, place));
            for &(j, value) in &beside {
                self.products += 1;
                let entry = self.rows[other].entry(j).or_insert_with(Sym::zero);
                *entry = *entry - factor * value;
            }
            // A multiplier's pivot is made by coordinates and unmade by other multipliers.
            if is_coordinate && other >= self.block.coordinates.len() {
                self.scale[other] = self.rows[other].get(&other).copied();
            }
        }
    }

    /// The functions that factor and solve.
    fn tasks(&self, system: usize) -> [Task; 2] {
        let factors = self.factors.iter().enumerate();
        let mut outputs: Vec<Output> =
            factors.map(|(i, &value)| output("factors", i, value, "factor")).collect();
        outputs.push(Output {
            place: Place::Return,
            value: self.shrinkage,
            label: "shrinkage".to_owned(),
        });
        let factor = |place: usize| leaf(SystemArray::Factors, place);
        let n = self.block.coordinates.len();
        let residuals = self.block.coordinates.iter().map(|&c| -leaf(SystemArray::Residual, c));
        let gaps = self.block.rows.iter().map(|&row| -leaf(SystemArray::Gaps, row));
        let mut x: Vec<Sym> = residuals.chain(gaps).collect();
        for &(pivot, _) in &self.order {
            for &(other, place) in &self.below[pivot] {
                x[other] = x[other] - factor(place) * x[pivot];
            }
        }
        for &(pivot, reciprocal) in self.order.iter().rev() {
            for &(other, place) in &self.beside[pivot] {
                x[pivot] = x[pivot] - factor(place) * x[other];
            }
            x[pivot] = x[pivot] * factor(reciprocal);
        }
        let steps = self.block.coordinates.iter().zip(&x);
        let mut solution: Vec<Output> =
            steps.map(|(&c, &value)| output("step", c, value, "step")).collect();
        let changes = self.block.rows.iter().zip(&x[n..]);
        solution.extend(changes.map(|(&row, &value)| output("change", row, value, "change")));
        [
            task(
                system,
                "factor",
                "Factors of J and of G₁J⁻¹G₀ᵀ in the order of elimination; returns by how much the \
                 smallest pivot has shrunk.",
                outputs,
            ),
            task(
                system,
                "solve",
                "Solves Jδ − G₀ᵀμ = −r and G₁δ = −c for the step δ and the change μ of the \
                 multipliers.",
                solution,
            ),
        ]
    }
}
