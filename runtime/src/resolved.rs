//! A mechanism with its numbers filled in for one scalar type and one set of parameters.
//!
//! Every [`Number`] becomes a scalar here, once per change of parameters; bodies of a link are
//! lumped into one. With symbols as parameters the same code keeps parameters open.

use crate::expression::Variable;
use crate::mechanism::{
    ConstraintKind, Law, Mechanism, Motion, Number, NumberTransform, NumberVector, Point,
};
use crate::muscle::ResolvedMuscle;
use crate::run::{ResolvedRun, find_runs};
use crate::structure::{PathStep, segment_path};
use crate::surface::Surface;
use crate::vector::{Mat3, Transform, Vec3};
use handc_core::scalar::Scalar;

/// A unit axis; the coordinate axes are told apart so that rotations about them stay cheap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Axis<S> {
    /// (1, 0, 0).
    X,
    /// (0, 1, 0).
    Y,
    /// (0, 0, 1).
    Z,
    /// Any unit vector.
    General(Vec3<S>),
}

impl<S: Scalar> Axis<S> {
    /// As a vector.
    #[inline]
    pub fn vector(&self) -> Vec3<S> {
        let (o, l) = (S::zero(), S::one());
        match *self {
            Axis::X => Vec3([l, o, o]),
            Axis::Y => Vec3([o, l, o]),
            Axis::Z => Vec3([o, o, l]),
            Axis::General(v) => v,
        }
    }
    /// Axis × v.
    #[inline]
    pub fn cross(&self, v: Vec3<S>) -> Vec3<S> {
        let [x, y, z] = v.0;
        match *self {
            Axis::X => Vec3([S::zero(), -z, y]),
            Axis::Y => Vec3([z, S::zero(), -x]),
            Axis::Z => Vec3([-y, x, S::zero()]),
            Axis::General(a) => a.cross(v),
        }
    }
    /// Axis · (u × v).
    #[inline]
    pub fn triple(&self, u: Vec3<S>, v: Vec3<S>) -> S {
        let ([a, b, c], [x, y, z]) = (u.0, v.0);
        match *self {
            Axis::X => b * z - c * y,
            Axis::Y => c * x - a * z,
            Axis::Z => a * y - b * x,
            Axis::General(axis) => axis.dot(u.cross(v)),
        }
    }
    /// (Axis × u) · (axis × v).
    #[inline]
    pub fn across(&self, u: Vec3<S>, v: Vec3<S>) -> S {
        let ([a, b, c], [x, y, z]) = (u.0, v.0);
        match *self {
            Axis::X => b * y + c * z,
            Axis::Y => c * z + a * x,
            Axis::Z => a * x + b * y,
            Axis::General(axis) => axis.cross(u).dot(axis.cross(v)),
        }
    }
    /// v without its part along the axis.
    #[inline]
    pub fn reject(&self, v: Vec3<S>) -> Vec3<S> {
        let ([x, y, z], o) = (v.0, S::zero());
        match *self {
            Axis::X => Vec3([o, y, z]),
            Axis::Y => Vec3([x, o, z]),
            Axis::Z => Vec3([x, y, o]),
            Axis::General(a) => v - a.scale(a.dot(v)),
        }
    }
    /// Axis · v.
    #[inline]
    pub fn dot(&self, v: Vec3<S>) -> S {
        match *self {
            Axis::X => v.0[0],
            Axis::Y => v.0[1],
            Axis::Z => v.0[2],
            Axis::General(a) => a.dot(v),
        }
    }
}

/// The motion of a link with its numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint<S> {
    /// Unit axis in the joint frame, through its origin.
    pub axis: Axis<S>,
    /// Whether it rotates.
    pub rotates: bool,
    /// Advance along the axis per unit of the coordinate: 1 for prismatic, the pitch for screw.
    pub advance: Option<S>,
    /// Rotation `parent_from_joint`; `None` is the identity.
    pub rotation: Option<Mat3<S>>,
    /// Origin of the joint frame in the parent.
    pub origin: Vec3<S>,
}

