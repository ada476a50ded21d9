//! Lowering: from the checked model to the mechanism.
//!
//! Expressions become symbols, so that constants fold, parameters stay open and derivatives are
//! taken here once. Frames that do not move are folded into the links that carry them, joints of
//! several coordinates become chains of links, shapes become numbers. What comes out is constant
//! data and short programs; nothing after this stage reads an expression of the text.

mod expression;
mod mass;
mod muscle;
mod scenario;

use crate::graph::{self, Leaf, Sym};
use handc_core::scalar::Scalar;
use handc_dsl::hir;
use handc_dsl::source::{SourceMap, Span};
use handc_runtime::expression::{Function, Own, Program};
use handc_runtime::mechanism::{
    Constraint, ConstraintKind, Coordinate, Force, Frame, Friction, Input, Law, Link, Mechanism,
    Motion, Number, NumberTransform, NumberVector, Param, Point, Requirement, Role, Strand,
    SurfaceForm, Torque, Wrap,
};
use handc_runtime::surface::planes;
use handc_runtime::vector::{Mat3, Transform, Vec3};
use std::collections::HashMap;

/// Lowers a checked model. `sources` tells lines for the mechanism's `source` fields.
pub fn lower(model: &hir::Model, sources: &SourceMap) -> Mechanism {
    graph::with_new(|| {
        let mut lowering = Lowering {
            model,
            sources,
            values: Vec::new(),
            value_index: HashMap::new(),
            places: Vec::new(),
            links: Vec::new(),
            first_row: Vec::new(),
        };
        lowering.run()
    })
}

/// Where a frame is: the link that carries it and its constant place there.
#[derive(Clone, Copy)]
struct Place {
    link: Option<u32>,
    link_from_frame: Transform<Sym>,
}

struct Lowering<'a> {
    model: &'a hir::Model,
    sources: &'a SourceMap,
    /// Numbers that depend on parameters.
    values: Vec<Sym>,
    value_index: HashMap<Sym, u32>,
    places: Vec<Place>,
    links: Vec<Link>,
    /// First row of each constraint.
    first_row: Vec<u32>,
}

