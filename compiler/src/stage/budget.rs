//! Straight lines or loops over tables.
//!
//! Straight lines know every constant and every zero, and are the fastest code as long as they are few. In
//! a chain each link moves with all before it, so their number grows with the square of its length, and
//! the time to build them with it. Groups of functions are therefore admitted one after another, what
//! steps ask for first, as long as the budget lasts; the others are left to the mechanics over the
//! mechanism as constant data, whose text grows as the model does.

use super::{Module, Task};
use crate::graph::{Node, node, reachable};
use std::collections::BTreeSet;
use std::fmt;

/// Operations that a crate may hold as straight lines, if nothing else is asked for: about half a
/// minute of building on two cores.
pub const DEFAULT_BUDGET: usize = 30_000;

/// How much longer the equations may be before like parts are merged and equal operations found.
const HOPE: usize = 10;

/// Functions that are either all straight lines or all loops over tables, in order of their claim on the
/// budget.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Group {
    /// Momentum, force, matrices and lengths of strands.
    Equations,
    /// Rows of constraints and their derivatives.
    Constraints,
    /// Linear systems of constrained blocks; without equations there are none.
    Systems,
    /// Commands to strands, and whether they can pass their surfaces.
    Strands,
    /// Start, inputs, natural lengths and drives of the model itself, and numbers that must be in range.
    Time,
    /// Inputs, drives and records of scenarios.
    Scenarios,
    /// Potential energy.
    Energy,
    /// Moment arms.
    MomentArms,
    /// Poses of named frames.
    Frames,
}

impl Group {
    const ALL: [Group; 9] = [
        Group::Equations,
        Group::Constraints,
        Group::Systems,
        Group::Strands,
        Group::Time,
        Group::Scenarios,
        Group::Energy,
        Group::MomentArms,
        Group::Frames,
    ];

    /// The group of a task; `None` for what follows from parameters, which goes with its readers.
    fn of(task: &Task) -> Option<Group> {
        Some(match (task.module, task.name) {
            (Module::Part(_), _) | (Module::Strands, "lengths") => Group::Equations,
            (Module::Strands, "moment_arms") => Group::MomentArms,
            (Module::Strands, _) => Group::Strands,
            (Module::Constraints, _) => Group::Constraints,
            (Module::System(_), _) => Group::Systems,
            (Module::Energy, _) => Group::Energy,
            (Module::Frames, _) => Group::Frames,
            (Module::Time, _) => Group::Time,
            (Module::Scenario(_), _) => Group::Scenarios,
            (Module::Values, _) => return None,
        })
    }
}

impl fmt::Display for Group {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str(match self {
            Group::Equations => "step equations",
            Group::Constraints => "constraints",
            Group::Systems => "linear systems",
            Group::Strands => "strands",
            Group::Time => "functions of time",
            Group::Scenarios => "scenarios",
            Group::Energy => "energy",
            Group::MomentArms => "moment arms",
            Group::Frames => "frames",
        })
    }
}

/// Whether equations of so many operations, before equal ones are found, are hopeless.
pub(super) fn is_hopeless(operations: usize, budget: usize) -> bool {
    operations > budget.saturating_mul(HOPE)
}

/// Removes the tasks that the budget does not admit and returns their groups. `without` are groups that
/// have not been staged.
pub(super) fn spend(
    tasks: &mut Vec<Task>,
    budget: usize,
    without: BTreeSet<Group>,
) -> BTreeSet<Group> {
    let mut tables = without;
    let mut left = budget;
    for group in Group::ALL {
        let of = |task: &&Task| Group::of(task) == Some(group);
        let cost: usize = tasks.iter().filter(of).map(cost).sum();
        let is_idle = group == Group::Systems && tables.contains(&Group::Equations);
        if cost > left || (is_idle && cost > 0) {
            tables.insert(group);
        } else {
            left -= cost;
        }
    }
    tasks.retain(|task| Group::of(task).is_none_or(|group| !tables.contains(&group)));
    tables
}

/// Operations of a function and results that it writes.
fn cost(task: &Task) -> usize {
    let roots: Vec<_> = task.outputs.iter().map(|output| output.value).collect();
    let is_work =
        |&symbol: &crate::graph::Sym| !matches!(node(symbol), Node::Constant(_) | Node::Leaf(_));
    reachable(&roots).into_iter().filter(is_work).count() + roots.len()
}
