//! Linear systems of constrained blocks, eliminated on symbols.
//!
//! Part by part: a part whose coordinates can satisfy all rows that touch it is eliminated together
//! with them, those touched by the fewest rows first; so the fingertips on a ball leave six equations
//! for the ball. What is left are rows of parts that are all gone.

use super::elimination::Elimination;
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
        let Some(elimination) = eliminated(block, &there) else { continue };
        let tasks = solvers(systems.len(), block, &elimination);
        systems.push(System { block: number, factors: elimination.factors.len() });
        made.push(sensitivities(systems.len() - 1, block, &there));
        made.extend(pulls(systems.len() - 1, block, &there[1]));
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

/// What the constraints do to the coordinates: the sum of their impulses, and that of their sizes.
fn pulls(system: usize, block: &Block, jacobian: &BTreeSet<usize>) -> [Task; 2] {
    let width = block.coordinates.len();
    let lambda = |row: usize| Sym::leaf(Leaf::Lambda(row as u32));
    let sums = |array: &'static str, term: &dyn Fn(Sym, Sym) -> Sym| -> Vec<Output> {
        let column = |i: usize| {
            let rows = block.rows.iter().enumerate();
            let rows = rows.map(|(k, &row)| (block.constraint_offset + k * width + i, row));
            let rows = rows.filter(|(slot, _)| jacobian.contains(slot));
            let terms = rows.map(|(slot, row)| term(leaf(SystemArray::Before, slot), lambda(row)));
            terms.fold(Sym::zero(), |sum, term| sum + term)
        };
        let coordinates = block.coordinates.iter().enumerate();
        coordinates.map(|(i, &c)| output(array, c, column(i), array)).collect()
    };
    let pull = sums("pull", &|g, lambda| g * lambda);
    let sizes = sums("sizes", &|g, lambda| (g * lambda).abs());
    [
        task(system, "pull", "Impulses G₀ᵀλ by coordinates.", pull),
        task(system, "pull_sizes", "Sizes of the terms of G₀ᵀλ by coordinates.", sizes),
    ]
}

