//! The mechanics as tasks: per part of a block, and for the whole model where a function has none.

use super::parts::{self, parts_of_strands};
use super::symbols::Symbols;
use super::{Module, Task, direct};
use crate::emit::{Output, Place};
use crate::graph::{Leaf, Sym};
use handc_core::passage::CLEARANCES;
use handc_core::scalar::Scalar;
use handc_runtime::mechanism::Law;

/// The results of a kernel as outputs to `array`, labelled by `label`; zeros are left out where the
/// caller's array is known to be clear.
pub(super) fn outputs(
    array: &'static str,
    values: impl IntoIterator<Item = (usize, Sym)>,
    keep_zeros: bool,
    label: impl Fn(usize) -> String,
) -> Vec<Output> {
    values
        .into_iter()
        .filter(|(_, value)| keep_zeros || !value.is_known_zero())
        .map(|(index, value)| Output {
            place: Place::Element { array, index },
            value,
            label: label(index),
        })
        .collect()
}

/// `name` with its source line, for a list in the documentation.
fn cited(name: &str, source: &str) -> String {
    if source.is_empty() { format!("`{name}`") } else { format!("`{name}` ({source})") }
}

fn sentence(opening: &str, items: Vec<String>) -> Option<String> {
    (!items.is_empty()).then(|| format!("{opening}: {}.", items.join(", ")))
}

/// Kernels of the whole model.
pub(super) fn tasks(symbols: &Symbols) -> Vec<Task> {
    let mut tasks = strands(symbols);
    tasks.push(commands(symbols));
    tasks.extend(clearances(symbols));
    tasks.extend(required_numbers(symbols));
    tasks.extend(constraints(symbols));
    tasks.push(potential(symbols));
    tasks.push(frames(symbols));
    tasks
}

/// Those of every part, by number.
pub(super) fn parts(symbols: &Symbols) -> Vec<Task> {
    let structure = symbols.structure;
    let (mechanics, at) = (symbols.mechanics(), symbols.at());
    let mut workspace = symbols.workspace();
    let zeros = |count| vec![Sym::zero(); count];
    let size = structure.blocks.iter().map(|b| b.coordinates.len().pow(2)).sum();
    let (mut momentum, mut force) = (zeros(structure.count), zeros(structure.count));
    let (mut matrix, mut mass, mut by_increment) = (zeros(size), zeros(size), zeros(size));
    let step = Sym::leaf(Leaf::Step);
    mechanics.evaluate(&mut workspace, &at, &mut momentum, &mut force, Some((step, &mut matrix)));
    mechanics.mass_matrix(&mut workspace, &symbols.q, &mut mass);
    let by_h = step.recip();
    mechanics.momentum_matrix(&mut workspace, &symbols.q, &symbols.v, by_h, &mut by_increment);
    let mut lengths = zeros(symbols.mechanism.strands.len());
    mechanics.strand_lengths(&mut workspace, &symbols.q, &mut lengths);
    let name = |coordinate: usize| symbols.mechanism.coordinates[coordinate].name.clone();
    let mut tasks = Vec::new();
    let part_of = parts_of_strands(structure);
    for (number, part) in parts::parts(&structure.blocks).into_iter().enumerate() {
        let pick = |values: &[Sym]| -> Vec<(usize, Sym)> {
            part.coordinates.iter().map(|&c| (c, values[c])).collect()
        };
        let packed = |array, values: &[Sym]| {
            outputs(array, part.slots().map(|slot| (slot, values[slot])), false, |slot| {
                name(part.coordinates[part.entry(slot).0])
            })
        };
        let mut vectors = outputs("momentum", pick(&momentum), true, name);
        vectors.extend(outputs("force", pick(&force), true, name));
        let mut all = vectors.clone();
        all.extend(packed("matrix", &matrix));
        let about = about_part(symbols, part.coordinates);
        let task = |name, opening: &str, outputs| Task {
            module: Module::Part(number),
            name,
            doc: std::iter::once(opening.to_owned()).chain(about.clone()).collect(),
            outputs,
        };
        tasks.push(task(
            "evaluate",
            "Momentum p = ∂L/∂v and force f = ∂L/∂q + F at the midpoint of a step.",
            vectors,
        ));
        tasks.push(task(
            "evaluate_with_matrix",
            "As [`evaluate`], and the Newton matrix −M/h + ½(L_qv − L_vq) + (h/4)(L_qq + F_q) + ½F_v.",
            all,
        ));
        tasks.push(task("mass_matrix", "Mass matrix M = ∂²L/∂v².", packed("matrix", &mass)));
        let entry = |slot: usize| {
            let (row, column) = part.entry(slot);
            row * part.coordinates.len() + column
        };
        let there = part.slots().filter(|&slot| !matrix[slot].is_known_zero()).map(entry).collect();
        if part.is_block && direct::suits(part.coordinates.len(), &there) {
            tasks.push(task(
                "momentum_matrix",
                "By how much the momentum changes with the increment of a step: M/h + ½∂p/∂q.",
                packed("matrix", &by_increment),
            ));
        }
        let own = (0..lengths.len())
            .filter(|&strand| part_of[strand] == Some(number))
            .map(|strand| (strand, lengths[strand]));
        tasks.push(task(
            "lengths",
            &format!("Lengths x = Σ‖pᵢ − pᵢ₊₁‖ of the strands{} (m).", wound(symbols)),
            outputs("lengths", own, true, |strand| symbols.mechanism.strands[strand].name.clone()),
        ));
    }
    tasks
}

