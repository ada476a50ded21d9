//! Inverses of small matrices on lanes.

use super::factors::SMALL_PIVOT;
use crate::lane::Lane;

/// Inverts the matrix in place by Gauss and Jordan's method without pivoting; returns the lanes where
/// no pivot was small. The Newton matrix is a mass matrix but for terms in h.
#[inline(always)]
pub(super) fn invert<L: Lane, const N: usize, const M: usize>(a: &mut [L; M]) -> u8 {
    let mut good = L::ALL;
    for k in 0..N {
        let mut largest = L::splat(0.0);
        for j in k..N {
            largest = largest.max(a[k * N + j].abs());
        }
        let pivot = a[k * N + k];
        good &= (L::splat(SMALL_PIVOT) * largest).less(pivot.abs());
        // An inverse is soon older than such rounding.
        let reciprocal = pivot.rough_recip();
        a[k * N + k] = L::splat(1.0);
        for j in 0..N {
            a[k * N + j] = a[k * N + j] * reciprocal;
        }
        for i in 0..N {
            if i != k {
                let factor = a[i * N + k];
                a[i * N + k] = L::splat(0.0);
                for j in 0..N {
                    a[i * N + j] = factor.neg_mul_add(a[k * N + j], a[i * N + j]);
                }
            }
        }
    }
    good
}

/// Matrix times vector.
#[inline(always)]
pub(super) fn multiply<L: Lane, const N: usize>(a: &[f64], x: &[L; N]) -> [L; N] {
    let a = &a[..N * N * L::WIDTH];
    let mut product = [L::splat(0.0); N];
    for i in 0..N {
        for j in 0..N {
            product[i] = L::load(&a[(i * N + j) * L::WIDTH..]).mul_add(x[j], product[i]);
        }
    }
    product
}

#[cfg(test)]
mod tests {
    use super::*;

    const MATRIX: [f64; 9] = [4.0, 1.0, -0.5, 0.8, 3.0, 0.2, -0.4, 0.3, 2.0];

    #[test]
    fn an_inverse_is_one() {
        let mut inverse = MATRIX;
        assert_eq!(invert::<f64, 3, 9>(&mut inverse), 1);
        for i in 0..3 {
            let column: [f64; 3] = std::array::from_fn(|k| inverse[k * 3 + i]);
            let unit = multiply::<f64, 3>(&MATRIX, &column);
            for (k, x) in unit.into_iter().enumerate() {
                assert!((x - f64::from(u8::from(k == i))).abs() < 1e-15, "{unit:?}");
            }
        }
        let mut singular = [1.0, 2.0, 2.0, 4.0];
        assert_eq!(invert::<f64, 2, 4>(&mut singular), 0, "no pivot is left");
    }
}
