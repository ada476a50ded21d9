//! Factors of small matrices without structure on lanes, and products with them. Where many entries are
//! zero a compiled model brings its own ([`crate::shape::Shape::factor`]).

use crate::lane::Lane;

/// A pivot below this part of its row's largest entry wants pivoting.
pub(crate) const SMALL_PIVOT: f64 = 1e-6;

/// Factors a matrix without pivoting: below the diagonal stand the factors of the rows, on it the
/// reciprocals of the pivots. Returns the lanes where no pivot was small. The Newton matrix is a mass
/// matrix but for terms in h.
#[inline(always)]
pub(crate) fn factor<L: Lane, const N: usize, const M: usize>(
    matrix: &[L; M],
    factors: &mut [L; M],
) -> u8 {
    *factors = *matrix;
    let a = factors;
    let mut good = L::ALL;
    for k in 0..N {
        let mut largest = L::splat(0.0);
        for j in k..N {
            largest = largest.max(a[k * N + j].abs());
        }
        let pivot = a[k * N + k];
        good &= (L::splat(SMALL_PIVOT) * largest).less(pivot.abs());
        // What such rounding leaves of a correction is far below what it leaves itself.
        let reciprocal = pivot.rough_recip();
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

/// Solves for one right-hand side.
#[inline(always)]
pub(crate) fn solve<L: Lane, const N: usize, const M: usize>(
    factors: &[L; M],
    b: &[L; N],
    x: &mut [L; N],
) {
    *x = *b;
    for i in 1..N {
        for j in 0..i {
            x[i] = factors[i * N + j].neg_mul_add(x[j], x[i]);
        }
    }
    for i in (0..N).rev() {
        for j in i + 1..N {
            x[i] = factors[i * N + j].neg_mul_add(x[j], x[i]);
        }
        x[i] = x[i] * factors[i * N + i];
    }
}

/// Matrix times vector.
#[inline(always)]
pub(crate) fn product<L: Lane, const N: usize, const M: usize>(
    matrix: &[L; M],
    x: &[L; N],
    product: &mut [L; N],
) {
    *product = [L::splat(0.0); N];
    for i in 0..N {
        for j in 0..N {
            product[i] = matrix[i * N + j].mul_add(x[j], product[i]);
        }
    }
}

/// Sums of the sizes of a row's entries, each times the size of its column.
#[inline(always)]
pub(crate) fn row_sizes<L: Lane, const N: usize, const M: usize>(
    matrix: &[L; M],
    size: &[L; N],
    sums: &mut [L; N],
) {
    *sums = [L::splat(0.0); N];
    for i in 0..N {
        for j in 0..N {
            sums[i] = matrix[i * N + j].abs().mul_add(size[j], sums[i]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_solve() {
        let matrix = [4.0, 1.0, -0.5, 0.8, 3.0, 0.2, -0.4, 0.3, 2.0];
        let (mut factors, mut x) = ([0.0; 9], [0.0; 3]);
        assert_eq!(factor::<f64, 3, 9>(&matrix, &mut factors), 1);
        solve::<f64, 3, 9>(&factors, &[1.0, -2.0, 0.5], &mut x);
        for (row, expected) in matrix.chunks(3).zip([1.0, -2.0, 0.5]) {
            let found: f64 = row.iter().zip(x).map(|(a, x)| a * x).sum();
            assert!((found - expected).abs() < 1e-15);
        }
        let mut b = [0.0; 3];
        product::<f64, 3, 9>(&matrix, &x, &mut b);
        assert!(b.iter().zip([1.0, -2.0, 0.5]).all(|(b, expected)| (b - expected).abs() < 1e-15));
        row_sizes::<f64, 3, 9>(&matrix, &[1.0, 2.0, 4.0], &mut b);
        assert_eq!(b, [8.0, 0.8 + 6.0 + 0.8, 0.4 + 0.6 + 8.0]);
        let singular = [1.0, 2.0, 2.0, 4.0];
        assert_eq!(factor::<f64, 2, 4>(&singular, &mut [0.0; 4]), 0, "no pivot is left");
    }
}
