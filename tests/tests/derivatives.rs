//! The mechanics against dual numbers, to 1e-12 of each matrix's scale: momentum and force against a
//! Lagrangian made from poses alone, the Newton matrix against the residual's derivative, mass
//! matrix, moment arms and constraint Jacobian likewise; and that the choice of hub changes nothing.

#[path = "support/oracle.rs"]
mod oracle;

use handc_core::scalar::Scalar;
use handc_runtime::dual::Dual;
use handc_runtime::interpreter::Interpreter;
use handc_runtime::mechanics::At;
use handc_runtime::mechanism::{Mechanism, Number, Point};
use handc_tests::load;
use oracle::{Noise, Oracle, Place, fixed, seeded};
use std::sync::Arc;

const TOLERANCE: f64 = 1e-12;

/// All mechanisms that are tested: models, fixtures, and those made for it.
fn mechanisms() -> Vec<Mechanism> {
    let folders = ["models", "tests/fixtures", "tests/mechanisms"];
    let files: Vec<_> = folders.iter().flat_map(|folder| load::models(folder)).collect();
    assert!(files.len() >= 20);
    files.iter().filter_map(|file| load::mechanism(file).ok()).collect()
}

/// Momentum and force of the kernels over any scalar.
fn evaluate<S: Scalar>(oracle: &Oracle, at: &At<S>) -> (Vec<S>, Vec<S>) {
    let n = at.q.len();
    let (mut momentum, mut force) = (vec![S::zero(); n], vec![S::zero(); n]);
    oracle.kernels(|mechanics, workspace| {
        mechanics.evaluate(workspace, at, &mut momentum, &mut force, None);
    });
    (momentum, force)
}

/// Momentum and force where coordinates and rates are dual numbers.
fn evaluate_dual(
    oracle: &Oracle,
    q: &[Dual<f64>],
    v: &[Dual<f64>],
    place: &Place,
) -> (Vec<Dual<f64>>, Vec<Dual<f64>>) {
    let (rest, inputs) = (fixed(&place.rest), fixed(&place.inputs));
    evaluate(oracle, &At { q, v, t: Dual::constant(0.3), rest: &rest, inputs: &inputs })
}

fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    values.into_iter().fold(0.0, |a: f64, x| a.max(x.abs()))
}

/// Checks two lists against each other, in rows of `width` of which each has its own scale; returns
/// the largest difference in parts of the scale.
fn compare(what: &str, name: &str, width: usize, found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let mut most: f64 = 0.0;
    for (found, expected) in found.chunks(width.max(1)).zip(expected.chunks(width.max(1))) {
        let scale = largest(expected);
        let difference = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
        let worst = difference.fold(0.0, |a: f64, d| if d <= a { a } else { d });
        let relative = if worst == 0.0 { 0.0 } else { worst / scale };
        assert!(relative <= TOLERANCE, "{name}: {what} is off by {relative:.2e} of {scale:.2e}");
        most = most.max(relative);
    }
    most
}

/// Runs a check at three places of every mechanism; `check` returns the relative difference.
fn everywhere(what: &str, check: impl Fn(&Oracle, &Place) -> f64) {
    let mut worst = (0.0, String::new());
    for mechanism in mechanisms() {
        let oracle = Oracle::new(&mechanism);
        let mut noise = Noise(7);
        for _ in 0..3 {
            let found = check(&oracle, &Place::new(&oracle, &mut noise));
            if found >= worst.0 {
                worst = (found, mechanism.name.clone());
            }
        }
    }
    eprintln!("{what}: at most {:.1e} of the scale ({})", worst.0, worst.1);
}

