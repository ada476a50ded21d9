//! Random mechanisms as model text: trees of every joint, loops closed by every constraint,
//! strands, springs, drives, inputs, forces, motions and records.
//!
//! Text goes through the whole language, so checker and lowering are exercised as well. A model is
//! drafted as a tree (`tree`), then what acts on it is added (`load`); loops are closed where
//! its points are at the start (`closure`), and scenarios come last (`scenario`).

mod closure;
mod draft;
mod expression;
mod load;
mod scenario;
mod tree;

use crate::chance::Chance;
use draft::Draft;

/// The text of a random model, the same for the same seed; `None` if its loops do not close.
pub fn model(name: &str, seed: u64) -> Option<String> {
    let mut draft = Draft::new(name, Chance::new(seed));
    tree::tree(&mut draft);
    load::strands(&mut draft);
    load::nodes(&mut draft);
    load::inputs(&mut draft);
    load::loads(&mut draft);
    if draft.chance.is(0.5) {
        closure::close(&mut draft)?;
    }
    scenario::scenarios(&mut draft);
    Some(draft.text())
}
