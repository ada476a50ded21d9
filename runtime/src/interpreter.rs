//! The interpreter: the mechanics over `f64` behind the trait that the integrator runs.
//!
//! A generated crate answers the same trait with straight-line code; this file is what it must
//! agree with.

use crate::dual::Dual;
use crate::expression::{Program, StrandQuantity, StrandState, Variable};
use crate::mechanics::{At, Mechanics, Workspace};
use crate::mechanism::{Law, Mechanism, Number, Point, Role};
use crate::resolved::Resolved;
use crate::structure::Structure;
use crate::vector::Transform;
use handc_core::lanes::next_revision;
use handc_core::layout::{
    ConstraintRow, Coordinate, CoordinateKind, Follow, Layout, Muscle, Quantity, Requirement,
    ScenarioLayout, Strand, Wrap,
};
use handc_core::model::{Instant, Midpoint, Model, ScenarioValues};
use std::sync::Arc;

/// A mechanism that runs.
#[derive(Clone, Debug)]
pub struct Interpreter {
    mechanism: Arc<Mechanism>,
    structure: Arc<Structure>,
    layout: Arc<Layout>,
    numbers: Resolved<f64>,
    workspace: Workspace<f64>,
    scratch: Vec<f64>,
    revision: u64,
}

impl Interpreter {
    /// Prepares a mechanism with its default parameters.
    pub fn new(mechanism: Arc<Mechanism>) -> Self {
        let structure = Arc::new(Structure::new(&mechanism));
        let params: Vec<f64> = mechanism.params.iter().map(|p| p.default).collect();
        Interpreter {
            layout: Arc::new(layout(&mechanism, &structure)),
            numbers: Resolved::new(&mechanism, &params),
            revision: next_revision(),
            workspace: Workspace::new(&structure),
            scratch: Vec::new(),
            mechanism,
            structure,
        }
    }

    /// The mechanism.
    pub fn mechanism(&self) -> &Arc<Mechanism> {
        &self.mechanism
    }
    /// Its shape.
    pub fn structure(&self) -> &Arc<Structure> {
        &self.structure
    }
    /// By how much momenta change with the increment of a step `h` at a midpoint, M/h + ½∂p/∂q, packed as
    /// the mass matrix (kg·m²/s, kg·m/s or kg/s).
    pub fn momentum_matrix(&mut self, at: &Midpoint, h: f64, matrix: &mut [f64]) {
        let (mechanics, workspace) = self.mechanics();
        mechanics.momentum_matrix(workspace, at.q, at.v, 1.0 / h, matrix);
    }

    /// Moment arms ∂length/∂q at q (m/rad or 1), s × n by rows.
    pub fn moment_arms(&mut self, q: &[f64], length_dq: &mut [f64]) {
        let (mechanics, workspace) = self.mechanics();
        mechanics.moment_arms(workspace, q, length_dq);
    }
    /// Motion of a point fixed in a link (rows 0 to 2) and turning of the link (rows 3 to 5) by every
    /// coordinate, in world axes, 6 × n by rows.
    pub fn point_jacobian(&mut self, q: &[f64], point: &Point, jacobian: &mut [f64]) {
        let (mechanics, workspace) = self.mechanics();
        mechanics.point_jacobian(workspace, q, point, jacobian);
    }
    /// How the constraint force Dhᵀλ changes with the coordinates at q, Σλ_r ∂²h_r/∂q², n × n.
    /// Exact, by dual numbers; not on a step's path.
    pub fn constraint_curvature(&self, q: &[f64], t: f64, lambda: &[f64]) -> Vec<f64> {
        let n = q.len();
        let mut curvature = vec![0.0; n * n];
        let params: Vec<Dual<f64>> = self.numbers.params.iter().map(|&p| Dual::fixed(p)).collect();
        let numbers = Resolved::new(&self.mechanism, &params);
        let mechanics =
            Mechanics { mechanism: &self.mechanism, structure: &self.structure, numbers: &numbers };
        let mut workspace = Workspace::new(&self.structure);
        let mut jacobian = vec![Dual::fixed(0.0); self.layout.constraint_size()];
        let mut at: Vec<Dual<f64>> = q.iter().map(|&q| Dual::fixed(q)).collect();
        for j in 0..n {
            at[j].slope = 1.0;
            mechanics.constraint_jacobian(&mut workspace, &at, Dual::fixed(t), &mut jacobian);
            at[j].slope = 0.0;
            for block in &self.layout.blocks {
                let width = block.coordinates.len();
                for (row, &r) in block.rows.iter().enumerate() {
                    for (column, &i) in block.coordinates.iter().enumerate() {
                        let entry = jacobian[block.constraint_offset + row * width + column];
                        curvature[i * n + j] += lambda[r] * entry.slope;
                    }
                }
            }
        }
        curvature
    }
    /// Transforms `world_from_frame` of the named frames, in the mechanism's order.
    pub fn frame_poses(&mut self, q: &[f64]) -> Vec<Transform<f64>> {
        let (mechanics, workspace) = self.mechanics();
        mechanics.frame_poses(workspace, q)
    }

