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

mod plane;
mod resolve;
mod sense;
mod trace;
mod turn;

use crate::resolved::Axis;
use crate::vector::Vec3;
use handc_core::passage::CLEARANCES;
use handc_core::scalar::Scalar;
pub use plane::planes;
pub use sense::Sense;
use turn::Turn;

/// The form of a surface with its numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form<S> {
    /// A sphere.
    Sphere,
    /// A cylinder about an axis.
    Cylinder(Axis<S>),
    /// A sphere whose strand stays in the plane through its centre with this normal.
    Ring(Axis<S>),
}

impl<S: Scalar> Form<S> {
    /// The axis about which a strand turns, if there is one.
    pub fn axis(&self) -> Option<&Axis<S>> {
        match self {
            Form::Sphere => None,
            Form::Cylinder(axis) | Form::Ring(axis) => Some(axis),
        }
    }
    /// A vector without its part along that axis.
    pub fn flat(&self, v: Vec3<S>) -> Vec3<S> {
        self.axis().map_or(v, |axis| axis.reject(v))
    }
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
            Form::Cylinder(_) | Form::Ring(_) => self.radius,
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
        let difference = points[1] - points[0];
        match &self.form {
            Form::Sphere => {
                let [p, q] = turn.points;
                // A straight line may point at the centre, and needs no plane.
                let inverse = turn.choose(S::zero(), turn.sine.recip());
                let normal = p.cross(q).scale(inverse);
                let ahead = turn.points.map(|point| normal.cross(point));
                let (mut way, factors) = self.flat(&turn, difference, ahead);
                // Out of its plane the way bends by (T + r cot θ)/p² at an end, and by −r/(pq sin θ)
                // between the ends.
                let bend = self.radius * inverse;
                for (i, end) in way.ends.iter_mut().enumerate() {
                    let bent = (turn.tangents[i] + bend * turn.cosine) * factors[i];
                    end.binormal = normal;
                    end.excess = turn.choose(S::zero(), bent - end.curvature);
                }
                way.cross_bent = -bend;
                way
            }
            Form::Cylinder(axis) | Form::Ring(axis) => {
                let ahead = turn.points.map(|point| axis.cross(point).scale(turn.sign));
                let advance = self.advance(points);
                if !advance.is_known_zero() {
                    return self.helix(&turn, difference, ahead, (axis.vector(), advance));
                }
                let (mut way, _) = self.flat(&turn, difference, ahead);
                let inverse = turn.length.recip();
                for (end, sign) in way.ends.iter_mut().zip([S::one(), -S::one()]) {
                    end.binormal = axis.vector().scale(sign);
                    end.excess = turn.choose(S::zero(), inverse - end.curvature);
                }
                way.cross_bent = turn.choose(S::zero(), inverse);
                way
            }
        }
    }

    /// What the ends of a turn point along, times p²: T_p p − r n×p and T_q q + r n×q.
    fn toward(&self, turn: &Turn<S>, ahead: [Vec3<S>; 2]) -> [Vec3<S>; 2] {
        let radii = [-self.radius, self.radius];
        [0, 1].map(|i| turn.points[i].scale(turn.tangents[i]) + ahead[i].scale(radii[i]))
    }

    /// A way in one plane, but for how it bends out of it; `ahead` is n×p and n×q. Beside it 1/p² and
    /// 1/q², where the way touches.
    fn flat(&self, turn: &Turn<S>, difference: Vec3<S>, ahead: [Vec3<S>; 2]) -> (Way<S>, [S; 2]) {
        let straight = difference.norm_squared().sqrt();
        let toward = self.toward(turn, ahead);
        let chords = [-difference, difference];
        // One quotient serves the line and the tangent.
        let factors = turn.squares.map(|square| turn.choose(straight, square).recip());
        let ends = [0, 1].map(|i| End {
            direction: turn.choose_vector(chords[i], toward[i]).scale(factors[i]),
            curvature: turn.choose(factors[i], turn.tangents[i].recip()),
            binormal: Vec3::zero(),
            excess: S::zero(),
        });
        let length = turn.choose(straight, turn.length);
        let cross_straight = turn.choose(-factors[0], S::zero());
        (Way { length, ends, cross_straight, cross_bent: S::zero() }, factors)
    }

    /// A way over a cylinder with a helix: with u the directions in the plane across the axis a,
    /// (s u_p − z a)/x and (s u_q + z a)/x; the binormals are those turned by a right angle, and the
    /// curvature is that of the tangent across the axis, s/(xT).
    fn helix(
        &self,
        turn: &Turn<S>,
        difference: Vec3<S>,
        ahead: [Vec3<S>; 2],
        (axis, advance): (Vec3<S>, S),
    ) -> Way<S> {
        let bent = turn.length * turn.length + advance * advance;
        let length = turn.choose(difference.norm_squared(), bent).sqrt();
        let inverse = length.recip();
        let toward = self.toward(turn, ahead);
        let chords = [-difference, difference];
        let signs = [-S::one(), S::one()];
        let ends = [0, 1].map(|i| {
            let flat = toward[i].scale(turn.squares[i].recip());
            let along = flat.scale(turn.length) + axis.scale(signs[i] * advance);
            let across = flat.scale(advance) - axis.scale(signs[i] * turn.length);
            let slope = turn.choose(S::one(), turn.length / turn.tangents[i]);
            let curvature = inverse * slope;
            End {
                direction: turn.choose_vector(chords[i], along).scale(inverse),
                curvature,
                binormal: across.scale(inverse),
                excess: inverse - curvature,
            }
        });
        Way {
            length,
            ends,
            cross_straight: turn.choose(-inverse, S::zero()),
            cross_bent: turn.choose(S::zero(), inverse),
        }
    }

    /// z: from the first point to the second along the axis of a cylinder.
    fn advance(&self, points: [Vec3<S>; 2]) -> S {
        match &self.form {
            Form::Cylinder(axis) => axis.dot(points[1] - points[0]),
            // A ring's points stay in its plane ([`Surface::turn`] looks).
            Form::Sphere | Form::Ring(_) => S::zero(),
        }
    }
}

/// √(s² + z²) for s ≥ 0.
fn hypotenuse<S: Scalar>(s: S, z: S) -> S {
    if z.is_known_zero() { s } else { (s * s + z * z).sqrt() }
}

#[cfg(test)]
mod tests;
