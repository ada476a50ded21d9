//! The planar part of a way: how it turns about the centre, and whether it touches.

use super::plane::EVEN;
use super::{Form, Surface};
use crate::vector::Vec3;
use handc_core::scalar::{Comparison, Scalar};

/// The turn about the centre in the plane across the axis, or that of the two points.
pub(super) struct Turn<S> {
    /// The points in that plane.
    pub(super) points: [Vec3<S>; 2],
    /// Their squares p², q².
    pub(super) squares: [S; 2],
    /// Tangents T.
    pub(super) tangents: [S; 2],
    /// 1 or −1: whether the way turns about the axis or p × q, or against it.
    pub(super) sign: S,
    /// pq·sin θ, below zero for more than half a turn.
    pub(super) sine: S,
    /// pq·cos θ.
    pub(super) cosine: S,
    /// Not below zero where the strand does not touch; not a number where a point is inside.
    pub(super) free: S,
    /// T_p + T_q + rφ.
    pub(super) length: S,
    /// Below zero where the sense is lost.
    pub(super) sure: S,
}

impl<S: Scalar> Turn<S> {
    /// `then` where the strand does not touch, else `otherwise`; the latter for what is not a number.
    #[inline]
    pub(super) fn choose(&self, then: S, otherwise: S) -> S {
        S::select(Comparison::LessEqual, S::zero(), self.free, then, otherwise)
    }
    #[inline]
    pub(super) fn choose_vector(&self, then: Vec3<S>, otherwise: Vec3<S>) -> Vec3<S> {
        Vec3([0, 1, 2].map(|i| self.choose(then.0[i], otherwise.0[i])))
    }
}

impl<S: Scalar> Surface<S> {
    /// Turns from the first point to the second, both in the link's axes.
    pub(super) fn turn(&self, points: [Vec3<S>; 2]) -> Turn<S> {
        let (zero, one) = (S::zero(), S::one());
        let points = points.map(|point| point - self.center);
        let flat = points.map(|point| self.form.flat(point));
        let plain = match self.form.axis() {
            None => flat[0].cross(flat[1]).norm_squared().sqrt(),
            Some(axis) => axis.triple(flat[0], flat[1]),
        };
        let beside = match &self.form {
            Form::Ring(axis) => Some(points.map(|point| axis.dot(point))),
            _ => None,
        };
        let points = flat;
        let squares = points.map(|point| point.norm_squared());
        let cosine = points[0].dot(points[1]);
        let (sign, sine, mut sure) = match &self.sense {
            None => (one, plain, one),
            Some(sense) => sense.turn(squares, (plain, cosine)),
        };
        for off in beside.into_iter().flatten().filter(|off| !off.is_known_zero()) {
            let within = self.radius.scale(EVEN) - off.abs();
            sure = S::select(Comparison::Less, within, zero, within, sure);
        }
        let tangents = squares.map(|p| (p - self.radius * self.radius).sqrt());
        // (cos θ + i sin θ)(r − iT_p), then times r − iT_q.
        let (r, [t_p, t_q]) = (self.radius, tangents);
        let (real, imaginary) = (cosine * r + sine * t_p, sine * r - cosine * t_p);
        let along = real * r + imaginary * t_q;
        let across = imaginary * r - real * t_q;
        // A strand that turns by less than half a turn touches if φ > 0; by more, always. Where its
        // sense is lost it has no length.
        let (free, reach) = match self.sense {
            None => (-across, r),
            Some(_) => {
                let free = S::select(Comparison::LessEqual, zero, sine, -across, -one);
                let none = S::constant(f64::NAN);
                let kept = |x: S| S::select(Comparison::LessEqual, zero, sure, x, none);
                (kept(free), kept(r))
            }
        };
        // φ is between 0 and 2π where the strand touches.
        let angle = (-across).atan2(-along);
        let length = (t_p + t_q + reach.scale(std::f64::consts::PI)) + reach * angle;
        Turn { points, squares, tangents, sign, sine, cosine, free, length, sure }
    }
}
