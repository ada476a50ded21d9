//! Natural lengths, on lanes, of strands that follow motions.
//!
//! Often all lanes would measure the same: one block stands in all of them, or copies of it in
//! several runs, and the pose of a motion does not depend on the state. Then the lanes stand for
//! steps to come instead, so that one evaluation serves as many steps as there are lanes.

use super::course::Course;
use super::vector::Vector;
use crate::lane::{Lane, WIDEST, Work, call, load, store};
use crate::shape::Shape;
use std::marker::PhantomData;

/// How many steps later a lane is, where lanes stand for steps to come.
const LATER: [f64; WIDEST] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

/// Natural lengths of steps to come, each step in a lane.
#[derive(Clone, Debug)]
pub(super) struct MeasuredAhead {
    lengths: Vec<f64>,
    /// Step in the first lane, and how many lanes count.
    first: usize,
    count: usize,
}

impl MeasuredAhead {
    /// Room for so many numbers, nothing measured.
    pub(super) fn new(numbers: usize) -> Self {
        MeasuredAhead { lengths: vec![0.0; numbers], first: 0, count: 0 }
    }

    /// What was measured counts no more.
    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.count = 0;
    }

    /// In which lane a step is.
    #[inline(always)]
    fn lane(&self, step: usize) -> Option<usize> {
        let lane = step.wrapping_sub(self.first);
        (lane < self.count).then_some(lane)
    }
}

/// Whether all lanes have the same bits in every row of a list.
pub(super) fn rows_are_alike(list: &[f64], width: usize) -> bool {
    let is_alike = |row: &[f64]| row.iter().all(|x| x.to_bits() == row[0].to_bits());
    list.chunks_exact(width).all(is_alike)
}

/// Middle of a step that lasts from `begin` to `end`, both counted in steps.
#[inline(always)]
pub(super) fn middle<L: Lane>(begin: L, end: L, h: L) -> L {
    let both = begin * h + end * h;
    L::splat(0.5) * both
}

/// Measures the natural lengths at the middle of a step, or takes them from what was measured ahead;
/// with how many steps of the stretch are left, this one among them.
#[inline(always)]
pub(super) fn measure<
    L: Lane,
    Sh: Shape<N, M, Q, S, U>,
    const N: usize,
    const M: usize,
    const Q: usize,
    const S: usize,
    const U: usize,
>(
    vector: &mut Vector,
    [t, h]: [L; 2],
    steps: [usize; 2],
) {
    for course in &mut vector.courses {
        if !course.is_due() {
            continue;
        }
        course.is_measured = true;
        let mut lane = course.ahead.lane(steps[0]);
        if lane.is_none() {
            // Lanes whose runs differ in time or step stand for themselves.
            let [first_t, first_h] = [vector.t[0], vector.h[0]].map(L::splat);
            let looks = L::WIDTH > 1
                && course.is_alike
                && steps[1] > 1
                && t.equal(first_t) & h.equal(first_h) == L::ALL;
            let (constants, times) = (&vector.constants[..], [&vector.t, &vector.h]);
            let shape = PhantomData::<Sh>;
            let work = Measure { course: &mut *course, constants, times, steps, looks, shape };
            if L::WIDTH == 1 {
                work.run::<L>();
            } else {
                call(L::WIDTH, work);
            }
            lane = course.ahead.lane(steps[0]);
        }
        recall::<L, S>(course, lane, &mut vector.rest);
    }
}

/// Measures in every lane for itself, or for as many steps as there are lanes.
///
/// It is called, not inlined: what it needs for itself would cost the solution of every step values
/// that wait in registers.
struct Measure<
    'v,
    Sh,
    const N: usize,
    const M: usize,
    const Q: usize,
    const S: usize,
    const U: usize,