    /// Transforms `world_from_link` of all links at q.
    pub fn link_poses(&mut self, q: &[f64]) -> Vec<Transform<f64>> {
        let (mechanics, workspace) = self.mechanics();
        mechanics.link_poses(workspace, q)
    }

    /// The equations with the parameters at hand.
    pub(crate) fn equations(&self) -> Mechanics<'_, f64> {
        Mechanics { mechanism: &self.mechanism, structure: &self.structure, numbers: &self.numbers }
    }

    /// Sets all parameters.
    pub fn set_params(&mut self, params: &[f64]) {
        if self.numbers.params != params {
            self.numbers = Resolved::new(&self.mechanism, params);
            self.revision = next_revision();
        }
    }

    fn mechanics(&mut self) -> (Mechanics<'_, f64>, &mut Workspace<f64>) {
        let mechanics = Mechanics {
            mechanism: &self.mechanism,
            structure: &self.structure,
            numbers: &self.numbers,
        };
        (mechanics, &mut self.workspace)
    }

    /// What every strand does at a state. The tension of a strand whose length is prescribed is its
    /// multiplier over the step and zero here.
    pub fn strand_states(&mut self, at: &Midpoint, states: &mut [StrandState<f64>]) {
        let (mechanics, workspace) = self.mechanics();
        mechanics.strand_states(workspace, &point(at), states);
    }

    /// As [`Interpreter::strand_states`], at an instant of a run.
    pub fn strand_states_at(&mut self, at: &Instant, states: &mut [StrandState<f64>]) {
        let Instant { q, v, t, rest, inputs, .. } = *at;
        self.strand_states(&Midpoint { q, v, t, rest, inputs }, states);
        for &(row, strand) in &self.structure.prescribed {
            states[strand][StrandQuantity::Tension as usize] = at.lambda[row] / at.h;
        }
    }

    fn in_time(&mut self, program: &Program, t: f64, inputs: &[f64]) -> f64 {
        let params = &self.numbers.params;
        let read = |variable| match variable {
            Variable::Time => t,
            Variable::Param(i) => params[i as usize],
            Variable::Input(i) => inputs[i as usize],
            _ => f64::NAN,
        };
        program.evaluate(read, &mut self.scratch);
        program.output(&self.scratch, 0)
    }

    fn numbers_of(&self, pairs: &[(u32, Number)]) -> Vec<(usize, f64)> {
        pairs.iter().map(|(i, n)| (*i as usize, self.numbers.number(*n))).collect()
    }
}

