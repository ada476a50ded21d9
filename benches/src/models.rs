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
