//! Muscles: the model of Hill with an elastic tendon, after Thelen (2003).
//!
//! Fibres and tendon lie in a row. The fibres stand at an angle α to the tendon and keep their
//! distance from it, w = l₀ sin α₀, while they change their length l. The coordinate is their length
//! along the tendon, s = l cos α, which is smooth at any angle; the tendon takes what is left of the
//! strand's length x. With F₀ the largest isometric force and λ = l/l₀ the balance is
//!
//! f_T((x − s − l_T)/(l_T ε₀)) = cos α·(a f_L(λ) f_V(λ̇/(v₀(1/4 + 3a/4))) + f_P(λ) + β λ̇/v₀)
//!
//! with the activation a, whose own equation is ȧ = (u − a)/τ(u, a). [`curves`] has the curves.

mod blend;
pub mod curves;
#[cfg(test)]
mod tests;

use crate::mechanism::{Muscle, Number};
use crate::resolved::Resolved;
use blend::step;
use curves::Curve;
use handc_core::scalar::Scalar;

/// Width of the excitation less the activation over which one time constant turns into the other.
const SWITCH: f64 = 0.1;

/// A muscle with its numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResolvedMuscle<S> {
    /// Largest isometric force F₀ (N).
    pub max_force: S,
    /// Optimal fibre length l₀ (m).
    pub optimal_fibre: S,
    /// 1/l₀.
    per_optimal: S,
    /// (w/l₀)² = sin²α₀; `None` for fibres along the tendon.
    thickness: Option<S>,
    /// Slack length l_T of the tendon (m).
    tendon_slack: S,
    /// Its stretch at the largest force, l_T ε₀ (m), and 1 over it.
    tendon_stretch: [S; 2],
    /// 1 over the largest velocity v₀ in optimal lengths (s).
    per_velocity: S,
    /// Strain of the passive fibres at the largest force, and 1 over it.
    passive_strain: [S; 2],
    /// Largest force of lengthening fibres, in parts of the isometric one.
    eccentric: S,
    /// Damping β of the fibres, if any.
    damping: Option<S>,
    /// 1 over the time constants of activation and deactivation (1/s).
    per_time: [S; 2],
    /// F₀ l₀ times the time constant of activation (J·s): makes the equation of the activation one of
    /// works, so that it stands beside those of lengths.
    action: S,
}

/// What the fibres do: their force along the tendon and its derivatives.
#[derive(Clone, Copy, Debug)]
pub struct Fibres<S> {
    /// F₀(a f_L f_V + f_P + β λ̇/v₀) cos α (N).
    pub force: S,
    /// By s (N/m), by ṡ (N·s/m) and by a (N).
    pub by: [S; 3],
    /// Length l (m).
    pub length: S,
    /// Force along the fibres themselves (N).
    pub pull: S,
    /// Power that the active fibres give, −F₀ a f_L f_V·l̇ (W).
    pub power: S,
    /// Power that the damping takes (W).
    pub dissipation: S,
}

impl<S: Scalar> ResolvedMuscle<S> {
    /// With the numbers of `resolved`.
    pub(crate) fn new(resolved: &Resolved<S>, muscle: &Muscle) -> Self {
        let some = |n: Number| (!n.is_zero()).then(|| resolved.number(n));
        let number = |n: Number| resolved.number(n);
        let stretch = number(muscle.tendon_slack) * number(muscle.tendon_strain);
        let passive = number(muscle.passive_strain);
        ResolvedMuscle {
            max_force: number(muscle.max_force),
            optimal_fibre: number(muscle.optimal_fibre),
            per_optimal: number(muscle.optimal_fibre).recip(),
            thickness: some(muscle.pennation).map(|angle| {
                let (sine, _) = angle.sin_cos();
                sine * sine
            }),
            tendon_slack: number(muscle.tendon_slack),
            tendon_stretch: [stretch, stretch.recip()],
            per_velocity: number(muscle.max_velocity).recip(),
            passive_strain: [passive, passive.recip()],
            eccentric: number(muscle.eccentric_force),
            damping: some(muscle.fibre_damping),
            action: number(muscle.max_force)
                * number(muscle.optimal_fibre)
                * number(muscle.activation_time),
            per_time: [muscle.activation_time, muscle.deactivation_time].map(|t| number(t).recip()),
        }
    }

    /// Strain of the tendon in parts of that at the largest force.
    fn strain(&self, stretch: S) -> S {
        (stretch - self.tendon_slack) * self.tendon_stretch[1]
    }

    /// Force of the tendon (N) and its stiffness (N/m) at a length x − s.
    pub fn tendon(&self, length: S) -> Curve<S> {
        let Curve { value, slope } = curves::tendon(self.strain(length));
        Curve {
            value: self.max_force * value,
            slope: self.max_force * self.tendon_stretch[1] * slope,
        }
    }

