//! Polynomials that join two pieces of a curve.

use handc_core::scalar::Scalar;

/// A value with its first two derivatives.
pub(super) type Jet = [f64; 3];

/// The polynomial of degree five that joins two curves over a width with value, slope and curvature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Blend {
    /// Where it begins.
    pub(super) from: f64,
    /// How wide it is.
    pub(super) width: f64,
    /// Coefficients over u = (x − from)/width.
    coefficients: [f64; 6],
}

impl Blend {
    /// From the curve that has `first` at `from` to the one that has `last` at `from + width`.
    pub(super) fn new((from, first): (f64, Jet), (width, last): (f64, Jet)) -> Blend {
        let scaled = |jet: Jet| [jet[0], width * jet[1], width * width * jet[2]];
        let ([p, d, c], [q, e, f]) = (scaled(first), scaled(last));
        // What is left for the last three terms at u = 1.
        let (value, slope, curvature) = (q - p - d - 0.5 * c, e - d - c, f - c);
        let coefficients = [
            p,
            d,
            0.5 * c,
            10.0 * value - 4.0 * slope + 0.5 * curvature,
            -15.0 * value + 7.0 * slope - curvature,
            6.0 * value - 3.0 * slope + 0.5 * curvature,
        ];
        Blend { from, width, coefficients }
    }

    /// Where it ends.
    pub(super) fn to(&self) -> f64 {
        self.from + self.width
    }

    /// Value and slope at x; beyond its ends the values there, and slopes that mean nothing.
    pub(super) fn at<S: Scalar>(&self, x: S) -> [S; 2] {
        let u = self.place(x);
        let c = S::constant;
        let [mut value, mut slope] = [S::zero(); 2];
        for (power, &k) in self.coefficients.iter().enumerate().rev() {
            value = value * u + c(k);
            if power > 0 {
                slope = slope * u + c(power as f64 * k / self.width);
            }
        }
        [value, slope]
    }

    /// Integral from the beginning to x, to the end at most.
    pub(super) fn integral<S: Scalar>(&self, x: S) -> S {
        let u = self.place(x);
        let mut sum = S::zero();
        for (power, &k) in self.coefficients.iter().enumerate().rev() {
            sum = sum * u + S::constant(self.width * k / (power + 1) as f64);
        }
        sum * u
    }

    fn place<S: Scalar>(&self, x: S) -> S {
        let u = (x - S::constant(self.from)).scale(self.width.recip());
        u.max(S::zero()).min(S::one())
    }
}

/// 10u³ − 15u⁴ + 6u⁵ with its slope, u kept between 0 and 1: a step that is twice differentiable.
pub(super) fn step<S: Scalar>(u: S) -> [S; 2] {
    let u = u.max(S::zero()).min(S::one());
    let square = u * u;
    let rest = S::one() - u;
    let value = square * u * (S::constant(10.0) + u * (u.scale(6.0) - S::constant(15.0)));
    [value, (square * rest * rest).scale(30.0)]
}