impl Lowering<'_> {
    fn run(&mut self) -> Mechanism {
        let model = self.model;
        self.place_frames();
        let mut row = 0;
        for constraint in &model.constraints {
            self.first_row.push(row);
            row += match &constraint.kind {
                hir::ConstraintKind::Coincident { axes, .. } => {
                    axes.iter().filter(|held| **held).count() as u32
                }
                hir::ConstraintKind::Weld { .. } => 6,
                _ => 1,
            };
        }
        let mut mechanism = Mechanism {
            name: model.name.text.clone(),
            doc: model.name.doc.clone(),
            params: model.params.iter().map(param).collect(),
            gravity: self.numbers(&model.gravity),
            ..Mechanism::default()
        };
        mechanism.inputs = model.inputs.iter().map(|input| self.input(input)).collect();
        mechanism.coordinates = model.coordinates.iter().map(|c| self.coordinate(c)).collect();
        mechanism.frames = (0..model.frames.len()).map(|i| self.frame(i)).collect();
        mechanism.bodies = model.masses.iter().map(|mass| self.body(mass)).collect();
        mechanism.strands = model.strands.iter().map(|strand| self.strand(strand)).collect();
        muscle::begin(&mut mechanism);
        mechanism.constraints = model.constraints.iter().map(|c| self.constraint(c)).collect();
        mechanism.torques = model.torques.iter().map(|torque| self.torque(torque)).collect();
        mechanism.forces = model.forces.iter().map(|force| self.force(force)).collect();
        mechanism.scenarios = model.scenarios.iter().map(|s| self.scenario(s)).collect();
        for requirement in &model.requirements {
            let requirement = self.requirement(requirement);
            // Strands often share a parameter; one place is enough to tell.
            let is_known = mechanism.requirements.iter().any(|known| known.is_as(&requirement));
            mechanism.requirements.extend((!is_known).then_some(requirement));
        }
        mechanism.links = std::mem::take(&mut self.links);
        mechanism.values = graph::to_program(&self.values);
        for ([strand, wrap], plane) in planes(&mechanism) {
            // Out of a plane a strand slides to the shorter way: its hint means nothing.
            let wrap = &mut mechanism.strands[strand].wraps[wrap];
            wrap.side = wrap.side.filter(|_| plane.is_some());
            wrap.plane = plane;
        }
        mechanism
    }

    /// A symbol as a number of the mechanism.
    fn number_of(&mut self, symbol: Sym) -> Number {
        if let Some(value) = symbol.as_constant() {
            return Number::Constant(value);
        }
        let next = self.values.len() as u32;
        let index = *self.value_index.entry(symbol).or_insert(next);
        if index == next {
            self.values.push(symbol);
        }
        Number::Value(index)
    }
    fn number(&mut self, expr: &hir::Expr) -> Number {
        let symbol = self.expr(expr);
        self.number_of(symbol)
    }
    fn number_or_zero(&mut self, expr: &Option<hir::Expr>) -> Number {
        expr.as_ref().map_or(Number::ZERO, |expr| self.number(expr))
    }
    fn numbers(&mut self, v: &hir::Vector) -> NumberVector {
        [0, 1, 2].map(|i| self.number(&v[i]))
    }
    fn vector_number(&mut self, v: Vec3<Sym>) -> NumberVector {
        v.0.map(|x| self.number_of(x))
    }
    fn vector(&mut self, v: &hir::Vector) -> Vec3<Sym> {
        Vec3([0, 1, 2].map(|i| self.expr(&v[i])))
    }
    fn transform_number(&mut self, t: &Transform<Sym>) -> NumberTransform {
        NumberTransform {
            rotation: t.rotation.0.map(|row| row.map(|x| self.number_of(snap(x)))),
            translation: self.vector_number(t.translation),
        }
    }
    fn program(&mut self, expr: &hir::Expr) -> Program {
        let symbol = self.expr(expr);
        graph::to_program(&[symbol])
    }

    /// A function of the state with its derivatives by coordinates, rates and lengths.
    fn function(&mut self, value: Sym) -> Function {
        let mut outputs = vec![value];
        let mut variables = Vec::new();
        let varying = graph::leaves(&[value]).into_iter().filter(|leaf| {
            matches!(leaf, Leaf::Q(_) | Leaf::V(_) | Leaf::Length(_))
                || matches!(leaf, Leaf::Own(Own::Length | Own::Rate))
        });
        for leaf in varying {
            let slope = graph::differentiate(value, Sym::leaf(leaf));
            if let (false, Some(variable)) = (slope.is_known_zero(), graph::variable(leaf)) {
                outputs.push(slope);
                variables.push(variable);
            }
        }
        Function { program: graph::to_program(&outputs), gradient: variables }
    }

    /// `file:line` of a declaration.
    fn source(&self, span: Span) -> String {
        let path = self.sources.path(span.file);
        let file = path.rsplit(['/', '\\']).next().unwrap_or(path);
        format!("{file}:{}", self.sources.line_col(span).0)
    }

    fn requirement(&mut self, requirement: &hir::Requirement) -> Requirement {
        Requirement {
            text: requirement.text.clone(),
            source: self.source(requirement.value.span),
            number: self.number(&requirement.value),
            least: requirement.least,
            most: requirement.most,
        }
    }

    fn place_frames(&mut self) {
        for frame in &self.model.frames {
            let parent = match frame.parent {
                Some(parent) => self.places[parent.index()],
                None => Place { link: None, link_from_frame: Transform::identity() },
            };
            let mut place = parent;
            let local = self.placement(&frame.placement);
            place.link_from_frame = parent.link_from_frame * local;
            place.link_from_frame.rotation =
                Mat3(place.link_from_frame.rotation.0.map(|row| row.map(snap)));
            if let Some(joint) = frame.joint {
                for coordinate in &self.model.joints[joint.index()].coordinates {
                    let parent_from_joint = self.transform_number(&place.link_from_frame);
                    let motion = self.motion(&self.model.coordinates[coordinate.index()]);
                    self.links.push(Link {
                        parent: place.link,
                        parent_from_joint,
                        motion,
                        coordinate: coordinate.0,
                    });
                    place = Place {
                        link: Some(self.links.len() as u32 - 1),
                        link_from_frame: Transform::identity(),
                    };
                }
            }
            self.places.push(place);
        }
    }

    fn placement(&mut self, placement: &hir::Placement) -> Transform<Sym> {
        let mut rotation = Mat3::identity();
        for turn in &placement.rotations {
            let axis = self.vector(&turn.axis);
            let axis = unit(axis);
            let (s, c) = self.expr(&turn.angle).sin_cos();
            let columns = [0, 1, 2].map(|j| {
                let mut e = Vec3::zero();
                e.0[j] = Sym::one();
                e.scale(c) + axis.cross(e).scale(s) + axis.scale(axis.dot(e) * (Sym::one() - c))
            });
            let turn = Mat3([0, 1, 2].map(|i| [columns[0].0[i], columns[1].0[i], columns[2].0[i]]));
            rotation = rotation * turn;
        }
        let rotation = Mat3(rotation.0.map(|row| row.map(snap)));
        Transform { rotation, translation: self.vector(&placement.at) }
    }

    fn motion(&mut self, coordinate: &hir::Coordinate) -> Motion {
        let axis = self.vector(&coordinate.axis);
        let axis = self.vector_number(Vec3(unit(axis).0.map(snap)));
        match &coordinate.motion {
            hir::MotionKind::Revolute => Motion::Revolute { axis },
            hir::MotionKind::Prismatic => Motion::Prismatic { axis },
            hir::MotionKind::Screw { pitch } => Motion::Screw { axis, pitch: self.number(pitch) },
            hir::MotionKind::Fibre | hir::MotionKind::Activation => {
                unreachable!("coordinates of muscles move no link")
            }
        }
    }

    fn input(&mut self, input: &hir::Input) -> Input {
        Input {
            name: input.name.text.clone(),
            doc: input.name.doc.clone(),
            unit: unit_name(input.default.dimension),
            default: self.program(&input.default),
        }
    }

    fn coordinate(&mut self, c: &hir::Coordinate) -> Coordinate {
        Coordinate {
            name: c.name.text.clone(),
            source: self.source(c.name.span),
            doc: match c.owner {
                hir::Owner::Joint(joint) => self.model.joints[joint.index()].name.doc.clone(),
                hir::Owner::Muscle(strand) => self.model.strands[strand.index()].name.doc.clone(),
            },
            is_length: matches!(c.motion, hir::MotionKind::Prismatic | hir::MotionKind::Fibre),
            start: self.number(&c.start),
            velocity: self.number(&c.velocity),
            damping: self.number_or_zero(&c.damping),
            stiffness: self.number_or_zero(&c.stiffness),
            rest: self.number_or_zero(&c.rest),
            limits: c.limits.as_ref().map(|[low, high]| [self.number(low), self.number(high)]),
            limit_stiffness: self.number_or_zero(&c.limit_stiffness),
            limit_width: self.number_or_zero(&c.limit_width),
            drive: c.drive.as_ref().map(|drive| self.program(drive)),
            role: match (c.owner, &c.motion) {
                (_, hir::MotionKind::Fibre) => Role::Fibre,
                (hir::Owner::Muscle(_), _) => Role::Activation,
                (hir::Owner::Joint(joint), _) => {
                    let is_node = self.model.joints[joint.index()].kind == hir::JointKind::Node;
                    if is_node { Role::Node } else { Role::Joint }
                }
            },
        }
    }

    fn frame(&mut self, index: usize) -> Frame {
        let place = self.places[index];
        Frame {
            name: self.model.frames[index].name.text.clone(),
            link: place.link,
            link_from_frame: self.transform_number(&place.link_from_frame),
        }
    }

    fn point(&mut self, point: &hir::Point) -> Point {
        let place = self.places[point.frame.index()];
        let offset = self.vector(&point.offset);
        Point {
            link: place.link,
            position: self.vector_number(place.link_from_frame.point(offset)),
        }
    }

    fn strand(&mut self, strand: &hir::Strand) -> Strand {
        Strand {
            name: strand.name.text.clone(),
            source: self.source(strand.name.span),
            doc: strand.name.doc.clone(),
            points: strand.path.iter().map(|point| self.point(point)).collect(),
            wraps: strand.wraps.iter().map(|wrap| self.wrap(wrap)).collect(),
            law: match &strand.law {
                hir::Law::Stiffness(stiffness) => Law::Linear { stiffness: self.number(stiffness) },
                hir::Law::Energy(energy) => {
                    let energy = self.expr(energy);
                    let x = Sym::leaf(Leaf::Own(Own::Length));
                    let tension = graph::differentiate(energy, x);
                    let slope = graph::differentiate(tension, x);
                    Law::Energy(graph::to_program(&[energy, tension, slope]))
                }
                hir::Law::Tension(tension) => {
                    let tension = self.expr(tension);
                    Law::Tension(self.function(tension))
                }
                hir::Law::Prescribed(_) => Law::Prescribed,
                hir::Law::Muscle(muscle) => Law::Muscle(Box::new(self.muscle(muscle))),
            },
            damping: self.number_or_zero(&strand.damping),
            slack: strand.slack.as_ref().map(|width| self.number(width)),
            quasi_static: strand.quasi_static,
            friction: strand.friction.as_ref().map(|[coefficient, speed]| Friction {
                coefficient: self.number(coefficient),
                speed: self.number(speed),
            }),
            actuator: strand.actuator.map(|input| input.0),
            rest: strand.rest.as_ref().map(|rest| self.program(rest)),
        }
    }

    fn wrap(&mut self, wrap: &hir::Wrap) -> Wrap {
        let frame = wrap.center.frame.index();
        let rotation = self.places[frame].link_from_frame.rotation;
        let mut direction = |v: &hir::Vector| {
            let v = rotation * unit(self.vector(v));
            self.vector_number(Vec3(v.0.map(snap)))
        };
        let form = match &wrap.surface {
            hir::Surface::Sphere => SurfaceForm::Sphere,
            hir::Surface::Cylinder { axis } => SurfaceForm::Cylinder { axis: direction(axis) },
        };
        let side = wrap.side.as_ref().map(&mut direction);
        Wrap {
            frame: self.model.frames[frame].name.text.clone(),
            source: self.source(wrap.span),
            gap: wrap.gap as u32,
            form,
            center: self.point(&wrap.center),
            radius: self.number(&wrap.radius),
            side,
            plane: None,
        }
    }

    fn constraint(&mut self, constraint: &hir::Constraint) -> Constraint {
        let kind = match &constraint.kind {
            hir::ConstraintKind::Coincident { first, second, axes } => ConstraintKind::Coincident {
                first: self.point(first),
                second: self.point(second),
                axes: *axes,
            },
            hir::ConstraintKind::Distance { first, second, distance } => ConstraintKind::Distance {
                first: self.point(first),
                second: self.point(second),
                distance: self.number(distance),
            },
            hir::ConstraintKind::OnPlane { point, frame, normal, through } => {
                let place = self.places[frame.index()];
                let through = self.vector(through);
                let through = self.vector_number(place.link_from_frame.point(through));
                let normal = self.vector(normal);
                let normal = self.vector_number(place.link_from_frame.rotation * normal);
                ConstraintKind::OnPlane {
                    point: self.point(point),
                    through: Point { link: place.link, position: through },
                    normal,
                }
            }
            hir::ConstraintKind::Weld { first, second } => {
                let (a, b) = (self.places[first.index()], self.places[second.index()]);
                ConstraintKind::Weld {
                    first: a.link,
                    first_from_frame: self.transform_number(&a.link_from_frame),
                    second: b.link,
                    second_from_frame: self.transform_number(&b.link_from_frame),
                }
            }
            hir::ConstraintKind::Equation { left, right } => {
                let value = self.expr(left) - self.expr(right);
                ConstraintKind::Equation(self.function(value))
            }
            hir::ConstraintKind::Length(strand) => ConstraintKind::Length(strand.0),
        };
        Constraint {
            name: constraint.name.text.clone(),
            source: self.source(constraint.name.span),
            kind,
        }
    }

    fn torque(&mut self, torque: &hir::Torque) -> Torque {
        let value = self.expr(&torque.value);
        Torque {
            name: torque.name.text.clone(),
            source: self.source(torque.name.span),
            coordinate: torque.coordinate.0,
            value: self.function(value),
        }
    }

    fn force(&mut self, force: &hir::Force) -> Force {
        let axes = self.places[force.frame.index()];
        let value = self.vector(&force.value);
        let value = axes.link_from_frame.rotation * value;
        Force {
            name: force.name.text.clone(),
            source: self.source(force.name.span),
            point: self.point(&force.point),
            value: value.0.map(|component| self.function(component)),
            axes: axes.link,
        }
    }
}

