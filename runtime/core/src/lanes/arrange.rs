//! Which block of which run stands in which lane.

use super::course::Follows;
use super::vector::{Counts, Fed, Vector};
use super::{Kinds, LaneVisitor};
use crate::internal::RATE;
use crate::shape::{Place, Shape};

/// Makes the vectors of all shapes.
pub(super) struct Arrange<'a> {
    kinds: &'a Kinds,
    follows: &'a Follows,
    /// How many runs.
    runs: usize,
    /// Lanes of the machine.
    lanes: usize,
    shapes: usize,
    pub(super) vectors: Vec<Vector>,
}

impl<'a> Arrange<'a> {
    pub(super) fn new(kinds: &'a Kinds, follows: &'a Follows, runs: usize, lanes: usize) -> Self {
        Arrange { kinds, follows, runs, lanes, shapes: 0, vectors: Vec::new() }
    }
}

impl LaneVisitor for Arrange<'_> {
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
        let shape = self.shapes;
        self.shapes += 1;
        let jobs = if self.is_complete() { self.runs * places.len() } else { 0 };
        let mut first = 0;
        while first < jobs {
            let left = jobs - first;
            let width = if left > 4 { self.lanes } else { 4 };
            let used = width.min(left);
            // Lanes that are left over repeat the last job.
            let lanes = || {
                (0..width).map(|lane| {
                    let job = first + lane.min(used - 1);
                    (job % self.runs, &places[job / self.runs], job / self.runs)
                })
            };
            let counts = Counts { unknowns: N, coordinates: Q, strands: S, inputs: U };
            let mut vector = Vector::new(shape, [width, used], &counts);
            for (place, (run, ..)) in vector.runs.iter_mut().zip(lanes()) {
                *place = run;
            }
            for i in 0..Q {
                vector.coordinates.extend(lanes().map(|(_, place, _)| place.coordinates[i]));
            }
            for i in 0..S {
                vector.strands.extend(lanes().map(|(_, place, _)| place.strands[i]));
            }
            // What is handed over in the lanes' order: rows of which each lane has one number.
            let fed = |row: usize, index: &dyn Fn(&Place<Q, S, U>) -> usize| -> Vec<Fed> {
                let of = |(lane, (run, place, _))| Fed {
                    place: row * width + lane,
                    run,
                    index: index(place),
                };
                lanes().enumerate().map(of).collect()
            };
            for i in 0..S {
                let row = fed(i, &|place| place.strands[i]);
                let is_fed = |fed: &Fed| self.follows.is_fed(fed.index);
                vector.fed_rest.extend(row.into_iter().filter(is_fed));
            }
            for i in 0..U {
                vector.fed_inputs.extend(fed(i, &|place| place.inputs[i]));
            }
            for i in N..Q {
                vector.fed_ends.extend(fed(i - N, &|place| place.coordinates[i]));
            }
            for k in 0..Sh::CONSTANTS {
                let of = |(run, _, block)| constants(run)[block * Sh::CONSTANTS + k];
                vector.constants.extend(lanes().map(of));
            }
            for &c in &vector.coordinates[..N * width] {
                vector.size.push(self.kinds.size[c]);
                vector.per_size.push(1.0 / self.kinds.size[c]);
                let (is_static, is_internal) = (self.kinds.is_static[c], self.kinds.is_internal[c]);
                vector.share.push(if is_static || is_internal { 0.5 } else { 1.0 });
                vector.rate.push(match (is_static, is_internal) {
                    (true, _) => 0.5,
                    (_, true) => RATE,
                    _ => 1.0,
                });
                vector.balances.push(f64::from(u8::from(is_static)));
            }
            vector.has_balances = vector.balances.contains(&1.0);
            vector.courses = self.follows.courses(&vector);
            self.vectors.push(vector);
            first += used;
        }
    }

    fn is_complete(&self) -> bool {
        self.lanes > 1
    }
}
