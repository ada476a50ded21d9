//! Where the model comes to rest with what it is given.

use super::answer::Answer;
use super::report::{self, Table};
use crate::command::posture::Posture;
use handc_core::model::Model as _;
use handc_runtime::analysis::equilibrium::{EquilibriumError, equilibrium};
use std::fmt::Write;

/// A rest and how it was found.
pub(super) struct Forward {
    pub(super) answer: Answer,
    pub(super) steps: usize,
    pub(super) left: usize,
}

/// Searches the rest from the posture.
pub(super) fn forward(
    posture: &mut Posture,
    frames: &[usize],
) -> Result<Forward, EquilibriumError> {
    let (q, given) = (posture.q.clone(), posture.clone());
    let found = equilibrium(&mut posture.model, &q, &given.held())?;
    let answer = Answer::of(posture, &found.q, found.tangent, frames);
    Ok(Forward { answer, steps: found.steps, left: found.left })
}

/// All that is said of it.
pub(super) fn text(posture: &Posture, found: &Forward, limits: &[Option<[f64; 2]>]) -> String {
    let answer = &found.answer;
    let layout = posture.model.layout();
    let mut table = Table::new(&["coordinate", "pose", "at rest", "change"]);
    for (i, coordinate) in layout.coordinates.iter().enumerate() {
        let mut cells = vec![
            coordinate.name.clone(),
            report::value(posture, i, posture.q[i]),
            report::value(posture, i, answer.q[i]),
        ];
        cells.push(match posture.driven[i] {
            true => "held".to_string(),
            false => report::value(posture, i, answer.q[i] - posture.q[i]),
        });
        table.row(cells);
    }
    let mut text = table.text();
    text.push('\n');
    let strands = report::strands(posture, answer);
    if !strands.is_empty() {
        let _ = writeln!(text, "{strands}");
    }
    text.push_str(&report::stiffness(posture, answer));
    text.push_str(&report::reach(posture, answer));
    if found.left > 0 {
        let _ = writeln!(
            text,
            "note: the search came through {} that {} not stable, and left {}",
            crate::command::count(found.left, "rest"),
            if found.left == 1 { "is" } else { "are" },
            if found.left == 1 { "it" } else { "them" }
        );
    }
    for (i, limits) in limits.iter().enumerate() {
        let Some(limits) = limits else { continue };
        let is_elastic = posture.model.mechanism().coordinates[i].limit_stiffness;
        if !crate::command::posture::names::within(answer.q[i], *limits) && is_elastic.is_zero() {
            let _ = writeln!(
                text,
                "note: `{}` rests outside its limits, which are a range only: `limit_stiffness` \
                 makes them hold",
                layout.coordinates[i].name
            );
        }
    }
    for (strand, tension) in layout.strands.iter().zip(&answer.tensions) {
        if *tension < -1e-9 {
            let _ = writeln!(text, "note: `{}` pushes with {:.4} N", strand.name, -tension);
        }
    }
    text
}
