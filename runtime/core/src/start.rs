//! The start of a run: a configuration on the constraints, momenta, and kinetic energy.

use crate::layout::Layout;
use crate::linalg::solve_least_norm;
use crate::model::Model;

/// The least change (Euclidean, over the free coordinates) that puts `q` on the constraints.
///
/// Iterates q ← q* − Gᵀμ with G Gᵀμ = h(q) + G(q* − q), the Gauss-Newton form of: least ½|q − q*|²
/// subject to h(q) = 0. Returns the largest change of a coordinate, or, where no such q is found, the
/// name of the row that is worst at the start and its gap there: where the search ends is chance.
/// `rest` are the lengths that are prescribed at time zero.
pub fn project<M: Model>(
    model: &mut M,
    q: &mut [f64],
    rest: &[f64],
    driven: &[bool],
) -> Result<f64, (String, f64)> {
    let layout = model.layout().clone();
    let target = q.to_vec();
    let m = layout.rows.len();
    if m == 0 {
        return Ok(0.0);
    }
    let mut gap = vec![0.0; m];
    let mut jacobian = vec![0.0; layout.constraint_size()];
    model.constraints(q, 0.0, rest, &mut gap);
    let found = worst(&layout, &gap);
    let mut previous = f64::INFINITY;
    for _ in 0..200 {
        model.constraints(q, 0.0, rest, &mut gap);
        model.constraint_jacobian(q, 0.0, &mut jacobian);
        let mut change: f64 = 0.0;
        for block in &layout.blocks {
            let free = block.free(driven);
            let rows = block.rows.len();
            let width = block.coordinates.len();
            let entry =
                |r: usize, local: usize| jacobian[block.constraint_offset + r * width + local];
            let mut gram = vec![0.0; rows * rows];
            let mut rhs = vec![0.0; rows];
            for r in 0..rows {
                rhs[r] = gap[block.rows[r]]
                    + free.iter().map(|&(l, c)| entry(r, l) * (target[c] - q[c])).sum::<f64>();
                for s in 0..rows {
                    gram[r * rows + s] = free.iter().map(|&(l, _)| entry(r, l) * entry(s, l)).sum();
                }
            }
            if gram.iter().chain(&rhs).any(|x| !x.is_finite()) {
                return Err(found);
            }
            let mu = solve_least_norm(&gram, rows, rows, &rhs).x;
            for &(local, c) in &free {
                let pull: f64 = (0..rows).map(|r| entry(r, local) * mu[r]).sum();
                let next = target[c] - pull;
                change = change.max((next - q[c]).abs());
                q[c] = next;
            }
        }
        if change <= 1e-15 || (change < 1e-11 && change >= previous) {
            break;
        }
        previous = change;
    }
    model.constraints(q, 0.0, rest, &mut gap);
    let largest = gap.iter().fold(0.0, |a: f64, x| if x.abs() <= a { a } else { x.abs() });
    if !(largest <= 1e-10 * layout.length_scale.max(1e-3)) {
        return Err(found);
    }
    let moved = q.iter().zip(&target).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    // A start that misses by rounding alone is the start.
    if moved < 1e-15 {
        q.copy_from_slice(&target);
    }
    Ok(moved)
}

fn worst(layout: &Layout, gap: &[f64]) -> (String, f64) {
    let mut found = (String::new(), 0.0);
    for (row, &value) in layout.rows.iter().zip(gap) {
        if !(value.abs() <= f64::abs(found.1)) || found.0.is_empty() {
            found = (row.name.clone(), value);
        }
    }
    found
}

/// p = M(q)·v over the free coordinates.
pub fn momentum<M: Model>(model: &mut M, q: &[f64], v: &[f64], driven: &[bool]) -> Vec<f64> {
    let layout = model.layout().clone();
    let mut p = vec![0.0; q.len()];
    if v.iter().all(|&v| v == 0.0) {
        return p;
    }
    let mut mass = vec![0.0; layout.matrix_size()];
    model.mass_matrix(q, &mut mass);
    for block in &layout.blocks {
        let width = block.coordinates.len();
        for (i, &row) in block.coordinates.iter().enumerate().filter(|(_, c)| !driven[**c]) {
            for (k, &column) in block.coordinates.iter().enumerate() {
                if !driven[column] {
                    p[row] += mass[block.matrix_offset + i * width + k] * v[column];
                }
            }
        }
    }
    p
}

/// Scratch of the kinetic energy.
#[derive(Clone, Debug, Default)]
pub struct Kinetic {
    mass: Vec<f64>,
    jacobian: Vec<f64>,
}

impl Kinetic {
    /// Kinetic energy (J) of the momenta p, projected onto the constraints' tangent space:
    /// ½pᵀv with M v + Gᵀμ = p and G v = 0, over the free coordinates.
    pub fn energy<M: Model>(
        &mut self,
        model: &mut M,
        q: &[f64],
        t: f64,
        p: &[f64],
        driven: &[bool],
    ) -> f64 {
        let layout = model.layout().clone();
        self.mass.resize(layout.matrix_size(), 0.0);
        self.jacobian.resize(layout.constraint_size(), 0.0);
        model.mass_matrix(q, &mut self.mass);
        if !layout.rows.is_empty() {
            model.constraint_jacobian(q, t, &mut self.jacobian);
        }
        let mut energy = 0.0;
        for block in &layout.blocks {
            let free = block.free(driven);
            if free.iter().all(|&(_, c)| p[c] == 0.0) {
                continue;
            }
            let (width, n, m) = (block.coordinates.len(), free.len(), block.rows.len());
            let size = n + m;
            let mut whole = vec![0.0; size * size];
            let mut rhs = vec![0.0; size];
            for (i, &(local, c)) in free.iter().enumerate() {
                rhs[i] = p[c];
                for (k, &(other, _)) in free.iter().enumerate() {
                    whole[i * size + k] = self.mass[block.matrix_offset + local * width + other];
                }
                for row in 0..m {
                    let g = self.jacobian[block.constraint_offset + row * width + local];
                    whole[i * size + n + row] = g;
                    whole[(n + row) * size + i] = g;
                }
            }
            let solution = solve_least_norm(&whole, size, size, &rhs).x;
            energy += free.iter().zip(&solution).map(|(&(_, c), v)| 0.5 * p[c] * v).sum::<f64>();
        }
        energy
    }
}
