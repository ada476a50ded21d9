//! `handc pose`: where a model comes to rest, and the other way round: what holds it in a pose.

mod answer;
mod files;
mod forward;
mod hold;
mod report;

use super::plot::skeleton::State;
use super::posture::names::Reader;
use super::posture::{self, Posture, PostureOptions, edit, value};
use handc_dsl::dimension::Dimension;
use handc_dsl::hir;
use handc_runtime::mechanism::Mechanism;
use hold::{Held, Pulled};
use std::path::PathBuf;

/// Options of a pose.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PoseOptions {
    /// Model, pose, natural lengths and loads.
    pub posture: PostureOptions,
    /// `STRAND=LENGTH`: natural lengths shortened.
    pub pull: Vec<String>,
    /// `STRAND=FORCE`: tensions instead of the strands' laws.
    pub tension: Vec<String>,
    /// Frames to tell about, beside those that are loaded.
    pub at: Vec<String>,
    /// Whether to find tensions that hold the pose, instead of the rest.
    pub hold: bool,
    /// `STRAND=FORCE`: largest tensions.
    pub limit: Vec<String>,
    /// The limit of all others.
    pub limit_all: Option<String>,
    /// Strands that pull by their own law.
    pub passive: Vec<String>,
    /// Where files go, without extension; `None`: none are written.
    pub out: Option<PathBuf>,
}

/// Prints the rest of a model, or what holds its pose.
pub fn pose(options: &PoseOptions) -> u8 {
    run(options).map_or_else(|code| code, |()| 0)
}

fn run(options: &PoseOptions) -> Result<(), u8> {
    let (model, mechanism) = posture::model(&options.posture)?;
    let mut reader = Reader::new(&mechanism);
    let passive: Vec<usize> =
        options.passive.iter().filter_map(|name| reader.strand(name)).collect();
    let pulls = pulls(&mut reader, options);
    let tensions = tensions(&mut reader, options);
    let pulled = pulled(&mut reader, options, &passive);
    let mut frames: Vec<usize> = options.at.iter().filter_map(|name| reader.frame(name)).collect();
    let mut edited = mechanism.clone();
    for (strand, tension) in &tensions {
        edit::commanded(&mut edited, *strand, *tension);
    }
    if options.hold {
        pulled.strands.iter().for_each(|&s| edit::without_force(&mut edited, s));
    }
    let settled = posture::settle(&mut reader, edited, &options.posture);
    let settled = settled.map_err(|error| posture::fail(&error))?;
    if let Some(posture) = &settled {
        for (strand, by) in &pulls {
            if posture.rest[*strand] - by < 0.0 {
                let name = &mechanism.strands[*strand].name;
                reader.complain(format!("`--pull`: the natural length of `{name}` is less"));
            }
        }
    }
    posture::complain(&reader)?;
    let Some(mut posture) = settled else { return Err(2) };
    pulls.iter().for_each(|(strand, by)| posture.rest[*strand] -= by);
    for load in &posture.loads {
        if !frames.contains(&load.frame) {
            frames.push(load.frame);
        }
    }
    if options.hold {
        held(options, &mechanism, &model, &mut posture, &pulled, &frames)
    } else {
        rest(options, &mechanism, &model, &mut posture, &frames)
    }
}

/// The way forward: the rest.
fn rest(
    options: &PoseOptions,
    mechanism: &Mechanism,
    model: &hir::Model,
    posture: &mut Posture,
    frames: &[usize],
) -> Result<(), u8> {
    let limits = posture::limits(&posture.model);
    let found = forward::forward(posture, frames).map_err(|error| {
        eprintln!("error: {error}");
        3
    })?;
    let head = head(options, mechanism, posture);
    let steps = super::count(found.steps, "step");
    let text = forward::text(posture, &found, &limits);
    super::print(&format!("{head} comes to rest ({steps})\n{text}"));
    let Some(stem) = &options.out else { return Ok(()) };
    let state = |q: &[f64], caption: &str| State {
        q: q.to_vec(),
        time: 0.0,
        caption: Some(caption.to_string()),
    };
    let name = options.posture.pose.as_deref().unwrap_or("start");
    let states = [state(&posture.q, name), state(&found.answer.q, "at rest")];
    let title = format!("{head} comes to rest");
    files::write(posture, &found.answer, model, &states, title, stem).map_err(|message| {
        eprintln!("error: {message}");
        3
    })
}

