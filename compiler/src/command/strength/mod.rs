//! `handc strength`: the largest force at a point within limits of tension, in every direction of a
//! plane.

mod figure;
mod plane;
mod table;

use super::posture::names::Reader;
use super::posture::{self, Posture, PostureOptions, edit, value};
use crate::statics::balance::Balance;
pub use crate::statics::strength::OffAxis;
use crate::statics::strength::strength as strongest;
use handc_core::error::RunError;
use handc_dsl::dimension::Dimension;
use handc_plot::{Picture, save};
use handc_runtime::vector::{Mat3, Transform, Vec3};
pub use plane::Plane;
use std::path::{Path, PathBuf};
use table::Row;

/// Options of a strength.
#[derive(Clone, Debug, PartialEq)]
pub struct StrengthOptions {
    /// Model, pose and loads.
    pub posture: PostureOptions,
    /// `FRAME` or `FRAME=X,Y,Z`: where the force is exerted.
    pub at: String,
    /// The plane; `None`: the one that the point moves in most.
    pub plane: Option<Plane>,
    /// The frame whose axes are meant; `None`: the world.
    pub axes: Option<String>,
    /// Directions around the plane.
    pub directions: usize,
    /// `X,Y,Z`: these directions instead.
    pub direction: Vec<String>,
    /// `STRAND=NEWTON`.
    pub limit: Vec<String>,
    /// The limit of all others.
    pub limit_all: Option<String>,
    /// Strands that pull by their own law.
    pub passive: Vec<String>,
    /// What may be exerted beside the direction.
    pub off_axis: OffAxis,
    /// Where files go, without extension; `None`: none are written.
    pub out: Option<PathBuf>,
}

/// Prints a table of strength, and writes tables and pictures.
pub fn strength(options: &StrengthOptions) -> u8 {
    run(options).map_or_else(|code| code, |()| 0)
}

fn run(options: &StrengthOptions) -> Result<(), u8> {
    let mechanism = posture::mechanism(&options.posture)?;
    let mut reader = Reader::new(&mechanism);
    let passive: Vec<usize> =
        options.passive.iter().filter_map(|name| reader.strand(name)).collect();
    let (strands, limits) = limits(&mut reader, options, &passive);
    let at = point(&mut reader, &options.at);
    let axes = options.axes.as_ref().and_then(|name| reader.frame(name));
    let asked = directions(&mut reader, &options.direction);
    let mut edited = mechanism.clone();
    strands.iter().for_each(|&s| edit::without_force(&mut edited, s));
    let settled = posture::settle(&mut reader, edited, &options.posture);
    let settled = settled.map_err(|error| posture::fail(&error))?;
    posture::complain(&reader)?;
    let (Some(mut posture), Some((frame, offset))) = (settled, at) else { return Err(2) };

    let (q, held) = (posture.q.clone(), posture.clone());
    let balance = Balance::at(&mut posture.model, &q, &held.held(), &strands)
        .ok_or_else(|| posture::fail(&RunError::Start(NOT_FINITE.to_string())))?;
    let point = posture.point(frame, offset);
    let motion = balance.point(&mut posture.model, &q, &point);
    if motion.iter().flatten().all(|x| x.abs() < 1e-15) {
        let name = &mechanism.frames[frame].name;
        eprintln!("error: nothing moves `{name}`: no force at it does work");
        return Err(2);
    }
    let poses = posture.model.frame_poses(&q);
    let world_from_axes = axes.map_or_else(Mat3::identity, |axes| poses[axes].rotation);
    let plane = options.plane.unwrap_or_else(|| Plane::of_motion(&motion, &world_from_axes));
    let plane_axes = plane.axes(&world_from_axes);
    let directions: Vec<(Option<f64>, [f64; 3])> = match asked.is_empty() {
        true => {
            let around = plane::around(plane_axes, options.directions);
            around.into_iter().map(|(angle, d)| (Some(angle), d)).collect()
        }
        false => asked.iter().map(|d| (None, (world_from_axes * Vec3(*d)).0)).collect(),
    };
    let mut rows = Vec::new();
    for (angle, direction) in directions {
        let found = strongest(&balance, &motion, &limits, direction, options.off_axis);
        let found = found.map_err(|message| {
            eprintln!("error: the strength at ({direction:.3?}) was not found: {message}");
            3
        })?;
        rows.push(Row { angle, direction, found });
    }

    let names: Vec<&str> = strands.iter().map(|&s| mechanism.strands[s].name.as_str()).collect();
    let place = &mechanism.frames[frame].name;
    let pose = options.posture.pose.as_ref().map_or(String::new(), |p| format!(", pose {p}"));
    let whose = options.axes.as_ref().map_or(String::new(), |axes| format!(" of {axes}"));
    let [first, second] = plane.names();
    let head = match asked.is_empty() {
        true => format!(
            "strength at {place}{pose}: directions of force from {first} to {second}{whose}"
        ),
        false => format!("strength at {place}{pose}"),
    };
    super::print(&format!("{head}\n{}", table::text(&rows, &names)));
    tell(&rows);
    let Some(stem) = &options.out else { return Ok(()) };
    write_text(&with_suffix(stem, ".csv"), &table::csv(&rows, &names))?;
    if !asked.is_empty() {
        return Ok(());
    }
    let axes = [first, second].map(|name| format!("{name}{whose}"));
    let skeleton = skeleton(&mut posture, frame, offset, &poses[frame], plane_axes);
    let title = format!("{}: strength at {place}{pose}", mechanism.name);
    let notes = notes(options, &limits, &names);
    write(&figure::polar(&rows, &title, axes, skeleton, notes), stem)?;
    let title = format!("{}: tensions at the largest force{pose}", mechanism.name);
    write(&figure::tensions(&rows, &title, &names, &limits), &with_suffix(stem, ".tensions"))
}

