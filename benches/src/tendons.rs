//! What one element of a tendon costs in a step of compiled code: the same joints with and without
//! a number of them, the difference shared out; beside it what the same adds to a step of MuJoCo, where
//! MuJoCo has it.
//!
//! Each element hangs on a pendulum of its own, so that no two are computed together but as lanes
//! would do for any like blocks; the column `one of four` shows a model of four, `alone` one of one.

use crate::own::{Crate, Own};
use crate::rival::Rival;
use crate::table::Series;
use serde_json::json;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// An element.
struct Element {
    name: &'static str,
    /// Its declarations on the joint `a#`; `#` stands for the number of the joint.
    text: &'static str,
    /// Which of [`STRANDS`] stands there without it.
    without: Option<usize>,
    /// The most it should cost alone (ns).
    target: Option<f64>,
    /// What the export to MuJoCo lacks, if MuJoCo has the element at all.
    rival: Option<&'static str>,
}

/// What elements are added to, by number.
const STRANDS: [&str; 3] = [
    // A strand that becomes one with a wrapping point.
    "strand s# { path = world (-60, #0, 20) mm -> a# (0, 2, -150) mm; stiffness = 300 N/m; rest = 180 mm; }",
    // Three strands that a node joins, so weak that the pendulum swings the same with and without it.
    "strand s# { path = a# (0, 0, -150) mm -> world (150, #5, -120) mm; stiffness = 5 N/m; rest = 60 mm; }
     strand t# { path = a# (0, 0, -150) mm -> world (300, #9, -100) mm; stiffness = 5 N/m; rest = 60 mm; }
     strand u# { path = a# (0, 0, -150) mm -> world (200, #9, 50) mm; stiffness = 5 N/m; rest = 60 mm; }",
    // Stiff ones.
    "strand s# { path = a# (0, 0, -150) mm -> world (150, #5, -120) mm; stiffness = 300 N/m; rest = 100 mm; }
     strand t# { path = a# (0, 0, -150) mm -> world (300, #9, -100) mm; stiffness = 300 N/m; rest = 100 mm; }
     strand u# { path = a# (0, 0, -150) mm -> world (200, #9, 50) mm; stiffness = 300 N/m; rest = 100 mm; }",
];

const ELEMENTS: [Element; 10] = [
    Element {
        name: "strand, one segment",
        text: "strand s# { path = world (200, #0, -100) mm -> a# (0, 0, -150) mm; stiffness = 300 N/m; rest = 180 mm; }",
        without: None,
        target: None,
        rival: Some(""),
    },
    Element {
        name: "slack strand with damping",
        text: "strand s# { path = world (200, #0, -100) mm -> a# (0, 0, -150) mm; stiffness = 300 N/m; rest = 180 mm; slack = true; slack_width = 5 mm; damping = 0.1 N*s/m; }",
        without: None,
        target: None,
        rival: Some(""),
    },
    Element {
        name: "energy law with a toe",
        text: "strand s# { path = world (200, #0, -100) mm -> a# (0, 0, -150) mm; energy = if(x < x0, 0 J, 3 N/mm * (x - x0)^3 / 60 mm); rest = 180 mm; }",
        without: None,
        target: None,
        rival: None,
    },
    Element {
        name: "commanded tension of length and rate",
        text: "strand s# { path = world (200, #0, -100) mm -> a# (0, 0, -150) mm; tension = 5 N + 10 N/m * (x - 0.2 m) + 0.1 N*s/m * rate(x); }",
        without: None,
        target: None,
        rival: None,
    },
    Element {
        name: "wrapping point of a strand, cylinder",
        text: "strand s# { path = world (-60, #0, 20) mm -> via wrap cylinder(world (0, #0, 0) mm, axis = y, radius = 30 mm, side = z) -> a# (0, 0, -150) mm; stiffness = 300 N/m; rest = 180 mm; }",
        without: Some(0),
        target: Some(60.0),
        rival: Some(""),
    },
    Element {
        name: "wrapping point of a strand, sphere",
        text: "strand s# { path = world (-60, #0, 20) mm -> via wrap sphere(world (0, #0, 0) mm, radius = 30 mm, side = z) -> a# (0, 2, -150) mm; stiffness = 300 N/m; rest = 180 mm; }",
        without: Some(0),
        target: Some(60.0),
        rival: Some(""),
    },
    Element {
        name: "massless node of three strands",
        text: "node n# at (150, #5, -120) mm in world { }
         strand s# { path = a# (0, 0, -150) mm -> n#; stiffness = 5 N/m; rest = 60 mm; }
         strand t# { path = n# -> world (300, #9, -100) mm; stiffness = 5 N/m; rest = 60 mm; }
         strand u# { path = n# -> world (200, #9, 50) mm; stiffness = 5 N/m; rest = 60 mm; }",
        without: Some(1),
        target: Some(100.0),
        rival: None,
    },
    Element {
        name: "one of stiff strands that push too: it snaps",
        text: "node n# at (150, #5, -120) mm in world { }
         strand s# { path = a# (0, 0, -150) mm -> n#; stiffness = 300 N/m; rest = 100 mm; }
         strand t# { path = n# -> world (300, #9, -100) mm; stiffness = 300 N/m; rest = 100 mm; }
         strand u# { path = n# -> world (200, #9, 50) mm; stiffness = 300 N/m; rest = 100 mm; }",
        without: Some(2),
        target: None,
        rival: None,
    },
    Element {
        name: "friction over two points",
        text: "strand s# { path = world (-200, #0, -100) mm -> world (-100, #0, -50) mm -> a# (0, 0, -100) mm -> a# (10, 0, -150) mm; stiffness = 300 N/m; rest = 180 mm; friction = 0.2; friction_speed = 0.1 m/s; }",
        without: None,
        target: None,
        rival: None,
    },
    Element {
        name: "muscle with an elastic tendon",
        text: MUSCLE,
        without: None,
        target: Some(80.0),
        rival: Some(MUSCLE_IN_MJCF),
    },
];

