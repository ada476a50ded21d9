//! Kinetic energy and gravity of planar runs, in absolute angles.
//!
//! In axes whose third, a, is that of the joints, with the base of the run turning at ω and moving
//! at u, link i has the rate Ω_i = ω + a·θ̇_i and adds its vectors dᵢ (to its far joint) and bᵢ (mass
//! carried, times centre). All sums over pairs of links then run over what lies before and beyond:
//!
//! T = ½M u² + u·Σ Ωᵢ×bᵢ + ½ Σ Ωᵢ·JᵢΩᵢ + Σ_{i<j} (Ωᵢ×dᵢ)·(Ωⱼ×bⱼ)
//!
//! Turning link i alone turns dᵢ, bᵢ and Jᵢ, which gives every derivative by θᵢ. Coordinates are the
//! differences of the angles, so that momenta, forces and matrices become sums from the tip.

use super::inertia::{Inertia, Spatial};
use super::{Mechanics, Terms, Workspace};
use crate::run::{ResolvedRun, RunLink};
use crate::vector::{Transform, Vec3};
use handc_core::scalar::Scalar;

/// A link of a run in motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turned<S> {
    /// θ̇ over the base.
    rate: S,
    /// Ω.
    spin: Vec3<S>,
    offset: Carried<S>,
    moment: Carried<S>,
    /// (J_xx − J_yy)/2 and J_xy.
    deviator: [S; 2],
    /// J_xz and J_yz.
    tilt: [S; 2],
    /// Offsets of the links before, and the rates of these with the base's.
    before: Vec3<S>,
    before_rate: Vec3<S>,
    /// Moments of the links beyond, and their rates.
    beyond: Vec3<S>,
    beyond_rate: Vec3<S>,
}

/// A vector x fixed in a link.
#[derive(Clone, Copy, Debug)]
struct Carried<S> {
    /// x; its derivative by the angle is a × x.
    vector: Vec3<S>,
    /// Ω × x, its rate.
    rate: Vec3<S>,
    /// Ω × (a × x).
    rate_turn: Vec3<S>,
}

/// Scratch of one run.
#[derive(Clone, Debug)]
pub(crate) struct Scratch<S> {
    links: Vec<Turned<S>>,
    /// Even and odd parts of a matrix over the angles, lower triangles.
    even: Vec<S>,
    odd: Vec<S>,
    /// `hub_from_run`; `None` is the identity.
    base: Option<Transform<S>>,
    /// Motion of the base in the run's axes, at its first joint.
    motion: Spatial<S>,
}

impl<S: Scalar> Scratch<S> {
    pub(crate) fn new() -> Self {
        Scratch {
            links: Vec::new(),
            even: Vec::new(),
            odd: Vec::new(),
            base: None,
            motion: Spatial::zero(),
        }
    }
}

