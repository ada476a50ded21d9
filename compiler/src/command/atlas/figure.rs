//! Pictures of an atlas: moment arm, excursion and tension over each joint.

use super::sweep::Sweep;
use crate::command::posture::Posture;
use handc_plot::{MapAxis, MapPlot, MapRow, Sweep as Column, SweepPlot, SweepRow, Unit};
use handc_runtime::mechanism::Mechanism;

/// A picture and what its file's name ends with.
pub(super) struct Figure {
    pub(super) suffix: String,
    pub(super) plot: SweepPlot,
}

/// One picture for each part of the model, or one for all where there are few joints.
pub(super) fn figures(
    mechanism: &Mechanism,
    posture: &Posture,
    lengths: &[f64],
    title: &str,
    sweeps: &[Sweep],
) -> Vec<Figure> {
    let part = |sweep: &Sweep| {
        let name = mechanism.coordinates[sweep.coordinates[0]].name.as_str();
        name.rsplit_once('.').map_or("", |(part, _)| part).to_string()
    };
    let mut parts: Vec<(String, Vec<&Sweep>)> = Vec::new();
    for sweep in sweeps {
        let name = if sweeps.len() > FEW { part(sweep) } else { String::new() };
        match parts.iter_mut().find(|(other, _)| *other == name) {
            Some((_, members)) => members.push(sweep),
            None => parts.push((name, vec![sweep])),
        }
    }
    let several = parts.len() > 1;
    parts
        .into_iter()
        .map(|(part, members)| {
            let named = several && !part.is_empty();
            let title = if named { format!("{title}, {part}") } else { title.to_string() };
            let prefix = if named { format!("{part}.") } else { String::new() };
            let plot = plot(mechanism, posture, lengths, title, &prefix, &members);
            let suffix = if named { format!(".{part}") } else { String::new() };
            Figure { suffix, plot }
        })
        .collect()
}

/// Joints that one picture holds whatever they belong to.
const FEW: usize = 4;

fn plot(
    mechanism: &Mechanism,
    posture: &Posture,
    lengths: &[f64],
    title: String,
    prefix: &str,
    sweeps: &[&Sweep],
) -> SweepPlot {
    let mut shown: Vec<usize> = sweeps.iter().flat_map(|sweep| &sweep.strands).copied().collect();
    shown.sort_unstable();
    shown.dedup();
    let short = |name: &str| name.strip_prefix(prefix).unwrap_or(name).to_string();
    let columns = sweeps.iter().map(|sweep| {
        let c = sweep.coordinates[0];
        let unit = if posture.is_length(c) { Unit::Prefixed("m") } else { Unit::Angle };
        Column {
            label: short(&mechanism.coordinates[c].name),
            unit,
            values: sweep.instants.iter().map(|(values, _)| values[0]).collect(),
            mark: Some(posture.q[c]),
        }
    });
    let row = |label: &str, unit: Unit, value: &dyn Fn(&super::sweep::Instant, usize) -> f64| {
        let curve = |sweep: &Sweep, strand: usize| -> Vec<f64> {
            let found = sweep.instants.iter().map(|(_, instant)| instant.as_ref());
            found.map(|instant| instant.map_or(f64::NAN, |i| value(i, strand))).collect()
        };
        let cells = sweeps.iter().map(|sweep| {
            let place = |s: usize| shown.iter().position(|&other| other == s).unwrap_or(0);
            sweep.strands.iter().map(|&s| (place(s), curve(sweep, s))).collect()
        });
        SweepRow { label: label.to_string(), unit, cells: cells.collect() }
    };
    let turns = sweeps.iter().any(|sweep| !posture.is_length(sweep.coordinates[0]));
    let arm = if turns { Unit::Prefixed("m") } else { Unit::Plain(String::new()) };
    SweepPlot {
        title,
        names: shown.iter().map(|&s| short(&mechanism.strands[s].name)).collect(),
        mark: "the pose".to_string(),
        columns: columns.collect(),
        rows: vec![
            row("moment arm", arm, &|instant, s| instant.arms[0][s]),
            row("change of length", Unit::Prefixed("m"), &|i, s| i.lengths[s] - lengths[s]),
            row("tension", Unit::Prefixed("N"), &|instant, s| instant.tensions[s]),
        ],
    }
}

/// A picture of a sweep of two joints: moment arms of each strand about both.
pub(super) fn map(
    mechanism: &Mechanism,
    posture: &Posture,
    title: String,
    sweep: &Sweep,
) -> MapPlot {
    // What all names begin with goes without saying.
    let strands = sweep.strands.iter().map(|&s| mechanism.strands[s].name.as_str());
    let joints = sweep.coordinates.iter().map(|&c| mechanism.coordinates[c].name.as_str());
    let names: Vec<&str> = joints.chain(strands).collect();
    let part = names.first().and_then(|name| name.rsplit_once('.')).map(|(part, _)| part);
    let prefix = part.map_or(String::new(), |part| format!("{part}."));
    let is_shared = names.iter().all(|name| name.starts_with(&prefix));
    let short = |name: &str| match is_shared {
        true => name[prefix.len()..].to_string(),
        false => name.to_string(),
    };
    let unit = |c: usize| match posture.is_length(c) {
        true => Unit::Prefixed("m"),
        false => Unit::Angle,
    };
    let axis = |k: usize| {
        let c = sweep.coordinates[k];
        let mut values: Vec<f64> = sweep.instants.iter().map(|(values, _)| values[k]).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        MapAxis { label: short(&mechanism.coordinates[c].name), unit: unit(c), values }
    };
    let row = |k: usize| {
        let c = sweep.coordinates[k];
        let cell = |&s: &usize| -> Vec<f64> {
            let instants = sweep.instants.iter().map(|(_, instant)| instant.as_ref());
            instants.map(|instant| instant.map_or(f64::NAN, |i| i.arms[k][s])).collect()
        };
        MapRow {
            label: format!("moment arm about {}", short(&mechanism.coordinates[c].name)),
            unit: match posture.is_length(c) {
                true => Unit::Plain(String::new()),
                false => Unit::Prefixed("m"),
            },
            cells: sweep.strands.iter().map(cell).collect(),
        }
    };
    MapPlot {
        title,
        across: axis(0),
        up: axis(1),
        names: sweep.strands.iter().map(|&s| short(&mechanism.strands[s].name)).collect(),
        rows: vec![row(0), row(1)],
    }
}
