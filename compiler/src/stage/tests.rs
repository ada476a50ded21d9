//! Staged code computes what the interpreter computes.

use super::*;
use crate::emit::Place;
use crate::graph::{Leaf, Sym, differentiate, evaluate, to_program, with_new};
use handc_core::model::{Instant, Midpoint, Model};
use handc_core::scalar::Scalar;
use handc_core::shape::FEW;
use handc_runtime::expression::{Function, Program, Variable};
use handc_runtime::interpreter::Interpreter;
use handc_runtime::mechanism::*;
use std::sync::Arc;

/// A program from symbols.
fn program(make: impl FnOnce() -> Sym) -> Program {
    with_new(|| to_program(&[make()]))
}

/// A function with its derivatives by `variables`.
fn function(variables: &[Leaf], make: impl FnOnce() -> Sym) -> Function {
    with_new(|| {
        let value = make();
        let slopes = variables.iter().map(|&leaf| differentiate(value, Sym::leaf(leaf)));
        let outputs: Vec<Sym> = std::iter::once(value).chain(slopes).collect();
        let gradient = variables.iter().filter_map(|&l| crate::graph::variable(l)).collect();
        Function { program: to_program(&outputs), gradient }
    })
}

fn numbers<const N: usize>(values: [f64; N]) -> [Number; N] {
    values.map(Number::Constant)
}

fn coordinate(name: &str, start: f64) -> Coordinate {
    Coordinate {
        name: name.into(),
        source: "sample.hdl:3".into(),
        doc: String::new(),
        is_length: false,
        start: Number::Constant(start),
        velocity: Number::ZERO,
        damping: Number::ZERO,
        stiffness: Number::ZERO,
        rest: Number::ZERO,
        limits: None,
        limit_stiffness: Number::ZERO,
        limit_width: Number::ZERO,
        drive: None,
        role: Role::Joint,
    }
}

fn at(link: u32, position: [f64; 3]) -> Point {
    Point { link: Some(link), position: numbers(position) }
}

fn world(position: [f64; 3]) -> Point {
    Point { link: None, position: numbers(position) }
}

/// Links in a chain: axis, and offset from the one before.
fn chain(mechanism: &mut Mechanism, name: &str, root: [f64; 3], joints: &[(&str, Motion)]) -> u32 {
    let first = mechanism.links.len() as u32;
    for (index, (joint, motion)) in joints.iter().enumerate() {
        let link = mechanism.links.len() as u32;
        let offset = if index == 0 { root } else { [0.03, 0.001, 0.0] };
        mechanism.links.push(Link {
            parent: (index > 0).then(|| link - 1),
            parent_from_joint: NumberTransform {
                translation: numbers(offset),
                ..NumberTransform::IDENTITY
            },
            motion: *motion,
            coordinate: link,
        });
        mechanism
            .coordinates
            .push(coordinate(&format!("{name}.{joint}"), 0.1 * index as f64 - 0.2));
        mechanism.bodies.push(Body {
            name: format!("{name}.{joint}"),
            source: String::new(),
            link: Some(link),
            mass: Number::Constant(0.005 + 0.001 * index as f64),
            center: numbers([0.012, 0.001, 0.002]),
            inertia: numbers([6e-8, 3e-7, 2.9e-7, 1e-9, 0.0, 2e-9]),
        });
    }
    first
}

fn strand(name: &str, points: Vec<Point>) -> Strand {
    Strand {
        name: name.into(),
        source: "sample.hdl:20".into(),
        doc: String::new(),
        points,
        wraps: Vec::new(),
        law: Law::Linear { stiffness: Number::Value(0) },
        damping: Number::ZERO,
        slack: None,
        actuator: None,
        friction: None,
        quasi_static: false,
        rest: None,
    }
}

fn revolute(axis: [f64; 3]) -> Motion {
    Motion::Revolute { axis: numbers(axis) }
}

