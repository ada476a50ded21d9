//! What acts on a coordinate alone: viscous damping, springs and elastic limits.

use super::{At, Mechanics, Terms};
use handc_core::scalar::{Comparison, Scalar};

impl<S: Scalar> Mechanics<'_, S> {
    /// Adds −c·q̇, the spring ½k(q − rest)² and the stops ½k·(excess over a limit)².
    pub(crate) fn add_joints(&self, at: &At<S>, terms: &mut Terms<S>) {
        let step = terms.matrix.as_ref().map(|(h, _)| *h);
        for &(i, coordinate) in &self.numbers.coordinates {
            let (q, v) = (at.q[i], at.v[i]);
            if let Some(c) = coordinate.damping {
                terms.force[i] -= c * v;
                if step.is_some() {
                    terms.add(self.structure, i, i, c.scale(-0.5));
                }
            }
            if let Some((k, rest)) = coordinate.spring {
                terms.force[i] -= k * (q - rest);
                if let Some(h) = step {
                    terms.add(self.structure, i, i, k * h.scale(-0.25));
                }
            }
            if let Some((k, low, high)) = coordinate.stops {
                let zero = S::zero();
                let pick = |then, otherwise_low| {
                    let above = S::select(Comparison::Less, high, q, then, zero);
                    S::select(Comparison::Less, q, low, otherwise_low, above)
                };
                terms.force[i] -= k * pick(q - high, q - low);
                if let Some(h) = step {
                    let inside = pick(S::one(), S::one());
                    terms.add(self.structure, i, i, k * inside * h.scale(-0.25));
                }
            }
        }
    }

    /// Potential of springs and stops.
    pub(crate) fn joint_potential(&self, q: &[S]) -> S {
        let mut energy = S::zero();
        for &(i, coordinate) in &self.numbers.coordinates {
            let q = q[i];
            if let Some((k, rest)) = coordinate.spring {
                energy += (k * (q - rest) * (q - rest)).scale(0.5);
            }
            if let Some((k, low, high)) = coordinate.stops {
                let zero = S::zero();
                let excess = (q - high).max(zero) + (low - q).max(zero);
                energy += (k * excess * excess).scale(0.5);
            }
        }
        energy
    }
}