    /// Whether the tendon pulls: 1, 0 or between.
    pub fn tendon_taut(&self, length: S) -> S {
        curves::tendon_taut(self.strain(length))
    }

    /// Length λ in parts of the optimum, cos α, and how cos α changes with λ cos α.
    fn shape(&self, s: S) -> (S, S, Option<S>) {
        let along = s * self.per_optimal;
        match self.thickness {
            Some(thickness) => {
                let square = along * along + thickness;
                let per_length = square.sqrt().recip();
                let turning = thickness * per_length * per_length * per_length;
                (square * per_length, along * per_length, Some(turning))
            }
            None => (along, S::one(), None),
        }
    }

    /// Energy (J) of tendon and passive fibres.
    pub fn energy(&self, tendon_length: S, s: S) -> S {
        let tendon = curves::tendon_energy(self.strain(tendon_length));
        let passive = curves::passive_energy(self.shape(s).0, self.passive_strain[0]);
        self.max_force * (tendon * self.tendon_stretch[0] + passive * self.optimal_fibre)
    }

    /// The fibres at s with rate ṡ and activation a.
    pub fn fibres(&self, s: S, rate: S, activation: S) -> Fibres<S> {
        let a = activation;
        let (length, cosine, turning) = self.shape(s);
        // Rate of λ in parts of the largest, and how it changes with s as the fibres turn.
        let along = rate * self.per_optimal * self.per_velocity;
        let velocity = cosine * along;
        let per_scale = per_scale(a);
        let active = curves::active(length);
        let passive = curves::passive(length, self.passive_strain[1]);
        let scaled = velocity * per_scale;
        let lengthening = curves::velocity(scaled, self.eccentric);
        let isometric = a * active.value;
        let (mut force, mut by_velocity) =
            (isometric * lengthening.value, isometric * lengthening.slope * per_scale);
        let power = -(force * velocity);
        let by_length = a * active.slope * lengthening.value + passive.slope;
        let by_activation = active.value
            * (lengthening.value - (a * per_scale).scale(0.75) * scaled * lengthening.slope);
        force += passive.value;
        let mut dissipation = S::zero();
        if let Some(damping) = self.damping {
            force += damping * velocity;
            by_velocity += damping;
            dissipation = damping * velocity * velocity;
        }
        let mut by_along = by_length * cosine;
        if let Some(turning) = turning {
            by_along += by_velocity * along * turning;
        }
        by_along = by_along * cosine;
        if let Some(turning) = turning {
            by_along += force * turning;
        }
        let by_rate = by_velocity * cosine * cosine * self.per_velocity;
        let per_metre = self.max_force * self.per_optimal;
        // l̇ = l₀ v₀ λ̇/v₀.
        let to_power = self.max_force * self.optimal_fibre / self.per_velocity;
        Fibres {
            force: self.max_force * force * cosine,
            by: [
                per_metre * by_along,
                per_metre * by_rate,
                self.max_force * by_activation * cosine,
            ],
            length: if self.thickness.is_some() { length * self.optimal_fibre } else { s },
            pull: self.max_force * force,
            power: power * to_power,
            dissipation: dissipation * to_power,
        }
    }

    /// F₀ l₀ τ₁ (J·s), by which the equation of the activation is multiplied.
    pub fn action(&self) -> S {
        self.action
    }

    /// Rate ȧ of the activation (1/s) at an excitation, and its slope by the activation:
    /// (u − a)/τ with τ = τ₁(1/2 + 3a/2) for u > a and τ₂/(1/2 + 3a/2) for u < a (Thelen 2003,
    /// equations 1 and 2), a smooth step between them.
    pub fn activation(&self, excitation: S, activation: S) -> Curve<S> {
        let rise = excitation - activation;
        let [share, share_slope] = step(rise.scale(1.0 / SWITCH) + S::constant(0.5));
        let scale = activation.scale(1.5) + S::constant(0.5);
        // The same quotient as that of the velocities.
        let per_scale = per_scale(activation).scale(0.5);
        let up = self.per_time[0] * per_scale;
        let down = self.per_time[1] * scale;
        let per_time = down + share * (up - down);
        let slope = (self.per_time[1] - share * (self.per_time[1] + up * per_scale)).scale(1.5)
            - share_slope.scale(1.0 / SWITCH) * (up - down);
        Curve { value: rise * per_time, slope: rise * slope - per_time }
    }
}

/// 1/(1/4 + 3a/4): velocities are smaller where fibres are less active.
fn per_scale<S: Scalar>(activation: S) -> S {
    (activation.scale(0.75) + S::constant(0.25)).recip()
}
