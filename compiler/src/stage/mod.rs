//! Staging: the mechanics run once on symbols, and what comes out sorted into functions.
//!
//! The compiler is the interpreter run on symbols. [`kernels`] runs the equations of motion part
//! by part, [`time`] the functions of time and the scenarios, [`hoist`] takes out what depends on
//! parameters alone so that it is computed when they change and not in every step. The result is a
//! list of [`Task`]s, each one function to be, in the module where a reader would look for it.

mod budget;
mod cost;
mod direct;
mod elimination;
mod harmony;
mod hoist;
mod kernels;
mod labels;
mod parts;
mod shapes;
mod symbols;
mod systems;
#[cfg(test)]
pub(crate) mod tests;
mod time;

use crate::emit::Output;
use crate::graph::{Leaf, Sym};
pub use budget::{DEFAULT_BUDGET, Group};
use handc_core::scalar::Scalar;
use handc_runtime::mechanism::Mechanism;
use handc_runtime::structure::Structure;
pub use parts::{Part, parts};
pub use shapes::{PartPlace, Shape, shared};
use std::collections::{BTreeSet, HashMap};
pub use symbols::Symbols;
pub use systems::System;

/// Where a function stands in the generated crate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Module {
    /// Momentum, force, matrices and strand lengths of like parts of blocks, by number of their shape.
    Part(usize),
    /// Lengths and moment arms.
    Strands,
    /// Rows and their derivatives.
    Constraints,
    /// The linear system of a constrained block, by number of the system.
    System(usize),
    /// Potential energy.
    Energy,
    /// Poses of named frames.
    Frames,
    /// Start, inputs, natural lengths and drives of the model itself.
    Time,
    /// Functions of one scenario, by number.
    Scenario(usize),
    /// Numbers that follow from parameters.
    Values,
}

/// A function to be emitted.
#[derive(Clone, Debug)]
pub struct Task {
    /// Its module.
    pub module: Module,
    /// Its name there.
    pub name: &'static str,
    /// What it computes, with formula and source lines.
    pub doc: Vec<String>,
    /// Its results.
    pub outputs: Vec<Output>,
}

/// Everything that a generated crate computes.
#[derive(Clone, Debug, Default)]
pub struct Staged {
    /// Functions in order of their modules; those without results are left out.
    pub tasks: Vec<Task>,
    /// Like parts of blocks.
    pub shapes: Vec<Shape>,
    /// Linear systems that are written out.
    pub systems: Vec<System>,
    /// What is left to loops over tables.
    pub tables: BTreeSet<Group>,
    /// How many numbers follow from parameters.
    pub values: usize,
    /// Numbers of each scenario that may depend on parameters, in the order of
    /// [`scenario_numbers`].
    pub scenario_numbers: Vec<Vec<crate::graph::Sym>>,
}

pub use time::scenario_numbers;

/// Runs the mechanics of `mechanism` on symbols of the current graph. What would take more than `budget`
/// operations is left to tables.
pub fn stage(mechanism: &Mechanism, structure: &Structure, budget: usize) -> Staged {
    let symbols = Symbols::new(mechanism, structure);
    labels::prepare(mechanism, &symbols);
    let is_hopeless = budget::is_hopeless(cost::operations(mechanism, structure), budget);
    let parts = (!is_hopeless).then(|| kernels::parts(&symbols));
    let of_model = kernels::tasks(&symbols);
    let mut without = BTreeSet::new();
    let (mut systems, mut shapes, mut tasks) = (Vec::new(), Vec::new(), Vec::new());
    if let Some(parts) = parts {
        let all: Vec<Task> = parts.iter().chain(&of_model).cloned().collect();
        let (own, of_systems) = systems::systems(structure, &all);
        (shapes, tasks) = like_parts(mechanism, &symbols, &parts);
        let solvers = direct::tasks(&shapes, &tasks);
        tasks.extend(solvers);
        tasks.extend(of_systems);
        systems = own;
    } else {
        without.insert(Group::Equations);
    }
    tasks.extend(of_model);
    tasks.extend(time::tasks(&symbols));
    let tables = budget::spend(&mut tasks, budget, without);
    if tables.contains(&Group::Equations) {
        shapes.clear();
    }
    if tables.contains(&Group::Systems) {
        systems.clear();
    }
    let mut scenario_numbers: Vec<Vec<_>> =
        mechanism.scenarios.iter().map(|s| time::numbers(&symbols, s)).collect();
    let constants = shapes.iter_mut().flat_map(|shape| &mut shape.constants);
    let values = hoist::hoist(&mut tasks, scenario_numbers.iter_mut().chain(constants).collect());
    tasks.retain(|task| !task.outputs.is_empty());
    tasks.sort_by_key(|task| task.module);
    Staged { tasks, shapes, systems, tables, values, scenario_numbers }
}

/// The equations of all parts of blocks, like ones merged.
fn like_parts(mechanism: &Mechanism, symbols: &Symbols, tasks: &[Task]) -> (Vec<Shape>, Vec<Task>) {
    let structure = symbols.structure;
    let Some(harmony) = harmony::harmonise(mechanism, structure) else {
        return shapes::merge(tasks, tasks, &HashMap::new(), structure);
    };
    let alike = Structure::new(&harmony.mechanism);
    if alike.blocks != structure.blocks {
        return shapes::merge(tasks, tasks, &HashMap::new(), structure);
    }
    let symbols = Symbols::new(&harmony.mechanism, &alike);
    labels::prepare(&harmony.mechanism, &symbols);
    let first = mechanism.params.len() as u32;
    let unknown = |(k, &value)| (Sym::leaf(Leaf::Param(first + k as u32)), Sym::constant(value));
    let unknowns = harmony.added.iter().enumerate().map(unknown).collect();
    shapes::merge(tasks, &kernels::parts(&symbols), &unknowns, structure)
}