impl<S: Scalar> Joint<S> {
    /// The same joint over another scalar.
    pub(crate) fn over<T>(&self, lift: &impl Fn(S) -> T) -> Joint<T> {
        let vector = |v: Vec3<S>| Vec3(v.0.map(lift));
        Joint {
            axis: match self.axis {
                Axis::X => Axis::X,
                Axis::Y => Axis::Y,
                Axis::Z => Axis::Z,
                Axis::General(axis) => Axis::General(vector(axis)),
            },
            rotates: self.rotates,
            advance: self.advance.map(lift),
            rotation: self.rotation.map(|rotation| Mat3(rotation.0.map(|row| row.map(lift)))),
            origin: vector(self.origin),
        }
    }
}

/// The matter of a link, lumped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lump<S> {
    /// Mass.
    pub mass: S,
    /// Centre in link axes.
    pub center: Vec3<S>,
    /// λ of the inertia about the centre, λE + D: the part that no rotation changes.
    pub isotropic: S,
    /// D by rows in link axes.
    pub deviator: Mat3<S>,
    /// Whether D is zero by structure.
    pub is_isotropic: bool,
}

/// A strand with its numbers: moving segments, and the length of those that do not move.
#[derive(Clone, Debug, PartialEq)]
pub struct ResolvedStrand<S> {
    /// Stiffness of a linear law.
    pub stiffness: Option<S>,
    /// Damping along the strand, if any.
    pub damping: Option<S>,
    /// Width over which it goes slack, if it does.
    pub slack: Option<S>,
    /// Friction coefficient and the speed that smooths it, if any.
    pub friction: Option<(S, S)>,
    /// The muscle that it is, if it is one.
    pub muscle: Option<ResolvedMuscle<S>>,
    /// Sum of the segments within one link.
    pub constant_length: S,
    /// The moving segments.
    pub segments: Vec<ResolvedSegment<S>>,
}

/// The numbers of a moving segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ResolvedSegment<S> {
    /// Over the hinge of a link.
    Hinge(u32, Hinge<S>),
    /// Over one hinge on each side, about axes that are coordinate axes in the middle.
    HingePair(HingeEnd<S>, HingeEnd<S>),
    /// Its end points in their links' axes.
    Ends(Vec3<S>, Vec3<S>),
    /// Over a surface, in the axes of the link that carries it; its end points in their links' axes.
    Wrapped(Surface<S>, [Vec3<S>; 2]),
}

/// d² = `constant` − 2(`cosine`·cos q + `sine`·sin q).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hinge<S> {
    /// Share of the cosine.
    pub cosine: S,
    /// Share of the sine.
    pub sine: S,
    /// Twice the first.
    pub twice_cosine: S,
    /// Twice the second.
    pub twice_sine: S,
    /// The rest.
    pub constant: S,
}

/// An end of a segment, with a hinge between it and the middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HingeEnd<S> {
    /// The link of the hinge.
    pub link: u32,
    /// Its axis.
    pub axis: Axis<S>,
    /// The point, from the joint and in its axes, as far as they do not move against it.
    pub point: Vec3<S>,
    /// Whether the point moves with the link and the middle does not.
    pub is_carried: bool,
    /// The joint in the middle's axes.
    pub origin: Vec3<S>,
}

/// Springs, limits and damping of a coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResolvedCoordinate<S> {
    /// Viscous coefficient, if any.
    pub damping: Option<S>,
    /// Stiffness and rest, if any.
    pub spring: Option<(S, S)>,
    /// Elastic limits, if any.
    pub stops: Option<Stops<S>>,
}

/// Elastic limits of a coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stops<S> {
    /// Stiffness beyond them.
    pub stiffness: S,
    /// The lower one.
    pub low: S,
    /// The upper one.
    pub high: S,
    /// Width over which they begin, if they begin smoothly.
    pub width: Option<S>,
}

