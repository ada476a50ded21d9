//! What is fed to a run from outside: inputs and natural lengths as functions of time, paths of
//! kinematic coordinates. What follows a motion is not among it.

use crate::layout::Layout;
use crate::model::Model;

/// Where inputs and natural lengths come from.
#[derive(Clone, Debug)]
pub(super) struct Feed {
    scenario: Option<usize>,
    /// Inputs that are held at a value.
    held: Vec<Option<f64>>,
    is_holding: bool,
    /// Inputs that stand for the natural lengths of strands, with their lengths at the start (m).
    actuated: Vec<(usize, f64)>,
    /// Whether any strand's length is prescribed.
    pub(super) is_prescribed: bool,
    /// Whether the model gives any natural length, and any coordinate its path.
    pub(super) has_rests: bool,
    pub(super) has_paths: bool,
    /// Whether anything that is fed changes from step to step.
    pub(super) varies: bool,
}

impl Feed {
    /// Of a scenario in which `has_paths` says whether any coordinate is driven.
    pub(super) fn new(layout: &Layout, scenario: Option<usize>, has_paths: bool) -> Self {
        let strands = &layout.strands;
        Feed {
            scenario,
            held: vec![None; layout.inputs.len()],
            is_holding: false,
            actuated: strands.iter().filter_map(|s| Some((s.actuator?, 0.0))).collect(),
            is_prescribed: strands.iter().any(|s| s.is_prescribed),
            has_rests: strands.iter().any(|s| s.has_rest),
            has_paths,
            varies: !layout.inputs.is_empty()
                || has_paths
                || strands.iter().any(|s| s.rest_varies || s.muscle.is_some()),
        }
    }

    /// Holds an input at a value, or lets go of it.
    pub(super) fn hold(&mut self, input: usize, value: Option<f64>) {
        self.held[input] = value;
        self.is_holding = self.held.iter().any(Option::is_some);
    }

    /// From now on inputs that stand for natural lengths are these lengths (m, by strand) where
    /// nothing else is given.
    pub(super) fn begin(&mut self, layout: &Layout, lengths: &[f64]) {
        let actuated = layout.strands.iter().zip(lengths).filter(|(s, _)| s.actuator.is_some());
        for (place, (_, &length)) in self.actuated.iter_mut().zip(actuated) {
            place.1 = length;
        }
    }

    /// Inputs at time `t` (s).
    #[inline]
    pub(super) fn inputs<M: Model>(&self, model: &mut M, t: f64, inputs: &mut [f64]) {
        if inputs.is_empty() {
            return;
        }
        model.inputs(t, inputs);
        if let Some(scenario) = self.scenario {
            model.scenario_inputs(scenario, t, inputs);
        }
        if self.is_holding {
            for (input, held) in inputs.iter_mut().zip(&self.held) {
                *input = held.unwrap_or(*input);
            }
        }
        for &(input, length) in &self.actuated {
            if inputs[input].is_nan() {
                inputs[input] = length;
            }
        }
    }

    /// Natural lengths that the model gives (m), at time `t` (s) and with these inputs.
    #[inline]
    pub(super) fn rests<M: Model>(&self, model: &mut M, t: f64, inputs: &[f64], rest: &mut [f64]) {
        if self.has_rests {
            model.rests(t, inputs, rest);
        }
        if let Some(scenario) = self.scenario.filter(|_| self.is_prescribed) {
            model.scenario_rests(scenario, t, rest);
        }
    }

    /// Kinematic coordinates at time `t` (s); others are left as they are.
    #[inline]
    pub(super) fn paths<M: Model>(&self, model: &mut M, t: f64, q: &mut [f64]) {
        if !self.has_paths {
            return;
        }
        model.drives(t, q);
        if let Some(scenario) = self.scenario {
            model.scenario_drives(scenario, t, q);
        }
    }
}
