//! Linear and quadratic programs with bounds, by the interior-point method of Clarabel (Goulart and
//! Chen, Clarabel: An interior-point solver for conic programs with quadratic objectives, 2024).
//!
//! An interior-point method ends near a solution, never on it. Which bounds hold there is known,
//! though, from their multipliers; with those fixed the solution follows from linear equations, to
//! rounding.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, ZeroConeT,
};
use handc_core::linalg::solve_least_norm;

/// A bound or an equation holds within this part of the numbers in it.
const TOLERANCE: f64 = 1e-9;

/// Least ½Σwᵢxᵢ² + c·x where E x = e and low ≤ x ≤ high.
#[derive(Clone, Debug, Default)]
pub struct Program {
    /// w, one for each unknown; none is negative.
    pub weights: Vec<f64>,
    /// c, one for each unknown.
    pub cost: Vec<f64>,
    /// Rows of E.
    pub equations: Vec<Vec<f64>>,
    /// e.
    pub right: Vec<f64>,
    /// Lower bounds; −∞ for none.
    pub low: Vec<f64>,
    /// Upper bounds; ∞ for none.
    pub high: Vec<f64>,
}

/// A solution.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// The unknowns.
    pub x: Vec<f64>,
    /// Which are at their lower bound because they must be.
    pub at_low: Vec<bool>,
    /// Which are at their upper bound because they must be.
    pub at_high: Vec<bool>,
}

/// What becomes of a program.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// It has a solution.
    Solved(Solution),
    /// Nothing within the bounds solves the equations.
    Infeasible,
    /// There is no least value.
    Unbounded,
    /// The method did not come to an end; why, in its own words.
    Failed(String),
}

impl Program {
    /// An unknown with its weight, cost and bounds, which no equation holds yet.
    pub fn unknown(&mut self, weight: f64, cost: f64, [low, high]: [f64; 2]) -> usize {
        self.weights.push(weight);
        self.cost.push(cost);
        self.low.push(low);
        self.high.push(high);
        self.weights.len() - 1
    }

    /// Solves it.
    pub fn solve(&self) -> Outcome {
        let count = self.weights.len();
        if (0..count).any(|i| !(self.low[i] <= self.high[i])) {
            return Outcome::Infeasible;
        }
        if count == 0 {
            let none = Solution { x: Vec::new(), at_low: Vec::new(), at_high: Vec::new() };
            let is_met = self.right.iter().all(|e| *e == 0.0);
            return if is_met { Outcome::Solved(none) } else { Outcome::Infeasible };
        }
        // Rows of length one, and unknowns in units of the largest number that is given for them.
        let norms: Vec<f64> = self.equations.iter().map(|row| norm(row)).collect();
        let right: Vec<f64> = self.right.iter().zip(&norms).map(|(e, n)| e / n).collect();
        if norms.iter().zip(&self.right).any(|(n, e)| *n == 0.0 && *e != 0.0) {
            return Outcome::Infeasible;
        }
        let sizes = right.iter().chain(&self.low).chain(&self.high);
        let unit = sizes.filter(|x| x.is_finite()).fold(0.0, |a: f64, x| a.max(x.abs()));
        let unit = if unit > 0.0 { unit } else { 1.0 };
        let mut rows: Vec<(Vec<f64>, f64)> = self
            .equations
            .iter()
            .zip(norms.iter().zip(&right))
            .filter(|(_, (norm, _))| **norm > 0.0)
            .map(|(row, (norm, right))| {
                (row.iter().map(|a| a / norm).collect::<Vec<f64>>(), right / unit)
            })
            .collect();
        // Bounds that leave no room are equations.
        for i in (0..count).filter(|&i| self.low[i] == self.high[i]) {
            let mut row = vec![0.0; count];
            row[i] = 1.0;
            rows.push((row, self.low[i] / unit));
        }
        let bounds: Vec<(usize, f64, f64)> = (0..count)
            .filter(|&i| self.low[i] < self.high[i])
            .flat_map(|i| [(i, -1.0, -self.low[i] / unit), (i, 1.0, self.high[i] / unit)])
            .filter(|(_, _, bound)| bound.is_finite())
            .collect();
        let cost: Vec<f64> = self.cost.iter().map(|c| c / unit).collect();
        let size = self.weights.iter().chain(&cost).fold(0.0, |a: f64, x| a.max(x.abs()));
        let size = if size > 0.0 { size } else { 1.0 };
        let cost: Vec<f64> = cost.iter().map(|c| c / size).collect();
        let weights: Vec<f64> = self.weights.iter().map(|w| w / size).collect();
        let mut solver = match solver(&weights, &rows, &bounds, &cost) {
            Ok(solver) => solver,
            Err(message) => return Outcome::Failed(message),
        };
        solver.solve();
        let solution = &solver.solution;
        match solution.status {
            SolverStatus::Solved
            | SolverStatus::AlmostSolved
            | SolverStatus::InsufficientProgress => {}
            SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => {
                return Outcome::Infeasible;
            }
            SolverStatus::DualInfeasible | SolverStatus::AlmostDualInfeasible => {
                return Outcome::Unbounded;
            }
            other => return Outcome::Failed(format!("{other}")),
        }
        let mut found = Solution {
            x: solution.x.clone(),
            at_low: vec![false; count],
            at_high: vec![false; count],
        };
        let pairs = solution.s[rows.len()..].iter().zip(&solution.z[rows.len()..]);
        for ((i, sign, bound), (slack, multiplier)) in bounds.iter().zip(pairs) {
            if multiplier > slack {
                let side = if *sign > 0.0 { &mut found.at_high } else { &mut found.at_low };
                side[*i] = true;
                found.x[*i] = bound / sign;
            }
        }
        finish(&mut found, &weights, &rows, &cost);
        let misses = |(row, right): &(Vec<f64>, f64)| (dot(row, &found.x) - right).abs();
        let worst = rows.iter().map(misses).fold(0.0, f64::max);
        if !(worst <= TOLERANCE) {
            // Too near to the edge of what is possible to be told from beyond it.
            return Outcome::Infeasible;
        }
        found.x.iter_mut().for_each(|x| *x *= unit);
        for i in 0..count {
            found.x[i] = found.x[i].clamp(self.low[i], self.high[i]);
        }
        Outcome::Solved(found)
    }
}

