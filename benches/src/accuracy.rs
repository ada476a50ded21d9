//! Accuracy beside speed: free swings from the same start, with natural lengths that stay.
//!
//! Nothing is fed and nothing damps, so both sides solve the same differential equations and keep,
//! or lose, the same energy. The reference is neither's own step: MuJoCo's RK4 at a fine step,
//! against which handc extrapolated to step zero is held too.

use crate::own::{Crate, Own};
use crate::rival::Rival;
use crate::speed::INTEGRATORS;
use crate::table::figure;
use handc_core::model::Model;
use handc_core::simulation::{Settings, Simulation};
use handc_tests::load::interpreter;
use handc_tests::table::Table;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Steps (s) at which errors are taken; they halve.
const STEPS: [f64; 5] = [2e-3, 1e-3, 5e-4, 2.5e-4, 1.25e-4];

/// Step of the reference (s).
const FINE: f64 = 1.25e-5;

/// Time at which positions are compared, and how often (s).
const HORIZON: f64 = 0.5;
const SAMPLE: f64 = 0.01;

/// Errors at which times are compared (rad).
const EQUAL: [f64; 3] = [1e-2, 1e-4, 1e-6];

/// A run: positions at the samples by handc's order, energies, and µs a step.
struct Run {
    q: Vec<Vec<f64>>,
    energy: Vec<f64>,
    time: f64,
    /// Largest gap of the constraints, where it is known.
    gap: Option<f64>,
}

/// One method at one step.
struct Point {
    step: f64,
    error: f64,
    /// Time for one second of the model (s).
    cost: f64,
}

/// The report on hand, finger and grasp as markdown.
pub(crate) fn report(own: &Own, rival: &mut Rival, crates: &[Crate]) -> Result<String, String> {
    let mut text = String::new();
    for name in ["hand", "finger"] {
        let made = crates.iter().find(|c| c.name == name).ok_or("no crate")?;
        swing(own, rival, made, &mut text)?;
    }
    let made = crates.iter().find(|c| c.name == "grasp").ok_or("no grasp")?;
    energy(own, rival, made, "hold", 10.0, &mut text)?;
    Ok(text)
}

fn swing(own: &Own, rival: &mut Rival, made: &Crate, text: &mut String) -> Result<(), String> {
    let names = coordinates(own, made);
    let xml = own.export(&model_file(own, made), "swing")?;
    let reference = theirs(rival, &xml, "RK4", FINE, HORIZON, SAMPLE, &names)?;
    let two = [FINE * 2.0, FINE].map(|step| ours(own, made, "swing", step, HORIZON, SAMPLE));
    let [coarse, fine] = two;
    let (coarse, fine) = (coarse?, fine?);
    // Second order: the error falls by four when the step is halved.
    let limit: Vec<Vec<f64>> = fine
        .q
        .iter()
        .zip(&coarse.q)
        .map(|(f, c)| f.iter().zip(c).map(|(f, c)| f + (f - c) / 3.0).collect())
        .collect();
    let agreement = distance(&limit, &reference.q);
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "\n### {}, free swing\n\nReference: MuJoCo's RK4 at {FINE:e} s; handc extrapolated to step zero agrees \
         to {} rad over {HORIZON} s.\nError: the largest difference of any coordinate at any of the samples \
         every {SAMPLE} s.\n\n| method | {} | us/step |\n|---|{}---|",
        made.name,
        figure(agreement),
        STEPS.map(|s| format!("error at {} ms", s * 1e3)).join(" | "),
        "---|".repeat(STEPS.len())
    );
    let mut methods: Vec<(String, Vec<Point>)> = Vec::new();
    for method in ["handc"].into_iter().chain(INTEGRATORS) {
        let mut points = Vec::new();
        let mut least = f64::INFINITY;
        for step in STEPS {
            let run = match method {
                "handc" => ours(own, made, "swing", step, HORIZON, SAMPLE),
                integrator => theirs(rival, &xml, integrator, step, HORIZON, SAMPLE, &names),
            };
            let Ok(run) = run else {
                points.push(Point { step, error: f64::NAN, cost: f64::NAN });
                continue;
            };
            least = least.min(run.time);
            points.push(Point {
                step,
                error: distance(&run.q, &reference.q),
                cost: run.time * 1e-6 / step,
            });
        }
        let errors: Vec<String> = points.iter().map(|p| figure(p.error)).collect();
        let _ = writeln!(text, "| {method} | {} | {} |", errors.join(" | "), figure(least));
        // The same cost of a step at every step.
        points.iter_mut().for_each(|p| p.cost = least * 1e-6 / p.step);
        methods.push((method.to_string(), points));
    }
    let _ = writeln!(
        text,
        "\nSeconds of computing for 1 s of the model at an error of so many rad, and how many times handc's; \
         read off between the steps above, and along them beyond.\n\n| method | {} |\n|---|{}",
        EQUAL.map(|error| format!("{error:e}")).join(" | "),
        "---|".repeat(EQUAL.len())
    );
    for (method, points) in &methods {
        let costs = EQUAL.map(|error| {
            let (own, cost) = (cost_at(&methods[0].1, error), cost_at(points, error));
            format!("{}: {}x", figure(cost), figure(cost / own))
        });
        let _ = writeln!(text, "| {method} | {} |", costs.join(" | "));
    }
    energy(own, rival, made, "swing", 10.0, text)
}

