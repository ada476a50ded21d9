//! `handc atlas`: length, moment arm and tension of strands over the ranges of joints.
//!
//! A moment arm is the derivative of the length by the joint: what An, Takahashi, Harrigan and Chao
//! measure as tendon excursion (Determination of muscle orientations and moment arms, J. Biomech.
//! Eng. 106:280-282, 1984). Positive means that a positive turn stretches the strand.

mod figure;
mod sweep;
mod table;

use super::posture::names::Reader;
use super::posture::{self, Posture, PostureOptions, edit, value};
use handc_core::model::Model as _;
use handc_plot::{Picture, save};
use handc_runtime::mechanism::{Law, Mechanism};
use std::path::{Path, PathBuf};
use sweep::Sweep;

/// Options of an atlas.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AtlasOptions {
    /// Model and pose.
    pub posture: PostureOptions,
    /// `JOINT` or `JOINT=LO:HI`; empty: all that have limits.
    pub joints: Vec<String>,
    /// Strands by name; empty: all that the joints move.
    pub strands: Vec<String>,
    /// Two joints that are swept together.
    pub grid: Option<[String; 2]>,
    /// Values over each range.
    pub points: usize,
    /// Where files go, without extension; `None`: beside the model, `.atlas` after its name.
    pub out: Option<PathBuf>,
}

/// Tabulates and draws the strands of a model.
pub fn atlas(options: &AtlasOptions) -> u8 {
    run(options).map_or_else(|code| code, |()| 0)
}

fn run(options: &AtlasOptions) -> Result<(), u8> {
    let mechanism = posture::mechanism(&options.posture)?;
    let mut reader = Reader::new(&mechanism);
    // What is prescribed would hold the joints that are swept: such strands are only measured.
    let mut measured = mechanism.clone();
    let prescribed: Vec<usize> = (0..mechanism.strands.len())
        .filter(|&s| mechanism.strands[s].law == Law::Prescribed)
        .collect();
    prescribed.iter().for_each(|&s| edit::without_force(&mut measured, s));
    let settled = posture::settle(&mut reader, measured, &options.posture);
    let settled = settled.map_err(|error| posture::fail(&error))?;
    let limits = settled.as_ref().map(|posture| posture::limits(&posture.model));
    let ranges = ranges(&mut reader, options, limits.as_deref());
    let chosen: Vec<usize> =
        options.strands.iter().filter_map(|name| reader.strand(name)).collect();
    if mechanism.strands.is_empty() {
        reader.complain(format!("`{}` has no strands", mechanism.name));
    }
    if options.points < 2 {
        reader.complain("`--points`: a range needs at least 2".to_string());
    }
    posture::complain(&reader)?;
    let Some(mut posture) = settled else { return Err(2) };
    if !prescribed.is_empty() {
        let names = prescribed.iter().map(|&s| format!("`{}`", mechanism.strands[s].name));
        eprintln!(
            "note: {} of prescribed length: measured only, tension 0",
            names.collect::<Vec<_>>().join(", ")
        );
    }
    let stem = options.out.clone().unwrap_or_else(|| options.posture.file.with_extension("atlas"));
    match ranges.as_slice() {
        [first, second] if options.grid.is_some() => {
            let values = [first, second].map(|(_, range)| sweep::values(*range, options.points));
            let joints = [first.0, second.0];
            let sweep = sweep::grid(&mut posture, joints, [&values[0], &values[1]], &chosen);
            tell(&mechanism, &sweep);
            write(&with_suffix(&stem, ".csv"), &table::grid(&mechanism, &sweep))?;
            let [a, b] = joints.map(|c| mechanism.coordinates[c].name.as_str());
            let title = format!("{}: moment arms over {a} and {b}", head(&mechanism, options));
            match sweep.strands.is_empty() {
                true => Ok(()),
                false => draw(&figure::map(&mechanism, &posture, title, &sweep), &stem),
            }
        }
        _ => {
            let sweeps: Vec<Sweep> = ranges
                .iter()
                .map(|(c, range)| {
                    let values = sweep::values(*range, options.points);
                    sweep::line(&mut posture, *c, &values, &chosen)
                })
                .collect();
            lines(&mechanism, &mut posture, options, &stem, &sweeps)
        }
    }
}

/// Writes the table and the pictures of single sweeps.
fn lines(
    mechanism: &Mechanism,
    posture: &mut Posture,
    options: &AtlasOptions,
    stem: &Path,
    sweeps: &[Sweep],
) -> Result<(), u8> {
    sweeps.iter().for_each(|sweep| tell(mechanism, sweep));
    for sweep in sweeps.iter().filter(|sweep| sweep.strands.is_empty()) {
        let joint = &mechanism.coordinates[sweep.coordinates[0]].name;
        eprintln!("note: no strand changes its length with `{joint}`");
    }
    write(&with_suffix(stem, ".csv"), &table::lines(mechanism, sweeps))?;
    let mut lengths = vec![0.0; mechanism.strands.len()];
    let q = posture.q.clone();
    posture.model.strand_lengths(&q, &mut lengths);
    let title = format!("{}: strands over each joint", head(mechanism, options));
    let drawn: Vec<Sweep> =
        sweeps.iter().filter(|sweep| !sweep.strands.is_empty()).cloned().collect();
    if drawn.is_empty() {
        return Ok(());
    }
    for figure in figure::figures(mechanism, posture, &lengths, &title, &drawn) {
        let stem = with_suffix(stem, &figure.suffix);
        draw(&figure.plot, &stem)?;
    }
    Ok(())
}

