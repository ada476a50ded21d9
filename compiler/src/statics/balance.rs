//! The balance of a pose: what all else does, and what one newton of each strand does against it.

use handc_runtime::analysis::linear::Held;
use handc_runtime::analysis::tangent::Tangent;
use handc_runtime::interpreter::Interpreter;
use handc_runtime::mechanism::Point;

/// Forces at a pose along the directions that keep the constraints; the pulled strands make none of
/// their own.
///
/// A pose is at rest where force + Σ Tᵢ·pullᵢ − JᵀF = 0, with tensions Tᵢ and a force F that the
/// model exerts at a point of Jacobian J (Valero-Cuevas, Fundamentals of Neuromechanics, 2016,
/// chapter 3).
#[derive(Clone, Debug)]
pub(crate) struct Balance {
    /// The model at the pose.
    pub(crate) tangent: Tangent,
    /// What is there without the pulled strands, for each direction.
    pub(crate) force: Vec<f64>,
    /// What one newton of each pulled strand does, for each direction.
    pub(crate) pull: Vec<Vec<f64>>,
}

impl Balance {
    /// Of a model that lets the pulled strands make no force, at q on its constraints; `None` where a
    /// force is not finite.
    pub(crate) fn at(
        model: &mut Interpreter,
        q: &[f64],
        held: &Held,
        strands: &[usize],
    ) -> Option<Balance> {
        let tangent = Tangent::at(model, q, held)?;
        let n = q.len();
        let mut arms = vec![0.0; held.rest.len() * n];
        model.moment_arms(q, &mut arms);
        if arms.iter().any(|arm| !arm.is_finite()) {
            return None;
        }
        let pull = tangent
            .basis
            .iter()
            .map(|direction| {
                let along = |&s: &usize| -> f64 {
                    (0..n).map(|i| -arms[s * n + i] * direction[i] * tangent.scale[i]).sum()
                };
                strands.iter().map(along).collect()
            })
            .collect();
        Some(Balance { force: tangent.push(), tangent, pull })
    }

    /// What a force at a point does along each direction, per component in world axes; q is the pose.
    pub(crate) fn point(&self, model: &mut Interpreter, q: &[f64], point: &Point) -> Vec<[f64; 3]> {
        let n = q.len();
        let mut jacobian = vec![0.0; 6 * n];
        model.point_jacobian(q, point, &mut jacobian);
        let along = |direction: &Vec<f64>, axis: usize| -> f64 {
            (0..n).map(|i| jacobian[axis * n + i] * direction[i] * self.tangent.scale[i]).sum()
        };
        let directions = self.tangent.basis.iter();
        directions.map(|direction| [0, 1, 2].map(|axis| along(direction, axis))).collect()
    }

    /// The share of every coordinate in forces along the directions (N·m or N).
    pub(crate) fn by_coordinate(&self, along: &[f64]) -> Vec<f64> {
        let n = self.tangent.linear.n;
        let share = |i: usize| -> f64 {
            let basis = self.tangent.basis.iter().zip(along);
            basis.map(|(direction, force)| direction[i] * force).sum::<f64>()
                / self.tangent.scale[i]
        };
        (0..n).map(share).collect()
    }

    /// A motion of every coordinate along the directions (rad or m).
    pub(crate) fn motion(&self, along: &[f64]) -> Vec<f64> {
        let n = self.tangent.linear.n;
        let basis = || self.tangent.basis.iter().zip(along);
        let sum = |i: usize| basis().map(|(direction, x)| direction[i] * x).sum::<f64>();
        (0..n).map(|i| self.tangent.scale[i] * sum(i)).collect()
    }
}
