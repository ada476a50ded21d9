//! Newton's method of one step on lanes: several blocks of one shape, or one block of several runs,
//! each in its own lane.
//!
//! It is the method of [`crate::step`] without its last resorts: lanes go on together until each
//! has converged, a lane that is done is held still, and if any lane needs a shorter step, another
//! guess or pivoting, the step is given back to be taken there.
//!
//! Where unknowns are few, or the matrix has few entries, it is made and factored in every step
//! ([`direct`]); else its inverse is kept from step to step ([`kept`]).

mod direct;
pub(crate) mod factors;
mod inverse;
mod kept;
mod masked;
mod scale;
mod secant;

use crate::internal::RATE;
use crate::lane::Lane;
use crate::shape::Local;
pub(crate) use direct::{LOOK, Memory, direct};
pub(crate) use kept::{Kept, newton};
pub(crate) use scale::Balances;

/// Where a step begins, in the block's own order.
pub(crate) struct Start<L, const N: usize, const Q: usize, const S: usize, const U: usize> {
    /// Coordinates at the beginning.
    pub(crate) q: [L; Q],
    /// Guess of the increment; of kinematic coordinates the increment itself.
    pub(crate) delta: [L; Q],
    /// Momenta.
    pub(crate) p: [L; N],
    /// Time at the middle (s).
    pub(crate) t: L,
    /// Step (s), and 1 over it.
    pub(crate) h: L,
    pub(crate) per_h: L,
    /// Natural lengths (m).
    pub(crate) rest: [L; S],
    /// Inputs.
    pub(crate) inputs: [L; U],
    /// Least size of each coordinate for tolerances (1 rad or the model's length).
    pub(crate) size: [L; N],
    /// 1 over it.
    pub(crate) per_size: [L; N],
    /// What past steps add to the rates of internal coordinates.
    pub(crate) past: [L; N],
    /// Relative tolerance on momenta.
    pub(crate) tolerance: L,
}

/// Where it ends.
pub(crate) struct End<L, const N: usize, const Q: usize> {
    /// Increment.
    pub(crate) delta: [L; Q],
    /// Force at the midpoint.
    pub(crate) force: [L; N],
    /// Newton iterations.
    pub(crate) iterations: usize,
    /// Matrices that were evaluated.
    pub(crate) matrices: usize,
    /// Lanes that have not converged, as bits.
    pub(crate) failed: u8,
    /// Whether the guess was so good that one correction was trusted in all lanes.
    pub(crate) is_calm: bool,
}

impl<L: Lane, const N: usize, const Q: usize, const S: usize, const U: usize> Start<L, N, Q, S, U> {
    /// What evaluations read; coordinates and rates are put in for each ([`put_at`]).
    #[inline(always)]
    fn local(&self) -> Local<L, Q, S, U> {
        Local { q: self.q, v: self.q, t: self.t, h: self.h, rest: self.rest, inputs: self.inputs }
    }

    /// Before anything has been done.
    #[inline(always)]
    fn end(&self) -> End<L, N, Q> {
        End {
            delta: self.delta,
            force: [L::splat(0.0); N],
            iterations: 0,
            matrices: 0,
            failed: L::ALL,
            is_calm: false,
        }
    }
}

/// What an evaluation gives.
struct Residual<L, const N: usize> {
    /// p0 + (h/2)f − p.
    r: [L; N],
    momentum: [L; N],
    force: [L; N],
}

/// Puts the midpoint where the increment leads; `internal` are internal coordinates.
#[inline(always)]
fn put_at<L: Lane, const N: usize, const Q: usize, const S: usize, const U: usize>(
    local: &mut Local<L, Q, S, U>,
    start: &Start<L, N, Q, S, U>,
    delta: &[L; Q],
    per_h: L,
    internal: &[usize],
) {
    for i in 0..Q {
        local.q[i] = L::splat(0.5).mul_add(delta[i], start.q[i]);
        local.v[i] = delta[i] * per_h;
    }
    for &i in internal {
        local.v[i] = L::splat(RATE).mul_add(local.v[i], start.past[i]);
    }
}

impl<L: Lane, const N: usize> Residual<L, N> {
    /// Makes the residual of momentum and force.
    #[inline(always)]
    fn balance<const Q: usize, const S: usize, const U: usize>(
        &mut self,
        start: &Start<L, N, Q, S, U>,
        half_h: L,
    ) {
        for i in 0..N {
            self.r[i] = start.p[i] + half_h.mul_sub(self.force[i], self.momentum[i]);
        }
    }
}
