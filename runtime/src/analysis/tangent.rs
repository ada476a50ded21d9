//! What is left of the linearised model on the constraints: directions that may be taken, forces
//! along them, and the stiffness against them.
//!
//! With f the force of all but the constraints and G their Jacobian, rest means f = Gᵀλ. In the
//! directions Z that keep the constraints the force left over is Zᵀ(f − Gᵀλ), and a small motion
//! changes it by −Zᵀ(K + Σλ_r ∂²h_r/∂q²)Z: the tangent stiffness, symmetric where the forces have a
//! potential, and positive definite where the rest is stable (Lagrange and Dirichlet).
//!
//! Angles and lengths are weighed against each other by the model's own length: a coordinate that is
//! a length counts in units of it.

use super::linear::{Held, Linear};
use super::rank::rank;
use crate::interpreter::Interpreter;
use handc_core::layout::CoordinateKind;
use handc_core::linalg::solve_least_norm;
use handc_core::model::Model;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// A part of the largest stiffness below which one counts as none.
const NEUTRAL: f64 = 1e-9;

/// A principal direction of the tangent stiffness.
#[derive(Clone, Debug, PartialEq)]
pub struct Direction {
    /// Stiffness (N·m/rad, or N/m times the model's length squared).
    pub stiffness: f64,
    /// Change of every coordinate (rad or m), of unit length with lengths in units of the model's.
    pub shape: Vec<f64>,
}

/// How a configuration at rest answers a small push.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stability {
    /// It comes back from every one.
    Stable,
    /// There is a direction in which nothing brings it back, or drives it away.
    Neutral,
    /// There is a direction in which it leaves.
    Unstable,
}

/// The model at a configuration at rest, on its constraints.
#[derive(Clone, Debug)]
pub struct Tangent {
    /// Forces and matrices over all coordinates.
    pub linear: Linear,
    /// What counts as one of each coordinate: 1 rad, or the model's length (m).
    pub scale: Vec<f64>,
    /// Force of every constraint row per unit of its Jacobian, length m; of least norm where rows are
    /// redundant.
    pub reaction: Vec<f64>,
    /// Force on every coordinate that nothing balances, f − Gᵀλ (N·m or N), length n; zero on
    /// coordinates that do not move.
    pub residual: Vec<f64>,
    /// Directions that keep the constraints: an orthonormal basis in units of `scale`, n numbers each.
    pub basis: Vec<Vec<f64>>,
    stiffness: DMatrix<f64>,
    /// Stiffness over all coordinates, constraints among what makes it.
    hessian: DMatrix<f64>,
    /// Principal directions of its symmetric part, softest first.
    pub directions: Vec<Direction>,
}

impl Tangent {
    /// Of the interpreter at q; `None` where a number is not finite.
    pub fn at(model: &mut Interpreter, q: &[f64], held: &Held) -> Option<Tangent> {
        let linear = Linear::at(model, q, held);
        let layout = model.layout().clone();
        let (n, m) = (linear.n, layout.rows.len());
        let numbers = linear.force.iter().chain(&linear.stiffness).chain(&linear.constraints);
        if numbers.chain(q).any(|x| !x.is_finite()) {
            return None;
        }
        let scale: Vec<f64> = layout
            .coordinates
            .iter()
            .map(|c| match c.kind {
                CoordinateKind::Angle | CoordinateKind::Ratio => 1.0,
                CoordinateKind::Length => layout.length_scale,
            })
            .collect();
        let scaled =
            |row: usize, column: usize| linear.constraints[row * n + column] * scale[column];
        let free: Vec<usize> = (0..n).filter(|&i| linear.free[i]).collect();
        let reaction = if m == 0 {
            Vec::new()
        } else {
            let mut gram = vec![0.0; m * m];
            let mut rhs = vec![0.0; m];
            for r in 0..m {
                rhs[r] = free.iter().map(|&i| scaled(r, i) * linear.force[i] * scale[i]).sum();
                for s in 0..m {
                    gram[r * m + s] = free.iter().map(|&i| scaled(r, i) * scaled(s, i)).sum();
                }
            }
            solve_least_norm(&gram, m, m, &rhs).x
        };
        let mut residual = vec![0.0; n];
        for &i in &free {
            let held: f64 = (0..m).map(|r| linear.constraints[r * n + i] * reaction[r]).sum();
            residual[i] = linear.force[i] - held;
        }
        let basis = basis(&linear, &scale);
        let mut hessian = DMatrix::from_row_slice(n, n, &linear.stiffness);
        if m > 0 {
            let curvature = model.constraint_curvature(q, held.t, &reaction);
            hessian += DMatrix::from_row_slice(n, n, &curvature);
        }
        let directions = DMatrix::from_fn(n, basis.len(), |i, k| basis[k][i] * scale[i]);
        let stiffness = directions.transpose() * &hessian * &directions;
        let mut tangent = Tangent {
            linear,
            scale,
            reaction,
            residual,
            basis,
            stiffness,
            hessian,
            directions: Vec::new(),
        };
        tangent.find_directions();
        Some(tangent)
    }

