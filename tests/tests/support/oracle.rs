//! A second way to the mechanics: the Lagrangian from the poses of bodies and points, differentiated
//! by dual numbers.
//!
//! Shares with the kernels the poses of links and nothing else: no screws, no lumped bodies, no
//! hubs, no segments. Slow and plain.

#[path = "muscle.rs"]
mod muscle;

use handc_core::scalar::{Comparison, Scalar};
use handc_runtime::dual::Dual;
use handc_runtime::expression::{Function, Own, Variable};
use handc_runtime::mechanics::{At, Mechanics, Workspace};
use handc_runtime::mechanism::{
    Law, Mechanism, Muscle, Number, Point, Role, Strand, SurfaceForm, Wrap,
};
use handc_runtime::resolved::Resolved;
use handc_runtime::structure::Structure;
use handc_runtime::vector::{Transform, Vec3};

/// A mechanism with its default parameters.
#[derive(Debug)]
pub(crate) struct Oracle<'a> {
    /// Constant data.
    pub(crate) mechanism: &'a Mechanism,
    /// Its shape.
    pub(crate) structure: Structure,
}

/// About what a way turns at the start, and by how much (rad).
type Start = Option<(Vec3<f64>, f64)>;

impl<'a> Oracle<'a> {
    /// Analyses a mechanism.
    pub(crate) fn new(mechanism: &'a Mechanism) -> Self {
        Oracle { mechanism, structure: Structure::new(mechanism) }
    }

    /// Numbers over any scalar.
    pub(crate) fn numbers<S: Scalar>(&self) -> Resolved<S> {
        let params: Vec<S> = self.mechanism.params.iter().map(|p| S::constant(p.default)).collect();
        Resolved::new(self.mechanism, &params)
    }

    /// Calls `f` with the kernels over the scalar S.
    pub(crate) fn kernels<S: Scalar, R>(
        &self,
        f: impl FnOnce(&Mechanics<S>, &mut Workspace<S>) -> R,
    ) -> R {
        let numbers = self.numbers();
        let (mechanism, structure) = (self.mechanism, &self.structure);
        f(&Mechanics { mechanism, structure, numbers: &numbers }, &mut Workspace::new(structure))
    }

    fn poses<S: Scalar>(&self, q: &[S]) -> Vec<Transform<S>> {
        self.kernels(|mechanics, workspace| mechanics.link_poses(workspace, q))
    }

    fn place<S: Scalar>(poses: &[Transform<S>], numbers: &Resolved<S>, point: &Point) -> Vec3<S> {
        let position = numbers.vector(&point.position);
        point.link.map_or(position, |link| poses[link as usize].point(position))
    }

    /// Kinetic energy: each body by the rates of its centre and of its axes.
    pub(crate) fn kinetic<S: Scalar>(&self, q: &[S], v: &[S]) -> S {
        let moving: Vec<Dual<S>> =
            q.iter().zip(v).map(|(&value, &slope)| Dual { value, slope }).collect();
        let poses = self.poses(&moving);
        let numbers: Resolved<Dual<S>> = self.numbers();
        let mut energy = S::zero();
        for body in &self.mechanism.bodies {
            let Some(link) = body.link else { continue };
            if self.is_weighed_only(link) {
                continue;
            }
            let pose = &poses[link as usize];
            let rate = Vec3(pose.point(numbers.vector(&body.center)).0.map(|x| x.slope));
            let mass = numbers.number(body.mass).value;
            energy += (mass * rate.norm_squared()).scale(0.5);
            // ½ tr(Ṙ J Ṙᵀ) with J = ½ tr(I) E − I.
            let [xx, yy, zz, xy, xz, yz] = body.inertia.map(|i| numbers.number(i).value);
            let half = (xx + yy + zz).scale(0.5);
            let rows = [[half - xx, -xy, -xz], [-xy, half - yy, -yz], [-xz, -yz, half - zz]];
            for row in pose.rotation.0 {
                let rate = Vec3(row.map(|x| x.slope));
                let turned = Vec3(rows.map(|row| Vec3(row).dot(rate)));
                energy += rate.dot(turned).scale(0.5);
            }
        }
        energy
    }