/// The way back: what holds the pose.
fn held(
    options: &PoseOptions,
    mechanism: &Mechanism,
    model: &hir::Model,
    posture: &mut Posture,
    pulled: &Pulled,
    frames: &[usize],
) -> Result<(), u8> {
    let head = head(options, mechanism, posture);
    let mut whole = mechanism.clone();
    posture.loads.iter().for_each(|load| edit::load(&mut whole, load));
    let found = hold::hold(posture, whole, pulled, frames).map_err(|message| {
        eprintln!("error: {message}");
        3
    })?;
    match found {
        Held::Yes { hold, answer, too_soft } => {
            let text = hold::text(posture, pulled, &hold, &answer, &too_soft);
            super::print(&format!("{head} is held\n{text}"));
            let Some(stem) = &options.out else { return Ok(()) };
            let caption = options.posture.pose.clone().unwrap_or_else(|| "start".to_string());
            let state = State { q: posture.q.clone(), time: 0.0, caption: Some(caption) };
            let title = format!("{head} is held");
            files::write(posture, &answer, model, &[state], title, stem).map_err(|message| {
                eprintln!("error: {message}");
                3
            })
        }
        Held::No { hold, balance } => {
            let text = hold::missing(posture, pulled, &hold, &balance);
            super::print(&format!("{head} cannot be held\n{text}"));
            Err(3)
        }
    }
}

/// The model, its pose and its loads, as the beginning of a sentence.
fn head(options: &PoseOptions, mechanism: &Mechanism, posture: &Posture) -> String {
    let mut head = mechanism.name.clone();
    if let Some(pose) = &options.posture.pose {
        head.push_str(&format!(", pose {pose}"));
    }
    for load in &posture.loads {
        let [x, y, z] = load.force.map(|f| f + 0.0);
        let name = &mechanism.frames[load.frame].name;
        head.push_str(&format!(", ({x}, {y}, {z}) N on {name}"));
    }
    if head != mechanism.name {
        head.push(',');
    }
    head
}

/// Natural lengths that are shortened.
fn pulls(reader: &mut Reader, options: &PoseOptions) -> Vec<(usize, f64)> {
    let pulls = reader.strand_values("--pull", &options.pull, Dimension::LENGTH);
    if options.hold && !options.pull.is_empty() {
        reader.complain(
            "`--pull` and `--hold` exclude each other: one gives natural lengths, the \
             other finds them"
                .to_string(),
        );
    }
    pulls
}

/// Tensions that are commanded.
fn tensions(reader: &mut Reader, options: &PoseOptions) -> Vec<(usize, f64)> {
    let tensions = reader.strand_values("--tension", &options.tension, Dimension::FORCE);
    let mut wrong = Vec::new();
    for (s, tension) in &tensions {
        let name = &reader.mechanism.strands[*s].name;
        if *tension < 0.0 {
            wrong.push(format!("`--tension`: `{name}` cannot push: {tension} N is negative"));
        }
        let names = |text: &String| text.split('=').next().is_some_and(|n| n.trim() == name);
        if options.posture.rest.iter().chain(&options.pull).any(names) {
            wrong.push(format!("`{name}` is given a tension and a natural length"));
        }
    }
    if options.hold && !options.tension.is_empty() {
        wrong.push(
            "`--tension` and `--hold` exclude each other: one gives tensions, the other \
             finds them"
                .to_string(),
        );
    }
    wrong.into_iter().for_each(|message| reader.complain(message));
    tensions
}

/// Strands that may be pulled, and their limits.
fn pulled(reader: &mut Reader, options: &PoseOptions, passive: &[usize]) -> Pulled {
    let given = reader.strand_values("--limit", &options.limit, Dimension::FORCE);
    let all = options
        .limit_all
        .as_ref()
        .and_then(|text| reader.take("--limit-all", value::number(text, Dimension::FORCE)));
    let mut wrong = Vec::new();
    let names = |s: usize| reader.mechanism.strands[s].name.clone();
    for (s, limit) in &given {
        if *limit < 0.0 {
            wrong.push(format!("`--limit`: `{}` cannot have the limit {limit} N", names(*s)));
        }
        if passive.contains(s) {
            wrong.push(format!("`{}` is given with `--limit` and with `--passive`", names(*s)));
        }
    }
    wrong.extend(all.filter(|limit| *limit < 0.0).map(|l| format!("`--limit-all` is {l} N")));
    let bounded = !given.is_empty() || all.is_some();
    if !options.hold && (bounded || !options.passive.is_empty()) {
        wrong.push("`--limit`, `--limit-all` and `--passive` need `--hold`".to_string());
    }
    let strands: Vec<usize> =
        (0..reader.mechanism.strands.len()).filter(|s| !passive.contains(s)).collect();
    let limit = |s: &usize| {
        let own = given.iter().find(|(other, _)| other == s).map(|(_, limit)| *limit);
        own.or(all).unwrap_or(f64::INFINITY)
    };
    let limits = strands.iter().map(limit).collect();
    wrong.into_iter().for_each(|message| reader.complain(message));
    Pulled { strands, limits }
}
