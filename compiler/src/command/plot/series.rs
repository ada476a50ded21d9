//! A run of a model kept in memory, and the curves made of it.

use handc_core::error::RunError;
use handc_core::layout::CoordinateKind;
use handc_core::model::Model;
use handc_core::simulation::{Settings, Simulation};
use handc_dsl::dimension::Dimension;
use handc_dsl::hir::{self, ConstraintKind};
use handc_plot::timeplot::{by_size, energy};
use handc_plot::{Curve, Quantity, Unit};
use handc_runtime::expression::StrandQuantity;
use handc_runtime::interpreter::Interpreter;

/// Most instants that are kept; longer runs are thinned out.
const INSTANTS: usize = 20_000;

/// A finished run.
pub(super) struct Run {
    /// The simulation at its end.
    pub(super) simulation: Simulation<Interpreter>,
    /// Instants (s).
    pub(super) time: Vec<f64>,
    /// Coordinates, one vector per coordinate.
    pub(super) q: Vec<Vec<f64>>,
    /// Lengths of strands (m).
    lengths: Vec<Vec<f64>>,
    /// Tensions of strands (N).
    tensions: Vec<Vec<f64>>,
    /// Multipliers over the step.
    forces: Vec<Vec<f64>>,
    /// Energy (J).
    energy: Vec<f64>,
    /// Recorded columns.
    records: Vec<Vec<f64>>,
    /// Why it ended early, if it did.
    pub(super) failure: Option<RunError>,
}

/// Runs a model. A run that fails on its way is kept up to there.
pub(super) fn run(model: Interpreter, settings: &Settings) -> Result<Run, RunError> {
    let simulation = Simulation::new(model, settings)?;
    let layout = simulation.layout();
    let empty = |count: usize| vec![Vec::new(); count];
    let records =
        simulation.scenario().map_or(0, |scenario| layout.scenarios[scenario].records.len());
    let mut run = Run {
        time: Vec::new(),
        q: empty(layout.coordinates.len()),
        lengths: empty(layout.strands.len()),
        tensions: empty(layout.strands.len()),
        forces: empty(layout.rows.len()),
        energy: Vec::new(),
        records: empty(records),
        failure: None,
        simulation,
    };
    let steps = run.simulation.steps;
    let every = steps.div_ceil(INSTANTS).max(1);
    run.keep();
    for step in 1..=steps {
        if let Err(error) = run.simulation.step() {
            run.failure = Some(error);
            break;
        }
        if step % every == 0 || step == steps {
            run.keep();
        }
    }
    Ok(run)
}

impl Run {
    /// Keeps the numbers of the current instant.
    fn keep(&mut self) {
        let simulation = &mut self.simulation;
        let mut records = vec![0.0; self.records.len()];
        simulation.records(&mut records);
        push(&mut self.records, &records);
        self.energy.push(simulation.energy());
        let q = simulation.coordinates().to_vec();
        let mut lengths = vec![0.0; self.lengths.len()];
        simulation.model.strand_lengths(&q, &mut lengths);
        let mut states = vec![[0.0; StrandQuantity::COUNT]; self.lengths.len()];
        simulation.look(|model, at| model.strand_states_at(at, &mut states));
        let tensions: Vec<f64> =
            states.iter().map(|state| state[StrandQuantity::Tension as usize]).collect();
        let h = simulation.h;
        // Multipliers belong to a step, and none has been taken at the start.
        let started = simulation.state.step > 0;
        let force = |lambda: &f64| if started { lambda / h } else { f64::NAN };
        let forces: Vec<f64> = simulation.state.lambda.iter().map(force).collect();
        self.time.push(simulation.state.t);
        push(&mut self.q, &q);
        push(&mut self.lengths, &lengths);
        push(&mut self.tensions, &tensions);
        push(&mut self.forces, &forces);
    }
}

fn push(columns: &mut [Vec<f64>], row: &[f64]) {
    columns.iter_mut().zip(row).for_each(|(column, value)| column.push(*value));
}

