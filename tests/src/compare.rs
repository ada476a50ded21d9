//! Requests made from the interpreter's own run, and the comparison of two sides' answers.

use crate::chance::Chance;
use crate::probe::{Answer, Point, Request, Start};
use handc_core::model::Model;
use handc_core::simulation::{Settings, Simulation};
use handc_runtime::interpreter::Interpreter;
use handc_runtime::mechanism::Mechanism;
use std::sync::Arc;

/// Steps followed and points evaluated in each scenario.
const STEPS: usize = 12;
const POINTS: usize = 4;

/// Requests for every scenario of a mechanism; `None` if one of them cannot start.
pub fn requests(mechanism: &Mechanism, seed: u64) -> Option<Vec<Request>> {
    let mut chance = Chance::new(seed);
    let model = Interpreter::new(Arc::new(mechanism.clone()));
    let mut settings: Vec<Settings> = mechanism
        .scenarios
        .iter()
        .map(|s| Settings { scenario: Some(s.name.clone()), ..Settings::default() })
        .collect();
    if settings.is_empty() {
        let (step, duration) = (Some(1e-3), Some(0.1));
        settings.push(Settings { step, duration, ..Settings::default() });
    }
    settings.iter().map(|settings| request(&model, settings, &mut chance)).collect()
}

fn request(model: &Interpreter, settings: &Settings, chance: &mut Chance) -> Option<Request> {
    let mut simulation = Simulation::new(model.clone(), settings).ok()?;
    let mut starts = Vec::new();
    let mut points = Vec::new();
    for _ in 0..STEPS {
        let state = &simulation.state;
        let numbers = [state.q.clone(), state.p.clone(), state.v.clone(), state.lambda.clone()];
        starts.push(Start { step: state.step, numbers });
        if simulation.step().is_err() {
            break;
        }
    }
    let layout = model.layout();
    for _ in 0..POINTS {
        let mut many = |count: usize, size: f64| -> Vec<f64> {
            (0..count).map(|_| chance.between(-size, size)).collect()
        };
        let mut q = many(layout.coordinates.len(), 0.4);
        q.iter_mut().zip(&simulation.state.q).for_each(|(q, start)| *q += start);
        let v = many(q.len(), 3.0);
        let mut rest = many(layout.strands.len(), 0.05);
        rest.iter_mut().zip(simulation.rest()).for_each(|(rest, fed)| *rest += fed);
        let inputs = many(layout.inputs.len(), 1.0);
        let lambda = many(layout.rows.len(), 1.0);
        points.push(Point { t: chance.between(0.0, 0.05), numbers: [q, v, rest, inputs, lambda] });
    }
    let model = layout.name.clone();
    Some(Request { model, settings: settings.clone(), starts, points })
}

/// Whether every constraint row has a coordinate that changes it. A row that holds by itself is told
/// by a lint; what rounding leaves of its Jacobian is not the same on the two sides.
pub fn every_row_moves(mechanism: &Mechanism) -> bool {
    let mut model = Interpreter::new(Arc::new(mechanism.clone()));
    let layout = model.layout().clone();
    let n = layout.coordinates.len();
    let (mut q, mut v) = (vec![0.0; n], vec![0.0; n]);
    model.start(&mut q, &mut v);
    model.drives(0.0, &mut q);
    let mut jacobian = vec![0.0; layout.constraint_size()];
    model.constraint_jacobian(&q, 0.0, &mut jacobian);
    layout.blocks.iter().all(|block| {
        let rows = jacobian[block.constraint_offset..].chunks(block.coordinates.len().max(1));
        rows.take(block.rows.len()).all(|row| row.iter().any(|x| x.abs() > 1e-9))
    })
}

/// Everything in which two sides differ by more than rounding, one line each.
pub fn differences(model: &str, expected: &[Answer], found: &[Answer]) -> Vec<String> {
    let mut wrong = Vec::new();
    if expected.len() != found.len() {
        wrong.push(format!("{model}: {} answers against {}", expected.len(), found.len()));
    }
    for (e, f) in expected.iter().zip(found) {
        // What a failed step says holds numbers that rounding changes.
        let head = |what: &str| what.split(": the ").next().unwrap_or_default().to_string();
        if head(&e.what) != head(&f.what) || e.values.len() != f.values.len() {
            wrong.push(format!("{model}: `{}` against `{}`", e.what, f.what));
            continue;
        }
        let bound = bound(e, expected);
        for (k, (a, b)) in e.values.iter().zip(&f.values).enumerate() {
            let equal = a == b || (a.is_nan() && b.is_nan());
            if !equal && !((a - b).abs() <= bound) {
                let off = (a - b).abs();
                wrong.push(format!("{model}: {} [{k}]: {a:e} and {b:e}, {off:.1e} off", e.what));
            }
        }
    }
    wrong
}

/// How far the numbers of an answer may be off: 1e-12 of the largest of them. Results of
/// a step end where rounding of the coordinates leaves the step's equations.
fn bound(answer: &Answer, all: &[Answer]) -> f64 {
    let largest = answer.values.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let beside = |what: &str| {
        let step: Vec<&str> = answer.what.split(' ').take(2).collect();
        let name = format!("{} {what}", step.join(" "));
        all.iter().find(|a| a.what == name)
    };
    let rounding = |which: usize| beside("rounding").map_or(0.0, |a| FLOOR * a.values[which]);
    let what = answer.what.split(' ').nth(2).unwrap_or_default();
    let floor = match what {
        "q" => rounding(2),
        "p" => rounding(0),
        "lambda" => rounding(1),
        // ½pᵀM⁻¹p, of momenta that far off.
        "energy" => rounding(0) * RATE,
        // Its terms cancel; what rounding of the coordinates makes of it is ∑|f||q|.
        "potential" => {
            let pull = |a: &Answer| {
                a.values.iter().map(|f| f.abs()).filter(|f| f.is_finite()).sum::<f64>()
            };
            FLOOR * f64::EPSILON * beside("force").map_or(0.0, pull)
        }
        "rounding" => return f64::INFINITY,
        _ => SMALLEST,
    };
    1e-12 * largest + floor
}

/// Units of rounding by which a step's coordinates (of 1 rad or 1 m) and momenta may be off: the two
/// sides' iterations may end at different points of the floor, and loops amplify it. The functions
/// themselves are held to 1e-12.
const FLOOR: f64 = 128.0;
/// Rates of the tested models stay below this (rad/s or m/s).
const RATE: f64 = 10.0;
/// Numbers below this are zero: sums whose terms cancel.
const SMALLEST: f64 = 1e-16;
