//! What one element of a tendon costs in a step of compiled code: the same joints with and without
//! a number of them, the difference shared out.
//!
//! Each element hangs on a pendulum of its own, so that no two are computed together but as lanes
//! would do for any like blocks; the row `lanes` shows a model of four, the row `alone` one of one.

use crate::own::{Crate, Own};
use crate::table::Series;
use std::fmt::Write;
use std::path::PathBuf;
use std::time::Duration;

/// An element: its name, its declarations on the joint `a{i}`, what stands there without it, and the
/// most it should cost (ns).
struct Element {
    name: &'static str,
    text: &'static str,
    without: Option<usize>,
    target: Option<f64>,
}

/// What elements are added to, by number.
const STRANDS: [&str; 2] = [
    // A strand that becomes one with a wrapping point.
    "strand s# { path = world (-60, #0, 20) mm -> a# (0, 2, -150) mm; stiffness = 300 N/m; rest = 180 mm; }",
    // Three strands that a node joins.
    "strand s# { path = a# (0, 0, -150) mm -> world (150, #5, -120) mm; stiffness = 300 N/m; rest = 100 mm; }
     strand t# { path = a# (0, 0, -150) mm -> world (300, #9, -100) mm; stiffness = 300 N/m; rest = 100 mm; }
     strand u# { path = a# (0, 0, -150) mm -> world (200, #9, 50) mm; stiffness = 300 N/m; rest = 100 mm; }",
];

/// `#` stands for the number of the joint.
const ELEMENTS: [Element; 9] = [
    Element {
        name: "strand, one segment",
        text: "strand s# { path = world (200, #0, -100) mm -> a# (0, 0, -150) mm; stiffness = 300 N/m; rest = 180 mm; }",
        without: None,
        target: None,
    },
    Element {
        name: "slack strand with damping",
        text: "strand s# { path = world (200, #0, -100) mm -> a# (0, 0, -150) mm; stiffness = 300 N/m; rest = 180 mm; slack = true; slack_width = 5 mm; damping = 0.1 N*s/m; }",
        without: None,
        target: None,
    },
    Element {
        name: "energy law with a toe",
        text: "strand s# { path = world (200, #0, -100) mm -> a# (0, 0, -150) mm; energy = if(x < x0, 0 J, 3 N/mm * (x - x0)^3 / 60 mm); rest = 180 mm; }",
        without: None,
        target: None,
    },
    Element {
        name: "commanded tension of length and rate",
        text: "strand s# { path = world (200, #0, -100) mm -> a# (0, 0, -150) mm; tension = 5 N + 10 N/m * (x - 0.2 m) + 0.1 N*s/m * rate(x); }",
        without: None,
        target: None,
    },
    Element {
        name: "wrapping point of a strand, cylinder",
        text: "strand s# { path = world (-60, #0, 20) mm -> via wrap cylinder(world (0, #0, 0) mm, axis = y, radius = 30 mm, side = z) -> a# (0, 0, -150) mm; stiffness = 300 N/m; rest = 180 mm; }",
        without: Some(0),
        target: Some(60.0),
    },
    Element {
        name: "wrapping point of a strand, sphere",
        text: "strand s# { path = world (-60, #0, 20) mm -> via wrap sphere(world (0, #0, 0) mm, radius = 30 mm, side = z) -> a# (0, 2, -150) mm; stiffness = 300 N/m; rest = 180 mm; }",
        without: Some(0),
        target: Some(60.0),
    },
    Element {
        name: "massless node of three strands",
        text: "node n# at (150, #5, -120) mm in world { }
         strand s# { path = a# (0, 0, -150) mm -> n#; stiffness = 300 N/m; rest = 100 mm; }
         strand t# { path = n# -> world (300, #9, -100) mm; stiffness = 300 N/m; rest = 100 mm; }
         strand u# { path = n# -> world (200, #9, 50) mm; stiffness = 300 N/m; rest = 100 mm; }",
        without: Some(1),
        target: Some(100.0),
    },
    Element {
        name: "friction over two points",
        text: "strand s# { path = world (-200, #0, -100) mm -> world (-100, #0, -50) mm -> a# (0, 0, -100) mm -> a# (10, 0, -150) mm; stiffness = 300 N/m; rest = 180 mm; friction = 0.2; friction_speed = 0.1 m/s; }",
        without: None,
        target: None,
    },
    Element {
        name: "muscle with an elastic tendon",
        text: MUSCLE,
        without: None,
        target: Some(80.0),
    },
];