    /// Tangent stiffness in the basis.
    pub fn stiffness(&self) -> &DMatrix<f64> {
        &self.stiffness
    }

    /// Adds to a motion of coordinates that are not free what those that are do, so that they stay
    /// balanced; `None` where nothing holds them. The motion keeps the constraints.
    pub fn balanced(&self, motion: &[f64]) -> Option<Vec<f64>> {
        let n = self.linear.n;
        let given = DVector::from_column_slice(motion);
        let directions =
            DMatrix::from_fn(n, self.basis.len(), |i, k| self.basis[k][i] * self.scale[i]);
        let push = directions.tr_mul(&(&self.hessian * given));
        let weights = self.stiffness.clone().lu().solve(&push)?;
        let answer = self.motion(weights.as_slice());
        let sum: Vec<f64> =
            motion.iter().zip(answer).map(|(given, answer)| given - answer).collect();
        sum.iter().all(|x| x.is_finite()).then_some(sum)
    }

    fn find_directions(&mut self) {
        if self.basis.is_empty() {
            return;
        }
        let symmetric = (&self.stiffness + self.stiffness.transpose()) * 0.5;
        let eigen = SymmetricEigen::new(symmetric);
        self.directions = (0..self.basis.len())
            .map(|k| {
                let weights: Vec<f64> = eigen.eigenvectors.column(k).iter().copied().collect();
                Direction { stiffness: eigen.eigenvalues[k], shape: self.motion(&weights) }
            })
            .collect();
        self.directions.sort_by(|a, b| a.stiffness.total_cmp(&b.stiffness));
    }

    /// Change of every coordinate for weights of the basis.
    pub(super) fn motion(&self, weights: &[f64]) -> Vec<f64> {
        let sum = |i: usize| -> f64 {
            self.basis.iter().zip(weights).map(|(direction, w)| direction[i] * w).sum()
        };
        (0..self.linear.n).map(|i| self.scale[i] * sum(i)).collect()
    }

    /// The force left over along each direction of the basis, in units of `scale`.
    pub fn push(&self) -> Vec<f64> {
        let along = |direction: &Vec<f64>| {
            (0..self.linear.n).map(|i| direction[i] * self.scale[i] * self.residual[i]).sum()
        };
        self.basis.iter().map(along).collect()
    }

    /// Largest stiffness, without its sign.
    pub fn stiffest(&self) -> f64 {
        self.directions.iter().fold(0.0, |a: f64, d| a.max(d.stiffness.abs()))
    }

    /// Whether the configuration, if it is at rest, comes back from a small push.
    pub fn stability(&self) -> Stability {
        let limit = NEUTRAL * self.stiffest();
        match self.directions.first() {
            Some(softest) if softest.stiffness < -limit => Stability::Unstable,
            Some(softest) if !(softest.stiffness > limit) => Stability::Neutral,
            _ => Stability::Stable,
        }
    }
}

/// Directions of free coordinates that keep the constraints, orthonormal in units of `scale`.
fn basis(linear: &Linear, scale: &[f64]) -> Vec<Vec<f64>> {
    let n = linear.n;
    let mut rows: Vec<f64> =
        linear.constraints.iter().enumerate().map(|(k, x)| x * scale[k % n]).collect();
    for i in (0..n).filter(|&i| !linear.free[i]) {
        rows.extend((0..n).map(|j| if i == j { 1.0 } else { 0.0 }));
    }
    rank(&rows, rows.len() / n.max(1), n).null_space
}
