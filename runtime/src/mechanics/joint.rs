//! What acts on a coordinate alone: viscous damping, springs and elastic limits.

use super::ramp::{Ramp, ramp};
use super::{At, Mechanics, Terms};
use crate::resolved::Stops;
use handc_core::scalar::{Comparison, Scalar};

impl<S: Scalar> Mechanics<'_, S> {
    /// Adds −c·q̇, the spring ½k(q − rest)² and the stops ½k·ρ(excess over a limit)², where ρ is
    /// the excess itself or, over a width, begins smoothly.
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
            if let Some(stops) = &coordinate.stops {
                let [below, above] = excess(stops, q);
                let k = stops.stiffness;
                terms.force[i] -= k * (above.value * above.slope - below.value * below.slope);
                if let Some(h) = step {
                    let bend =
                        |side: Ramp<S>| side.slope * side.slope + side.value * side.curvature;
                    let slope = k * (bend(below) + bend(above));
                    terms.add(self.structure, i, i, slope * h.scale(-0.25));
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
            if let Some(stops) = &coordinate.stops {
                let [below, above] = excess(stops, q).map(|side| side.value);
                energy += (stops.stiffness * (below * below + above * above)).scale(0.5);
            }
        }
        energy
    }
}

/// How far a coordinate is below its lower limit and above its upper one.
fn excess<S: Scalar>(stops: &Stops<S>, q: S) -> [Ramp<S>; 2] {
    [stops.low - q, q - stops.high].map(|excess| match stops.width {
        Some(width) => ramp(excess, width),
        None => {
            let (zero, one) = (S::zero(), S::one());
            Ramp {
                value: excess.max(zero),
                slope: S::select(Comparison::Less, zero, excess, one, zero),
                curvature: zero,
            }
        }
    })
}
