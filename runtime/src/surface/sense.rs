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
//! A sphere has a side only where all that moves between its points moves in one plane through its
//! centre ([`planes`]): there it is a ring about the plane's normal. Else the strand slides to the shorter
//! way, in any direction.
//!
//! [`planes`]: super::planes

use super::Surface;
use crate::vector::Vec3;
use handc_core::scalar::{Comparison, Scalar};

/// Sine of the angle to the end of the range at which the way is given up: two degrees.
const MARGIN: f64 = 0.035;
/// A way round that is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sense<S> {
    /// 1 where the way at the start turns about the axis, −1 where it turns against it.
    pub(super) sign: S,
    /// Cosine and sine, in no particular length, of the angle c at which the range begins.
    pub(super) cut: [S; 2],
}

impl<S: Scalar> Sense<S> {
    /// The sense at the start, where the points are p₀ and q₀ in the link's axes; `None` without an
    /// axis. A way turns about d × (q̂₀ − p̂₀) if it leads by the half of the plane that a hint d points
    /// to.
    pub fn new(surface: &Surface<S>, side: Option<Vec3<S>>, points: [Vec3<S>; 2]) -> Option<Self> {
        let axis = surface.form.axis()?;
        let [p, q] = points.map(|point| surface.form.flat(point - surface.center));
        let unit = |v: Vec3<S>| v.scale(v.norm_squared().sqrt().recip());
        let about = match side {
            Some(side) => axis.triple(side, unit(q) - unit(p)),
            None => axis.triple(p, q),
        };
        let (zero, one) = (S::zero(), S::one());
        let sign = S::select(Comparison::Less, about, zero, -one, one);
        let (sine, cosine) = (sign * axis.triple(p, q), p.dot(q));
        // c = ϑ₀ − π, but not above zero.
        let most = |x: S, otherwise: S| S::select(Comparison::Less, sine, zero, otherwise, x);
        let cut = [most(-cosine, one), most(-sine, zero)];
        Some(Sense { sign, cut })
    }

    /// For the squares of the points in the plane, and sine and cosine of the angle between them about
    /// the axis (times pq): whether the way turns about the axis (1) or against it (−1), its sine, and
    /// what is below zero where the sense is lost.
    pub(super) fn turn(&self, squares: [S; 2], (plain, cosine): (S, S)) -> (S, S, S) {
        let (zero, one) = (S::zero(), S::one());
        let sine = self.sign * plain;
        let [cut_cosine, cut_sine] = self.cut;
        // Sine and cosine of ϑ − c.
        let beyond = sine * cut_cosine - cosine * cut_sine;
        let along = cosine * cut_cosine + sine * cut_sine;
        // ϑ < 0: 2π + ϑ would be the angle, and the sine is below zero.
        let is_other = |then: S, otherwise: S| {
            let inner = S::select(Comparison::Less, zero, beyond, then, otherwise);
            S::select(Comparison::Less, sine, zero, inner, otherwise)
        };
        // Squares, so that there is neither root nor quotient.
        let least = (cut_cosine * cut_cosine + cut_sine * cut_sine).scale(MARGIN * MARGIN);
        let left = beyond * beyond - squares[0] * squares[1] * least;
        let sure = S::select(Comparison::Less, along, zero, one, left);
        (is_other(-self.sign, self.sign), is_other(-sine, sine), sure)
    }
}
