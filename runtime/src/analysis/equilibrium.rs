//! Static equilibrium: a configuration in which nothing moves, and to which it comes back.
//!
//! Newton's method on the force left over along the constraints. Where the tangent stiffness is not
//! positive its principal directions are taken with their absolute value (Nocedal and Wright,
//! Numerical Optimization, section 3.4), so that a step always goes with the force; it is shortened
//! until the force has done work over it, and a rest that is not stable is left along its worst
//! direction. The work is taken from the forces at both ends, so that forces without a potential may
//! act too.

use super::linear::Held;
use super::tangent::{Stability, Tangent};
use crate::interpreter::Interpreter;
use handc_core::model::Model as _;
use handc_core::start::project;
use nalgebra::{DMatrix, DVector};
use std::fmt;

/// Most steps of the search.
const STEPS: usize = 1000;
/// Longest change of a coordinate in one step (rad, or parts of the model's length): short, so that
/// of several rests one near the start is found.
const LONGEST: f64 = 0.1;
/// First change of a coordinate away from a rest that is not stable.
const NUDGE: f64 = 1e-3;
/// A step shorter than this has arrived.
const ARRIVED: f64 = 1e-14;
/// A step shorter than this that brings nothing has arrived as well as rounding lets it.
const NEAR: f64 = 1e-8;
/// A part of the stiffness below which a force along a direction without one is rounding.
const NOISE: f64 = 1e-11;

/// A configuration at rest.
#[derive(Clone, Debug)]
pub struct Equilibrium {
    /// Coordinates (rad or m).
    pub q: Vec<f64>,
    /// Forces and stiffness there.
    pub tangent: Tangent,
    /// Steps taken.
    pub steps: usize,
    /// How many rests that are not stable were left on the way.
    pub left: usize,
}

/// Why no configuration at rest was found.
#[derive(Clone, Debug, PartialEq)]
pub enum EquilibriumError {
    /// Constraints do not close at the start: the worst row and its gap there.
    Open {
        /// Constraint row.
        row: String,
        /// Its gap.
        gap: f64,
    },
    /// Forces or stiffness are not finite at the start.
    NotFinite,
    /// The search has not ended.
    NotFound {
        /// Coordinate with the largest force left over.
        coordinate: String,
        /// That force (N·m or N).
        force: f64,
        /// Coordinate that has moved farthest.
        moved: String,
        /// By how much (rad or m).
        by: f64,
        /// Steps taken.
        steps: usize,
    },
}

impl fmt::Display for EquilibriumError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            EquilibriumError::Open { row, gap } => write!(
                f,
                "the start cannot be moved onto the constraints: `{row}` is {gap:.3e} away there\n  \
                 try: a start nearer to a closed configuration"
            ),
            EquilibriumError::NotFinite => write!(
                f,
                "forces at the start are not finite\n  try: another start, or check divisions and \
                 roots in the model's expressions"
            ),
            EquilibriumError::NotFound { coordinate, force, moved, by, steps } => write!(
                f,
                "no equilibrium was found in {steps} steps: `{coordinate}` is still pushed by \
                 {force:.3e}, and `{moved}` has moved by {by:.3}\n  try: a smaller load, a start \
                 nearer to the rest, or something that holds `{moved}`: a strand, a `stiffness` or \
                 a `limit_stiffness`"
            ),
        }
    }
}

impl std::error::Error for EquilibriumError {}

/// Searches a stable rest from `start`, which is moved onto the constraints first.
pub fn equilibrium(
    model: &mut Interpreter,
    start: &[f64],
    held: &Held,
) -> Result<Equilibrium, EquilibriumError> {
    let mut q = start.to_vec();
    project(model, &mut q, held.rest, held.driven)
        .map_err(|(row, gap)| EquilibriumError::Open { row, gap })?;
    let mut at = Tangent::at(model, &q, held).ok_or(EquilibriumError::NotFinite)?;
    let mut left = 0;
    for steps in 0..STEPS {
        let step = newton_step(&at);
        let length = largest(&step);
        let found = length <= ARRIVED;
        let next = if found { None } else { advance(model, &q, &at, &step, held) };
        match next {
            Some((next_q, next_at)) => {
                let shrinks = largest(&next_at.push()) < largest(&at.push());
                // Near the end a step that brings nothing is rounding.
                if length > NEAR || shrinks {
                    (q, at) = (next_q, next_at);
                    continue;
                }
            }
            None if found || length <= NEAR => {}
            None => return Err(not_found(model, start, &q, &at, steps)),
        }
        if at.stability() != Stability::Unstable {
            return Ok(Equilibrium { q, tangent: at, steps, left });
        }
        // At rest, but not stable: leave it.
        let Some(away) = leave(model, &q, &at, held) else {
            return Ok(Equilibrium { q, tangent: at, steps, left });
        };
        left += 1;
        (q, at) = away;
    }
    Err(not_found(model, start, &q, &at, STEPS))
}

