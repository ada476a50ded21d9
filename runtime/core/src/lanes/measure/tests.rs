//! Lengths that were measured ahead are those of their own steps.

use super::super::course::{Courses, Follows};
use super::super::vector::Counts;
use super::*;
use crate::lane::available;
use crate::shape::Local;
use std::cell::Cell;

const STEP: f64 = 1e-3;
const STEPS: usize = 37;

thread_local! {
    static EVALUATIONS: Cell<usize> = const { Cell::new(0) };
}

/// One coordinate, two strands that do not pull.
struct Slack;

impl Shape<1, 1, 1, 2, 0> for Slack {
    const CONSTANTS: usize = 1;

    fn evaluate<L: Lane>(_: &Local<L, 1, 2, 0>, _: &[f64], _: &mut [L; 1], _: &mut [L; 1]) {}
    fn evaluate_with_matrix<L: Lane>(
        _: &Local<L, 1, 2, 0>,
        _: &[f64],
        _: &mut [L; 1],
        _: &mut [L; 1],
        _: &mut [L; 1],
    ) {
    }
    fn mass_matrix<L: Lane>(_: &[L; 1], _: &[f64], _: &mut [L; 1]) {}
    fn momentum_matrix<L: Lane>(_: &Local<L, 1, 2, 0>, _: &[f64], _: &mut [L; 1]) {}
    fn lengths<L: Lane>(q: &[L; 1], constants: &[f64], lengths: &mut [L; 2]) {
        EVALUATIONS.set(EVALUATIONS.get() + 1);
        let (arm, (sine, cosine)) = (L::load(constants), q[0].sin_cos());
        *lengths = [arm.mul_add(sine, L::splat(0.5)), arm * cosine];
    }
}

/// A run in stretches, which notes natural lengths after every step.
struct Run<'a> {
    vector: &'a mut Vector,
    courses: &'a [Courses<'a>],
    stretch: usize,
    noted: &'a mut Vec<u64>,
}

impl Work for Run<'_> {
    #[inline(always)]
    fn run<L: Lane>(self) {
        let h = L::load(&self.vector.h);
        for step in 0..STEPS {
            let k = step % self.stretch;
            if k == 0 {
                self.vector.begin_stretch();
            }
            let t = middle(L::splat(step as f64), L::splat((step + 1) as f64), h);
            t.store(&mut self.vector.t);
            self.vector.move_courses(t, self.courses);
            let left = self.stretch.min(STEPS - step + k) - k;
            measure::<L, Slack, 1, 1, 1, 2, 0>(self.vector, [t, h], [step, left]);
            self.noted.extend(self.vector.rest.iter().map(|rest| rest.to_bits()));
        }
    }
}

/// What the last lane has.
#[derive(Clone, Copy, Debug)]
struct Last {
    constant: f64,
    /// First strand.
    strand: usize,
    /// Angle of a pose of its run, and step.
    angle: f64,
    step: f64,
}

/// The same as the others.
const SAME: Last = Last { constant: 0.1, strand: 0, angle: 0.3, step: STEP };

/// What was noted, and how often lengths were evaluated.
fn measured(width: usize, last: Last, stretch: usize) -> (Vec<u64>, usize) {
    let counts = Counts { unknowns: 1, coordinates: 1, strands: 2, inputs: 0 };
    let mut vector = Vector::new(0, [width, width], &counts);
    vector.coordinates = vec![0; width];
    vector.strands = [vec![0; width], vec![1; width]].concat();
    vector.constants = vec![0.1; width];
    vector.constants[width - 1] = last.constant;
    vector.strands[width - 1] = last.strand;
    vector.runs[width - 1] = 1;
    vector.h = [STEP; WIDEST];
    vector.h[width - 1] = last.step;
    let follows = Follows::new(vec![(0, vec![0]), (1, vec![1])], vec![false; 2]);
    vector.courses = follows.courses(&vector);
    // Turns are amid what is measured ahead, at any lane; between them the first motion rests.
    let motion = |knots: &[(usize, f64)]| -> Vec<(usize, f64)> {
        knots.iter().map(|&(pose, steps)| (pose, steps * STEP)).collect()
    };
    let motions = [
        motion(&[(0, -2.0), (1, 5.3), (2, 12.6), (2, 19.1), (0, 30.9)]),
        motion(&[(2, 2.2), (0, 23.0)]),
    ];
    let poses = [SAME.angle, last.angle].map(|angle| [vec![-0.2], vec![angle], vec![0.9]]);
    let courses = poses.each_ref().map(|poses| Courses { poses, motions: &motions });
    let mut noted = Vec::new();
    EVALUATIONS.set(0);
    let run = Run { vector: &mut vector, courses: &courses, stretch, noted: &mut noted };
    assert!(call(width, run));
    (noted, EVALUATIONS.get())
}

#[test]
fn what_is_measured_ahead_serves_its_own_steps_up_to_a_turn() {
    for width in [4, 8].into_iter().filter(|&width| width <= available()) {
        let (one_by_one, evaluations) = measured(width, SAME, 1);
        // By part of the motions; where they rest one is enough.
        assert_eq!(evaluations, (13 + 1 + 12 + 1) + (1 + 21 + 1));
        for stretch in [2, 3, 7, 64] {
            let (noted, fewer) = measured(width, SAME, stretch);
            assert!(noted == one_by_one, "{stretch} steps in one go on {width} lanes");
            let most = evaluations * 2 / stretch.min(3);
            assert!(fewer < most, "{fewer} of {evaluations} for {stretch} steps in one go");
        }
    }
}

#[test]
fn lanes_that_differ_stand_for_themselves() {
    for width in [4, 8].into_iter().filter(|&width| width <= available()) {
        let others = [
            Last { constant: 0.1f64.next_up(), ..SAME },
            Last { strand: 2, ..SAME },
            Last { angle: 0.4, ..SAME },
            Last { step: STEP * 1.25, ..SAME },
        ];
        for last in others {
            let (one_by_one, evaluations) = measured(width, last, 1);
            let (noted, as_many) = measured(width, last, 64);
            assert!(noted == one_by_one, "{last:?}");
            // One part does not touch that pose, and all lanes follow the other motion.
            let is_partial = last.angle != SAME.angle || last.strand != SAME.strand;
            assert!(as_many == evaluations || is_partial, "{last:?}: {as_many}");
        }
    }
}