const NOT_FINITE: &str = "forces at the pose are not finite\n  try: another pose, or check \
    divisions and roots in the model's expressions";

/// Pulled strands and their limits.
fn limits(
    reader: &mut Reader,
    options: &StrengthOptions,
    passive: &[usize],
) -> (Vec<usize>, Vec<f64>) {
    let given = reader.strand_values("--limit", &options.limit, Dimension::FORCE);
    let all = options
        .limit_all
        .as_ref()
        .and_then(|text| reader.take("--limit-all", value::number(text, Dimension::FORCE)));
    let names = |s: usize| reader.mechanism.strands[s].name.clone();
    let mut wrong: Vec<String> = given
        .iter()
        .filter(|(_, limit)| *limit < 0.0)
        .map(|(s, limit)| format!("`--limit`: `{}` cannot have the limit {limit} N", names(*s)))
        .collect();
    wrong.extend(all.filter(|limit| *limit < 0.0).map(|l| format!("`--limit-all` is {l} N")));
    wrong.extend(
        given
            .iter()
            .filter(|(s, _)| passive.contains(s))
            .map(|(s, _)| format!("`{}` is given with `--limit` and with `--passive`", names(*s))),
    );
    let mut without = Vec::new();
    let (mut strands, mut limits) = (Vec::new(), Vec::new());
    for s in (0..reader.mechanism.strands.len()).filter(|s| !passive.contains(s)) {
        match given.iter().find(|(other, _)| *other == s).map(|(_, limit)| *limit).or(all) {
            Some(limit) => {
                strands.push(s);
                limits.push(limit);
            }
            None => without.push(format!("`{}`", names(s))),
        }
    }
    if !without.is_empty() && options.limit_all.is_none() {
        wrong.push(format!(
            "no limit of tension for {}: give `--limit STRAND=NEWTON`, `--limit-all NEWTON` for all \
             others, or `--passive STRAND` for what pulls by its own law",
            without.join(", ")
        ));
    }
    if reader.mechanism.strands.is_empty() {
        wrong.push(format!("`{}` has no strands", reader.mechanism.name));
    }
    wrong.into_iter().for_each(|message| reader.complain(message));
    (strands, limits)
}