fn solver(
    weights: &[f64],
    rows: &[(Vec<f64>, f64)],
    bounds: &[(usize, f64, f64)],
    cost: &[f64],
) -> Result<DefaultSolver<f64>, String> {
    let count = weights.len();
    let height = rows.len() + bounds.len();
    let (mut i, mut j, mut v) = (Vec::new(), Vec::new(), Vec::new());
    for (r, (row, _)) in rows.iter().enumerate() {
        for (c, a) in row.iter().enumerate().filter(|(_, a)| **a != 0.0) {
            i.push(r);
            j.push(c);
            v.push(*a);
        }
    }
    for (r, (c, sign, _)) in bounds.iter().enumerate() {
        i.push(rows.len() + r);
        j.push(*c);
        v.push(*sign);
    }
    let matrix = CscMatrix::new_from_triplets(height, count, i, j, v);
    let on: Vec<usize> = (0..count).collect();
    let hessian = CscMatrix::new_from_triplets(count, count, on.clone(), on, weights.to_vec());
    let right: Vec<f64> = rows.iter().map(|r| r.1).chain(bounds.iter().map(|b| b.2)).collect();
    let cones = [ZeroConeT(rows.len()), NonnegativeConeT(bounds.len())];
    let settings = DefaultSettings {
        verbose: false,
        tol_gap_abs: 1e-12,
        tol_gap_rel: 1e-12,
        tol_feas: 1e-12,
        presolve_enable: false,
        ..DefaultSettings::default()
    };
    DefaultSolver::new(&hessian, cost, &matrix, &right, &cones, settings)
        .map_err(|error| error.to_string())
}

