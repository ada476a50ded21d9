//! The fastest natural frequency at a configuration, for hints and warnings.

use crate::linalg::Lu;
use crate::model::{Midpoint, Model};
use crate::step::Surroundings;

/// Largest ω = √(K/M) (rad/s) over the blocks by power iteration on M⁻¹K, constraints left aside;
/// `None` where no block has both a regular mass matrix and stiffness.
pub fn fastest<M: Model>(model: &mut M, q: &[f64], around: &Surroundings) -> Option<f64> {
    let layout = model.layout().clone();
    let n = layout.coordinates.len();
    let mut mass = vec![0.0; layout.matrix_size()];
    let mut newton = vec![0.0; layout.matrix_size()];
    model.mass_matrix(q, &mut mass);
    let (mut momentum, mut force, zero) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let at = Midpoint { q, v: &zero, t: around.t1, rest: around.rest, inputs: around.inputs };
    let h = around.h;
    model.evaluate_with_matrix(&at, h, &mut momentum, &mut force, &mut newton);
    let mut best: Option<f64> = None;
    for block in &layout.blocks {
        let size = block.coordinates.len();
        let range = block.matrix_offset..block.matrix_offset + size * size;
        // At rest the matrix is −M/h − (h/4)K.
        let stiffness: Vec<f64> = newton[range.clone()]
            .iter()
            .zip(&mass[range.clone()])
            .map(|(j, m)| -(j + m / h) * 4.0 / h)
            .collect();
        let mut factors = Lu::new(size);
        for (i, row) in mass[range].chunks_exact(size).enumerate() {
            factors.row_mut(i).copy_from_slice(row);
        }
        if !(factors.factor().smallest > 1e-12) {
            continue;
        }
        let mut x: Vec<f64> = (0..size).map(|i| 1.0 + 0.1 * i as f64).collect();
        let mut value = 0.0;
        for _ in 0..60 {
            let mut y: Vec<f64> = (0..size)
                .map(|i| (0..size).map(|k| stiffness[i * size + k] * x[k]).sum())
                .collect();
            factors.solve(&mut y);
            let norm = y.iter().map(|v| v * v).sum::<f64>().sqrt();
            let length = x.iter().map(|v| v * v).sum::<f64>().sqrt();
            if !(norm > 0.0) {
                break;
            }
            value = norm / length;
            x = y.iter().map(|v| v / norm).collect();
        }
        if value > 0.0 {
            let omega = value.sqrt();
            best = Some(best.map_or(omega, |b: f64| b.max(omega)));
        }
    }
    best
}