fn param(param: &hir::Param) -> Param {
    Param {
        name: param.name.text.clone(),
        doc: param.name.doc.clone(),
        unit: unit_name(param.dimension),
        default: param.default,
    }
}

/// The SI unit of a dimension; empty where there is none.
fn unit_name(dimension: handc_dsl::dimension::Dimension) -> String {
    if dimension == handc_dsl::dimension::Dimension::NONE {
        String::new()
    } else {
        dimension.to_string()
    }
}

/// v/‖v‖; a vector along a coordinate axis stays exact.
fn unit(v: Vec3<Sym>) -> Vec3<Sym> {
    let constants = v.0.map(|x| x.as_constant());
    let along = (0..3).find(|&i| {
        constants[i].is_some_and(|x| x != 0.0)
            && (0..3).all(|j| j == i || constants[j] == Some(0.0))
    });
    match along {
        Some(i) => {
            let mut e = Vec3::zero();
            e.0[i] = Sym::constant(constants[i].unwrap_or(1.0).signum());
            e
        }
        None => v.scale(v.norm_squared().sqrt().recip()),
    }
}

/// Constants of a rotation that are 0 or ±1 but for rounding become exactly that, so that zeros
/// fold and axes stay principal.
fn snap(x: Sym) -> Sym {
    match x.as_constant() {
        Some(value) if (value - value.round()).abs() < 4e-16 => Sym::constant(value.round() + 0.0),
        _ => x,
    }
}
