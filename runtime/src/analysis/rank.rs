//! Rank of a constraint Jacobian and the rows that depend on others.

use faer::Mat;

/// A singular value below this part of the largest counts as zero.
const TOLERANCE: f64 = 1e-9;

/// Rank of a matrix by rows, and its dependent rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Rank {
    /// Rank.
    pub rank: usize,
    /// Groups of rows whose combination vanishes: row and weight, largest weight one.
    pub dependencies: Vec<Vec<(usize, f64)>>,
    /// An orthonormal basis of the null space, n numbers each.
    pub null_space: Vec<Vec<f64>>,
}

/// Analyses the m×n matrix `g`; rows are scaled to length one first.
pub fn rank(g: &[f64], m: usize, n: usize) -> Rank {
    let scaled = Mat::<f64>::from_fn(m, n, |i, j| {
        let norm = g[i * n..(i + 1) * n].iter().map(|x| x * x).sum::<f64>().sqrt();
        if norm > 0.0 { g[i * n + j] / norm } else { 0.0 }
    });
    let unit = |i: usize, n: usize| (0..n).map(|j| if i == j { 1.0 } else { 0.0 }).collect();
    let decomposition = if m == 0 || n == 0 { None } else { scaled.svd().ok() };
    let Some(svd) = decomposition else {
        return Rank {
            rank: 0,
            dependencies: (0..m).map(|row| vec![(row, 1.0)]).collect(),
            null_space: (0..n).map(|i| unit(i, n)).collect(),
        };
    };
    let values = svd.S().column_vector();
    let largest = (0..values.nrows()).map(|i| values[i]).fold(0.0, f64::max);
    let rank = (0..values.nrows()).filter(|&i| values[i] > TOLERANCE * largest.max(1e-300)).count();
    let dependencies = (rank..m)
        .map(|k| {
            let weights: Vec<f64> = (0..m).map(|i| svd.U()[(i, k)]).collect();
            let most = weights.iter().fold(0.0, |a: f64, w| a.max(w.abs()));
            weights
                .iter()
                .enumerate()
                .filter(|(_, w)| w.abs() > 1e-6 * most)
                .map(|(i, w)| (i, w / most))
                .collect()
        })
        .collect();
    let null_space = (rank..n).map(|k| (0..n).map(|j| svd.V()[(j, k)]).collect()).collect();
    Rank { rank, dependencies, null_space }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_repeated_row_is_found_with_its_twin() {
        let found = rank(&[1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 3.0, 0.0, 0.0], 3, 3);
        assert_eq!(found.rank, 2);
        assert_eq!(found.null_space.len(), 1);
        let rows: Vec<usize> = found.dependencies[0].iter().map(|d| d.0).collect();
        assert_eq!(rows, [0, 2]);
        assert!((found.null_space[0][2].abs() - 1.0).abs() < 1e-14);
    }
}
