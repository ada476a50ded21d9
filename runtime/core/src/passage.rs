//! Which strand cannot pass its surface or is to push, and why: asked when a run cannot begin or a step
//! fails.
//!
//! A point inside a surface leaves the strand's length without a value, and a command below zero its
//! tension, so that a step there fails by itself; this finds the strand to name.

use crate::model::{Midpoint, Model};

/// Numbers that a model tells of each surface ([`Model::clearances`]).
pub const CLEARANCES: usize = 4;

/// A strand that cannot pass its surface.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Blocked {
    /// Which strand, which surface, and why.
    pub(crate) what: String,
    /// What to try.
    pub(crate) hint: &'static str,
}

/// The strand that is commanded to push most; `None` if every one pulls.
pub(crate) fn pushing<M: Model>(model: &mut M, at: &Midpoint) -> Option<Blocked> {
    let mut tensions = vec![0.0; model.layout().strands.len()];
    model.commands(at, &mut tensions);
    let pushes = tensions.iter().copied().enumerate().filter(|(_, tension)| *tension < 0.0);
    let (strand, tension) = pushes.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let name = &model.layout().strands[strand].name;
    Some(Blocked {
        what: format!("strand `{name}` is commanded a tension of {tension:.3e} N: it cannot push"),
        hint: "a command that stays above zero, such as `max(0 N, …)`",
    })
}

/// The surface that is worst at q; `None` if all can be passed.
pub(crate) fn blocked<M: Model>(model: &mut M, q: &[f64]) -> Option<Blocked> {
    let layout = model.layout().clone();
    if layout.wraps.is_empty() {
        return None;
    }
    let mut clearances = vec![0.0; CLEARANCES * layout.wraps.len()];
    model.clearances(q, &mut clearances);
    let wraps = layout.wraps.iter().zip(clearances.chunks(CLEARANCES));
    let faults = wraps.filter_map(|(wrap, found)| Some((wrap, worst(found)?)));
    let (wrap, (fault, by)) = faults.reduce(|a, b| if b.1.1 < a.1.1 { b } else { a })?;
    let strand = &layout.strands[wrap.strand].name;
    let inside = "a smaller radius, path points further off, or joint limits with `limit_stiffness` \
                  that keep them out";
    let (why, hint) = match fault {
        Fault::Before => (format!("the point before it is {:.3e} m inside", -by), inside),
        Fault::Behind => (format!("the point behind it is {:.3e} m inside", -by), inside),
        Fault::Opposite => (
            "the points before and behind it are opposite each other, so that no way round is the \
             shortest"
                .to_string(),
            "a cylinder, whose axis tells the way round, or a path point beside the sphere",
        ),
        Fault::Around => (
            "the points before and behind it have come so far round from where the model starts that \
             the strand would jump to the other side"
                .to_string(),
            "a start nearer to the middle of the motion; over a sphere `side` serves motions in one \
             plane alone",
        ),
        Fault::NotANumber => (
            "its radius is negative, or a place is not a number".to_string(),
            "parameters within their range",
        ),
    };
    let what = format!("strand `{strand}` cannot pass the {}: {why}", wrap.surface);
    Some(Blocked { what, hint })
}

/// What is wrong at a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    /// The point before the surface is inside.
    Before,
    /// The point behind it is.
    Behind,
    /// Both are opposite each other on a sphere.
    Opposite,
    /// Both have come too far round.
    Around,
    /// Something is not a number, or the radius is negative.
    NotANumber,
}

/// The worst of a surface's numbers, if it is bad.
fn worst(found: &[f64]) -> Option<(Fault, f64)> {
    if found.iter().any(|x| x.is_nan()) {
        return Some((Fault::NotANumber, f64::NEG_INFINITY));
    }
    let faults = [Fault::Before, Fault::Behind, Fault::Opposite, Fault::Around];
    let bad = faults.into_iter().zip(found.iter().copied()).filter(|fault| fault.1 < 0.0);
    bad.reduce(|a, b| if b.1 < a.1 { b } else { a })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_fault_is_told() {
        assert_eq!(worst(&[0.1, 0.2, 0.3, 1.0]), None);
        assert_eq!(worst(&[0.1, -0.2, 0.3, 1.0]), Some((Fault::Behind, -0.2)));
        assert_eq!(worst(&[-0.3, -0.2, 0.0, 1.0]), Some((Fault::Before, -0.3)));
        assert_eq!(worst(&[0.3, 0.2, -1e-9, 1.0]), Some((Fault::Opposite, -1e-9)));
        assert_eq!(worst(&[0.3, 0.2, 0.1, -2.0]), Some((Fault::Around, -2.0)));
        assert_eq!(worst(&[f64::NAN, 0.2, 1.0, 1.0]).map(|f| f.0), Some(Fault::NotANumber));
    }
}
