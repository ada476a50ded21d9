//! Strands, inputs, torques and forces.

use super::draft::Draft;
use super::expression::{LOAD, REST, Reads, TIME, plain};

/// Strands of two to six points.
pub(super) fn strands(draft: &mut Draft) {
    for _ in 0..draft.chance.below(4) {
        let name = draft.fresh("s");
        let count = 2 + draft.chance.below(5);
        let points: Vec<String> = (0..count).map(|_| draft.point(0.25)).collect();
        let length = 0.2 * count as f64;
        let rest = match draft.chance.below(5) {
            0 => format!(" rest = {};", draft.quantity(length, "m")),
            1 => {
                // An input feeds it.
                let input = draft.fresh("in");
                draft.lines.push(format!("input {input} = {length:.4} m;"));
                draft.inputs.push((input.clone(), "m"));
                let wave = plain(draft, REST, 1);
                format!(" rest = {input} + 3 cm * sin({wave});")
            }
            2 => format!(" rest = {length:.4} m + 2 cm * {};", plain(draft, TIME, 2)),
            _ => String::new(),
        };
        let friction = draft.chance.is(0.15) && count > 2;
        let path = if friction { points.join(" -> ") } else { wound(draft, &points) };
        let law = law(draft);
        let more = match draft.chance.below(6) {
            _ if friction => " friction = 0.2; friction_speed = 0.1 m/s;".to_string(),
            0 => format!(" damping = {};", draft.quantity(0.4, "N*s/m")),
            1 => " slack = true; slack_width = 0.2 m;".to_string(),
            2 => " slack = true; slack_width = 0.1 m; damping = 0.3 N*s/m;".to_string(),
            _ => String::new(),
        };
        draft.lines.push(format!("strand {name} {{ path = {path};{law}{rest}{more} }}"));
        draft.strands.push(name);
    }
}

/// A path through points, round a surface here and there.
fn wound(draft: &mut Draft, points: &[String]) -> String {
    let mut path = points[0].clone();
    for point in &points[1..] {
        if draft.chance.is(0.25) {
            let (center, radius) = (draft.point(0.1), draft.chance.between(10.0, 60.0));
            let [x, y, z] = draft.chance.vector(1.0);
            let side = match draft.chance.below(3) {
                0 => String::new(),
                _ => format!(", side = ({x:.3}, {y:.3}, {z:.3})"),
            };
            let surface = match draft.chance.is(0.4) {
                true => format!("sphere({center}, radius = {radius:.2} mm{side})"),
                false => {
                    let axis = *draft.chance.pick(&["x", "-y", "z", "(1, 2, 0)", "(0, 1, -3)"]);
                    format!("cylinder({center}, axis = {axis}, radius = {radius:.2} mm{side})")
                }
            };
            path.push_str(&format!(" -> via wrap {surface}"));
        }
        path.push_str(&format!(" -> {point}"));
    }
    path
}

/// What makes a strand pull.
fn law(draft: &mut Draft) -> String {
    let stiffness = draft.chance.between(10.0, 300.0);
    match draft.chance.below(6) {
        0 => format!(" energy = {stiffness:.3} N/m * (x - x0)^2 / 2 * (1 + 0.3 * (x / x0 - 1));"),
        1 => {
            let reads = Reads { lengths: false, ..LOAD };
            let value = plain(draft, reads, 1);
            format!(" tension = 8 N + 0.5 N * sin({value}) + 0.2 N*s/m * rate(x) + 3 N/m * x;")
        }
        2 => format!(" tension = {};", draft.quantity(stiffness / 100.0, "N")),
        _ => format!(" stiffness = {};", draft.quantity(stiffness, "N/m")),
    }
}

/// A node that three strands hold, with mass or without.
pub(super) fn nodes(draft: &mut Draft) {
    if !draft.chance.is(0.3) {
        return;
    }
    let name = draft.fresh("n");
    let [x, y, z] = draft.chance.vector(0.3);
    let frame = draft.chance.pick(&draft.frames).clone();
    let mass = if draft.chance.is(0.5) { " mass = 20 g; damping = 0.1 N*s/m;" } else { "" };
    draft.lines.push(format!("node {name} at ({x:.4}, {y:.4}, {z:.4}) m in {frame} {{{mass} }}"));
    for _ in 0..4 {
        let strand = draft.fresh("s");
        let end = draft.point(0.6);
        draft.lines.push(format!(
            "strand {strand} {{ path = {name} -> {end}; stiffness = 80 N/m; rest = 0.05 m; }}"
        ));
        draft.strands.push(strand);
    }
}

/// Inputs with defaults in time.
pub(super) fn inputs(draft: &mut Draft) {
    for _ in 0..draft.chance.below(3) {
        let unit = *draft.chance.pick(&["N*m", "N", "m", "s"]);
        let value = plain(draft, TIME, 2);
        let name = draft.fresh("in");
        draft.lines.push(format!("input {name} = 0.3 {unit} * {value};"));
        draft.inputs.push((name, unit));
    }
}

/// Torques and forces.
pub(super) fn loads(draft: &mut Draft) {
    for _ in 0..draft.chance.below(3) {
        let c = draft.chance.pick(&draft.coordinates).clone();
        let mut reads = LOAD;
        reads.kinks = draft.chance.is(0.15);
        let size = if c.is_length { 0.5 } else { 0.05 };
        let (value, unit, name) = (plain(draft, reads, 2), c.force_unit(), draft.fresh("tau"));
        draft.lines.push(format!("torque {name} on {} = {size} {unit} * {value};", c.name));
    }
    for _ in 0..draft.chance.below(3) {
        let (name, at) = (draft.fresh("push"), draft.point(0.2));
        let [x, y, z] = draft.chance.vector(1.0);
        let first = plain(draft, LOAD, 2);
        let second = match draft.chance.is(0.4) {
            true => format!("{y:.4} N * {}", plain(draft, LOAD, 1)),
            false => format!("{y:.4} N"),
        };
        let axes = match draft.chance.is(0.4) {
            true => format!(" in {}", draft.chance.pick(&draft.frames)),
            false => String::new(),
        };
        let value = format!("({x:.4} N * {first}, {second}, {z:.4} N)");
        draft.lines.push(format!("force {name} at {at} = {value}{axes};"));
    }
}
