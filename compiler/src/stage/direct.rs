//! Newton matrices that are factored in every step on lanes, where they have few entries.
//!
//! A muscle's fibre pulls on the joints that its tendon passes and hears of nothing else but its own
//! activation; a node feels its own strands. Eliminated first, such unknowns leave a small matrix for the
//! joints, so that the matrix of a finger with seven muscles, of eighteen unknowns, is factored with
//! less work than a product with its inverse takes. Where unknowns are few and all depend on each
//! other, the runtime's own loops do as well ([`handc_core::shape::Shape::factor`]).

use super::elimination::Elimination;
use super::{Module, Shape, Task};
use crate::emit::{Output, Place};
use crate::graph::{Leaf, Sym, SystemArray};
use handc_core::scalar::Scalar;
use handc_core::shape::FEW;
use std::collections::{BTreeMap, BTreeSet};

/// A matrix of many unknowns suits if it takes at most so many products ([`Elimination::products`]) for
/// each entry of its square. Measured: with 2.4 (`extensor`) a step takes 0.4 of the time that it takes with
/// an inverse that is kept; with 3.2 (a chain of eight, every entry there) copies take a sixth more.
const MOST_PRODUCTS: f64 = 2.5;

fn leaf(array: SystemArray, index: usize) -> Sym {
    Sym::leaf(Leaf::System(array, index as u32))
}

/// Eliminates all unknowns of a matrix with these entries, counted by rows; `None` where that is too
/// long.
fn eliminated(unknowns: usize, entries: &BTreeSet<usize>) -> Option<Elimination> {
    let mut rows = vec![BTreeMap::new(); unknowns];
    for &entry in entries {
        rows[entry / unknowns].insert(entry % unknowns, leaf(SystemArray::Matrix, entry));
    }
    let most = (MOST_PRODUCTS * unknowns.pow(2) as f64) as usize;
    let mut elimination = Elimination::new(unknowns, rows);
    elimination.eliminate((0..unknowns).collect(), most)?;
    (elimination.products() <= most).then_some(elimination)
}

/// Whether the matrix of a block without constraints is factored in every step: it is small, or has few
/// entries, which are counted by rows.
pub(super) fn suits(unknowns: usize, entries: &BTreeSet<usize>) -> bool {
    unknowns <= FEW || eliminated(unknowns, entries).is_some()
}

/// Products that factoring and solving take where every entry is there.
fn products_if_full(n: usize) -> usize {
    n.saturating_sub(1) * n * (2 * n).saturating_sub(1) / 6 + n * n
}

/// The functions that factor, solve and sum over the entries of the shapes whose matrices suit; `tasks`
/// are those of the shapes.
pub(super) fn tasks(shapes: &[Shape], tasks: &[Task]) -> Vec<Task> {
    let mut made = Vec::new();
    for (number, shape) in shapes.iter().enumerate() {
        let of = |name: &str| {
            tasks.iter().find(|task| task.module == Module::Part(number) && task.name == name)
        };
        let (Some(newton), Some(momentum)) = (of("evaluate_with_matrix"), of("momentum_matrix"))
        else {
            continue;
        };
        let n = shape.unknowns;
        let (newton, momentum) = (entries(newton), entries(momentum));
        let Some(elimination) = eliminated(n, &newton) else { continue };
        if n <= FEW && 5 * elimination.products() > 4 * products_if_full(n) {
            continue;
        }
        made.extend(solvers(number, n, &elimination));
        let sensitivity = sums(n, "sensitivity", &newton, |i, j| {
            leaf(SystemArray::Matrix, n * i + j).abs() * leaf(SystemArray::Size, j)
        });
        made.push(task(
            number,
            "sensitivities",
            "Σ|Jᵢⱼ|·size(j) of each row of the Newton matrix.",
            sensitivity,
        ));
        let change = sums(n, "change", &momentum, |i, j| {
            leaf(SystemArray::Momentum, n * i + j) * leaf(SystemArray::Step, j)
        });
        made.push(task(
            number,
            "momentum_change",
            "What a step makes of the derivative of the momentum.",
            change,
        ));
    }
    made
}

/// Entries of the matrix that a task writes.
fn entries(task: &Task) -> BTreeSet<usize> {
    let entry = |output: &Output| match output.place {
        Place::Element { array: "matrix", index } => Some(index),
        _ => None,
    };
    task.outputs.iter().filter_map(entry).collect()
}

fn task(shape: usize, name: &'static str, doc: &str, outputs: Vec<Output>) -> Task {
    Task { module: Module::Part(shape), name, doc: vec![doc.to_owned()], outputs }
}

fn output(array: &'static str, index: usize, value: Sym) -> Output {
    Output { place: Place::Element { array, index }, value, label: array.to_owned() }
}

/// Sums over the entries of each row.
fn sums(
    n: usize,
    array: &'static str,
    entries: &BTreeSet<usize>,
    term: impl Fn(usize, usize) -> Sym,
) -> Vec<Output> {
    let sum = |i: usize| {
        let terms = entries.range(n * i..n * (i + 1)).map(|entry| term(i, entry % n));
        terms.fold(Sym::zero(), |sum, term| sum + term)
    };
    (0..n).map(|i| output(array, i, sum(i))).collect()
}

