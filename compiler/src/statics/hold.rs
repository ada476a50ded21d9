//! Tensions that hold a pose: the least ones, none negative, or the nearest miss.

use super::balance::Balance;
use super::program::{Outcome, Program};

/// Weight of a tension beside the miss that it leaves: enough to choose among equals.
const LIGHT: f64 = 1e-10;

/// A miss that is less than this part of the forces is none: the pose is at the edge of what can be
/// held.
const ROUNDING: f64 = 1e-9;

/// What tensions can do for a pose.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Hold {
    /// Tension of each pulled strand (N).
    pub(crate) tensions: Vec<f64>,
    /// Which are at their limit.
    pub(crate) at_limit: Vec<bool>,
    /// Force along each direction that is not balanced; `None` where the pose is held.
    pub(crate) miss: Option<Vec<f64>>,
}

/// The tensions of least ΣTᵢ² that balance a pose, 0 ≤ Tᵢ ≤ limit; where there are none, those that
/// come nearest (nonnegative least squares, Lawson and Hanson, Solving Least Squares Problems, 1974,
/// chapter 23, with upper bounds).
pub(crate) fn hold(balance: &Balance, limits: &[f64]) -> Result<Hold, String> {
    let mut program = Program::default();
    for limit in limits {
        program.unknown(1.0, 0.0, [0.0, *limit]);
    }
    program.equations = balance.pull.clone();
    program.right = balance.force.iter().map(|f| -f).collect();
    match program.solve() {
        Outcome::Solved(solution) => {
            Ok(Hold { tensions: solution.x, at_limit: solution.at_high, miss: None })
        }
        Outcome::Infeasible => nearest(balance, limits),
        Outcome::Unbounded => Err("least tensions have no bound".to_string()),
        Outcome::Failed(message) => Err(message),
    }
}

/// Least ½ΣTᵢ² with Σ Tᵢ pullᵢ as wanted.
fn least(balance: &Balance, limits: &[f64], wanted: &[f64]) -> Outcome {
    let mut program = Program::default();
    for limit in limits {
        program.unknown(1.0, 0.0, [0.0, *limit]);
    }
    program.equations = balance.pull.clone();
    program.right = wanted.to_vec();
    program.solve()
}

/// Which tensions are at their limits.
fn reached(tensions: &[f64], limits: &[f64]) -> Vec<bool> {
    tensions.iter().zip(limits).map(|(tension, limit)| *tension >= limit * (1.0 - 1e-9)).collect()
}

/// Least ½|force + Σ Tᵢ pullᵢ|².
fn nearest(balance: &Balance, limits: &[f64]) -> Result<Hold, String> {
    let arms = balance.pull.iter().flatten().fold(0.0, |a: f64, x| a.max(x.abs()));
    let mut program = Program::default();
    for limit in limits {
        program.unknown(LIGHT * arms * arms, 0.0, [0.0, *limit]);
    }
    let count = limits.len();
    for (k, pull) in balance.pull.iter().enumerate() {
        let miss = program.unknown(1.0, 0.0, [f64::NEG_INFINITY, f64::INFINITY]);
        let mut row = vec![0.0; count + balance.pull.len()];
        row[..count].copy_from_slice(pull);
        row[miss] = -1.0;
        program.equations.push(row);
        program.right.push(-balance.force[k]);
    }
    match program.solve() {
        Outcome::Solved(solution) => {
            let (tensions, miss) = solution.x.split_at(count);
            let largest = |values: &[f64]| values.iter().fold(0.0, |a: f64, x| a.max(x.abs()));
            let is_held = largest(miss) <= ROUNDING * largest(&balance.force);
            // Of all tensions that reach as far, the least.
            let reached_force: Vec<f64> =
                miss.iter().zip(&balance.force).map(|(miss, force)| miss - force).collect();
            let tensions = match least(balance, limits, &reached_force) {
                Outcome::Solved(solution) => solution.x,
                _ => tensions.to_vec(),
            };
            Ok(Hold {
                at_limit: reached(&tensions, limits),
                tensions,
                miss: (!is_held).then(|| miss.to_vec()),
            })
        }
        Outcome::Failed(message) => Err(message),
        other => Err(format!("{other:?}")),
    }
}
