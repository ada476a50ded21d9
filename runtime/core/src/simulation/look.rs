//! What is written of a run: coordinates, energy and records at the instant it has reached.

use super::Simulation;
use crate::model::{Instant, Model};

impl<M: Model> Simulation<M> {
    /// Coordinates at the state's time: those in static equilibrium are balanced there, where the
    /// state itself has them at the middle of the step.
    pub fn coordinates(&mut self) -> &[f64] {
        self.seen_q.copy_from_slice(&self.state.q);
        if !self.statics.is_empty() && self.state.step > 0 {
            self.feed(self.state.t);
            let given = (self.state.t, &self.rest[..], &self.inputs[..]);
            let (statics, q) = (&mut self.statics, &mut self.seen_q);
            // Before the first step all is where it rests, and internal variables where they were
            // put. Where no balance is found the next step will say so.
            if statics.settle(&mut self.model, q, self.h, given).is_err() {
                self.seen_q.copy_from_slice(&self.state.q);
            }
        }
        &self.seen_q
    }

    /// Energy (J) at the state: kinetic from p, projected onto the constraints' tangent space, plus
    /// potential with the natural lengths at the state's time.
    pub fn energy(&mut self) -> f64 {
        self.coordinates();
        self.feed(self.state.t);
        let (q, state) = (&self.seen_q, &self.state);
        let kinetic = self.kinetic.energy(&mut self.model, q, state.t, &state.p, &self.driven);
        kinetic + self.model.potential(q, &self.rest)
    }

    /// Values of the scenario's recorded columns at the state.
    pub fn records(&mut self, values: &mut [f64]) {
        if let Some(scenario) = self.scenario.filter(|_| !values.is_empty()) {
            self.look(|model, at| model.scenario_records(scenario, at, values));
        }
    }

    /// Shows the model the instant that the state has reached.
    pub fn look<T>(&mut self, see: impl FnOnce(&mut M, &Instant) -> T) -> T {
        self.coordinates();
        self.seen_v.copy_from_slice(&self.state.v);
        if self.state.step > 0 {
            for (_, muscle) in self.layout.muscles() {
                for c in [muscle.fibre, muscle.activation].into_iter().filter(|&c| !self.driven[c])
                {
                    self.seen_v[c] = (self.seen_q[c] - self.state.q[c]) / (0.5 * self.h);
                }
            }
        }
        self.feed(self.state.t);
        let rest = std::mem::take(&mut self.rest);
        self.rest.clone_from(&rest);
        // Inputs are those of the step just ended.
        self.feed(if self.state.step == 0 { 0.0 } else { self.state.t - 0.5 * self.h });
        let at = Instant {
            t: self.state.t,
            q: &self.seen_q,
            v: &self.seen_v,
            inputs: &self.inputs,
            lambda: &self.state.lambda,
            rest: &rest,
            h: self.h,
        };
        see(&mut self.model, &at)
    }
}
