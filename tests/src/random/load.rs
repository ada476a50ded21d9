//! Strands, inputs, torques and forces.

use super::draft::Draft;
use super::expression::{LOAD, REST, TIME, plain};

/// Strands of two to six points.
pub(super) fn strands(draft: &mut Draft) {
    for _ in 0..draft.chance.below(4) {
        let name = draft.fresh("s");
        let count = 2 + draft.chance.below(5);
        let points: Vec<String> = (0..count).map(|_| draft.point(0.25)).collect();
        let stiffness = draft.chance.between(10.0, 300.0);
        let stiffness = draft.quantity(stiffness, "N/m");
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
        let path = points.join(" -> ");
        draft
            .lines
            .push(format!("strand {name} {{ path = {path}; stiffness = {stiffness};{rest} }}"));
        draft.strands.push(name);
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
