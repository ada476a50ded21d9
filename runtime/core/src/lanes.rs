//! Steps on lanes: which block of which run stands in which lane.
//!
//! A model lists its shapes to a [`LaneStep`]; every pair of a run and a block of that shape takes a
//! lane. So the like fingers of one hand go side by side, and so do the hands of an ensemble. The
//! constants of a vector's lanes are laid side by side once and used until a parameter changes.

use crate::lane::{Lane, Work, call};
use crate::newton::{Start, newton};
use crate::shape::{Place, Shape};
use std::sync::atomic::{AtomicU64, Ordering};

/// Runs that step together at most.
pub const RUNS: usize = 4;

/// Lanes of the widest vector.
const WIDTH: usize = 4;

/// What a step needs of one run, and what it gives back.
#[derive(Debug)]
pub struct LaneRun<'a> {
    /// Coordinates at the beginning.
    pub q: &'a [f64],
    /// Momenta at the beginning.
    pub p: &'a [f64],
    /// Natural lengths at the middle (m).
    pub rest: &'a [f64],
    /// Inputs at the middle.
    pub inputs: &'a [f64],
    /// Time at the middle (s).
    pub t: f64,
    /// Step (s).
    pub h: f64,
    /// Relative tolerance on momenta.
    pub tolerance: f64,
    /// Least size of each coordinate for tolerances (1 rad or the model's length).
    pub size: &'a [f64],
    /// Guess of the increment, replaced by the increment.
    pub delta: &'a mut [f64],
    /// Receives the force at the midpoint.
    pub force: &'a mut [f64],
    /// Newton iterations of the slowest block.
    pub iterations: usize,
    /// Whether a block has not converged, so that the run must step by itself.
    pub failed: bool,
}

/// A stamp that has not been given before, for parameters that have changed.
pub fn next_revision() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(1);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

/// Constants by vector, kept from step to step.
#[derive(Clone, Debug, Default)]
pub struct LaneConstants {
    revisions: [u64; RUNS],
    vectors: Vec<Vec<f64>>,
}

/// A step of up to [`RUNS`] runs of one model.
#[derive(Debug)]
pub struct LaneStep<'a, 'b> {
    runs: &'b mut [LaneRun<'a>],
    constants: &'b mut LaneConstants,
    next_vector: usize,
    fresh: bool,
    unavailable: bool,
}

impl<'a, 'b> LaneStep<'a, 'b> {
    /// A step of `runs`, whose parameters bear the given stamps.
    pub fn new(
        runs: &'b mut [LaneRun<'a>],
        revisions: &[u64],
        constants: &'b mut LaneConstants,
    ) -> Self {
        let mut stamps = [0; RUNS];
        stamps[..revisions.len()].copy_from_slice(revisions);
        let fresh = stamps != constants.revisions;
        if fresh {
            constants.revisions = stamps;
            constants.vectors.clear();
        }
        LaneStep { runs, constants, next_vector: 0, fresh, unavailable: false }
    }

    /// Whether every block has been computed; runs may have failed one by one.
    pub fn is_complete(&self) -> bool {
        !self.unavailable
    }

    /// Takes the step of all blocks of one shape; `constants(r)` holds those of run r, block after
    /// block.
    pub fn blocks<
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
        let lanes = self.runs.len() * places.len();
        let mut first = 0;
        while first < lanes && !self.unavailable {
            let mut jobs = [(0, 0); WIDTH];
            let used = WIDTH.min(lanes - first);
            for (lane, job) in jobs.iter_mut().enumerate() {
                // Lanes that are left over repeat the last job.
                let number = first + lane.min(used - 1);
                *job = (number % self.runs.len(), number / self.runs.len());
            }
            if self.fresh {
                self.constants
                    .vectors
                    .push(vector::<Sh, N, M, Q, S, U>(&jobs, self.runs, places, &constants));
            }
            let vector = Vector::<Sh, N, M, Q, S, U> {
                runs: self.runs,
                places,
                jobs,
                used,
                constants: &self.constants.vectors[self.next_vector],
                shape: std::marker::PhantomData,
            };
            self.unavailable = !call(vector);
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
    jobs: &[(usize, usize); WIDTH],
    runs: &[LaneRun],
    places: &[Place<Q, S, U>],
    constants: &impl Fn(usize) -> &'c [f64],
) -> Vec<f64> {
    let mut vector = Vec::with_capacity((Sh::CONSTANTS + N) * WIDTH);
    for k in 0..Sh::CONSTANTS {
        vector.extend(jobs.iter().map(|&(run, block)| constants(run)[block * Sh::CONSTANTS + k]));
    }
    for i in 0..N {
        vector
            .extend(jobs.iter().map(|&(run, block)| runs[run].size[places[block].coordinates[i]]));
    }
    vector
}

/// One vector's work.
struct Vector<
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
    jobs: [(usize, usize); WIDTH],
    used: usize,
    constants: &'v [f64],
    shape: std::marker::PhantomData<Sh>,
}

impl<
    Sh: Shape<N, M, Q, S, U>,
    const N: usize,
    const M: usize,
    const Q: usize,
    const S: usize,
    const U: usize,
> Work for Vector<'_, '_, Sh, N, M, Q, S, U>
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
            tolerance: zero,
        };
        macro_rules! of {
            ($run:ident, $place:ident: $number:expr) => {
                L::from_lanes(|lane| {
                    let (run, block) = self.jobs[lane];
                    let ($run, $place) = (&self.runs[run], &self.places[block]);
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
            let run = &mut self.runs[run];
            for i in 0..N {
                let c = self.places[block].coordinates[i];
                run.delta[c] = end.delta[i].lane(lane);
                run.force[c] = end.force[i].lane(lane);
            }
            run.iterations = run.iterations.max(end.iterations);
            run.failed |= end.failed >> lane & 1 == 1;
        }
    }
}
