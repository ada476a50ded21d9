//! What is said of a configuration at rest: strands, stiffness, and what their Jacobians reach.

use crate::command::posture::Posture;
use handc_core::model::Model as _;
use handc_runtime::analysis::modes::modes;
use handc_runtime::analysis::singular::singular_values;
use handc_runtime::analysis::tangent::Tangent;
use nalgebra::{DMatrix, SymmetricEigen};

/// A point that is loaded or asked about.
#[derive(Clone, Debug)]
pub(super) struct Tip {
    /// Frame by index.
    pub(super) frame: usize,
    /// Where it is, world axes (m).
    pub(super) place: [f64; 3],
    /// Singular values of its Jacobian (m/rad), three, largest first.
    pub(super) reach: Vec<f64>,
    /// Principal compliances (m/N) and their directions, softest first; none where the rest is not
    /// stable.
    pub(super) compliance: Vec<(f64, [f64; 3])>,
}

/// The answer for one configuration.
#[derive(Clone, Debug)]
pub(super) struct Answer {
    /// Coordinates.
    pub(super) q: Vec<f64>,
    /// Forces and stiffness.
    pub(super) tangent: Tangent,
    /// Natural frequencies (rad/s), slowest first; not a number where a direction is not stable.
    pub(super) frequencies: Vec<f64>,
    /// Lengths of strands (m).
    pub(super) lengths: Vec<f64>,
    /// Natural lengths (m).
    pub(super) rest: Vec<f64>,
    /// Tensions (N).
    pub(super) tensions: Vec<f64>,
    /// Moment arms, s × n.
    pub(super) arms: Vec<f64>,
    /// Singular values of the strand Jacobian (m/rad).
    pub(super) excursion: Vec<f64>,
    /// Loaded points and those asked about.
    pub(super) tips: Vec<Tip>,
}

impl Answer {
    /// Of a posture whose configuration is q.
    pub(super) fn of(
        posture: &mut Posture,
        q: &[f64],
        tangent: Tangent,
        frames: &[usize],
    ) -> Answer {
        let (n, s) = (q.len(), posture.rest.len());
        let mut lengths = vec![0.0; s];
        let mut arms = vec![0.0; s * n];
        posture.model.strand_lengths(q, &mut lengths);
        let rest = posture.rest.clone();
        let mut tensions = posture.tensions(q, &rest);
        // A prescribed length is held by its multiplier.
        for &(row, strand) in &posture.model.structure().prescribed {
            tensions[strand] = tangent.reaction[row];
        }
        posture.model.moment_arms(q, &mut arms);
        let reduced = along(&arms, s, &tangent);
        let vibrations = modes(
            &tangent.linear.mass,
            &stiffness(&tangent, n),
            n,
            &tangent.basis.iter().map(|b| scaled(b, &tangent.scale)).collect::<Vec<_>>(),
        );
        let tips = frames.iter().map(|&frame| Tip::at(posture, q, &tangent, frame)).collect();
        Answer {
            q: q.to_vec(),
            frequencies: vibrations.iter().map(|mode| mode.omega_squared.sqrt()).collect(),
            excursion: singular_values(&reduced, s, tangent.basis.len()),
            lengths,
            rest: posture.rest.clone(),
            tensions,
            arms,
            tips,
            tangent,
        }
    }
}

impl Tip {
    fn at(posture: &mut Posture, q: &[f64], tangent: &Tangent, frame: usize) -> Tip {
        let n = q.len();
        let point = posture.point(frame, [0.0; 3]);
        let mut jacobian = vec![0.0; 6 * n];
        posture.model.point_jacobian(q, &point, &mut jacobian);
        let k = tangent.basis.len();
        let reduced = along(&jacobian[..3 * n], 3, tangent);
        let place = posture.model.frame_poses(q)[frame].translation.0;
        let mut compliance = Vec::new();
        if tangent.stability() == handc_runtime::analysis::tangent::Stability::Stable {
            let reach = DMatrix::from_row_slice(3, k, &reduced);
            let soft = tangent.stiffness().clone().try_inverse();
            if let Some(soft) = soft {
                let at_tip = &reach * soft * reach.transpose();
                let eigen = SymmetricEigen::new((&at_tip + at_tip.transpose()) * 0.5);
                compliance = (0..3)
                    .map(|i| {
                        let axis = [0, 1, 2].map(|j| eigen.eigenvectors[(j, i)]);
                        (eigen.eigenvalues[i], axis)
                    })
                    .collect();
                compliance.sort_by(|a, b| b.0.total_cmp(&a.0));
            }
        }
        Tip { frame, place, reach: singular_values(&reduced, 3, k), compliance }
    }
}

/// A matrix over coordinates, rows by n, along the directions that keep the constraints.
fn along(matrix: &[f64], rows: usize, tangent: &Tangent) -> Vec<f64> {
    let n = tangent.linear.n;
    let mut found = Vec::with_capacity(rows * tangent.basis.len());
    for row in 0..rows {
        for direction in &tangent.basis {
            let terms = (0..n).map(|i| matrix[row * n + i] * direction[i] * tangent.scale[i]);
            found.push(terms.sum());
        }
    }
    found
}

fn scaled(direction: &[f64], scale: &[f64]) -> Vec<f64> {
    direction.iter().zip(scale).map(|(d, s)| d * s).collect()
}

/// The tangent stiffness over all coordinates, as far as the directions reach.
fn stiffness(tangent: &Tangent, n: usize) -> Vec<f64> {
    let basis = DMatrix::from_fn(n, tangent.basis.len(), |i, k| {
        // The transpose undoes the scaling that the stiffness was made with.
        tangent.basis[k][i] / tangent.scale[i]
    });
    let whole = &basis * tangent.stiffness() * basis.transpose();
    (0..n * n).map(|k| whole[(k / n, k % n)]).collect()
}
