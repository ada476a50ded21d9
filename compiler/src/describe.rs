//! What `handc info` prints: the tree, coordinates, masses, strands, constraints and degrees of
//! freedom of a model.

use handc_core::model::Model as _;
use handc_core::simulation::{Settings, Simulation};
use handc_dsl::hir;
use handc_runtime::analysis::rank::rank;
use handc_runtime::interpreter::Interpreter;
use handc_runtime::mechanism::{Law, Mechanism, Motion, Strand};
use handc_runtime::resolved::Resolved;
use std::fmt::Write;
use std::sync::Arc;

/// The model as text.
pub fn describe(model: &hir::Model, mechanism: Mechanism) -> String {
    let mechanism = Arc::new(mechanism);
    let interpreter = Interpreter::new(Arc::clone(&mechanism));
    let numbers = Resolved::new(&mechanism, interpreter.params());
    let mut text = String::new();
    // Writing to a string cannot fail, so results are dropped throughout.
    let _ = writeln!(text, "model {}", mechanism.name);
    for line in mechanism.doc.lines() {
        let _ = writeln!(text, "{}", format!("  {line}").trim_end());
    }
    tree(model, &mechanism, &numbers, &mut text);
    parameters(&mechanism, &mut text);
    masses(&mechanism, &numbers, &mut text);
    strands(&mechanism, &numbers, interpreter.clone(), &mut text);
    freedom(&mechanism, interpreter, &mut text);
    scenarios(&mechanism, &numbers, &mut text);
    text
}

fn tree(model: &hir::Model, mechanism: &Mechanism, numbers: &Resolved<f64>, text: &mut String) {
    let _ = writeln!(text, "\nframes and coordinates");
    let mut children = vec![Vec::new(); model.frames.len()];
    for (index, frame) in model.frames.iter().enumerate() {
        if let Some(parent) = frame.parent {
            children[parent.index()].push(index);
        }
    }
    let mut open = vec![(0, 0)];
    while let Some((index, depth)) = open.pop() {
        let frame = &model.frames[index];
        let _ = write!(text, "{:indent$}{}", "", frame.name.text, indent = 2 + 2 * depth);
        if let Some(joint) = frame.joint {
            let joint = &model.joints[joint.index()];
            let kind = format!("{:?}", joint.kind).to_lowercase();
            let coordinates: Vec<String> = joint
                .coordinates
                .iter()
                .map(|id| {
                    let c = &mechanism.coordinates[id.index()];
                    let unit = c.unit();
                    let role = if c.drive.is_some() { ", driven" } else { "" };
                    format!("{} from {:.4} {unit}{role}", c.name, numbers.number(c.start))
                })
                .collect();
            let _ = write!(text, "  [{kind}: {}]", coordinates.join("; "));
        }
        let bodies: Vec<&str> = model
            .masses
            .iter()
            .filter(|mass| mass.frame.index() == index)
            .map(|mass| mass.name.text.as_str())
            .collect();
        if !bodies.is_empty() {
            let _ = write!(text, "  carries {}", bodies.join(", "));
        }
        let _ = writeln!(text);
        open.extend(children[index].iter().rev().map(|&child| (child, depth + 1)));
    }
    let rotations =
        mechanism.links.iter().filter(|l| !matches!(l.motion, Motion::Prismatic { .. }));
    let _ = writeln!(
        text,
        "  {} coordinates, {} of them rotations{}",
        mechanism.coordinates.len(),
        rotations.count(),
        match mechanism.coordinates.len() - mechanism.links.len() {
            0 => String::new(),
            internal => format!(", {internal} of muscles"),
        }
    );
}

fn parameters(mechanism: &Mechanism, text: &mut String) {
    if !mechanism.params.is_empty() {
        let _ = writeln!(text, "\nparameters");
    }
    for param in &mechanism.params {
        let _ = writeln!(text, "  {} = {} {}", param.name, param.default, param.unit);
    }
    if !mechanism.inputs.is_empty() {
        let names: Vec<&str> = mechanism.inputs.iter().map(|i| i.name.as_str()).collect();
        let _ = writeln!(text, "\ninputs\n  {}", names.join(", "));
    }
}

fn masses(mechanism: &Mechanism, numbers: &Resolved<f64>, text: &mut String) {
    if mechanism.bodies.is_empty() {
        return;
    }
    let _ = writeln!(text, "\nmasses");
    let (mut total, mut moving) = (0.0, 0.0);
    for body in &mechanism.bodies {
        let mass = numbers.number(body.mass);
        total += mass;
        if body.link.is_some() {
            moving += mass;
        }
        let at = if body.link.is_some() { "" } else { "  (fixed to the world)" };
        let _ = writeln!(text, "  {:<24} {:>12.4} g{at}", body.name, mass * 1e3);
    }
    let _ = writeln!(
        text,
        "  {:<24} {:>12.4} g, {:.4} g of it moving",
        "total",
        total * 1e3,
        moving * 1e3
    );
}

