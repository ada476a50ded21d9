//! The mechanism as lines and bodies in space, at several instants of a run.

use super::series::Run;
use handc_core::model::Model;
use handc_dsl::hir::{self, BinaryOp, Expr, ExprKind, JointKind, MassKind};
use handc_plot::PoseFigure;
use handc_plot::pose::{Pose, Solid, Spot, instants};
use handc_runtime::interpreter::Interpreter;
use handc_runtime::mechanism::{ConstraintKind, Mechanism, Point, Strand};
use handc_runtime::resolved::{Resolved, constraint_points};
use handc_runtime::surface::Form;
use handc_runtime::vector::{Transform, Vec3};

/// Poses in a picture.
const POSES: usize = 6;
/// Places along a strand's way over a surface.
const ARC: usize = 24;
/// Half the length of a cylinder that is wrapped, as it is drawn, in radii: it has no ends.
const THICK: f64 = 0.7;

/// What does not change from pose to pose.
struct Skeleton<'a> {
    model: &'a hir::Model,
    mechanism: &'a Mechanism,
    numbers: Resolved<f64>,
}

/// A pose: where frames and links are.
struct Placed<'a> {
    skeleton: &'a Skeleton<'a>,
    frames: Vec<Transform<f64>>,
    /// `None` for links that carry no frame.
    links: Vec<Option<Transform<f64>>>,
}

/// Poses from the start to the greatest departure from it.
pub(super) fn figure(run: &mut Run, model: &hir::Model, title: String) -> PoseFigure {
    let chosen = instants(&departure(run), POSES);
    let states = chosen.iter().map(|&at| State {
        q: run.q.iter().map(|values| values[at]).collect(),
        time: run.time[at],
        caption: None,
    });
    let states: Vec<State> = states.collect();
    poses(&mut run.simulation.model, model, &states, title).without_repetition()
}

/// A configuration and what stands below its picture.
#[derive(Clone, Debug)]
pub(crate) struct State {
    /// Coordinates.
    pub(crate) q: Vec<f64>,
    /// Time (s).
    pub(crate) time: f64,
    /// Text instead of the time.
    pub(crate) caption: Option<String>,
}

/// A picture of configurations.
pub(crate) fn poses(
    interpreter: &mut Interpreter,
    model: &hir::Model,
    states: &[State],
    title: String,
) -> PoseFigure {
    let mechanism = interpreter.mechanism().clone();
    let numbers = Resolved::new(&mechanism, interpreter.params());
    let skeleton = Skeleton { model, mechanism: &mechanism, numbers };
    let poses = states.iter().map(|state| {
        let frames = interpreter.frame_poses(&state.q);
        let pose = Placed::new(&skeleton, frames).pose(state.time);
        Pose { caption: state.caption.clone(), ..pose }
    });
    let poses = poses.collect();
    let gravity = mechanism.gravity.map(|g| skeleton.numbers.number(g));
    let up = if gravity == [0.0; 3] { [0.0, 0.0, 1.0] } else { gravity.map(|g| -g) };
    let strands = mechanism.strands.iter().map(|strand| strand.name.clone()).collect();
    PoseFigure { title, strands, up, poses }
}

/// How far the coordinates are from their start at each instant (rad; lengths against the model's).
fn departure(run: &Run) -> Vec<f64> {
    let layout = run.simulation.layout();
    let mut squares = vec![0.0; run.time.len()];
    for (coordinate, values) in layout.coordinates.iter().zip(&run.q) {
        let is_length = coordinate.kind == handc_core::layout::CoordinateKind::Length;
        let scale = if is_length { 1.0 / layout.length_scale } else { 1.0 };
        let Some(first) = values.first() else { continue };
        for (square, value) in squares.iter_mut().zip(values) {
            *square += ((value - first) * scale).powi(2);
        }
    }
    squares.into_iter().map(f64::sqrt).collect()
}

impl<'a> Placed<'a> {
    fn new(skeleton: &'a Skeleton<'a>, frames: Vec<Transform<f64>>) -> Self {
        let mut links = vec![None; skeleton.mechanism.links.len()];
        for (frame, world_from_frame) in skeleton.mechanism.frames.iter().zip(&frames) {
            if let Some(link) = frame.link {
                let link_from_frame = skeleton.numbers.transform(&frame.link_from_frame);
                links[link as usize] = Some(*world_from_frame * link_from_frame.inverse());
            }
        }
        Placed { skeleton, frames, links }
    }

    fn point(&self, point: &Point) -> Option<Spot> {
        let position = self.skeleton.numbers.vector(&point.position);
        self.link(point.link).map(|link| link.point(position).0)
    }

