//! Momentum, force and Newton matrix on lanes, for Newton's method number by number.

use super::LaneVisitor;
use crate::lane::{Lane, WIDEST, Work, available, call};
use crate::model::Midpoint;
use crate::shape::{Local, Place, Shape};
use std::marker::PhantomData;

/// What is asked at a midpoint of one run.
#[derive(Debug)]
pub(crate) struct Asked<'a> {
    /// Where.
    pub(crate) at: Midpoint<'a>,
    /// Receives ∂L/∂q̇.
    pub(crate) momentum: &'a mut [f64],
    /// Receives ∂L/∂q + F.
    pub(crate) force: &'a mut [f64],
    /// Step (s), and the packed Newton matrix to be written, if it is wanted.
    pub(crate) matrix: Option<(f64, &'a mut [f64])>,
}

/// Constants of the vectors, laid out for one set of parameters.
#[derive(Clone, Debug, Default)]
pub(crate) struct EvaluationConstants {
    /// Stamp of the parameters, and lanes of the machine.
    made_for: (u64, usize),
    vectors: Vec<Vec<f64>>,
}

/// Evaluates all parts of one run's equations.
pub(crate) struct LaneEvaluation<'a, 'b> {
    asked: Asked<'a>,
    constants: &'b mut EvaluationConstants,
    /// Whether the constants are to be laid out.
    is_fresh: bool,
    next: usize,
    is_complete: bool,
}

impl<'a, 'b> LaneEvaluation<'a, 'b> {
    /// For a run whose parameters bear the given stamp.
    pub(crate) fn new(
        asked: Asked<'a>,
        revision: u64,
        constants: &'b mut EvaluationConstants,
    ) -> Self {
        let wanted = (revision, available());
        let is_fresh = constants.made_for != wanted;
        if is_fresh {
            constants.made_for = wanted;
            constants.vectors.clear();
        }
        LaneEvaluation { asked, constants, is_fresh, next: 0, is_complete: available() > 1 }
    }
}

impl LaneVisitor for LaneEvaluation<'_, '_> {
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
        let mut first = 0;
        while first < places.len() && self.is_complete {
            let left = places.len() - first;
            let width = if left > 4 { available() } else { 4 };
            let used = width.min(left);
            // Lanes that are left over repeat the last part.
            let parts: [usize; WIDEST] = std::array::from_fn(|lane| first + lane.min(used - 1));
            if self.is_fresh {
                let mut all = Vec::with_capacity(Sh::CONSTANTS * width);
                for k in 0..Sh::CONSTANTS {
                    let own = |&part: &usize| constants(0)[part * Sh::CONSTANTS + k];
                    all.extend(parts[..width].iter().map(own));
                }
                self.constants.vectors.push(all);
            }
            let (asked, constants) = (&mut self.asked, &self.constants.vectors[self.next][..]);
            let shape = PhantomData::<Sh>;
            let parts = &parts;
            let work = EvaluationVector { asked, places, parts, used, constants, shape };
            self.is_complete = call(width, work);
            self.next += 1;
            first += used;
        }
    }

    fn is_complete(&self) -> bool {
        self.is_complete
    }
}

/// The evaluation in one vector.
struct EvaluationVector<
    'v,
    'a,
    Sh,
    const N: usize,
    const M: usize,
    const Q: usize,
    const S: usize,
    const U: usize,
> {
    asked: &'v mut Asked<'a>,
    places: &'v [Place<Q, S, U>],
    parts: &'v [usize; WIDEST],
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
> Work for EvaluationVector<'_, '_, Sh, N, M, Q, S, U>
{
    #[inline(always)]
    fn run<L: Lane>(self) {
        let Asked { at, momentum, force, matrix } = self.asked;
        let zero = L::splat(0.0);
        let lanes = self.parts.map(|part| &self.places[part]);
        let mut local = Local::<L, Q, S, U> {
            q: [zero; Q],
            v: [zero; Q],
            t: L::splat(at.t),
            h: zero,
            rest: [zero; S],
            inputs: [zero; U],
        };
        // Loops, not closures over `L`: what is not inlined is not made of the vector's instructions.
        for i in 0..Q {
            local.q[i] = L::from_lanes(|lane| at.q[lanes[lane].coordinates[i]]);
            local.v[i] = L::from_lanes(|lane| at.v[lanes[lane].coordinates[i]]);
        }
        for i in 0..S {
            local.rest[i] = L::from_lanes(|lane| at.rest[lanes[lane].strands[i]]);
        }
        for i in 0..U {
            local.inputs[i] = L::from_lanes(|lane| at.inputs[lanes[lane].inputs[i]]);
        }
        let (mut p, mut f) = ([zero; N], [zero; N]);
        if let Some((h, matrix)) = matrix {
            local.h = L::splat(*h);
            let mut own = [zero; M];
            Sh::evaluate_with_matrix(&local, self.constants, &mut p, &mut f, &mut own);
            for (lane, place) in lanes[..self.used].iter().enumerate() {
                for i in 0..N {
                    let row = &mut matrix[place.matrix + i * place.width..][..N];
                    for j in 0..N {
                        row[j] = own[i * N + j].lane(lane);
                    }
                }
            }
        } else {
            Sh::evaluate(&local, self.constants, &mut p, &mut f);
        }
        for (lane, place) in lanes[..self.used].iter().enumerate() {
            for i in 0..N {
                momentum[place.coordinates[i]] = p[i].lane(lane);
                force[place.coordinates[i]] = f[i].lane(lane);
            }
        }
    }
}
