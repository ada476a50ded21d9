//! Simplification and differentiation against plain numbers, on random expressions.

use super::*;
use handc_core::scalar::{Comparison, Scalar};
use handc_runtime::expression::Variable;

mod dual;
mod rules;

/// A small deterministic generator.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((self.0 >> 33) as usize) % bound
    }
    fn number(&mut self) -> f64 {
        self.below(4001) as f64 / 1000.0 - 2.0
    }
}

/// A random expression over `leaves`: the same one for every scalar type and equal seed.
fn expression<S: Scalar>(seed: u64, leaves: &[S]) -> S {
    let random = &mut Random(seed);
    let mut values = leaves.to_vec();
    for constant in [0.0, 1.0, -1.0, 2.0, -0.5] {
        values.push(S::constant(constant));
    }
    values.push(S::constant(random.number()));
    for _ in 0..40 {
        let mut pick = || values[random.below(values.len())];
        let (a, b, c, d) = (pick(), pick(), pick(), pick());
        values.push(match random.below(20) {
            0..=2 => a + b,
            3..=5 => a - b,
            6..=9 => a * b,
            10 => -a,
            11 => a / (b * b + S::one()),
            12 => a.sin_cos().0,
            13 => a.sin_cos().1,
            14 => (a * a + S::constant(0.25)).sqrt(),
            15 => S::select(Comparison::Less, a, b, c, d),
            16 => a.min(b) + c.max(d),
            17 => a.atan2(b * b + S::constant(0.5)).abs(),
            18 => a.sin_cos().0.powi(3).exp() - a.atan(),
            _ => (a * a + S::one()).log() - (b * b + S::one()).recip().powf(S::constant(1.5)),
        });
    }
    *values.last().expect("never empty")
}

const POINT: [f64; 3] = [0.7, -1.3, 0.4];

fn unknowns() -> [Sym; 3] {
    [Sym::leaf(Leaf::Q(0)), Sym::leaf(Leaf::V(1)), Sym::leaf(Leaf::Time)]
}

fn read<S: Scalar>(point: [S; 3]) -> impl Fn(Variable) -> S {
    move |variable| match variable {
        Variable::Coordinate(0) => point[0],
        Variable::Rate(1) => point[1],
        Variable::Time => point[2],
        other => panic!("unexpected {other:?}"),
    }
}

fn close(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= 1e-9 * (1.0 + expected.abs())
}

#[test]
fn simplified_expressions_keep_their_value() {
    for seed in 0..1000 {
        let expected = expression(seed, &POINT);
        let found = with_new(|| to_program(&[expression(seed, &unknowns())])).value(read(POINT));
        // Chaotic or overflowing samples say nothing about the rules.
        if expected.is_finite() && expected.abs() < 1e6 {
            assert!(close(found, expected), "seed {seed}: {found} instead of {expected}");
        }
    }
}

#[test]
fn derivatives_agree_with_dual_numbers() {
    for seed in 0..1000 {
        for direction in 0..3 {
            let mut point = POINT.map(dual::Dual::constant);
            point[direction].derivative = 1.0;
            let expected = expression(seed, &point).derivative;
            let program = with_new(|| {
                let leaves = unknowns();
                to_program(&[differentiate(expression(seed, &leaves), leaves[direction])])
            });
            let found = program.value(read(POINT));
            if expected.is_finite() && expected.abs() < 1e6 {
                assert!(close(found, expected), "seed {seed}: {found} instead of {expected}");
            }
        }
    }
}

#[test]
fn evaluating_a_program_on_symbols_gives_its_symbols_back() {
    with_new(|| {
        let leaves = unknowns();
        for seed in 0..200 {
            let symbol = expression(seed, &leaves);
            assert_eq!(to_program(&[symbol]).value(read(leaves)), symbol, "seed {seed}");
        }
    });
}
