//! A model at a pose: what `atlas`, `pose` and `strength` begin with.
//!
//! Loads and what is asked of strands are written into the mechanism before anything is computed, so
//! that they go through the same mechanics as what the model itself declares.

pub(crate) mod edit;
pub(crate) mod names;
pub(crate) mod value;

use handc_core::error::RunError;
use handc_core::layout::CoordinateKind;
use handc_core::model::{Midpoint, Model};
use handc_core::simulation::{Settings, Simulation};
use handc_core::start::project;
use handc_dsl::dimension::Dimension;
use handc_dsl::hir;
use handc_runtime::analysis::equilibrium::equilibrium;
use handc_runtime::analysis::linear::Held;
use handc_runtime::expression::StrandQuantity;
use handc_runtime::interpreter::Interpreter;
use handc_runtime::mechanism::{Mechanism, Point};
use handc_runtime::resolved::Resolved;
use names::Reader;
use std::path::PathBuf;
use std::sync::Arc;

/// Which model at which pose.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PostureOptions {
    /// Model file.
    pub file: PathBuf,
    /// Folder that imports may not leave.
    pub root: Option<PathBuf>,
    /// Scenario by name.
    pub scenario: Option<String>,
    /// Parameters by name.
    pub set: Vec<(String, f64)>,
    /// One of the scenario's poses; `None`: its start.
    pub pose: Option<String>,
    /// `JOINT=VALUE`: instead of what the pose has.
    pub start: Vec<String>,
    /// `STRAND=VALUE`: natural lengths.
    pub rest: Vec<String>,
    /// `FRAME=FX,FY,FZ`: forces at frames, world axes.
    pub load: Vec<String>,
}

/// A force at a frame's origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Load {
    /// Frame by index.
    pub(crate) frame: usize,
    /// Components in world axes (N).
    pub(crate) force: [f64; 3],
}

/// A model at a pose on its constraints.
#[derive(Clone, Debug)]
pub(crate) struct Posture {
    /// With its parameters set, and with the loads.
    pub(crate) model: Interpreter,
    /// Coordinates (rad or m).
    pub(crate) q: Vec<f64>,
    /// Natural lengths (m).
    pub(crate) rest: Vec<f64>,
    /// Inputs at the beginning.
    pub(crate) inputs: Vec<f64>,
    /// Coordinates whose path is given: they stay where they are.
    pub(crate) driven: Vec<bool>,
    /// Scenario by index.
    pub(crate) scenario: Option<usize>,
    /// What is loaded.
    pub(crate) loads: Vec<Load>,
}

/// Reads a mechanism, or says what is wrong with it.
pub(crate) fn mechanism(options: &PostureOptions) -> Result<Mechanism, u8> {
    model(options).map(|(_, mechanism)| mechanism)
}

/// Reads a model and its mechanism, or says what is wrong with it.
pub(crate) fn model(options: &PostureOptions) -> Result<(hir::Model, Mechanism), u8> {
    let (mut checked, mechanism) = super::load(&options.file, options.root.as_deref());
    // No step is taken, so none is too long.
    checked.diagnostics.retain(|d| d.code != "long-step");
    super::report(&checked);
    checked.model.take().zip(mechanism).ok_or(1)
}

/// Loads of the command line, as the reader can make them out.
pub(crate) fn loads(reader: &mut Reader, texts: &[String]) -> Vec<Load> {
    let mut found = Vec::new();
    for text in texts {
        let Some((name, force)) = reader.split("--load", text) else { continue };
        let frame = reader.frame(name);
        let force = reader.take("--load", value::triple(force, Dimension::FORCE));
        found.extend(frame.zip(force).map(|(frame, force)| Load { frame, force }));
    }
    found
}