    /// `world_from_link`, if it is known.
    fn link(&self, link: Option<u32>) -> Option<Transform<f64>> {
        link.map_or(Some(Transform::identity()), |link| self.links[link as usize])
    }

    fn pose(&self, time: f64) -> Pose {
        let mechanism = self.skeleton.mechanism;
        let model = self.skeleton.model;
        let solids: Vec<Solid> = model.masses.iter().filter_map(|mass| self.solid(mass)).collect();
        let world = |point: &&Point| point.link.is_none();
        let ends = mechanism.strands.iter().flat_map(|s| [s.points.first(), s.points.last()]);
        let held: Vec<Point> =
            mechanism.constraints.iter().flat_map(|c| constraint_points(&c.kind)).collect();
        let anchors = ends.flatten().chain(&held).filter(world);
        let joints = model.joints.iter().filter(|joint| joint.kind != JointKind::Free);
        Pose {
            time,
            caption: None,
            forces: Vec::new(),
            solids,
            surfaces: self.surfaces(),
            bars: self.bars(),
            joints: joints.map(|j| self.frames[j.frame.index()].translation.0).collect(),
            anchors: anchors.filter_map(|point| self.point(point)).collect(),
            strands: mechanism.strands.iter().map(|strand| self.path(strand)).collect(),
        }
    }

    /// A strand from point to point, along the surfaces between.
    fn path(&self, strand: &Strand) -> Vec<Spot> {
        let mut path = Vec::new();
        for (gap, point) in strand.points.iter().enumerate() {
            path.extend(self.point(point));
            let Some(wrap) = strand.wrap(gap) else { continue };
            let Some(place) = self.link(wrap.center.link) else { continue };
            let ends = [point, &strand.points[gap + 1]].map(|point| self.point(point));
            let [Some(first), Some(second)] = ends else { continue };
            let ends = [first, second].map(|end| place.inverse_point(Vec3(end)));
            let trace = self.skeleton.numbers.surface(strand, wrap).trace(ends, ARC);
            path.extend(trace.into_iter().map(|local| place.point(local).0));
        }
        path
    }

    /// The surfaces that strands wrap, each once.
    fn surfaces(&self) -> Vec<Solid> {
        let strands = self.skeleton.mechanism.strands.iter();
        let wraps = strands.flat_map(|strand| strand.wraps.iter().map(move |wrap| (strand, wrap)));
        let mut solids: Vec<Solid> = Vec::new();
        for (strand, wrap) in wraps {
            let Some(place) = self.link(wrap.center.link) else { continue };
            let surface = self.skeleton.numbers.surface(strand, wrap);
            let (center, radius) = (surface.center, surface.radius);
            let solid = match &surface.form {
                Form::Sphere | Form::Ring(_) => {
                    Solid::Ball { center: place.point(center).0, radius }
                }
                Form::Cylinder(axis) => {
                    let end = |sign: f64| {
                        place.point(center + axis.vector().scale(sign * THICK * radius)).0
                    };
                    Solid::Rod { from: end(-1.0), to: end(1.0), radius }
                }
            };
            if !solids.contains(&solid) {
                solids.push(solid);
            }
        }
        solids
    }

    /// Lines from joint to joint, to the masses and frames of a link, and along constant distances.
    fn bars(&self) -> Vec<[Spot; 2]> {
        let mechanism = self.skeleton.mechanism;
        let origin = |link: u32| self.links[link as usize].map(|link| link.translation.0);
        let mut bars = Vec::new();
        for (index, link) in mechanism.links.iter().enumerate() {
            let mut parent = link.parent;
            while let Some(p) = parent.filter(|p| self.links[*p as usize].is_none()) {
                parent = mechanism.links[p as usize].parent;
            }
            bars.extend(parent.and_then(origin).zip(origin(index as u32)));
        }
        for mass in &self.skeleton.model.masses {
            let to = self.solid(mass);
            let link = mechanism.frames[mass.frame.index()].link;
            if let (Some(Solid::Mass(at) | Solid::Ball { center: at, .. }), Some(link)) = (to, link)
            {
                bars.extend(origin(link).map(|from| (from, at)));
            }
        }
        let held = mechanism.constraints.iter().flat_map(|c| constraint_points(&c.kind));
        let ends = mechanism.strands.iter().flat_map(|s| [s.points.first(), s.points.last()]);
        for point in held.chain(ends.flatten().copied()) {
            if let Some(link) = point.link.filter(|link| !self.is_solid(*link)) {
                bars.extend(origin(link).zip(self.point(&point)));
            }
        }
        let bodies = |link| mechanism.bodies.iter().any(|body| body.link == Some(link));
        for (frame, place) in mechanism.frames.iter().zip(&self.frames) {
            if let Some(link) = frame.link.filter(|link| !bodies(*link)) {
                bars.extend(origin(link).map(|from| (from, place.translation.0)));
            }
        }
        for constraint in &mechanism.constraints {
            if let ConstraintKind::Distance { first, second, .. } = &constraint.kind {
                bars.extend(self.point(first).zip(self.point(second)));
            }
        }
        for mass in &self.skeleton.model.masses {
            bars.extend(self.inertia_axes(mass));
        }
        let apart = |(a, b): &(Spot, Spot)| a.iter().zip(b).any(|(x, y)| (x - y).abs() > 1e-9);
        bars.into_iter().filter(apart).map(|(a, b)| [a, b]).collect()
    }

