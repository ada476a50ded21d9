//! Strength as a table: all of it as CSV, part of it for the reader.

use crate::statics::strength::Strength;
use handc_core::trajectory::push_number;
use std::fmt::Write;

/// Most rows that are shown.
const SHOWN: usize = 24;

/// The strength in a direction of the world, with the angle in the plane if there is one.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub(super) angle: Option<f64>,
    pub(super) direction: [f64; 3],
    pub(super) found: Strength,
}

/// `angle,dx,dy,dz,force,fx,fy,fz`, then the tension of each strand, then those at their limit.
pub(super) fn csv(rows: &[Row], strands: &[&str]) -> String {
    let is_plane = rows.iter().all(|row| row.angle.is_some());
    let mut text = String::from(if is_plane { "angle,dx,dy,dz" } else { "dx,dy,dz" });
    text.push_str(",force,fx,fy,fz");
    strands.iter().for_each(|strand| {
        let _ = write!(text, ",tension.{strand}");
    });
    text.push_str(",at_limit\n");
    for row in rows {
        let angle = row.angle.into_iter();
        let numbers = angle.chain(row.direction).chain([row.found.force]);
        for (k, number) in numbers.chain(row.found.exerted).enumerate() {
            if k > 0 {
                text.push(',');
            }
            push_number(&mut text, number);
        }
        for tension in &row.found.tensions {
            text.push(',');
            push_number(&mut text, *tension);
        }
        let _ = writeln!(text, ",{}", limiting(&row.found, strands, " "));
    }
    text
}

/// Names of the strands at their limit.
fn limiting(found: &Strength, strands: &[&str], between: &str) -> String {
    let named = strands.iter().zip(&found.at_limit).filter(|(_, at)| **at).map(|(name, _)| *name);
    named.collect::<Vec<_>>().join(between)
}

/// A direction for the reader.
fn direction(row: &Row) -> String {
    match row.angle {
        Some(angle) => format!("{:.0}°", angle.to_degrees()),
        None => {
            let [x, y, z] = row.direction.map(|d| d + 0.0);
            format!("({x:.3}, {y:.3}, {z:.3})")
        }
    }
}

fn force(found: &Strength) -> String {
    if found.force.is_nan() {
        "none".to_string()
    } else if found.force.is_infinite() {
        "no end".to_string()
    } else {
        format!("{:.2} N", found.force)
    }
}

/// A table of some directions, and the strongest and the weakest of all.
pub(super) fn text(rows: &[Row], strands: &[&str]) -> String {
    let every = rows.len().div_ceil(SHOWN).max(1);
    let mut text = String::new();
    let width = rows.iter().map(|row| direction(row).chars().count()).max().unwrap_or(0).max(9);
    let _ = writeln!(text, "  {:>width$}  {:>12}  at their limit", "direction", "force");
    for row in rows.iter().step_by(every) {
        let shown = direction(row);
        let limiting = limiting(&row.found, strands, ", ");
        let line = format!("  {shown:>width$}  {:>12}  {limiting}", force(&row.found));
        let _ = writeln!(text, "{}", line.trim_end());
    }
    if every > 1 {
        let _ = writeln!(text, "  (every {every}th of {} directions)", rows.len());
    }
    let finite = || rows.iter().filter(|row| row.found.force.is_finite());
    let order = |a: &&Row, b: &&Row| a.found.force.total_cmp(&b.found.force);
    if let (Some(strongest), Some(weakest)) = (finite().max_by(order), finite().min_by(order))
        && rows.len() > 1
    {
        let _ = writeln!(
            text,
            "strongest {} at {}, weakest {} at {}",
            force(&strongest.found),
            direction(strongest),
            force(&weakest.found),
            direction(weakest)
        );
    }
    text
}
