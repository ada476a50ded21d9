//! A step on lanes: numbers gathered from the runs, Newton's method, results scattered.

use super::{Jobs, LaneConstants, LaneVisitor, Schedule};
use crate::lane::{Lane, Work, call};
use crate::newton::{Start, newton};
use crate::shape::{Place, Shape};
use std::marker::PhantomData;

/// What a step needs of one run, and what it gives back.
#[derive(Debug)]
pub(crate) struct LaneRun<'a> {
    /// Coordinates at the beginning.
    pub(crate) q: &'a [f64],
    /// Momenta at the beginning.
    pub(crate) p: &'a [f64],
    /// Natural lengths at the middle (m).
    pub(crate) rest: &'a [f64],
    /// Inputs at the middle.
    pub(crate) inputs: &'a [f64],
    /// Time at the middle (s).
    pub(crate) t: f64,
    /// Step (s).
    pub(crate) h: f64,
    /// Relative tolerance on momenta.
    pub(crate) tolerance: f64,
    /// What past steps add to the rates of internal coordinates.
    pub(crate) past: &'a [f64],
    /// Guess of the increment, replaced by the increment.
    pub(crate) delta: &'a mut [f64],
    /// Receives the force at the midpoint.
    pub(crate) force: &'a mut [f64],
    /// Newton iterations of the slowest block.
    pub(crate) iterations: usize,
    /// Whether a block has not converged, so that the run must step by itself.
    pub(crate) failed: bool,
}

/// A step of up to [`RUNS`] runs of one model.
pub(crate) struct LaneStep<'a, 'b> {
    runs: &'b mut [LaneRun<'a>],
    schedule: Schedule<'b>,
}

impl<'a, 'b> LaneStep<'a, 'b> {
    /// A step of `runs`, whose parameters bear the given stamps.
    pub(crate) fn new(
        runs: &'b mut [LaneRun<'a>],
        revisions: &[u64],
        constants: &'b mut LaneConstants,
    ) -> Self {
        LaneStep { runs, schedule: Schedule::new(revisions, constants) }
    }
}

impl LaneVisitor for LaneStep<'_, '_> {
    #[inline]
    fn blocks<
        'c,
        Sh: Shape<N, M, Q, S, U>,
        const N: usize,
        const M: usize,
        const Q: usize,
        const S: usize,
        const U: usize,
    >(
        &mut self,
        places: &[Place<Q, S, U>],
        constants: impl Fn(usize) -> &'c [f64],
    ) {
        let runs = &mut *self.runs;
        self.schedule.vectors::<Sh, N, M, Q, S, U>(
            runs.len(),
            places,
            constants,
            |jobs, used, constants| {
                call(StepVector::<Sh, N, M, Q, S, U> {
                    runs,
                    places,
                    jobs,
                    used,
                    constants,
                    shape: PhantomData,
                })
            },
        );
    }

    fn is_complete(&self) -> bool {
        !self.schedule.unavailable
    }
}

/// The step in one vector.
struct StepVector<
    'v,
    'a,
    Sh,
    const N: usize,
    const M: usize,
    const Q: usize,
    const S: usize,
    const U: usize,
> {
    runs: &'v mut [LaneRun<'a>],
    places: &'v [Place<Q, S, U>],
    jobs: &'v Jobs,
    used: usize,
    constants: &'v [f64],
    shape: PhantomData<Sh>,
}

impl<
    Sh: Shape<N, M, Q, S, U>,
    const N: usize,
    const M: usize,
    const Q: usize,
    const S: usize,
    const U: usize,
> Work for StepVector<'_, '_, Sh, N, M, Q, S, U>
{
    #[inline(always)]
    fn run<L: Lane>(self) {
        let (constants, sizes) = self.constants.split_at(Sh::CONSTANTS * L::WIDTH);
        // Loops, not closures over `L`: what is not inlined is not made of the vector's instructions.
        let zero = L::splat(0.0);
        let mut start = Start::<L, N, Q, S, U> {
            q: [zero; Q],
            delta: [zero; Q],
            p: [zero; N],
            t: zero,
            h: zero,
            rest: [zero; S],
            inputs: [zero; U],
            size: [zero; N],
            past: [zero; N],
            tolerance: zero,
        };
        let lanes = self.jobs.map(|(run, block)| (&self.runs[run], &self.places[block]));
        macro_rules! of {
            ($run:ident, $place:ident: $number:expr) => {
                L::from_lanes(|lane| {
                    let ($run, $place) = lanes[lane];
                    $number
                })
            };
        }
        for i in 0..Q {
            start.q[i] = of!(run, place: run.q[place.coordinates[i]]);
            start.delta[i] = of!(run, place: run.delta[place.coordinates[i]]);
        }
        for i in 0..N {
            start.p[i] = of!(run, place: run.p[place.coordinates[i]]);
            start.size[i] = L::load(&sizes[i * L::WIDTH..]);
        }
        for &i in Sh::INTERNAL {
            start.past[i] = of!(run, place: run.past[place.coordinates[i]]);
        }
        for i in 0..S {
            start.rest[i] = of!(run, place: run.rest[place.strands[i]]);
        }
        for i in 0..U {
            start.inputs[i] = of!(run, place: run.inputs[place.inputs[i]]);
        }
        start.t = of!(run, _place: run.t);
        start.h = of!(run, _place: run.h);
        start.tolerance = of!(run, _place: run.tolerance);
        let end = newton::<L, Sh, N, M, Q, S, U>(&start, constants);
        for (lane, &(run, block)) in self.jobs[..self.used].iter().enumerate() {
            let (run, place) = (&mut self.runs[run], &self.places[block]);
            for i in 0..N {
                let c = place.coordinates[i];
                run.delta[c] = end.delta[i].lane(lane);
                run.force[c] = end.force[i].lane(lane);
            }
            run.iterations = run.iterations.max(end.iterations);
            run.failed |= end.failed >> lane & 1 == 1;
        }
    }
}