/// What acts in a part, with source lines.
fn about_part(symbols: &Symbols, coordinates: &[usize]) -> Vec<String> {
    let mechanism = symbols.mechanism;
    let structure = symbols.structure;
    let touches = |others: &[usize]| others.iter().any(|c| coordinates.contains(c));
    let joints = coordinates.iter().map(|&c| {
        let coordinate = &mechanism.coordinates[c];
        cited(&coordinate.name, &coordinate.source)
    });
    let bodies = mechanism
        .bodies
        .iter()
        .filter(|body| touches(&structure.chain_coordinates(body.link)))
        .map(|body| cited(&body.name, &body.source));
    let strands = mechanism
        .strands
        .iter()
        .zip(&structure.strands)
        .filter(|(_, path)| touches(&path.coordinates))
        .map(|(strand, _)| cited(&strand.name, &strand.source));
    let torques = mechanism
        .torques
        .iter()
        .filter(|torque| coordinates.contains(&(torque.coordinate as usize)))
        .map(|torque| cited(&torque.name, &torque.source));
    let forces = mechanism
        .forces
        .iter()
        .filter(|force| touches(&structure.chain_coordinates(force.point.link)))
        .map(|force| cited(&force.name, &force.source));
    [
        sentence("Coordinates", joints.collect()),
        sentence("Bodies", bodies.collect()),
        sentence("Strands", strands.collect()),
        sentence("Torques", torques.collect()),
        sentence("Forces", forces.collect()),
    ]
    .into_iter()
    .flatten()
    .flat_map(|line| [String::new(), line])
    .collect()
}

/// What is to be added to the formula of lengths.
fn wound(symbols: &Symbols) -> &'static str {
    let winds = symbols.mechanism.strands.iter().any(|strand| !strand.wraps.is_empty());
    if winds { ", round surfaces where they wind" } else { "" }
}

fn strands(symbols: &Symbols) -> Vec<Task> {
    let mechanism = symbols.mechanism;
    let (strands, count) = (mechanism.strands.len(), mechanism.coordinates.len());
    let mechanics = symbols.mechanics();
    let mut workspace = symbols.workspace();
    let mut lengths = vec![Sym::zero(); strands];
    let mut arms = vec![Sym::zero(); strands * count];
    mechanics.strand_lengths(&mut workspace, &symbols.q, &mut lengths);
    mechanics.moment_arms(&mut workspace, &symbols.q, &mut arms);
    let name = |strand: usize| mechanism.strands[strand].name.clone();
    let list: Vec<String> = mechanism.strands.iter().map(|s| cited(&s.name, &s.source)).collect();
    let about: Vec<String> =
        sentence("Strands", list).into_iter().flat_map(|line| [String::new(), line]).collect();
    let part_of = parts_of_strands(symbols.structure);
    let outside = (0..strands).filter(|&s| part_of[s].is_none()).map(|s| (s, lengths[s]));
    let task = |name, opening: &str, outputs| Task {
        module: Module::Strands,
        name,
        doc: std::iter::once(opening.to_owned()).chain(about.clone()).collect(),
        outputs,
    };
    vec![
        task(
            "lengths",
            &format!(
                "Lengths x = Σ‖pᵢ − pᵢ₊₁‖ of strands that span no block{} (m).",
                wound(symbols)
            ),
            outputs("lengths", outside, true, name),
        ),
        task(
            "moment_arms",
            "Moment arms ∂x/∂q of all strands (m/rad or 1), one row per strand; entries that are \
             zero by structure are not written.",
            outputs("arms", arms.into_iter().enumerate(), false, |slot| name(slot / count)),
        ),
    ]
}

/// Commanded tensions, if there are any.
fn commands(symbols: &Symbols) -> Task {
    let strands = &symbols.mechanism.strands;
    let is_commanded = |s: &usize| matches!(strands[*s].law, Law::Tension(_));
    let commanded: Vec<usize> = (0..strands.len()).filter(is_commanded).collect();
    let mut found = vec![Sym::zero(); strands.len()];
    symbols.mechanics().commands(&mut symbols.workspace(), &symbols.at(), &mut found);
    let values = commanded.into_iter().map(|s| (s, found[s]));
    Task {
        module: Module::Strands,
        name: "commands",
        doc: vec!["Commanded tensions (N).".to_owned()],
        outputs: outputs("tensions", values, true, |s| strands[s].name.clone()),
    }
}

