//! Scenarios: one with everything, one left alone.

use super::draft::Draft;
use super::expression::{RECORD, TIME, plain};

/// Adds scenarios `main` and `alone`.
pub(super) fn scenarios(draft: &mut Draft) {
    let mut lines = vec!["step = 2 ms;".to_string(), "duration = 40 ms;".into()];
    // The length of a rod stays, so that loops still close.
    let free: Vec<_> = draft.params.iter().filter(|p| !p.0.starts_with("rod")).cloned().collect();
    if !free.is_empty() && draft.chance.is(0.4) {
        let (name, unit) = draft.chance.pick(&free);
        lines.push(format!("set {name} = 0.11 {unit};"));
    }
    for (name, unit) in draft.inputs.clone() {
        if draft.chance.is(0.4) {
            lines.push(format!("input {name} = 0.2 {unit} * {};", plain(draft, TIME, 1)));
        }
    }
    let closed = draft.lines.iter().any(|line| line.starts_with("constraint"));
    for c in draft.coordinates.clone() {
        if c.driven {
            continue;
        }
        let unit = c.unit();
        if !closed && draft.chance.is(0.12) {
            let size = draft.chance.between(-0.1, 0.1);
            let wave = plain(draft, TIME, 1);
            lines.push(format!(
                "drive {} = {:.6} {unit} + {size:.4} {unit} * sin({wave});",
                c.name, c.start
            ));
        } else if draft.chance.is(0.2) {
            lines.push(format!("start {} = {:.6} {unit};", c.name, c.start + 1e-3));
            lines.push(format!("velocity {} = {:.6} {unit}/s;", c.name, -0.5 * c.start));
        }
    }
    if !draft.strands.is_empty() && draft.chance.is(0.6) {
        motion(draft, &mut lines);
    }
    for k in 0..1 + draft.chance.below(3) {
        lines.push(format!("record {} as extra{k};", plain(draft, RECORD, 2)));
    }
    if let Some((name, unit)) = draft.multipliers.first() {
        lines.push(format!("record {name} / 2 {unit} as pull;"));
    }
    draft.lines.push(format!("scenario main {{\n        {}\n    }}", lines.join("\n        ")));
    draft.lines.push("scenario alone { step = 5 ms; duration = 0.1 s; tolerance = 1e-13; }".into());
}

fn motion(draft: &mut Draft, lines: &mut Vec<String>) {
    for pose in ["here", "there"] {
        let mut entries = String::new();
        for c in draft.coordinates.clone() {
            if draft.chance.is(0.7) {
                let value = c.start + draft.chance.between(-0.1, 0.1);
                entries.push_str(&format!(" {} = {value:.6} {};", c.name, c.unit()));
            }
        }
        lines.push(format!("pose {pose} {{{entries} }}"));
    }
    lines.push("motion go = here @ 0 s -> there @ 15 ms -> here @ 35 ms;".into());
    match draft.chance.is(0.5) {
        true => lines.push("follow go;".into()),
        false => lines.push(format!("follow go with {};", draft.strands[0])),
    }
}