const MUSCLE: &str = "strand s# { path = world (200, #0, -100) mm -> a# (0, 0, -150) mm; muscle = thelen2003; max_force = 20 N; optimal_fibre = 80 mm; tendon_slack = 120 mm; pennation = 5 deg; excitation = 0.2 + 0.1 * sin(9 rad/s * t); }";

/// MuJoCo's muscle, whose tendon is rigid.
const MUSCLE_IN_MJCF: &str =
    "<actuator><muscle tendon=\"s1\" force=\"20\" lengthrange=\"0.1 0.35\"/></actuator>";

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
    out.push_str("    scenario swing { step = 1 ms; duration = 1000 s; }\n}\n");
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

/// Rounds at least: what is told is the difference of two short times.
const ROUNDS: usize = 12;
/// Steps of MuJoCo in a round: it takes longer.
const RIVAL_STEPS: usize = 50_000;

/// A model exported to MuJoCo, with what the export lacks. Muscles are a third excited.
fn exported(own: &Own, name: &str, lacking: &str) -> Result<PathBuf, String> {
    let model = own.folder.join("models").join(format!("{name}.hdl"));
    let path = own.export(&model, "swing")?;
    let fail = |e: std::io::Error| format!("{}: {e}", path.display());
    let mut text = std::fs::read_to_string(&path).map_err(fail)?;
    if !lacking.is_empty() {
        text = text.replace("</mujoco>", &format!("{lacking}</mujoco>"));
        text = text.replace("<key ", "<key act=\"0.3\" ctrl=\"0.3\" ");
    }
    std::fs::write(&path, text).map_err(fail)?;
    Ok(path)
}

/// The models of one that MuJoCo can run, by their number among [`texts`].
fn rivals(own: &Own) -> Result<Vec<(usize, PathBuf)>, String> {
    let elements = ELEMENTS.iter().enumerate();
    let elements = elements.filter_map(|(k, e)| Some((1 + STRANDS.len() + k, e.rival?)));
    // The bare pendulum and the strand that comes to wrap.
    let all = [(0, ""), (1, "")].into_iter().chain(elements);
    all.map(|(k, lacking)| Ok((k, exported(own, &format!("element{k}of1"), lacking)?))).collect()
}

/// Nanoseconds that one step takes MuJoCo.
fn asked(rival: &mut Rival, xml: &Path) -> Result<f64, String> {
    let answer = rival.ask(&json!({
        "ask": "speed",
        "xml": xml,
        "integrator": "Euler",
        "step": 1e-3,
        "steps": RIVAL_STEPS,
        "instances": 1,
        "threads": 1,
    }))?;
    let seconds = answer["seconds"].as_f64().ok_or("no time")?;
    Ok(seconds * 1e9 / RIVAL_STEPS as f64)
}

/// The table: nanoseconds a step for one element, alone and as one of four, and beside MuJoCo.
pub(crate) fn report(
    own: &Own,
    rival: &mut Result<Rival, String>,
    rounds: usize,
) -> Result<String, String> {
    let mut crates = Vec::new();
    for count in [1, TOGETHER] {
        for (k, text) in texts().enumerate() {
            let name = format!("element{k}of{count}");
            crates.push(made(own, &name, &model(&name, count, text))?);
        }
    }
    let rivals = rivals(own)?;
    let mut times = vec![Series::default(); crates.len()];
    let mut theirs = vec![Series::default(); crates.len() / 2];
    for _ in 0..rounds.max(ROUNDS) {
        for (series, made) in times.iter_mut().zip(&crates) {
            let run = own.run(made, &[])?;
            series.0.push(run.wall * 1e9 / run.steps);
        }
        if let Ok(rival) = rival {
            for (k, xml) in &rivals {
                theirs[*k].0.push(asked(rival, xml)?);
            }
        }
    }
    let (alone, together) = times.split_at(crates.len() / 2);
    let mut out = String::from(
        "\nNanoseconds a step that one element adds to a pendulum: in a model of one, and each of four. \
         Wrapping points and\nnodes are what they add to the same strands without them. MuJoCo: what it adds \
         there, by Euler's method, to some\n100 ns, since its steps vary by as much; its muscle has a rigid tendon.\n\n\
         | element | alone | one of four | at most | MuJoCo | alone beside it |\n|---|---|---|---|---|---|\n",
    );
    for (k, element) in ELEMENTS.iter().enumerate() {
        let with = 1 + STRANDS.len() + k;
        let without = element.without.map_or(0, |strand| 1 + strand);
        let adds = |times: &[Series]| times[with].least() - times[without].least();
        let (single, shared) = (adds(alone), adds(together) / TOGETHER as f64);
        let target = match element.target {
            Some(target) if single <= target => format!("{target:.0}: met"),
            Some(target) => format!("{target:.0}: not met"),
            None => String::new(),
        };
        let beside = match theirs[with].0.is_empty() {
            true => " | ".to_string(),
            false => format!("{:.0} | 1/{:.0}", adds(&theirs), adds(&theirs) / single),
        };
        let name = element.name;
        let _ = writeln!(out, "| {name} | {single:.0} | {shared:.0} | {target} | {beside} |");
    }
    let _ = write!(out, "\nA bare pendulum takes {:.0} ns a step", alone[0].least());
    if !theirs[0].0.is_empty() {
        let _ = write!(out, ", in MuJoCo {:.0}", theirs[0].least());
    }
    out.push_str(".\n");
    Ok(out)
}
