//! A link of a planar run in motion, and what turning it alone does.

use crate::mechanics::inertia::{Inertia, Spatial};
use crate::run::{ResolvedRun, RunLink};
use crate::vector::Vec3;
use handc_core::scalar::Scalar;

/// A link of a run in motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turned<S> {
    /// θ̇ over the base.
    pub(super) rate: S,
    /// Ω.
    pub(super) spin: Vec3<S>,
    pub(super) offset: Carried<S>,
    pub(super) moment: Carried<S>,
    /// (J_xx − J_yy)/2 and J_xy.
    pub(super) deviator: [S; 2],
    /// J_xz and J_yz.
    pub(super) tilt: [S; 2],
    /// Offsets of the links before, and the rates of these with the base's.
    pub(super) before: Vec3<S>,
    pub(super) before_rate: Vec3<S>,
    /// Moments of the links beyond, and their rates.
    pub(super) beyond: Vec3<S>,
    pub(super) beyond_rate: Vec3<S>,
}

/// A vector x fixed in a link.
#[derive(Clone, Copy, Debug)]
pub(super) struct Carried<S> {
    /// x; its derivative by the angle is a × x.
    pub(super) vector: Vec3<S>,
    /// Ω × x, its rate.
    pub(super) rate: Vec3<S>,
    /// Ω × (a × x).
    pub(super) rate_turn: Vec3<S>,
}

impl<S: Scalar> Carried<S> {
    #[inline]
    fn new(fixed: Vec3<S>, (s, c): (S, S), spin: Vec3<S>) -> Self {
        let [x, y, z] = fixed.0;
        let (x, y) = (x * c - y * s, y * c + x * s);
        let vector = Vec3([x, y, z]);
        Carried { vector, rate: spin.cross(vector), rate_turn: cross_turn(spin, vector) }
    }
    /// Minus the second derivative of the rate by the angle, Ω × (x − a(a·x)).
    #[inline]
    fn rate_across(&self, spin: Vec3<S>) -> Vec3<S> {
        let ([x, y, _], z) = (spin.0, self.vector.0[2]);
        self.rate - Vec3([y * z, -(x * z), S::zero()])
    }
}

/// (a × x)·v.
#[inline]
pub(super) fn turn_dot<S: Scalar>(x: Vec3<S>, v: Vec3<S>) -> S {
    x.0[0] * v.0[1] - x.0[1] * v.0[0]
}

/// v × (a × x).
#[inline]
fn cross_turn<S: Scalar>(v: Vec3<S>, x: Vec3<S>) -> Vec3<S> {
    let ([vx, vy, vz], [x, y, _]) = (v.0, x.0);
    Vec3([-(vz * x), -(vz * y), vx * x + vy * y])
}

