//! Thelen's muscle (2003) written out plainly, piece by piece, for the tests: what the runtime
//! evaluates by other formulas.

use handc_core::scalar::{Comparison, Scalar};

/// Quintic through two points with their slopes and curvatures, by Hermite's basis.
fn hermite<S: Scalar>(x: S, (a, at_a): (f64, [f64; 3]), (b, at_b): (f64, [f64; 3])) -> S {
    let h = b - a;
    let t = (x - S::constant(a)).scale(1.0 / h);
    let p = |c: [f64; 6]| {
        let terms = c.iter().enumerate().map(|(i, &c)| t.powi(i as i32).scale(c));
        terms.fold(S::zero(), |sum, term| sum + term)
    };
    p([1.0, 0.0, 0.0, -10.0, 15.0, -6.0]).scale(at_a[0])
        + p([0.0, 1.0, 0.0, -6.0, 8.0, -3.0]).scale(h * at_a[1])
        + p([0.0, 0.0, 0.5, -1.5, 1.5, -0.5]).scale(h * h * at_a[2])
        + p([0.0, 0.0, 0.0, 10.0, -15.0, 6.0]).scale(at_b[0])
        + p([0.0, 0.0, 0.0, -4.0, 7.0, -3.0]).scale(h * at_b[1])
        + p([0.0, 0.0, 0.0, 0.5, -1.0, 0.5]).scale(h * h * at_b[2])
}

/// Integral of a polynomial of degree five by Gauss' rule of three points.
fn gauss<S: Scalar>(from: f64, to: S, f: impl Fn(S) -> S) -> S {
    let half = (to - S::constant(from)).scale(0.5);
    let middle = (to + S::constant(from)).scale(0.5);
    let root = 0.6f64.sqrt();
    let nodes = [(-root, 5.0 / 9.0), (0.0, 8.0 / 9.0), (root, 5.0 / 9.0)];
    let sum = nodes.map(|(x, weight)| f(middle + half.scale(x)).scale(weight));
    (sum[0] + sum[1] + sum[2]) * half
}

/// Picks by the place of x: the last piece that begins at or below it.
fn piece<S: Scalar>(x: S, below: S, pieces: &[(f64, S)]) -> S {
    pieces.iter().fold(below, |found, &(from, value)| {
        S::select(Comparison::Less, x, S::constant(from), found, value)
    })
}

/// a(e^{cy} − 1) and its derivatives.
fn toe(a: f64, c: f64, y: f64) -> [f64; 3] {
    [a * ((c * y).exp() - 1.0), a * c * (c * y).exp(), a * c * c * (c * y).exp()]
}

/// Force of passive fibres and its integral.
pub(crate) fn passive<S: Scalar>(length: S, strain: S) -> [S; 2] {
    let y = (length - S::one()) / strain;
    let (a, w) = (1.0 / (5f64.exp() - 1.0), 0.1);
    let end = toe(a, 5.0, w);
    let join = |y: S| hermite(y, (-w, [0.0; 3]), (w, end));
    let curve = y.scale(5.0).exp().scale(a) - S::constant(a);
    let force = piece(y, S::zero(), &[(-w, join(y)), (w, curve)]);
    let over = y - S::constant(w);
    let rest = (y.scale(5.0).exp() - S::constant((5.0 * w).exp())).scale(a / 5.0) - over.scale(a);
    let energy = piece(
        y,
        S::zero(),
        &[(-w, gauss(-w, y, join)), (w, gauss(-w, S::constant(w), join) + rest)],
    );
    let short = S::constant(0.5) - length;
    let stop = short.powi(3).scale(40.0 / 3.0);
    let stored = short.powi(4).scale(10.0 / 3.0);
    let is_long = |stop: S| piece(length, stop, &[(0.5, S::zero())]);
    [force - is_long(stop), energy * strain + is_long(stored)]
}

/// Force of the tendon over strain in parts of that at the largest force, and its integral.
pub(crate) fn tendon<S: Scalar>(z: S) -> [S; 2] {
    let e = 3f64.exp();
    // OpenSim's form of the end of the toe.
    let end = 99.0 * e / (166.0 * e - 67.0);
    let slope = 0.67 / (1.0 - end);
    let (a, c, w) = (0.33 / (e - 1.0), 3.0 / end, 0.1);
    let first = |z: S| hermite(z, (-w, [0.0; 3]), (w, toe(a, c, w)));
    let last = end + 0.5 * w;
    let line = [0.33 + slope * 0.5 * w, slope, 0.0];
    let second = |z: S| hermite(z, (end - w, toe(a, c, end - w)), (last, line));
    let curve = z.scale(c).exp().scale(a) - S::constant(a);
    let straight = (z - S::constant(end)).scale(slope) + S::constant(0.33);
    let force =
        piece(z, S::zero(), &[(-w, first(z)), (w, curve), (end - w, second(z)), (last, straight)]);
    let to = |z: S| {
        (z.scale(c).exp() - S::constant((c * w).exp())).scale(a / c) - (z - S::constant(w)).scale(a)
    };
    let one = gauss(-w, S::constant(w), first);
    let two = one + to(S::constant(end - w));
    let three = two + gauss(end - w, S::constant(last), second);
    let over = z - S::constant(last);
    let energy = piece(
        z,
        S::zero(),
        &[
            (-w, gauss(-w, z, first)),
            (w, one + to(z)),
            (end - w, two + gauss(end - w, z, second)),
            (last, three + over.scale(line[0]) + (over * over).scale(0.5 * slope)),
        ],
    );
    [force, energy]
}

/// 10u³ − 15u⁴ + 6u⁵ between 0 and 1.
fn step<S: Scalar>(u: S) -> S {
    let poly = u.powi(3).scale(10.0) - u.powi(4).scale(15.0) + u.powi(5).scale(6.0);
    piece(u, S::zero(), &[(0.0, poly), (1.0, S::one())])
}

/// Force over velocity.
pub(crate) fn velocity<S: Scalar>(v: S, eccentric: S) -> S {
    let one = S::one();
    let w = (eccentric - one).scale(1.0 / 20.0);
    let share = step((v / w + one).scale(0.5));
    let (plus, minus) = (share * v, v - share * v);
    let shortening = (one + minus) / (one - minus.scale(4.0));
    // v = (F − 1)(E − 1)/(10(E − F)) solved for F.
    let c = S::constant(10.0) * plus / (eccentric - one);
    shortening + (one + eccentric * c) / (one + c) - one
}

/// Rate of the activation.
pub(crate) fn activation<S: Scalar>(u: S, a: S, up: S, down: S) -> S {
    let share = step((u - a).scale(10.0) + S::constant(0.5));
    let scale = S::constant(0.5) + a.scale(1.5);
    (u - a) * (share / (up * scale) + (S::one() - share) * scale / down)
}
