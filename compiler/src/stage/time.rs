//! Start values, functions of time, and what scenarios add.

use super::kernels::outputs;
use super::symbols::Symbols;
use super::{Module, Task};
use crate::graph::Sym;
use handc_runtime::expression::Program;
use handc_runtime::mechanism::{Number, Scenario};

/// All of them.
pub(super) fn tasks(symbols: &Symbols) -> Vec<Task> {
    let mechanism = symbols.mechanism;
    let task = |name, doc: &str, outputs| Task {
        module: Module::Time,
        name,
        doc: vec![doc.to_owned()],
        outputs,
    };
    let number = |n: Number| symbols.numbers.number(n);
    let coordinate = |index: usize| mechanism.coordinates[index].name.clone();
    let input = |index: usize| mechanism.inputs[index].name.clone();
    let start = mechanism.coordinates.iter().map(|c| number(c.start)).enumerate();
    let velocity = mechanism.coordinates.iter().map(|c| number(c.velocity)).enumerate();
    let mut state = outputs("q", start, true, coordinate);
    state.extend(outputs("v", velocity, true, coordinate));
    let inputs = programs(symbols, mechanism.inputs.iter().map(|i| &i.default).enumerate());
    let rests = mechanism.strands.iter().enumerate();
    let rests = programs(symbols, rests.filter_map(|(i, s)| Some((i, s.rest.as_ref()?))));
    let drives = mechanism.coordinates.iter().enumerate();
    let drives = programs(symbols, drives.filter_map(|(i, c)| Some((i, c.drive.as_ref()?))));
    let mut tasks = vec![
        task("start", "Coordinates and rates at the start.", state),
        task("inputs", "Default inputs at time t (s).", outputs("inputs", inputs, true, input)),
        task(
            "rests",
            "Natural lengths that the model gives (m).",
            outputs("rest", rests, true, |i| mechanism.strands[i].name.clone()),
        ),
        task(
            "drives",
            "Coordinates whose path the model gives, at time t (s).",
            outputs("q", drives, true, coordinate),
        ),
    ];
    for (index, scenario) in mechanism.scenarios.iter().enumerate() {
        let task = |name, doc: &str, outputs| Task {
            module: Module::Scenario(index),
            name,
            doc: vec![doc.to_owned()],
            outputs,
        };
        let at = |(i, program): &'_ (u32, Program)| (*i as usize, program.clone());
        let own: Vec<_> = scenario.inputs.iter().map(at).collect();
        let driven: Vec<_> = scenario.drives.iter().map(at).collect();
        let own = programs(symbols, own.iter().map(|(i, p)| (*i, p)));
        let driven = programs(symbols, driven.iter().map(|(i, p)| (*i, p)));
        let lengths: Vec<_> = scenario.lengths.iter().map(at).collect();
        let lengths = programs(symbols, lengths.iter().map(|(i, p)| (*i, p)));
        let records = scenario.records.iter().map(|(_, program)| program).enumerate();
        let records = programs(symbols, records);
        tasks.push(task(
            "inputs",
            "Inputs that the scenario gives, at time t (s).",
            outputs("inputs", own, true, input),
        ));
        tasks.push(task(
            "drives",
            "Coordinates that the scenario drives, at time t (s).",
            outputs("q", driven, true, coordinate),
        ));
        tasks.push(task(
            "rests",
            "Lengths that the scenario prescribes for strands, at time t (s).",
            outputs("rest", lengths, true, |i| mechanism.strands[i].name.clone()),
        ));
        tasks.push(task(
            "records",
            "Recorded columns.",
            outputs("records", records, true, |i| scenario.records[i].0.clone()),
        ));
    }
    tasks
}

fn programs<'p>(
    symbols: &Symbols,
    list: impl Iterator<Item = (usize, &'p Program)>,
) -> Vec<(usize, Sym)> {
    list.map(|(index, program)| (index, symbols.evaluate(program)[0])).collect()
}

/// The numbers of a scenario in a fixed order: step, duration and tolerance if given, then those
/// of sets, starts, rates, poses and motions.
pub fn scenario_numbers(scenario: &Scenario) -> Vec<Number> {
    let mut numbers: Vec<Number> =
        [scenario.step, scenario.duration, scenario.tolerance].into_iter().flatten().collect();
    for list in [&scenario.set, &scenario.start, &scenario.velocity] {
        numbers.extend(list.iter().map(|(_, number)| *number));
    }
    for (_, list) in scenario.poses.iter().chain(&scenario.motions) {
        numbers.extend(list.iter().map(|(_, number)| *number));
    }
    numbers
}

pub(super) fn numbers(symbols: &Symbols, scenario: &Scenario) -> Vec<Sym> {
    scenario_numbers(scenario).into_iter().map(|n| symbols.numbers.number(n)).collect()
}
