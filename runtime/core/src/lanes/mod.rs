//! Runs on lanes: states that are kept lane by lane while they step.
//!
//! A model shows its shapes to a [`LaneVisitor`]; every pair of a run and a block of that shape takes
//! a lane. So the like fingers of one hand go side by side, and so do the hands of an ensemble. A
//! [`Vector`] holds everything that the steps of its lanes read and write, lane beside lane, from
//! step to step: what the world does is handed to it before a step, and the state is written back
//! when someone wants to see it.

mod advance;
mod arrange;
mod course;
mod evaluate;
mod exchange;
mod foretell;
mod measure;
mod step;
mod vector;

use crate::lane::available;
use crate::model::Model;
use crate::shape::{Place, Shape};
use advance::advance;
use arrange::Arrange;
pub(crate) use course::{Courses, Follows};
pub(crate) use evaluate::{Asked, EvaluationConstants, LaneEvaluation};
pub(crate) use exchange::{Around, TakenUp, Told};
use std::sync::atomic::{AtomicU64, Ordering};
use step::LaneStep;
use vector::Vector;

/// Runs that go together at most.
pub const RUNS: usize = 8;

/// Steps that are taken in one go at most.
const STRETCH: usize = 64;

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

/// What is known of coordinates before any run.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kinds {
    /// Least size for tolerances (1 rad or the model's length).
    pub(crate) size: Vec<f64>,
    /// Whether it is in static equilibrium.
    pub(crate) is_static: Vec<bool>,
    /// Whether it is an [internal variable](crate::internal).
    pub(crate) is_internal: Vec<bool>,
}

/// Runs of one model on lanes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lanes {
    kinds: Kinds,
    follows: Follows,
    vectors: Vec<Vector>,
    /// Whether some follower is on no lane.
    leave_followers: bool,
    /// Stamps of the runs' parameters, and lanes of the machine, for which the vectors were made.
    made_for: ([u64; RUNS], usize),
    /// Steps whose increments the lanes remember.
    known: usize,
    /// Newton iterations of each run in the last steps.
    iterations: [usize; RUNS],
    /// Steps that are still to be taken one by one, since a stretch has failed.
    careful: usize,
}

/// How steps on lanes ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// The model or the machine has no lanes.
    Unavailable,
    /// All runs have taken so many steps.
    Stepped(usize),
    /// The runs whose bits are set could not take one step and are left as they were; the others have
    /// taken it.
    Failed(u8),
}

impl Lanes {
    /// For coordinates of these kinds.
    pub(crate) fn new(kinds: Kinds) -> Self {
        Lanes { kinds, ..Lanes::default() }
    }

    /// The same coordinates and motions, for other runs.
    pub(crate) fn fresh(&self) -> Self {
        let (kinds, follows) = (self.kinds.clone(), self.follows.clone());
        Lanes { kinds, follows, ..Lanes::default() }
    }

    /// From now on the strands of `follows` take their natural lengths from motions.
    pub(crate) fn follow(&mut self, follows: Follows) {
        self.follows = follows;
        self.made_for = Default::default();
    }

    /// Whether the vectors were made for these parameters and this machine. If not they are made now,
    /// with no states in them.
    pub(crate) fn arrange<M: Model>(&mut self, models: &[&M]) -> bool {
        let mut stamps = [0; RUNS];
        for (stamp, model) in stamps.iter_mut().zip(models) {
            *stamp = model.revision();
        }
        let wanted = (stamps, available());
        if self.made_for == wanted {
            return true;
        }
        self.made_for = wanted;
        let mut arrange = Arrange::new(&self.kinds, &self.follows, models.len(), available());
        M::on_lanes(models, &mut arrange);
        self.vectors = arrange.vectors;
        let is_here = |strand| self.vectors.iter().any(|vector| vector.strands.contains(&strand));
        self.leave_followers = !self.follows.followers().all(is_here);
        false
    }

    /// How many of `count` steps may be taken in one go.
    pub(crate) fn reach(&self, count: usize) -> usize {
        if self.careful > 0 { 1 } else { count.min(STRETCH) }
    }

    /// Takes `count` steps, as many as [`Lanes::reach`] allows and the runs were told of, with all runs
    /// of which [`Lanes::arrange`] was asked; one where they do not go in one go.
    pub(crate) fn step<M: Model>(
        &mut self,
        models: &[&M],
        courses: &[Courses],
        count: usize,
    ) -> Outcome {
        let stretch = self.reach(count);
        if stretch > 1 {
            self.vectors.iter_mut().for_each(Vector::save);
            let mut steps = LaneStep::new(&mut self.vectors, courses, self.known, Some(stretch));
            if !M::on_lanes(models, &mut steps) {
                return Outcome::Unavailable;
            }
            if steps.failed == 0 {
                self.iterations = steps.iterations;
                self.known += stretch;
                return Outcome::Stepped(stretch);
            }
            // Vectors have come to different steps: back, and one by one to where it fails.
            self.vectors.iter_mut().for_each(Vector::restore);
            self.careful = STRETCH;
        }
        self.careful = self.careful.saturating_sub(1);
        let mut step = LaneStep::new(&mut self.vectors, courses, self.known, None);
        if !M::on_lanes(models, &mut step) {
            return Outcome::Unavailable;
        }
        let failed = step.failed;
        self.iterations = step.iterations;
        advance(&mut self.vectors, self.known, failed);
        self.known += 1;
        if failed == 0 { Outcome::Stepped(1) } else { Outcome::Failed(failed) }
    }

    /// Newton iterations of a run in the last steps.
    pub(crate) fn iterations(&self, run: usize) -> usize {
        self.iterations[run]
    }
}
