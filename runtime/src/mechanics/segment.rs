//! The distance between two points on different links, with exact derivatives.
//!
//! A segment is evaluated in the axes of the link midway between its ends, so that it depends on
//! nothing but the joints between them. Writing w for the (signed) axis of a joint and r for the
//! derivative of p₂ − p₁ by its coordinate, u for the unit vector from p₁ to p₂ and d for the
//! distance,
//!
//! d_j = u·r_j,  d_jk = (r_j·r_k − d_j d_k)/d + u·(w_j × r_k)
//!
//! with j the joint nearer the middle, and without the last term where the two joints lie on
//! opposite sides. Over a single hinge d² = K − 2y with y = A cos q + B sin q + const, which needs
//! no vectors at all.

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
    /// Derivative of p₂ − p₁.
    r: Vec3<S>,
    /// d_j.
    pub(crate) length_dq: S,
}

/// Scratch and results of one segment.
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

impl<S: Scalar> Mechanics<'_, S> {
    /// Length of a segment, with derivatives up to `order`.
    pub(crate) fn segment(
        &self,
        sin_cos: &[(S, S)],
        q: &[S],
        path: &SegmentPath,
        (first, second_point): (Vec3<S>, Vec3<S>),
        order: Order,
        out: &mut Segment<S>,
    ) {
        out.crossings.clear();
        out.length_dqdq.clear();
        if let ([], [step]) = (path.first.as_slice(), path.second.as_slice()) {
            let joint = &self.numbers.joints[step.link() as usize];
            if joint.rotates && joint.advance.is_none() {
                let (parent, child) = match step {
                    PathStep::Up(_) => (first, second_point),
                    PathStep::Down(_) => (second_point, first),
                };
                self.hinge_segment(sin_cos, step.link(), parent, child, order, out);
                return;
            }
        }
        if order == Order::Length {
            let p1 = self.place_along(sin_cos, q, &path.first, first);
            let p2 = self.place_along(sin_cos, q, &path.second, second_point);
            out.length = (p2 - p1).norm_squared().sqrt();
            return;
        }
        let p1 = self.walk(sin_cos, q, &path.first, first, &mut out.crossings, 0);
        let split = out.crossings.len();
        for crossing in &mut out.crossings {
            crossing.r = -crossing.r;
        }
        let p2 = self.walk(sin_cos, q, &path.second, second_point, &mut out.crossings, split);
        let difference = p2 - p1;
        let length = difference.norm_squared().sqrt();
        let inverse = length.recip();
        let unit = difference.scale(inverse);
        out.length = length;
        for crossing in &mut out.crossings {
            crossing.length_dq = unit.dot(crossing.r);
        }
        if order != Order::Second {
            return;
        }
        let count = out.crossings.len();
        out.length_dqdq.resize(count * count, S::zero());
        for i in 0..count {
            for j in 0..=i {
                let (inner, outer) = (&out.crossings[j], &out.crossings[i]);
                let mut value =
                    (inner.r.dot(outer.r) - inner.length_dq * outer.length_dq) * inverse;
                // On one side the later crossing is nearer the middle and carries the earlier.
                if (i < split) == (j < split) && outer.rotates {
                    value += unit.dot(outer.axis.cross(inner.r));
                }
                out.length_dqdq[i * count + j] = value;
            }
        }
    }

    /// Over one hinge: d² = K − 2y, d' = −y'/d, d'' = −(y'' + d'²)/d.
    fn hinge_segment(
        &self,
        sin_cos: &[(S, S)],
        link: u32,
        parent: Vec3<S>,
        child: Vec3<S>,
        order: Order,
        out: &mut Segment<S>,
    ) {
        let joint = &self.numbers.joints[link as usize];
        let mut a = parent - joint.origin;
        if let Some(rotation) = joint.rotation {
            a = rotation.transpose_mul(a);
        }
        let b = child;
        let along = joint.axis.dot(a) * joint.axis.dot(b);
        let two = S::constant(2.0);
        let cosine = a.dot(b) - along;
        let sine = joint.axis.dot(b.cross(a));
        let constant = a.norm_squared() + b.norm_squared() - two * along;
        let (s, c) = sin_cos[link as usize];
        let y = cosine * c + sine * s;
        let length = (constant - two * y).sqrt();
        let inverse = length.recip();
        let length_dq = (cosine * s - sine * c) * inverse;
        out.length = length;
        out.crossings.push(Crossing {
            rotates: true,
            axis: Vec3::zero(),
            r: Vec3::zero(),
            length_dq,
        });
        if order == Order::Second {
            out.length_dqdq.push((y - length_dq * length_dq) * inverse);
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
        steps.iter().fold(point, |p, step| {
            let link = step.link() as usize;
            let joint = &self.numbers.joints[link];
            let (s, c) = sin_cos[link];
            let turn = |v: Vec3<S>, sine: S| {
                if joint.rotates { rotate_vector(&joint.axis, (sine, c), v) } else { v }
            };
            let slide = joint.advance.map(|advance| {
                joint.axis.vector().scale(q[self.structure.coordinate_of[link]] * advance)
            });
            let slide = slide.unwrap_or_else(Vec3::zero);
            match (step, joint.rotation) {
                (PathStep::Up(_), None) => turn(p, s) + slide + joint.origin,
                (PathStep::Up(_), Some(r)) => r * (turn(p, s) + slide) + joint.origin,
                (PathStep::Down(_), None) => turn(p - joint.origin - slide, -s),
                (PathStep::Down(_), Some(r)) => turn(r.transpose_mul(p - joint.origin) - slide, -s),
            }
        })
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
            let coordinate = self.structure.coordinate_of[link];
            let (s, c) = sin_cos[link];
            let axis = joint.axis.vector();
            let turn = |v: Vec3<S>, sine: S| {
                if joint.rotates { rotate_vector(&joint.axis, (sine, c), v) } else { v }
            };
            let slide = joint.advance.map(|advance| axis.scale(q[coordinate] * advance));
            match step {
                PathStep::Up(_) => {
                    p = turn(p, s);
                    self.turn_all(&mut crossings[start..], |v| turn(v, s));
                    crossings.push(crossing(joint, p, false));
                    if let Some(slide) = slide {
                        p += slide;
                    }
                    if let Some(rotation) = joint.rotation {
                        p = rotation * p;
                        self.turn_all(&mut crossings[start..], |v| rotation * v);
                    }
                    p += joint.origin;
                }
                PathStep::Down(_) => {
                    p -= joint.origin;
                    if let Some(rotation) = joint.rotation {
                        p = rotation.transpose_mul(p);
                        self.turn_all(&mut crossings[start..], |v| rotation.transpose_mul(v));
                    }
                    if let Some(slide) = slide {
                        p -= slide;
                    }
                    p = turn(p, -s);
                    self.turn_all(&mut crossings[start..], |v| turn(v, -s));
                    crossings.push(crossing(joint, p, true));
                }
            }
        }
        p
    }

    #[inline]
    fn turn_all(&self, crossings: &mut [Crossing<S>], turn: impl Fn(Vec3<S>) -> Vec3<S>) {
        for crossing in crossings {
            crossing.axis = turn(crossing.axis);
            crossing.r = turn(crossing.r);
        }
    }
}

/// The joint just crossed by the point `p`, given in the joint's own axes.
#[inline]
fn crossing<S: Scalar>(joint: &Joint<S>, p: Vec3<S>, downward: bool) -> Crossing<S> {
    let axis = joint.axis.vector();
    let mut r = if joint.rotates { joint.axis.cross(p) } else { Vec3::zero() };
    if let Some(advance) = joint.advance {
        r += axis.scale(advance);
    }
    let mut w = if joint.rotates { axis } else { Vec3::zero() };
    if downward {
        (r, w) = (-r, -w);
    }
    Crossing { rotates: joint.rotates, axis: w, r, length_dq: S::zero() }
}
