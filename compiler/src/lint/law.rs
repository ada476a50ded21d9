//! Energies of strands: twice differentiable wherever the strand can get.
//!
//! A law may choose between branches. Where it does, value, slope and curvature of the energy are
//! compared on both sides; a jump would leave Newton's method without a matrix, and the integrator
//! without its balance of energy.

use super::Context;
use handc_core::model::Model;
use handc_dsl::diagnostic::Diagnostic;
use handc_runtime::expression::{Operation, Own, Program, Variable};
use handc_runtime::mechanism::Law;

/// Lengths at which branches are looked for.
const SAMPLES: usize = 2000;
/// Lengths from this to that part of the length at the start are thought to be reached.
const REACHED: [f64; 2] = [0.2, 2.0];
/// Jumps below this part of the largest value in reach are rounding.
const JUMP: f64 = 1e-6;

/// What the outputs of an energy's program are called, and their units.
const DERIVATIVES: [(&str, &str); 3] =
    [("it", "J"), ("its first derivative", "N"), ("its second derivative", "N/m")];

/// Looks at every law that is an energy.
pub(super) fn energies(context: &mut Context, found: &mut Vec<Diagnostic>) {
    let start = context.start();
    let strands = context.mechanism.strands.len();
    let mut lengths = vec![0.0; strands];
    context.interpreter.strand_lengths(&start, &mut lengths);
    let mut rest = lengths.clone();
    let mut inputs = vec![0.0; context.mechanism.inputs.len()];
    context.interpreter.inputs(0.0, &mut inputs);
    context.interpreter.rests(0.0, &inputs, &mut rest);
    let params = context.interpreter.params().to_vec();
    for (index, strand) in context.mechanism.strands.iter().enumerate() {
        let Law::Energy(program) = &strand.law else { continue };
        let rest = if rest[index].is_finite() { rest[index] } else { lengths[index] };
        let law = EnergyLaw { program, params: &params, rest };
        let Some((at, order, [left, right])) = law.kink(lengths[index]) else { continue };
        let model = &context.model.strands[index];
        let (what, unit) = DERIVATIVES[order];
        found.push(
            Diagnostic::error(
                "energy-kink",
                model.name.span,
                format!("the energy of `{}` is not twice differentiable", model.name.text),
            )
            .label(format!(
                "{what} jumps from {left:.4} to {right:.4} {unit} at x = {:.4} m, where x0 = {rest:.4} m",
                at
            ))
            .help(
                "let value, slope and curvature meet there, or use `stiffness` with `slack = true`, \
                 which is smooth",
            ),
        );
    }
}

struct EnergyLaw<'a> {
    program: &'a Program,
    params: &'a [f64],
    rest: f64,
}

impl EnergyLaw<'_> {
    /// All values of the program at a length.
    fn values(&self, length: f64) -> Vec<f64> {
        let mut values = Vec::new();
        let read = |variable| match variable {
            Variable::Param(i) => self.params[i as usize],
            Variable::Own(Own::Length) => length,
            Variable::Own(Own::Rest) => self.rest,
            _ => f64::NAN,
        };
        self.program.evaluate(read, &mut values);
        values
    }

    fn derivatives(&self, length: f64) -> [f64; 3] {
        let values = self.values(length);
        [0, 1, 2].map(|k| self.program.output(&values, k))
    }

    /// By how much each choice of the program is decided, positive on one side and negative on the
    /// other.
    fn margins(&self, length: f64) -> Vec<f64> {
        let values = self.values(length);
        let at = |i: u32| values[i as usize];
        self.program
            .operations
            .iter()
            .filter_map(|operation| match *operation {
                Operation::IfLess(a, b, ..)
                | Operation::IfLessEqual(a, b, ..)
                | Operation::IfEqual(a, b, ..)
                | Operation::Min(a, b)
                | Operation::Max(a, b) => Some(at(a) - at(b)),
                Operation::Abs(a) => Some(at(a)),
                // Jumps at every whole number.
                Operation::Floor(a) => Some((std::f64::consts::PI * at(a)).sin()),
                _ => None,
            })
            .collect()
    }

    /// The first length in reach at which the energy or a derivative jumps: where, which, and the
    /// values on both sides.
    fn kink(&self, start: f64) -> Option<(f64, usize, [f64; 2])> {
        let [low, high] = REACHED.map(|part| part * start.max(self.rest));
        let length = |k: usize| low + (high - low) * k as f64 / SAMPLES as f64;
        let mut scale = [0.0f64; 3];
        for k in 0..=SAMPLES {
            let values = self.derivatives(length(k));
            for (scale, value) in scale.iter_mut().zip(values) {
                if value.is_finite() {
                    *scale = scale.max(value.abs());
                }
            }
        }
        let mut before = self.margins(low);
        for k in 1..=SAMPLES {
            let after = self.margins(length(k));
            for choice in 0..after.len() {
                if !(before[choice] * after[choice] <= 0.0) || before[choice] == after[choice] {
                    continue;
                }
                let [left, right] = self.sides(choice, [length(k - 1), length(k)]);
                let (a, b) = (self.derivatives(left), self.derivatives(right));
                for order in 0..3 {
                    if !((a[order] - b[order]).abs() <= JUMP * scale[order]) {
                        return Some((0.5 * (left + right), order, [a[order], b[order]]));
                    }
                }
            }
            before = after;
        }
        None
    }

    /// Lengths on both sides of the place where a choice changes, as near as rounding allows.
    fn sides(&self, choice: usize, [mut left, mut right]: [f64; 2]) -> [f64; 2] {
        let sign = self.margins(left)[choice] > 0.0;
        while right - left > 1e-13 * right {
            let middle = 0.5 * (left + right);
            if (self.margins(middle)[choice] > 0.0) == sign {
                left = middle;
            } else {
                right = middle;
            }
        }
        // A little away, so that neither side is the place itself.
        let away = 1e-12 * right;
        [left - away, right + away]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::{Leaf, Sym, differentiate, to_program, with_new};
    use handc_core::scalar::{Comparison, Scalar};

    /// The first jump of k·max(0, x − x₀)ⁿ with x₀ = 0.1 m.
    fn jump(power: i32) -> Option<(f64, usize, [f64; 2])> {
        with_new(|| {
            let x = Sym::leaf(Leaf::Own(Own::Length));
            let stretch = x - Sym::leaf(Leaf::Own(Own::Rest));
            let zero = Sym::zero();
            let pulled = stretch.powi(power).scale(100.0);
            let energy = Sym::select(Comparison::Less, stretch, zero, zero, pulled);
            let tension = differentiate(energy, x);
            let slope = differentiate(tension, x);
            let program = to_program(&[energy, tension, slope]);
            EnergyLaw { program: &program, params: &[], rest: 0.1 }.kink(0.12)
        })
    }

    #[test]
    fn a_square_that_begins_is_found_and_a_cube_is_not() {
        let (at, order, [left, right]) = jump(2).expect("a jump of the curvature");
        assert!((at - 0.1).abs() < 1e-9 && order == 2 && left == 0.0 && right == 200.0);
        assert_eq!(jump(1).map(|found| found.1), Some(1));
        assert_eq!(jump(3), None);
    }
}
