//! The planar part of a way: how it turns about the centre, and whether it touches.

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
        let (points, plain) = match &self.form {
            Form::Sphere => (points, points[0].cross(points[1]).norm_squared().sqrt()),
            Form::Cylinder(axis) => {
                let points = points.map(|point| axis.reject(point));
                (points, axis.triple(points[0], points[1]))
            }
        };
        let squares = points.map(|point| point.norm_squared());
        let cosine = points[0].dot(points[1]);
        let (sign, sine, sure) = match &self.sense {
            None => (one, plain, one),
            Some(sense) => sense.turn(&self.form, points, squares, (plain, cosine)),
        };
        let square = self.radius * self.radius;
        let tangents = squares.map(|p| (p - square).sqrt());
        // (r − iT_p)(r − iT_q) = real − i·imaginary.
        let real = square - tangents[0] * tangents[1];
        let tangent = tangents[0] + tangents[1];
        let imaginary = self.radius * tangent;
        let along = cosine * real + sine * imaginary;
        let across = sine * real - cosine * imaginary;
        // 0 ≤ φ < 2π where the strand touches.
        let angle = (-across).atan2(-along) + S::constant(std::f64::consts::PI);
        let length = tangent + self.radius * angle;
        // A strand that turns by less than half a turn touches if φ > 0; by more, always. Where its
        // sense is lost it has no length.
        let (free, length) = match self.sense {
            None => (-across, length),
            Some(_) => {
                let free = S::select(Comparison::LessEqual, zero, sine, -across, -one);
                let none = S::constant(f64::NAN);
                let kept = |x: S| S::select(Comparison::LessEqual, zero, sure, x, none);
                (kept(free), kept(length))
            }
        };
        Turn { points, squares, tangents, sign, sine, cosine, free, length, sure }
    }
}