/// Takes the pose of the options with the mechanism as it was edited. What is wrong with the options
/// goes to the reader; a pose that cannot be taken is an error.
pub(crate) fn settle(
    reader: &mut Reader,
    edited: Mechanism,
    options: &PostureOptions,
) -> Result<Option<Posture>, RunError> {
    let loads = loads(reader, &options.load);
    let mut edited = edited;
    for load in &loads {
        edit::load(&mut edited, load);
    }
    let settings = Settings {
        scenario: options.scenario.clone(),
        set: options.set.clone(),
        // No step is taken.
        step: Some(1e-3),
        duration: Some(1e-3),
        ..Settings::default()
    };
    let simulation = match Simulation::new(Interpreter::new(Arc::new(edited)), &settings) {
        Ok(simulation) => simulation,
        Err(RunError::Usage(message)) => {
            reader.complain(message);
            // Names can be told without a pose.
            reader.coordinate_values("--start", &options.start, |_| None);
            reader.strand_values("--rest", &options.rest, Dimension::LENGTH);
            return Ok(None);
        }
        Err(error) => return Err(error),
    };
    let scenario = simulation.scenario();
    let limits = limits(&simulation.model);
    let mut posture = Posture {
        q: simulation.state.q.clone(),
        rest: simulation.rest().to_vec(),
        inputs: simulation.inputs().to_vec(),
        driven: simulation.driven().to_vec(),
        scenario,
        loads,
        model: simulation.model,
    };
    if let Some(name) = &options.pose
        && let Some(pose) = posture.find_pose(reader, name)
    {
        pose.iter().for_each(|&(c, value)| posture.q[c] = value);
    }
    for (c, value) in reader.coordinate_values("--start", &options.start, |c| limits[c]) {
        posture.q[c] = value;
    }
    if (options.pose.is_some() || !options.start.is_empty()) && reader.complaints.is_empty() {
        posture.move_to_constraints(options.pose.is_some())?;
    }
    for (strand, value) in reader.strand_values("--rest", &options.rest, Dimension::LENGTH) {
        posture.rest[strand] = value;
        if value < 0.0 {
            let name = &reader.mechanism.strands[strand].name;
            reader.complain(format!("`--rest`: the natural length of `{name}` is negative"));
        }
    }
    Ok(Some(posture))
}

/// Ranges of the coordinates.
pub(crate) fn limits(model: &Interpreter) -> Vec<Option<[f64; 2]>> {
    let mechanism = model.mechanism();
    let numbers = Resolved::new(mechanism, model.params());
    let range = |limits: [handc_runtime::mechanism::Number; 2]| limits.map(|n| numbers.number(n));
    mechanism.coordinates.iter().map(|c| c.limits.map(range)).collect()
}

/// Shows what is wrong with the command line; the exit code, if anything is.
pub(crate) fn complain(reader: &Reader) -> Result<(), u8> {
    reader.complaints.iter().for_each(|complaint| eprintln!("error: {complaint}"));
    if reader.complaints.is_empty() { Ok(()) } else { Err(2) }
}

/// Shows an error of a run and returns its exit code.
pub(crate) fn fail(error: &RunError) -> u8 {
    eprintln!("error: {error}");
    error.exit_code() as u8
}