/// `FRAME` or `FRAME=X,Y,Z`.
fn point(reader: &mut Reader, text: &str) -> Option<(usize, [f64; 3])> {
    let (name, offset) = match text.split_once('=') {
        Some((name, offset)) => (name.trim(), Some(offset)),
        None => (text.trim(), None),
    };
    let frame = reader.frame(name);
    let offset = match offset {
        Some(offset) => reader.take("--at", value::triple(offset, Dimension::LENGTH)),
        None => Some([0.0; 3]),
    };
    frame.zip(offset)
}

/// `X,Y,Z` as unit vectors.
fn directions(reader: &mut Reader, texts: &[String]) -> Vec<[f64; 3]> {
    let mut found = Vec::new();
    for text in texts {
        let Some(d) = reader.take("--direction", value::triple(text, Dimension::NONE)) else {
            continue;
        };
        let length = d.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length > 0.0 && length.is_finite() {
            found.push(d.map(|x| x / length));
        } else {
            reader.complain(format!("`--direction {text}` points nowhere"));
        }
    }
    found
}

/// The joints that carry the point, and the point, in the plane as seen from it.
fn skeleton(
    posture: &mut Posture,
    frame: usize,
    offset: [f64; 3],
    world_from_frame: &Transform<f64>,
    [a, b]: [[f64; 3]; 2],
) -> Vec<[f64; 2]> {
    let tip = world_from_frame.point(Vec3(offset));
    let q = posture.q.clone();
    let links = posture.model.link_poses(&q);
    let mut spots = vec![tip];
    for link in posture.model.structure().chain(posture.model.mechanism().frames[frame].link) {
        let spot = links[link as usize].translation;
        let last = spots[spots.len() - 1];
        if (spot - last).norm_squared() > 1e-12 {
            spots.push(spot);
        }
    }
    let flat = |spot: Vec3<f64>| [a, b].map(|axis| (spot - tip).dot(Vec3(axis)));
    spots.into_iter().map(flat).collect()
}

fn notes(options: &StrengthOptions, limits: &[f64], names: &[&str]) -> Vec<String> {
    let first = limits.first().copied().unwrap_or(0.0);
    let mut notes = match limits.iter().all(|limit| *limit == first) {
        true => vec![format!("tension of every strand up to {first} N")],
        false => {
            let each = names.iter().zip(limits).map(|(name, limit)| format!("{name} {limit}"));
            vec![format!("tensions up to (N): {}", each.collect::<Vec<_>>().join(", "))]
        }
    };
    if options.off_axis == OffAxis::Free {
        notes.push("components across the direction are free".to_string());
    }
    notes
}

/// What the numbers do not say by themselves.
fn tell(rows: &[Row]) {
    if rows.iter().any(|row| row.found.force.is_infinite()) {
        eprintln!(
            "note: no end: the joints carry the force by themselves, no strand is needed for more"
        );
    }
    if rows.iter().all(|row| row.found.force.is_nan()) {
        eprintln!(
            "note: none: within these limits the pose cannot be held; `handc pose --hold` tells why"
        );
    }
}

fn with_suffix(stem: &Path, suffix: &str) -> PathBuf {
    let mut name = stem.as_os_str().to_os_string();
    name.push(suffix);
    PathBuf::from(name)
}

fn write_text(path: &Path, text: &str) -> Result<(), u8> {
    std::fs::write(path, text).map_err(|error| {
        eprintln!("error: cannot write `{}`: {error}", path.display());
        3
    })?;
    eprintln!("wrote {}", path.display());
    Ok(())
}

fn write(picture: &dyn Picture, stem: &Path) -> Result<(), u8> {
    let paths = save(picture, stem).map_err(|message| {
        eprintln!("error: {message}");
        3
    })?;
    paths.iter().for_each(|path| eprintln!("wrote {}", path.display()));
    Ok(())
}
