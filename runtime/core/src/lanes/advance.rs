//! The end of a step on lanes: states move on by the increments and forces that were found.

use super::vector::Vector;
use crate::lane::{Lane, Work, call};
use crate::predict::{DEGREES, FADING, shift};

/// Moves all vectors on in the runs whose bits are not set.
pub(super) fn advance(vectors: &mut [Vector], known: usize, failed: u8) {
    if failed != 0 || !call(4, Advance { vectors: &mut *vectors, known, failed }) {
        Advance { vectors, known, failed }.run::<f64>();
    }
}

struct Advance<'a> {
    vectors: &'a mut [Vector],
    /// Increments that the differences are made of.
    known: usize,
    failed: u8,
}

impl Work for Advance<'_> {
    /// Some neighbouring lanes at a time, whatever the width of the vectors.
    #[inline(always)]
    fn run<L: Lane>(self) {
        for vector in self.vectors {
            for lane in (0..vector.width).step_by(L::WIDTH) {
                if self.failed >> vector.runs[lane] & 1 == 0 {
                    advance_lanes::<L>(vector, lane, self.known);
                }
            }
        }
    }
}

/// q1 = q0 + Δq and p1 = p0 + h·f; a coordinate in static equilibrium or internal is left at the
/// middle of the step, where its equation was solved, and carries no momentum.
#[inline(always)]
fn advance_lanes<L: Lane>(vector: &mut Vector, lane: usize, known: usize) {
    let (width, count) = (vector.width, vector.unknowns * vector.width);
    let h = L::load(&vector.h[lane..]);
    let per_h = L::splat(1.0) / h;
    let mut missed = [L::splat(0.0); DEGREES];
    for k in (lane..count).step_by(width) {
        let (increment, force) = (L::load(&vector.delta[k..]), L::load(&vector.force[k..]));
        let share = L::load(&vector.share[k..]);
        share.mul_add(increment, L::load(&vector.q[k..])).store(&mut vector.q[k..]);
        let rate = L::load(&vector.rate[k..]) * per_h;
        rate.mul_add(increment, L::load(&vector.past[k..])).store(&mut vector.v[k..]);
        let is_moving = share + share - L::splat(1.0);
        let p = h.mul_add(force, L::load(&vector.p[k..]));
        (is_moving * p).store(&mut vector.p[k..]);
        let next = shift(increment, &mut vector.differences[k..], count);
        let per_size = L::load(&vector.per_size[k..]);
        for degree in 0..DEGREES {
            let size = next[degree] * per_size;
            missed[degree] = size.mul_add(size, missed[degree]);
        }
    }
    for degree in 0..DEGREES.min(known) {
        let place = &mut vector.missed[degree * width + lane..];
        let faded = L::splat(if degree + 1 < known { FADING } else { 0.0 }) * L::load(place);
        (missed[degree] + faded).store(place);
    }
    for k in (count + lane..vector.q.len()).step_by(width) {
        L::load(&vector.ends[k - count..]).store(&mut vector.q[k..]);
    }
}