fn solvers(shape: usize, n: usize, elimination: &Elimination) -> [Task; 2] {
    let factors = elimination.factors.iter().enumerate();
    let mut outputs: Vec<Output> =
        factors.map(|(place, &value)| output("factors", place, value)).collect();
    outputs.push(Output {
        place: Place::Return,
        value: elimination.shrinkage,
        label: "shrinkage".to_owned(),
    });
    let residual = (0..n).map(|i| leaf(SystemArray::Residual, i)).collect();
    let step = elimination.solution(residual, |place| leaf(SystemArray::Factors, place));
    let steps = step.into_iter().enumerate().map(|(i, value)| output("step", i, value)).collect();
    [
        task(
            shape,
            "factor",
            "Factors of the Newton matrix in the order of elimination; returns by how much the smallest \
             pivot has shrunk.",
            outputs,
        ),
        task(shape, "solve", "The step that the Newton matrix makes of a residual.", steps),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::with_new;
    use crate::stage::PartPlace;
    use crate::stage::elimination::testing::{number, results};
    use handc_core::linalg::Lu;

    /// Three joints that all feel each other, and as many muscles, each with a fibre that feels the joints
    /// and an activation that feels nothing.
    fn muscled() -> (usize, BTreeSet<usize>) {
        let (joints, n) = (3, 9);
        let mut entries = BTreeSet::new();
        for i in 0..joints {
            let (fibre, activation) = (joints + 2 * i, joints + 2 * i + 1);
            entries.extend((0..joints).map(|j| n * i + j));
            entries.extend((0..joints).flat_map(|j| [n * j + fibre, n * fibre + j]));
            entries.extend([fibre, activation].map(|k| (n + 1) * k));
            entries.insert(n * fibre + activation);
        }
        (n, entries)
    }

    fn all(n: usize) -> BTreeSet<usize> {
        (0..n * n).collect()
    }

    fn task(name: &'static str, entries: &BTreeSet<usize>) -> Task {
        let outputs = entries.iter().map(|&entry| output("matrix", entry, Sym::one())).collect();
        super::task(0, name, "", outputs)
    }

    #[test]
    fn matrices_with_few_entries_suit() {
        with_new(|| {
            assert!(suits(FEW, &all(FEW)), "small ones do in any case");
            assert!(!suits(FEW + 1, &all(FEW + 1)));
            let (n, entries) = muscled();
            assert!(n > FEW && suits(n, &entries));
        });
    }

    #[test]
    fn shapes_without_structure_keep_the_loops_of_the_runtime() {
        with_new(|| {
            let shape =
                Shape { unknowns: 4, places: vec![PartPlace::default()], constants: vec![] };
            let of = ["evaluate_with_matrix", "momentum_matrix"].map(|name| task(name, &all(4)));
            assert!(tasks(&[shape], &of).is_empty());
        });
    }

    #[test]
    fn solves_what_a_dense_solver_solves() {
        let (n, entries) = muscled();
        let filled = |salt: usize| -> Vec<f64> {
            let entry = |i: usize| if entries.contains(&i) { number(i, salt) } else { 0.0 };
            (0..n * n).map(entry).collect()
        };
        let (mut matrix, momentum) = (filled(1), filled(2));
        (0..n).for_each(|i| matrix[i * (n + 1)] -= 3.0);
        let of = |salt: usize| -> Vec<f64> { (0..n).map(|i| number(i, salt)).collect() };
        let (residual, size, step) = (of(3), of(4), of(5));
        let found = with_new(|| {
            let shape =
                Shape { unknowns: n, places: vec![PartPlace::default()], constants: vec![] };
            let of = ["evaluate_with_matrix", "momentum_matrix"].map(|name| task(name, &entries));
            results(&tasks(&[shape], &of), |leaf, factors| match leaf {
                Leaf::System(SystemArray::Matrix, i) => matrix[i as usize],
                Leaf::System(SystemArray::Momentum, i) => momentum[i as usize],
                Leaf::System(SystemArray::Size, i) => size[i as usize],
                Leaf::System(SystemArray::Residual, i) => residual[i as usize],
                Leaf::System(SystemArray::Step, i) => step[i as usize],
                Leaf::System(SystemArray::Factors, i) => factors[i as usize],
                other => panic!("reads {other:?}"),
            })
        });
        let of = |array: &'static str, index: usize| -> f64 {
            let place = Place::Element { array, index };
            found.iter().find(|(found, _)| *found == place).unwrap().1
        };
        let mut dense = Lu::new(n);
        (0..n).for_each(|i| dense.row_mut(i).copy_from_slice(&matrix[i * n..][..n]));
        let condition = dense.factor().condition();
        let mut x = residual.clone();
        dense.solve(&mut x);
        let close = |a: f64, b: f64| (a - b).abs() < 1e-13 * condition * (1.0 + b.abs());
        for i in 0..n {
            assert!(close(of("step", i), x[i]), "step {i}");
            let sizes = (0..n).map(|j| matrix[i * n + j].abs() * size[j]);
            assert!(close(of("sensitivity", i), sizes.sum()), "sensitivity {i}");
            let change = (0..n).map(|j| momentum[i * n + j] * step[j]);
            assert!(close(of("change", i), change.sum()), "change {i}");
        }
        let shrinkage = found.iter().find(|(place, _)| *place == Place::Return).unwrap().1;
        assert!((1.0..1e6).contains(&shrinkage), "{shrinkage}");
    }
}