    /// Whether quasi-static strands span every joint of the tree that carries a link.
    fn is_weighed_only(&self, link: u32) -> bool {
        let root = |mut link: u32| {
            while let Some(parent) = self.mechanism.links[link as usize].parent {
                link = parent;
            }
            link
        };
        let spanned: Vec<usize> = self
            .mechanism
            .strands
            .iter()
            .zip(&self.structure.strands)
            .filter(|(strand, _)| strand.quasi_static)
            .flat_map(|(_, path)| path.coordinates.clone())
            .collect();
        let carries = |l: usize| {
            let below = |body: &handc_runtime::mechanism::Body| {
                body.link.is_some_and(|b| self.structure.chain(Some(b)).contains(&(l as u32)))
            };
            self.mechanism.bodies.iter().any(below)
        };
        (0..self.mechanism.links.len())
            .filter(|&l| root(l as u32) == root(link) && carries(l))
            .all(|l| spanned.contains(&(self.mechanism.links[l].coordinate as usize)))
    }

    /// Lengths of the strands, point to point in the world, round the surfaces between.
    pub(crate) fn lengths<S: Scalar>(&self, q: &[S]) -> Vec<S> {
        let (poses, numbers) = (self.poses(q), self.numbers());
        let length = |strand: &Strand| {
            let mut sum = S::zero();
            for (gap, pair) in strand.points.windows(2).enumerate() {
                let [a, b] = [0, 1].map(|i| Self::place(&poses, &numbers, &pair[i]));
                sum += match strand.wrap(gap) {
                    None => (b - a).norm_squared().sqrt(),
                    Some(wrap) => {
                        let start = self.start(strand, wrap);
                        Self::way(&poses, &numbers, wrap, ([a, b], &start))
                    }
                };
            }
            sum
        };
        self.mechanism.strands.iter().map(length).collect()
    }

    /// Length of the way over a surface by angles, in the world. Over a cylinder, and over a sphere with
    /// a hint, the angle is followed from the start.
    fn way<S: Scalar>(
        poses: &[Transform<S>],
        numbers: &Resolved<S>,
        wrap: &Wrap,
        (points, start): ([Vec3<S>; 2], &Start),
    ) -> S {
        let center = Self::place(poses, numbers, &wrap.center);
        let turned = |v: Vec3<S>| wrap.center.link.map_or(v, |l| poses[l as usize].rotation * v);
        let mut arms = points.map(|point| point - center);
        let mut rise = S::zero();
        if let SurfaceForm::Cylinder { axis } = &wrap.form {
            let axis = turned(numbers.vector(axis));
            rise = axis.dot(arms[1] - arms[0]);
            arms = arms.map(|arm| arm - axis.scale(axis.dot(arm)));
        }
        let (r, o) = (numbers.number(wrap.radius), S::zero());
        let norms = arms.map(|arm| arm.norm_squared().sqrt());
        let turn = arms[0].cross(arms[1]);
        let mut angle = turn.norm_squared().sqrt().atan2(arms[0].dot(arms[1]));
        if let Some((about, first)) = start {
            let about = turned(Vec3(about.0.map(S::constant)));
            angle = S::select(Comparison::Less, about.dot(turn), o, -angle, angle);
            let whole = S::constant(std::f64::consts::TAU);
            let low = S::constant((first - std::f64::consts::PI).min(0.0));
            angle = S::select(Comparison::Less, angle, low, angle + whole, angle).abs();
        }
        let mut flat = S::zero();
        for norm in norms {
            flat += (norm * norm - r * r).sqrt();
            angle -= (r / norm).acos();
        }
        flat += r * angle;
        let straight = (points[1] - points[0]).norm_squared().sqrt();
        let bent = (flat * flat + rise * rise).sqrt();
        S::select(Comparison::Less, o, angle, bent, straight)
    }