> {
    course: &'v mut Course,
    constants: &'v [f64],
    /// Time at the middle of the step at hand, and step.
    times: [&'v [f64; WIDEST]; 2],
    /// Number of the step at hand, and steps of the stretch that are left.
    steps: [usize; 2],
    /// Whether lanes stand for steps to come.
    looks: bool,
    shape: PhantomData<Sh>,
}

impl<
    Sh: Shape<N, M, Q, S, U>,
    const N: usize,
    const M: usize,
    const Q: usize,
    const S: usize,
    const U: usize,
> Work for Measure<'_, Sh, N, M, Q, S, U>
{
    #[inline(always)]
    fn run<L: Lane>(self) {
        let Measure { course, constants, times, steps, looks, .. } = self;
        let own = times.map(|list| L::load(list));
        let (times, count) = match looks {
            true => steps_to_come::<L>(course, own, steps),
            false => (own[0], 0),
        };
        let lengths = lengths::<L, Sh, N, M, Q, S, U>(course, constants, times);
        store(&lengths, &mut course.ahead.lengths);
        (course.ahead.first, course.ahead.count) = (steps[0], count);
    }
}

/// Lengths of the strands at the pose of a motion.
#[inline(always)]
fn lengths<
    L: Lane,
    Sh: Shape<N, M, Q, S, U>,
    const N: usize,
    const M: usize,
    const Q: usize,
    const S: usize,
    const U: usize,
>(
    course: &Course,
    constants: &[f64],
    t: L,
) -> [L; S] {
    let passed = (t - L::load(&course.begins)) * L::load(&course.per_duration);
    let (_, cosine) = (L::splat(std::f64::consts::PI) * passed).sin_cos();
    let weight = L::splat(0.5) * (L::splat(1.0) - cosine);
    let (mut pose, change) = (load::<L, Q>(&course.from), load::<L, Q>(&course.change));
    for i in 0..Q {
        pose[i] = change[i].mul_add(weight, pose[i]);
    }
    // A strand that spans no block stays unmeasured, which no step survives.
    let mut lengths = [L::splat(f64::NAN); S];
    Sh::lengths(&pose, constants, &mut lengths);
    lengths
}

/// Middle times of the step at hand and those after it, one in each lane, and how many of them there
/// are: those of the stretch in which the motion stays in its part. The other lanes repeat the first
/// time, since what is never asked for must not lead an evaluation onto slow ways.
#[inline(always)]
fn steps_to_come<L: Lane>(course: &Course, [t, h]: [L; 2], [step, left]: [usize; 2]) -> (L, usize) {
    // Whole numbers: these sums are exact.
    let begin = L::splat(step as f64) + L::load(&LATER);
    let later = middle(begin, begin + L::splat(1.0), h);
    // The first step's time was handed over.
    let times = L::choose(1, t, later);
    let stretch = if left < L::WIDTH { (1 << left) - 1 } else { L::ALL };
    let stays = stretch & course.holds(times);
    (L::choose(stays, times, t), stays.trailing_ones() as usize)
}

/// Lets the followers of all lanes have what stands in one, or in their own.
#[inline(always)]
fn recall<L: Lane, const S: usize>(course: &Course, lane: Option<usize>, rest: &mut [f64]) {
    let followers = &course.followers[..S];
    let (lengths, rest) = (&course.ahead.lengths[..S * L::WIDTH], &mut rest[..S * L::WIDTH]);
    let Some(lane) = lane else {
        for i in 0..S {
            let (own, place) = (L::load(&lengths[i * L::WIDTH..]), &mut rest[i * L::WIDTH..]);
            L::choose(followers[i], own, L::load(place)).store(place);
        }
        return;
    };
    // What is past the lanes never happens; that it is seen here spares a check for every strand.
    let lane = lane.min(L::WIDTH - 1);
    for i in 0..S {
        if followers[i] != 0 {
            L::splat(lengths[i * L::WIDTH + lane]).store(&mut rest[i * L::WIDTH..]);
        }
    }
}

#[cfg(test)]
mod tests;
