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
    /// x.
    vector: Vec3<S>,
    /// a × x, its derivative by the angle.
    turn: Vec3<S>,
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
    /// `hub_from_run`.
    base: Transform<S>,
    /// Motion of the base in the run's axes, at its first joint.
    motion: Spatial<S>,
}

impl<S: Scalar> Scratch<S> {
    pub(crate) fn new() -> Self {
        Scratch {
            links: Vec::new(),
            even: Vec::new(),
            odd: Vec::new(),
            base: Transform::identity(),
            motion: Spatial::zero(),
        }
    }
}

impl<S: Scalar> Carried<S> {
    #[inline]
    fn new(fixed: Vec3<S>, (s, c): (S, S), spin: Vec3<S>) -> Self {
        let [x, y, z] = fixed.0;
        let (x, y) = (x * c - y * s, y * c + x * s);
        let (vector, turn) = (Vec3([x, y, z]), Vec3([-y, x, S::zero()]));
        Carried { vector, turn, rate: spin.cross(vector), rate_turn: spin.cross(turn) }
    }
    /// Minus the second derivative of the rate by the angle, Ω × (x − a(a·x)).
    #[inline]
    fn rate_across(&self, spin: Vec3<S>) -> Vec3<S> {
        let ([x, y, _], z) = (spin.0, self.vector.0[2]);
        self.rate - Vec3([y * z, -(x * z), S::zero()])
    }
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
        self.offset.turn.dot(self.beyond_rate)
            + self.moment.turn.dot(self.before_rate)
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
        let angular = self.beyond.cross(self.offset.turn)
            + self.before.cross(self.moment.turn)
            + Vec3([xz, yz, polar]);
        Spatial { angular, linear: self.moment.turn }
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
        let angular = self.offset.turn.cross(self.beyond_rate)
            + self.moment.turn.cross(self.before_rate)
            + self.beyond.cross(self.offset.rate_turn)
            + self.before.cross(self.moment.rate_turn)
            + own;
        Spatial { angular, linear: self.moment.rate_turn }
    }
}

impl<S: Scalar> Mechanics<'_, S> {
    /// Places and moves a run whose parent is placed and moves.
    pub(crate) fn move_run(&self, workspace: &mut Workspace<S>, index: usize, v: &[S]) {
        let (run, numbers) = (&self.structure.runs[index], &self.numbers.runs[index]);
        let joint = &self.numbers.joints[run.links[0] as usize];
        let parent = run.parent.map(|parent| workspace.inertia.placed(parent));
        let (parent, motion) = parent.unwrap_or((Transform::identity(), Spatial::zero()));
        let scratch = &mut workspace.run;
        scratch.base = Transform {
            rotation: match joint.rotation {
                Some(rotation) => parent.rotation * rotation * numbers.axes,
                None => parent.rotation * numbers.axes,
            },
            translation: parent.point(joint.origin),
        };
        if run.parent.is_some() {
            scratch.motion = motion.seen_from(&scratch.base);
        } else {
            scratch.motion = Spatial::zero();
        }
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
        (inertia.carried_to(&scratch.base), momentum.force_carried_to(&scratch.base))
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
        let gravity = gravity.map(|g| scratch.base.rotation.transpose_mul(g));
        let (mut momentum, mut force) = (S::zero(), S::zero());
        for ((&link, numbers), turned) in
            run.links.iter().zip(&numbers.links).zip(&scratch.links).rev()
        {
            momentum += turned.momentum(numbers.polar);
            force += turned.force();
            if let Some(g) = gravity {
                force += turned.moment.turn.dot(g);
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
                let mass = before.offset.turn.dot(turned.moment.turn);
                let stiffness = before.offset.rate_turn.dot(turned.moment.rate_turn);
                let lever = before.offset.turn.dot(turned.moment.vector);
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
            let screw = screw.seen_from(&workspace.run.base);
            let screw_dot = screw_dot.seen_from(&workspace.run.base);
            let lean = gravity.map(|g| g.cross(screw.angular));
            let column = coordinate(ancestor);
            let (mut even, mut odd) = (S::zero(), S::zero());
            let links = workspace.run.links.iter().zip(&numbers.links);
            for (&link, (turned, numbers)) in run.links.iter().zip(links).rev() {
                let (dv, dq) = (turned.momentum_dv(numbers.polar), turned.momentum_dq());
                let mut stiffness = screw_dot.dot(&dq);
                if let Some(lean) = lean {
                    stiffness += lean.dot(turned.moment.turn);
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
                scratch.even.push(before.offset.turn.dot(turned.moment.turn));
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
            let screw = workspace.inertia.screws(ancestor).0.seen_from(&workspace.run.base);
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