impl<S: Scalar> Scratch<S> {
    /// A motion in the axes of the run.
    #[inline]
    fn see(&self, motion: Spatial<S>) -> Spatial<S> {
        self.base.as_ref().map_or(motion, |base| motion.seen_from(base))
    }
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
fn turn_dot<S: Scalar>(x: Vec3<S>, v: Vec3<S>) -> S {
    x.0[0] * v.0[1] - x.0[1] * v.0[0]
}

/// v × (a × x).
#[inline]
fn cross_turn<S: Scalar>(v: Vec3<S>, x: Vec3<S>) -> Vec3<S> {
    let ([vx, vy, vz], [x, y, _]) = (v.0, x.0);
    Vec3([-(vz * x), -(vz * y), vx * x + vy * y])
}

impl<S: Scalar> Turned<S> {
    fn new(link: &RunLink<S>, (s, c): (S, S), rate: S, base_spin: Vec3<S>) -> Self {
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
    fn momentum(&self, polar: S) -> S {
        let ([x, y, z], [xz, yz]) = (self.spin.0, self.tilt);
        turn_dot(self.offset.vector, self.beyond_rate)
            + turn_dot(self.moment.vector, self.before_rate)
            + (xz * x + yz * y + polar * z)
    }
    /// ∂T/∂θ.
    #[inline]
    fn force(&self) -> S {
        let ([x, y, z], [half, mixed], [xz, yz]) = (self.spin.0, self.deviator, self.tilt);
        self.offset.rate_turn.dot(self.beyond_rate)
            + self.moment.rate_turn.dot(self.before_rate)
            + (mixed * (y * y - x * x) + half * (x * y).scale(2.0) + z * (xz * y - yz * x))
    }
    /// ∂²T/∂θ².
    #[inline]
    fn stiffness(&self) -> S {
        let ([x, y, z], [half, mixed], [xz, yz]) = (self.spin.0, self.deviator, self.tilt);
        half * (y * y - x * x).scale(2.0)
            - mixed * (x * y).scale(4.0)
            - z * (xz * x + yz * y)
            - self.offset.rate_across(self.spin).dot(self.beyond_rate)
            - self.moment.rate_across(self.spin).dot(self.before_rate)
    }
    /// Momentum of the run per unit of θ̇.
    #[inline]
    fn momentum_dv(&self, polar: S) -> Spatial<S> {
        let [xz, yz] = self.tilt;
        let angular = cross_turn(self.beyond, self.offset.vector)
            + cross_turn(self.before, self.moment.vector)
            + Vec3([xz, yz, polar]);
        let [x, y, _] = self.moment.vector.0;
        Spatial { angular, linear: Vec3([-y, x, S::zero()]) }
    }
    /// Derivative of the run's momentum by θ.
    #[inline]
    fn momentum_dq(&self) -> Spatial<S> {
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

impl<S: Scalar> Mechanics<'_, S> {
    /// Places and moves a run whose parent is placed and moves.
    pub(crate) fn move_run(&self, workspace: &mut Workspace<S>, index: usize, v: &[S]) {
        let (run, numbers) = (&self.structure.runs[index], &self.numbers.runs[index]);
        let parent = run.parent.map(|parent| workspace.inertia.placed(parent));
        let (parent, motion) = parent.unwrap_or((Transform::identity(), Spatial::zero()));
        let scratch = &mut workspace.run;
        scratch.base = (!run.is_hub).then(|| parent * numbers.parent_from_run);
        scratch.motion = if run.parent.is_some() { scratch.see(motion) } else { motion };
        scratch.links.clear();
        let mut rate = S::zero();
        let (mut s, mut c) = (S::zero(), S::one());
        let (mut before, mut before_rate) = (Vec3::zero(), scratch.motion.linear);
        for (&link, numbers) in run.links.iter().zip(&numbers.links) {
            let (sine, cosine) = workspace.sin_cos[link as usize];
            (s, c) = (s * cosine + c * sine, c * cosine - s * sine);
            rate += v[self.structure.coordinate_of[link as usize]];
            let mut turned = Turned::new(numbers, (s, c), rate, scratch.motion.angular);
            (turned.before, turned.before_rate) = (before, before_rate);
            before += turned.offset.vector;
            before_rate += turned.offset.rate;
            scratch.links.push(turned);
        }
        let (mut beyond, mut beyond_rate) = (Vec3::zero(), Vec3::zero());
        for turned in scratch.links.iter_mut().rev() {
            (turned.beyond, turned.beyond_rate) = (beyond, beyond_rate);
            beyond += turned.moment.vector;
            beyond_rate += turned.moment.rate;
        }
    }

    /// Inertia and momentum of a run that has been moved, in the hub.
    pub(crate) fn sum_run(
        &self,
        workspace: &Workspace<S>,
        index: usize,
    ) -> (Inertia<S>, Spatial<S>) {
        let (numbers, scratch) = (&self.numbers.runs[index], &workspace.run);
        let inertia = run_inertia(numbers, &scratch.links);
        let mut momentum = inertia.times(&scratch.motion);
        for (turned, link) in scratch.links.iter().zip(&numbers.links) {
            momentum = momentum.plus(&turned.momentum_dv(link.polar).scale(turned.rate));
        }
        match &scratch.base {
            Some(base) => (inertia.carried_to(base), momentum.force_carried_to(base)),
            None => (inertia, momentum),
        }
    }

    /// Adds what a run that has been moved does to its own coordinates, and the matrix between them
    /// and those of its ancestors.
    pub(crate) fn add_run(
        &self,
        workspace: &mut Workspace<S>,
        index: usize,
        gravity: Option<Vec3<S>>,
        terms: &mut Terms<S>,
    ) {
        let (run, numbers) = (&self.structure.runs[index], &self.numbers.runs[index]);
        let scratch = &mut workspace.run;
        let gravity = gravity.map(|g| match &scratch.base {
            Some(base) => base.rotation.transpose_mul(g),
            None => g,
        });
        let (mut momentum, mut force) = (S::zero(), S::zero());
        for ((&link, numbers), turned) in
            run.links.iter().zip(&numbers.links).zip(&scratch.links).rev()
        {
            momentum += turned.momentum(numbers.polar);
            force += turned.force();
            if let Some(g) = gravity {
                force += turn_dot(turned.moment.vector, g);
            }
            let row = self.structure.coordinate_of[link as usize];
            terms.momentum[row] += momentum;
            terms.force[row] += force;
        }
        let Some((h, _)) = terms.matrix else { return };
        let (quarter, by_h) = (h.scale(0.25), h.recip());
        scratch.even.clear();
        scratch.odd.clear();
        for (i, turned) in scratch.links.iter().enumerate() {
            for before in &scratch.links[..i] {
                let (d, b) = (before.offset.vector, turned.moment.vector);
                let mass = d.0[0] * b.0[0] + d.0[1] * b.0[1];
                let stiffness = before.offset.rate_turn.dot(turned.moment.rate_turn);
                let lever = turn_dot(d, b);
                let spin = (before.spin.0[2] + turned.spin.0[2]).scale(0.5);
                scratch.even.push(stiffness * quarter - mass * by_h);
                scratch.odd.push(-(spin * lever));
            }
            let mut stiffness = turned.stiffness();
            if let Some(g) = gravity {
                let ([x, y, _], [g_x, g_y, _]) = (turned.moment.vector.0, g.0);
                stiffness -= g_x * x + g_y * y;
            }
            scratch.even.push(stiffness * quarter - numbers.links[i].polar * by_h);
            scratch.odd.push(S::zero());
        }
        sum_even(&mut scratch.even, run.links.len());
        sum_odd(&mut scratch.odd, run.links.len());
        let coordinate = |link: u32| self.structure.coordinate_of[link as usize];
        for (i, &link) in run.links.iter().enumerate() {
            let row = coordinate(link);
            for (j, &before) in run.links[..i].iter().enumerate() {
                let (even, odd) = (scratch.even[entry(i, j)], scratch.odd[entry(i, j)]);
                terms.add_pair(self.structure, row, coordinate(before), even, odd);
            }
            terms.add(self.structure, row, row, scratch.even[entry(i, i)]);
        }
        for &ancestor in &run.ancestors {
            let (screw, screw_dot) = workspace.inertia.screws(ancestor);
            let (screw, screw_dot) = (workspace.run.see(screw), workspace.run.see(screw_dot));
            let lean = gravity.map(|g| g.cross(screw.angular));
            let column = coordinate(ancestor);
            let (mut even, mut odd) = (S::zero(), S::zero());
            let links = workspace.run.links.iter().zip(&numbers.links);
            for (&link, (turned, numbers)) in run.links.iter().zip(links).rev() {
                let (dv, dq) = (turned.momentum_dv(numbers.polar), turned.momentum_dq());
                let mut stiffness = screw_dot.dot(&dq);
                if let Some(lean) = lean {
                    stiffness += turn_dot(turned.moment.vector, lean);
                }
                even += stiffness * quarter - screw.dot(&dv) * by_h;
                odd += (screw.dot(&dq) - screw_dot.dot(&dv)).scale(0.5);
                terms.add_pair(self.structure, coordinate(link), column, even, odd);
            }
        }
    }

    /// The mass matrix of a run that has been moved, written to both sides of `matrix`.
    pub(crate) fn write_run_mass(
        &self,
        workspace: &mut Workspace<S>,
        index: usize,
        mut write: impl FnMut(usize, usize, S),
    ) {
        let (run, numbers) = (&self.structure.runs[index], &self.numbers.runs[index]);
        let coordinate = |link: u32| self.structure.coordinate_of[link as usize];
        let scratch = &mut workspace.run;
        scratch.even.clear();
        for (i, turned) in scratch.links.iter().enumerate() {
            for before in &scratch.links[..i] {
                let (d, b) = (before.offset.vector, turned.moment.vector);
                scratch.even.push(d.0[0] * b.0[0] + d.0[1] * b.0[1]);
            }
            scratch.even.push(numbers.links[i].polar);
        }
        sum_even(&mut scratch.even, run.links.len());
        for (i, &link) in run.links.iter().enumerate() {
            for (j, &before) in run.links[..=i].iter().enumerate() {
                write(coordinate(link), coordinate(before), scratch.even[entry(i, j)]);
            }
        }
        for &ancestor in &run.ancestors {
            let screw = workspace.run.see(workspace.inertia.screws(ancestor).0);
            let mut mass = S::zero();
            let links = workspace.run.links.iter().zip(&numbers.links);
            for (&link, (turned, numbers)) in run.links.iter().zip(links).rev() {
                mass += screw.dot(&turned.momentum_dv(numbers.polar));
                write(coordinate(link), coordinate(ancestor), mass);
            }
        }
    }
}

/// Inertia of the whole run at its first joint, in its axes.
fn run_inertia<S: Scalar>(numbers: &ResolvedRun<S>, links: &[Turned<S>]) -> Inertia<S> {
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

/// Where (i, j), j ≤ i, stands in a lower triangle.
#[inline]
fn entry(i: usize, j: usize) -> usize {
    i * (i + 1) / 2 + j
}

/// From a symmetric matrix over absolute angles to one over their differences: entry (i, j) becomes
/// the sum over all (a, b) with a ≥ i and b ≥ j.
fn sum_even<S: Scalar>(matrix: &mut [S], count: usize) {
    for i in (0..count - 1).rev() {
        for j in 0..=i {
            let below = matrix[entry(i + 1, j)];
            matrix[entry(i, j)] += below;
        }
    }
    for i in (0..count).rev() {
        for j in (0..=i).rev() {
            // Beyond the diagonal stands the mirrored entry.
            let (a, b) = if j == i { (i + 1, i) } else { (i, j + 1) };
            if a < count {
                let right = matrix[entry(a, b)];
                matrix[entry(i, j)] += right;
            }
        }
    }
}

/// As [`sum_even`] for an antisymmetric matrix, whose sums on the diagonal vanish.
fn sum_odd<S: Scalar>(matrix: &mut [S], count: usize) {
    for i in (0..count - 1).rev() {
        for j in 0..i {
            let below = matrix[entry(i + 1, j)];
            matrix[entry(i, j)] += below;
        }
    }
    for i in (1..count).rev() {
        for j in (0..i - 1).rev() {
            let right = matrix[entry(i, j + 1)];
            matrix[entry(i, j)] += right;
        }
    }
}
