//! The way of a strand over a sphere or a cylinder between two points p and q.
//!
//! With p and q from the centre, r the radius, T = √(p² − r²) the tangent from a point, and θ the
//! angle from p to q about the unit normal n of their plane, on the side on which the strand passes,
//!
//! x = T_p + T_q + rφ,  φ = θ − acos(r/p) − acos(r/q),
//!
//! where φ > 0; else the strand does not touch and x = ‖q − p‖. Value and first derivatives of both
//! agree where φ = 0. Over a cylinder this holds in the plane across its axis, where it gives s; the
//! surface unrolled is flat, and x = √(s² + z²) with z the advance along the axis (a helix between
//! two straight lines). φ is one angle of a product of three complex numbers,
//! (cos θ + i sin θ)(r − iT_p)(r − iT_q), so that no inverse cosine loses digits.
//!
//! Side: let d be the hint and m the direction midway between p and q along the way. Of the two ways
//! round the one with m·d ≥ 0 is taken, so that the strand stays on its side as long as m stays
//! within a right angle of d. Without a hint it is the shorter way.
//!
//! A point inside the surface has no tangent: T is the root of a negative number, and x is not a
//! number. Over a sphere, points opposite each other have no plane, and x no derivative.

use crate::resolved::Axis;
use crate::vector::Vec3;
use handc_core::scalar::{Comparison, Scalar};

/// The form of a surface with its numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form<S> {
    /// A sphere.
    Sphere,
    /// A cylinder about an axis.
    Cylinder(Axis<S>),
}

/// A surface in the axes of the link that carries it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface<S> {
    /// Its form.
    pub form: Form<S>,
    /// Its centre (m).
    pub center: Vec3<S>,
    /// Its radius (m).
    pub radius: S,
    /// Unit vector to the side on which the strand passes, if it is told.
    pub side: Option<Vec3<S>>,
}

/// A way with what its derivatives are made of.
///
/// With u, b, κ and c of each end, the second derivatives of the length x by the positions are
///
/// ∂²x/∂p² = κ(1 − uuᵀ) + c bbᵀ,  ∂²x/∂p∂q = `cross_straight`·(1 + u_p u_qᵀ) + `cross_bent`·b_p b_qᵀ,
///
/// where the first cross term is meant for u_q = −u_p.
#[derive(Clone, Copy, Debug)]
pub struct Way<S> {
    /// Its length x (m).
    pub length: S,
    /// At the first point and at the second.
    pub ends: [End<S>; 2],
    /// −1/x where the way is straight, else 0 (1/m).
    pub cross_straight: S,
    /// What couples the two binormals where the way is bent, else 0 (1/m).
    pub cross_bent: S,
}

/// One end of a way.
#[derive(Clone, Copy, Debug)]
pub struct End<S> {
    /// u = ∂x/∂p: unit vector out of the surface, along the strand.
    pub direction: Vec3<S>,
    /// κ: curvature of x across the strand (1/m).
    pub curvature: S,
    /// 1/κ: how far behind the end the strand turns about (m).
    pub reach: S,
    /// b: unit vector across the strand, along the surface.
    pub binormal: Vec3<S>,
    /// c: curvature along the binormal beyond κ (1/m).
    pub excess: S,
}

/// The turn about the centre in the plane across the axis, or that of the two points.
struct Turn<S> {
    /// The points in that plane.
    points: [Vec3<S>; 2],
    /// Their squares p², q².
    squares: [S; 2],
    /// Tangents T.
    tangents: [S; 2],
    /// 1 or −1: whether the way turns about the axis or p × q, or against it.
    sign: S,
    /// pq·sin θ, below zero for more than half a turn.
    sine: S,
    /// pq·cos θ.
    cosine: S,
    /// Not below zero where the strand does not touch; not a number where a point is inside.
    free: S,
    /// T_p + T_q + rφ.
    length: S,
}

impl<S: Scalar> Turn<S> {
    /// `then` where the strand does not touch, else `otherwise`; the latter for what is not a number.
    #[inline]
    fn choose(&self, then: S, otherwise: S) -> S {
        S::select(Comparison::LessEqual, S::zero(), self.free, then, otherwise)
    }
    #[inline]
    fn choose_vector(&self, then: Vec3<S>, otherwise: Vec3<S>) -> Vec3<S> {
        Vec3([0, 1, 2].map(|i| self.choose(then.0[i], otherwise.0[i])))
    }
}

impl<S: Scalar> Surface<S> {
    /// Length of the way between two points in the link's axes (m).
    pub fn length(&self, points: [Vec3<S>; 2]) -> S {
        let turn = self.turn(points);
        let advance = self.advance(points);
        let straight = (points[1] - points[0]).norm_squared().sqrt();
        turn.choose(straight, hypotenuse(turn.length, advance))
    }

    /// The way between two points in the link's axes, with its derivatives.
    pub fn way(&self, points: [Vec3<S>; 2]) -> Way<S> {
        let turn = self.turn(points);
        let bent = match &self.form {
            Form::Sphere => self.over_sphere(points, &turn),
            Form::Cylinder(axis) => self.over_cylinder(axis, points, &turn),
        };
        let difference = points[1] - points[0];
        let length = difference.norm_squared().sqrt();
        let inverse = length.recip();
        let along = difference.scale(inverse);
        let mut ends = bent.ends;
        for (end, direction) in ends.iter_mut().zip([-along, along]) {
            end.direction = turn.choose_vector(direction, end.direction);
            end.curvature = turn.choose(inverse, end.curvature);
            end.reach = turn.choose(length, end.reach);
            end.excess = turn.choose(S::zero(), end.excess);
        }
        Way {
            length: turn.choose(length, bent.length),
            ends,
            cross_straight: turn.choose(-inverse, S::zero()),
            cross_bent: turn.choose(S::zero(), bent.cross_bent),
        }
    }

