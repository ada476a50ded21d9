//! Questions to a model and its answers, the same for the interpreter and for compiled code.
//!
//! The battery, a program that links many generated crates, includes this file too: both sides go
//! through the same questions and their answers are compared number by number. Numbers travel as
//! the hexadecimal digits of their bits, so that nothing is lost on the way.

use handc_core::model::{Instant, Midpoint, Model};
use handc_core::passage::CLEARANCES;
use handc_core::simulation::{Settings, Simulation};
use handc_core::step::State;
use handc_core::trajectory::columns;

/// A state from which one step is taken.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Start {
    /// Steps taken before.
    pub step: usize,
    /// Coordinates, momenta, rates and multipliers.
    pub numbers: [Vec<f64>; 4],
}

/// A point at which every function of the model is evaluated.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Point {
    /// Time (s).
    pub t: f64,
    /// Coordinates, rates, natural lengths, inputs and multipliers.
    pub numbers: [Vec<f64>; 5],
}

/// A run of one model and what is asked about it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Request {
    /// Name of the model.
    pub model: String,
    /// What the run is asked for.
    pub settings: Settings,
    /// States to step from.
    pub starts: Vec<Start>,
    /// Points to evaluate at.
    pub points: Vec<Point>,
}

/// One answer: what it is, and its numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// What it is.
    pub what: String,
    /// Numbers.
    pub values: Vec<f64>,
}

/// Answers a request.
pub fn answer<M: Model + Clone>(model: M, request: &Request) -> Vec<Answer> {
    let mut out = Vec::new();
    let mut say = |what: String, values: &[f64]| out.push(Answer { what, values: values.to_vec() });
    let mut simulation = match Simulation::new(model, &request.settings) {
        Ok(simulation) => simulation,
        Err(error) => {
            say(format!("no start: {error}").replace(['\n', '\t'], " "), &[]);
            return out;
        }
    };
    say(format!("{:?}", simulation.layout()), &[]);
    say(columns(&simulation).join(","), &[]);
    say("params".into(), simulation.model.params());
    say("steps".into(), &[simulation.steps as f64, simulation.h]);
    say("start q".into(), &simulation.state.q);
    say("start p".into(), &simulation.state.p);
    say("start v".into(), &simulation.state.v);
    for (k, start) in request.starts.iter().enumerate() {
        let [q, p, v, lambda] = start.numbers.clone();
        let mut state = State::new(q, p, v, lambda.len());
        state.step = start.step;
        state.t = start.step as f64 * simulation.h;
        state.lambda = lambda;
        simulation.state = state;
        let before = simulation.state.clone();
        if let Err(error) = simulation.step() {
            say(format!("step {k}: {error}").replace(['\n', '\t'], " "), &[]);
            continue;
        }
        let (inputs, rest) = (simulation.inputs().to_vec(), simulation.rest().to_vec());
        say(format!("step {k} inputs"), &inputs);
        say(format!("step {k} rest"), &rest);
        say(format!("step {k} q"), &simulation.state.q);
        say(format!("step {k} p"), &simulation.state.p);
        say(format!("step {k} lambda"), &simulation.state.lambda);
        say(format!("step {k} energy"), &[simulation.energy()]);
        let rounding = rounding(&mut simulation, &before, &inputs, &rest);
        say(format!("step {k} rounding"), &rounding);
    }
    let scenario = simulation.scenario();
    for (k, point) in request.points.iter().enumerate() {
        functions(&mut simulation.model, scenario, simulation.h, point, &mut |what, values| {
            say(format!("point {k} {what}"), values);
        });
    }
    out
}

