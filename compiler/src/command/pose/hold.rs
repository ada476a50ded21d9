//! Tensions and natural lengths that hold the pose, or why there are none.

use super::answer::Answer;
use super::report::{self, Table};
use crate::command::posture::{Posture, edit};
use crate::statics::balance::Balance;
use crate::statics::hold::{Hold, hold as least};
use crate::statics::natural::natural_length;
use handc_core::model::Model as _;
use handc_runtime::analysis::tangent::Tangent;
use handc_runtime::mechanism::{Law, Mechanism};
use std::fmt::Write;

/// A part of the largest force below which nothing is missing.
const NOTHING: f64 = 1e-7;

/// Strands that are pulled, and how much each bears.
#[derive(Clone, Debug)]
pub(super) struct Pulled {
    /// Strands by index.
    pub(super) strands: Vec<usize>,
    /// Largest tension of each (N).
    pub(super) limits: Vec<f64>,
}

/// What came of it.
pub(super) enum Held {
    /// The pose is held, with the answer for the model as it is then, and strands that cannot have
    /// their tension by any natural length.
    Yes { hold: Hold, answer: Box<Answer>, too_soft: Vec<usize> },
    /// It is not.
    No { hold: Hold, balance: Box<Balance> },
}

/// Finds tensions of a posture whose model lets the pulled strands make no force; `whole` is the
/// mechanism in which they do.
pub(super) fn hold(
    posture: &mut Posture,
    whole: Mechanism,
    pulled: &Pulled,
    frames: &[usize],
) -> Result<Held, String> {
    let (q, given) = (posture.q.clone(), posture.clone());
    let not_finite = || "forces at the pose are not finite".to_string();
    let balance = Balance::at(&mut posture.model, &q, &given.held(), &pulled.strands)
        .ok_or_else(not_finite)?;
    let hold = least(&balance, &pulled.limits)?;
    if hold.miss.is_some() {
        return Ok(Held::No { hold, balance: Box::new(balance) });
    }
    let mut whole = whole;
    let pulls = pulled.strands.iter().zip(&hold.tensions);
    for (&strand, &tension) in pulls.clone() {
        if matches!(whole.strands[strand].law, Law::Tension(_) | Law::Muscle(_)) {
            edit::commanded(&mut whole, strand, tension);
        }
    }
    posture.exchange(whole);
    let mut lengths = vec![0.0; posture.rest.len()];
    posture.model.strand_lengths(&q, &mut lengths);
    let mut too_soft = Vec::new();
    let mechanism = posture.model.mechanism().clone();
    for (&strand, &wanted) in pulls {
        let natural = match mechanism.strands[strand].law {
            Law::Tension(_) | Law::Muscle(_) => continue,
            Law::Prescribed => Some(lengths[strand]),
            Law::Linear { .. } | Law::Energy(_) => {
                let mut rest = posture.rest.clone();
                natural_length(lengths[strand], wanted, |natural| {
                    rest[strand] = natural;
                    posture.tensions(&q, &rest)[strand]
                })
            }
        };
        match natural {
            Some(natural) => posture.rest[strand] = natural,
            None => too_soft.push(strand),
        }
    }
    let given = posture.clone();
    let tangent = Tangent::at(&mut posture.model, &q, &given.held()).ok_or_else(not_finite)?;
    let answer = Box::new(Answer::of(posture, &q, tangent, frames));
    Ok(Held::Yes { hold, answer, too_soft })
}

