//! Newton's method of one step on lanes: several blocks of one shape, or one block of several runs,
//! each in its own lane.
//!
//! It is the method of [`crate::step`] without its last resorts: lanes go on together until each
//! has converged, a lane that is done is held still, and if any lane needs a shorter step, another
//! guess or pivoting, the step is given back to be taken there.

use crate::internal::RATE;
use crate::lane::Lane;
use crate::shape::{Local, Shape};
use crate::step::{BALANCE, FLOOR, KEEP_FACTORS, LINEAR_END, STAGNATION};

/// Evaluations of the Newton matrix before the step is given back.
const MATRICES: usize = 6;
/// Corrections with the same factors.
const CORRECTIONS: usize = 6;
/// A pivot below this part of its row's largest entry wants pivoting.
const SMALL_PIVOT: f64 = 1e-6;

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
    /// Step (s).
    pub(crate) h: L,
    /// Natural lengths (m).
    pub(crate) rest: [L; S],
    /// Inputs.
    pub(crate) inputs: [L; U],
    /// Least size of each coordinate for tolerances (1 rad or the model's length).
    pub(crate) size: [L; N],
    /// What past steps add to the rates of internal coordinates.
    pub(crate) past: [L; N],
    /// Relative tolerance on momenta.
    pub(crate) tolerance: L,
}

/// Which equations are of static equilibrium, where their tolerance is wider and remembers how stiff
/// they have been; see [`crate::step`].
#[derive(Clone, Copy)]
pub(crate) struct Balances<L, const N: usize> {
    /// 1 where it is one, else 0.
    pub(crate) is: [L; N],
    /// The largest sensitivity so far; zero for others.
    pub(crate) stiffest: [L; N],
}

/// Where it ends.
pub(crate) struct End<L, const N: usize, const Q: usize> {
    /// What static equilibria remember.
    pub(crate) balances: Option<Balances<L, N>>,
    /// Increment.
    pub(crate) delta: [L; Q],
    /// Force at the midpoint.
    pub(crate) force: [L; N],
    /// Newton iterations.
    pub(crate) iterations: usize,
    /// Lanes that have not converged, as bits.
    pub(crate) failed: u8,
}

/// What an evaluation gives.
struct Residual<L, const N: usize> {
    /// p0 + (h/2)f − p.
    r: [L; N],
    momentum: [L; N],
    force: [L; N],
}

/// The largest ratio, and which lanes are finite throughout.
#[inline(always)]
fn merit<L: Lane, const N: usize>(r: &[L; N], per_scale: &[L; N]) -> (L, u8) {
    let (mut largest, mut sum) = (L::splat(0.0), L::splat(0.0));
    for i in 0..N {
        let ratio = r[i].abs() * per_scale[i];
        largest = largest.max(ratio);
        sum = sum + ratio;
    }
    (largest, sum.less(L::splat(f64::INFINITY)))
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
    balances: Option<Balances<L, N>>,
) -> End<L, N, Q> {
    let zero = L::splat(0.0);
    let per_h = L::splat(1.0) / start.h;
    let half_h = L::splat(0.5) * start.h;
    let mut local = Local {
        q: start.q,
        v: start.q,
        t: start.t,
        h: start.h,
        rest: start.rest,
        inputs: start.inputs,
    };
    let mut end =
        End { balances, delta: start.delta, force: [zero; N], iterations: 0, failed: L::ALL };
    let mut at = Residual { r: [zero; N], momentum: [zero; N], force: [zero; N] };
    let mut done = 0;
    for _ in 0..MATRICES {
        let mut matrix = [zero; M];
        put_at(&mut local, start, &end.delta, per_h, Sh::INTERNAL);
        Sh::evaluate_with_matrix(&local, constants, &mut at.momentum, &mut at.force, &mut matrix);
        at.balance(start, half_h);
        let per_scale = per_scales(start, &at, half_h, &matrix, &mut end.balances);
        let (mut before, finite) = merit(&at.r, &per_scale);
        let converged = before.less_equal(L::splat(1.0)) & finite & !done;
        hold(converged, &at.force, &mut end.force);
        done |= converged;
        if done == L::ALL {
            break;
        }
        if (finite | done) & factor::<L, N, M>(&mut matrix) != L::ALL {
            break;
        }
        for _ in 0..CORRECTIONS {
            end.iterations += 1;
            let correction = solve::<L, N, M>(&matrix, &at.r);
            for i in 0..N {
                end.delta[i] = L::choose(done, end.delta[i], end.delta[i] - correction[i]);
            }
            let force_before = at.force;
            put_at(&mut local, start, &end.delta, per_h, Sh::INTERNAL);
            Sh::evaluate(&local, constants, &mut at.momentum, &mut at.force);
            at.balance(start, half_h);
            let (next, finite) = merit(&at.r, &per_scale);
            // How far the correction moved the half step's impulse: the next one would move it by
            // as much less as the residual has fallen.
            let mut moved = zero;
            for i in 0..N {
                let change = half_h * (at.force[i] - force_before[i]);
                moved = moved.max(change.abs() * per_scale[i]);
            }
            let left = moved.max(next) * next;
            let converged = next.less_equal(L::splat(1.0)) & finite & !done;
            let linear = left.less_equal(L::splat(LINEAR_END) * before) & finite;
            let linear = linear & !converged & !done;
            if linear != 0 {
                end.iterations += 1;
                let last = solve::<L, N, M>(&matrix, &at.r);
                for i in 0..N {
                    end.delta[i] = L::choose(linear, end.delta[i] - last[i], end.delta[i]);
                }
            }
            let mut over = converged | linear;
            if (done | over) != L::ALL {
                // The residual hardly falls and the correction is rounding: the floor.
                let mut largest = zero;
                for i in 0..N {
                    let size = start.q[i].abs().max(start.size[i]);
                    largest = largest.max(correction[i].abs() / size);
                }
                let stagnant = (L::splat(0.1) * before).less(next)
                    & largest.less_equal(L::splat(STAGNATION))
                    & finite;
                over |= stagnant & !done;
            }
            hold(over, &at.force, &mut end.force);
            done |= over;
            if done == L::ALL {
                end.failed = 0;
                return end;
            }
            if (next.less(before) & finite) | done != L::ALL {
                end.failed = !done & L::ALL;
                return end;
            }
            let fast = next.less(L::splat(KEEP_FACTORS) * before);
            before = next;
            if fast | done != L::ALL {
                break;
            }
        }
    }
    end.failed = !done & L::ALL;
    end
}

