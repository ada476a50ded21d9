//! Small dense linear algebra: LU with scaled partial pivoting, and a rank-revealing least-norm
//! solve for the systems that LU must refuse.
//!
//! Written here because a generated crate has no dependencies; blocks are small (4 unknowns for a
//! finger, 41 for a grasp). Matrices are by rows.

/// How a factorisation went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pivots {
    /// Smallest pivot relative to the largest entry of its row; 0 where a column had none.
    pub smallest: f64,
    /// Largest such ratio.
    pub largest: f64,
}

impl Pivots {
    /// A cheap lower bound of the condition number.
    pub fn condition(&self) -> f64 {
        self.largest / self.smallest
    }
}

/// Factors the n×n matrix in place as P A = L U. `order[i]` is the original row of row i.
/// Returns the range of pivots; the factors are useless if the smallest is zero or not finite.
pub fn lu_factor(a: &mut [f64], n: usize, order: &mut [usize], scale: &mut [f64]) -> Pivots {
    // A size known to the compiler unrolls the loops; a finger's four unknowns cost half as much.
    match n {
        1 => factor(a, 1, order, scale),
        2 => factor(a, 2, order, scale),
        3 => factor(a, 3, order, scale),
        4 => factor(a, 4, order, scale),
        5 => factor(a, 5, order, scale),
        6 => factor(a, 6, order, scale),
        _ => factor(a, n, order, scale),
    }
}

#[inline(always)]
fn factor(a: &mut [f64], n: usize, order: &mut [usize], scale: &mut [f64]) -> Pivots {
    let (a, order, scale) = (&mut a[..n * n], &mut order[..n], &mut scale[..n]);
    let mut pivots = Pivots { smallest: f64::INFINITY, largest: 0.0 };
    for i in 0..n {
        order[i] = i;
        scale[i] = a[i * n..(i + 1) * n].iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    }
    for k in 0..n {
        let mut best = k;
        let mut best_ratio = -1.0;
        for i in k..n {
            let ratio = if scale[i] > 0.0 { a[i * n + k].abs() / scale[i] } else { 0.0 };
            if ratio > best_ratio {
                (best, best_ratio) = (i, ratio);
            }
        }
        // A NaN compares false above and is caught here.
        if !(best_ratio > 0.0) {
            return Pivots { smallest: 0.0, largest: pivots.largest };
        }
        if best != k {
            for j in 0..n {
                a.swap(k * n + j, best * n + j);
            }
            order.swap(k, best);
            scale.swap(k, best);
        }
        pivots.smallest = pivots.smallest.min(best_ratio);
        pivots.largest = pivots.largest.max(best_ratio);
        let reciprocal = 1.0 / a[k * n + k];
        let (upper, lower) = a.split_at_mut((k + 1) * n);
        let pivot_row = &upper[k * n + k + 1..];
        for row in lower.chunks_exact_mut(n) {
            let factor = row[k] * reciprocal;
            row[k] = factor;
            if factor != 0.0 {
                for (x, y) in row[k + 1..].iter_mut().zip(pivot_row) {
                    *x -= factor * y;
                }
            }
        }
    }
    pivots
}

/// Solves with the factors of [`lu_factor`]: `x` holds the right-hand side of the original rows and
/// receives the solution.
pub fn lu_solve(a: &[f64], n: usize, order: &[usize], x: &mut [f64], scratch: &mut [f64]) {
    match n {
        1 => substitute(a, 1, order, x, scratch),
        2 => substitute(a, 2, order, x, scratch),
        3 => substitute(a, 3, order, x, scratch),
        4 => substitute(a, 4, order, x, scratch),
        5 => substitute(a, 5, order, x, scratch),
        6 => substitute(a, 6, order, x, scratch),
        _ => substitute(a, n, order, x, scratch),
    }
}

#[inline(always)]
fn substitute(a: &[f64], n: usize, order: &[usize], x: &mut [f64], scratch: &mut [f64]) {
    let (a, order) = (&a[..n * n], &order[..n]);
    let (x, scratch) = (&mut x[..n], &mut scratch[..n]);
    for i in 0..n {
        let mut sum = x[order[i]];
        for j in 0..i {
            sum -= a[i * n + j] * scratch[j];
        }
        scratch[i] = sum;
    }
    for i in (0..n).rev() {
        let mut sum = scratch[i];
        for j in i + 1..n {
            sum -= a[i * n + j] * x[j];
        }
        x[i] = sum / a[i * n + i];
    }
}

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

/// Solves the m×n system A x = b where it may be rank-deficient: pivoted Gram-Schmidt (twice, so
/// that orthogonality holds to rounding) finds independent columns, and the null space is used to
/// make x as short as possible. Rows are scaled to length one first.
pub fn solve_least_norm(a: &[f64], m: usize, n: usize, b: &[f64]) -> LeastNorm {
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
    let (mut order, mut scale) = (vec![0; rank], vec![0.0; rank]);
    lu_factor(&mut gram, rank, &mut order, &mut scale);
    let mut mu = basic;
    lu_solve(&gram, rank, &order, &mut mu, &mut scale);
    for (k, &column) in chosen.iter().enumerate() {
        x[column] = mu[k];
    }
    for (combination, &column) in combinations.iter().zip(&left) {
        x[column] = dot(combination, &mu);
    }
    left.sort_unstable();
    LeastNorm { x, dependent: left }
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
    fn lu_solves_with_row_exchange() {
        let a = [0.0, 2.0, 1.0, 1.0, 1.0, 0.0, 3.0, 0.0, 1e6];
        let truth = [1.0, -2.0, 3.0];
        let mut x: Vec<f64> =
            (0..3).map(|i| (0..3).map(|j| a[i * 3 + j] * truth[j]).sum()).collect();
        let (mut f, mut order, mut scratch) = (a, [0; 3], [0.0; 3]);
        let pivots = lu_factor(&mut f, 3, &mut order, &mut scratch);
        assert!(pivots.smallest > 0.0);
        lu_solve(&f, 3, &order, &mut x, &mut scratch);
        for i in 0..3 {
            assert!((x[i] - truth[i]).abs() < 1e-14);
        }
    }

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

    #[test]
    fn not_a_number_never_factors() {
        let mut a = [f64::NAN, 1.0, 1.0, f64::NAN];
        assert_eq!(lu_factor(&mut a, 2, &mut [0; 2], &mut [0.0; 2]).smallest, 0.0);
    }
}