impl Posture {
    /// What stays as it is while the configuration varies.
    pub(crate) fn held(&self) -> Held<'_> {
        Held { t: 0.0, rest: &self.rest, inputs: &self.inputs, driven: &self.driven }
    }

    /// Goes on with another mechanism of the same names, parameters as they are.
    pub(crate) fn exchange(&mut self, mechanism: Mechanism) {
        let params = self.model.params().to_vec();
        self.model = Interpreter::new(Arc::new(mechanism));
        params.into_iter().enumerate().for_each(|(i, value)| self.model.set_param(i, value));
    }

    fn find_pose(&mut self, reader: &mut Reader, name: &str) -> Option<Vec<(usize, f64)>> {
        let mechanism = Arc::clone(self.model.mechanism());
        let Some(scenario) = self.scenario else {
            reader.complain(format!(
                "`{}` has no pose `{name}`: poses stand in a scenario, and it has none; give \
                 `--start JOINT=VALUE`",
                mechanism.name
            ));
            return None;
        };
        let poses = &mechanism.scenarios[scenario].poses;
        let known = poses.iter().map(|(name, _)| name.as_str());
        let whose = format!("{}.{}", mechanism.name, mechanism.scenarios[scenario].name);
        match handc_core::simulation::find_name(&whose, "pose", name, known) {
            Ok(index) => Some(self.model.scenario(scenario).poses[index].clone()),
            Err(error) => {
                reader.complain(error.to_string());
                None
            }
        }
    }

    /// Moves a pose that was asked for onto the constraints, and its massless nodes to where they
    /// balance.
    fn move_to_constraints(&mut self, is_named: bool) -> Result<(), RunError> {
        let asked = self.q.clone();
        // Prescribed lengths are constraints too.
        self.leave_rests(is_named);
        project(&mut self.model, &mut self.q, &self.rest, &self.driven).map_err(|(row, gap)| {
            RunError::Start(format!(
                "the pose cannot be moved onto the constraints: `{row}` is {gap:.3e} away there\n  \
                 try: a pose nearer to a closed configuration"
            ))
        })?;
        let moved = asked.iter().zip(&self.q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        if moved > 1e-6 {
            eprintln!(
                "note: the pose was moved onto the constraints by up to {moved:.3e} (rad or m)"
            );
        }
        self.leave_rests(is_named);
        self.settle_nodes()
    }

    /// Moves massless nodes and muscles to where they balance, all else as it is.
    pub(crate) fn settle_nodes(&mut self) -> Result<(), RunError> {
        let mut driven = vec![true; self.q.len()];
        let statics = self.model.layout().massless(&self.driven);
        if statics.is_empty() {
            return Ok(());
        }
        statics.into_iter().for_each(|c| driven[c] = false);
        let held = Held { t: 0.0, rest: &self.rest, inputs: &self.inputs, driven: &driven };
        let found = equilibrium(&mut self.model, &self.q, &held)
            .map_err(|error| RunError::Start(error.to_string()))?;
        self.q = found.q;
        Ok(())
    }

    /// Tensions of all strands at rest in q (N). Those of prescribed strands are multipliers, and
    /// zero here.
    pub(crate) fn tensions(&mut self, q: &[f64], rest: &[f64]) -> Vec<f64> {
        let v = vec![0.0; q.len()];
        let mut states = vec![[0.0; StrandQuantity::COUNT]; rest.len()];
        let at = Midpoint { q, v: &v, t: 0.0, rest, inputs: &self.inputs };
        self.model.strand_states(&at, &mut states);
        states.iter().map(|state| state[StrandQuantity::Tension as usize]).collect()
    }

    /// Natural lengths that the model does not give are the lengths at this pose, and those that
    /// follow a motion too where the pose is one of the motion's.
    fn leave_rests(&mut self, is_named: bool) {
        let layout = self.model.layout().clone();
        let mut lengths = vec![0.0; self.rest.len()];
        self.model.strand_lengths(&self.q, &mut lengths);
        let follows = self.scenario.map_or(&[][..], |s| &layout.scenarios[s].follow);
        for (strand, length) in lengths.into_iter().enumerate() {
            let followed = follows.iter().any(|follow| follow.strands.contains(&strand));
            let left_out = !layout.strands[strand].has_rest;
            if (followed && is_named) || (left_out && !followed) {
                self.rest[strand] = length;
            }
        }
    }

    /// The origin of a frame, or another point given in its axes, as a point of its link.
    pub(crate) fn point(&self, frame: usize, offset: [f64; 3]) -> Point {
        let mechanism = self.model.mechanism();
        let numbers = Resolved::new(mechanism, self.model.params());
        let frame = &mechanism.frames[frame];
        let link_from_frame = numbers.transform(&frame.link_from_frame);
        let position = link_from_frame.point(handc_runtime::vector::Vec3(offset));
        Point { link: frame.link, position: position.0.map(edit::number) }
    }

    /// Coordinates that are lengths are told in mm, angles in degrees.
    pub(crate) fn is_length(&self, coordinate: usize) -> bool {
        self.kind(coordinate) == CoordinateKind::Length
    }

    /// What a coordinate measures.
    pub(crate) fn kind(&self, coordinate: usize) -> CoordinateKind {
        self.model.layout().coordinates[coordinate].kind
    }
}
