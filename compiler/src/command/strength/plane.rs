//! The directions that are asked about: around a plane, or one by one.

use handc_runtime::vector::Mat3;
use std::f64::consts::TAU;

/// A plane of the world's axes or of a frame's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// x to y.
    Xy,
    /// y to z.
    Yz,
    /// x to z.
    Xz,
}

impl Plane {
    /// Names of its two axes.
    pub(super) fn names(self) -> [&'static str; 2] {
        match self {
            Plane::Xy => ["x", "y"],
            Plane::Yz => ["y", "z"],
            Plane::Xz => ["x", "z"],
        }
    }

    fn columns(self) -> [usize; 2] {
        match self {
            Plane::Xy => [0, 1],
            Plane::Yz => [1, 2],
            Plane::Xz => [0, 2],
        }
    }

    /// Its two axes in the world, where `world_from_axes` turns them.
    pub(super) fn axes(self, world_from_axes: &Mat3<f64>) -> [[f64; 3]; 2] {
        self.columns().map(|column| world_from_axes.column(column).0)
    }

    /// The plane in which a point of the given motions moves most: the axis that it moves least along
    /// is left out.
    pub(super) fn of_motion(motion: &[[f64; 3]], world_from_axes: &Mat3<f64>) -> Plane {
        let along = |axis: usize| -> f64 {
            let axis = world_from_axes.column(axis).0;
            let part = |m: &[f64; 3]| (0..3).map(|i| m[i] * axis[i]).sum::<f64>().powi(2);
            motion.iter().map(part).sum()
        };
        let planes = [(2, Plane::Xy), (1, Plane::Xz), (0, Plane::Yz)];
        let least = planes.into_iter().min_by(|a, b| along(a.0).total_cmp(&along(b.0)));
        least.map_or(Plane::Xy, |(_, plane)| plane)
    }
}

/// Angles evenly over a turn, and the directions there.
pub(super) fn around([a, b]: [[f64; 3]; 2], count: usize) -> Vec<(f64, [f64; 3])> {
    (0..count)
        .map(|k| {
            // Quarters are exact.
            let quarter = 4 * k / count;
            let rest = (4 * k % count) as f64 / count as f64 * TAU / 4.0;
            let (s, c) = rest.sin_cos();
            let (c, s) = [(c, s), (-s, c), (-c, -s), (s, -c)][quarter];
            (TAU * k as f64 / count as f64, [0, 1, 2].map(|i| c * a[i] + s * b[i]))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_go_around() {
        let found = around([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], 8);
        assert_eq!(found[0].1, [1.0, 0.0, 0.0]);
        assert_eq!(found[2].1.map(|x| x + 0.0), [0.0, 0.0, 1.0]);
        assert_eq!(found[4].1.map(|x| x + 0.0), [-1.0, 0.0, 0.0]);
        let half = 0.5f64.sqrt();
        assert!((found[1].1[0] - half).abs() < 1e-15 && (found[1].1[2] - half).abs() < 1e-15);
        assert!((found[7].1[0] - half).abs() < 1e-15 && (found[7].1[2] + half).abs() < 1e-15);
    }

    #[test]
    fn a_planar_finger_chooses_its_plane() {
        let world = Mat3::identity();
        assert_eq!(Plane::of_motion(&[[1.0, 2.0, 0.0]], &world), Plane::Xy);
        assert_eq!(Plane::of_motion(&[[1.0, 0.1, 3.0]], &world), Plane::Xz);
        assert_eq!(Plane::of_motion(&[], &world), Plane::Xy);
    }
}
