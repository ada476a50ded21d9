//! Tolerances of the step's equations on lanes, and residuals in units of them.

use super::{Residual, Start};
use crate::lane::Lane;
use crate::shape::Shape;
use crate::step::{BALANCE, FLOOR};

/// Scales below this are none; its reciprocal is finite in all arithmetic.
const LEAST: f64 = 1e-300;

/// Which equations are of static equilibrium, where their tolerance is wider and remembers how stiff
/// they have been; see [`crate::step`].
#[derive(Clone, Copy)]
pub(crate) struct Balances<L, const N: usize> {
    /// 1 where it is one, else 0.
    pub(crate) is: [L; N],
    /// The largest sensitivity so far; zero for others.
    pub(crate) stiffest: [L; N],
}

/// What rounding of the coordinates does to each equation: Σ|Jᵢⱼ|·size(j), with a wider bound for
/// static equilibria; see [`crate::step`].
#[inline(always)]
pub(super) fn sensitivities<
    L: Lane,
    Sh: Shape<N, M, Q, S, U>,
    const N: usize,
    const M: usize,
    const Q: usize,
    const S: usize,
    const U: usize,
>(
    start: &Start<L, N, Q, S, U>,
    matrix: &[L; M],
    balances: &mut Option<Balances<L, N>>,
) -> [L; N] {
    let mut size = start.size;
    for i in 0..N {
        size[i] = size[i].max(start.q[i].abs());
    }
    let mut sums = [L::splat(0.0); N];
    Sh::sensitivities(matrix, &size, &mut sums);
    if let Some(balances) = balances {
        for i in 0..N {
            sums[i] = sums[i].max(balances.stiffest[i]);
            balances.stiffest[i] = balances.is[i] * sums[i];
            sums[i] = L::splat(BALANCE - 1.0).mul_add(balances.stiffest[i], sums[i]);
        }
    }
    sums
}

/// 1 over the tolerance of each equation; see [`crate::step`].
#[inline(always)]
pub(super) fn per_scales<
    L: Lane,
    const N: usize,
    const Q: usize,
    const S: usize,
    const U: usize,
>(
    start: &Start<L, N, Q, S, U>,
    at: &Residual<L, N>,
    half_h: L,
    sensitivity: &[L; N],
) -> [L; N] {
    let mut scales = *sensitivity;
    for i in 0..N {
        let p = start.p[i].abs();
        let asked = p + at.momentum[i].abs() + (half_h * at.force[i]).abs();
        let floor = L::splat(FLOOR) * p.max(sensitivity[i]);
        let scale = floor.max(start.tolerance * asked);
        scales[i] = scale.max(L::splat(LEAST)).rough_recip();
    }
    scales
}

/// The largest ratio, and which lanes are finite throughout.
#[inline(always)]
pub(super) fn merit<L: Lane, const N: usize>(r: &[L; N], per_scale: &[L; N]) -> (L, u8) {
    let (mut largest, mut sum) = (L::splat(0.0), L::splat(0.0));
    for i in 0..N {
        let ratio = r[i].abs() * per_scale[i];
        largest = largest.max(ratio);
        sum = sum + ratio;
    }
    (largest, sum.less(L::splat(f64::INFINITY)))
}