/// What one unit of rounding in the coordinates does to the momenta, to the multipliers and to the
/// coordinates of a step. In the momenta: Σ|K||q| of the worst row of the step's matrix. Constraints
/// that say nearly the same stretch the rounding of the coordinates: by Σ|G||q| of a row of their
/// Jacobian over the part of it that no other row has. Over the shortest such part momenta become
/// multipliers.
fn rounding<M: Model>(
    simulation: &mut Simulation<M>,
    before: &State,
    inputs: &[f64],
    rest: &[f64],
) -> [f64; 3] {
    let (h, after) = (simulation.h, simulation.state.clone());
    let layout = simulation.layout().clone();
    let n = after.q.len();
    let middle: Vec<f64> = (0..n).map(|i| 0.5 * (before.q[i] + after.q[i])).collect();
    let rate: Vec<f64> = (0..n).map(|i| (after.q[i] - before.q[i]) / h).collect();
    let at = Midpoint { q: &middle, v: &rate, t: 0.5 * (before.t + after.t), rest, inputs };
    let (mut p, mut f) = (vec![0.0; n], vec![0.0; n]);
    let mut matrix = vec![0.0; layout.matrix_size()];
    simulation.model.evaluate_with_matrix(&at, h, &mut p, &mut f, &mut matrix);
    let mut jacobian = vec![0.0; layout.constraint_size()];
    simulation.model.constraint_jacobian(&after.q, after.t, &mut jacobian);
    let (mut impulse, mut stretch, mut shortest) = (0.0_f64, 1.0_f64, f64::INFINITY);
    for block in &layout.blocks {
        let width = block.coordinates.len();
        let size = |row: &[f64]| -> f64 {
            let pull = |(entry, &c): (&f64, &usize)| entry.abs() * after.q[c].abs().max(1.0);
            row.iter().zip(&block.coordinates).map(pull).sum()
        };
        for row in matrix[block.matrix_offset..].chunks(width.max(1)).take(width) {
            impulse = impulse.max(size(row));
        }
        let rows = jacobian[block.constraint_offset..].chunks(width.max(1)).take(block.rows.len());
        let rows: Vec<&[f64]> = rows.collect();
        for last in 0..rows.len() {
            // A row that others imply shares its multiplier with them, by its length.
            let whole = rows[last].iter().map(|x| x * x).sum::<f64>().sqrt();
            for length in [whole, beyond_others(&rows, last)].into_iter().filter(|&l| l > 1e-9) {
                shortest = shortest.min(length);
                stretch = stretch.max(size(rows[last]) / length);
            }
        }
    }
    // Where a scenario asks for less, a step may end as far off as it allows.
    let scenario = simulation.scenario().map(|scenario| simulation.model.scenario(scenario));
    let tolerance = scenario.and_then(|values| values.tolerance).unwrap_or(0.0);
    let stretched = stretch * f64::EPSILON.max(tolerance / 32.0);
    [impulse * stretched, impulse * stretched / shortest, stretched]
}

/// Length of the part of a row that lies outside the span of the others (Gram and Schmidt).
fn beyond_others(rows: &[&[f64]], last: usize) -> f64 {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let order = (0..rows.len()).filter(|&i| i != last).chain([last]);
    let mut length = 0.0;
    for index in order {
        let mut rest = rows[index].to_vec();
        for _ in 0..2 {
            for known in &basis {
                let along: f64 = known.iter().zip(&rest).map(|(a, b)| a * b).sum();
                rest.iter_mut().zip(known).for_each(|(x, k)| *x -= along * k);
            }
        }
        length = rest.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length > 1e-9 {
            basis.push(rest.iter().map(|x| x / length).collect());
        }
    }
    length
}

/// Every function of a model at a point.
fn functions<M: Model>(
    model: &mut M,
    scenario: Option<usize>,
    h: f64,
    point: &Point,
    say: &mut dyn FnMut(&str, &[f64]),
) {
    let layout = model.layout().clone();
    let (n, s, m) = (layout.coordinates.len(), layout.strands.len(), layout.rows.len());
    let [q, v, rest, inputs, lambda] = &point.numbers;
    let t = point.t;
    let at = Midpoint { q, v, t, rest, inputs };
    let (mut momentum, mut force) = (vec![0.0; n], vec![0.0; n]);
    model.evaluate(&at, &mut momentum, &mut force);
    // Those of kinematic coordinates are not read.
    let read = |values: &[f64]| -> Vec<f64> {
        let numbers = layout.coordinates.iter().zip(values);
        numbers.map(|(c, x)| if c.kinematic { 0.0 } else { *x }).collect()
    };
    say("momentum", &read(&momentum));
    say("force", &read(&force));
    let mut matrix = vec![0.0; layout.matrix_size()];
    model.evaluate_with_matrix(&at, h, &mut momentum, &mut force, &mut matrix);
    say("momentum beside the matrix", &read(&momentum));
    say("force beside the matrix", &read(&force));
    say("matrix", &matrix);
    let mut mass = vec![0.0; layout.matrix_size()];
    model.mass_matrix(q, &mut mass);
    say("mass", &mass);
    let mut gap = vec![0.0; m];
    model.constraints(q, t, rest, &mut gap);
    say("constraints", &gap);
    let mut jacobian = vec![0.0; layout.constraint_size()];
    model.constraint_jacobian(q, t, &mut jacobian);
    say("jacobian", &jacobian);
    let mut lengths = vec![0.0; s];
    model.strand_lengths(q, &mut lengths);
    say("lengths", &lengths);
    let mut clearances = vec![0.0; CLEARANCES * layout.wraps.len()];
    model.clearances(q, &mut clearances);
    say("clearances", &clearances);
    say("potential", &[model.potential(q, rest)]);
    let mut given = vec![0.0; inputs.len()];
    model.inputs(t, &mut given);
    say("inputs", &given);
    let mut natural = vec![0.0; s];
    model.rests(t, inputs, &mut natural);
    say("rests", &natural);
    let mut driven = vec![0.0; n];
    model.drives(t, &mut driven);
    say("drives", &driven);
    let Some(scenario) = scenario else { return };
    model.scenario_inputs(scenario, t, &mut given);
    say("scenario inputs", &given);
    model.scenario_drives(scenario, t, &mut driven);
    say("scenario drives", &driven);
    model.scenario_rests(scenario, t, &mut natural);
    say("scenario rests", &natural);
    let mut records = vec![0.0; layout.scenarios[scenario].records.len()];
    let at = Instant { t, q, v, inputs, lambda, rest, h };
    model.scenario_records(scenario, &at, &mut records);
    for (name, value) in layout.scenarios[scenario].records.iter().zip(&records) {
        say(&format!("record {name}"), &[*value]);
    }
}

