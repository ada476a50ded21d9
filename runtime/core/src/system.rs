//! Linear systems of constrained blocks as straight-line code: the order of elimination is chosen when
//! the model is compiled.
//!
//! Which entries there are is known then, and so is an order that makes few new ones: a finger and the
//! rows that its tip carries are eliminated before the ball. There is no exchange of rows; where a
//! pivot comes out small the system is solved by other means.

/// Function from J, G₁ and sizes of coordinates to sums by coordinates and by rows.
pub type Sensitivities =
    fn(matrix: &[f64], after: &[f64], size: &[f64], to: &mut [f64], to_rows: &mut [f64]);

/// Function from J, G₀ and G₁ to factors and the shrinkage of pivots.
pub type Factor = fn(matrix: &[f64], before: &[f64], after: &[f64], factors: &mut [f64]) -> f64;

/// Function from factors, r and c to δ and μ.
pub type Solve =
    fn(factors: &[f64], residual: &[f64], gaps: &[f64], step: &mut [f64], change: &mut [f64]);

/// The system of one block,
///
/// ```text
/// [ J  −G₀ᵀ ] [ δ ]   [ −r ]
/// [ G₁   0  ] [ μ ] = [ −c ]
/// ```
///
/// All vectors are those of the model, indexed by coordinate or row; matrices are packed by block. Only
/// entries of the block are read or written.
#[derive(Clone, Copy, Debug)]
pub struct System {
    /// Which block.
    pub block: usize,
    /// How many numbers its factors are.
    pub factors: usize,
    /// Σ|Jᵢⱼ|·size(j) for every coordinate, and Σ|G₁|·size for every row; of J, G₁ and sizes.
    pub sensitivities: Sensitivities,
    /// G₀ᵀλ for every coordinate.
    pub pull: fn(before: &[f64], lambda: &[f64], pull: &mut [f64]),
    /// The same with all terms positive.
    pub pull_sizes: fn(before: &[f64], lambda: &[f64], sizes: &mut [f64]),
    /// Factors J, G₀ and G₁. Returns by how much the smallest pivot has shrunk while others were
    /// eliminated; not a number or infinite where one has vanished.
    pub factor: Factor,
    /// Solves for δ and μ, from factors, r and c.
    pub solve: Solve,
}
