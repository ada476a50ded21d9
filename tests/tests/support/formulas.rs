//! Closed forms: Jacobi's elliptic functions, oscillators damped and driven.

/// Jacobi's functions of modulus k by the arithmetic-geometric mean (Abramowitz and Stegun 16.4, 17.6).
pub(crate) struct Elliptic {
    k: f64,
    /// a and c/a of the descending means.
    means: Vec<(f64, f64)>,
}

impl Elliptic {
    pub(crate) fn new(k: f64) -> Self {
        let (mut a, mut b) = (1.0f64, ((1.0 - k) * (1.0 + k)).sqrt());
        let mut means = vec![(a, k)];
        while (a - b).abs() > 1e-16 * a && means.len() < 12 {
            let c = 0.5 * (a - b);
            (a, b) = (0.5 * (a + b), (a * b).sqrt());
            means.push((a, c / a));
        }
        Elliptic { k, means }
    }

    /// The quarter period K(k).
    pub(crate) fn quarter(&self) -> f64 {
        0.5 * std::f64::consts::PI / self.means[self.means.len() - 1].0
    }

    /// sn, cn and dn of u.
    pub(crate) fn sn_cn_dn(&self, u: f64) -> (f64, f64, f64) {
        let last = self.means.len() - 1;
        let mut phi = (1u64 << last) as f64 * self.means[last].0 * u;
        for &(_, ratio) in self.means[1..].iter().rev() {
            phi = 0.5 * (phi + (ratio * phi.sin()).asin());
        }
        let (sn, cn) = phi.sin_cos();
        (sn, cn, (1.0 - (self.k * sn).powi(2)).sqrt())
    }
}

/// q and q̇ after n steps of the midpoint rule on q̈ + 2γq̇ + ω²q = 0: its eigenvalues μ become
/// (1 + hμ/2)/(1 − hμ/2) = exp(ρ ± iφ).
pub(crate) fn damped(q: f64, gamma: f64, omega: f64, h: f64, n: usize) -> (f64, f64) {
    let (re, im) = (-gamma, (omega * omega - gamma * gamma).sqrt());
    let (x, y) = (0.5 * h * re, 0.5 * h * im);
    let phase = n as f64 * (y.atan2(1.0 + x) + y.atan2(1.0 - x));
    let growth =
        (n as f64 * 0.5 * (((1.0 + x).powi(2) + y * y) / ((1.0 - x).powi(2) + y * y)).ln()).exp();
    let (s, c) = phase.sin_cos();
    (q * growth * (c - re / im * s), -q * growth * omega * omega / im * s)
}

/// q̈ + 2γq̇ + ω²q = a cos νt from rest at 0.
pub(crate) fn forced(gamma: f64, omega: f64, a: f64, nu: f64, t: f64) -> f64 {
    let (even, odd) = (omega * omega - nu * nu, 2.0 * gamma * nu);
    let size = a / (even * even + odd * odd);
    let (b, c) = (size * even, size * odd);
    let free = (omega * omega - gamma * gamma).sqrt();
    let (s, k) = (free * t).sin_cos();
    b * (nu * t).cos() + c * (nu * t).sin()
        - (-gamma * t).exp() * (b * k + (gamma * b + nu * c) / free * s)
}
