//! The curves of a muscle, without units: forces in parts of the largest isometric force, lengths
//! in parts of the optimal fibre length, velocities in parts of the largest.
//!
//! They are those of Thelen (Adjustment of muscle mechanics model parameters to simulate dynamic
//! contractions in older adults, Journal of Biomechanical Engineering 125, 2003). Where two pieces
//! of one meet with a corner they are joined over a small width, so that every curve is twice
//! differentiable: below the tendon's slack length and about it, at the end of its toe, where the
//! passive fibres begin to pull, and where shortening turns into lengthening. Fibres shorter than
//! half their optimum resist, as those of OpenSim's Millard2012 models do, so that a muscle whose
//! tendon is slack finds an end.

use super::blend::{Blend, step};
use handc_core::scalar::{Comparison, Scalar};
use std::sync::LazyLock;

/// Width γ of the active curve.
const ACTIVE_SHAPE: f64 = 0.45;
/// Exponent k of the passive curve.
const PASSIVE_SHAPE: f64 = 5.0;
/// Shape A of shortening.
pub(super) const SHORTENING: f64 = 0.25;
/// Force at the end of the tendon's toe.
const TOE_FORCE: f64 = 0.33;
/// Exponent of the toe.
const TOE_SHAPE: f64 = 3.0;
/// How far from a corner its pieces are joined, in parts of the strain at the largest force.
const JOIN: f64 = 0.1;
/// Fibres shorter than this resist.
const SHORTEST: f64 = 0.5;
/// Their stiffness at length zero.
const STOP: f64 = 10.0;

/// A curve at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve<S> {
    /// Value.
    pub value: S,
    /// Derivative by the argument.
    pub slope: S,
}

impl<S: Scalar> Curve<S> {
    fn new([value, slope]: [S; 2]) -> Self {
        Curve { value, slope }
    }
    fn choose(x: S, end: f64, below: Self, above: Self) -> Self {
        let end = S::constant(end);
        let pick = |a, b| S::select(Comparison::Less, x, end, a, b);
        Curve { value: pick(below.value, above.value), slope: pick(below.slope, above.slope) }
    }
}

/// height·(e^{rate·y} − 1) for positive y, zero for negative, joined over ±[`JOIN`].
#[derive(Debug)]
struct Toe {
    height: f64,
    rate: f64,
    join: Blend,
}

impl Toe {
    /// The one that reaches `force` at `y` with a given exponent there.
    fn new(force: f64, y: f64, shape: f64) -> Toe {
        let (height, rate) = (force / shape.exp_m1(), shape / y);
        let growth = height * (rate * JOIN).exp();
        let end = [growth - height, growth * rate, growth * rate * rate];
        Toe { height, rate, join: Blend::new((-JOIN, [0.0; 3]), (2.0 * JOIN, end)) }
    }

    fn jet(&self, y: f64) -> [f64; 3] {
        let growth = self.height * (self.rate * y).exp();
        [growth - self.height, growth * self.rate, growth * self.rate * self.rate]
    }

    fn at<S: Scalar>(&self, y: S) -> Curve<S> {
        let c = S::constant;
        let growth = y.scale(self.rate).exp().scale(self.height);
        let above = Curve { value: growth - c(self.height), slope: growth.scale(self.rate) };
        Curve::choose(y, self.join.to(), Curve::new(self.join.at(y)), above)
    }

    /// Integral from where it begins.
    fn integral<S: Scalar>(&self, y: S) -> S {
        let joined = self.join.integral(y);
        let end = self.join.to();
        let over = y.max(S::constant(end));
        let growth = over.scale(self.rate).exp() - S::constant((self.rate * end).exp());
        let linear = over - S::constant(end);
        joined + growth.scale(self.height / self.rate) - linear.scale(self.height)
    }
}

/// Passive fibres, over the strain in parts of that at the largest force.
static PASSIVE: LazyLock<Toe> = LazyLock::new(|| Toe::new(1.0, 1.0, PASSIVE_SHAPE));

/// The tendon, over the strain in parts of that at the largest force.
struct Tendon {
    toe: Toe,
    join: Blend,
    /// Slope of the line through (1, 1) that ends it.
    slope: f64,
}

static TENDON: LazyLock<Tendon> = LazyLock::new(|| {
    // The toe ends where the line through (1, 1) has its slope.
    let growth = TOE_FORCE * TOE_SHAPE * TOE_SHAPE.exp() / TOE_SHAPE.exp_m1();
    let end = growth / (1.0 - TOE_FORCE + growth);
    let slope = (1.0 - TOE_FORCE) / (1.0 - end);
    let toe = Toe::new(TOE_FORCE, end, TOE_SHAPE);
    // Half as far beyond the end as before it: so the stiffness nowhere exceeds that of the line.
    let (from, beyond) = (end - JOIN, 0.5 * JOIN);
    let line = [TOE_FORCE + slope * beyond, slope, 0.0];
    let join = Blend::new((from, toe.jet(from)), (JOIN + beyond, line));
    Tendon { toe, join, slope }
});

