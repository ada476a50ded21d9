//! Guesses that know vibrations.
//!
//! Stiff strands make a model vibrate faster than the polynomials of [`crate::predict`] can follow.
//! Linear vibration obeys, from step to step, ∇²Δ₁ = −B·Δ₀ with a matrix B = (M + h²K/4)⁻¹h²K for the
//! midpoint rule. A motion that is such a vibration and a slow part which ∇² makes linear is foretold
//! by
//!
//! Δ₁ = Δ₀ + ∇Δ₀ + ∇²Δ₀ + ∇³Δ₀ − B·∇²Δ₀,
//!
//! the cubic guess and a term in B. B is not computed but learned from what the guess has missed, by
//! the smallest change that would have foretold the last step (Kaczmarz' projection), so that it
//! follows the motion through its configurations.

use super::step::{load, store};
use super::vector::Vector;
use crate::lane::Lane;
use crate::predict::{FADING, guess};

/// Second differences below this, relative to the coordinates, are rounding.
const AUDIBLE: f64 = 1e-13;
/// Where the second difference of the increments stands among the differences.
const SECOND: usize = 2;

/// The increments of the step at hand, with `known` increments (at least 2) behind it.
#[inline(always)]
pub(super) fn foretell<L: Lane, const N: usize, const M: usize>(
    vector: &mut Vector,
    known: usize,
) -> [L; N] {
    let mut echo = load::<L, M>(&vector.echo);
    let per_size = load::<L, N>(&vector.per_size);
    if vector.is_foretold {
        learn(vector, &mut echo, &per_size);
    }
    let (polynomial, least) = guess::<L, N>(known, &vector.differences, &vector.missed);
    if known <= SECOND + 1 {
        return polynomial;
    }
    let differences = |k: usize| load::<L, N>(&vector.differences[k * N * L::WIDTH..]);
    let (lead, mut foretold) = (differences(SECOND), differences(0));
    for k in 1..=SECOND + 1 {
        let difference = differences(k);
        for i in 0..N {
            foretold[i] = foretold[i] + difference[i];
        }
    }
    for i in 0..N {
        for j in 0..N {
            foretold[i] = echo[i * N + j].neg_mul_add(lead[j], foretold[i]);
        }
    }
    store(&foretold, &mut vector.foretold);
    store(&lead, &mut vector.lead);
    let better = match vector.is_foretold {
        true => L::load(&vector.missed_echo).less(least),
        false => 0,
    };
    vector.is_foretold = true;
    let mut chosen = polynomial;
    for i in 0..N {
        chosen[i] = L::choose(better, foretold[i], polynomial[i]);
    }
    chosen
}

/// Learns from the last step.
#[inline(always)]
fn learn<L: Lane, const N: usize, const M: usize>(
    vector: &mut Vector,
    echo: &mut [L; M],
    per_size: &[L; N],
) {
    let (lead, foretold) = (load::<L, N>(&vector.lead), load::<L, N>(&vector.foretold));
    let mut missed = load::<L, N>(&vector.differences);
    let mut weighted = lead;
    let (mut square, mut size) = (L::splat(0.0), L::splat(0.0));
    for i in 0..N {
        missed[i] = missed[i] - foretold[i];
        let relative = missed[i] * per_size[i];
        size = relative.mul_add(relative, size);
        let relative = lead[i] * per_size[i];
        square = relative.mul_add(relative, square);
        weighted[i] = relative * per_size[i];
    }
    L::load(&vector.missed_echo).mul_add(L::splat(FADING), size).store(&mut vector.missed_echo);
    let audible = L::splat(AUDIBLE * AUDIBLE).less(square) & size.less(L::splat(f64::INFINITY));
    let per_square = L::choose(audible, L::splat(1.0) / square, L::splat(0.0));
    for i in 0..N {
        let share = L::choose(audible, missed[i] * per_square, L::splat(0.0));
        for j in 0..N {
            echo[i * N + j] = share.neg_mul_add(weighted[j], echo[i * N + j]);
        }
    }
    store(echo, &mut vector.echo);
}
