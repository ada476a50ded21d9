//! Matrices over absolute angles as matrices over their differences.

use handc_core::scalar::Scalar;

/// Where (i, j), j ≤ i, stands in a lower triangle.
#[inline]
pub(super) fn entry(i: usize, j: usize) -> usize {
    i * (i + 1) / 2 + j
}

/// From a symmetric matrix over absolute angles to one over their differences: entry (i, j) becomes
/// the sum over all (a, b) with a ≥ i and b ≥ j.
pub(super) fn sum_even<S: Scalar>(matrix: &mut [S], count: usize) {
    for i in (0..count - 1).rev() {
        for j in 0..=i {
            let below = matrix[entry(i + 1, j)];
            matrix[entry(i, j)] += below;
        }
    }
    for i in (0..count).rev() {
        for j in (0..=i).rev() {
            // Beyond the diagonal stands the mirrored entry.
            let (a, b) = if j == i { (i + 1, i) } else { (i, j + 1) };
            if a < count {
                let right = matrix[entry(a, b)];
                matrix[entry(i, j)] += right;
            }
        }
    }
}

/// As [`sum_even`] for an antisymmetric matrix, whose sums on the diagonal vanish.
pub(super) fn sum_odd<S: Scalar>(matrix: &mut [S], count: usize) {
    for i in (0..count - 1).rev() {
        for j in 0..i {
            let below = matrix[entry(i + 1, j)];
            matrix[entry(i, j)] += below;
        }
    }
    for i in (1..count).rev() {
        for j in (0..i - 1).rev() {
            let right = matrix[entry(i, j + 1)];
            matrix[entry(i, j)] += right;
        }
    }
}
