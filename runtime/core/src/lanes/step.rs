//! A step on lanes: natural lengths measured, increments guessed and found by Newton's method.
//!
//! The states stay as they are until every vector has been solved; see [`super::advance`].

use super::advance::advance_lanes;
use super::course::Courses;
use super::foretell::foretell;
use super::measure::{measure, middle};
use super::vector::Vector;
use super::{LaneVisitor, RUNS};
use crate::internal;
use crate::lane::{Lane, WIDEST, Work, call, load, store};
use crate::newton::{Balances, Kept, LOOK, Memory, Start, direct, newton};
use crate::shape::{Place, Shape};
use std::marker::PhantomData;

/// Steps of all vectors, shape by shape.
pub(super) struct LaneStep<'a> {
    vectors: &'a mut [Vector],
    /// Vectors and shapes that have been seen.
    next: usize,
    shapes: usize,
    /// Motions of the runs.
    courses: &'a [Courses<'a>],
    /// Increments that the lanes remember.
    known: usize,
    /// Steps that are taken one after the other; if none, one step is found but states do not move.
    stretch: Option<usize>,
    /// Runs that could not step, as bits.
    pub(super) failed: u8,
    /// Newton iterations by run.
    pub(super) iterations: [usize; RUNS],
    is_complete: bool,
}

impl<'a> LaneStep<'a> {
    pub(super) fn new(
        vectors: &'a mut [Vector],
        courses: &'a [Courses<'a>],
        known: usize,
        stretch: Option<usize>,
    ) -> Self {
        LaneStep {
            courses,
            stretch,
            is_complete: !vectors.is_empty(),
            vectors,
            next: 0,
            shapes: 0,
            known,
            failed: 0,
            iterations: [0; RUNS],
        }
    }
}

impl LaneVisitor for LaneStep<'_> {
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
        _places: &[Place<Q, S, U>],
        _constants: impl Fn(usize) -> &'c [f64],
    ) {
        let shape = self.shapes;
        self.shapes += 1;
        while let Some(vector) = self.vectors.get_mut(self.next)
            && vector.shape == shape
            && self.is_complete
        {
            self.next += 1;
            let (width, courses, shape) = (vector.width, self.courses, PhantomData);
            let (known, stretch) = (self.known, self.stretch);
            let vector = &mut *vector;
            self.is_complete = call(
                width,
                StepVector::<Sh, N, M, Q, S, U> { vector, courses, known, stretch, shape },
            );
            let vector = &self.vectors[self.next - 1];
            for (lane, &run) in vector.runs[..vector.used].iter().enumerate() {
                self.iterations[run] = self.iterations[run].max(vector.iterations);
                self.failed |= (vector.failed >> lane & 1) << run;
            }
        }
    }

    fn is_complete(&self) -> bool {
        self.is_complete
    }
}

/// The steps in one vector.
struct StepVector<
    'v,
    Sh,
    const N: usize,
    const M: usize,
    const Q: usize,
    const S: usize,
    const U: usize,
> {
    vector: &'v mut Vector,
    courses: &'v [Courses<'v>],
    known: usize,
    stretch: Option<usize>,
    shape: PhantomData<Sh>,
}

impl<
    Sh: Shape<N, M, Q, S, U>,
    const N: usize,
    const M: usize,
    const Q: usize,
    const S: usize,
    const U: usize,
> Work for StepVector<'_, Sh, N, M, Q, S, U>
{
    #[inline(always)]
    fn run<L: Lane>(self) {
        let StepVector { vector, courses, known, stretch, .. } = self;
        let h = L::load(&vector.h);
        vector.iterations = 0;
        vector.begin_stretch();
        let count = stretch.unwrap_or(1);
        for k in 0..count {
            vector.listen::<L>(k);
            if k > 0 {
                let (begin, end) = ((known + k) as f64, (known + k + 1) as f64);
                middle(L::splat(begin), L::splat(end), h).store(&mut vector.t);
            }
            let t = L::load(&vector.t);
            vector.move_courses(t, courses);
            measure::<L, Sh, N, M, Q, S, U>(vector, [t, h], [known + k, count - k]);
            step::<L, Sh, N, M, Q, S, U>(vector, known + k, [t, h]);
            if vector.failed != 0 {
                break;
            }
            if stretch.is_some() {
                advance_lanes::<L>(vector, 0, known + k, [L::WIDTH, N]);
            }
        }
    }
}

/// Finds the step at hand.
// Loops, not closures over `L`: what is not inlined is not made of the vector's instructions.
#[inline(always)]
fn step<
    L: Lane,
    Sh: Shape<N, M, Q, S, U>,
    const N: usize,
    const M: usize,
    const Q: usize,
    const S: usize,
    const U: usize,
>(
    vector: &mut Vector,
    known: usize,
    [t, h]: [L; 2],
) {
    let q = load::<L, Q>(&vector.q);
    for &i in Sh::INTERNAL {
        let last = L::load(&vector.differences[i * L::WIDTH..]);
        let v = L::load(&vector.v[i * L::WIDTH..]);
        internal::past(known, last, v, h).store(&mut vector.past[i * L::WIDTH..]);
    }
    let mut delta = [L::splat(0.0); Q];
    let guessed: [L; N] = match known {
        0 | 1 => {
            let mut increments = load(&vector.v);
            for i in 0..N {
                increments[i] = increments[i] * h;
            }
            increments
        }
        known => foretell::<L, N>(vector, known),
    };
    delta[..N].copy_from_slice(&guessed);
    for i in N..Q {
        delta[i] = L::load(&vector.ends[(i - N) * L::WIDTH..]) - q[i];
    }
    let start = Start::<L, N, Q, S, U> {
        q,
        delta,
        p: load(&vector.p),
        t,
        h,
        per_h: L::load(&vector.per_h),
        rest: load(&vector.rest),
        inputs: load(&vector.inputs),
        size: load(&vector.size),
        per_size: load(&vector.per_size),
        tolerance: L::load(&vector.tolerance),
        past: load(&vector.past),
    };
    let mut balances = vector
        .has_balances
        .then(|| Balances { is: load(&vector.balances), stiffest: load(&vector.stiffest) });
    let mut looks = known.is_multiple_of(LOOK);
    let end = match const { Sh::DIRECT } {
        true => {
            if !std::mem::replace(&mut vector.is_tried, true) {
                vector.trusted = [0.0; WIDEST];
                looks = true;
            }
            let Vector { constants, sensitivity, trusted, .. } = &mut *vector;
            let mut memory = Memory { sensitivity, trusted };
            direct::<L, Sh, N, M, Q, S, U>(&start, constants, &mut memory, &mut balances, looks)
        }
        false => {
            let serves = !vector.renewal.begin(vector.h[0]);
            let Vector { constants, inverse, mass, sensitivity, .. } = &mut *vector;
            let mut kept = Kept { inverse, mass, sensitivity, serves };
            let end = newton::<L, Sh, N, M, Q, S, U>(&start, constants, &mut kept, &mut balances);
            let serves = kept.serves;
            if end.matrices > 0 {
                vector.renewal.made(vector.h[0]);
            }
            vector.renewal.end(end.iterations);
            if !serves {
                vector.renewal.forget();
            }
            end
        }
    };
    if let Some(balances) = balances {
        store(&balances.stiffest, &mut vector.stiffest);
    }
    let mut delta = [L::splat(0.0); N];
    delta.copy_from_slice(&end.delta[..N]);
    store(&delta, &mut vector.delta);
    store(&end.force, &mut vector.force);
    (vector.failed, vector.is_calm) = (end.failed, end.is_calm);
    vector.iterations += end.iterations;
}
