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

mod link;
mod sum;

use super::inertia::{Inertia, Spatial};
use super::world::rotate_vector;
use super::{Mechanics, Terms, Workspace};
use crate::resolved::Axis;
use crate::vector::{Transform, Vec3};
use handc_core::scalar::Scalar;
use link::{Turned, run_inertia, turn_dot};
use sum::{entry, sum_even, sum_odd};

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
    /// Sine and cosine of an angle by which the run's axes are turned first. On the world they are
    /// those of the first link, where its vectors are constant: there is no motion to be turned.
    lead: Option<(S, S)>,
}

impl<S: Scalar> Scratch<S> {
    pub(crate) fn new() -> Self {
        Scratch {
            links: Vec::new(),
            even: Vec::new(),
            odd: Vec::new(),
            base: None,
            motion: Spatial::zero(),
            lead: None,
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

impl<S: Scalar> Mechanics<'_, S> {
    /// Places and moves a run whose parent is placed and moves; `is_base` if momenta are expressed
    /// in its axes.
    pub(crate) fn move_run(
        &self,
        workspace: &mut Workspace<S>,
        index: usize,
        is_base: bool,
        v: &[S],
    ) {
        let (run, numbers) = (&self.structure.runs[index], &self.numbers.runs[index]);
        let parent = run.parent.map(|parent| workspace.inertia.placed(parent));
        let (parent, motion) = parent.unwrap_or((Transform::identity(), Spatial::zero()));
        let scratch = &mut workspace.run;
        scratch.base = (!is_base).then(|| parent * numbers.parent_from_run);
        scratch.motion = if run.parent.is_some() { scratch.see(motion) } else { motion };
        scratch.links.clear();
        let mut rate = S::zero();
        let (mut s, mut c) = (S::zero(), S::one());
        scratch.lead = None;
        let (mut before, mut before_rate) = (Vec3::zero(), scratch.motion.linear);
        for (&link, numbers) in run.links.iter().zip(&numbers.links) {
            let (sine, cosine) = workspace.sin_cos[link as usize];
            if scratch.links.is_empty() && run.parent.is_none() {
                scratch.lead = Some((sine, cosine));
            } else {
                (s, c) = (s * cosine + c * sine, c * cosine - s * sine);
            }
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
    /// and those of its ancestors; without the mass matrix where inertia is left out.
    pub(crate) fn add_run(
        &self,
        workspace: &mut Workspace<S>,
        index: usize,
        gravity: Option<Vec3<S>>,
        is_static: bool,
        terms: &mut Terms<S>,
    ) {
        let (run, numbers) = (&self.structure.runs[index], &self.numbers.runs[index]);
        let scratch = &mut workspace.run;
        let gravity = gravity.map(|g| {
            let g = scratch.base.as_ref().map_or(g, |base| base.rotation.transpose_mul(g));
            scratch.lead.map_or(g, |(s, c)| rotate_vector(&Axis::Z, (-s, c), g))
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
        let (quarter, by_h) = (h.scale(0.25), if is_static { S::zero() } else { h.recip() });
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
        for (pair, (&even, &odd)) in run.inner.iter().zip(scratch.even.iter().zip(&scratch.odd)) {
            terms.add_pair(*pair, even, odd);
        }
        let mut outer = run.outer.iter();
        for &ancestor in &run.ancestors {
            let (screw, screw_dot) = workspace.inertia.screws(ancestor);
            let (screw, screw_dot) = (workspace.run.see(screw), workspace.run.see(screw_dot));
            let lean = gravity.map(|g| g.cross(screw.angular));
            let (mut even, mut odd) = (S::zero(), S::zero());
            let links = workspace.run.links.iter().zip(&numbers.links);
            for (turned, numbers) in links.rev() {
                let (dv, dq) = (turned.momentum_dv(numbers.polar), turned.momentum_dq());
                let mut stiffness = screw_dot.dot(&dq);
                if let Some(lean) = lean {
                    stiffness += turn_dot(turned.moment.vector, lean);
                }
                even += stiffness * quarter - screw.dot(&dv) * by_h;
                odd += (screw.dot(&dq) - screw_dot.dot(&dv)).scale(0.5);
                terms.add_pair(outer.next().copied().flatten(), even, odd);
            }
        }
    }

    /// M/h + ½∂p/∂q of a run that has been moved, between its own coordinates and between them and
    /// those of its ancestors.
    pub(crate) fn write_run_momentum_matrix(
        &self,
        workspace: &mut Workspace<S>,
        index: usize,
        by_h: S,
        mut write: impl FnMut(usize, usize, S),
    ) {
        let (run, numbers) = (&self.structure.runs[index], &self.numbers.runs[index]);
        let coordinate = |link: u32| self.structure.coordinate_of[link as usize];
        let half = S::constant(0.5);
        let scratch = &mut workspace.run;
        scratch.even.clear();
        scratch.odd.clear();
        for (i, turned) in scratch.links.iter().enumerate() {
            for before in &scratch.links[..i] {
                let (d, b) = (before.offset.vector, turned.moment.vector);
                let mass = d.0[0] * b.0[0] + d.0[1] * b.0[1];
                let lever = turn_dot(d, b).scale(0.25);
                let (own, other) = (turned.spin.0[2], before.spin.0[2]);
                scratch.even.push(mass * by_h + (other - own) * lever);
                scratch.odd.push((other + own) * lever);
            }
            scratch.even.push(numbers.links[i].polar * by_h + half * turned.momentum_dq_own());
            scratch.odd.push(S::zero());
        }
        sum_even(&mut scratch.even, run.links.len());
        sum_odd(&mut scratch.odd, run.links.len());
        for (i, &link) in run.links.iter().enumerate() {
            for (j, &before) in run.links[..=i].iter().enumerate() {
                let (even, odd) = (scratch.even[entry(i, j)], scratch.odd[entry(i, j)]);
                write(coordinate(link), coordinate(before), even + odd);
                if j < i {
                    write(coordinate(before), coordinate(link), even - odd);
                }
            }
        }
        for &ancestor in &run.ancestors {
            let (screw, screw_dot) = workspace.inertia.screws(ancestor);
            let (screw, screw_dot) = (workspace.run.see(screw), workspace.run.see(screw_dot));
            let (mut below, mut above) = (S::zero(), S::zero());
            let links = workspace.run.links.iter().zip(&numbers.links);
            for (&link, (turned, numbers)) in run.links.iter().zip(links).rev() {
                let (dv, dq) = (turned.momentum_dv(numbers.polar), turned.momentum_dq());
                let mass = screw.dot(&dv) * by_h;
                below += mass + half * screw_dot.dot(&dv);
                above += mass + half * screw.dot(&dq);
                write(coordinate(link), coordinate(ancestor), below);
                write(coordinate(ancestor), coordinate(link), above);
            }
        }
    }
}
