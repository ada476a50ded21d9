//! Newton's method of one step on lanes where the matrix is small or has few entries: made anew and
//! factored in every step, it leads to the end in one correction.
//!
//! Such a matrix costs hardly more than the residual, and its factors less than what a matrix of an
//! earlier step would cost in further evaluations. A correction c with the matrix of where
//! it begins leaves a residual of the order of c², so that from a good guess nothing is left; and by
//! how much it changes the momentum is known from the momentum's own derivative. What has been known to
//! lead below tolerance is remembered ([`Memory::trusted`]): a correction no longer than that ends the step without
//! another evaluation. Now and then it is looked at all the same.

use super::masked::{correct, hold};
use super::scale::{Balances, merit, per_scales, sensitivities};
use super::{End, Residual, Start, put_at};
use crate::lane::{Lane, load, store};
use crate::shape::Shape;
use crate::step::{KEEP_FACTORS, STAGNATION};

/// Evaluations before the step is given back.
const PASSES: usize = 20;
/// Residuals up to this many units of tolerance may be rounding.
const LOUD: f64 = 4.0;
/// After corrections longer than this the matrix is another.
const FAR: f64 = 1e-4;
/// A step that asks for a longer correction is given back.
const FARTHEST: f64 = 0.1;
/// Of so many steps one is looked at though its correction could be trusted.
pub(crate) const LOOK: usize = 32;

/// What is remembered from step to step, the lanes of one number side by side.
pub(crate) struct Memory<'v> {
    /// Σ|Jᵢⱼ|·size(j) of each row of the Newton matrix.
    pub(crate) sensitivity: &'v mut [f64],
    /// The longest correction that leads below tolerance, in units of the coordinates' sizes.
    pub(crate) trusted: &'v mut [f64],
}

/// Takes the step in every lane; `looks` says that it is not to end unseen, and sensitivities are to be
/// made anew.
#[inline(always)]
pub(crate) fn direct<
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
    memory: &mut Memory,
    balances: &mut Option<Balances<L, N>>,
    looks: bool,
) -> End<L, N, Q> {
    let zero = L::splat(0.0);
    let half_h = L::splat(0.5) * start.h;
    let mut local = start.local();
    let mut end = start.end();
    let mut at = Residual { r: [zero; N], momentum: [zero; N], force: [zero; N] };
    let mut per_scale = [zero; N];
    let (mut factors, mut momentum_matrix) = ([zero; M], [zero; M]);
    // The last correction, the force that it was to lead to, and the merit before it.
    let (mut correction, mut foretold) = ([zero; N], [zero; N]);
    let mut before = L::splat(f64::INFINITY);
    let mut trusted = L::load(memory.trusted);
    // Lengths of the last correction and of all since the matrix was made.
    let (mut length, mut since) = (zero, zero);
    let (mut renews, mut is_first) = (true, false);
    let (mut done, mut good) = (0, L::ALL);
    for pass in 0..PASSES {
        put_at(&mut local, start, &end.delta, start.per_h, Sh::INTERNAL);
        if renews {
            end.matrices += 1;
            let (momentum, force) = (&mut at.momentum, &mut at.force);
            let mut matrix = [zero; M];
            momentum_matrix = [zero; M];
            Sh::evaluate_with_matrix(&local, constants, momentum, force, &mut matrix);
            Sh::momentum_matrix(&local, constants, &mut momentum_matrix);
            if looks {
                let sums = sensitivities::<L, Sh, N, M, Q, S, U>(start, &matrix, balances);
                store(&sums, memory.sensitivity);
            }
            good = Sh::factor(&matrix, &mut factors);
            since = zero;
        } else {
            Sh::evaluate(&local, constants, &mut at.momentum, &mut at.force);
        }
        at.balance(start, half_h);
        if pass == 0 && !looks {
            // What is trusted in all lanes needs no tolerances.
            let mut next = [zero; N];
            Sh::solve(&factors, &at.r, &mut next);
            let ends = span(&next, start).less_equal(trusted) & good;
            if ends == L::ALL {
                end.iterations = 1;
                correct(L::ALL, &mut end.delta, &next);
                end.force =
                    force_after::<L, Sh, N, M, Q, S, U>(&at, &next, &momentum_matrix, start);
                (end.failed, end.is_calm) = (0, true);
                return end;
            }
        }
        if renews {
            per_scale = per_scales(start, &at, half_h, &load(memory.sensitivity));
        }
        let (merit, finite) = merit(&at.r, &per_scale);
        let mut ends = merit.less_equal(L::splat(1.0)) & finite;
        if pass > 0 {
            if is_first {
                let mut missed = merit;
                for i in 0..N {
                    let off = half_h * (at.force[i] - foretold[i]);
                    missed = missed.max(off.abs() * per_scale[i]);
                }
                trusted = learned(trusted, length, missed, finite & !done);
            }
            // The residual hardly falls and the correction is rounding: the floor.
            let mut largest = zero;
            for i in 0..N {
                let size = start.q[i].abs().max(start.size[i]);
                largest = largest.max(correction[i].abs() / size);
            }
            ends |= (L::splat(0.1) * before).less(merit)
                & largest.less_equal(L::splat(STAGNATION))
                & finite;
        }
        ends &= !done;
        if ends != 0 {
            hold(ends, &at.force, &mut end.force);
            done |= ends;
        }
        if done == L::ALL || good | done != L::ALL || (merit.less(before) & finite) | done != L::ALL
        {
            break;
        }
        if !renews {
            // Fast enough, or but one more to go.
            let fast = merit.less(L::splat(KEEP_FACTORS) * before)
                | (merit * merit).less_equal(before)
                | done;
            if fast != L::ALL {
                (renews, is_first) = (true, false);
                continue;
            }
        }
        let mut next = [zero; N];
        Sh::solve(&factors, &at.r, &mut next);
        length = span(&next, start);
        if length.less_equal(L::splat(FARTHEST)) | done != L::ALL {
            // That way may lead to another solution.
            break;
        }
        foretold = force_after::<L, Sh, N, M, Q, S, U>(&at, &next, &momentum_matrix, start);
        end.iterations += 1;
        correct(!done & L::ALL, &mut end.delta, &next);
        // What is left is of the order of the product of this correction and all since the matrix.
        let squared = length * (since + since + length);
        let ends = squared.less_equal(trusted * trusted) & finite & !done;
        if ends != 0 && !looks {
            hold(ends, &foretold, &mut end.force);
            done |= ends;
            if done == L::ALL {
                break;
            }
        }
        is_first = renews;
        since = since + length;
        renews = L::splat(FAR).less(length) & !done != 0;
        (correction, before) = (next, merit);
    }
    trusted.store(memory.trusted);
    end.failed = !done & L::ALL;
    end
}