/// Everything that is drawn over time, from top to bottom.
pub(super) fn quantities(run: &Run, model: &hir::Model) -> Vec<Quantity> {
    let layout = run.simulation.layout();
    let of_kind = |kind: CoordinateKind, is_internal: bool| {
        let coordinates = layout.coordinates.iter().zip(&run.q);
        let chosen = coordinates.filter(|(c, _)| c.kind == kind && c.is_internal == is_internal);
        chosen.map(|(c, values)| curve(&c.name, values)).collect::<Vec<_>>()
    };
    let strands = |columns: &[Vec<f64>]| {
        layout.strands.iter().zip(columns).map(|(s, v)| curve(&s.name, v)).collect::<Vec<_>>()
    };
    let from_start: Vec<Vec<f64>> = run
        .lengths
        .iter()
        .map(|length| length.iter().map(|x| x - length.first().unwrap_or(x)).collect())
        .collect();
    let mut quantities = vec![
        Quantity::new("joint angle", Unit::Angle, of_kind(CoordinateKind::Angle, false)),
        Quantity::new("displacement", Unit::Prefixed("m"), of_kind(CoordinateKind::Length, false)),
        Quantity::new(
            "activation",
            Unit::Plain(String::new()),
            of_kind(CoordinateKind::Ratio, true),
        ),
        Quantity::new("fibre length", Unit::Prefixed("m"), of_kind(CoordinateKind::Length, true)),
        Quantity::new("change of strand length", Unit::Prefixed("m"), strands(&from_start)),
        Quantity::new("strand tension", Unit::Prefixed("N"), strands(&run.tensions)),
    ];
    quantities.extend(constraint_forces(run, model));
    quantities.extend(energy(run.energy.clone()));
    quantities.extend(records(run, model));
    quantities
}

fn curve(name: &str, values: &[f64]) -> Curve {
    Curve { name: name.to_string(), values: values.to_vec() }
}

/// Multipliers over the step, by unit.
fn constraint_forces(run: &Run, model: &hir::Model) -> Vec<Quantity> {
    let names = run.simulation.layout().rows.iter().map(|row| row.name.as_str());
    let units = model.constraints.iter().flat_map(|constraint| match &constraint.kind {
        ConstraintKind::Coincident { axes, .. } => {
            vec!["N"; axes.iter().filter(|held| **held).count()]
        }
        ConstraintKind::OnPlane { .. } => vec!["N"],
        ConstraintKind::Weld { .. } => vec!["N", "N", "N", "N·m", "N·m", "N·m"],
        ConstraintKind::Length(_) => vec!["N"],
        ConstraintKind::Distance { .. } => vec!["N/m"],
        ConstraintKind::Equation { .. } => vec!["SI"],
    });
    let rows: Vec<_> = names.zip(units).zip(&run.forces).collect();
    let kinds = [
        ("constraint force", "N", Unit::Prefixed("N")),
        ("constraint torque", "N·m", Unit::Plain("N·m".into())),
        ("constraint λ/h", "N/m", Unit::Plain("N/m".into())),
        ("constraint λ/h", "SI", Unit::Plain("SI".into())),
    ];
    let quantity = |(label, wanted, unit): (&str, &str, Unit)| {
        let chosen = rows.iter().filter(|((_, unit), _)| *unit == wanted);
        let curves = chosen.map(|((name, _), values)| curve(name, values)).collect();
        Quantity::new(label, unit, curves)
    };
    kinds.into_iter().map(quantity).collect()
}

/// Recorded columns, by unit and size.
fn records(run: &Run, model: &hir::Model) -> Vec<Quantity> {
    let Some(scenario) = run.simulation.scenario().and_then(|s| model.scenarios.get(s)) else {
        return Vec::new();
    };
    let mut by_unit: Vec<(Unit, Vec<Curve>)> = Vec::new();
    for (record, values) in scenario.records.iter().zip(&run.records) {
        let unit = unit(record.value.dimension);
        let curve = curve(&record.name.text, values);
        match by_unit.iter_mut().find(|(other, _)| *other == unit) {
            Some((_, curves)) => curves.push(curve),
            None => by_unit.push((unit, vec![curve])),
        }
    }
    by_unit.into_iter().flat_map(|(unit, curves)| by_size("recorded", &unit, curves)).collect()
}

fn unit(dimension: Dimension) -> Unit {
    match dimension {
        Dimension::NONE => Unit::Plain(String::new()),
        Dimension::LENGTH => Unit::Prefixed("m"),
        Dimension::FORCE => Unit::Prefixed("N"),
        Dimension::TIME => Unit::Prefixed("s"),
        other => {
            Unit::Plain(other.to_string().replace('*', "·").replace("^2", "²").replace("^3", "³"))
        }
    }
}