    /// About what a way turns where the model starts, in the axes of the surface's link, and by how
    /// much; `None` where it is always the shorter way.
    fn start(&self, strand: &Strand, wrap: &Wrap) -> Start {
        if wrap.side.is_none() && wrap.form == SurfaceForm::Sphere {
            return None;
        }
        let numbers = self.numbers::<f64>();
        let starts = self.mechanism.coordinates.iter().map(|c| numbers.number(c.start));
        let poses = self.poses(&starts.collect::<Vec<f64>>());
        let local =
            |v: Vec3<f64>| wrap.center.link.map_or(v, |l| poses[l as usize].inverse_point(v));
        let center = numbers.vector(&wrap.center.position);
        let arms = [0, 1].map(|k| {
            let point = &strand.points[wrap.gap as usize + k];
            let arm = local(Self::place(&poses, &numbers, point)) - center;
            match &wrap.form {
                SurfaceForm::Sphere => arm,
                SurfaceForm::Cylinder { axis } => {
                    let axis = numbers.vector(axis);
                    arm - axis.scale(axis.dot(arm))
                }
            }
        });
        let unit = |v: Vec3<f64>| v.scale(1.0 / v.norm_squared().sqrt());
        let (turn, cosine) = (arms[0].cross(arms[1]), arms[0].dot(arms[1]));
        let angle = turn.norm_squared().sqrt().atan2(cosine);
        let middle = unit(arms[0]) + unit(arms[1]);
        let is_far = wrap.side.is_some_and(|side| numbers.vector(&side).dot(middle) < 0.0);
        Some(if is_far { (-turn, std::f64::consts::TAU - angle) } else { (turn, angle) })
    }

    /// Energy of a strand by its length.
    fn strand_energy<S: Scalar>(
        &self,
        numbers: &Resolved<S>,
        index: usize,
        q: &[S],
        (length, rest): (S, S),
    ) -> S {
        let strand = &self.mechanism.strands[index];
        let (stretch, seen) = match strand.slack {
            Some(width) => {
                let ramp = ramp(length - rest, numbers.number(width));
                (ramp, rest + ramp)
            }
            None => (length - rest, length),
        };
        let read = |variable| match variable {
            Variable::Own(Own::Length) => seen,
            Variable::Own(Own::Rest) => rest,
            Variable::Param(p) => numbers.params[p as usize],
            _ => S::constant(f64::NAN),
        };
        match &strand.law {
            Law::Linear { stiffness } => {
                (numbers.number(*stiffness) * stretch * stretch).scale(0.5)
            }
            Law::Energy(program) => program.value(read),
            Law::Tension(function) if is_constant(function) => seen * function.program.value(read),
            Law::Tension(_) | Law::Prescribed => S::zero(),
            Law::Muscle(muscle) => Pieces::new(muscle, numbers).energy(length, q),
        }
    }

    /// Σ φ_k·∂d_k/∂q of a strand that slides over its points with friction.
    fn sliding(&self, index: usize, q: &[f64], v: &[f64], numbers: &Resolved<f64>) -> Vec<f64> {
        let strand = &self.mechanism.strands[index];
        let friction = strand.friction.expect("a strand with friction");
        let [mu, slow] = [friction.coefficient, friction.speed].map(|n| numbers.number(n));
        let points = |q: &[Dual<f64>]| -> Vec<Vec3<Dual<f64>>> {
            let (poses, numbers) = (self.poses(q), self.numbers());
            let mut distinct = strand.points.clone();
            distinct.dedup();
            distinct.iter().map(|p| Self::place(&poses, &numbers, p)).collect()
        };
        let slopes: Vec<Vec<f64>> = (0..q.len())
            .map(|j| {
                let p = points(&seeded(q, j));
                p.windows(2).map(|ab| (ab[1] - ab[0]).norm_squared().sqrt().slope).collect()
            })
            .collect();
        let here: Vec<[f64; 3]> = points(&fixed(q)).iter().map(|p| p.0.map(|x| x.value)).collect();
        let along: Vec<[f64; 3]> = here
            .windows(2)
            .map(|ab| {
                let d = [0, 1, 2].map(|i| ab[1][i] - ab[0][i]);
                let size = d.iter().map(|x| x * x).sum::<f64>().sqrt();
                d.map(|x| x / size)
            })
            .collect();
        let segments = along.len();
        let rate = |k: usize| -> f64 { slopes.iter().zip(v).map(|(s, v)| s[k] * v).sum() };
        let mut factors = vec![1.0; segments];
        for k in 1..segments {
            let out: f64 = (k..segments).map(rate).sum();
            let cosine: f64 = along[k - 1].iter().zip(&along[k]).map(|(a, b)| a * b).sum();
            let smooth = |square: f64| (square + 1e-8).sqrt();
            let bend = 2.0 * smooth(2.0 - 2.0 * cosine).atan2(smooth(2.0 + 2.0 * cosine));
            factors[k] = factors[k - 1] * (mu * bend * out / out.hypot(slow)).exp();
        }
        slopes.iter().map(|s| s.iter().zip(&factors).map(|(d, f)| d * f).sum()).collect()
    }

