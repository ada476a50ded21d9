//! Loops, closed where the points are at the start.

use super::draft::Draft;
use crate::load::mechanism_of_text;
use handc_core::model::Model;
use handc_runtime::interpreter::Interpreter;
use handc_runtime::vector::{Transform, Vec3};
use std::sync::Arc;

struct Placed {
    name: String,
    link: Option<u32>,
    world: Transform<f64>,
}

/// Adds constraints that leave at least one coordinate free; `None` where there is no room.
pub(super) fn close(draft: &mut Draft) -> Option<()> {
    let text = draft.text();
    let mechanism = mechanism_of_text(&draft.name, &text).unwrap_or_else(|e| panic!("{text}\n{e}"));
    let mut model = Interpreter::new(Arc::new(mechanism.clone()));
    let n = mechanism.coordinates.len();
    let (mut q, mut v) = (vec![0.0; n], vec![0.0; n]);
    model.start(&mut q, &mut v);
    model.drives(0.0, &mut q);
    let poses = model.frame_poses(&q);
    let mut lengths = vec![0.0; mechanism.strands.len()];
    model.strand_lengths(&q, &mut lengths);
    let placed: Vec<Placed> = mechanism
        .frames
        .iter()
        .zip(poses)
        .filter(|(frame, _)| frame.name != "world")
        .map(|(frame, world)| Placed { name: frame.name.clone(), link: frame.link, world })
        .collect();
    let free = mechanism.coordinates.iter().filter(|c| c.drive.is_none()).count();
    let mut room = free.checked_sub(1).filter(|&room| room > 0)?;
    for _ in 0..1 + draft.chance.below(2) {
        let rows = constraint(draft, &placed, &q, &lengths, room)?;
        room -= rows;
        if room == 0 {
            break;
        }
    }
    Some(())
}

/// Adds one constraint and answers how many rows it has.
fn constraint(
    draft: &mut Draft,
    placed: &[Placed],
    q: &[f64],
    lengths: &[f64],
    room: usize,
) -> Option<usize> {
    let name = draft.fresh("c");
    let first = draft.chance.below(placed.len());
    let others: Vec<&Placed> = placed.iter().filter(|p| p.link != placed[first].link).collect();
    let first = &placed[first];
    let here = draft.chance.vector(0.2);
    let meeting = first.world.point(Vec3(here));
    let point = |p: &[f64; 3]| format!("({:.17}, {:.17}, {:.17}) m", p[0], p[1], p[2]);
    let end = format!("{} {}", first.name, point(&here));
    // The other end is in a frame that moves against the first, or in the world.
    let other = match others.is_empty() || (first.link.is_some() && draft.chance.is(0.3)) {
        true if first.link.is_none() => return None,
        true => None,
        false => Some(*draft.chance.pick(&others)),
    };
    let base = other.map_or_else(Transform::identity, |p| p.world);
    let frame = other.map_or("world", |p| p.name.as_str());
    let local = base.inverse().point(meeting).0;
    let weld = room >= 6 && draft.chance.is(0.7);
    let (text, rows, units): (String, &[&str], &'static str) = match draft.chance.below(8) {
        _ if weld => {
            let twist = base.inverse() * first.world;
            let (axis, angle) = axis_angle(&twist);
            let at = point(&twist.translation.0);
            let seat = draft.fresh("seat");
            let [x, y, z] = axis;
            draft.lines.push(format!(
                "frame {seat} in {frame} at {at} rotate ({x:.17}, {y:.17}, {z:.17}) {angle:.17};"
            ));
            (format!("weld({}, {seat})", first.name), &[".x", ".y", ".z", ".xy", ".yz", ".zx"], "")
        }
        0 if room >= 3 => {
            (format!("coincident({end}, {frame} {})", point(&local)), &[".x", ".y", ".z"], "N*s")
        }
        0 | 1 if room >= 2 => (
            format!("coincident({end}, {frame} {}, axes = (x, z))", point(&local)),
            &[".x", ".z"],
            "N*s",
        ),
        2 => (format!("coincident({end}, {frame} {}, axes = (y))", point(&local)), &[".y"], "N*s"),
        3 | 4 => {
            let away = draft.chance.vector(0.2).map(|x| x + 0.25);
            let target = base.point(Vec3(away));
            let gap = (target - meeting).norm_squared().sqrt();
            let d = match draft.chance.is(0.4) {
                true => {
                    let name = draft.fresh("rod");
                    draft.lines.insert(0, format!("param {name} = {gap:.17} m;"));
                    draft.params.push((name.clone(), "m"));
                    name
                }
                false => format!("{gap:.17} m"),
            };
            (format!("distance({end}, {frame} {}) = {d}", point(&away)), &[""], "kg/s")
        }
        5 => {
            let normal = draft.axis();
            let through = point(&local);
            (
                format!("on_plane({end}, {frame}, normal = {normal}, through = {through})"),
                &[""],
                "N*s",
            )
        }
        6 if !lengths.is_empty() => {
            let k = draft.chance.below(lengths.len());
            let (strand, length) = (&draft.strands[k], lengths[k]);
            (format!("length({strand}) == {length:.17} m + 2 mm * sin(9 rad/s * t)"), &[""], "N*s")
        }
        _ => {
            // Those of nodes come last and are left alone.
            let count = draft.coordinates.len();
            let (i, k) = (draft.chance.below(count), draft.chance.below(count));
            let (a, b) = (&draft.coordinates[i], &draft.coordinates[k]);
            if i == k || a.driven {
                return None;
            }
            let (ua, ub) = (a.unit(), b.unit());
            let offset = q[i] - 0.4 * (q[k] - b.start).sin();
            let right = format!("0.4 {ua} * sin(({} - {:.6} {ub}) / 1 {ub})", b.name, b.start);
            (format!("{} == {offset:.17} {ua} + {right}", a.name), &[""], "")
        }
    };
    draft.lines.push(format!("constraint {name}: {text};"));
    if !units.is_empty() {
        for row in rows {
            draft.multipliers.push((format!("lambda.{name}{row}"), units));
        }
    }
    Some(rows.len())
}

/// Axis and angle of a rotation.
fn axis_angle(transform: &Transform<f64>) -> ([f64; 3], f64) {
    let r = &transform.rotation.0;
    let twice = [r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]];
    let sine = 0.5 * twice.iter().map(|x| x * x).sum::<f64>().sqrt();
    let angle = sine.atan2(0.5 * (r[0][0] + r[1][1] + r[2][2] - 1.0));
    if sine < 1e-6 {
        return ([0.0, 0.0, 1.0], 0.0);
    }
    (twice.map(|x| 0.5 * x / sine), angle)
}