/// A hand of five fingers with four joints and four strands each.
pub(crate) fn hand() -> Mechanism {
    let mut hand = Mechanism {
        name: "sample_hand".into(),
        gravity: numbers([0.0, -9.81, 0.0]),
        params: vec![Param {
            name: "k".into(),
            doc: String::new(),
            unit: "N/m".into(),
            default: 200.0,
        }],
        values: program(|| Sym::leaf(Leaf::Param(0))),
        ..Mechanism::default()
    };
    let (y, z) = ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    for (index, finger) in ["thumb", "index", "middle", "ring", "little"].into_iter().enumerate() {
        let side = 0.02 * index as f64;
        let joints = [
            ("abduct", revolute(y)),
            ("mcp", revolute(z)),
            ("pip", revolute(z)),
            ("dip", revolute(z)),
        ];
        let first = chain(&mut hand, finger, [0.0, 0.0, side], &joints);
        for (number, offset) in [-0.01, -0.008, 0.009, -0.006].into_iter().enumerate() {
            let mut points =
                vec![world([-0.06, offset, side]), world([-0.008, offset, side + 0.002])];
            for link in 1..=(3 - number as u32 % 3) {
                points.push(at(first + link, [0.004, offset, 0.001]));
                points.push(at(first + link, [0.024, offset * 0.9, -0.001]));
            }
            hand.strands.push(strand(&format!("{finger}.s{number}"), points));
        }
        let link_from_frame =
            NumberTransform { translation: numbers([0.02, 0.0, 0.0]), ..NumberTransform::IDENTITY };
        hand.frames.push(Frame {
            name: format!("{finger}.tip"),
            link: Some(first + 3),
            link_from_frame,
        });
    }
    let open: Vec<(u32, Number)> = (0..20).map(|c| (c, Number::Constant(-0.05))).collect();
    let fist = (0..20).map(|c| (c, Number::Constant(if c % 4 == 0 { 0.02 } else { -0.8 })));
    hand.scenarios.push(Scenario {
        name: "close".into(),
        step: Some(Number::Constant(1e-3)),
        duration: Some(Number::Constant(10.0)),
        poses: vec![("open".into(), open), ("fist".into(), fist.collect())],
        motions: vec![(
            "motion".into(),
            vec![(0, Number::ZERO), (1, Number::Constant(4.0)), (0, Number::Constant(8.0))],
        )],
        follow: vec![(0, (0..20).collect())],
        ..Scenario::default()
    });
    hand
}