    /// Potential energy: gravity, strands, springs, elastic limits.
    pub(crate) fn potential<S: Scalar>(&self, q: &[S], rest: &[S]) -> S {
        let (poses, numbers): (_, Resolved<S>) = (self.poses(q), self.numbers());
        let mut energy = S::zero();
        let spring = |k: S, x: S| (k * x * x).scale(0.5);
        let gravity = numbers.vector(&self.mechanism.gravity);
        for body in &self.mechanism.bodies {
            let center =
                Self::place(&poses, &numbers, &Point { link: body.link, position: body.center });
            energy -= numbers.number(body.mass) * gravity.dot(center);
        }
        for (i, length) in self.lengths(q).into_iter().enumerate() {
            energy += self.strand_energy(&numbers, i, q, (length, rest[i]));
        }
        for (c, &q) in self.mechanism.coordinates.iter().zip(q) {
            energy += spring(numbers.number(c.stiffness), q - numbers.number(c.rest));
            if let Some([low, high]) = c.limits.map(|l| l.map(|x| numbers.number(x))) {
                let k = numbers.number(c.limit_stiffness);
                for excess in [q - high, low - q] {
                    energy += spring(
                        k,
                        match c.limit_width.is_zero() {
                            true => excess.max(S::zero()),
                            false => ramp(excess, numbers.number(c.limit_width)),
                        },
                    );
                }
            }
        }
        energy
    }

    /// Forces that no potential gives, on every coordinate.
    pub(crate) fn forces(&self, at: &At<f64>) -> Vec<f64> {
        let numbers: Resolved<f64> = self.numbers();
        let lengths = self.lengths(at.q);
        let value = |function: &Function| {
            function.program.value(|variable| match variable {
                Variable::Time => at.t,
                Variable::Param(i) => numbers.params[i as usize],
                Variable::Input(i) => at.inputs[i as usize],
                Variable::Coordinate(i) => at.q[i as usize],
                Variable::Rate(i) => at.v[i as usize],
                Variable::Length(i) => lengths[i as usize],
                _ => f64::NAN,
            })
        };
        let mut force: Vec<f64> = self
            .mechanism
            .coordinates
            .iter()
            .zip(at.v)
            .map(|(c, v)| -numbers.number(c.damping) * v)
            .collect();
        for torque in &self.mechanism.torques {
            force[torque.coordinate as usize] += value(&torque.value);
        }
        self.add_pulls(at, &numbers, &mut force);
        for muscle in self.mechanism.strands.iter().filter_map(|strand| strand.muscle()) {
            let [fibre, rate] = Pieces::new(muscle, &numbers).forces(at);
            force[muscle.fibre as usize] += fibre;
            force[muscle.activation as usize] += rate;
        }
        let poses = self.poses(at.q);
        for (j, sum) in force.iter_mut().enumerate() {
            let turning = self.poses(&seeded(at.q, j));
            for force in &self.mechanism.forces {
                let mut f = Vec3([0, 1, 2].map(|i| value(&force.value[i])));
                if let Some(link) = force.axes {
                    f = poses[link as usize].rotation * f;
                }
                let point = Self::place(&turning, &self.numbers(), &force.point);
                *sum += f.dot(Vec3(point.0.map(|x| x.slope)));
            }
        }
        force
    }

