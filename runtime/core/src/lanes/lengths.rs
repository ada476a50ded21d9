//! Strand lengths on lanes.

use super::{Jobs, LaneConstants, LaneVisitor, Schedule};
use crate::lane::{Lane, Work, call};
use crate::shape::{Place, Shape};
use std::marker::PhantomData;

/// Coordinates of a run, and the lengths of its strands to be.
pub(crate) type Measured<'a> = (&'a [f64], &'a mut [f64]);

/// Lengths of the strands of some runs.
pub(crate) struct LaneLengths<'a, 'b> {
    runs: &'b mut [Measured<'a>],
    schedule: Schedule<'b>,
}

impl<'a, 'b> LaneLengths<'a, 'b> {
    /// Of runs whose parameters bear the given stamps.
    pub(crate) fn new(
        runs: &'b mut [Measured<'a>],
        revisions: &[u64],
        constants: &'b mut LaneConstants,
    ) -> Self {
        LaneLengths { runs, schedule: Schedule::new(revisions, constants) }
    }
}

impl LaneVisitor for LaneLengths<'_, '_> {
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
            |width, jobs, used, constants| {
                call(
                    width,
                    LengthVector::<Sh, N, M, Q, S, U> {
                        runs,
                        places,
                        jobs,
                        used,
                        constants,
                        shape: PhantomData,
                    },
                )
            },
        );
    }

    fn is_complete(&self) -> bool {
        !self.schedule.unavailable
    }
}

/// Lengths in one vector.
struct LengthVector<
    'v,
    'a,
    Sh,
    const N: usize,
    const M: usize,
    const Q: usize,
    const S: usize,
    const U: usize,
> {
    runs: &'v mut [Measured<'a>],
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
> Work for LengthVector<'_, '_, Sh, N, M, Q, S, U>
{
    #[inline(always)]
    fn run<L: Lane>(self) {
        let (mut q, mut lengths) = ([L::splat(0.0); Q], [L::splat(0.0); S]);
        let lanes = self.jobs.map(|(run, block)| (self.runs[run].0, &self.places[block]));
        for i in 0..Q {
            q[i] = L::from_lanes(|lane| {
                let (q, place) = lanes[lane];
                q[place.coordinates[i]]
            });
        }
        Sh::lengths(&q, self.constants, &mut lengths);
        for (lane, &(run, block)) in self.jobs[..self.used].iter().enumerate() {
            for (i, &strand) in self.places[block].strands.iter().enumerate() {
                self.runs[run].1[strand] = lengths[i].lane(lane);
            }
        }
    }
}
