//! The models that are measured: the fixtures with scenarios of their own added, and families of
//! growing size.

use handc_tests::load::repository;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Links of the chains.
pub(crate) const CHAINS: [usize; 5] = [8, 16, 32, 64, 128];

/// Fingers of the growing hands.
pub(crate) const FINGERS: [usize; 7] = [1, 2, 4, 8, 16, 32, 64];

/// How much longer the finger's scenario `long` takes than `track`.
const STRETCH: f64 = 100.0;

/// Writes the hand, the finger and the grasp into a folder.
pub(crate) fn write_fixtures(folder: &Path) -> Result<(), String> {
    let hand = read("tests/fixtures/hand.hdl")?;
    write(folder, "hand.hdl", &with(&hand, &swing(&hand_rates(&hand))))?;
    let finger = read("tests/fixtures/finger.hdl")?;
    let rates = [("q_mcp", -2.0), ("q_pip", 3.0), ("q_dip", -4.0)];
    let rates = rates.map(|(name, rate)| (name.to_string(), rate));
    let long = stretched(&finger)?;
    write(folder, "finger.hdl", &with(&with(&finger, &long), &swing(&rates)))?;
    write(folder, "grasp.hdl", &read("models/grasp.hdl")?)?;
    write(folder, "digit.hdl", &read("models/digit.hdl")?)?;
    Ok(())
}

fn read(path: &str) -> Result<String, String> {
    let path = repository(path);
    std::fs::read_to_string(&path).map_err(|e| format!("cannot read `{}`: {e}", path.display()))
}

pub(crate) fn write(folder: &Path, name: &str, text: &str) -> Result<PathBuf, String> {
    let path = folder.join(name);
    std::fs::create_dir_all(folder)
        .and_then(|()| std::fs::write(&path, text))
        .map_err(|e| format!("cannot write `{}`: {e}", path.display()))?;
    Ok(path)
}

/// A model with one more scenario.
fn with(model: &str, scenario: &str) -> String {
    let end = model.rfind('}').unwrap_or(model.len());
    format!("{}\n{scenario}}}\n", &model[..end])
}

/// Rates for a free swing of the hand: all digits move, all joints of a digit against each other.
fn hand_rates(model: &str) -> Vec<(String, f64)> {
    let names = model.lines().filter_map(|line| line.trim().strip_prefix("joint "));
    let names = names.filter_map(|line| line.split(':').next());
    names
        .enumerate()
        .map(|(i, name)| (name.to_string(), [0.5, 1.5, -2.0, 2.5][i % 4] * (1.0 + 0.1 * i as f64)))
        .collect()
}

/// A free swing: from the start with given rates; natural lengths are those of the start.
fn swing(rates: &[(String, f64)]) -> String {
    let mut text =
        "    scenario swing {\n        step = 1 ms;\n        duration = 1 s;\n".to_string();
    for (name, rate) in rates {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "        velocity {name} = {rate} rad/s;");
    }
    text + "    }\n"
}

/// The finger's scenario with every time multiplied, so that a run is long enough to be timed.
fn stretched(model: &str) -> Result<String, String> {
    let track = model.split("scenario track").nth(1).ok_or("the finger has no `track`")?;
    let end = track.rfind('}').ok_or("`track` is not closed")?;
    let track = &track[..end];
    let mut text = "    scenario long".to_string();
    let mut rest = track;
    while let Some(at) = rest.find(" @ ") {
        let (before, after) = rest.split_at(at + 3);
        let (time, after) = after.split_once(' ').ok_or("a knot without unit")?;
        let time: f64 = time.parse().map_err(|_| format!("`{time}` is not a time"))?;
        let _ = write!(text, "{before}{} ", time * STRETCH);
        rest = after;
    }
    text.push_str(rest);
    Ok(text.replace("duration = 30 s", "duration = 3000 s"))
}

/// A chain of hinged rods, slightly bent, that swings under gravity.
pub(crate) fn chain(links: usize) -> String {
    let mut text =
        format!("/// Hinged rods.\nmodel chain_{links} {{\n    gravity = (0, 0, -9.81) m/s^2;\n");
    for i in 0..links {
        let parent = if i == 0 { "world".into() } else { format!("j{} at (0, 0, -50) mm", i - 1) };
        let _ = writeln!(
            text,
            "    joint j{i}: revolute(y) in {parent} {{ start = 0.02 rad; }}\n    mass m{i} in j{i} = capsule \
             {{ from = (0, 0, 0) mm; to = (0, 0, -50) mm; radius = 5 mm; mass = 0.05 kg; }}"
        );
    }
    text + "    scenario fall { step = 1 ms; duration = 1 s; }\n}\n"
}

/// Planar fingers side by side, each with three joints and four strands.
pub(crate) fn fingers(count: usize) -> String {
    let mut text = FINGER.to_string();
    let _ = writeln!(text, "/// Fingers.\nmodel fingers_{count} {{");
    for i in 0..count {
        // Lengths differ a little, as those of a hand do.
        let size = 1.0 - 0.002 * i as f64;
        let _ = writeln!(
            text,
            "    place finger(s = {size}) as f{i} in world at (0, {}, 0) mm;",
            20 * i
        );
    }
    text + "    scenario sway { step = 1 ms; duration = 1 s; }\n}\n"
}

const FINGER: &str = "
/// Three flexion joints, four strands.
component finger(s: Number) {
    joint mcp: revolute(z) in base { start = -0.1 rad; velocity = -1 rad/s; }
    mass pp in mcp { mass = 11 g; at = (20 * s, 0, 0) mm; inertia = (0.45, 1.7, 1.7) kg*mm^2; }
    joint pip: revolute(z) in mcp at (40 * s, 0, 0) mm { start = -0.2 rad; }
    mass mp in pip { mass = 5 g; at = (11 * s, 0, 0) mm; inertia = (0.16, 0.29, 0.29) kg*mm^2; }
    joint dip: revolute(z) in pip at (22 * s, 0, 0) mm { start = -0.1 rad; velocity = 1 rad/s; }
    mass dp in dip { mass = 2.7 g; at = (8 * s, 0, 0) mm; inertia = (0.065, 0.089, 0.089) kg*mm^2; }
    strand fdp {
        path = base (-60, -10, 0) mm -> base (-8, -10, 0) mm -> mcp (10, -10, 0) mm -> mcp (34, -9, 0) mm
            -> pip (6, -8, 0) mm -> pip (18, -7, 0) mm -> dip (6, -6, 0) mm;
        stiffness = 200 N/m;
    }
    strand fds {
        path = base (-60, -12, 0) mm -> base (-8, -12, 0) mm -> mcp (10, -11, 0) mm -> mcp (34, -10, 0) mm
            -> pip (8, -8, 0) mm;
        stiffness = 200 N/m;
    }
    strand edc {
        path = base (-60, 10, 0) mm -> base (-6, 10, 0) mm -> mcp (10, 9.5, 0) mm -> mcp (36, 8, 0) mm
            -> pip (6, 7, 0) mm -> pip (20, 6, 0) mm -> dip (6, 5.5, 0) mm;
        stiffness = 150 N/m;
    }
    strand lum {
        path = base (-50, -7, 0) mm -> mcp (12, -5, 0) mm -> pip (4, 6, 0) mm -> dip (5, 5.5, 0) mm;
        stiffness = 100 N/m;
    }
}
";