#[test]
fn momentum_and_force_are_those_of_the_lagrangian() {
    everywhere("momentum and force", |oracle, place| {
        let (name, n) = (&oracle.mechanism.name, place.q.len());
        let (momentum, force) = evaluate(oracle, &place.at());
        let (p, f) = oracle.evaluate(&place.at());
        let potential = oracle
            .kernels(|mechanics, workspace| mechanics.potential(workspace, &place.q, &place.rest));
        compare("momentum", name, n, &momentum, &p).max(compare("force", name, n, &force, &f)).max(
            compare("potential", name, 1, &[potential], &[oracle.potential(&place.q, &place.rest)]),
        )
    });
}

/// The Newton matrix for a step: small, where M/h rules; large, where stiffness does.
#[test]
fn newton_matrix() {
    everywhere("Newton matrix", |oracle, place| {
        let (structure, n) = (&oracle.structure, place.q.len());
        let size = structure.blocks.iter().map(|b| b.coordinates.len().pow(2)).sum();
        let mut worst: f64 = 0.0;
        for h in [1e-3, 0.05, 3.0] {
            let mut matrix = vec![0.0; size];
            let (mut p, mut f) = (vec![0.0; n], vec![0.0; n]);
            oracle.kernels(|mechanics, workspace| {
                let matrix = Some((h, matrix.as_mut_slice()));
                mechanics.evaluate(workspace, &place.at(), &mut p, &mut f, matrix);
            });
            let free: Vec<usize> = (0..n).filter(|&i| structure.slots[i].is_some()).collect();
            let (mut found, mut expected) = (Vec::new(), Vec::new());
            for &j in &free {
                let (mut q, mut v) = (fixed(&place.q), fixed(&place.v));
                (q[j].slope, v[j].slope) = (0.5, structure.rate_weight(j) / h);
                let (momentum, force) = evaluate_dual(oracle, &q, &v, place);
                for &i in &free {
                    found.push(structure.slot(i, j).map_or(0.0, |slot| matrix[slot]));
                    expected.push(0.5 * h * force[i].slope - momentum[i].slope);
                }
            }
            let what = format!("Newton matrix at h = {h}");
            worst =
                worst.max(compare(&what, &oracle.mechanism.name, free.len(), &found, &expected));
        }
        worst
    });
}

#[test]
fn mass_matrix() {
    everywhere("mass matrix", |oracle, place| {
        let (structure, n) = (&oracle.structure, place.q.len());
        let size = structure.blocks.iter().map(|b| b.coordinates.len().pow(2)).sum();
        let mut matrix = vec![0.0; size];
        oracle.kernels(|mechanics, workspace| {
            mechanics.mass_matrix(workspace, &place.q, &mut matrix);
        });
        let free: Vec<usize> = (0..n).filter(|&i| structure.slots[i].is_some()).collect();
        let (mut found, mut expected) = (Vec::new(), Vec::new());
        for &j in &free {
            let (momentum, _) =
                evaluate_dual(oracle, &fixed(&place.q), &seeded(&place.v, j), place);
            for &i in &free {
                found.push(structure.slot(i, j).map_or(0.0, |slot| matrix[slot]));
                expected.push(momentum[i].slope);
            }
        }
        compare("mass matrix", &oracle.mechanism.name, free.len(), &found, &expected)
    });
}

/// By how much momenta change with the increment of a step.
#[test]
fn momentum_matrix() {
    everywhere("momentum matrix", |oracle, place| {
        let (structure, n) = (&oracle.structure, place.q.len());
        let size = structure.blocks.iter().map(|b| b.coordinates.len().pow(2)).sum();
        let h = 0.05;
        let mut matrix = vec![0.0; size];
        oracle.kernels(|mechanics, workspace| {
            mechanics.momentum_matrix(workspace, &place.q, &place.v, 1.0 / h, &mut matrix);
        });
        let free: Vec<usize> = (0..n).filter(|&i| structure.slots[i].is_some()).collect();
        let (mut found, mut expected) = (Vec::new(), Vec::new());
        for &j in &free {
            let (mut q, mut v) = (fixed(&place.q), fixed(&place.v));
            (q[j].slope, v[j].slope) = (0.5, structure.rate_weight(j) / h);
            let (momentum, _) = evaluate_dual(oracle, &q, &v, place);
            for &i in &free {
                found.push(structure.slot(i, j).map_or(0.0, |slot| matrix[slot]));
                expected.push(momentum[i].slope);
            }
        }
        compare("momentum matrix", &oracle.mechanism.name, free.len(), &found, &expected)
    });
}

