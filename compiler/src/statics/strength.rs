//! Strength: the largest force at a point that tensions within their limits can balance.
//!
//! For a direction d the force F·d that the model exerts obeys force + Σ Tᵢ·pullᵢ − F·Jᵀd = 0 with
//! 0 ≤ Tᵢ ≤ limitᵢ, and the largest F is a linear program: the finger of Lee and Kroemer (A finger
//! model with constant tendon moment arms, Proc. Human Factors and Ergonomics Society, 1993) with the
//! moment arms of the model, and the feasible forces of Valero-Cuevas, Zajac and Burgar (Large
//! index-fingertip forces are produced by subject-independent patterns of muscle excitation,
//! J. Biomech. 31:693-703, 1998).

use super::balance::Balance;
use super::program::{Outcome, Program, Solution};

/// What may be exerted beside the direction that is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OffAxis {
    /// Nothing: the force is along the direction.
    Zero,
    /// Anything: the component along the direction is as large as can be.
    Free,
}

/// The strength in one direction.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Strength {
    /// Size of the largest force along the direction (N): infinite where bones alone carry it, not a
    /// number where the pose cannot be held at all with a force that way.
    pub(crate) force: f64,
    /// The force as it is exerted, world axes (N).
    pub(crate) exerted: [f64; 3],
    /// Tension of each pulled strand (N): of all that give this force those of least Σ(Tᵢ/limitᵢ)².
    pub(crate) tensions: Vec<f64>,
    /// Which strands must be at their limit.
    pub(crate) at_limit: Vec<bool>,
}

/// The largest force in the unit direction `direction`, world axes; `point` is what each component
/// of a force does along each direction of the balance.
pub(crate) fn strength(
    balance: &Balance,
    point: &[[f64; 3]],
    limits: &[f64],
    direction: [f64; 3],
    off_axis: OffAxis,
) -> Result<Strength, String> {
    let beside = match off_axis {
        OffAxis::Zero => Vec::new(),
        OffAxis::Free => across(direction).to_vec(),
    };
    let count = limits.len();
    let mut program = Program::default();
    for limit in limits {
        program.unknown(0.0, 0.0, [0.0, *limit]);
    }
    program.unknown(0.0, -1.0, [0.0, f64::INFINITY]);
    for _ in &beside {
        program.unknown(0.0, 0.0, [f64::NEG_INFINITY, f64::INFINITY]);
    }
    for (pull, at) in balance.pull.iter().zip(point) {
        let mut row = pull.clone();
        row.push(-dot(*at, direction));
        row.extend(beside.iter().map(|axis| -dot(*at, *axis)));
        program.equations.push(row);
    }
    program.right = balance.force.iter().map(|f| -f).collect();
    let none = |force: f64| Strength {
        force,
        exerted: direction.map(|d| d * force),
        tensions: vec![f64::NAN; count],
        at_limit: vec![false; count],
    };
    match program.solve() {
        Outcome::Solved(solution) => {
            let least = least_effort(&program, &solution, limits);
            let x = least.as_ref().map_or(&solution.x, |least| &least.x);
            let force = solution.x[count];
            let mut exerted = direction.map(|d| d * force);
            for (axis, size) in beside.iter().zip(&x[count + 1..]) {
                exerted.iter_mut().zip(axis).for_each(|(sum, a)| *sum += a * size);
            }
            Ok(Strength {
                force,
                exerted,
                tensions: x[..count].to_vec(),
                at_limit: solution.at_high[..count].to_vec(),
            })
        }
        Outcome::Infeasible => Ok(none(f64::NAN)),
        Outcome::Unbounded => Ok(none(f64::INFINITY)),
        Outcome::Failed(message) => Err(message),
    }
}

/// Of all tensions that give the largest force the least ones, each in parts of its limit.
fn least_effort(program: &Program, found: &Solution, limits: &[f64]) -> Option<Solution> {
    let count = limits.len();
    let mut program = program.clone();
    program.cost.fill(0.0);
    let largest = limits.iter().copied().fold(0.0, f64::max);
    for (weight, limit) in program.weights.iter_mut().zip(limits) {
        *weight = if *limit > 0.0 { (largest / limit).powi(2) } else { 1.0 };
    }
    (program.low[count], program.high[count]) = (found.x[count], found.x[count]);
    // What must be at its limit stays there.
    for i in (0..count).filter(|&i| found.at_high[i]) {
        program.low[i] = program.high[i];
    }
    match program.solve() {
        Outcome::Solved(solution) => Some(solution),
        _ => None,
    }
}

/// Two unit vectors across a unit vector and each other.
fn across(d: [f64; 3]) -> [[f64; 3]; 2] {
    let least = (0..3).min_by(|&a, &b| d[a].abs().total_cmp(&d[b].abs())).unwrap_or(0);
    let mut other = [0.0; 3];
    other[least] = 1.0;
    let along = dot(other, d);
    let first = [0, 1, 2].map(|i| other[i] - along * d[i]);
    let length = dot(first, first).sqrt();
    let first = first.map(|x| x / length);
    [first, cross(d, first)]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
