//! The distance between two points on different links, with exact derivatives.
//!
//! A segment is evaluated in the axes of the link midway between its ends, so that it depends on
//! nothing but the joints between them. Writing w for the (signed) axis of a joint, r for the motion
//! of the end on its side by its coordinate, P for p₂ − p₁ and d for its length,
//!
//! d_j = ±P·r_j/d,  d_jk = (D_jk − d_j d_k)/d
//!
//! with + on the second side, D_jk = −r_j·r_k across the middle and D_jk = s_j·r_k on one side, j the
//! joint nearer the middle and s_j the motion of the other end, were it carried by joint j.
//! Over a single hinge d² = K − 2y with y = A cos q + B sin q, which needs no vectors at all.

use super::Mechanics;
use super::world::rotate_vector;
use crate::resolved::Joint;
use crate::structure::{PathStep, SegmentPath};
use crate::vector::Vec3;
use handc_core::scalar::Scalar;

/// How much of a segment is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Order {
    /// Its length.
    Length,
    /// And first derivatives.
    First,
    /// And second derivatives.
    Second,
}

/// A joint between the ends of a segment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing<S> {
    /// Whether the joint rotates.
    rotates: bool,
    /// Signed axis in the middle's axes.
    axis: Vec3<S>,
    /// The end on this side, from the joint.
    arm: Vec3<S>,
    /// Advance along the axis, if any.
    advance: Option<S>,
    /// r: motion of the end.
    motion: Vec3<S>,
    /// s: motion of the other end, were it carried too.
    other: Vec3<S>,
    /// d_j.
    pub(crate) length_dq: S,
}

/// Results of one segment, and scratch.
#[derive(Clone, Debug)]
pub(crate) struct Segment<S> {
    /// Distance.
    pub(crate) length: S,
    /// Joints crossed: those of the first side, then those of the second, innermost last on each.
    pub(crate) crossings: Vec<Crossing<S>>,
    /// d_jk, lower triangle, row by row of `crossings`, if wanted.
    pub(crate) length_dqdq: Vec<S>,
}

impl<S: Scalar> Segment<S> {
    pub(crate) fn new() -> Self {
        Segment { length: S::zero(), crossings: Vec::new(), length_dqdq: Vec::new() }
    }
}

/// Length over a hinge of sine and cosine (s, c), and its first and second derivative.
#[inline]
pub(crate) fn hinge_segment<S: Scalar>(
    (cosine, sine, constant): (S, S, S),
    (s, c): (S, S),
    order: Order,
) -> (S, S, S) {
    let y = cosine * c + sine * s;
    let length = (constant - y.scale(2.0)).sqrt();
    if order == Order::Length {
        return (length, S::zero(), S::zero());
    }
    let inverse = length.recip();
    let length_dq = (cosine * s - sine * c) * inverse;
    if order == Order::First {
        return (length, length_dq, S::zero());
    }
    (length, length_dq, (y - length_dq * length_dq) * inverse)
}