/// Keeps the force of lanes that are done.
#[inline(always)]
fn hold<L: Lane, const N: usize>(bits: u8, force: &[L; N], kept: &mut [L; N]) {
    for i in 0..N {
        kept[i] = L::choose(bits, force[i], kept[i]);
    }
}

/// 1 over the tolerance of each equation; see [`crate::step`].
#[inline(always)]
fn per_scales<
    L: Lane,
    const N: usize,
    const M: usize,
    const Q: usize,
    const S: usize,
    const U: usize,
>(
    start: &Start<L, N, Q, S, U>,
    at: &Residual<L, N>,
    half_h: L,
    matrix: &[L; M],
    balances: &mut Option<Balances<L, N>>,
) -> [L; N] {
    let floor = L::splat(FLOOR);
    let mut size = start.size;
    for i in 0..N {
        size[i] = size[i].max(start.q[i].abs());
    }
    let mut scales = size;
    for i in 0..N {
        let p = start.p[i].abs();
        let asked = p + at.momentum[i].abs() + (half_h * at.force[i]).abs();
        let mut row = p;
        let mut sum = L::splat(0.0);
        for j in 0..N {
            sum = matrix[i * N + j].abs().mul_add(size[j], sum);
        }
        if let Some(balances) = balances {
            sum = sum.max(balances.stiffest[i]);
            balances.stiffest[i] = balances.is[i] * sum;
            sum = L::splat(BALANCE - 1.0).mul_add(balances.stiffest[i], sum);
        }
        row = row.max(sum);
        let scale = (floor * row).max(start.tolerance * asked);
        scales[i] = L::splat(1.0) / scale.max(L::splat(f64::MIN_POSITIVE));
    }
    scales
}

/// Factors the matrix in place without pivoting, reciprocals of the pivots on the diagonal; returns
/// the lanes where no pivot was small. The Newton matrix is a mass matrix but for terms in h.
#[inline(always)]
fn factor<L: Lane, const N: usize, const M: usize>(a: &mut [L; M]) -> u8 {
    let mut good = L::ALL;
    for k in 0..N {
        let mut largest = L::splat(0.0);
        for j in k..N {
            largest = largest.max(a[k * N + j].abs());
        }
        let pivot = a[k * N + k];
        good &= (L::splat(SMALL_PIVOT) * largest).less(pivot.abs());
        let reciprocal = L::splat(1.0) / pivot;
        a[k * N + k] = reciprocal;
        for i in k + 1..N {
            let factor = a[i * N + k] * reciprocal;
            a[i * N + k] = factor;
            for j in k + 1..N {
                a[i * N + j] = factor.neg_mul_add(a[k * N + j], a[i * N + j]);
            }
        }
    }
    good
}

/// Solves with the factors.
#[inline(always)]
fn solve<L: Lane, const N: usize, const M: usize>(a: &[L; M], b: &[L; N]) -> [L; N] {
    let mut x = *b;
    for i in 0..N {
        for j in 0..i {
            x[i] = a[i * N + j].neg_mul_add(x[j], x[i]);
        }
    }
    for i in (0..N).rev() {
        for j in i + 1..N {
            x[i] = a[i * N + j].neg_mul_add(x[j], x[i]);
        }
        x[i] = x[i] * a[i * N + i];
    }
    x
}