/// The cost at which an error is reached, along the line through the two points
/// nearest to it in logarithms; beyond the steps tried it is extrapolated.
fn cost_at(points: &[Point], wanted: f64) -> f64 {
    let usable: Vec<&Point> =
        points.iter().filter(|p| p.error.is_finite() && p.error > 0.0 && p.error < 0.3).collect();
    let near = |p: &&&Point| ((p.error / wanted).ln().abs() * 1e6) as i64;
    let mut near_first: Vec<&&Point> = usable.iter().collect();
    near_first.sort_by_key(near);
    let [a, b, ..] = near_first[..] else { return f64::NAN };
    let slope = (b.cost / a.cost).ln() / (b.error / a.error).ln();
    a.cost * (wanted / a.error).powf(slope)
}

fn energy(
    own: &Own,
    rival: &mut Rival,
    made: &Crate,
    scenario: &str,
    duration: f64,
    text: &mut String,
) -> Result<(), String> {
    let names = coordinates(own, made);
    let xml = own.export(&model_file(own, made), scenario)?;
    let (step, sample) = (1e-3, 0.01);
    let _ = writeln!(
        text,
        "\n### {}, `{scenario}`: energy over {duration} s at {} ms\n\n\
         Relative to the largest kinetic energy of the first second.\n\n\
         | method | largest change | at the end | largest gap of constraints, m |\n|---|---|---|---|",
        made.name,
        step * 1e3
    );
    let scale = largest_kinetic(own, made, scenario)?;
    for method in ["handc"].into_iter().chain(INTEGRATORS) {
        let run = match method {
            "handc" => ours(own, made, scenario, step, duration, sample),
            integrator => theirs(rival, &xml, integrator, step, duration, sample, &names),
        };
        let _ = match run {
            Ok(run) => {
                let changes = run.energy.iter().map(|e| (e - run.energy[0]) / scale);
                let changes: Vec<f64> = changes.collect();
                let largest = changes.iter().copied().fold(0.0, |m: f64, c| m.max(c.abs()));
                let last = changes.last().copied().unwrap_or(f64::NAN);
                let gap = run.gap.map_or("-".to_string(), |gap| format!("{gap:.1e}"));
                let diverged = changes.iter().any(|c| c.is_nan());
                let largest = if diverged { f64::INFINITY } else { largest };
                writeln!(text, "| {method} | {largest:.1e} | {last:+.1e} | {gap} |")
            }
            Err(reason) => writeln!(text, "| {method} | {reason} | | |"),
        };
    }
    Ok(())
}

fn model_file(own: &Own, made: &Crate) -> PathBuf {
    own.folder.join(format!("models/{}.hdl", made.name))
}

