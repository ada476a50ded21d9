//! A smooth beginning: what goes slack and what meets an end stop.

use handc_core::scalar::Scalar;

/// The part of an excess that is felt.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ramp<S> {
    /// ρ.
    pub(super) value: S,
    /// ρ'.
    pub(super) slope: S,
    /// ρ''.
    pub(super) curvature: S,
}

/// ρ(e) over a width w: 0 below −w/2, e above w/2, and w·u⁴(5/2 − 3u + u²) between, where u runs
/// from 0 to 1. ρ'' = 30·u²(1 − u)²/w vanishes with its slope at both ends.
pub(super) fn ramp<S: Scalar>(excess: S, width: S) -> Ramp<S> {
    let c = S::constant;
    let (zero, one) = (S::zero(), S::one());
    let per_width = width.recip();
    let u = (excess * per_width + c(0.5)).max(zero).min(one);
    let square = u * u;
    let rest = one - u;
    let smooth = square * square * (c(2.5) + u * (u - c(3.0)));
    Ramp {
        value: width * smooth + (excess - width.scale(0.5)).max(zero),
        slope: square * u * (c(10.0) + u * (u.scale(6.0) - c(15.0))),
        curvature: (square * rest * rest * per_width).scale(30.0),
    }
}