/// All numbers of a mechanism over one scalar type.
#[derive(Clone, Debug)]
pub struct Resolved<S> {
    /// Parameters.
    pub params: Vec<S>,
    /// Outputs of the parameter program.
    pub values: Vec<S>,
    /// Gravity in world axes; `None` if zero.
    pub gravity: Option<Vec3<S>>,
    /// Joint of each link.
    pub joints: Vec<Joint<S>>,
    /// `world_from_link` where the model starts, if strands wrap surfaces; else empty.
    pub start: Vec<Transform<S>>,
    /// Lumped matter of each link, if any.
    pub lumps: Vec<Option<Lump<S>>>,
    /// Planar runs.
    pub runs: Vec<ResolvedRun<S>>,
    /// Strands.
    pub strands: Vec<ResolvedStrand<S>>,
    /// What acts on a coordinate alone, and on which.
    pub coordinates: Vec<(usize, ResolvedCoordinate<S>)>,
}

impl<S: Scalar> Resolved<S> {
    /// Fills in the numbers for the given parameters.
    pub fn new(mechanism: &Mechanism, params: &[S]) -> Self {
        let mut scratch = Vec::new();
        let read = |variable| match variable {
            Variable::Param(i) => params[i as usize],
            other => unreachable!("a parameter program reads {other:?}"),
        };
        mechanism.values.evaluate(read, &mut scratch);
        let values =
            mechanism.values.outputs.iter().map(|&i| scratch[i as usize]).collect::<Vec<S>>();
        let mut resolved = Resolved {
            params: params.to_vec(),
            values,
            gravity: None,
            joints: Vec::new(),
            start: Vec::new(),
            lumps: Vec::new(),
            runs: Vec::new(),
            strands: Vec::new(),
            coordinates: Vec::new(),
        };
        if !mechanism.gravity.iter().all(|g| g.is_zero()) {
            resolved.gravity = Some(resolved.vector(&mechanism.gravity));
        }
        resolved.joints = mechanism
            .links
            .iter()
            .map(|link| resolved.joint(&link.motion, &link.parent_from_joint))
            .collect();
        if mechanism.strands.iter().any(|strand| !strand.wraps.is_empty()) {
            resolved.start = resolved.start(mechanism);
        }
        resolved.lumps =
            (0..mechanism.links.len()).map(|link| resolved.lump(mechanism, link as u32)).collect();
        resolved.runs = find_runs(mechanism)
            .iter()
            .map(|run| ResolvedRun::new(run, &resolved.joints, &resolved.lumps))
            .collect();
        resolved.strands =
            mechanism.strands.iter().map(|s| resolved.strand(mechanism, s)).collect();
        let coordinates = mechanism.coordinates.iter().enumerate();
        let coordinates = coordinates.filter_map(|(i, c)| Some((i, resolved.coordinate(c)?)));
        resolved.coordinates = coordinates.collect();
        resolved
    }