/// The tensions and what they make of the pose.
pub(super) fn text(
    posture: &Posture,
    pulled: &Pulled,
    hold: &Hold,
    answer: &Answer,
    too_soft: &[usize],
) -> String {
    let layout = posture.model.layout();
    let mut table = Table::new(&["strand", "tension", "<limit", "length", "natural length"]);
    for (s, strand) in layout.strands.iter().enumerate() {
        let place = pulled.strands.iter().position(|&other| other == s);
        let tension = place.map_or(answer.tensions[s], |k| hold.tensions[k]);
        let limit = match place {
            None => "passive".to_string(),
            Some(k) if hold.at_limit[k] => format!("{} N, reached", pulled.limits[k]),
            Some(k) if pulled.limits[k].is_finite() => format!("{} N", pulled.limits[k]),
            Some(_) => "none".to_string(),
        };
        table.row(vec![
            strand.name.clone(),
            format!("{} N", report::fixed(tension, 4)),
            limit,
            format!("{:.3} mm", answer.lengths[s] * 1e3),
            match posture.model.mechanism().strands[s].law {
                Law::Tension(_) => "commanded".to_string(),
                _ if too_soft.contains(&s) => "none".to_string(),
                _ => format!("{:.3} mm", answer.rest[s] * 1e3),
            },
        ]);
    }
    let mut text = table.text();
    text.push('\n');
    if too_soft.is_empty() {
        text.push_str(&report::stiffness(posture, answer));
        text.push_str(&report::reach(posture, answer));
    }
    for &s in too_soft {
        let name = &layout.strands[s].name;
        let _ = writeln!(
            text,
            "note: no natural length gives `{name}` this tension: it is too soft and would stretch \
             by more than its length"
        );
    }
    text
}

/// What is missing, joint by joint, and why.
pub(super) fn missing(
    posture: &mut Posture,
    pulled: &Pulled,
    hold: &Hold,
    balance: &Balance,
) -> String {
    let miss = hold.miss.clone().unwrap_or_default();
    let n = posture.q.len();
    let mut arms = vec![0.0; posture.rest.len() * n];
    let q = posture.q.clone();
    posture.model.moment_arms(&q, &mut arms);
    let layout = posture.model.layout().clone();
    let needed = balance.by_coordinate(&balance.force.iter().map(|f| -f).collect::<Vec<_>>());
    let left = balance.by_coordinate(&miss);
    let largest = needed.iter().chain(&left).fold(0.0, |a: f64, x| a.max(x.abs()));
    let mut idle = 0;
    let mut table = Table::new(&["coordinate", "needed", "reached", "missing", "<why"]);
    for (i, coordinate) in layout.coordinates.iter().enumerate() {
        let missing = -left[i];
        if needed[i].abs().max(missing.abs()) <= NOTHING * largest {
            idle += 1;
            continue;
        }
        let why = match missing.abs() > NOTHING * largest {
            false => String::new(),
            true => {
                let turns = |k: usize| -arms[pulled.strands[k] * n + i] * missing > 1e-15;
                let able: Vec<usize> = (0..pulled.strands.len()).filter(|&k| turns(k)).collect();
                let name = |k: &usize| layout.strands[pulled.strands[*k]].name.as_str();
                let names: Vec<&str> = able.iter().map(name).collect();
                if able.is_empty() {
                    "no strand turns it that way".to_string()
                } else if able.iter().all(|&k| hold.at_limit[k]) {
                    format!("at their limit: {}", names.join(", "))
                } else {
                    format!("would turn others too: {}", names.join(", "))
                }
            }
        };
        table.row(vec![
            coordinate.name.clone(),
            report::force(posture, i, needed[i]),
            report::force(posture, i, needed[i] - missing),
            report::force(posture, i, missing),
            why,
        ]);
    }
    let mut text = table.text();
    if idle > 0 {
        let _ = writeln!(text, "  nothing is needed at {}", crate::command::count(idle, "other"));
    }
    let motion = report::shape(posture, &balance.motion(&miss));
    let _ = writeln!(text, "\nit gives way along {motion}: no strand below its limit resists that");
    let borne = pulled.strands.iter().zip(&hold.tensions).zip(&hold.at_limit);
    let borne: Vec<String> = borne
        .filter(|((_, tension), at_limit)| **tension > 1e-9 || **at_limit)
        .map(|((&s, tension), at_limit)| {
            let limit = if *at_limit { " (its limit)" } else { "" };
            format!("{} {} N{limit}", layout.strands[s].name, report::fixed(*tension, 4))
        })
        .collect();
    let borne = if borne.is_empty() { "none".to_string() } else { borne.join(", ") };
    let _ = write!(text, "nearest tensions: {borne}");
    text.push('\n');
    text
}