/// The force of which a correction leaves no residual: the momentum then is what the step's first
/// momentum and half its impulse make.
#[inline(always)]
fn force_after<
    L: Lane,
    Sh: Shape<N, M, Q, S, U>,
    const N: usize,
    const M: usize,
    const Q: usize,
    const S: usize,
    const U: usize,
>(
    at: &Residual<L, N>,
    correction: &[L; N],
    momentum_matrix: &[L; M],
    start: &Start<L, N, Q, S, U>,
) -> [L; N] {
    let mut change = [L::splat(0.0); N];
    Sh::momentum_change(momentum_matrix, correction, &mut change);
    let mut force = at.momentum;
    for i in 0..N {
        let half_impulse = force[i] - change[i] - start.p[i];
        force[i] = half_impulse * (start.per_h + start.per_h);
    }
    force
}

/// Length of a correction, in units of the coordinates' sizes: a sum, which is not a number where any of
/// it is not.
#[inline(always)]
fn span<L: Lane, const N: usize, const Q: usize, const S: usize, const U: usize>(
    correction: &[L; N],
    start: &Start<L, N, Q, S, U>,
) -> L {
    let mut length = L::splat(0.0);
    for i in 0..N {
        length = correction[i].abs().mul_add(start.per_size[i], length);
    }
    length
}

/// The longest correction to be trusted, when one of some length has missed by so many units of
/// tolerance: what a correction leaves grows with its square.
#[inline(always)]
fn learned<L: Lane>(trusted: L, length: L, missed: L, bits: u8) -> L {
    let shorter = length / missed.sqrt();
    let is_loud = L::splat(LOUD).less(missed);
    let now = L::choose(is_loud, shorter, trusted.max(length));
    L::choose(bits, now, trusted)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trust_follows_what_corrections_miss() {
        assert_eq!(learned(0.0, 0.5, 64.0, 1), 0.0625, "eight times shorter");
        assert_eq!(learned(0.1, 0.5, 1.0, 1), 0.5, "a longer one has done");
        assert_eq!(learned(0.5, 0.1, 1.0, 1), 0.5, "a shorter one tells nothing");
        assert_eq!(learned(0.1, 0.5, 64.0, 0), 0.1, "another lane");
    }
}
