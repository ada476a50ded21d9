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
//! Which way round is decided where the model starts and kept ([`Sense`]), so that nothing jumps.
//!
//! A point inside the surface has no tangent: T is the root of a negative number, and x is not a
//! number. Over a sphere, points opposite each other have no plane, and x no derivative.

mod resolve;
mod sense;
mod trace;
mod turn;

use crate::resolved::Axis;
use crate::vector::Vec3;
use handc_core::passage::CLEARANCES;
use handc_core::scalar::Scalar;
pub use sense::Sense;
use turn::Turn;

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
    /// Which way round the strand passes; `None`: always the shorter one, as over a sphere, where a
    /// strand slides to it.
    pub sense: Option<Sense<S>>,
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

impl<S: Scalar> Surface<S> {
    /// Length of the way between two points in the link's axes (m).
    pub fn length(&self, points: [Vec3<S>; 2]) -> S {
        let turn = self.turn(points);
        let advance = self.advance(points);
        let straight = (points[1] - points[0]).norm_squared().sqrt();
        turn.choose(straight, hypotenuse(turn.length, advance))
    }

    /// How far the points are outside, how far the centre of a sphere that is touched is from the line
    /// between them, less 10⁻⁹ of the radius (m); and what is below zero where the sense is lost
    /// ([`Sense`]), in no unit.
    pub fn clearances(&self, points: [Vec3<S>; 2]) -> [S; CLEARANCES] {
        let turn = self.turn(points);
        let [before, behind] = turn.squares.map(|p| p.sqrt() - self.radius);
        let off = match self.form {
            Form::Cylinder(_) => self.radius,
            Form::Sphere => {
                let distance = (points[1] - points[0]).norm_squared().sqrt();
                let least = self.radius.scale(1e-9);
                turn.choose(self.radius, turn.sine.abs() / distance - least)
            }
        };
        [before, behind, off, turn.sure]
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

#[cfg(test)]
mod tests;
