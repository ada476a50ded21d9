//! Singular values of a Jacobian: how far unit motions reach, and in how many directions.

use nalgebra::DMatrix;

/// Singular values of the m×n matrix by rows, largest first; none where a number is not finite.
pub fn singular_values(matrix: &[f64], m: usize, n: usize) -> Vec<f64> {
    if m == 0 || n == 0 || matrix.iter().any(|x| !x.is_finite()) {
        return Vec::new();
    }
    let mut values: Vec<f64> =
        DMatrix::from_row_slice(m, n, matrix).singular_values().iter().copied().collect();
    values.sort_by(|a, b| b.total_cmp(a));
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arm_of_two_links() {
        // Straight out, unit links: only across, √(2² + 1²).
        let found = singular_values(&[0.0, 0.0, 2.0, 1.0], 2, 2);
        assert!((found[0] - 5f64.sqrt()).abs() < 1e-14 && found[1].abs() < 1e-14);
        assert!(singular_values(&[f64::NAN], 1, 1).is_empty());
        assert!(singular_values(&[], 0, 3).is_empty());
    }
}
