//! Newton's method with an inverse of the matrix that is kept from step to step.
//!
//! The matrix is inverted, not factored: a product with an inverse has no chain of divisions and
//! differences to wait for, and an inverse can learn. It learns from every correction what the matrix
//! has become ([`Secant`]), and is made anew when it has cost as much.
//!
//! A step may end with a correction that is not evaluated. What it does to the force is then known
//! from the equation itself: of the residual that it takes away, what does not change the momentum
//! changes the impulse. How wrong that has been for the correction before tells whether it will do.

use super::inverse::{invert, multiply};
use super::masked::{correct, hold};
use super::scale::{Balances, merit, per_scales, sensitivities};
use super::secant::Secant;
use super::{End, Residual, Start, put_at};
use crate::lane::{Lane, load, store};
use crate::shape::Shape;
use crate::step::{KEEP_FACTORS, LINEAR_END, STAGNATION};

/// Evaluations of the Newton matrix before the step is given back.
const MATRICES: usize = 6;
/// Evaluations before the step is given back.
const PASSES: usize = 24;
/// Residuals above this many units of tolerance are heard above rounding: what a correction does to
/// them tells of the matrix.
const AUDIBLE: f64 = 1e3;

impl<L: Lane, const N: usize> Residual<L, N> {
    /// Half the step's impulse (h/2)f after a correction that leaves no residual: what the correction
    /// takes from the residual and not from the momentum, which changes by the mass matrix over h.
    #[inline(always)]
    fn foretell(&self, correction: &[L; N], mass: &[f64], half_h: L, per_h: L) -> [L; N] {
        let mut impulse = multiply::<L, N>(mass, correction);
        for i in 0..N {
            let taken = per_h.mul_add(impulse[i], self.r[i]);
            impulse[i] = half_h.mul_sub(self.force[i], taken);
        }
        impulse
    }
}

/// The inverse of the Newton matrix that is kept from step to step, and what goes with it.
///
/// Matrices stay in memory, the lanes of one entry side by side: copies would cost as much as what is
/// done with them.
pub(crate) struct Kept<'v> {
    /// The inverse, by rows.
    pub(crate) inverse: &'v mut [f64],
    /// The mass matrix, by rows.
    pub(crate) mass: &'v mut [f64],
    /// Σ|Jᵢⱼ|·size(j) of each row of the Newton matrix.
    pub(crate) sensitivity: &'v mut [f64],
    /// Whether it is there and is to be tried.
    pub(crate) serves: bool,
}

/// Takes the step in every lane.
#[inline(always)]
pub(crate) fn newton<
    L: Lane,
    Sh: Shape<N, M, Q, S, U>,
    const N: usize,
    const M: usize,
    const Q: usize,
    const S: usize,
    const U: usize,