/// How far surfaces are from being impassable, if strands wrap any.
fn clearances(symbols: &Symbols) -> Option<Task> {
    let strands = &symbols.mechanism.strands;
    let wraps = || strands.iter().flat_map(|s| s.wraps.iter().map(move |w| (&s.name, w)));
    let count = wraps().count();
    if count == 0 {
        return None;
    }
    let mut found = vec![Sym::zero(); CLEARANCES * count];
    symbols.mechanics().clearances(&mut symbols.workspace(), &symbols.q, &mut found);
    let names: Vec<&String> = wraps().map(|(name, _)| name).collect();
    let list = wraps().map(|(name, wrap)| format!("`{name}` over the {wrap}")).collect();
    let opening = "How far every surface is from being impassable, four numbers each: how far the point \
                   before it and the point behind it are outside (m); on a sphere that is touched, how \
                   far its centre is from the line between them (m); and what is negative where the \
                   strand would jump to the other side.";
    let about = sentence("Surfaces", list).into_iter().flat_map(|line| [String::new(), line]);
    Some(Task {
        module: Module::Strands,
        name: "clearances",
        doc: std::iter::once(opening.to_owned()).chain(about).collect(),
        outputs: outputs("clearances", found.into_iter().enumerate(), true, |slot| {
            names[slot / CLEARANCES].clone()
        }),
    })
}

/// Numbers that a change of parameters may put out of range, if there are any.
fn required_numbers(symbols: &Symbols) -> Option<Task> {
    let requirements = &symbols.mechanism.requirements;
    if requirements.is_empty() {
        return None;
    }
    let mut found = vec![Sym::zero(); requirements.len()];
    symbols.mechanics().required_numbers(&mut found);
    Some(Task {
        module: Module::Time,
        name: "required_numbers",
        doc: vec!["Numbers that must lie in their ranges when a run begins.".to_owned()],
        outputs: outputs("numbers", found.into_iter().enumerate(), true, |slot| {
            requirements[slot].text.clone()
        }),
    })
}

fn constraints(symbols: &Symbols) -> Vec<Task> {
    let (mechanism, structure) = (symbols.mechanism, symbols.structure);
    let rows = structure.row_slots.len();
    let mechanics = symbols.mechanics();
    let mut workspace = symbols.workspace();
    let size = structure.blocks.iter().map(|b| b.coordinates.len() * b.rows.len()).sum();
    let time = Sym::leaf(Leaf::Time);
    let mut values = vec![Sym::zero(); rows];
    let mut jacobian = vec![Sym::zero(); size];
    mechanics.constraints(&mut workspace, &symbols.q, time, &symbols.rest, &mut values);
    mechanics.constraint_jacobian(&mut workspace, &symbols.q, time, &mut jacobian);
    let of_row = |row: usize| {
        let index = structure.first_row.partition_point(|&first| first <= row);
        &mechanism.constraints[index - 1]
    };
    let row_of_slot = |slot: usize| {
        structure
            .blocks
            .iter()
            .rev()
            .find(|block| !block.rows.is_empty() && block.constraint_offset <= slot)
            .map_or(0, |b| b.rows[(slot - b.constraint_offset) / b.coordinates.len()])
    };
    let list: Vec<String> =
        mechanism.constraints.iter().map(|c| cited(&c.name, &c.source)).collect();
    let about: Vec<String> =
        sentence("Constraints", list).into_iter().flat_map(|l| [String::new(), l]).collect();
    let task = |name, opening: &str, outputs| Task {
        module: Module::Constraints,
        name,
        doc: std::iter::once(opening.to_owned()).chain(about.clone()).collect(),
        outputs,
    };
    vec![
        task(
            "rows",
            "Values of the constraint rows h(q), zero where they hold.",
            outputs("rows", values.into_iter().enumerate(), true, |row| of_row(row).name.clone()),
        ),
        task(
            "jacobian",
            "Derivatives ∂h/∂q, packed by block; entries that are zero by structure are not written.",
            outputs("jacobian", jacobian.into_iter().enumerate(), false, |slot| {
                of_row(row_of_slot(slot)).name.clone()
            }),
        ),
    ]
}

fn potential(symbols: &Symbols) -> Task {
    let mut workspace = symbols.workspace();
    let value = symbols.mechanics().potential(&mut workspace, &symbols.q, &symbols.rest);
    Task {
        module: Module::Energy,
        name: "potential",
        doc: vec!["Potential energy (J): gravity, strands, springs and elastic limits.".to_owned()],
        outputs: vec![Output { place: Place::Return, value, label: "energy".to_owned() }],
    }
}

fn frames(symbols: &Symbols) -> Task {
    let mut workspace = symbols.workspace();
    let poses = symbols.mechanics().frame_poses(&mut workspace, &symbols.q);
    let numbers = poses.iter().flat_map(|pose| {
        let r = pose.rotation.0;
        r.into_iter().flatten().chain(pose.translation.0)
    });
    let name = |slot: usize| symbols.mechanism.frames[slot / 12].name.clone();
    Task {
        module: Module::Frames,
        name: "write_poses",
        doc: vec![
            "Rotation by rows, then origin, of every frame in the world: twelve numbers each."
                .to_owned(),
        ],
        outputs: outputs("poses", numbers.enumerate(), true, name),
    }
}
