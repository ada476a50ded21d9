//! The neutral JSON of the reference models as mechanisms, without the language in between.

use handc_runtime::expression::Program;
use handc_runtime::mechanism::{
    Body, Constraint, ConstraintKind, Coordinate, Frame, Law, Link, Mechanism, Motion, Number,
    NumberTransform, Point, Role, Strand,
};
use serde_json::Value;
use std::collections::HashMap;

type Place = (Option<u32>, [[f64; 3]; 3], [f64; 3]);

/// Reads a reference model; scenarios are left out.
pub fn mechanism(json: &Value) -> Mechanism {
    let number = Number::Constant;
    let vector = |v: [f64; 3]| v.map(Number::Constant);
    let mut mechanism = Mechanism {
        name: text(&json["name"]),
        gravity: vector(triple(&json["gravity"])),
        ..Mechanism::default()
    };
    let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut places: HashMap<String, Place> =
        HashMap::from([("world".to_string(), (None, identity, [0.0; 3]))]);
    for frame in json["frames"].as_array().unwrap() {
        let (link, rotation, origin) = places[&text(&frame["parent"])];
        let kind = text(&frame["type"]);
        let mut place = (link, rotation, origin);
        if kind == "const" {
            place.2 = add(origin, times(rotation, triple(&frame["p"])));
        } else {
            let axis = "xyz".find(&kind[1..]).unwrap();
            let unit = identity[axis];
            let rotates = kind.starts_with('r');
            if let Some(name) = frame["value"].as_str() {
                let coordinate = mechanism.coordinates.len() as u32;
                let damping = &json["damping"];
                let c = damping["coefficients"][name].as_f64().or(damping["default"].as_f64());
                mechanism.coordinates.push(Coordinate {
                    name: name.to_string(),
                    source: String::new(),
                    doc: String::new(),
                    is_length: !rotates,
                    start: number(json["q0"][name].as_f64().unwrap()),
                    velocity: Number::ZERO,
                    damping: number(c.unwrap_or(0.0)),
                    stiffness: Number::ZERO,
                    rest: Number::ZERO,
                    limits: None,
                    limit_stiffness: Number::ZERO,
                    limit_width: Number::ZERO,
                    drive: None,
                    role: Role::Joint,
                });
                let axis = vector(unit);
                mechanism.links.push(Link {
                    parent: link,
                    parent_from_joint: NumberTransform {
                        rotation: rotation.map(vector),
                        translation: vector(origin),
                    },
                    motion: if rotates {
                        Motion::Revolute { axis }
                    } else {
                        Motion::Prismatic { axis }
                    },
                    coordinate,
                });
                place = (Some(mechanism.links.len() as u32 - 1), identity, [0.0; 3]);
            } else {
                let value = frame["value"].as_f64().unwrap();
                if rotates {
                    place.1 = turn(rotation, axis, value);
                } else {
                    place.2 = add(origin, times(rotation, unit.map(|x| x * value)));
                }
            }
        }
        let name = text(&frame["name"]);
        if let Some(mass) = frame["mass"].as_f64() {
            let inertia =
                frame["inertia"].as_array().map_or([0.0; 3], |_| triple(&frame["inertia"]));
            assert!(
                inertia == [0.0; 3] || place.1 == identity || place.0.is_none(),
                "bodies with inertia stand straight in their links"
            );
            let [xx, yy, zz] = vector(inertia);
            let zero = Number::ZERO;
            mechanism.bodies.push(Body {
                name: name.clone(),
                source: String::new(),
                link: place.0,
                mass: number(mass),
                center: vector(place.2),
                inertia: [xx, yy, zz, zero, zero, zero],
            });
        }
        mechanism.frames.push(Frame {
            name: name.clone(),
            link: place.0,
            link_from_frame: NumberTransform {
                rotation: place.1.map(vector),
                translation: vector(place.2),
            },
        });
        places.insert(name, place);
    }
    let point = |frame: &Value, offset: [f64; 3]| {
        let (link, rotation, origin) = places[&text(frame)];
        Point { link, position: vector(add(origin, times(rotation, offset))) }
    };
    let empty = Vec::new();
    let list = |name: &str| json[name].as_array().unwrap_or(&empty).clone();
    for strand in list("strands") {
        mechanism.strands.push(Strand {
            name: text(&strand["name"]),
            source: String::new(),
            doc: String::new(),
            points: strand["points"]
                .as_array()
                .unwrap()
                .iter()
                .map(|p| point(&p["frame"], triple(&p["offset"])))
                .collect(),
            wraps: Vec::new(),
            law: Law::Linear { stiffness: number(strand["k"].as_f64().unwrap()) },
            damping: Number::ZERO,
            slack: None,
            actuator: None,
            friction: None,
            quasi_static: false,
            rest: None,
        });
    }
    for (i, spring) in list("springs").iter().enumerate() {
        mechanism.strands.push(Strand {
            name: format!("spring{i}"),
            source: String::new(),
            doc: String::new(),
            points: vec![point(&spring["frame1"], [0.0; 3]), point(&spring["frame2"], [0.0; 3])],
            wraps: Vec::new(),
            law: Law::Linear { stiffness: number(spring["k"].as_f64().unwrap()) },
            damping: Number::ZERO,
            slack: None,
            actuator: None,
            friction: None,
            quasi_static: false,
            rest: Some(constant(spring["x0"].as_f64().unwrap())),
        });
    }
    for (i, c) in list("constraints").iter().enumerate() {
        assert_eq!(c["type"], "distance");
        mechanism.constraints.push(Constraint {
            name: format!("rod{i}"),
            source: String::new(),
            kind: ConstraintKind::Distance {
                first: point(&c["frame1"], [0.0; 3]),
                second: point(&c["frame2"], [0.0; 3]),
                distance: number(c["distance"].as_f64().unwrap()),
            },
        });
    }
    mechanism
}

fn constant(value: f64) -> Program {
    Program {
        operations: vec![handc_runtime::expression::Operation::Constant(value)],
        outputs: vec![0],
    }
}
fn text(value: &Value) -> String {
    value.as_str().unwrap_or("").to_string()
}
fn triple(value: &Value) -> [f64; 3] {
    [0, 1, 2].map(|i| value[i].as_f64().unwrap())
}
fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] + b[i])
}
fn times(r: [[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    r.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}
fn turn(r: [[f64; 3]; 3], axis: usize, angle: f64) -> [[f64; 3]; 3] {
    let (s, c) = angle.sin_cos();
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
    r.map(|row| {
        let mut out = row;
        out[j] = row[j] * c + row[k] * s;
        out[k] = row[k] * c - row[j] * s;
        out
    })
}