    /// A number as a scalar.
    #[inline]
    pub fn number(&self, number: Number) -> S {
        match number {
            Number::Constant(value) => S::constant(value),
            Number::Value(index) => self.values[index as usize],
        }
    }
    /// Three numbers as a vector.
    pub fn vector(&self, v: &NumberVector) -> Vec3<S> {
        Vec3(v.map(|x| self.number(x)))
    }
    /// A constant transform.
    pub fn transform(&self, t: &NumberTransform) -> Transform<S> {
        Transform {
            rotation: Mat3(t.rotation.map(|row| self.vector(&row).0)),
            translation: self.vector(&t.translation),
        }
    }
    /// A unit axis.
    pub(crate) fn axis(&self, axis: &NumberVector) -> Axis<S> {
        match principal_axis(axis) {
            Some(0) => Axis::X,
            Some(1) => Axis::Y,
            Some(_) => Axis::Z,
            None => Axis::General(self.vector(axis)),
        }
    }
    fn joint(&self, motion: &Motion, parent_from_joint: &NumberTransform) -> Joint<S> {
        let (axis, rotates, advance) = match motion {
            Motion::Revolute { axis } => (axis, true, None),
            Motion::Prismatic { axis } => (axis, false, Some(S::one())),
            Motion::Screw { axis, pitch } => (axis, true, Some(self.number(*pitch))),
        };
        let is_identity = parent_from_joint.rotation == NumberTransform::IDENTITY.rotation;
        let transform = self.transform(parent_from_joint);
        Joint {
            axis: self.axis(axis),
            rotates,
            advance,
            rotation: (!is_identity).then_some(transform.rotation),
            origin: transform.translation,
        }
    }
    fn lump(&self, mechanism: &Mechanism, link: u32) -> Option<Lump<S>> {
        let bodies: Vec<_> = mechanism.bodies.iter().filter(|b| b.link == Some(link)).collect();
        if bodies.is_empty() {
            return None;
        }
        let numbers = bodies.iter().map(|b| {
            (self.number(b.mass), self.vector(&b.center), b.inertia.map(|i| self.number(i)))
        });
        if let [only] = bodies.as_slice() {
            let (mass, center, inertia) = numbers.into_iter().next()?;
            // The repeated principal moment is the part that a rotation cannot change.
            let [xx, yy, zz, ..] = only.inertia;
            let isotropic = if xx == yy || xx == zz { inertia[0] } else { inertia[1] };
            let is_isotropic =
                xx == yy && yy == zz && only.inertia[3..].iter().all(|i| i.is_zero());
            return Some(Lump {
                mass,
                center,
                isotropic,
                deviator: deviator(inertia, isotropic),
                is_isotropic,
            });
        }
        let parts: Vec<_> = numbers.collect();
        let mut mass = S::zero();
        let mut moment = Vec3::zero();
        for (m, c, _) in &parts {
            mass += *m;
            moment += c.scale(*m);
        }
        let center = moment.scale(mass.recip());
        let mut total = [S::zero(); 6];
        for (m, c, inertia) in parts {
            let [x, y, z] = (c - center).0;
            let shift = [
                m * (y * y + z * z),
                m * (x * x + z * z),
                m * (x * x + y * y),
                -(m * x * y),
                -(m * x * z),
                -(m * y * z),
            ];
            for k in 0..6 {
                total[k] += inertia[k] + shift[k];
            }
        }
        let isotropic = total[1];
        Some(Lump {
            mass,
            center,
            isotropic,
            deviator: deviator(total, isotropic),
            is_isotropic: false,
        })
    }
    fn segment(
        &self,
        (first, a): (&[PathStep], Vec3<S>),
        (second, b): (&[PathStep], Vec3<S>),
    ) -> ResolvedSegment<S> {
        let is_hinge = |step: PathStep| {
            let joint = &self.joints[step.link() as usize];
            joint.rotates && joint.advance.is_none()
        };
        match (first, second) {
            ([], [step @ PathStep::Up(link)]) if is_hinge(*step) => {
                ResolvedSegment::Hinge(*link, self.hinge(*link, a, b))
            }
            ([], [step @ PathStep::Down(link)]) if is_hinge(*step) => {
                ResolvedSegment::Hinge(*link, self.hinge(*link, b, a))
            }
            ([x], [y]) => match (self.hinge_end(*x, a), self.hinge_end(*y, b)) {
                (Some(first), Some(second)) => ResolvedSegment::HingePair(first, second),
                _ => ResolvedSegment::Ends(a, b),
            },
            _ => ResolvedSegment::Ends(a, b),
        }
    }
    fn hinge_end(&self, step: PathStep, point: Vec3<S>) -> Option<HingeEnd<S>> {
        let link = step.link();
        let joint = &self.joints[link as usize];
        if !joint.rotates || joint.advance.is_some() || matches!(joint.axis, Axis::General(_)) {
            return None;
        }
        let (axis, is_carried) = (joint.axis, matches!(step, PathStep::Up(_)));
        match joint.rotation {
            // Its frame turned in its parent turns the axis.
            Some(_) if is_carried => None,
            _ if is_carried => {
                Some(HingeEnd { link, axis, point, is_carried, origin: joint.origin })
            }
            rotation => {
                let p = point - joint.origin;
                let point = rotation.map_or(p, |rotation| rotation.transpose_mul(p));
                Some(HingeEnd { link, axis, point, is_carried, origin: Vec3::zero() })
            }
        }
    }
    /// A segment from `parent` on one side of a hinge to `child` on the other.
    fn hinge(&self, link: u32, parent: Vec3<S>, child: Vec3<S>) -> Hinge<S> {
        let joint = &self.joints[link as usize];
        let mut a = parent - joint.origin;
        if let Some(rotation) = joint.rotation {
            a = rotation.transpose_mul(a);
        }
        let b = child;
        let along = joint.axis.dot(a) * joint.axis.dot(b);
        let (cosine, sine) = (a.dot(b) - along, joint.axis.dot(b.cross(a)));
        Hinge {
            cosine,
            sine,
            twice_cosine: cosine.scale(2.0),
            twice_sine: sine.scale(2.0),
            constant: a.norm_squared() + b.norm_squared() - along.scale(2.0),
        }
    }
    fn strand(
        &self,
        mechanism: &Mechanism,
        strand: &crate::mechanism::Strand,
    ) -> ResolvedStrand<S> {
        let mut constant_length = S::zero();
        let mut segments = Vec::new();
        for (gap, pair) in strand.points.windows(2).enumerate() {
            let (a, b) = (self.vector(&pair[0].position), self.vector(&pair[1].position));
            let wrap = strand.wrap(gap);
            let path = segment_path(mechanism, [pair[0], pair[1]], wrap);
            match (path, wrap.map(|wrap| self.surface(strand, wrap))) {
                (Some(_), Some(surface)) => {
                    segments.push(ResolvedSegment::Wrapped(surface, [a, b]));
                }
                (Some([first, second]), None) => {
                    segments.push(self.segment((&first, a), (&second, b)));
                }
                (None, Some(surface)) => constant_length += surface.length([a, b]),
                (None, None) => constant_length += (b - a).norm_squared().sqrt(),
            }
        }
        ResolvedStrand {
            stiffness: match strand.law {
                Law::Linear { stiffness } => Some(self.number(stiffness)),
                _ => None,
            },
            damping: (!strand.damping.is_zero()).then(|| self.number(strand.damping)),
            slack: strand.slack.map(|width| self.number(width)),
            friction: strand.friction.map(|f| (self.number(f.coefficient), self.number(f.speed))),
            muscle: strand.muscle().map(|muscle| ResolvedMuscle::new(self, muscle)),
            constant_length,
            segments,
        }
    }
    fn coordinate(&self, c: &crate::mechanism::Coordinate) -> Option<ResolvedCoordinate<S>> {
        let some = |n: Number| (!n.is_zero()).then(|| self.number(n));
        let is_free = c.damping.is_zero() && c.stiffness.is_zero() && c.limit_stiffness.is_zero();
        (!is_free).then(|| ResolvedCoordinate {
            damping: some(c.damping),
            spring: some(c.stiffness).map(|k| (k, self.number(c.rest))),
            stops: some(c.limit_stiffness).zip(c.limits).map(|(stiffness, [low, high])| Stops {
                stiffness,
                low: self.number(low),
                high: self.number(high),
                width: some(c.limit_width),
            }),
        })
    }
}