/// Tendon force over strain in parts of the strain at the largest force: an exponential toe, then a
/// line (Thelen 2003, equation 5).
pub fn tendon<S: Scalar>(strain: S) -> Curve<S> {
    let Tendon { toe, join, slope } = &*TENDON;
    let line = (strain - S::one()).scale(*slope) + S::one();
    let line = Curve { value: line, slope: S::constant(*slope) };
    let above = Curve::choose(strain, join.to(), Curve::new(join.at(strain)), line);
    // Kept where it counts, so that the exponential stays finite.
    let below = toe.at(strain.min(S::constant(join.from)));
    Curve::choose(strain, join.from, below, above)
}

/// Energy of the tendon: the integral of its force over strain.
pub fn tendon_energy<S: Scalar>(strain: S) -> S {
    let Tendon { toe, join, slope } = &*TENDON;
    let c = S::constant;
    let over = (strain - c(join.to())).max(S::zero());
    let line = over * (c(1.0 - slope * (1.0 - join.to())) + over.scale(0.5 * slope));
    toe.integral(strain.min(c(join.from))) + join.integral(strain) + line
}

/// Whether the tendon pulls: 1 beyond its slack length, 0 below, a smooth step between.
pub fn tendon_taut<S: Scalar>(strain: S) -> S {
    step((strain + S::constant(JOIN)).scale(0.5 / JOIN))[0]
}

/// Isometric force of the active fibres over their length (Thelen 2003, equation 4).
pub fn active<S: Scalar>(length: S) -> Curve<S> {
    let stretch = length - S::one();
    let value = (stretch * stretch).scale(-1.0 / ACTIVE_SHAPE).exp();
    Curve { value, slope: value * stretch.scale(-2.0 / ACTIVE_SHAPE) }
}

/// Force of the passive fibres over their length (Thelen 2003, equation 3), and of what keeps them
/// from being too short; `per_strain` is 1 over their strain at the largest force.
pub fn passive<S: Scalar>(length: S, per_strain: S) -> Curve<S> {
    let pull = PASSIVE.at((length - S::one()) * per_strain);
    let short = (S::constant(SHORTEST) - length).max(S::zero());
    let square = (short * short).scale(STOP / (SHORTEST * SHORTEST));
    Curve {
        value: pull.value - (square * short).scale(1.0 / 3.0),
        slope: pull.slope * per_strain + square,
    }
}

/// Energy of the passive fibres: the integral of [`passive`] over length.
pub fn passive_energy<S: Scalar>(length: S, strain: S) -> S {
    let pull = PASSIVE.integral((length - S::one()) / strain) * strain;
    let short = (S::constant(SHORTEST) - length).max(S::zero());
    pull + (short * short * short * short).scale(STOP / (12.0 * SHORTEST * SHORTEST))
}

/// Force of the active fibres over their velocity of lengthening, in parts of the isometric one
/// (Thelen 2003, equations 6 and 7 solved for the force): a hyperbola through zero at −1 for
/// shortening and one that ends at `eccentric` for lengthening. Of the two, the second begins twice
/// as steep; they are joined over a velocity of ±(eccentric − 1)/20 with value 1 at zero.
pub fn velocity<S: Scalar>(velocity: S, eccentric: S) -> Curve<S> {
    let (one, c) = (S::one(), S::constant);
    // The second hyperbola is a function of this alone.
    let scale = (eccentric - one).recip().scale(2.0 + 2.0 / SHORTENING);
    let x = velocity * scale;
    let [share, share_slope] = step(x + c(0.5));
    let lengthening = share * x;
    let lengthening_slope = share + share_slope * x;
    let shortening = velocity - share * velocity;
    // One quotient for both denominators.
    let (below_short, below_long) = (one - shortening.scale(1.0 / SHORTENING), one + lengthening);
    let quotient = (below_short * below_long).recip();
    let (per_short, per_long) = (quotient * below_long, quotient * below_short);
    let short = (one + shortening) * per_short;
    let long = (one + eccentric * lengthening) * per_long;
    let short_slope = (per_short * per_short).scale(1.0 + 1.0 / SHORTENING);
    let long_slope = (eccentric - one) * scale * per_long * per_long;
    Curve {
        value: short + long - one,
        slope: short_slope * (one - lengthening_slope) + long_slope * lengthening_slope,
    }
}
