//! The end of a step on lanes: states move on by the increments and forces that were found.

use super::vector::Vector;
use crate::lane::functions::if_less;
use crate::lane::{Lane, Work, call};
use crate::predict::{DEGREES, FADING, shift};
use crate::step::NOTHING;

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
                    let counts = [vector.width, vector.unknowns];
                    advance_lanes::<L>(vector, lane, self.known, counts);
                }
            }
        }
    }
}

/// q1 = q0 + Δq and p1 = p0 + h·f; a coordinate in static equilibrium or internal is left at the
/// middle of the step, where its equation was solved, and carries no momentum. Width of the vector and
/// number of unknowns are told, since those who know them when they are compiled need no checks.
#[inline(always)]
pub(super) fn advance_lanes<L: Lane>(
    vector: &mut Vector,
    lane: usize,
    known: usize,
    [width, unknowns]: [usize; 2],
) {
    let count = unknowns * width;
    let learns = vector.learns(known + 1);
    let h = L::load(&vector.h[lane..]);
    let per_h = L::load(&vector.per_h[lane..]);
    let (q, v, p) = (&mut vector.q[..count], &mut vector.v[..count], &mut vector.p[..count]);
    let (delta, force, past) =
        (&vector.delta[..count], &vector.force[..count], &vector.past[..count]);
    let (share, rate) = (&vector.share[..count], &vector.rate[..count]);
    let per_size = &vector.per_size[..count];
    let differences = &mut vector.differences[..DEGREES * count];
    let mut missed = [L::splat(0.0); DEGREES];
    for i in 0..unknowns {
        let k = i * width + lane;
        let (increment, force) = (L::load(&delta[k..]), L::load(&force[k..]));
        let share = L::load(&share[k..]);
        share.mul_add(increment, L::load(&q[k..])).store(&mut q[k..]);
        let rate = L::load(&rate[k..]) * per_h;
        rate.mul_add(increment, L::load(&past[k..])).store(&mut v[k..]);
        let is_moving = share + share - L::splat(1.0);
        let next_p = h.mul_add(force, L::load(&p[k..]));
        (is_moving * next_p).store(&mut p[k..]);
        let next = shift(increment, &mut differences[k..], count);
        if learns {
            let per_size = L::load(&per_size[k..]);
            for degree in 0..DEGREES {
                let size = next[degree] * per_size;
                missed[degree] = size.mul_add(size, missed[degree]);
            }
        }
    }
    if learns {
        cut_off::<L>([q, p], delta, differences, lane, width);
    }
    let all_missed = &mut vector.missed[..DEGREES * width];
    for degree in 0..DEGREES {
        if degree < known && learns {
            let place = &mut all_missed[degree * width + lane..];
            let faded = L::splat(if degree + 1 < known { FADING } else { 0.0 }) * L::load(place);
            (missed[degree] + faded).store(place);
        }
    }
    for k in (count + lane..vector.q.len()).step_by(width) {
        L::load(&vector.ends[k - count..]).store(&mut vector.q[k..]);
    }
}

/// Makes zeros of coordinates and momenta that are nothing, and of the differences that an increment of
/// nothing leaves. Once in some steps is enough.
#[inline(always)]
fn cut_off<L: Lane>(
    lists: [&mut [f64]; 2],
    delta: &[f64],
    differences: &mut [f64],
    lane: usize,
    width: usize,
) {
    let count = delta.len();
    for list in lists {
        for k in (lane..count).step_by(width) {
            let x = L::load(&list[k..]);
            audible(x, x).store(&mut list[k..]);
        }
    }
    for k in (lane..count).step_by(width) {
        let increment = L::load(&delta[k..]);
        for degree in 0..DEGREES {
            let place = &mut differences[degree * count + k..];
            audible(increment, L::load(place)).store(place);
        }
    }
}

/// `x`, or zero where `by` is nothing.
#[inline(always)]
fn audible<L: Lane>(by: L, x: L) -> L {
    if_less(by.abs(), L::splat(NOTHING), L::splat(0.0), x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_nothing_is_zero() {
        let audible = |x| audible(x, x);
        assert_eq!([1e-51, -1e-51, f64::MIN_POSITIVE / 2.0].map(audible), [0.0; 3]);
        assert_eq!([1e-49, -1e-49, f64::INFINITY].map(audible), [1e-49, -1e-49, f64::INFINITY]);
        assert!(audible(f64::NAN).is_nan());
    }

    #[test]
    fn what_has_died_away_leaves_no_trace() {
        let (mut q, mut p) = ([0.3, 1e-60], [1e-70, 0.2]);
        let mut differences = [1e-80; 2 * DEGREES];
        cut_off::<f64>([&mut q, &mut p], &[0.1, 1e-80], &mut differences, 0, 1);
        assert_eq!((q, p), ([0.3, 0.0], [0.0, 0.2]));
        for degree in differences.chunks(2) {
            assert_eq!(degree, [1e-80, 0.0], "those of the first still count");
        }
    }
}