/// Names of the coordinates in handc's order.
fn coordinates(own: &Own, made: &Crate) -> Vec<String> {
    let model = interpreter(&model_file(own, made));
    model.layout().coordinates.iter().map(|c| c.name.clone()).collect()
}

/// The largest kinetic energy (J) within the first second.
fn largest_kinetic(own: &Own, made: &Crate, scenario: &str) -> Result<f64, String> {
    let settings =
        Settings { scenario: Some(scenario.into()), duration: Some(1.0), ..Settings::default() };
    let model = interpreter(&model_file(own, made));
    let mut run = Simulation::new(model, &settings).map_err(|e| e.to_string())?;
    let mut largest = 0.0_f64;
    for step in 0..run.steps {
        if step % 10 == 0 {
            let (q, total) = (run.state.q.clone(), run.energy());
            let rest = run.rest().to_vec();
            largest = largest.max(total - run.model.potential(&q, &rest));
        }
        run.step().map_err(|e| e.to_string())?;
    }
    Ok(largest)
}

/// handc's run of a compiled model.
fn ours(
    own: &Own,
    made: &Crate,
    scenario: &str,
    step: f64,
    duration: f64,
    sample: f64,
) -> Result<Run, String> {
    let csv = own.folder.join("run.csv");
    let every = ((sample / step).round() as usize).to_string();
    let (step, duration) = (step.to_string(), duration.to_string());
    let out = csv.to_string_lossy().into_owned();
    let options = [
        "--scenario",
        scenario,
        "--step",
        &step,
        "--duration",
        &duration,
        "--every",
        &every,
        "--out",
        &out,
    ];
    let said = own.run(made, &options)?;
    let table = Table::read(&csv);
    let mut model = interpreter(&model_file(own, made));
    let layout = model.layout().clone();
    let n = layout.coordinates.len();
    let energy = table.columns.iter().position(|c| c == "energy").ok_or("no energy")?;
    let q: Vec<Vec<f64>> = table.rows.iter().map(|row| row[1..=n].to_vec()).collect();
    let mut rows = vec![0.0; layout.rows.len()];
    let mut gap = None;
    for (q, row) in q.iter().zip(&table.rows).filter(|_| !layout.rows.is_empty()) {
        model.constraints(q, row[0], &[], &mut rows);
        gap = Some(rows.iter().fold(gap.unwrap_or(0.0), |m: f64, r| m.max(r.abs())));
    }
    Ok(Run {
        q,
        energy: table.rows.iter().map(|row| row[energy]).collect(),
        time: said.wall * 1e6 / said.steps,
        gap,
    })
}

/// MuJoCo's run of an exported model, coordinates in the order of `names`.
fn theirs(
    rival: &mut Rival,
    xml: &Path,
    integrator: &str,
    step: f64,
    duration: f64,
    sample: f64,
    names: &[String],
) -> Result<Run, String> {
    let steps = (duration / step).round() as usize;
    let answer = rival.ask(&json!({
        "ask": "swing", "xml": xml, "integrator": integrator, "step": step, "steps": steps,
        "every": (sample / step).round() as usize,
    }))?;
    let joints: Vec<&str> = list(&answer["joints"]).iter().filter_map(Value::as_str).collect();
    let places: Option<Vec<usize>> =
        names.iter().map(|name| joints.iter().position(|joint| joint == name)).collect();
    let places = places.ok_or("joints and coordinates differ")?;
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    let row = |row: &Value| places.iter().map(|&place| number(&row[place])).collect();
    let gap = number(&answer["gap"]);
    Ok(Run {
        q: list(&answer["q"]).iter().map(row).collect(),
        energy: list(&answer["energy"]).iter().map(number).collect(),
        time: number(&answer["seconds"]) * 1e6 / steps as f64,
        gap: (gap > 0.0).then_some(gap),
    })
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

/// The largest difference of two runs.
fn distance(one: &[Vec<f64>], other: &[Vec<f64>]) -> f64 {
    if one.len() != other.len() {
        return f64::NAN;
    }
    let pairs = one.iter().flatten().zip(other.iter().flatten());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, |m, d| if d > m { d } else { m })
}
