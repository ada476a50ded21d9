//! Work on lanes: which block of which run stands in which lane.
//!
//! A model shows its shapes to a [`LaneVisitor`]; every pair of a run and a block of that shape takes
//! a lane. So the like fingers of one hand go side by side, and so do the hands of an ensemble. The
//! constants of a vector's lanes are laid side by side once and used until a parameter changes.

mod evaluate;
mod lengths;
mod step;

use crate::lane::WIDEST;
use crate::shape::{Place, Shape};
pub(crate) use evaluate::{Asked, LaneEvaluation};
pub(crate) use lengths::LaneLengths;
use std::sync::atomic::{AtomicU64, Ordering};
pub(crate) use step::{LaneRun, LaneStep};

/// Runs that go together at most.
pub const RUNS: usize = 4;

/// A run and a block for every lane.
type Jobs = [(usize, usize); WIDEST];

/// A stamp that has not been given before, for parameters that have changed.
pub fn next_revision() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(1);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

/// What is done with all blocks of one shape after another.
pub trait LaneVisitor {
    /// Does it with the blocks at `places`; `constants(r)` holds those of run r, block after block.
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
    );

    /// Whether it could be done: the processor may have no lanes.
    fn is_complete(&self) -> bool;
}

/// Constants by vector, kept from step to step.
#[derive(Clone, Debug, Default)]
pub(crate) struct LaneConstants {
    /// Least size of each coordinate for tolerances (1 rad or the model's length).
    size: Vec<f64>,
    revisions: [u64; RUNS],
    vectors: Vec<Vec<f64>>,
}

impl LaneConstants {
    /// The same sizes, and no constants yet.
    pub(crate) fn fresh(&self) -> Self {
        LaneConstants::new(self.size.clone())
    }

    /// None yet, for coordinates of these sizes.
    pub(crate) fn new(size: Vec<f64>) -> Self {
        LaneConstants { size, ..LaneConstants::default() }
    }
}

/// Goes through the vectors in order.
struct Schedule<'b> {
    constants: &'b mut LaneConstants,
    next_vector: usize,
    fresh: bool,
    unavailable: bool,
}

impl<'b> Schedule<'b> {
    fn new(revisions: &[u64], constants: &'b mut LaneConstants) -> Self {
        let mut stamps = [0; RUNS];
        stamps[..revisions.len()].copy_from_slice(revisions);
        let fresh = stamps != constants.revisions;
        if fresh {
            constants.revisions = stamps;
            constants.vectors.clear();
        }
        Schedule { constants, next_vector: 0, fresh, unavailable: false }
    }

    /// Hands every vector of a shape's jobs to `work`: jobs, how many count, and constants.
    #[inline(always)]
    fn vectors<
        'c,
        Sh: Shape<N, M, Q, S, U>,
        const N: usize,
        const M: usize,
        const Q: usize,
        const S: usize,
        const U: usize,
    >(
        &mut self,
        runs: usize,
        places: &[Place<Q, S, U>],
        constants: impl Fn(usize) -> &'c [f64],
        mut work: impl FnMut(&Jobs, usize, &[f64]) -> bool,
    ) {
        let lanes = runs * places.len();
        let mut first = 0;
        while first < lanes && !self.unavailable {
            let mut jobs = [(0, 0); WIDEST];
            let used = WIDEST.min(lanes - first);
            for (lane, job) in jobs.iter_mut().enumerate() {
                // Lanes that are left over repeat the last job.
                let number = first + lane.min(used - 1);
                *job = (number % runs, number / runs);
            }
            if self.fresh {
                let size = &self.constants.size;
                let made = vector::<Sh, N, M, Q, S, U>(&jobs, size, places, &constants);
                self.constants.vectors.push(made);
            }
            self.unavailable = !work(&jobs, used, &self.constants.vectors[self.next_vector]);
            self.next_vector += 1;
            first += used;
        }
    }
}

/// The constants of the jobs lane beside lane, and after them the sizes of their coordinates.
fn vector<
    'c,
    Sh: Shape<N, M, Q, S, U>,
    const N: usize,
    const M: usize,
    const Q: usize,
    const S: usize,
    const U: usize,
>(
    jobs: &Jobs,
    size: &[f64],
    places: &[Place<Q, S, U>],
    constants: &impl Fn(usize) -> &'c [f64],
) -> Vec<f64> {
    let mut vector = Vec::with_capacity((Sh::CONSTANTS + N) * WIDEST);
    for k in 0..Sh::CONSTANTS {
        vector.extend(jobs.iter().map(|&(run, block)| constants(run)[block * Sh::CONSTANTS + k]));
    }
    for i in 0..N {
        vector.extend(jobs.iter().map(|&(_, block)| size[places[block].coordinates[i]]));
    }
    vector
}
