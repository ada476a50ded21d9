//! Joints, frames and masses.

use super::draft::{Coordinate, Draft};

/// A tree of one to six coordinates with masses on it.
pub(super) fn tree(draft: &mut Draft) {
    let [x, y, z] = draft.chance.vector(9.8);
    if draft.chance.is(0.7) {
        draft.lines.push(format!("gravity = ({x:.4}, {y:.4}, {z:.4}) m/s^2;"));
    }
    let wanted = 1 + draft.chance.below(6);
    if wanted >= 5 && draft.chance.is(0.3) {
        free(draft);
    }
    while draft.coordinates.len() < wanted {
        if draft.chance.is(0.25) {
            let (name, parent) = (draft.fresh("f"), draft.chance.pick(&draft.frames).clone());
            let place = draft.placement(0.15);
            draft.lines.push(format!("frame {name} in {parent}{place};"));
            draft.frames.push(name);
        }
        joint(draft, wanted - draft.coordinates.len());
    }
    if draft.chance.is(0.3) {
        mass(draft, "world");
    }
    let (name, parent) = (draft.fresh("f"), draft.frames.last().expect("a frame").clone());
    let place = draft.placement(0.15);
    draft.lines.push(format!("frame {name} in {parent}{place};"));
    draft.frames.push(name);
}

fn joint(draft: &mut Draft, room: usize) {
    // Mostly a chain, now and then a branch.
    let parent = match draft.chance.is(0.7) {
        true => draft.frames.last().expect("a frame").clone(),
        false => draft.chance.pick(&draft.frames).clone(),
    };
    let name = draft.fresh("j");
    let place = draft.placement(0.2);
    let axis = draft.axis();
    let (kind, lengths, suffixes): (String, Vec<bool>, Vec<&str>) = match draft.chance.below(9) {
        0 | 1 => (format!("prismatic({axis})"), vec![true], vec![""]),
        2 => {
            let pitch = draft.chance.between(-0.02, 0.02);
            let pitch = draft.quantity(pitch, "m");
            (format!("screw({axis}, {pitch})"), vec![false], vec![""])
        }
        3 if room >= 2 => ("universal(x, (0, 1, 0.3))".into(), vec![false; 2], vec![".a", ".b"]),
        4 if room >= 3 => {
            let normal = *draft.chance.pick(&["x", "y", "z"]);
            (format!("planar({normal})"), vec![true, true, false], vec![".u", ".v", ".r"])
        }
        _ => (format!("revolute({axis})"), vec![false], vec![""]),
    };
    let starts: Vec<f64> = lengths
        .iter()
        .map(|&is_length| draft.chance.between(-1.0, 1.0) * if is_length { 0.1 } else { 0.9 })
        .collect();
    let mut driven = false;
    let options = if lengths.len() == 1 {
        driven = !draft.coordinates.is_empty() && draft.chance.is(0.12);
        single(draft, lengths[0], starts[0], driven)
    } else {
        let list: Vec<String> = starts
            .iter()
            .zip(&lengths)
            .map(|(value, &is_length)| {
                format!("{value:.6} {}", if is_length { "m" } else { "rad" })
            })
            .collect();
        format!("start = ({});", list.join(", "))
    };
    draft.lines.push(format!("joint {name}: {kind} in {parent}{place} {{ {options} }}"));
    for ((suffix, is_length), start) in suffixes.iter().zip(lengths).zip(starts) {
        let name = format!("{name}{suffix}");
        draft.coordinates.push(Coordinate { name, is_length, driven, start });
    }
    mass(draft, &name);
    draft.frames.push(name);
}

/// Options of a joint with one coordinate.
fn single(draft: &mut Draft, is_length: bool, start: f64, driven: bool) -> String {
    let (unit, stiff, damp) = match is_length {
        true => ("m", "N/m", "N*s/m"),
        false => ("rad", "N*m/rad", "N*m*s/rad"),
    };
    let scale = if is_length { 100.0 } else { 1.0 };
    if driven {
        let (size, rate) = (draft.chance.between(-0.1, 0.1), draft.chance.between(2.0, 9.0));
        return format!("drive = {start:.6} {unit} + {size:.6} {unit} * sin({rate:.3} rad/s * t);");
    }
    let mut text = format!("start = {start:.6} {unit};");
    let mut option = |draft: &mut Draft, often: f64, name: &str, value: f64, unit: &'static str| {
        if draft.chance.is(often) {
            let value = draft.quantity(value, unit);
            text.push_str(&format!(" {name} = {value};"));
        }
    };
    let random = draft.chance.vector(1.0);
    option(draft, 0.3, "velocity", random[0], if is_length { "m/s" } else { "rad/s" });
    option(draft, 0.4, "damping", 0.02 * scale * random[1].abs(), damp);
    if draft.chance.is(0.4) {
        option(draft, 1.0, "stiffness", scale * random[2].abs(), stiff);
        option(draft, 0.5, "rest", 0.2 * random[0], unit);
    }
    if draft.chance.is(0.35) {
        let (low, high) = (start - 0.05 * random[1].abs() - 0.01, start + 0.02);
        text.push_str(&format!(" limits = ({low:.6} {unit}, {high:.6} {unit});"));
        text.push_str(&format!(" limit_stiffness = {:.3} {stiff};", 5.0 * scale));
    }
    text
}

fn free(draft: &mut Draft) {
    let name = draft.fresh("body");
    let place = draft.placement(0.3);
    let mut starts = [draft.chance.vector(0.1), draft.chance.vector(0.8)].concat();
    starts[4] *= 0.5;
    let list: Vec<String> = starts
        .iter()
        .enumerate()
        .map(|(i, x)| format!("{x:.6} {}", if i < 3 { "m" } else { "rad" }))
        .collect();
    let list = list.join(", ");
    draft.lines.push(format!("joint {name}: free in world{place} {{ start = ({list}); }}"));
    for (i, suffix) in ["tx", "ty", "tz", "rx", "ry", "rz"].iter().enumerate() {
        let (name, start) = (format!("{name}.{suffix}"), starts[i]);
        draft.coordinates.push(Coordinate { name, is_length: i < 3, driven: false, start });
    }
    mass(draft, &name);
    draft.frames.push(name);
}

/// A body with inertia about every axis.
fn mass(draft: &mut Draft, frame: &str) {
    let name = draft.fresh("m");
    let kilograms = draft.chance.between(0.1, 1.0);
    let mass = draft.quantity(kilograms, "kg");
    let text = match draft.chance.below(6) {
        0 => format!("= sphere {{ radius = 6 cm; mass = {mass}; at = {}; }}", draft.vector(0.1)),
        1 => "= box { size = (8, 12, 5) cm; density = 900 kg/m^3; }".to_string(),
        2 => {
            let to = draft.vector(0.1);
            format!(
                "= capsule {{ from = (0, 0, 0.2) m; to = {to}; radius = 4 cm; mass = {mass}; }}"
            )
        }
        3 => {
            let to = draft.vector(0.1);
            format!(
                "= cylinder {{ from = (0, 0.2, 0) m; to = {to}; radius = 3 cm; mass = {mass}; }}"
            )
        }
        4 => {
            let at = draft.vector(0.1);
            let full = "(30, 40, 50, 3, -4, 5) kg*cm^2";
            format!("{{ mass = {mass}; at = {at}; inertia = {full}; }}")
        }
        _ => {
            let at = draft.vector(0.1);
            format!("{{ mass = {mass}; at = {at}; inertia = (20, 35, 45) kg*cm^2; }}")
        }
    };
    draft.lines.push(format!("mass {name} in {frame} {text}"));
}