    /// Half axes of the box that has the inertia of a free body without a shape, so that its
    /// turning is seen.
    fn inertia_axes(&self, mass: &hir::Mass) -> Vec<(Spot, Spot)> {
        let model = self.skeleton.model;
        let frame = self.frames[mass.frame.index()];
        let joint = model.frames[mass.frame.index()].joint;
        let free = joint.is_some_and(|j| model.joints[j.index()].kind == JointKind::Free);
        let MassKind::Explicit { mass, at, inertia: Some(inertia) } = &mass.kind else {
            return Vec::new();
        };
        if !free {
            return Vec::new();
        }
        let value = |expr: &Expr| value(expr, &self.skeleton.numbers.params);
        let moments = [0, 1, 2].map(|i| value(&inertia[i]));
        let center = Vec3([0, 1, 2].map(|i| value(&at[i])));
        let axis = |i: usize| {
            let spread = 0.5 * (moments.iter().sum::<f64>() - 2.0 * moments[i]) / value(mass);
            let mut end = center;
            end.0[i] += (3.0 * spread.max(0.0)).sqrt();
            (frame.point(center).0, frame.point(end).0)
        };
        vec![axis(0), axis(1), axis(2)]
    }

    /// Whether a link carries a body with a size.
    fn is_solid(&self, link: u32) -> bool {
        let model = self.skeleton.model;
        let frames = &self.skeleton.mechanism.frames;
        model.masses.iter().any(|mass| {
            frames[mass.frame.index()].link == Some(link)
                && !matches!(mass.kind, MassKind::Explicit { .. })
        })
    }

    fn solid(&self, mass: &hir::Mass) -> Option<Solid> {
        let frame = self.frames.get(mass.frame.index())?;
        let value = |expr: &Expr| value(expr, &self.skeleton.numbers.params);
        let spot = |v: &hir::Vector| frame.point(Vec3([0, 1, 2].map(|i| value(&v[i])))).0;
        Some(match &mass.kind {
            MassKind::Explicit { at, .. } => Solid::Mass(spot(at)),
            MassKind::Sphere { at, radius, .. } => {
                Solid::Ball { center: spot(at), radius: value(radius) }
            }
            MassKind::Capsule { from, to, radius, .. }
            | MassKind::Cylinder { from, to, radius, .. } => {
                Solid::Rod { from: spot(from), to: spot(to), radius: value(radius) }
            }
            MassKind::Box { at, size, .. } => {
                let corner = |k: usize| {
                    let side = |i: usize| if k >> i & 1 == 1 { 0.5 } else { -0.5 };
                    let local = [0, 1, 2].map(|i| value(&at[i]) + side(i) * value(&size[i]));
                    frame.point(Vec3(local)).0
                };
                Solid::Block([0, 1, 2, 3, 4, 5, 6, 7].map(corner))
            }
        })
    }
}

/// The value of an expression of constants and parameters; not a number where it is more than
/// arithmetic.
fn value(expr: &Expr, params: &[f64]) -> f64 {
    match &expr.kind {
        ExprKind::Number(number) => *number,
        ExprKind::Param(param) => params.get(param.index()).copied().unwrap_or(f64::NAN),
        ExprKind::Neg(inner) => -value(inner, params),
        ExprKind::Binary(op, left, right) => {
            let (left, right) = (value(left, params), value(right, params));
            match op {
                BinaryOp::Add => left + right,
                BinaryOp::Sub => left - right,
                BinaryOp::Mul => left * right,
                BinaryOp::Div => left / right,
                BinaryOp::Pow => left.powf(right),
            }
        }
        _ => f64::NAN,
    }
}