impl<S: Scalar> Mechanics<'_, S> {
    /// Length of a segment between two points, with derivatives up to `order`.
    pub(crate) fn segment(
        &self,
        sin_cos: &[(S, S)],
        q: &[S],
        path: &SegmentPath,
        (first, second): (Vec3<S>, Vec3<S>),
        order: Order,
        out: &mut Segment<S>,
    ) {
        out.crossings.clear();
        out.length_dqdq.clear();
        if order == Order::Length {
            let p1 = self.place_along(sin_cos, q, &path.first, first);
            let p2 = self.place_along(sin_cos, q, &path.second, second);
            out.length = (p2 - p1).norm_squared().sqrt();
            return;
        }
        let p1 = self.walk(sin_cos, q, &path.first, first, &mut out.crossings, 0);
        let split = out.crossings.len();
        let p2 = self.walk(sin_cos, q, &path.second, second, &mut out.crossings, split);
        let difference = p2 - p1;
        out.length = difference.norm_squared().sqrt();
        let inverse = out.length.recip();
        let (before, after) = out.crossings.split_at_mut(split);
        for crossing in before {
            crossing.arrive(difference);
            crossing.length_dq = -(difference.dot(crossing.motion) * inverse);
        }
        for crossing in after {
            crossing.arrive(-difference);
            crossing.length_dq = difference.dot(crossing.motion) * inverse;
        }
        if order != Order::Second {
            return;
        }
        for (i, nearer) in out.crossings.iter().enumerate() {
            for (j, outer) in out.crossings[..=i].iter().enumerate() {
                let square = if (i < split) == (j < split) {
                    nearer.other.dot(outer.motion)
                } else {
                    -nearer.motion.dot(outer.motion)
                };
                let bend = (square - nearer.length_dq * outer.length_dq) * inverse;
                out.length_dqdq.push(bend);
            }
        }
    }

    /// Takes a point along a path.
    fn place_along(
        &self,
        sin_cos: &[(S, S)],
        q: &[S],
        steps: &[PathStep],
        point: Vec3<S>,
    ) -> Vec3<S> {
        let mut p = point;
        for step in steps {
            let link = step.link() as usize;
            let joint = &self.numbers.joints[link];
            let (s, c) = sin_cos[link];
            let slide = joint.advance.map(|advance| {
                joint.axis.vector().scale(q[self.structure.coordinate_of[link]] * advance)
            });
            match step {
                PathStep::Up(_) => {
                    if joint.rotates {
                        p = rotate_vector(&joint.axis, (s, c), p);
                    }
                    if let Some(slide) = slide {
                        p += slide;
                    }
                    if let Some(rotation) = &joint.rotation {
                        p = *rotation * p;
                    }
                    p += joint.origin;
                }
                PathStep::Down(_) => {
                    p -= joint.origin;
                    if let Some(rotation) = &joint.rotation {
                        p = rotation.transpose_mul(p);
                    }
                    if let Some(slide) = slide {
                        p -= slide;
                    }
                    if joint.rotates {
                        p = rotate_vector(&joint.axis, (-s, c), p);
                    }
                }
            }
        }
        p
    }

    /// Takes a point along a path; crossings from `start` on are turned with it.
    fn walk(
        &self,
        sin_cos: &[(S, S)],
        q: &[S],
        steps: &[PathStep],
        point: Vec3<S>,
        crossings: &mut Vec<Crossing<S>>,
        start: usize,
    ) -> Vec3<S> {
        let mut p = point;
        for step in steps {
            let link = step.link() as usize;
            let joint = &self.numbers.joints[link];
            let (s, c) = sin_cos[link];
            let axis = joint.axis.vector();
            let slide = joint
                .advance
                .map(|advance| axis.scale(q[self.structure.coordinate_of[link]] * advance));
            match step {
                PathStep::Up(_) => {
                    if joint.rotates {
                        p = rotate_vector(&joint.axis, (s, c), p);
                        turn_all(&mut crossings[start..], |v| {
                            rotate_vector(&joint.axis, (s, c), v)
                        });
                    }
                    crossings.push(Crossing::new(joint, axis, p));
                    if let Some(slide) = slide {
                        p += slide;
                    }
                    if let Some(rotation) = &joint.rotation {
                        p = *rotation * p;
                        turn_all(&mut crossings[start..], |v| *rotation * v);
                    }
                    p += joint.origin;
                }
                PathStep::Down(_) => {
                    p -= joint.origin;
                    if let Some(rotation) = &joint.rotation {
                        p = rotation.transpose_mul(p);
                        turn_all(&mut crossings[start..], |v| rotation.transpose_mul(v));
                    }
                    if let Some(slide) = slide {
                        p -= slide;
                    }
                    if joint.rotates {
                        p = rotate_vector(&joint.axis, (-s, c), p);
                        turn_all(&mut crossings[start..], |v| {
                            rotate_vector(&joint.axis, (-s, c), v)
                        });
                    }
                    crossings.push(Crossing::new(joint, -axis, p));
                }
            }
        }
        p
    }
}

#[inline]
fn turn_all<S: Scalar>(crossings: &mut [Crossing<S>], turn: impl Fn(Vec3<S>) -> Vec3<S>) {
    for crossing in crossings {
        crossing.axis = turn(crossing.axis);
        crossing.arm = turn(crossing.arm);
    }
}

impl<S: Scalar> Crossing<S> {
    /// The joint just crossed by the point `p`, given in the joint's own axes.
    #[inline]
    fn new(joint: &Joint<S>, axis: Vec3<S>, p: Vec3<S>) -> Self {
        let zero = Vec3::zero();
        Crossing {
            rotates: joint.rotates,
            axis,
            arm: p,
            advance: joint.advance,
            motion: zero,
            other: zero,
            length_dq: S::zero(),
        }
    }
    /// Works out r and s in the middle, where the other end is `beyond` this one.
    #[inline]
    fn arrive(&mut self, beyond: Vec3<S>) {
        let slide = self.advance.map_or_else(Vec3::zero, |advance| self.axis.scale(advance));
        (self.motion, self.other) = (slide, slide);
        if self.rotates {
            self.motion += self.axis.cross(self.arm);
            self.other += self.axis.cross(self.arm + beyond);
        }
    }
}
