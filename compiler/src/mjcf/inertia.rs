//! Inertia as MuJoCo accepts it.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// The least mass (kg) and principal moment (kg·m²) of a moving body that MuJoCo loads.
pub(super) const LEAST: f64 = 1e-15;

/// Relative room for rounding where two moments make up the third, or MuJoCo has to find them.
const ROOM: f64 = 32.0 * f64::EPSILON;

/// What was changed in an inertia.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Change {
    /// Nothing, or rounding.
    None,
    /// Moments of zero became the least.
    Least,
    /// The smallest moment was raised until the largest was no more than the sum of the others.
    Raised,
}

/// The nearest inertia (xx yy zz xy xz yz, kg·m²) with every principal moment at least [`LEAST`]
/// and the largest at most the sum of the others; only the small moments change.
pub(super) fn accepted(entries: [f64; 6]) -> ([f64; 6], Change) {
    let [xx, yy, zz, xy, xz, yz] = entries;
    if xy == 0.0 && xz == 0.0 && yz == 0.0 {
        let (added, change) = missing([xx, yy, zz], 0.0);
        return ([xx + added[0], yy + added[1], zz + added[2], 0.0, 0.0, 0.0], change);
    }
    let matrix = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let eigen = SymmetricEigen::new(matrix);
    let (added, change) = missing(eigen.eigenvalues.into(), ROOM);
    if added == [0.0; 3] {
        return (entries, change);
    }
    let axes = eigen.eigenvectors;
    let m = matrix + axes * Matrix3::from_diagonal(&Vector3::from(added)) * axes.transpose();
    ([m.m11, m.m22, m.m33, m.m12, m.m13, m.m23], change)
}

/// What three principal moments lack, with relative room for rounding.
fn missing(moments: [f64; 3], room: f64) -> ([f64; 3], Change) {
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| moments[a].total_cmp(&moments[b]));
    let [low, middle, high] = order;
    let least = LEAST.max(room * moments[high].abs());
    let mut wanted = moments.map(|moment| if moment < least { least } else { moment });
    let mut change = if wanted == moments { Change::None } else { Change::Least };
    let short = wanted[high] - wanted[low] - wanted[middle];
    if short > -room * wanted[high] {
        wanted[low] += short + ROOM * wanted[high];
        if short > ROOM * wanted[high] {
            change = Change::Raised;
        }
    }
    ([0, 1, 2].map(|i| wanted[i] - moments[i]), change)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn good_inertias_stay_as_they_are() {
        for good in [[1e-6, 2e-6, 2.5e-6, 0.0, 0.0, 0.0], [2e-4, 1e-4, 1.5e-4, 1e-5, 0.0, -2e-5]] {
            assert_eq!(accepted(good), (good, Change::None));
        }
    }

    #[test]
    fn points_rods_and_plates_get_the_least() {
        let (point, change) = accepted([0.0; 6]);
        assert_eq!((&point[..3], change), (&[LEAST; 3][..], Change::Least));
        let (rod, _) = accepted([0.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
        assert!(rod[0] >= LEAST && rod[0] < 1e-13 && rod[1..3] == [1.0, 1.0]);
        let (plate, change) = accepted([0.1, 0.2, 0.300_000_000_000_000_1, 0.0, 0.0, 0.0]);
        assert!(plate[0] + plate[1] >= plate[2] && plate[0] < 0.1 + 1e-13);
        assert_eq!(change, Change::None);
    }

    #[test]
    fn a_slanted_rod_keeps_its_moments() {
        // A rod along (1, 1, 0).
        let (rod, change) = accepted([0.5, 0.5, 1.0, -0.5, 0.0, 0.0]);
        assert_eq!(change, Change::Least);
        assert!((rod[0] - 0.5).abs() < 1e-13 && (rod[2] - 1.0).abs() < 1e-13);
    }

    #[test]
    fn an_impossible_inertia_changes_in_its_smallest_moment() {
        let (inertia, change) = accepted([0.02, 0.01, 0.005, 0.0, 0.0, 0.0]);
        assert_eq!(change, Change::Raised);
        assert_eq!(inertia[..2], [0.02, 0.01]);
        assert!((inertia[2] - 0.01).abs() < 1e-15);
    }
}