impl Model for Interpreter {
    fn layout(&self) -> &Arc<Layout> {
        &self.layout
    }
    fn params(&self) -> &[f64] {
        &self.numbers.params
    }
    fn set_param(&mut self, index: usize, value: f64) {
        let mut params = self.numbers.params.clone();
        params[index] = value;
        self.set_params(&params);
    }
    fn revision(&self) -> u64 {
        self.revision
    }
    fn evaluate(&mut self, at: &Midpoint, momentum: &mut [f64], force: &mut [f64]) {
        let (mechanics, workspace) = self.mechanics();
        mechanics.evaluate(workspace, &point(at), momentum, force, None);
    }
    fn evaluate_with_matrix(
        &mut self,
        at: &Midpoint,
        h: f64,
        momentum: &mut [f64],
        force: &mut [f64],
        matrix: &mut [f64],
    ) {
        let (mechanics, workspace) = self.mechanics();
        mechanics.evaluate(workspace, &point(at), momentum, force, Some((h, matrix)));
    }
    fn required_numbers(&mut self, numbers: &mut [f64]) {
        self.mechanics().0.required_numbers(numbers);
    }
    fn constraints(&mut self, q: &[f64], t: f64, rest: &[f64], values: &mut [f64]) {
        let (mechanics, workspace) = self.mechanics();
        mechanics.constraints(workspace, q, t, rest, values);
    }
    fn constraint_jacobian(&mut self, q: &[f64], t: f64, jacobian: &mut [f64]) {
        let (mechanics, workspace) = self.mechanics();
        mechanics.constraint_jacobian(workspace, q, t, jacobian);
    }
    fn mass_matrix(&mut self, q: &[f64], matrix: &mut [f64]) {
        let (mechanics, workspace) = self.mechanics();
        mechanics.mass_matrix(workspace, q, matrix);
    }
    fn potential(&mut self, q: &[f64], rest: &[f64]) -> f64 {
        let (mechanics, workspace) = self.mechanics();
        mechanics.potential(workspace, q, rest)
    }
    fn strand_lengths(&mut self, q: &[f64], lengths: &mut [f64]) {
        let (mechanics, workspace) = self.mechanics();
        mechanics.strand_lengths(workspace, q, lengths);
    }
    fn commands(&mut self, at: &Midpoint, tensions: &mut [f64]) {
        let (mechanics, workspace) = self.mechanics();
        mechanics.commands(workspace, &point(at), tensions);
    }
    fn clearances(&mut self, q: &[f64], clearances: &mut [f64]) {
        let (mechanics, workspace) = self.mechanics();
        mechanics.clearances(workspace, q, clearances);
    }
    fn inputs(&mut self, t: f64, inputs: &mut [f64]) {
        let mechanism = Arc::clone(&self.mechanism);
        for (input, value) in mechanism.inputs.iter().zip(inputs) {
            *value = self.in_time(&input.default, t, &[]);
        }
    }
    fn rests(&mut self, t: f64, inputs: &[f64], rest: &mut [f64]) {
        let mechanism = Arc::clone(&self.mechanism);
        for (strand, value) in mechanism.strands.iter().zip(rest) {
            if let Some(program) = &strand.rest {
                *value = self.in_time(program, t, inputs);
            }
        }
    }
    fn drives(&mut self, t: f64, q: &mut [f64]) {
        let mechanism = Arc::clone(&self.mechanism);
        for (coordinate, value) in mechanism.coordinates.iter().zip(q) {
            if let Some(program) = &coordinate.drive {
                *value = self.in_time(program, t, &[]);
            }
        }
    }
    fn start(&mut self, q: &mut [f64], v: &mut [f64]) {
        for (i, coordinate) in self.mechanism.coordinates.iter().enumerate() {
            q[i] = self.numbers.number(coordinate.start);
            v[i] = self.numbers.number(coordinate.velocity);
        }
    }
    fn scenario(&mut self, scenario: usize) -> ScenarioValues {
        let scenario = &self.mechanism.scenarios[scenario];
        let number = |n: Option<Number>| n.map(|n| self.numbers.number(n));
        ScenarioValues {
            set: self.numbers_of(&scenario.set),
            step: number(scenario.step),
            duration: number(scenario.duration),
            tolerance: number(scenario.tolerance),
            start: self.numbers_of(&scenario.start),
            velocity: self.numbers_of(&scenario.velocity),
            poses: scenario.poses.iter().map(|(_, pose)| self.numbers_of(pose)).collect(),
            motions: scenario.motions.iter().map(|(_, knots)| self.numbers_of(knots)).collect(),
        }
    }
    fn scenario_inputs(&mut self, scenario: usize, t: f64, inputs: &mut [f64]) {
        let mechanism = Arc::clone(&self.mechanism);
        for (input, program) in &mechanism.scenarios[scenario].inputs {
            inputs[*input as usize] = self.in_time(program, t, &[]);
        }
    }
    fn scenario_drives(&mut self, scenario: usize, t: f64, q: &mut [f64]) {
        let mechanism = Arc::clone(&self.mechanism);
        for (coordinate, program) in &mechanism.scenarios[scenario].drives {
            q[*coordinate as usize] = self.in_time(program, t, &[]);
        }
    }
    fn scenario_rests(&mut self, scenario: usize, t: f64, rest: &mut [f64]) {
        let mechanism = Arc::clone(&self.mechanism);
        for (strand, program) in &mechanism.scenarios[scenario].lengths {
            rest[*strand as usize] = self.in_time(program, t, &[]);
        }
    }
    fn scenario_records(&mut self, scenario: usize, at: &Instant, values: &mut [f64]) {
        let mechanism = Arc::clone(&self.mechanism);
        let records = &mechanism.scenarios[scenario].records;
        let reads_length = |variable: &Variable| matches!(variable, Variable::Length(_));
        let mut lengths = vec![0.0; mechanism.strands.len()];
        if records.iter().any(|(_, program)| program.variables().iter().any(reads_length)) {
            self.strand_lengths(at.q, &mut lengths);
        }
        let reads_states = |variable: &Variable| matches!(variable, Variable::Strand(..));
        let mut states = vec![[0.0; StrandQuantity::COUNT]; mechanism.strands.len()];
        if records.iter().any(|(_, program)| program.variables().iter().any(reads_states)) {
            self.strand_states_at(at, &mut states);
        }
        let params = &self.numbers.params;
        let read = |variable| match variable {
            Variable::Time => at.t,
            Variable::Param(i) => params[i as usize],
            Variable::Input(i) => at.inputs[i as usize],
            Variable::Coordinate(i) => at.q[i as usize],
            Variable::Rate(i) => at.v[i as usize],
            Variable::Length(i) => lengths[i as usize],
            Variable::Multiplier(i) => at.lambda[i as usize],
            Variable::Strand(quantity, i) => states[i as usize][quantity as usize],
            Variable::Own(_) => f64::NAN,
        };
        for ((_, program), value) in records.iter().zip(values) {
            program.evaluate(read, &mut self.scratch);
            *value = program.output(&self.scratch, 0);
        }
    }
}