fn deviator<S: Scalar>([xx, yy, zz, xy, xz, yz]: [S; 6], isotropic: S) -> Mat3<S> {
    Mat3([[xx - isotropic, xy, xz], [xy, yy - isotropic, yz], [xz, yz, zz - isotropic]])
}

/// Which coordinate axis it is, if it is one.
pub fn principal_axis(axis: &NumberVector) -> Option<usize> {
    let unit = |i: usize, j: usize| Number::Constant(if i == j { 1.0 } else { 0.0 });
    (0..3).find(|&i| (0..3).all(|j| axis[j] == unit(i, j)))
}

/// The points of a constraint that are given by position, for those that walk over constraints.
pub fn constraint_points(kind: &ConstraintKind) -> Vec<Point> {
    match kind {
        ConstraintKind::Coincident { first, second, .. }
        | ConstraintKind::Distance { first, second, .. } => vec![*first, *second],
        ConstraintKind::OnPlane { point, through, .. } => vec![*point, *through],
        ConstraintKind::Weld { first, first_from_frame, second, second_from_frame } => vec![
            Point { link: *first, position: first_from_frame.translation },
            Point { link: *second, position: second_from_frame.translation },
        ],
        ConstraintKind::Equation(_) | ConstraintKind::Length(_) => Vec::new(),
    }
}
