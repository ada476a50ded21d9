//! Natural frequencies and mode shapes at a configuration.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// A free vibration of the linearised model.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// ω² (rad²/s²); negative where the configuration is unstable.
    pub omega_squared: f64,
    /// Shape over the coordinates, of unit kinetic metric: φᵀMφ = 1.
    pub shape: Vec<f64>,
}

/// Modes of K φ = ω² M φ within the span of `basis` (the null space of the constraints), slowest
/// first. Directions without mass are left out.
pub fn modes(mass: &[f64], stiffness: &[f64], n: usize, basis: &[Vec<f64>]) -> Vec<Mode> {
    let free = basis.len();
    if free == 0 {
        return Vec::new();
    }
    let mass = DMatrix::from_row_slice(n, n, mass);
    let stiffness = DMatrix::from_row_slice(n, n, stiffness);
    let basis = DMatrix::from_fn(n, free, |i, j| basis[j][i]);
    let symmetric = |a: DMatrix<f64>| (&a + a.transpose()) * 0.5;
    let m = symmetric(basis.transpose() * mass * &basis);
    let k = symmetric(basis.transpose() * stiffness * &basis);
    if m.iter().chain(k.iter()).any(|x| !x.is_finite()) {
        return Vec::new();
    }
    // Equal scales first: rotations and translations differ by orders of magnitude.
    let scale =
        DVector::from_fn(free, |i, _| if m[(i, i)] > 0.0 { m[(i, i)].sqrt().recip() } else { 1.0 });
    let scaled = DMatrix::from_fn(free, free, |i, j| m[(i, j)] * scale[i] * scale[j]);
    let inertia = SymmetricEigen::new(scaled);
    let heavy: Vec<usize> = (0..free).filter(|&i| inertia.eigenvalues[i] > 1e-10).collect();
    if heavy.is_empty() {
        return Vec::new();
    }
    let whiten = DMatrix::from_fn(free, heavy.len(), |i, j| {
        let which = heavy[j];
        scale[i] * inertia.eigenvectors[(i, which)] / inertia.eigenvalues[which].sqrt()
    });
    let vibration = SymmetricEigen::new(symmetric(whiten.transpose() * k * &whiten));
    let shapes = basis * whiten * &vibration.eigenvectors;
    let mut found: Vec<Mode> = (0..heavy.len())
        .map(|i| Mode {
            omega_squared: vibration.eigenvalues[i],
            shape: shapes.column(i).iter().copied().collect(),
        })
        .collect();
    found.sort_by(|a, b| a.omega_squared.total_cmp(&b.omega_squared));
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_masses_on_three_springs() {
        // Unit masses and springs: ω² = 1 and 3.
        let basis = [vec![1.0, 0.0], vec![0.0, 1.0]];
        let found = modes(&[1.0, 0.0, 0.0, 1.0], &[2.0, -1.0, -1.0, 2.0], 2, &basis);
        assert!((found[0].omega_squared - 1.0).abs() < 1e-14);
        assert!((found[1].omega_squared - 3.0).abs() < 1e-14);
        let held = modes(&[1.0, 0.0, 0.0, 1.0], &[2.0, -1.0, -1.0, 2.0], 2, &basis[..1]);
        assert!((held[0].omega_squared - 2.0).abs() < 1e-14);
        assert!(modes(&[0.0], &[1.0], 1, &[vec![1.0]]).is_empty());
    }
}