fn point<'a>(at: &Midpoint<'a>) -> At<'a, f64> {
    At { q: at.q, v: at.v, t: at.t, rest: at.rest, inputs: at.inputs }
}

/// Names, units and blocks of a mechanism; the same for the interpreter and for generated code.
pub fn layout(mechanism: &Mechanism, structure: &Structure) -> Layout {
    let quantity = |name: &str, unit: &str| Quantity { name: name.into(), unit: unit.into() };
    Layout {
        name: mechanism.name.clone(),
        params: mechanism.params.iter().map(|p| quantity(&p.name, &p.unit)).collect(),
        inputs: mechanism.inputs.iter().map(|i| quantity(&i.name, &i.unit)).collect(),
        coordinates: mechanism
            .coordinates
            .iter()
            .enumerate()
            .map(|(i, c)| Coordinate {
                name: c.name.clone(),
                kind: match (c.role, c.is_length) {
                    (Role::Activation, _) => CoordinateKind::Ratio,
                    (_, true) => CoordinateKind::Length,
                    (_, false) => CoordinateKind::Angle,
                },
                kinematic: c.drive.is_some(),
                is_static: structure.is_static[i],
                is_internal: structure.is_internal[i],
            })
            .collect(),
        strands: mechanism
            .strands
            .iter()
            .map(|s| Strand {
                name: s.name.clone(),
                has_rest: s.rest.is_some(),
                rest_varies: s.rest.as_ref().is_some_and(Program::varies),
                is_prescribed: s.law == Law::Prescribed,
                actuator: s.actuator.map(|input| input as usize),
                muscle: s.muscle().map(|muscle| Muscle {
                    fibre: muscle.fibre as usize,
                    activation: muscle.activation as usize,
                    excitation: muscle.excitation as usize,
                    has_start: muscle.start.is_some(),
                }),
            })
            .collect(),
        wraps: mechanism
            .strands
            .iter()
            .enumerate()
            .flat_map(|(strand, s)| s.wraps.iter().map(move |wrap| (strand, wrap)))
            .map(|(strand, wrap)| Wrap { strand, surface: wrap.to_string() })
            .collect(),
        requirements: mechanism
            .requirements
            .iter()
            .map(|r| Requirement {
                text: r.text.clone(),
                source: r.source.clone(),
                least: r.least,
                most: r.most,
            })
            .collect(),
        rows: mechanism
            .constraints
            .iter()
            .flat_map(|c| {
                let name = &c.name;
                c.row_suffixes()
                    .into_iter()
                    .map(move |suffix| ConstraintRow { name: format!("{name}{suffix}") })
            })
            .collect(),
        blocks: structure.blocks.clone(),
        scenarios: mechanism
            .scenarios
            .iter()
            .map(|s| ScenarioLayout {
                name: s.name.clone(),
                driven: s.drives.iter().map(|(c, _)| *c as usize).collect(),
                follow: s
                    .follow
                    .iter()
                    .map(|(motion, strands)| Follow {
                        motion: *motion as usize,
                        strands: strands.iter().map(|&s| s as usize).collect(),
                    })
                    .collect(),
                records: s.records.iter().map(|(name, _)| name.clone()).collect(),
            })
            .collect(),
        length_scale: length_scale(mechanism),
    }
}

/// The largest constant offset in the mechanism (m), 1 where there is none.
fn length_scale(mechanism: &Mechanism) -> f64 {
    let links = mechanism.links.iter().flat_map(|l| l.parent_from_joint.translation);
    let points = mechanism.strands.iter().flat_map(|s| &s.points).flat_map(|p| p.position);
    let wraps = mechanism.strands.iter().flat_map(|s| &s.wraps).flat_map(|w| w.center.position);
    let bodies = mechanism.bodies.iter().flat_map(|b| b.center);
    let frames = mechanism.frames.iter().flat_map(|f| f.link_from_frame.translation);
    let largest = links
        .chain(points)
        .chain(wraps)
        .chain(bodies)
        .chain(frames)
        .map(|number| match number {
            Number::Constant(value) => value.abs(),
            Number::Value(_) => 0.0,
        })
        .fold(0.0, f64::max);
    if largest > 0.0 { largest } else { 1.0 }
}
