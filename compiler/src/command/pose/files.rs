//! The answer as files: two tables in SI units, and a picture.

use super::answer::Answer;
use crate::command::plot::skeleton::{State, poses};
use crate::command::posture::Posture;
use handc_core::model::Model as _;
use handc_core::trajectory::push_number;
use handc_dsl::hir;
use handc_plot::save;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// `coordinate,pose,value`.
pub(super) fn coordinates(posture: &Posture, answer: &Answer) -> String {
    let mut text = String::from("coordinate,pose,value\n");
    let names = posture.model.layout().coordinates.iter().map(|c| c.name.as_str());
    for (name, (pose, value)) in names.zip(posture.q.iter().zip(&answer.q)) {
        text.push_str(name);
        for number in [pose, value] {
            text.push(',');
            push_number(&mut text, *number);
        }
        text.push('\n');
    }
    text
}

/// `strand,length,natural_length,tension`, then the moment arm about every coordinate.
pub(super) fn strands(posture: &Posture, answer: &Answer) -> String {
    let layout = posture.model.layout();
    let mut text = String::from("strand,length,natural_length,tension");
    for coordinate in &layout.coordinates {
        // Writing to a string cannot fail.
        let _ = write!(text, ",moment_arm.{}", coordinate.name);
    }
    text.push('\n');
    let n = layout.coordinates.len();
    for (s, strand) in layout.strands.iter().enumerate() {
        text.push_str(&strand.name);
        let own = [answer.lengths[s], answer.rest[s], answer.tensions[s]];
        for number in own.iter().chain(&answer.arms[s * n..(s + 1) * n]) {
            text.push(',');
            push_number(&mut text, *number);
        }
        text.push('\n');
    }
    text
}

/// Writes the tables and a picture of the states, with the loads as arrows.
pub(super) fn write(
    posture: &mut Posture,
    answer: &Answer,
    model: &hir::Model,
    states: &[State],
    title: String,
    stem: &Path,
) -> Result<(), String> {
    let with = |suffix: &str| {
        let mut name = stem.as_os_str().to_os_string();
        name.push(suffix);
        PathBuf::from(name)
    };
    let tables = [
        (with(".coordinates.csv"), coordinates(posture, answer)),
        (with(".strands.csv"), strands(posture, answer)),
    ];
    for (path, text) in tables {
        std::fs::write(&path, text)
            .map_err(|error| format!("cannot write `{}`: {error}", path.display()))?;
        eprintln!("wrote {}", path.display());
    }
    let mut figure = poses(&mut posture.model, model, states, title);
    for (pose, state) in figure.poses.iter_mut().zip(states) {
        let frames = posture.model.frame_poses(&state.q);
        let force =
            |load: &crate::command::posture::Load| (frames[load.frame].translation.0, load.force);
        pose.forces = posture.loads.iter().map(force).collect();
    }
    let paths = save(&figure, stem)?;
    paths.iter().for_each(|path| eprintln!("wrote {}", path.display()));
    Ok(())
}
