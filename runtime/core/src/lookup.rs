//! Scenarios and parameters by name, and what to say of names that are not there.

use crate::error::RunError;
use crate::layout::Layout;
use crate::suggest::nearest;

/// Most names listed where none was meant.
const LISTED: usize = 12;

/// Index of the scenario that is meant: `None` where the model has none.
pub(crate) fn find_scenario(
    layout: &Layout,
    wanted: Option<&str>,
) -> Result<Option<usize>, RunError> {
    let names = || layout.scenarios.iter().map(|s| s.name.as_str());
    match (wanted, layout.scenarios.len()) {
        (None, 0) => Ok(None),
        (None, 1) => Ok(Some(0)),
        (None, _) => Err(RunError::Usage(format!(
            "`{}` has several scenarios: choose one with `--scenario`: {}",
            layout.name,
            list(names())
        ))),
        (Some(name), _) => find_name(&layout.name, "scenario", name, names()).map(Some),
    }
}

/// Index of a parameter by name.
pub fn find_param(layout: &Layout, name: &str) -> Result<usize, RunError> {
    find_name(&layout.name, "parameter", name, layout.params.iter().map(|p| p.name.as_str()))
}

/// Index of a coordinate by name.
pub fn find_coordinate(layout: &Layout, name: &str) -> Result<usize, RunError> {
    let known = layout.coordinates.iter().map(|c| c.name.as_str());
    find_name(&layout.name, "coordinate", name, known)
}

/// Index of a name among the known ones of a model; the error suggests the one that may be meant.
pub fn find_name<'a>(
    model: &str,
    kind: &str,
    name: &str,
    known: impl Iterator<Item = &'a str> + Clone,
) -> Result<usize, RunError> {
    known.clone().position(|n| n == name).ok_or_else(|| unknown(model, kind, name, known))
}

fn unknown<'a>(
    model: &str,
    kind: &str,
    name: &str,
    known: impl Iterator<Item = &'a str> + Clone,
) -> RunError {
    let hint = match nearest(name, known.clone()) {
        Some(near) => format!("did you mean `{near}`?"),
        None => match list(known) {
            listed if listed.is_empty() => "it has none".to_string(),
            listed => format!("it has {listed}"),
        },
    };
    RunError::Usage(format!("`{model}` has no {kind} `{name}`: {hint}"))
}

/// `` `a`, `b` ``, and an end where there are too many.
fn list<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let mut names = names.map(|name| format!("`{name}`"));
    let mut shown: Vec<String> = names.by_ref().take(LISTED).collect();
    if names.next().is_some() {
        shown.push("...".to_string());
    }
    shown.join(", ")
}