    /// Commanded tensions that vary, and dampers: −T·x_q by derivatives of the lengths themselves.
    fn add_pulls(&self, at: &At<f64>, numbers: &Resolved<f64>, force: &mut [f64]) {
        let arms: Vec<Vec<f64>> = (0..at.q.len())
            .map(|j| self.lengths(&seeded(at.q, j)).iter().map(|x| x.slope).collect())
            .collect();
        let lengths = self.lengths(at.q);
        for (i, strand) in self.mechanism.strands.iter().enumerate() {
            let rate: f64 = arms.iter().zip(at.v).map(|(arms, v)| arms[i] * v).sum();
            let taut = strand.slack.map_or(1.0, |width| {
                let stretch = Dual::variable(lengths[i] - at.rest[i]);
                ramp(stretch, Dual::fixed(numbers.number(width))).slope
            });
            let mut tension = numbers.number(strand.damping) * taut * taut * rate;
            if let Law::Tension(function) = &strand.law
                && !is_constant(function)
            {
                let read = |variable| match variable {
                    Variable::Time => at.t,
                    Variable::Param(p) => numbers.params[p as usize],
                    Variable::Input(u) => at.inputs[u as usize],
                    Variable::Coordinate(c) => at.q[c as usize],
                    Variable::Rate(c) => at.v[c as usize],
                    Variable::Own(Own::Length) => lengths[i],
                    Variable::Own(Own::Rest) => at.rest[i],
                    Variable::Own(Own::Rate) => rate,
                    _ => f64::NAN,
                };
                tension += taut * function.program.value(read);
            }
            for (sum, arms) in force.iter_mut().zip(&arms) {
                *sum -= tension * arms[i];
            }
            if strand.friction.is_some() {
                // All of the tension goes another way than the potential's gradient says.
                let numbers: Resolved<Dual<f64>> = self.numbers();
                let (length, rest) = (Dual::variable(lengths[i]), Dual::fixed(at.rest[i]));
                let whole =
                    tension + self.strand_energy(&numbers, i, &fixed(at.q), (length, rest)).slope;
                let gradient = self.sliding(i, at.q, at.v, &self.numbers());
                for ((sum, arms), g) in force.iter_mut().zip(&arms).zip(gradient) {
                    *sum -= whole * (g - arms[i]);
                }
            }
        }
    }

    /// Momentum ∂T/∂v and force ∂(T − V)/∂q + F.
    pub(crate) fn evaluate(&self, at: &At<f64>) -> (Vec<f64>, Vec<f64>) {
        let forces = self.forces(at);
        (0..at.q.len())
            .map(|j| {
                let p = self.kinetic(&fixed(at.q), &seeded(at.v, j)).slope;
                let t_dq = self.kinetic(&seeded(at.q, j), &fixed(at.v)).slope;
                let v_dq = self.potential(&seeded(at.q, j), &fixed(at.rest)).slope;
                (p, t_dq - v_dq + forces[j])
            })
            .unzip()
    }
}

/// A muscle by its plain formulas.
struct Pieces<'a, S> {
    muscle: &'a Muscle,
    number: [S; 11],
}

impl<'a, S: Scalar> Pieces<'a, S> {
    fn new(muscle: &'a Muscle, numbers: &Resolved<S>) -> Self {
        let number = muscle.clone().numbers_mut().map(|n| numbers.number(*n));
        Pieces { muscle, number }
    }

    /// Length of the fibres in parts of the optimum, and the cosine of their angle.
    fn shape(&self, s: S) -> [S; 2] {
        let width = self.number[1] * self.number[3].sin_cos().0;
        let length = (s * s + width * width).sqrt();
        [length / self.number[1], s / length]
    }

