//! Square roots together with their reciprocals, from the estimates that some processors have.

use super::Lane;

/// Root and reciprocal of `x` from an estimate of the reciprocal to 14 bits: its error goes from e to
/// e³ and then to e² (Goldschmidt's iteration). The exact instructions, of which one is done at a time,
/// take four times as long.
#[inline(always)]
pub(super) fn refined<L: Lane>(x: L, estimate: L) -> (L, L) {
    let (one, half) = (L::splat(1.0), L::splat(0.5));
    let off = (x * estimate).neg_mul_add(estimate, one);
    let series = L::splat(0.375).mul_add(off, half);
    let reciprocal = (estimate * off).mul_add(series, estimate);
    let root = x * reciprocal;
    let off = half * root.neg_mul_add(reciprocal, one);
    let is_zero = x.equal(L::splat(0.0));
    let root = L::choose(is_zero, x, root.mul_add(off, root));
    (root, L::choose(is_zero, estimate, reciprocal.mul_add(off, reciprocal)))
}

#[cfg(test)]
mod tests {
    use super::super::{Work, available, call};
    use super::*;

    /// Root, reciprocal of the root and rough reciprocal of eight numbers.
    struct Roots<'a>(&'a [f64; 8], &'a mut [[f64; 8]; 3]);

    impl Work for Roots<'_> {
        #[inline(always)]
        fn run<L: Lane>(self) {
            for first in (0..8).step_by(L::WIDTH) {
                let x = L::load(&self.0[first..]);
                let (root, reciprocal) = x.sqrt_recip();
                root.store(&mut self.1[0][first..]);
                reciprocal.store(&mut self.1[1][first..]);
                x.rough_recip().store(&mut self.1[2][first..]);
                assert_eq!(x.sqrt().lane(0).to_bits(), root.lane(0).to_bits());
            }
        }
    }

    fn off(found: f64, expected: f64) -> f64 {
        (found - expected).abs() / (expected.abs() * f64::EPSILON)
    }

    #[test]
    fn vectors_have_the_roots_of_the_standard_library() {
        for width in [4, available()] {
            for i in 0..40_000 {
                let x = |k: i32| {
                    10f64.powf(0.0141 * f64::from(i % 20_000) - 141.0)
                        * (1.0 + 0.37 * f64::from(k + i % 7))
                };
                let x: [f64; 8] = std::array::from_fn(|k| x(k as i32));
                let mut found = [[0.0; 8]; 3];
                if !call(width, Roots(&x, &mut found)) {
                    return;
                }
                for k in 0..8 {
                    assert!(off(found[0][k], x[k].sqrt()) <= 1.0, "root of {:e}", x[k]);
                    assert!(
                        off(found[1][k], 1.0 / x[k].sqrt()) <= 1.5,
                        "1 over root of {:e}",
                        x[k]
                    );
                    assert!((found[2][k] * x[k] - 1.0).abs() < 2f64.powi(-26), "1 over {:e}", x[k]);
                }
            }
            let x = [0.0, 1.0, 4.0, -1.0, f64::NAN, 0.25, 1e-310, 1e300];
            let mut found = [[0.0; 8]; 3];
            assert!(call(width, Roots(&x, &mut found)));
            assert_eq!(found[0][..3], [0.0, 1.0, 2.0]);
            assert_eq!(found[1][..3], [f64::INFINITY, 1.0, 0.5]);
            assert!(found[0][3].is_nan() && found[0][4].is_nan());
            assert!(off(found[0][7], 1e150) <= 1.0);
        }
    }
}
