//! Strand lengths on lanes.

use super::{Jobs, LaneConstants, LaneVisitor, Schedule};
use crate::lane::{Lane, Work, call};
use crate::shape::{Place, Shape};
use std::marker::PhantomData;

/// Lengths of the strands of one run.
pub(crate) struct LaneLengths<'b> {
    q: &'b [f64],
    lengths: &'b mut [f64],
    schedule: Schedule<'b>,
}

impl<'b> LaneLengths<'b> {
    /// At coordinates `q`, of a run whose parameters bear the given stamp.
    pub(crate) fn new(
        q: &'b [f64],
        lengths: &'b mut [f64],
        revision: u64,
        constants: &'b mut LaneConstants,
    ) -> Self {
        LaneLengths { q, lengths, schedule: Schedule::new(&[revision], constants) }
    }
}

impl LaneVisitor for LaneLengths<'_> {
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
        let (q, lengths) = (self.q, &mut *self.lengths);
        self.schedule.vectors::<Sh, N, M, Q, S, U>(
            1,
            places,
            constants,
            |jobs, used, constants| {
                call(LengthVector::<Sh, N, M, Q, S, U> {
                    q,
                    lengths,
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

/// Lengths in one vector.
struct LengthVector<
    'v,
    Sh,
    const N: usize,
    const M: usize,
    const Q: usize,
    const S: usize,
    const U: usize,
> {
    q: &'v [f64],
    lengths: &'v mut [f64],
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
> Work for LengthVector<'_, Sh, N, M, Q, S, U>
{
    #[inline(always)]
    fn run<L: Lane>(self) {
        let (mut q, mut lengths) = ([L::splat(0.0); Q], [L::splat(0.0); S]);
        for i in 0..Q {
            q[i] = L::from_lanes(|lane| self.q[self.places[self.jobs[lane].1].coordinates[i]]);
        }
        Sh::lengths(&q, self.constants, &mut lengths);
        for (lane, &(_, block)) in self.jobs[..self.used].iter().enumerate() {
            for (i, &strand) in self.places[block].strands.iter().enumerate() {
                self.lengths[strand] = lengths[i].lane(lane);
            }
        }
    }
}
