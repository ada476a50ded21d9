//! The least-norm solution of a system that may be rank-deficient.

use super::Lu;

/// Result of [`solve_least_norm`].
#[derive(Clone, Debug, PartialEq)]
pub struct LeastNorm {
    /// The solution of least Euclidean norm among those that fit best.
    pub x: Vec<f64>,
    /// Columns that depend on the others.
    pub dependent: Vec<usize>,
}

/// A column whose part outside the span of the others is smaller than this, relative to its length,
/// depends on them.
pub const RANK_TOLERANCE: f64 = 1e-9;

/// A square system whose pivots differ by less than this has full rank.
const FULL_RANK: f64 = 1e6;

/// Solves the m×n system A x = b where it may be rank-deficient: pivoted Gram-Schmidt (twice, so
/// that orthogonality holds to rounding) finds independent columns, and the null space is used to
/// make x as short as possible. Rows are scaled to length one first. A square system far from
/// singular is solved by its LU factors.
pub fn solve_least_norm(a: &[f64], m: usize, n: usize, b: &[f64]) -> LeastNorm {
    if m == n
        && let Some(x) = solve_regular(a, n, b)
    {
        return LeastNorm { x, dependent: Vec::new() };
    }
    let mut columns: Vec<Vec<f64>> = vec![vec![0.0; m]; n];
    let mut rhs = vec![0.0; m];
    for i in 0..m {
        let row = &a[i * n..(i + 1) * n];
        let norm = row.iter().map(|x| x * x).sum::<f64>().sqrt();
        if norm > 0.0 {
            for j in 0..n {
                columns[j][i] = row[j] / norm;
            }
            rhs[i] = b[i] / norm;
        }
    }
    let original: Vec<f64> = columns.iter().map(|c| dot(c, c).sqrt()).collect();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let mut chosen: Vec<usize> = Vec::new();
    // Coordinates of every column in the basis.
    let mut triangle: Vec<Vec<f64>> = vec![Vec::new(); n];
    let mut left: Vec<usize> = (0..n).collect();
    while !left.is_empty() && basis.len() < m {
        let relative = |&j: &usize| {
            if original[j] > 0.0 { dot(&columns[j], &columns[j]).sqrt() / original[j] } else { 0.0 }
        };
        let (at, ratio) = left
            .iter()
            .map(relative)
            .enumerate()
            .fold((0, -1.0), |best, (i, r)| if r > best.1 { (i, r) } else { best });
        if !(ratio > RANK_TOLERANCE) {
            break;
        }
        let pivot = left.remove(at);
        let mut direction = columns[pivot].clone();
        for (k, known) in basis.iter().enumerate() {
            let part = dot(known, &direction);
            triangle[pivot][k] += part;
            axpy(-part, known, &mut direction);
        }
        let norm = dot(&direction, &direction).sqrt();
        direction.iter_mut().for_each(|x| *x /= norm);
        triangle[pivot].push(norm);
        for &j in &left {
            let part = dot(&direction, &columns[j]);
            triangle[j].push(part);
            axpy(-part, &direction, &mut columns[j]);
        }
        chosen.push(pivot);
        basis.push(direction);
    }
    let rank = basis.len();
    let back_substitute = |mut y: Vec<f64>| {
        for k in (0..rank).rev() {
            y[k] /= triangle[chosen[k]][k];
            for i in 0..k {
                y[i] -= triangle[chosen[k]][i] * y[k];
            }
        }
        y
    };
    let basic = back_substitute(basis.iter().map(|direction| dot(direction, &rhs)).collect());
    let combinations: Vec<Vec<f64>> =
        left.iter().map(|&j| back_substitute(triangle[j].clone())).collect();
    let mut x = vec![0.0; n];
    if left.is_empty() {
        for (k, &column) in chosen.iter().enumerate() {
            x[column] = basic[k];
        }
        return LeastNorm { x, dependent: left };
    }
    // Shortest x with x_chosen + C x_left = basic: x = Wᵀ(W Wᵀ)⁻¹ basic with W = [E, C].
    let mut gram = vec![0.0; rank * rank];
    for i in 0..rank {
        gram[i * rank + i] = 1.0;
        for j in 0..rank {
            gram[i * rank + j] += combinations.iter().map(|c| c[i] * c[j]).sum::<f64>();
        }
    }
    let mut lu = Lu::new(rank);
    for i in 0..rank {
        lu.row_mut(i).copy_from_slice(&gram[i * rank..(i + 1) * rank]);
    }
    lu.factor();
    let mut mu = basic;
    lu.solve(&mut mu);
    for (k, &column) in chosen.iter().enumerate() {
        x[column] = mu[k];
    }
    for (combination, &column) in combinations.iter().zip(&left) {
        x[column] = dot(combination, &mu);
    }
    left.sort_unstable();
    LeastNorm { x, dependent: left }
}

/// Solves an n×n system if it is far from singular.
fn solve_regular(a: &[f64], n: usize, b: &[f64]) -> Option<Vec<f64>> {
    let mut lu = Lu::new(n);
    (0..n).for_each(|i| lu.row_mut(i).copy_from_slice(&a[i * n..(i + 1) * n]));
    let condition = lu.factor().condition();
    (condition < FULL_RANK).then(|| {
        let mut x = b.to_vec();
        lu.solve(&mut x);
        x
    })
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn axpy(factor: f64, x: &[f64], y: &mut [f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += factor * x;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn least_norm_shares_between_equal_columns() {
        let solution = solve_least_norm(
            &[1.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 2.0],
            3,
            3,
            &[4.0, 4.0, 6.0],
        );
        assert_eq!(solution.dependent.len(), 1);
        for (x, expected) in solution.x.iter().zip([2.0, 2.0, 3.0]) {
            assert!((x - expected).abs() < 1e-14);
        }
    }
}
