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
use crate::resolved::{Hinge, HingeEnd, Joint, ResolvedSegment};
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
    pub(crate) motion: Vec3<S>,
    /// s: motion of the other end, were it carried too.
    other: Vec3<S>,
}

/// The segments of one strand: lengths summed, the rest one after another.
#[derive(Clone, Debug)]
pub(crate) struct Segments<S> {
    /// Sum of the lengths.
    pub(crate) length: S,
    /// 1/d of each segment.
    pub(crate) inverse: Vec<S>,
    /// d_j of each segment: joints of the first side, then of the second, innermost last on each.
    pub(crate) length_dq: Vec<S>,
    /// D_jk of each segment, lower triangle; over a surface d_jk itself, with 1 for 1/d.
    pub(crate) squares: Vec<S>,
    pub(crate) crossings: Vec<Crossing<S>>,
}

impl<S: Scalar> Segments<S> {
    pub(crate) fn new() -> Self {
        Segments {
            length: S::zero(),
            inverse: Vec::new(),
            length_dq: Vec::new(),
            squares: Vec::new(),
            crossings: Vec::new(),
        }
    }
    /// Forgets the last strand; a part of the next one has the length given.
    pub(crate) fn begin(&mut self, length: S) {
        self.length = length;
        self.inverse.clear();
        self.length_dq.clear();
        self.squares.clear();
    }
    /// Adds a segment over a hinge of sine and cosine (s, c).
    #[inline]
    fn hinge(&mut self, hinge: &Hinge<S>, (s, c): (S, S), order: Order) {
        let twice = hinge.twice_cosine * c + hinge.twice_sine * s;
        let length = (hinge.constant - twice).sqrt();
        self.length += length;
        if order == Order::Length {
            return;
        }
        let inverse = length.recip();
        self.length_dq.push((hinge.cosine * s - hinge.sine * c) * inverse);
        if order == Order::Second {
            self.inverse.push(inverse);
            self.squares.push(twice.scale(0.5));
        }
    }

    /// Adds a segment over one hinge on each side.
    #[inline]
    fn hinge_pair(
        &mut self,
        first: &HingeEnd<S>,
        second: &HingeEnd<S>,
        [turn1, turn2]: [(S, S); 2],
        order: Order,
    ) {
        let (arm1, arm2) = (first.arm(turn1), second.arm(turn2));
        let difference = (arm2 + second.origin) - (arm1 + first.origin);
        let length = difference.norm_squared().sqrt();
        self.length += length;
        if order == Order::Length {
            return;
        }
        let inverse = length.recip();
        let signed = |value: S, positive: bool| if positive { value } else { -value };
        // P·r, but for the sign of a joint that carries the middle instead.
        let (lever1, lever2) =
            (first.axis.triple(arm1, difference), second.axis.triple(arm2, difference));
        self.length_dq.push(signed(lever1 * inverse, !first.is_carried));
        self.length_dq.push(signed(lever2 * inverse, second.is_carried));
        if order == Order::Second {
            let opposite = first.is_carried != second.is_carried;
            self.inverse.push(inverse);
            let motions = first.axis.cross(arm1).dot(second.axis.cross(arm2));
            self.squares.push(first.axis.across(arm1 + difference, arm1));
            self.squares.push(signed(motions, opposite));
            self.squares.push(second.axis.across(arm2 - difference, arm2));
        }
    }
}

impl<S: Scalar> HingeEnd<S> {
    /// From the joint to the point, in the middle's axes.
    #[inline]
    fn arm(&self, (s, c): (S, S)) -> Vec3<S> {
        let s = if self.is_carried { s } else { -s };
        rotate_vector(&self.axis, (s, c), self.point)
    }
}

impl<S: Scalar> Mechanics<'_, S> {
    /// Adds a segment, with derivatives up to `order`.
    #[inline]
    pub(crate) fn segment(
        &self,
        sin_cos: &[(S, S)],
        q: &[S],
        path: &SegmentPath,
        resolved: &ResolvedSegment<S>,
        order: Order,
        out: &mut Segments<S>,
    ) {
        match resolved {
            ResolvedSegment::Hinge(link, hinge) => {
                out.hinge(hinge, sin_cos[*link as usize], order);
            }
            ResolvedSegment::HingePair(first, second) => {
                let sin_cos = [sin_cos[first.link as usize], sin_cos[second.link as usize]];
                out.hinge_pair(first, second, sin_cos, order);
            }
            ResolvedSegment::Ends(first, second) if order == Order::Length => {
                let p1 = self.place_along(sin_cos, q, &path.first, *first);
                let p2 = self.place_along(sin_cos, q, &path.second, *second);
                out.length += (p2 - p1).norm_squared().sqrt();
            }
            ResolvedSegment::Ends(first, second) => {
                self.long_segment(sin_cos, q, path, (*first, *second), order, out);
            }
            ResolvedSegment::Wrapped(surface, points) => {
                self.wrapped_segment(sin_cos, q, path, (surface, *points), order, out);
            }
        }
    }

    /// A segment over any joints.
    fn long_segment(
        &self,
        sin_cos: &[(S, S)],
        q: &[S],
        path: &SegmentPath,
        (first, second): (Vec3<S>, Vec3<S>),
        order: Order,
        out: &mut Segments<S>,
    ) {
        let crossings = &mut out.crossings;
        crossings.clear();
        let p1 = self.walk(sin_cos, q, &path.first, first, crossings, 0);
        let split = crossings.len();
        let p2 = self.walk(sin_cos, q, &path.second, second, crossings, split);
        let difference = p2 - p1;
        let length = difference.norm_squared().sqrt();
        let inverse = length.recip();
        out.length += length;
        let (before, after) = crossings.split_at_mut(split);
        for crossing in before {
            crossing.arrive(difference);
            out.length_dq.push(-(difference.dot(crossing.motion) * inverse));
        }
        for crossing in after {
            crossing.arrive(-difference);
            out.length_dq.push(difference.dot(crossing.motion) * inverse);
        }
        if order != Order::Second {
            return;
        }
        out.inverse.push(inverse);
        for (i, nearer) in out.crossings.iter().enumerate() {
            for (j, outer) in out.crossings[..=i].iter().enumerate() {
                out.squares.push(if (i < split) == (j < split) {
                    nearer.other.dot(outer.motion)
                } else {
                    -nearer.motion.dot(outer.motion)
                });
            }
        }
    }

    /// Takes a point along a path.
    pub(crate) fn place_along(
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
    pub(crate) fn walk(
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
        }
    }
    /// u × w for a direction u in the middle's axes.
    #[inline]
    pub(crate) fn turning(&self, direction: Vec3<S>) -> Vec3<S> {
        if self.rotates { direction.cross(self.axis) } else { Vec3::zero() }
    }
    /// Works out r and s in the middle, where the other end is `beyond` this one.
    #[inline]
    pub(crate) fn arrive(&mut self, beyond: Vec3<S>) {
        let slide = self.advance.map_or_else(Vec3::zero, |advance| self.axis.scale(advance));
        (self.motion, self.other) = (slide, slide);
        if self.rotates {
            self.motion += self.axis.cross(self.arm);
            self.other += self.axis.cross(self.arm + beyond);
        }
    }
}