    /// z: from the first point to the second along the axis of a cylinder.
    fn advance(&self, points: [Vec3<S>; 2]) -> S {
        match &self.form {
            Form::Sphere => S::zero(),
            Form::Cylinder(axis) => axis.dot(points[1] - points[0]),
        }
    }

    fn turn(&self, points: [Vec3<S>; 2]) -> Turn<S> {
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
        let sign = match (&self.form, self.side) {
            (Form::Sphere, None) => one,
            (Form::Cylinder(_), None) => S::select(Comparison::Less, plain, zero, -one, one),
            // m·d has the sign of d·(p/‖p‖ + q/‖q‖) if θ < π, and against the turn that of
            // (a × d)·(q/‖q‖ − p/‖p‖). Squares that keep their sign need no root.
            (form, Some(side)) => {
                let (toward, first) = match form {
                    Form::Sphere => (side, -one),
                    Form::Cylinder(axis) => (axis.cross(side), one),
                };
                let [p, q] = points.map(|point| toward.dot(point));
                let [p, q] = [p * p.abs() * squares[1] * first, q * q.abs() * squares[0]];
                S::select(Comparison::Less, q, p, -one, one)
            }
        };
        let sine = match (&self.form, self.side) {
            (Form::Sphere, None) => plain,
            (Form::Cylinder(_), None) => plain.abs(),
            _ => sign * plain,
        };
        let cosine = points[0].dot(points[1]);
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
        // A strand that turns by less than half a turn touches if φ > 0; by more, always.
        let free = match self.side {
            None => -across,
            Some(_) => S::select(Comparison::LessEqual, zero, sine, -across, -one),
        };
        let length = tangent + self.radius * angle;
        Turn { points, squares, tangents, sign, sine, cosine, free, length }
    }

    /// The two ends of a turn: u_p = (T_p p − r n×p)/p², u_q = (T_q q + r n×q)/q².
    fn directions(&self, turn: &Turn<S>, ahead: [Vec3<S>; 2]) -> [Vec3<S>; 2] {
        let radii = [-self.radius, self.radius];
        [0, 1].map(|i| {
            let toward = turn.points[i].scale(turn.tangents[i]) + ahead[i].scale(radii[i]);
            toward.scale(turn.squares[i].recip())
        })
    }

    /// A way that touches a sphere. Out of its plane it bends by (T + r cot θ)/p² at an end and by
    /// −r/(pq sin θ) between the ends.
    fn over_sphere(&self, points: [Vec3<S>; 2], turn: &Turn<S>) -> Way<S> {
        let [p, q] = points.map(|point| point - self.center);
        let inverse = turn.sine.recip();
        let normal = p.cross(q).scale(inverse);
        let directions = self.directions(turn, turn.points.map(|point| normal.cross(point)));
        let bend = self.radius * inverse;
        let end = |i: usize| {
            let tangent: S = turn.tangents[i];
            let curvature = tangent.recip();
            let across = (tangent + bend * turn.cosine) / turn.squares[i];
            End {
                direction: directions[i],
                curvature,
                reach: tangent,
                binormal: normal,
                excess: across - curvature,
            }
        };
        Way {
            length: turn.length,
            ends: [end(0), end(1)],
            cross_straight: S::zero(),
            cross_bent: -bend,
        }
    }

    /// A way that touches a cylinder: with u the directions in the plane across the axis a,
    /// (s u_p − z a)/x and (s u_q + z a)/x; the binormals are those turned by a right angle.
    fn over_cylinder(&self, axis: &Axis<S>, points: [Vec3<S>; 2], turn: &Turn<S>) -> Way<S> {
        let ahead = turn.points.map(|point| axis.cross(point).scale(turn.sign));
        let directions = self.directions(turn, ahead);
        let advance = self.advance(points);
        let length = hypotenuse(turn.length, advance);
        let inverse = length.recip();
        // Sine and cosine of the helix' slope.
        let (rise, level) = match advance.is_known_zero() {
            true => (S::zero(), S::one()),
            false => (advance * inverse, turn.length * inverse),
        };
        let axis = axis.vector();
        let end = |i: usize| {
            let sign = if i == 0 { -S::one() } else { S::one() };
            let tangent: S = turn.tangents[i];
            let curvature = level / tangent;
            End {
                direction: directions[i].scale(level) + axis.scale(sign * rise),
                curvature,
                reach: tangent / level,
                binormal: directions[i].scale(rise) - axis.scale(sign * level),
                excess: inverse - curvature,
            }
        };
        Way { length, ends: [end(0), end(1)], cross_straight: S::zero(), cross_bent: inverse }
    }
}

/// √(s² + z²) for s ≥ 0.
fn hypotenuse<S: Scalar>(s: S, z: S) -> S {
    if z.is_known_zero() { s } else { (s * s + z * z).sqrt() }
}
