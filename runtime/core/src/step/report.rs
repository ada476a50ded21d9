//! What is said of a step that could not be taken.

use super::{Attempt, State, Stepper, Surroundings};
use crate::error::{StepError, StepErrorKind};
use crate::model::{Midpoint, Model};
use crate::passage::{self, Blocked};

impl Stepper {
    pub(super) fn report<M: Model>(
        &mut self,
        model: &mut M,
        state: &State,
        around: &Surroundings,
        last: Attempt,
        iterations: usize,
    ) -> StepError {
        let blocked = match self.blocked(model, state, around) {
            Some(blocked) => Some(blocked),
            None => self.pushing(model, state, around),
        };
        // Evaluate where the step began, so that the numbers reported are the model's own.
        self.guess(2, state, around);
        self.evaluate(model, state, around, true);
        self.set_sensitivities(state);
        self.set_scales(state, around);
        let layout = model.layout();
        let mut worst = (0.0, String::from("none"), 0.0);
        let mut keep = |found: f64, name: &str, r: f64| {
            // The first that is not a number stays.
            if !(found <= worst.0) && !f64::is_nan(worst.0) {
                worst = (found, name.to_string(), r);
            }
        };
        for block in &self.blocks {
            for &c in &block.coordinates {
                let r = self.residual[c];
                keep(r.abs() * self.per_scale[c], &layout.coordinates[c].name, r);
            }
            for &row in &block.rows {
                let gap = self.gap[row];
                keep(gap.abs() * self.per_gap[row], &layout.rows[row].name, gap);
            }
        }
        let mut hints = Vec::new();
        let kind = match last {
            Attempt::Singular(coordinate) => {
                let name = &layout.coordinates[coordinate].name;
                worst.1 = name.clone();
                hints.push(format!(
                    "give `{name}` mass or stiffness: neither a mass, a strand nor a constraint \
                     determines it here"
                ));
                StepErrorKind::Singular
            }
            _ if !worst.0.is_finite() => {
                hints.push(
                    "look for coincident path points or a division by zero in an expression"
                        .to_string(),
                );
                StepErrorKind::NotFinite
            }
            _ => StepErrorKind::NoConvergence,
        };
        if kind == StepErrorKind::NoConvergence {
            let fastest = crate::frequency::fastest(model, &state.q, around);
            if let Some(omega) = fastest.filter(|omega| omega * around.h > 0.5) {
                hints.push(format!(
                    "a smaller step: the stiffest motion has h·ω = {:.2} (ω = {omega:.0} rad/s); \
                     h = {:.1e} s brings it to 0.5",
                    around.h * omega,
                    0.5 / omega
                ));
            } else {
                hints.push(format!("a smaller step than {} s", around.h));
            }
            hints.push("drives, inputs and motions that begin without a jump".to_string());
        }
        let kind = if blocked.is_some() { StepErrorKind::Blocked } else { kind };
        let (blocked, hints) = match blocked {
            Some(Blocked { what, hint }) => (what, vec![hint.to_string()]),
            None => (String::new(), hints),
        };
        StepError {
            kind,
            t: state.t,
            step: state.step + 1,
            equation: worst.1,
            residual: worst.2,
            condition: self.condition,
            iterations,
            blocked,
            hints,
        }
    }

    /// A strand that is commanded to push, at the middle of the step as the guesses have it.
    fn pushing<M: Model>(
        &mut self,
        model: &mut M,
        state: &State,
        around: &Surroundings,
    ) -> Option<Blocked> {
        [2, 1, 0, 3].into_iter().find_map(|guess| {
            self.guess(guess, state, around);
            let moved = |(q, delta): (&f64, &f64)| q + 0.5 * delta;
            let q: Vec<f64> = state.q.iter().zip(&self.delta).map(moved).collect();
            let v: Vec<f64> = self.delta.iter().map(|delta| delta / around.h).collect();
            let t = 0.5 * (state.t + around.t1);
            let at = Midpoint { q: &q, v: &v, t, rest: around.rest, inputs: around.inputs };
            passage::pushing(model, &at)
        })
    }

    /// A strand that cannot pass its surface where the step begins, or where a guess leads: at the
    /// middle of the step first.
    fn blocked<M: Model>(
        &mut self,
        model: &mut M,
        state: &State,
        around: &Surroundings,
    ) -> Option<Blocked> {
        let here = passage::blocked(model, &state.q);
        here.or_else(|| {
            let places =
                [0.5, 1.0].into_iter().flat_map(|part| [1, 0, 3].map(|guess| (part, guess)));
            places.into_iter().find_map(|(part, guess)| {
                self.guess(guess, state, around);
                let ahead = state.q.iter().zip(&self.delta).map(|(q, delta)| q + part * delta);
                passage::blocked(model, &ahead.collect::<Vec<f64>>())
            })
        })
    }
}