/// One of everything.
pub(crate) fn everything() -> Mechanism {
    let mut model = Mechanism {
        name: "crate".into(),
        doc: "One of everything.".into(),
        gravity: numbers([0.3, -9.81, 0.1]),
        params: ["k", "type", "sqrt"]
            .map(|name| Param {
                name: name.into(),
                doc: String::new(),
                unit: String::new(),
                default: 1.5,
            })
            .to_vec(),
        values: program(|| Sym::leaf(Leaf::Param(0)) * Sym::leaf(Leaf::Param(0)).scale(40.0)),
        ..Mechanism::default()
    };
    model.values = with_new(|| {
        let p = |i| Sym::leaf(Leaf::Param(i));
        to_program(&[p(0) * p(0).scale(40.0), p(1).sin_cos().0, p(2).sqrt().scale(0.001)])
    });
    let slanted = [0.6, 0.0, 0.8];
    let joints = [
        ("a", revolute([0.0, 0.0, 1.0])),
        ("A", revolute(slanted)),
        ("slide", Motion::Prismatic { axis: numbers([0.0, 1.0, 0.0]) }),
        ("bolt", Motion::Screw { axis: numbers([1.0, 0.0, 0.0]), pitch: Number::Value(2) }),
    ];
    chain(&mut model, "one", [0.0, 0.0, 0.0], &joints);
    chain(&mut model, "two", [0.05, 0.0, 0.1], &joints);
    model.coordinates[6].is_length = true;
    model.coordinates[1].damping = Number::Constant(1e-4);
    model.coordinates[2].stiffness = Number::Value(1);
    model.coordinates[3].limits = Some(numbers([-0.5, 0.05]));
    model.coordinates[3].limit_stiffness = Number::Constant(0.4);
    model.coordinates[4].drive = Some(program(|| {
        (Sym::leaf(Leaf::Time) * Sym::leaf(Leaf::Param(1))).sin_cos().0.scale(0.3)
    }));
    model.inputs.push(Input {
        name: "match".into(),
        doc: "A force.".into(),
        unit: "N".into(),
        default: program(|| Sym::leaf(Leaf::Time).scale(2.0).sin_cos().1),
    });
    let path = vec![
        world([-0.1, 0.0, 0.0]),
        at(1, [0.0, 0.01, 0.0]),
        at(5, [0.01, 0.0, 0.02]),
        at(7, [0.02; 3]),
    ];
    model.strands.push(strand("mod", path));
    model.strands.push(Strand {
        rest: Some(program(|| {
            Sym::leaf(Leaf::Input(0)) * Sym::constant(1e-3) + Sym::constant(0.1)
        })),
        law: Law::Linear { stiffness: Number::Constant(30.0) },
        damping: Number::Constant(0.2),
        slack: Some(Number::Constant(1e-3)),
        ..strand("mod.x", vec![world([0.0, 0.1, 0.0]), at(3, [0.0; 3])])
    });
    let constraint =
        |name: &str, kind| Constraint { name: name.into(), source: String::new(), kind };
    let (a, b) = (at(3, [0.01, 0.0, 0.0]), at(7, [0.0, 0.01, 0.0]));
    model.constraints = vec![
        constraint(
            "pin",
            ConstraintKind::Coincident { first: a, second: b, axes: [true, false, true] },
        ),
        constraint(
            "rod",
            ConstraintKind::Distance { first: a, second: b, distance: Number::Constant(0.1) },
        ),
        constraint(
            "plane",
            ConstraintKind::OnPlane { point: a, through: b, normal: numbers([0.0, 1.0, 0.0]) },
        ),
        constraint(
            "weld",
            ConstraintKind::Weld {
                first: Some(2),
                first_from_frame: NumberTransform::IDENTITY,
                second: Some(6),
                second_from_frame: NumberTransform::IDENTITY,
            },
        ),
        constraint(
            "law",
            ConstraintKind::Equation(function(&[Leaf::Q(0), Leaf::Length(1)], || {
                Sym::leaf(Leaf::Q(0)).sin_cos().0
                    - Sym::leaf(Leaf::Length(1)) * Sym::leaf(Leaf::Param(0))
            })),
        ),
    ];
    model.torques.push(Torque {
        name: "muscle".into(),
        source: String::new(),
        coordinate: 1,
        value: function(&[Leaf::Q(1), Leaf::V(0), Leaf::Length(0)], || {
            let q = Sym::leaf(Leaf::Q(1));
            q * q * Sym::leaf(Leaf::V(0)) - Sym::leaf(Leaf::Length(0)) * Sym::leaf(Leaf::Input(0))
        }),
    });
    let force = |axis: usize| {
        function(&[Leaf::Q(2)], || Sym::leaf(Leaf::Q(2)).scale(axis as f64) + Sym::leaf(Leaf::Time))
    };
    model.forces.push(Force {
        name: "push".into(),
        source: String::new(),
        point: at(7, [0.01, 0.02, 0.03]),
        value: [force(0), force(1), force(2)],
        axes: Some(2),
    });
    model.frames.push(Frame {
        name: "frame".into(),
        link: Some(3),
        link_from_frame: NumberTransform::IDENTITY,
    });
    for name in ["self", "Self"] {
        model.scenarios.push(Scenario {
            name: name.into(),
            doc: "Shakes.".into(),
            step: Some(Number::Constant(1e-3)),
            duration: Some(Number::Value(1)),
            set: vec![(0, Number::Constant(1.2))],
            start: vec![(3, Number::Value(2))],
            inputs: vec![(0, program(|| Sym::leaf(Leaf::Time).scale(3.0)))],
            drives: vec![(5, program(|| Sym::leaf(Leaf::Time) * Sym::leaf(Leaf::Param(2))))],
            records: vec![
                ("length".into(), program(|| Sym::leaf(Leaf::Length(0)).scale(2.0))),
                ("pull".into(), program(|| Sym::leaf(Leaf::Lambda(2)) - Sym::leaf(Leaf::V(3)))),
            ],
            ..Scenario::default()
        });
    }
    model
}

/// Numbers for every leaf.
struct Point1 {
    q: Vec<f64>,
    v: Vec<f64>,
    rest: Vec<f64>,
    inputs: Vec<f64>,
    params: Vec<f64>,
    lambda: Vec<f64>,
}

const T: f64 = 0.37;
const H: f64 = 2e-3;

impl Point1 {
    fn new(model: &Interpreter) -> Point1 {
        let list = |count: usize, seed: f64| -> Vec<f64> {
            (0..count).map(|i| (seed + 1.7 * i as f64).sin() * 0.4).collect()
        };
        let layout = model.layout();
        Point1 {
            q: list(layout.coordinates.len(), 0.3),
            v: list(layout.coordinates.len(), 1.1),
            rest: list(layout.strands.len(), 2.0),
            inputs: list(layout.inputs.len(), 0.9),
            params: model.params().to_vec(),
            lambda: list(layout.rows.len(), 0.1),
        }
    }

    fn midpoint(&self) -> Midpoint<'_> {
        Midpoint { q: &self.q, v: &self.v, t: T, rest: &self.rest, inputs: &self.inputs }
    }
}