#[test]
fn strand_lengths_and_moment_arms() {
    everywhere("lengths and moment arms", |oracle, place| {
        let (n, s, name) = (place.q.len(), oracle.mechanism.strands.len(), &oracle.mechanism.name);
        let (mut lengths, mut arms) = (vec![0.0; s], vec![0.0; s * n]);
        oracle.kernels(|mechanics, workspace| {
            mechanics.strand_lengths(workspace, &place.q, &mut lengths);
            mechanics.moment_arms(workspace, &place.q, &mut arms);
        });
        let mut expected = vec![0.0; s * n];
        for j in 0..n {
            for (i, length) in oracle.lengths(&seeded(&place.q, j)).iter().enumerate() {
                expected[i * n + j] = length.slope;
            }
        }
        compare("lengths", name, s, &lengths, &oracle.lengths(&place.q)).max(compare(
            "moment arms",
            name,
            n,
            &arms,
            &expected,
        ))
    });
}

#[test]
fn constraint_jacobian() {
    everywhere("constraint Jacobian", |oracle, place| {
        let (structure, n) = (&oracle.structure, place.q.len());
        let rows = structure.row_slots.len();
        let size = structure.blocks.iter().map(|b| b.coordinates.len() * b.rows.len()).sum();
        let mut jacobian = vec![0.0; size];
        oracle.kernels(|mechanics, workspace| {
            mechanics.constraint_jacobian(workspace, &place.q, 0.3, &mut jacobian);
        });
        let (mut found, mut expected) = (Vec::new(), Vec::new());
        for j in (0..n).filter(|&j| structure.slots[j].is_some()) {
            let mut values = vec![Dual::zero(); rows];
            oracle.kernels(|mechanics, workspace| {
                let (q, rest) = (seeded(&place.q, j), fixed(&place.rest));
                mechanics.constraints(workspace, &q, Dual::constant(0.3), &rest, &mut values);
            });
            for (row, value) in values.iter().enumerate() {
                found.push(structure.row_slot(row, j).map_or(0.0, |slot| jacobian[slot]));
                expected.push(value.slope);
            }
        }
        compare("constraint Jacobian", &oracle.mechanism.name, rows, &found, &expected)
    });
}

#[test]
fn point_jacobians() {
    everywhere("Jacobians of frames", |oracle, place| {
        let n = place.q.len();
        let mut worst: f64 = 0.0;
        for (index, frame) in oracle.mechanism.frames.iter().enumerate() {
            let point = Point { link: frame.link, position: frame.link_from_frame.translation };
            let mut found = vec![0.0; 6 * n];
            oracle.kernels(|mechanics, workspace| {
                mechanics.point_jacobian(workspace, &place.q, &point, &mut found);
            });
            let mut expected = vec![0.0; 6 * n];
            for j in 0..n {
                let q = seeded(&place.q, j);
                let pose = oracle
                    .kernels(|mechanics, workspace| mechanics.frame_poses(workspace, &q)[index]);
                for axis in 0..3 {
                    expected[axis * n + j] = pose.translation.0[axis].slope;
                    // ω is the axis of Ṙ Rᵀ.
                    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                    expected[(3 + axis) * n + j] = (0..3)
                        .map(|k| pose.rotation.0[v][k].slope * pose.rotation.0[u][k].value)
                        .sum();
                }
            }
            let name = format!("{}, {}", oracle.mechanism.name, frame.name);
            worst = worst.max(compare("motion", &name, 3 * n, &found, &expected));
        }
        worst
    });
}

