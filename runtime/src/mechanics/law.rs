//! Laws of strands: the tension that follows from length, natural length and rate.
//!
//! Every law is a function of the length x. A strand that can go slack sees x₀ + ρ(x − x₀) in its
//! place, where ρ is zero for a strand too long for its path and x − x₀ for one that is taut, three
//! times differentiable between: so slack composes with every law, with damping too, and keeps the
//! energy of those that have one.

use super::ramp::{Ramp, ramp};
use super::segment::Order;
use super::{At, Mechanics, Workspace};
use crate::expression::{Own, Variable};
use crate::mechanism::Law;
use handc_core::scalar::{Comparison, Scalar};

/// The tension of a strand and what it changes with.
#[derive(Clone, Debug)]
pub(crate) struct Pull<S> {
    /// Tension T (N).
    pub(crate) tension: S,
    /// ∂T/∂x.
    pub(crate) length_slope: S,
    /// ∂T/∂ẋ, if T depends on the rate.
    pub(crate) rate_slope: Option<S>,
    /// ∂T by coordinates that a commanded tension reads.
    pub(crate) dq: Vec<(usize, S)>,
    /// ∂T by rates that a commanded tension reads.
    pub(crate) dv: Vec<(usize, S)>,
    /// 1 where the strand pulls, 0 where it is slack.
    pub(crate) taut: S,
    /// Power that damping takes (W).
    pub(crate) dissipation: S,
}

impl<S: Scalar> Mechanics<'_, S> {
    /// The ramp of a strand that can go slack.
    fn ramp(&self, index: usize, length: S, rest: S) -> Option<Ramp<S>> {
        self.numbers.strands[index].slack.map(|width| ramp(length - rest, width))
    }

    /// Tension of a strand of length x and rate ẋ; derivatives by other variables if `slopes`.
    pub(crate) fn pull(
        &self,
        workspace: &mut Workspace<S>,
        at: &At<S>,
        index: usize,
        (length, rate): (S, S),
        slopes: bool,
    ) -> Pull<S> {
        let rest = at.rest[index];
        let numbers = &self.numbers.strands[index];
        let ramp = self.ramp(index, length, rest);
        let seen = ramp.map_or(length, |ramp| rest + ramp.value);
        let mut pull = Pull {
            tension: S::zero(),
            length_slope: S::zero(),
            rate_slope: None,
            dq: Vec::new(),
            dv: Vec::new(),
            taut: ramp.map_or(S::one(), |ramp| ramp.slope),
            dissipation: S::zero(),
        };
        match &self.mechanism.strands[index].law {
            Law::Linear { .. } => {
                let stiffness = numbers.stiffness.unwrap_or_else(S::zero);
                let stretch = ramp.map_or(length - rest, |ramp| ramp.value);
                pull.tension = stiffness * stretch;
                pull.length_slope = stiffness;
            }
            Law::Energy(program) => {
                let mut values = std::mem::take(&mut workspace.values);
                program.evaluate(|variable| self.read_own(variable, seen, rest), &mut values);
                pull.tension = program.output(&values, 1);
                pull.length_slope = program.output(&values, 2);
                workspace.values = values;
            }
            Law::Tension(function) => {
                let own = [length, rest, rate];
                let (value, found) = self.function_of(workspace, at, function, own, slopes);
                // The commanded tension acts through the part of the length that pulls. One below
                // zero would push: the step has no solution then.
                let zero = S::zero();
                let value = S::select(Comparison::Less, value, zero, S::constant(f64::NAN), value);
                pull.tension = value;
                pull.dq = found.dq;
                pull.dv = found.dv;
                let along = found.own[Own::Length as usize];
                if let Some(ramp) = ramp {
                    pull.length_slope = along * ramp.slope + value * ramp.curvature;
                    pull.tension = value * ramp.slope;
                    for (_, slope) in pull.dq.iter_mut().chain(&mut pull.dv) {
                        *slope = *slope * ramp.slope;
                    }
                } else {
                    pull.length_slope = along;
                }
                if self.mechanism.strands[index].has_rate() {
                    pull.rate_slope = Some(found.own[Own::Rate as usize] * pull.taut);
                }
            }
            Law::Prescribed => {}
            Law::Muscle(muscle) => self.pull_of_tendon(at, index, muscle, length, &mut pull),
        }
        if let (Some(ramp), Law::Linear { .. } | Law::Energy(_)) =
            (ramp, &self.mechanism.strands[index].law)
        {
            let (tension, slope) = (pull.tension, pull.length_slope);
            pull.tension = tension * ramp.slope;
            pull.length_slope = slope * ramp.slope * ramp.slope + tension * ramp.curvature;
        }
        if let Some(c) = numbers.damping {
            let (mut drag, mut drag_slope) = (c, S::zero());
            if let Some(ramp) = ramp {
                drag = c * ramp.slope * ramp.slope;
                drag_slope = (c * ramp.slope * ramp.curvature * rate).scale(2.0);
            }
            pull.tension += drag * rate;
            pull.length_slope += drag_slope;
            pull.rate_slope = Some(pull.rate_slope.map_or(drag, |slope| slope + drag));
            pull.dissipation = drag * rate * rate;
        }
        pull
    }

    /// Commanded tensions as they are given (N); those of strands with another law are not written.
    pub fn commands(&self, workspace: &mut Workspace<S>, at: &At<S>, tensions: &mut [S]) {
        self.prepare(workspace, at.q);
        for (index, strand) in self.mechanism.strands.iter().enumerate() {
            let Law::Tension(function) = &strand.law else { continue };
            self.strand_length(workspace, at.q, index, Order::First);
            let rate = self.strand_rate(workspace, index, at.v);
            let own = [workspace.strand.lengths[index], at.rest[index], rate];
            tensions[index] = self.function_of(workspace, at, function, own, false).0;
        }
    }

    /// Energy (J) of a strand of length x: of a commanded tension T·x where T is constant in time
    /// and in the state, else none.
    pub(crate) fn strand_energy(&self, index: usize, q: &[S], length: S, rest: S) -> S {
        let numbers = &self.numbers.strands[index];
        let ramp = self.ramp(index, length, rest);
        let seen = ramp.map_or(length, |ramp| rest + ramp.value);
        match &self.mechanism.strands[index].law {
            Law::Linear { .. } => {
                let stiffness = numbers.stiffness.unwrap_or_else(S::zero);
                let stretch = ramp.map_or(length - rest, |ramp| ramp.value);
                (stiffness * stretch * stretch).scale(0.5)
            }
            Law::Energy(program) => program.value(|variable| self.read_own(variable, seen, rest)),
            Law::Tension(function) => {
                let variables = function.program.variables();
                if variables.iter().any(|variable| !matches!(variable, Variable::Param(_))) {
                    return S::zero();
                }
                let zero = S::zero();
                seen * function.program.value(|variable| self.read_own(variable, zero, zero))
            }
            Law::Prescribed => S::zero(),
            Law::Muscle(muscle) => {
                let s = q[muscle.fibre as usize];
                numbers.muscle.map_or(S::zero(), |resolved| resolved.energy(length - s, s))
            }
        }
    }

    /// What a law that is a function of length and parameters reads.
    fn read_own(&self, variable: Variable, length: S, rest: S) -> S {
        match variable {
            Variable::Param(i) => self.numbers.params[i as usize],
            Variable::Own(Own::Length) => length,
            Variable::Own(Own::Rest) => rest,
            other => unreachable!("an energy reads {other:?}"),
        }
    }
}