fn check(mechanism: Mechanism) {
    let structure = Structure::new(&mechanism);
    let mut model = Interpreter::new(Arc::new(mechanism.clone()));
    let point = Point1::new(&model);
    with_new(|| {
        let staged = stage(&mechanism, &structure, DEFAULT_BUDGET);
        let values = staged.tasks.iter().find(|task| task.module == Module::Values);
        let read_first = |leaf: Leaf| match leaf {
            Leaf::Param(i) => point.params[i as usize],
            other => panic!("a value reads {other:?}"),
        };
        let values = values.map_or(Vec::new(), |task| {
            let symbols: Vec<Sym> = task.outputs.iter().map(|output| output.value).collect();
            evaluate(&symbols, read_first)
        });
        let read = |leaf: Leaf| match leaf {
            Leaf::Q(i) => point.q[i as usize],
            Leaf::V(i) => point.v[i as usize],
            Leaf::Rest(i) => point.rest[i as usize],
            Leaf::Input(i) => point.inputs[i as usize],
            Leaf::Param(i) => point.params[i as usize],
            Leaf::Lambda(i) => point.lambda[i as usize],
            Leaf::Value(i) => values[i as usize],
            Leaf::Time => T,
            Leaf::Step => H,
            Leaf::Length(_) | Leaf::Own(_) | Leaf::Strand(..) => panic!("{leaf:?} is left"),
            Leaf::Constant(i) => panic!("constant {i} stands outside of a part"),
            Leaf::System(..) => panic!("{leaf:?} stands outside of a system"),
        };
        // A block's own numbering, and its constants.
        let read_in = |shape: &Shape, block: usize, leaf: Leaf| {
            let place = &shape.places[block];
            let global = |list: &[usize], i: u32| list[i as usize] as u32;
            match leaf {
                Leaf::Q(i) => read(Leaf::Q(global(&place.coordinates, i))),
                Leaf::V(i) => read(Leaf::V(global(&place.coordinates, i))),
                Leaf::Rest(i) => read(Leaf::Rest(global(&place.strands, i))),
                Leaf::Input(i) => read(Leaf::Input(global(&place.inputs, i))),
                Leaf::Constant(i) => evaluate(&[shape.constants[block][i as usize]], read)[0],
                other => read(other),
            }
        };
        let in_blocks = |name: &str, array: &str, size: usize| -> Vec<f64> {
            let mut found = vec![0.0; size];
            for task in staged.tasks.iter().filter(|t| t.name == name) {
                let Module::Part(number) = task.module else { continue };
                let shape = &staged.shapes[number];
                let symbols: Vec<Sym> = task.outputs.iter().map(|output| output.value).collect();
                for (block, place) in shape.places.iter().enumerate() {
                    let results = evaluate(&symbols, |leaf| read_in(shape, block, leaf));
                    for (output, value) in task.outputs.iter().zip(results) {
                        let Place::Element { array: own, index } = output.place else { continue };
                        let index = match own {
                            "matrix" => {
                                let [first, width] = place.matrix;
                                first + index / shape.unknowns * width + index % shape.unknowns
                            }
                            "lengths" => place.strands[index],
                            _ => place.coordinates[index],
                        };
                        if own == array {
                            found[index] = value;
                        }
                    }
                }
            }
            found
        };
        let find = |module: Module, name: &str, array: &str, size: usize| -> Vec<f64> {
            let mut found = vec![0.0; size];
            for task in staged.tasks.iter().filter(|t| t.name == name) {
                if std::mem::discriminant(&task.module) != std::mem::discriminant(&module) {
                    continue;
                }
                let symbols: Vec<Sym> = task.outputs.iter().map(|output| output.value).collect();
                for (output, value) in task.outputs.iter().zip(evaluate(&symbols, read)) {
                    match output.place {
                        Place::Element { array: own, index } if own == array => {
                            found[index] = value
                        }
                        Place::Return => found[0] = value,
                        _ => {}
                    }
                }
            }
            found
        };
        let layout = Arc::clone(model.layout());
        let (n, m) = (layout.coordinates.len(), layout.rows.len());
        let zeros = |count| vec![0.0; count];
        let (mut p, mut f, mut matrix) = (zeros(n), zeros(n), zeros(layout.matrix_size()));
        model.evaluate_with_matrix(&point.midpoint(), H, &mut p, &mut f, &mut matrix);
        for i in (0..n).filter(|&i| layout.coordinates[i].kinematic) {
            (p[i], f[i]) = (0.0, 0.0);
        }
        same("momentum", &in_blocks("evaluate", "momentum", n), &p);
        same("force", &in_blocks("evaluate", "force", n), &f);
        same("force", &in_blocks("evaluate_with_matrix", "force", n), &f);
        same("matrix", &in_blocks("evaluate_with_matrix", "matrix", matrix.len()), &matrix);
        model.mass_matrix(&point.q, &mut matrix);
        same("mass", &in_blocks("mass_matrix", "matrix", matrix.len()), &matrix);
        model.momentum_matrix(&point.midpoint(), H, &mut matrix);
        let asked = staged.tasks.iter().filter(|task| task.name == "momentum_matrix");
        let asked: Vec<Module> = asked.map(|task| task.module).collect();
        let shapes = staged.shapes.iter().enumerate();
        let shapes = shapes.filter(|(number, _)| asked.contains(&Module::Part(*number)));
        let asked: Vec<usize> = shapes
            .flat_map(|(_, shape)| shape.places.iter().map(|place| place.matrix[0]))
            .collect();
        for block in &layout.blocks {
            let count = block.coordinates.len();
            let is_few = block.rows.is_empty() && count <= FEW;
            assert!(!is_few || asked.contains(&block.matrix_offset), "asked of {block:?}");
            if !asked.contains(&block.matrix_offset) {
                matrix[block.matrix_offset..][..count * count].fill(0.0);
            }
        }
        same("momentum", &in_blocks("momentum_matrix", "matrix", matrix.len()), &matrix);
        let (mut rows, mut jacobian) = (zeros(m), zeros(layout.constraint_size()));
        model.constraints(&point.q, T, &point.rest, &mut rows);
        model.constraint_jacobian(&point.q, T, &mut jacobian);
        same("rows", &find(Module::Constraints, "rows", "rows", m), &rows);
        let found = find(Module::Constraints, "jacobian", "jacobian", jacobian.len());
        same("jacobian", &found, &jacobian);
        let energy = model.potential(&point.q, &point.rest);
        same("potential", &find(Module::Energy, "potential", "", 1), &[energy]);
        let mut lengths = zeros(layout.strands.len());
        model.strand_lengths(&point.q, &mut lengths);
        let mut found = find(Module::Strands, "lengths", "lengths", lengths.len());
        let of_blocks = in_blocks("lengths", "lengths", lengths.len());
        found.iter_mut().zip(of_blocks).for_each(|(outside, inside)| *outside += inside);
        same("lengths", &found, &lengths);
        let mut arms = zeros(lengths.len() * n);
        model.moment_arms(&point.q, &mut arms);
        same("arms", &find(Module::Strands, "moment_arms", "arms", arms.len()), &arms);
        let (mut q, mut v) = (zeros(n), zeros(n));
        model.start(&mut q, &mut v);
        same("start", &find(Module::Time, "start", "q", n), &q);
        let mut driven = zeros(n);
        model.drives(T, &mut driven);
        same("drives", &find(Module::Time, "drives", "q", n), &driven);
        let mut inputs = zeros(layout.inputs.len());
        model.inputs(T, &mut inputs);
        same("inputs", &find(Module::Time, "inputs", "inputs", inputs.len()), &inputs);
        if let Some(scenario) = layout.scenarios.first() {
            let mut records = zeros(scenario.records.len());
            let at = Instant {
                t: T,
                q: &point.q,
                v: &point.v,
                inputs: &point.inputs,
                lambda: &point.lambda,
                rest: &point.rest,
                h: H,
            };
            model.scenario_records(0, &at, &mut records);
            let found = find(Module::Scenario(0), "records", "records", records.len());
            same("records", &found, &records);
        }
    });
}

fn same(what: &str, found: &[f64], expected: &[f64]) {
    let scale = expected.iter().fold(1e-12, |a: f64, b| a.max(b.abs()));
    for (index, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!(
            (found - expected).abs() <= 1e-11 * scale,
            "{what}[{index}]: {found} instead of {expected}"
        );
    }
}

#[test]
fn a_hand_is_staged_to_what_the_interpreter_computes() {
    check(hand());
}

#[test]
fn one_of_everything_is_staged_to_what_the_interpreter_computes() {
    check(everything());
}

#[test]
fn parameters_are_worked_out_once() {
    let mechanism = everything();
    let structure = Structure::new(&mechanism);
    with_new(|| {
        let staged = stage(&mechanism, &structure, DEFAULT_BUDGET);
        assert!(staged.values > 0);
        let _ = Variable::Time;
    });
}
