//! Which way round a surface a strand passes, decided once.
//!
//! In the plane across the axis the angle from p to q is known up to full turns. Where the model starts
//! the strand takes the way on the side of the hint, or the shorter one, and turns by ϑ₀; from there on
//! the angle ϑ is followed to ϑ₀ ± π, which tells it wherever the parts move in between. Below zero the
//! strand lies round the other side, and what counts is |ϑ|. With ϑ₀ > π the range is 0 to 2π, so that
//! no strand is ever wound more than once. So p and q may turn against each other about the axis by
//! almost half a turn either way from the start, and whether the surface turns with one or the other
//! does not matter. Within [`MARGIN`] of the end of the range, where the way would jump, length and
//! derivatives are not numbers.
//!
//! A sphere has a side only in a plane: with a hint it has that of the start, whose normal takes the
//! place of the axis. Where the points have left it so far that the way would jump, again there is no
//! number. Without a hint the strand slides to the shorter way, in any direction.

use super::{Form, Surface};
use crate::vector::Vec3;
use handc_core::scalar::{Comparison, Scalar};

/// Sine of the angle to the end of the range at which the way is given up: two degrees.
const MARGIN: f64 = 0.035;
/// Sine of the angle between the points below which they are in line with the centre of a sphere.
const IN_LINE: f64 = 0.1;
/// Cosine between the normals of the planes, now and at the start, below which a sphere has no side.
const TILT: f64 = 0.2;

/// A way round that is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sense<S> {
    /// About what the way turns at the start, in no particular length: a normal of its plane.
    pub(super) about: Vec3<S>,
    /// On a cylinder 1, or −1 if that is against the axis.
    pub(super) sign: S,
    /// Cosine and sine, in no particular length, of the angle c at which the range begins.
    pub(super) cut: [S; 2],
}

impl<S: Scalar> Sense<S> {
    /// The sense at the start, where the points are p₀ and q₀ in the link's axes. About what the way
    /// turns is d × (q̂₀ − p̂₀) with a hint d, which leads by the half of the plane that d points to.
    pub fn new(surface: &Surface<S>, side: Option<Vec3<S>>, points: [Vec3<S>; 2]) -> Option<Self> {
        let flat = |v: Vec3<S>| match &surface.form {
            Form::Sphere => v,
            Form::Cylinder(axis) => axis.reject(v),
        };
        let [p, q] = points.map(|point| flat(point - surface.center));
        let unit = |v: Vec3<S>| v.scale(v.norm_squared().sqrt().recip());
        let about = match (side, &surface.form) {
            (Some(side), _) => flat(side).cross(unit(q) - unit(p)),
            (None, Form::Cylinder(_)) => p.cross(q),
            (None, Form::Sphere) => return None,
        };
        let (zero, one) = (S::zero(), S::one());
        let sign_of = |x: S| S::select(Comparison::Less, x, zero, -one, one);
        let turned = p.cross(q);
        let (about, sign, sine) = match &surface.form {
            Form::Sphere => {
                // The plane of the points themselves, unless they are nearly in line with the centre.
                let turns = sign_of(about.dot(turned));
                let square = turned.norm_squared();
                let least = (p.norm_squared() * q.norm_squared()).scale(IN_LINE * IN_LINE);
                let plane = turned.scale(turns);
                let pick = |x: S, y: S| S::select(Comparison::Less, least, square, x, y);
                let about = Vec3([0, 1, 2].map(|i| pick(plane.0[i], about.0[i])));
                (about, one, turns * square.sqrt())
            }
            Form::Cylinder(axis) => {
                let sign = sign_of(axis.dot(about));
                (about, sign, sign * axis.dot(turned))
            }
        };
        // c = ϑ₀ − π, but not above zero.
        let cosine = p.dot(q);
        let most = |x: S, otherwise: S| S::select(Comparison::Less, sine, zero, otherwise, x);
        let cut = [most(-cosine, one), most(-sine, zero)];
        Some(Sense { about, sign, cut })
    }

    /// For points in the plane, their squares, and sine and cosine of the angle between them (times
    /// pq; the sine about the axis, or without a sign): whether the way turns about the axis or p × q
    /// (1) or against it (−1), its sine, and what is below zero where the sense is lost.
    pub(super) fn turn(
        &self,
        form: &Form<S>,
        points: [Vec3<S>; 2],
        squares: [S; 2],
        (plain, cosine): (S, S),
    ) -> (S, S, S) {
        let (zero, one) = (S::zero(), S::one());
        let less =
            |x: S, then: S, otherwise: S| S::select(Comparison::Less, x, zero, then, otherwise);
        let out_of_plane = match form {
            Form::Sphere => Some(self.about.dot(points[0].cross(points[1]))),
            Form::Cylinder(_) => None,
        };
        let kept = match out_of_plane {
            Some(turned) => less(turned, -one, one),
            None => self.sign,
        };
        let sine = kept * plain;
        let [cut_cosine, cut_sine] = self.cut;
        // Sine and cosine of ϑ − c.
        let beyond = sine * cut_cosine - cosine * cut_sine;
        let along = cosine * cut_cosine + sine * cut_sine;
        // ϑ < 0: 2π + ϑ would be the angle, and the sine is below zero.
        let is_other = |then: S, otherwise: S| {
            let inner = S::select(Comparison::Less, zero, beyond, then, otherwise);
            less(sine, inner, otherwise)
        };
        // Squares, so that there is neither root nor quotient.
        let least = (cut_cosine * cut_cosine + cut_sine * cut_sine).scale(MARGIN * MARGIN);
        let left = beyond * beyond - squares[0] * squares[1] * least;
        let mut sure = less(along, one, left);
        if let Some(turned) = out_of_plane {
            let whole = plain * self.about.norm_squared().sqrt();
            let tilt = turned.abs() - whole.scale(TILT);
            // Where both signs lead to one way nothing jumps.
            let same = -(plain * cut_cosine) - cosine * cut_sine;
            let tilt = S::select(Comparison::Less, zero, same, one, tilt);
            sure = S::select(Comparison::Less, tilt, sure, tilt, sure);
        }
        (is_other(-kept, kept), is_other(-sine, sine), sure)
    }
}