/// From near a solution onto it: unknowns that no bound holds, from the equations and from the
/// slope of what is made least. Kept as it was where that leaves the bounds.
fn finish(found: &mut Solution, weights: &[f64], rows: &[(Vec<f64>, f64)], cost: &[f64]) {
    let count = weights.len();
    let free: Vec<usize> = (0..count).filter(|&i| !found.at_low[i] && !found.at_high[i]).collect();
    let (n, m) = (free.len(), rows.len());
    let size = n + m;
    if n == 0 {
        return;
    }
    let mut whole = vec![0.0; size * size];
    let mut right = vec![0.0; size];
    for (k, &i) in free.iter().enumerate() {
        whole[k * size + k] = weights[i];
        right[k] = -weights[i] * found.x[i] - cost[i];
        for (r, (row, _)) in rows.iter().enumerate() {
            whole[k * size + n + r] = row[i];
            whole[(n + r) * size + k] = row[i];
        }
    }
    for (r, (row, value)) in rows.iter().enumerate() {
        right[n + r] = value - dot(row, &found.x);
    }
    let change = solve_least_norm(&whole, size, size, &right).x;
    let mut moved = found.x.clone();
    free.iter().zip(&change).for_each(|(&i, change)| moved[i] += change);
    let scale = moved.iter().fold(1.0, |a: f64, x| a.max(x.abs()));
    let near = change[..n].iter().all(|change| change.abs() <= 1e-4 * scale);
    if near {
        found.x = moved;
    }
}

fn norm(row: &[f64]) -> f64 {
    dot(row, row).sqrt()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

    fn solved(program: &Program) -> Solution {
        match program.solve() {
            Outcome::Solved(solution) => solution,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn the_shortest_sum_of_pulls() {
        // x + 2 y = 5 with the least x² + y²: (1, 2); with y ≤ 1.5: (2, 1.5).
        let mut program = Program::default();
        program.unknown(1.0, 0.0, [0.0, f64::INFINITY]);
        program.unknown(1.0, 0.0, [0.0, f64::INFINITY]);
        program.equations = vec![vec![1.0, 2.0]];
        program.right = vec![5.0];
        let solution = solved(&program);
        assert!((solution.x[0] - 1.0).abs() < 1e-14 && (solution.x[1] - 2.0).abs() < 1e-14);
        program.high[1] = 1.5;
        let solution = solved(&program);
        assert_eq!(solution.x[1], 1.5);
        assert!((solution.x[0] - 2.0).abs() < 1e-14 && solution.at_high[1]);
    }

    #[test]
    fn the_corner_of_a_linear_program() {
        // Most 3 x + 2 y where x + y = 4, x ≤ 2.5.
        let mut program = Program::default();
        program.unknown(0.0, -3.0, [0.0, 2.5]);
        program.unknown(0.0, -2.0, [0.0, f64::INFINITY]);
        program.equations = vec![vec![1.0, 1.0]];
        program.right = vec![4.0];
        let solution = solved(&program);
        assert!((solution.x[0] - 2.5).abs() < 1e-14 && (solution.x[1] - 1.5).abs() < 1e-14);
        assert_eq!((solution.at_high[0], solution.at_high[1]), (true, false));
    }

    #[test]
    fn what_cannot_be_is_told() {
        let mut program = Program::default();
        program.unknown(1.0, 0.0, [0.0, 1.0]);
        program.equations = vec![vec![1e-3]];
        program.right = vec![2e-3];
        assert_eq!(program.solve(), Outcome::Infeasible);
        program.right = vec![-1e-6];
        assert_eq!(program.solve(), Outcome::Infeasible);
        let mut program = Program::default();
        program.unknown(0.0, 1.0, ANY);
        program.unknown(0.0, 0.0, ANY);
        program.equations = vec![vec![1.0, 1.0]];
        program.right = vec![0.0];
        assert_eq!(program.solve(), Outcome::Unbounded);
        let nothing = Program { equations: vec![vec![]], right: vec![1.0], ..Program::default() };
        assert_eq!(nothing.solve(), Outcome::Infeasible);
        let nothing = Program { right: vec![0.0], ..nothing };
        assert!(matches!(nothing.solve(), Outcome::Solved(_)));
    }

    #[test]
    fn sizes_do_not_matter() {
        for unit in [1e-9, 1.0, 1e9] {
            let mut program = Program::default();
            program.unknown(0.0, -1.0, [0.0, 30.0 * unit]);
            program.unknown(0.0, 0.0, [0.0, 20.0 * unit]);
            program.equations = vec![vec![0.01, -0.02]];
            program.right = vec![0.0];
            let solution = solved(&program);
            assert!((solution.x[0] / unit - 30.0).abs() < 1e-12, "{solution:?}");
            assert!((solution.x[1] / unit - 15.0).abs() < 1e-12, "{solution:?}");
        }
    }
}
