//! What corrections tell of the Newton matrix.

use super::Start;
use crate::lane::Lane;

/// What a correction tells of the matrix: Broyden's rank-one update of the inverse (Broyden 1965, the
/// first of his methods), which maps the change of the residual to the correction that made it.
///
/// With the correction c, the next one d = J⁻¹r and weights w that make coordinates comparable,
/// J⁻¹ + d·(w∘c)ᵀJ⁻¹/(cᵀwc − cᵀwd) is the inverse after the update, and d·cᵀwc/(cᵀwc − cᵀwd) what it
/// makes of the residual.
pub(super) struct Secant<L, const N: usize> {
    /// w∘c.
    weighted: [L; N],
    /// By which the update stretches the next correction.
    pub(super) stretch: L,
    /// 1/cᵀwc.
    per_square: L,
}

impl<L: Lane, const N: usize> Secant<L, N> {
    #[inline(always)]
    pub(super) fn new<const Q: usize, const S: usize, const U: usize>(
        correction: &[L; N],
        next: &[L; N],
        start: &Start<L, N, Q, S, U>,
    ) -> Self {
        let mut weighted = *correction;
        let (mut square, mut along) = (L::splat(0.0), L::splat(0.0));
        for i in 0..N {
            weighted[i] = correction[i] * start.per_size[i] * start.per_size[i];
            square = weighted[i].mul_add(correction[i], square);
            along = weighted[i].mul_add(next[i], along);
        }
        // The one does not wait for the other.
        let (per_square, per_left) = (square.rough_recip(), (square - along).rough_recip());
        Secant { weighted, stretch: square * per_left, per_square }
    }

    /// Lanes in which the update changes the inverse little.
    #[inline(always)]
    pub(super) fn is_sound(&self) -> u8 {
        self.stretch.less(L::splat(2.0)) & L::splat(0.5).less(self.stretch)
    }

    /// Updates the inverse in the lanes whose bits are set; `next` has been stretched.
    #[inline(always)]
    pub(super) fn teach(&self, bits: u8, inverse: &mut [f64], next: &[L; N]) {
        let inverse = &mut inverse[..N * N * L::WIDTH];
        let zero = L::splat(0.0);
        let mut row = [zero; N];
        for i in 0..N {
            let factor = L::choose(bits, self.weighted[i] * self.per_square, zero);
            for j in 0..N {
                row[j] = factor.mul_add(L::load(&inverse[(i * N + j) * L::WIDTH..]), row[j]);
            }
        }
        for i in 0..N {
            let next = L::choose(bits, next[i], zero);
            for j in 0..N {
                let entry = &mut inverse[(i * N + j) * L::WIDTH..];
                next.mul_add(row[j], L::load(entry)).store(entry);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::inverse::{invert, multiply};
    use super::*;

    const MATRIX: [f64; 9] = [4.0, 1.0, -0.5, 0.8, 3.0, 0.2, -0.4, 0.3, 2.0];

    #[test]
    fn an_old_inverse_learns_what_corrections_tell() {
        let mut inverse = MATRIX.map(|x| 1.1 * x);
        invert::<f64, 3, 9>(&mut inverse);
        let start = Start::<f64, 3, 3, 0, 0> {
            q: [0.0; 3],
            delta: [0.0; 3],
            p: [0.0; 3],
            t: 0.0,
            h: 1.0,
            per_h: 1.0,
            rest: [],
            inputs: [],
            size: [1.0, 0.1, 1.0],
            per_size: [1.0, 10.0, 1.0],
            past: [0.0; 3],
            tolerance: 0.0,
        };
        // The residual r = A·x − b, linear.
        let mut r = [1.0, -2.0, 0.5];
        let correction = multiply::<f64, 3>(&inverse, &r);
        let change = multiply::<f64, 3>(&MATRIX, &correction);
        for i in 0..3 {
            r[i] -= change[i];
        }
        let mut next = multiply::<f64, 3>(&inverse, &r);
        let secant = Secant::new(&correction, &next, &start);
        assert_eq!(secant.is_sound(), 1);
        next = next.map(|x| secant.stretch * x);
        secant.teach(1, &mut inverse, &next);
        let told = multiply::<f64, 3>(&inverse, &change);
        let ahead = multiply::<f64, 3>(&inverse, &r);
        for i in 0..3 {
            assert!((told[i] - correction[i]).abs() < 1e-14, "the change leads to the correction");
            assert!((ahead[i] - next[i]).abs() < 1e-14, "and the next one was stretched rightly");
        }
    }
}