/// Requests as text, one line for each part.
pub fn write_request(request: &Request, text: &mut String) {
    let settings = &request.settings;
    let scenario = settings.scenario.as_deref().unwrap_or("-");
    let times = [settings.step, settings.duration].map(|x| x.unwrap_or(f64::NAN));
    text.push_str(&format!("ask\t{}\t{scenario}\t{}\n", request.model, bits(&times)));
    for (name, value) in &settings.set {
        text.push_str(&format!("set\t{name}\t{}\n", bits(&[*value])));
    }
    for start in &request.starts {
        let parts: Vec<String> = start.numbers.iter().map(|part| bits(part)).collect();
        text.push_str(&format!("start\t{}\t{}\n", start.step, parts.join("\t")));
    }
    for point in &request.points {
        let parts: Vec<String> = point.numbers.iter().map(|part| bits(part)).collect();
        text.push_str(&format!("point\t{}\t{}\n", bits(&[point.t]), parts.join("\t")));
    }
}

/// Reads what [`write_request`] wrote; such text is never wrong.
pub fn read_requests(text: &str) -> Vec<Request> {
    let mut requests: Vec<Request> = Vec::new();
    for line in text.lines() {
        let parts: Vec<&str> = line.split('\t').collect();
        let Some(last) = requests.last_mut().filter(|_| parts[0] != "ask") else {
            let times = numbers(parts[3]);
            let time = |i: usize| Some(times[i]).filter(|x| !x.is_nan());
            let scenario = Some(parts[2].to_string()).filter(|name| name != "-");
            let settings =
                Settings { scenario, step: time(0), duration: time(1), ..Settings::default() };
            let model = parts[1].to_string();
            requests.push(Request { model, settings, ..Request::default() });
            continue;
        };
        match parts[0] {
            "set" => last.settings.set.push((parts[1].to_string(), numbers(parts[2])[0])),
            "start" => last.starts.push(Start {
                step: parts[1].parse().expect("a number"),
                numbers: std::array::from_fn(|i| numbers(parts[2 + i])),
            }),
            _ => last.points.push(Point {
                t: numbers(parts[1])[0],
                numbers: std::array::from_fn(|i| numbers(parts[2 + i])),
            }),
        }
    }
    requests
}

/// An answer as one line.
pub fn write_answer(answer: &Answer) -> String {
    format!("{}\t{}\n", answer.what, bits(&answer.values))
}

/// Reads what [`write_answer`] wrote.
pub fn read_answer(line: &str) -> Answer {
    let (what, values) = line.split_once('\t').expect("an answer");
    Answer { what: what.to_string(), values: numbers(values) }
}

fn bits(values: &[f64]) -> String {
    let words: Vec<String> = values.iter().map(|x| format!("{:x}", x.to_bits())).collect();
    words.join(" ")
}

fn numbers(text: &str) -> Vec<f64> {
    let number = |word| f64::from_bits(u64::from_str_radix(word, 16).expect("bits"));
    text.split_whitespace().map(number).collect()
}
