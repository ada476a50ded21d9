//! Guesses that know vibrations.
//!
//! Stiff strands make a model vibrate faster than the polynomials of [`crate::predict`] can follow.
//! Linear vibration obeys, from step to step, ∇²Δ₁ = −B·Δ₀ with a matrix B = (M + h²K/4)⁻¹h²K for the
//! midpoint rule. A motion that is such a vibration and a slow part whose increments are quadratic in
//! time obeys ∇⁵Δ₁ = −B·∇³Δ₀, and is foretold by
//!
//! Δ₁ = Δ₀ + ∇Δ₀ + ∇²Δ₀ + ∇³Δ₀ + ∇⁴Δ₀ − B·∇³Δ₀,
//!
//! the guess of highest degree and a term in B. B is not computed but learned from what the guess has
//! missed, by the smallest change that would have foretold the last step (Kaczmarz' projection), so
//! that it follows the motion through its configurations. While guesses do, one step in some is
//! enough to learn from.

use super::vector::Vector;
use crate::lane::{Lane, load, store};
use crate::predict::{DEGREES, FADING, best_degrees, guess};

/// Third differences below this, relative to the coordinates, are rounding.
const AUDIBLE: f64 = 1e-13;
/// While guesses do, one step in so many is learned from.
const SELDOM: usize = 4;
/// Where the third difference of the increments stands among the differences.
const THIRD: usize = 3;

impl Vector {
    /// Whether what guesses have missed is looked at once `known` increments are known.
    #[inline(always)]
    pub(super) fn learns(&self, known: usize) -> bool {
        // The first guess of each degree is always looked at.
        !self.is_calm || known.is_multiple_of(SELDOM) || known <= DEGREES + 1
    }
}

/// The increments of the step at hand, with `known` increments (at least 2) behind it.
#[inline(always)]
pub(super) fn foretell<L: Lane, const N: usize>(vector: &mut Vector, known: usize) -> [L; N] {
    let learns = vector.learns(known);
    if vector.is_foretold && learns {
        learn::<L, N>(vector);
        vector.has_learned = true;
    }
    // What misses tell stays until there are others.
    if learns || vector.choice.is_none() {
        let (best, least) = best_degrees::<L>(known, &vector.missed);
        let better = match vector.has_learned {
            true => L::load(&vector.missed_echo).less(least),
            false => 0,
        };
        vector.choice = Some((best, better));
    }
    let (best, better) = vector.choice.unwrap_or_default();
    if known <= THIRD + 1 {
        return guess(best, &vector.differences);
    }
    vector.is_foretold = vector.learns(known + 1);
    if better == 0 && !vector.is_foretold {
        return guess(best, &vector.differences);
    }
    let count = N * L::WIDTH;
    let lead = load::<L, N>(&vector.differences[THIRD * count..]);
    let mut foretold = load::<L, N>(&vector.differences);
    for k in 1..=THIRD + 1 {
        let differences = &vector.differences[k * count..][..count];
        for i in 0..N {
            foretold[i] = foretold[i] + L::load(&differences[i * L::WIDTH..]);
        }
    }
    let echo = &vector.echo[..N * count];
    for i in 0..N {
        for j in 0..N {
            let entry = L::load(&echo[(i * N + j) * L::WIDTH..]);
            foretold[i] = entry.neg_mul_add(lead[j], foretold[i]);
        }
    }
    if vector.is_foretold {
        store(&foretold, &mut vector.foretold);
        store(&lead, &mut vector.lead);
    }
    if better == L::ALL {
        return foretold;
    }
    let polynomial = guess::<L, N>(best, &vector.differences);
    let mut chosen = polynomial;
    for i in 0..N {
        chosen[i] = L::choose(better, foretold[i], polynomial[i]);
    }
    chosen
}

/// Learns from the last step.
#[inline(always)]
fn learn<L: Lane, const N: usize>(vector: &mut Vector) {
    let per_size = load::<L, N>(&vector.per_size);
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
    let per_square = L::choose(audible, square.rough_recip(), L::splat(0.0));
    let echo = &mut vector.echo[..N * N * L::WIDTH];
    for i in 0..N {
        let share = L::choose(audible, missed[i] * per_square, L::splat(0.0));
        for j in 0..N {
            let entry = &mut echo[(i * N + j) * L::WIDTH..];
            share.neg_mul_add(weighted[j], L::load(entry)).store(entry);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::vector::Counts;
    use super::*;
    use crate::predict::shift;

    /// Increments of two vibrations of 0.9 and 0.4 rad a step, along directions that are not
    /// orthogonal, and a slow motion.
    fn increments(step: usize) -> [f64; 2] {
        let t = step as f64;
        let (fast, slow) = (1e-4 * (0.9 * t).cos(), 1e-4 * (0.4 * t + 1.0).cos());
        let drift = 1e-3 * (1e-3 * t).sin();
        [fast + 0.3 * slow + drift, -0.5 * fast + slow - 2.0 * drift]
    }

    #[test]
    fn vibrations_are_learned() {
        let counts = Counts { unknowns: 2, coordinates: 2, strands: 0, inputs: 0 };
        let mut vector = Vector::new(0, [1, 1], &counts);
        vector.per_size = vec![1.0; 2];
        let mut missed = Vec::new();
        for step in 0..400 {
            let now = increments(step);
            if step >= 2 {
                let guess: [f64; 2] = foretell::<f64, 2>(&mut vector, step);
                missed.push((guess[0] - now[0]).abs().max((guess[1] - now[1]).abs()));
            }
            let mut misses = [0.0; DEGREES];
            for i in 0..2 {
                let next = shift(now[i], &mut vector.differences[i..], 2);
                (0..DEGREES).for_each(|k| misses[k] += next[k] * next[k]);
            }
            for (k, miss) in misses.into_iter().enumerate() {
                vector.missed[k] = miss + FADING * vector.missed[k];
            }
        }
        let worst = |range: &[f64]| range.iter().copied().fold(0.0, f64::max);
        let late = worst(&missed[300..]);
        let polynomial = vector.missed.iter().copied().fold(f64::INFINITY, f64::min).sqrt();
        assert!(late < 1e-10, "what was learned: {late:e}");
        assert!(polynomial > 1e4 * late, "the polynomials alone: {polynomial:e}");
    }
}