/// Eliminates everything; `None` where that is too long or meets a structural zero.
fn eliminated(block: &Block, there: &[BTreeSet<usize>; 2]) -> Option<Elimination> {
    let mut elimination = open(block, there);
    let first_row = block.coordinates.len();
    let mut open: Vec<(Part, usize)> = Vec::new();
    for (range, part) in block.part_ranges().zip(parts(std::slice::from_ref(block))) {
        open.push((part, range.start));
    }
    while !open.is_empty() {
        let held = |&(part, first): &(Part, usize)| -> Vec<usize> {
            let mut rows: Vec<usize> = (first..first + part.coordinates.len())
                .flat_map(|i| elimination.neighbours(i))
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
        elimination.eliminate((first..first + part.coordinates.len()).collect(), LARGEST)?;
        if rows.len() <= part.coordinates.len() {
            elimination.eliminate(rows, LARGEST)?;
        }
    }
    let last = (first_row..first_row + block.rows.len()).collect::<Vec<_>>();
    let left = last.into_iter().filter(|&row| !elimination.is_done(row)).collect();
    elimination.eliminate(left, LARGEST)?;
    Some(elimination)
}

/// The system before anything has been eliminated.
fn open(block: &Block, [matrix, jacobian]: &[BTreeSet<usize>; 2]) -> Elimination {
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
    Elimination::new(n, rows)
}

/// The functions that factor and solve.
fn solvers(system: usize, block: &Block, elimination: &Elimination) -> [Task; 2] {
    let factors = elimination.factors.iter().enumerate();
    let mut outputs: Vec<Output> =
        factors.map(|(i, &value)| output("factors", i, value, "factor")).collect();
    outputs.push(Output {
        place: Place::Return,
        value: elimination.shrinkage,
        label: "shrinkage".to_owned(),
    });
    let n = block.coordinates.len();
    let residuals = block.coordinates.iter().map(|&c| -leaf(SystemArray::Residual, c));
    let gaps = block.rows.iter().map(|&row| -leaf(SystemArray::Gaps, row));
    let factor = |place| leaf(SystemArray::Factors, place);
    let x = elimination.solution(residuals.chain(gaps).collect(), factor);
    let steps = block.coordinates.iter().zip(&x);
    let mut solution: Vec<Output> =
        steps.map(|(&c, &value)| output("step", c, value, "step")).collect();
    let changes = block.rows.iter().zip(&x[n..]);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::with_new;
    use crate::stage::elimination::testing::{number, results};
    use handc_core::linalg::Lu;

    /// Two fingers and a ball, held by two and three rows.
    fn block() -> Block {
        Block {
            coordinates: vec![4, 5, 6, 0, 1, 7, 8, 9],
            rows: vec![2, 3, 4, 6, 5],
            parts: vec![3, 2, 3],
            matrix_offset: 3,
            constraint_offset: 2,
        }
    }

    /// Which parts each row touches.
    const TOUCHED: [[bool; 3]; 5] = [
        [true, false, true],
        [true, false, true],
        [false, true, true],
        [false, true, true],
        [true, true, false],
    ];

    /// Entries of a packed matrix or Jacobian; what is not there stays zero.
    fn packed(there: &BTreeSet<usize>, salt: usize, size: usize) -> Vec<f64> {
        (0..size).map(|i| if there.contains(&i) { number(i, salt) } else { 0.0 }).collect()
    }

    #[test]
    fn solves_what_a_dense_solver_solves() {
        let block = block();
        let (n, m) = (block.coordinates.len(), block.rows.len());
        let ranges: Vec<_> = block.part_ranges().collect();
        let mut matrix_there = BTreeSet::new();
        for part in parts(std::slice::from_ref(&block)) {
            matrix_there.extend(part.slots());
        }
        let mut jacobian_there = BTreeSet::new();
        for (k, touched) in TOUCHED.iter().enumerate() {
            for (range, _) in ranges.iter().zip(touched).filter(|(_, touched)| **touched) {
                jacobian_there.extend(range.clone().map(|j| block.constraint_offset + k * n + j));
            }
        }
        let mut matrix = packed(&matrix_there, 1, 3 + n * n);
        (0..n).for_each(|i| matrix[3 + i * (n + 1)] -= 3.0);
        let before = packed(&jacobian_there, 2, 2 + n * m);
        let after = packed(&jacobian_there, 3, 2 + n * m);
        let residual: Vec<f64> = (0..10).map(|i| number(i, 4)).collect();
        let gaps: Vec<f64> = (0..7).map(|i| number(i, 5)).collect();
        let size: Vec<f64> = (0..10).map(|i| 1.0 + number(i, 6)).collect();
        let lambda: Vec<f64> = (0..7).map(|i| number(i, 7)).collect();
        let found = with_new(|| {
            let there = [matrix_there, jacobian_there];
            let elimination = eliminated(&block, &there).unwrap();
            let mut tasks = solvers(0, &block, &elimination).to_vec();
            tasks.push(sensitivities(0, &block, &there));
            tasks.extend(pulls(0, &block, &there[1]));
            results(&tasks, |leaf, factors| match leaf {
                Leaf::System(SystemArray::Matrix, i) => matrix[i as usize],
                Leaf::System(SystemArray::Before, i) => before[i as usize],
                Leaf::System(SystemArray::After, i) => after[i as usize],
                Leaf::System(SystemArray::Size, i) => size[i as usize],
                Leaf::System(SystemArray::Residual, i) => residual[i as usize],
                Leaf::System(SystemArray::Gaps, i) => gaps[i as usize],
                Leaf::System(SystemArray::Factors, i) => factors[i as usize],
                Leaf::Lambda(i) => lambda[i as usize],
                other => panic!("reads {other:?}"),
            })
        });
        let of = |array: &'static str, index: usize| -> f64 {
            let place = Place::Element { array, index };
            found.iter().find(|(found, _)| *found == place).unwrap().1
        };
        let g = |jacobian: &[f64], k: usize, j: usize| jacobian[2 + k * n + j];
        let mut dense = Lu::new(n + m);
        for i in 0..n {
            let row = dense.row_mut(i);
            row[..n].copy_from_slice(&matrix[3 + i * n..][..n]);
            (0..m).for_each(|k| row[n + k] = -g(&before, k, i));
        }
        for k in 0..m {
            (0..n).for_each(|j| dense.row_mut(n + k)[j] = g(&after, k, j));
        }
        let condition = dense.factor().condition();
        let mut x: Vec<f64> = block.coordinates.iter().map(|&c| -residual[c]).collect();
        x.extend(block.rows.iter().map(|&row| -gaps[row]));
        dense.solve(&mut x);
        let close = |a: f64, b: f64| (a - b).abs() < 1e-12 * condition * (1.0 + b.abs());
        for (i, &c) in block.coordinates.iter().enumerate() {
            assert!(close(of("step", c), x[i]), "step {i}");
            let row = (0..n).map(|j| matrix[3 + i * n + j].abs() * size[block.coordinates[j]]);
            assert!(close(of("sensitivity", c), row.sum()));
            let pulls = || (0..m).map(|k| g(&before, k, i) * lambda[block.rows[k]]);
            assert!(close(of("pull", c), pulls().sum()));
            assert!(close(of("sizes", c), pulls().map(f64::abs).sum()));
        }
        for (k, &row) in block.rows.iter().enumerate() {
            assert!(close(of("change", row), x[n + k]), "change {k}");
            let terms = (0..n).map(|j| g(&after, k, j).abs() * size[block.coordinates[j]]);
            assert!(close(of("row_sensitivity", row), terms.sum()));
        }
        let shrinkage = found.iter().find(|(place, _)| *place == Place::Return).unwrap().1;
        assert!((1.0..1e6).contains(&shrinkage), "{shrinkage}");
    }
}