>(
    start: &Start<L, N, Q, S, U>,
    constants: &[f64],
    kept: &mut Kept,
    balances: &mut Option<Balances<L, N>>,
) -> End<L, N, Q> {
    let zero = L::splat(0.0);
    let per_h = start.per_h;
    let half_h = L::splat(0.5) * start.h;
    let mut local = start.local();
    let mut end = start.end();
    let mut at = Residual { r: [zero; N], momentum: [zero; N], force: [zero; N] };
    let mut per_scale = [zero; N];
    // Half the step's impulse as the last correction foretold it.
    let mut foretold = [zero; N];
    let mut correction = [zero; N];
    let mut before = L::splat(f64::INFINITY);
    let mut done = 0;
    // Whether the matrix is evaluated too, and whether a correction led here.
    let (mut renews, mut is_corrected) = (!kept.serves, false);
    for pass in 0..PASSES {
        put_at(&mut local, start, &end.delta, per_h, Sh::INTERNAL);
        let mut good = L::ALL;
        if renews {
            if end.matrices == MATRICES {
                break;
            }
            end.matrices += 1;
            let mut matrix = [zero; M];
            let (momentum, force) = (&mut at.momentum, &mut at.force);
            Sh::evaluate_with_matrix(&local, constants, momentum, force, &mut matrix);
            let sums = sensitivities::<L, Sh, N, M, Q, S, U>(start, &matrix, balances);
            store(&sums, kept.sensitivity);
            good = invert::<L, N, M>(&mut matrix);
            store(&matrix, kept.inverse);
            let mut mass = [zero; M];
            Sh::mass_matrix(&local.q, constants, &mut mass);
            store(&mass, kept.mass);
        } else {
            Sh::evaluate(&local, constants, &mut at.momentum, &mut at.force);
        }
        at.balance(start, half_h);
        if renews || pass == 0 {
            per_scale = per_scales(start, &at, half_h, &load(kept.sensitivity));
        }
        let (merit, finite) = merit(&at.r, &per_scale);
        let converged = merit.less_equal(L::splat(1.0)) & finite & !done;
        if converged != 0 {
            hold(converged, &at.force, &mut end.force);
            done |= converged;
        }
        if done == L::ALL {
            kept.serves = good == L::ALL;
            end.failed = 0;
            return end;
        }
        if good | done != L::ALL {
            break;
        }
        let mut next = multiply::<L, N>(kept.inverse, &at.r);
        if is_corrected {
            // How far the half step's impulse was foretold wrongly: the next time it will be by as
            // much less as the residual has fallen.
            let mut missed = zero;
            for i in 0..N {
                let off = half_h.mul_sub(at.force[i], foretold[i]);
                missed = missed.max(off.abs() * per_scale[i]);
            }
            foretold = at.foretell(&next, kept.mass, half_h, per_h);
            let left = missed.max(merit) * merit;
            let linear = left.less_equal(L::splat(LINEAR_END) * before) & finite & !done;
            if linear != 0 {
                end.iterations += 1;
                correct(linear, &mut end.delta, &next);
                let mut force = foretold;
                for i in 0..N {
                    force[i] = foretold[i] * (per_h + per_h);
                }
                hold(linear, &force, &mut end.force);
                done |= linear;
            }
            if done == L::ALL {
                kept.serves = true;
                end.failed = 0;
                return end;
            }
            // What the correction did is told to the inverse, unless rounding did it.
            let secant = Secant::new(&correction, &next, start);
            let told = L::splat(AUDIBLE).less(before) & secant.is_sound() & finite & !done;
            if told != 0 {
                for i in 0..N {
                    next[i] = L::choose(told, secant.stretch * next[i], next[i]);
                }
                foretold = at.foretell(&next, kept.mass, half_h, per_h);
            }
            // The residual hardly falls and the correction is rounding: the floor.
            let mut largest = zero;
            for i in 0..N {
                let size = start.q[i].abs().max(start.size[i]);
                largest = largest.max(correction[i].abs() / size);
            }
            let stagnant = (L::splat(0.1) * before).less(merit)
                & largest.less_equal(L::splat(STAGNATION))
                & finite;
            let stagnant = stagnant & !done;
            hold(stagnant, &at.force, &mut end.force);
            done |= stagnant;
            let falls = (merit.less(before) & finite) | done;
            if falls != L::ALL {
                if end.matrices > 0 {
                    break;
                }
                // The inverse is too old: back, and a new one.
                for i in 0..N {
                    end.delta[i] = L::choose(falls, end.delta[i], end.delta[i] + correction[i]);
                }
                (renews, is_corrected) = (true, false);
                continue;
            }
            if told & !done != 0 {
                secant.teach(told & !done, kept.inverse, &next);
            }
            if done == L::ALL {
                kept.serves = true;
                end.failed = 0;
                return end;
            }
            // Fast enough, or but one more to go.
            let fast = merit.less(L::splat(KEEP_FACTORS) * before)
                | (merit * merit).less_equal(before)
                | done;
            if fast != L::ALL {
                (renews, is_corrected) = (true, false);
                continue;
            }
        } else if finite | done != L::ALL {
            break;
        } else {
            foretold = at.foretell(&next, kept.mass, half_h, per_h);
        }
        end.iterations += 1;
        correct(!done & L::ALL, &mut end.delta, &next);
        (correction, before) = (next, merit);
        (renews, is_corrected) = (false, true);
    }
    kept.serves = false;
    end.failed = !done & L::ALL;
    end
}