    fn energy(&self, length: S, q: &[S]) -> S {
        let [force, optimal, slack, _, _, strain, passive, ..] = self.number;
        let s = q[self.muscle.fibre as usize];
        let tendon = muscle::tendon((length - s - slack) / (slack * strain))[1];
        let fibres = muscle::passive(self.shape(s)[0], passive)[1];
        force * (slack * strain * tendon + optimal * fibres)
    }

    /// Forces without a potential: of active and damped fibres, and of the activation.
    fn forces(&self, at: &At<S>) -> [S; 2] {
        let [force, optimal, _, _, fastest, _, _, eccentric, damping, up, down] = self.number;
        let (fibre, a) = (self.muscle.fibre as usize, self.muscle.activation as usize);
        let [length, cosine] = self.shape(at.q[fibre]);
        let rate = at.v[fibre] * cosine / (optimal * fastest);
        let stretch = length - S::one();
        let active = at.q[a] * (stretch * stretch).scale(-1.0 / 0.45).exp();
        let scaled = rate / (S::constant(0.25) + at.q[a].scale(0.75));
        let pull = active * muscle::velocity(scaled, eccentric) + damping * rate;
        let excitation = at.inputs[self.muscle.excitation as usize];
        let change = muscle::activation(excitation, at.q[a], up, down);
        [-(force * pull * cosine), force * optimal * up * (change - at.v[a])]
    }
}

/// Whether a commanded tension is that of a potential.
fn is_constant(function: &Function) -> bool {
    function.program.variables().iter().all(|variable| matches!(variable, Variable::Param(_)))
}

/// The part of a stretch that pulls, as the integral of a step 10u³ − 15u⁴ + 6u⁵ over the width.
fn ramp<S: Scalar>(stretch: S, width: S) -> S {
    let half = width.scale(0.5);
    let into = (stretch + half).max(S::zero()).min(width);
    let u = into / width;
    let integral = u.powi(4).scale(2.5) - u.powi(5).scale(3.0) + u.powi(6);
    integral * width + (stretch - half).max(S::zero())
}

/// Numbers that do not vary.
pub(crate) fn fixed(x: &[f64]) -> Vec<Dual<f64>> {
    x.iter().map(|&x| Dual::fixed(x)).collect()
}

/// Numbers of which the j-th is the variable.
pub(crate) fn seeded(x: &[f64], j: usize) -> Vec<Dual<f64>> {
    let mut x = fixed(x);
    x[j].slope = 1.0;
    x
}

/// Numbers evenly spread over −1 … 1, always the same.
pub(crate) struct Noise(pub(crate) u64);
impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// A midpoint near the start, with strands pulled and everything moving.
pub(crate) struct Place {
    pub(crate) q: Vec<f64>,
    pub(crate) v: Vec<f64>,
    pub(crate) rest: Vec<f64>,
    pub(crate) inputs: Vec<f64>,
}

impl Place {
    pub(crate) fn new(oracle: &Oracle, noise: &mut Noise) -> Place {
        let numbers = oracle.numbers::<f64>();
        let spread: Vec<f64> = oracle
            .mechanism
            .coordinates
            .iter()
            .map(|c| match c.role {
                Role::Fibre => 0.02,
                _ if c.is_length => 0.03,
                _ => 0.4,
            })
            .collect();
        let start = |n: Number| numbers.number(n);
        let coordinates = oracle.mechanism.coordinates.iter().zip(&spread);
        let q: Vec<f64> = coordinates.map(|(c, s)| start(c.start) + s * noise.next()).collect();
        let v = spread.iter().map(|s| 5.0 * s * noise.next()).collect();
        let rest = oracle.lengths(&q).iter().map(|x| x * (0.9 + 0.1 * noise.next())).collect();
        let inputs = oracle.mechanism.inputs.iter().map(|_| noise.next()).collect();
        Place { q, v, rest, inputs }
    }
    pub(crate) fn at(&self) -> At<'_, f64> {
        At { q: &self.q, v: &self.v, t: 0.3, rest: &self.rest, inputs: &self.inputs }
    }
}