const MUSCLE: &str = "strand s# { path = world (200, #0, -100) mm -> a# (0, 0, -150) mm; muscle = thelen2003; max_force = 20 N; optimal_fibre = 80 mm; tendon_slack = 120 mm; pennation = 5 deg; excitation = 0.2 + 0.1 * sin(9 rad/s * t); }";

/// Elements in one model.
const TOGETHER: usize = 4;

/// A model of pendulums, each with the element if `text` holds one.
fn model(name: &str, count: usize, text: &str) -> String {
    let mut out = format!("model {name} {{\n    gravity = (0, 0, -9.81) m/s^2;\n");
    for i in 0..count {
        let number = (i + 1).to_string();
        let _ = writeln!(
            out,
            "    joint a{number}: revolute(y) in world at (0, {number}0, 0) mm {{ start = 20 deg; }}\n    \
             mass m{number} in a{number} {{ mass = 0.2 kg; at = (0, 0, -150) mm; inertia = (1, 1, 1) g*m^2; }}\n    {}",
            text.replace('#', &number)
        );
    }
    out.push_str("    scenario swing { step = 1 ms; duration = 200 s; }\n}\n");
    out
}

fn made(own: &Own, name: &str, text: &str) -> Result<Crate, String> {
    let path: PathBuf = own.folder.join("models").join(format!("{name}.hdl"));
    std::fs::write(&path, text).map_err(|e| format!("{}: {e}", path.display()))?;
    let limit = Duration::from_secs(600);
    let made = own.compile(&path, limit)?;
    own.make(&made, false, limit)?;
    Ok(made)
}

/// What stands on the joints of each model: nothing, what elements are added to, the elements.
fn texts() -> impl Iterator<Item = &'static str> {
    [""].into_iter().chain(STRANDS).chain(ELEMENTS.iter().map(|element| element.text))
}

/// The table: nanoseconds a step for one element, alone and as one of four.
pub(crate) fn report(own: &Own, rounds: usize) -> Result<String, String> {
    let mut crates = Vec::new();
    for count in [1, TOGETHER] {
        for (k, text) in texts().enumerate() {
            let name = format!("element{k}of{count}");
            crates.push(made(own, &name, &model(&name, count, text))?);
        }
    }
    let mut times = vec![Series::default(); crates.len()];
    for _ in 0..rounds.max(3) {
        for (series, made) in times.iter_mut().zip(&crates) {
            let run = own.run(made, &[])?;
            series.0.push(run.wall * 1e9 / run.steps);
        }
    }
    let (alone, together) = times.split_at(crates.len() / 2);
    let mut out = String::from(
        "\nNanoseconds a step that one element adds to a pendulum: in a model of one, and each of four. \
         Wrapping points and\nnodes are what they add to the same strands without them.\n\n\
         | element | alone | one of four | at most |\n|---|---|---|---|\n",
    );
    for (k, element) in ELEMENTS.iter().enumerate() {
        let with = 1 + STRANDS.len() + k;
        let without = element.without.map_or(0, |strand| 1 + strand);
        let single = alone[with].least() - alone[without].least();
        let shared = (together[with].least() - together[without].least()) / TOGETHER as f64;
        let target = match element.target {
            Some(target) if single <= target => format!("{target:.0}: met"),
            Some(target) => format!("{target:.0}: not met"),
            None => String::new(),
        };
        let _ = writeln!(out, "| {} | {single:.0} | {shared:.0} | {target} |", element.name);
    }
    let _ = writeln!(out, "\nA bare pendulum takes {:.0} ns a step.", alone[0].least());
    Ok(out)
}