/// Weights of the basis: along each principal direction the force over the stiffness without its
/// sign; where all are positive Newton's step itself, which also sees what is not symmetric.
fn newton_step(at: &Tangent) -> Vec<f64> {
    let push = DVector::from_vec(at.push());
    let count = push.len();
    let stiffest = at.stiffest();
    let limit = 1e-10 * stiffest;
    if at.directions.first().is_some_and(|softest| softest.stiffness > limit) {
        let step = at.stiffness().clone().lu().solve(&push);
        if let Some(step) = step.filter(|step| step.dot(&push) > 0.0) {
            return step.iter().copied().collect();
        }
    }
    let mut step = DVector::zeros(count);
    let basis = DMatrix::from_fn(at.linear.n, count, |i, k| at.basis[k][i]);
    for direction in &at.directions {
        let scaled = DVector::from_fn(at.linear.n, |i, _| direction.shape[i] / at.scale[i]);
        let weights = basis.tr_mul(&scaled);
        let force = weights.dot(&push);
        let stiffness = direction.stiffness.abs();
        if stiffness <= limit && force.abs() <= NOISE * stiffest {
            continue;
        }
        // Without stiffness the step is as long as it may be.
        let share = if stiffness > limit { force / stiffness } else { force.signum() * LONGEST };
        step += weights * share;
    }
    step.iter().copied().collect()
}

/// Goes along a step as far as the force does work.
fn advance(
    model: &mut Interpreter,
    q: &[f64],
    at: &Tangent,
    step: &[f64],
    held: &Held,
) -> Option<(Vec<f64>, Tangent)> {
    let motion = at.motion(step);
    let size = motion.iter().zip(&at.scale).fold(0.0, |a: f64, (m, s)| a.max((m / s).abs()));
    let push = at.push();
    let promise: f64 = push.iter().zip(step).map(|(f, s)| f * s).sum();
    let mut share = (LONGEST / size).min(1.0);
    for _ in 0..40 {
        let mut next: Vec<f64> = q.iter().zip(&motion).map(|(q, m)| q + share * m).collect();
        if project(model, &mut next, held.rest, held.driven).is_ok()
            && let Some(there) = Tangent::at(model, &next, held)
        {
            let both = at.residual.iter().zip(&there.residual);
            let work: f64 =
                both.zip(next.iter().zip(q)).map(|((a, b), (n, q))| 0.5 * (a + b) * (n - q)).sum();
            let smaller = largest(&there.push()) < 0.9 * largest(&push);
            if work > 1e-4 * share * promise || (smaller && work >= 0.0) || size * share <= NEAR {
                return Some((next, there));
            }
        }
        share *= 0.5;
    }
    None
}

/// A place away from a rest that is not stable.
fn leave(
    model: &mut Interpreter,
    q: &[f64],
    at: &Tangent,
    held: &Held,
) -> Option<(Vec<f64>, Tangent)> {
    let worst = at.directions.first()?;
    // The same side every time: that of the largest entry.
    let turn = worst.shape.iter().fold(0.0, |a: f64, &x| if x.abs() > a.abs() { x } else { a });
    for sign in [turn.signum(), -turn.signum()] {
        let mut size = NUDGE;
        while size <= LONGEST {
            let moved = q.iter().zip(&worst.shape);
            let mut next: Vec<f64> = moved.map(|(q, s)| q + sign * size * s).collect();
            if project(model, &mut next, held.rest, held.driven).is_ok()
                && let Some(there) = Tangent::at(model, &next, held)
            {
                let away: f64 =
                    there.residual.iter().zip(&worst.shape).map(|(f, s)| f * s * sign).sum();
                if away > 0.0 && largest(&there.push()) > largest(&at.push()) {
                    return Some((next, there));
                }
            }
            size *= 4.0;
        }
    }
    None
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |a: f64, x| a.max(x.abs()))
}

fn not_found(
    model: &Interpreter,
    start: &[f64],
    q: &[f64],
    at: &Tangent,
    steps: usize,
) -> EquilibriumError {
    let layout = model.layout();
    let most = |values: &mut dyn Iterator<Item = f64>| {
        let mut best = (0, 0.0f64);
        for (i, value) in values.enumerate() {
            if value.abs() > best.1.abs() {
                best = (i, value);
            }
        }
        best
    };
    let name = |i: usize| layout.coordinates.get(i).map_or(String::new(), |c| c.name.clone());
    let (pushed, force) = most(&mut at.residual.iter().copied());
    let scaled = q.iter().zip(start).zip(&at.scale);
    let (moved, _) = most(&mut scaled.map(|((q, start), scale)| (q - start) / scale));
    EquilibriumError::NotFound {
        coordinate: name(pushed),
        force,
        moved: name(moved),
        by: q.get(moved).zip(start.get(moved)).map_or(0.0, |(q, start)| q - start),
        steps,
    }
}