/// The model and its pose.
fn head(mechanism: &Mechanism, options: &AtlasOptions) -> String {
    let pose = options.posture.pose.as_ref().map_or(String::new(), |pose| format!(", pose {pose}"));
    format!("{}{pose}", mechanism.name)
}

fn draw(picture: &dyn Picture, stem: &Path) -> Result<(), u8> {
    let paths = save(picture, stem).map_err(|message| {
        eprintln!("error: {message}");
        3
    })?;
    paths.iter().for_each(|path| eprintln!("wrote {}", path.display()));
    Ok(())
}

/// The coordinates to sweep and their ranges.
fn ranges(
    reader: &mut Reader,
    options: &AtlasOptions,
    limits: Option<&[Option<[f64; 2]>]>,
) -> Vec<(usize, [f64; 2])> {
    let limit = |c: usize| limits.and_then(|limits| limits[c]);
    let mut asked: Vec<(usize, Option<[f64; 2]>)> = Vec::new();
    for text in &options.joints {
        let (name, range) = match text.split_once('=') {
            Some((name, range)) => (name.trim(), Some(range)),
            None => (text.trim(), None),
        };
        let Some(c) = reader.coordinate(name) else { continue };
        let range = range.map(|range| parse_range(reader, c, text, range));
        if asked.iter().any(|(other, _)| *other == c) {
            reader.complain(format!("`--joint` is given twice for `{name}`"));
        } else if range != Some(None) {
            asked.push((c, range.flatten()));
        }
    }
    let wanted: Vec<usize> = match &options.grid {
        Some(names) => {
            let found: Vec<usize> =
                names.iter().filter_map(|name| reader.coordinate(name)).collect();
            if let [a, b] = found[..]
                && a == b
            {
                reader.complain(format!("`--grid` needs two joints, not `{}` twice", names[0]));
            }
            found
        }
        None if options.joints.is_empty() => {
            (0..reader.mechanism.coordinates.len()).filter(|&c| limit(c).is_some()).collect()
        }
        None => asked.iter().map(|(c, _)| *c).collect(),
    };
    if limits.is_none() {
        return Vec::new();
    }
    let is_right = reader.complaints.is_empty() && !reader.mechanism.strands.is_empty();
    if wanted.is_empty() && is_right {
        reader.complain(
            "no joint of the model has limits: give ranges with `--joint JOINT=LO:HI`".to_string(),
        );
    }
    let mut found = Vec::new();
    for c in wanted {
        let given = asked.iter().find(|(other, _)| *other == c).and_then(|(_, range)| *range);
        match given.or(limit(c)) {
            Some(range) => found.push((c, range)),
            None => {
                let name = &reader.mechanism.coordinates[c].name;
                let message =
                    format!("`{name}` has no limits: give its range with `--joint {name}=LO:HI`");
                reader.complain(message);
            }
        }
    }
    found
}

/// `LO:HI`, the lower one first.
fn parse_range(reader: &mut Reader, c: usize, text: &str, range: &str) -> Option<[f64; 2]> {
    let dimension = reader.dimension(c);
    let Some((low, high)) = range.split_once(':') else {
        reader.complain(format!("`--joint {text}`: a range is LO:HI, as in `-60deg:20deg`"));
        return None;
    };
    let low = reader.take("--joint", value::number(low, dimension));
    let high = reader.take("--joint", value::number(high, dimension));
    let (low, high) = low.zip(high)?;
    if low < high {
        return Some([low, high]);
    }
    reader.complain(format!(
        "`--joint {text}`: the range is reversed or empty; write the lower end first"
    ));
    None
}

/// Says where the constraints do not close.
fn tell(mechanism: &Mechanism, sweep: &Sweep) {
    let open = sweep.instants.iter().filter(|(_, instant)| instant.is_none()).count();
    if open > 0 {
        let names: Vec<String> = sweep
            .coordinates
            .iter()
            .map(|&c| format!("`{}`", mechanism.coordinates[c].name))
            .collect();
        eprintln!(
            "note: the constraints do not close at {open} of {} values of {}: they are left out",
            sweep.instants.len(),
            names.join(" and ")
        );
    }
}

fn with_suffix(stem: &Path, suffix: &str) -> PathBuf {
    let mut name = stem.as_os_str().to_os_string();
    name.push(suffix);
    PathBuf::from(name)
}

fn write(path: &Path, text: &str) -> Result<(), u8> {
    std::fs::write(path, text).map_err(|error| {
        eprintln!("error: cannot write `{}`: {error}", path.display());
        3
    })?;
    eprintln!("wrote {}", path.display());
    Ok(())
}
