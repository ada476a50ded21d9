//! A step on lanes: natural lengths measured, increments guessed and found by Newton's method.
//!
//! The states stay as they are until every vector has been solved; see [`super::advance`].

use super::foretell::foretell;
use super::vector::Vector;
use super::{LaneVisitor, RUNS};
use crate::internal;
use crate::lane::{Lane, Work, call};
use crate::newton::{Balances, Kept, Start, newton};
use crate::shape::{Place, Shape};
use std::marker::PhantomData;

/// A step of all vectors, shape by shape.
pub(super) struct LaneStep<'a> {
    vectors: &'a mut [Vector],
    /// Vectors and shapes that have been seen.
    next: usize,
    shapes: usize,
    /// Increments that the lanes remember.
    known: usize,
    /// Runs that could not step, as bits.
    pub(super) failed: u8,
    /// Newton iterations by run.
    pub(super) iterations: [usize; RUNS],
    is_complete: bool,
}

impl<'a> LaneStep<'a> {
    pub(super) fn new(vectors: &'a mut [Vector], known: usize) -> Self {
        LaneStep {
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
            let (width, known, shape) = (vector.width, self.known, PhantomData);
            let work = StepVector::<Sh, N, M, Q, S, U> { vector: &mut *vector, known, shape };
            self.is_complete = call(width, work);
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

/// The step in one vector.
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
    known: usize,
    shape: PhantomData<Sh>,
}

/// The first numbers of a list, each in all lanes.
#[inline(always)]
pub(super) fn load<L: Lane, const N: usize>(list: &[f64]) -> [L; N] {
    let list = &list[..N * L::WIDTH];
    let mut all = [L::splat(0.0); N];
    for i in 0..N {
        all[i] = L::load(&list[i * L::WIDTH..]);
    }
    all
}

/// The other way.
#[inline(always)]
pub(super) fn store<L: Lane, const N: usize>(all: &[L; N], list: &mut [f64]) {
    let list = &mut list[..N * L::WIDTH];
    for i in 0..N {
        all[i].store(&mut list[i * L::WIDTH..]);
    }
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
    // Loops, not closures over `L`: what is not inlined is not made of the vector's instructions.
    #[inline(always)]
    fn run<L: Lane>(self) {
        let vector = self.vector;
        let (t, h) = (L::load(&vector.t), L::load(&vector.h));
        measure::<L, Sh, N, M, Q, S, U>(vector, t);
        let q = load::<L, Q>(&vector.q);
        for &i in Sh::INTERNAL {
            let last = L::load(&vector.differences[i * L::WIDTH..]);
            let v = L::load(&vector.v[i * L::WIDTH..]);
            internal::past(self.known, last, v, h).store(&mut vector.past[i * L::WIDTH..]);
        }
        let mut delta = [L::splat(0.0); Q];
        let guessed: [L; N] = match self.known {
            0 | 1 => {
                let mut increments = load(&vector.v);
                for i in 0..N {
                    increments[i] = increments[i] * h;
                }
                increments
            }
            known => foretell::<L, N, M>(vector, known),
        };
        for i in 0..N {
            delta[i] = guessed[i];
        }
        for i in N..Q {
            delta[i] = L::load(&vector.ends[(i - N) * L::WIDTH..]) - q[i];
        }
        let start = Start::<L, N, Q, S, U> {
            q,
            delta,
            p: load(&vector.p),
            t,
            h,
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
        if vector.made_for != vector.h {
            vector.renewal.forget();
        }
        let mut kept = Kept::<L, N, M> {
            inverse: load(&vector.inverse),
            sensitivity: load(&vector.sensitivity),
            serves: !vector.renewal.begin(vector.h[0]),
        };
        let constants = &vector.constants;
        let end = newton::<L, Sh, N, M, Q, S, U>(&start, constants, &mut kept, &mut balances);
        store(&kept.inverse, &mut vector.inverse);
        store(&kept.sensitivity, &mut vector.sensitivity);
        if end.matrices > 0 {
            vector.renewal.made(vector.h[0]);
            vector.made_for = vector.h;
        }
        vector.renewal.end(end.iterations);
        if !kept.serves {
            vector.renewal.forget();
        }
        if let Some(balances) = balances {
            store(&balances.stiffest, &mut vector.stiffest);
        }
        let mut delta = [L::splat(0.0); N];
        for i in 0..N {
            delta[i] = end.delta[i];
        }
        store(&delta, &mut vector.delta);
        store(&end.force, &mut vector.force);
        (vector.failed, vector.iterations) = (end.failed, end.iterations);
    }
}

/// Measures the natural lengths of strands that follow motions.
#[inline(always)]
fn measure<
    L: Lane,
    Sh: Shape<N, M, Q, S, U>,
    const N: usize,
    const M: usize,
    const Q: usize,
    const S: usize,
    const U: usize,
>(
    vector: &mut Vector,
    t: L,
) {
    for course in &mut vector.courses {
        if !course.is_due() {
            continue;
        }
        let passed = (t - L::load(&course.begins)) * L::load(&course.per_duration);
        let (_, cosine) = (L::splat(std::f64::consts::PI) * passed).sin_cos();
        let weight = L::splat(0.5) * (L::splat(1.0) - cosine);
        let (mut pose, change) = (load::<L, Q>(&course.from), load::<L, Q>(&course.change));
        for i in 0..Q {
            pose[i] = change[i].mul_add(weight, pose[i]);
        }
        // A strand that spans no block stays unmeasured, which no step survives.
        let mut lengths = [L::splat(f64::NAN); S];
        Sh::lengths(&pose, &vector.constants, &mut lengths);
        let mut rest = load::<L, S>(&vector.rest);
        let followers = &course.followers[..S];
        for i in 0..S {
            rest[i] = L::choose(followers[i], lengths[i], rest[i]);
        }
        store(&rest, &mut vector.rest);
        course.is_measured = true;
    }
}