fn strands(
    mechanism: &Mechanism,
    numbers: &Resolved<f64>,
    mut interpreter: Interpreter,
    text: &mut String,
) {
    if mechanism.strands.is_empty() {
        return;
    }
    let n = mechanism.coordinates.len();
    let (mut q, mut v) = (vec![0.0; n], vec![0.0; n]);
    interpreter.start(&mut q, &mut v);
    let mut lengths = vec![0.0; mechanism.strands.len()];
    interpreter.strand_lengths(&q, &mut lengths);
    let mut arms = vec![0.0; mechanism.strands.len() * n];
    interpreter.moment_arms(&q, &mut arms);
    let _ = writeln!(text, "\nstrands: law, length at the start, moment arms there");
    for (i, strand) in mechanism.strands.iter().enumerate() {
        let arms: Vec<String> = (0..n)
            .filter(|&c| arms[i * n + c] != 0.0)
            .map(|c| {
                let (arm, unit) = if mechanism.coordinates[c].is_length {
                    (arms[i * n + c], "")
                } else {
                    (arms[i * n + c] * 1e3, " mm")
                };
                format!("{} {arm:+.2}{unit}", mechanism.coordinates[c].name)
            })
            .collect();
        let _ = writeln!(
            text,
            "  {:<24} {:>12} {:>9.2} mm   {}",
            strand.name,
            law(strand, numbers.strands[i].stiffness),
            lengths[i] * 1e3,
            arms.join(", ")
        );
    }
}

/// The law of a strand in a word; its stiffness where that is all of it.
fn law(strand: &Strand, stiffness: Option<f64>) -> String {
    match (&strand.law, stiffness) {
        (Law::Linear { .. }, Some(stiffness)) => format!("{stiffness:.1} N/m"),
        (Law::Linear { .. } | Law::Energy(_), _) => "energy".to_string(),
        (Law::Tension(_), _) => "tension".to_string(),
        (Law::Prescribed, _) => "length".to_string(),
        (Law::Muscle(_), _) => "muscle".to_string(),
    }
}

fn freedom(mechanism: &Mechanism, interpreter: Interpreter, text: &mut String) {
    let n = mechanism.coordinates.len();
    let dynamic = mechanism.coordinates.iter().filter(|c| c.drive.is_none()).count();
    let layout = Arc::clone(interpreter.layout());
    let m = layout.rows.len();
    let _ = writeln!(text, "\ndegrees of freedom");
    if m == 0 {
        let _ = writeln!(text, "  {dynamic}: every dynamic coordinate is free");
        return;
    }
    let names: Vec<&str> = layout.rows.iter().map(|row| row.name.as_str()).collect();
    let _ = writeln!(text, "  constraint rows: {}", names.join(", "));
    let settings = Settings {
        scenario: mechanism.scenarios.first().map(|s| s.name.clone()),
        step: Some(1e-3),
        duration: Some(1e-3),
        ..Settings::default()
    };
    match Simulation::new(interpreter, &settings) {
        Ok(mut simulation) => {
            let mut packed = vec![0.0; layout.constraint_size()];
            let q = simulation.state.q.clone();
            simulation.model.constraint_jacobian(&q, 0.0, &mut packed);
            let mut dense = vec![0.0; m * n];
            for block in &layout.blocks {
                let width = block.coordinates.len();
                for (i, row) in block.rows.iter().enumerate() {
                    for (k, column) in block.coordinates.iter().enumerate() {
                        dense[row * n + column] = packed[block.constraint_offset + i * width + k];
                    }
                }
            }
            let rank = rank(&dense, m, n).rank;
            let _ = writeln!(
                text,
                "  {}: {dynamic} dynamic coordinates less {rank} independent rows of {m}",
                dynamic - rank.min(dynamic)
            );
        }
        Err(error) => {
            let _ = writeln!(text, "  not known: {error}");
        }
    }
}

fn scenarios(mechanism: &Mechanism, numbers: &Resolved<f64>, text: &mut String) {
    if mechanism.scenarios.is_empty() {
        return;
    }
    let _ = writeln!(text, "\nscenarios");
    for scenario in &mechanism.scenarios {
        let seconds = |number: Option<_>| {
            number.map_or_else(|| "not given".to_string(), |n| format!("{} s", numbers.number(n)))
        };
        let _ = writeln!(
            text,
            "  {}: step {}, duration {}, {}",
            scenario.name,
            seconds(scenario.step),
            seconds(scenario.duration),
            crate::command::count(scenario.records.len(), "record")
        );
    }
}