#[test]
fn constraint_curvature() {
    everywhere("curvature of constraints", |oracle, place| {
        let (n, rows) = (place.q.len(), oracle.structure.row_slots.len());
        let lambda: Vec<f64> = (0..rows).map(|r| 1.0 + (r as f64).sin()).collect();
        let interpreter = Interpreter::new(Arc::new(oracle.mechanism.clone()));
        let found = interpreter.constraint_curvature(&place.q, 0.3, &lambda);
        let mut expected = vec![0.0; n * n];
        let moves = |i: usize| oracle.structure.slots[i].is_some();
        for i in (0..n).filter(|&i| moves(i)) {
            for j in 0..n {
                let mut q: Vec<Dual<Dual<f64>>> =
                    seeded(&place.q, i).into_iter().map(Dual::fixed).collect();
                q[j].slope = Dual::fixed(1.0);
                let mut values = vec![Dual::zero(); rows];
                oracle.kernels(|mechanics, workspace| {
                    let rest: Vec<_> = place.rest.iter().map(|&x| Dual::constant(x)).collect();
                    mechanics.constraints(workspace, &q, Dual::constant(0.3), &rest, &mut values);
                });
                let sum = values.iter().zip(&lambda).map(|(h, l)| h.slope.slope * l);
                expected[i * n + j] = sum.sum();
            }
        }
        compare("curvature", &oracle.mechanism.name, n * n, &found, &expected)
    });
}

/// Momenta are summed about a hub chosen for speed: any other link, and the world, give the same.
#[test]
fn the_hub_does_not_matter() {
    everywhere("other hubs", |oracle, place| {
        let (momentum, force) = evaluate(oracle, &place.at());
        let mut other = Oracle::new(oracle.mechanism);
        let mut worst: f64 = 0.0;
        for tree in 0..other.structure.trees.len() {
            let links = other.structure.trees[tree].links.clone();
            for hub in links.into_iter().map(Some).chain([None]) {
                let mut trunk = other.structure.chain(hub);
                trunk.reverse();
                let tree = &mut other.structure.trees[tree];
                (tree.hub, tree.base, tree.trunk) = (hub, None, trunk);
                let (p, f) = evaluate(&other, &place.at());
                let (name, n) = (&oracle.mechanism.name, p.len());
                worst = worst.max(compare("momentum", name, n, &p, &momentum));
                worst = worst.max(compare("force", name, n, &f, &force));
            }
        }
        worst
    });
}

/// A base far away: momentum and force stay, up to the rounding of the far coordinates.
#[test]
fn the_place_of_the_base_does_not_matter() {
    let mut worst: f64 = 0.0;
    for name in ["joints", "strands"] {
        let near =
            load::mechanism(&load::repository("tests/mechanisms").join(format!("{name}.hdl")))
                .unwrap();
        let mut far = near.clone();
        let moved = |position: &mut [Number; 3]| {
            for (x, shift) in position.iter_mut().zip([512.0, -1024.0, 256.0]) {
                if let Number::Constant(value) = x {
                    *value += shift;
                }
            }
        };
        for link in far.links.iter_mut().filter(|link| link.parent.is_none()) {
            moved(&mut link.parent_from_joint.translation);
        }
        let points = far.strands.iter_mut().flat_map(|s| &mut s.points);
        points.filter(|p| p.link.is_none()).for_each(|p| moved(&mut p.position));
        let (near, far) = (Oracle::new(&near), Oracle::new(&far));
        let place = Place::new(&near, &mut Noise(3));
        let (p, f) = evaluate(&near, &place.at());
        let (p_far, f_far) = evaluate(&far, &place.at());
        for (a, b) in [(p, p_far), (f, f_far)] {
            let difference: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a - b).collect();
            worst = worst.max(largest(&difference) / largest(&a));
        }
    }
    eprintln!("a base 1 km away: {worst:.1e}");
    assert!(worst < 1e-11);
}
