//! Internal variables: coordinates that move no mass but on whose rates forces depend, such as the
//! length of a muscle's fibres and its activation.
//!
//! Their equations are of first order, often stiffer than the step: the fibres of a muscle that is
//! hardly active follow their tendon within microseconds. The midpoint rule would let such a
//! variable swing from step to step without end. So it is known at the middles of steps, where its
//! equation f(q, y, ẏ) = 0 is solved with all others, and its rate there is that of the parabola
//! through the last three middles (the backward differentiation formula of second order; Hairer and
//! Wanner, Solving Ordinary Differential Equations II, section III.1),
//!
//! ẏ = (3/2·Δ − 1/2·Δ₋₁)/h,
//!
//! with Δ the increment from middle to middle. The formula is of second order and forgets in a few
//! steps what is faster than the step.
//!
//! The unknown of a step is δ = 2Δ, so that the middle of the step is at q0 + δ/2 as for all other
//! coordinates. The first middle is only half a step from the start: its rate is taken from the start
//! value and the initial rate v₀, (3/2·Δ)/h + v₀/4, and the second one's from twice the first
//! increment. Both are exact to first order, which is enough for two steps, and have the same factor
//! on δ as the others, so that one Newton matrix serves all.

use crate::lane::Lane;

/// Factor of δ/h in the rate of an internal variable.
pub const RATE: f64 = 0.75;

/// What past steps add to the rate of an internal variable in step number `step` (from zero), after
/// the increment `last` with the rate `v`.
#[inline(always)]
pub(crate) fn past<L: Lane>(step: usize, last: L, v: L, h: L) -> L {
    match step {
        0 => L::splat(0.25) * v,
        1 => L::splat(-0.5) * last / h,
        _ => L::splat(-0.25) * last / h,
    }
}