impl<S: Scalar> Turned<S> {
    pub(super) fn new(link: &RunLink<S>, (s, c): (S, S), rate: S, base_spin: Vec3<S>) -> Self {
        let [x, y, z] = base_spin.0;
        let spin = Vec3([x, y, z + rate]);
        let ([half, mixed], [xz, yz]) = (link.deviator, link.tilt);
        let twice = half.scale(2.0) * s + mixed.scale(2.0) * c;
        let zero = Vec3::zero();
        Turned {
            rate,
            spin,
            offset: Carried::new(link.offset, (s, c), spin),
            moment: Carried::new(link.moment, (s, c), spin),
            deviator: [half - s * twice, c * twice - mixed],
            tilt: [xz * c - yz * s, yz * c + xz * s],
            before: zero,
            before_rate: zero,
            beyond: zero,
            beyond_rate: zero,
        }
    }
    /// ∂T/∂θ̇.
    #[inline]
    pub(super) fn momentum(&self, polar: S) -> S {
        let ([x, y, z], [xz, yz]) = (self.spin.0, self.tilt);
        turn_dot(self.offset.vector, self.beyond_rate)
            + turn_dot(self.moment.vector, self.before_rate)
            + (xz * x + yz * y + polar * z)
    }
    /// ∂²T/∂θ∂θ̇.
    #[inline]
    pub(super) fn momentum_dq_own(&self) -> S {
        let ([x, y, _], [xz, yz]) = (self.spin.0, self.tilt);
        let across = |x: Vec3<S>, v: Vec3<S>| x.0[0] * v.0[0] + x.0[1] * v.0[1];
        xz * y
            - yz * x
            - across(self.offset.vector, self.beyond_rate)
            - across(self.moment.vector, self.before_rate)
    }
    /// ∂T/∂θ.
    #[inline]
    pub(super) fn force(&self) -> S {
        let ([x, y, z], [half, mixed], [xz, yz]) = (self.spin.0, self.deviator, self.tilt);
        self.offset.rate_turn.dot(self.beyond_rate)
            + self.moment.rate_turn.dot(self.before_rate)
            + (mixed * (y * y - x * x) + half * (x * y).scale(2.0) + z * (xz * y - yz * x))
    }
    /// ∂²T/∂θ².
    #[inline]
    pub(super) fn stiffness(&self) -> S {
        let ([x, y, z], [half, mixed], [xz, yz]) = (self.spin.0, self.deviator, self.tilt);
        half * (y * y - x * x).scale(2.0)
            - mixed * (x * y).scale(4.0)
            - z * (xz * x + yz * y)
            - self.offset.rate_across(self.spin).dot(self.beyond_rate)
            - self.moment.rate_across(self.spin).dot(self.before_rate)
    }
    /// Momentum of the run per unit of θ̇.
    #[inline]
    pub(super) fn momentum_dv(&self, polar: S) -> Spatial<S> {
        let [xz, yz] = self.tilt;
        let angular = cross_turn(self.beyond, self.offset.vector)
            + cross_turn(self.before, self.moment.vector)
            + Vec3([xz, yz, polar]);
        let [x, y, _] = self.moment.vector.0;
        Spatial { angular, linear: Vec3([-y, x, S::zero()]) }
    }
    /// Derivative of the run's momentum by θ.
    #[inline]
    pub(super) fn momentum_dq(&self) -> Spatial<S> {
        let ([x, y, z], [half, mixed], [xz, yz]) = (self.spin.0, self.deviator, self.tilt);
        let (x2, y2) = (x.scale(2.0), y.scale(2.0));
        let own = Vec3([
            half * y2 - mixed * x2 - yz * z,
            half * x2 + mixed * y2 + xz * z,
            xz * y - yz * x,
        ]);
        let angular = self.beyond.cross(self.offset.rate_turn)
            + self.before.cross(self.moment.rate_turn)
            - cross_turn(self.beyond_rate, self.offset.vector)
            - cross_turn(self.before_rate, self.moment.vector)
            + own;
        Spatial { angular, linear: self.moment.rate_turn }
    }
}

/// Inertia of the whole run at its first joint, in its axes.
pub(super) fn run_inertia<S: Scalar>(numbers: &ResolvedRun<S>, links: &[Turned<S>]) -> Inertia<S> {
    let mut inertia = Inertia::zero();
    inertia.mass = numbers.mass;
    let (mut mean, mut polar) = (S::zero(), S::zero());
    for link in &numbers.links {
        mean += link.mean;
        polar += link.polar;
    }
    inertia.rotational = [mean, mean, polar, S::zero(), S::zero(), S::zero()];
    for turned in links {
        inertia.moment += turned.moment.vector;
        let ([half, mixed], [xz, yz]) = (turned.deviator, turned.tilt);
        let ([x, y, z], [bx, by, bz]) = (turned.offset.vector.0, turned.beyond.0);
        let (xx, yy, zz) = ((x * bx).scale(2.0), (y * by).scale(2.0), (z * bz).scale(2.0));
        let cross = |a: S, b: S, c: S, d: S| a * b + c * d;
        let parts = [
            half + (yy + zz),
            (xx + zz) - half,
            xx + yy,
            mixed - cross(x, by, y, bx),
            xz - cross(x, bz, z, bx),
            yz - cross(y, bz, z, by),
        ];
        for (sum, part) in inertia.rotational.iter_mut().zip(parts) {
            *sum += part;
        }
    }
    inertia
}
