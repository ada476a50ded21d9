//! A model for tests of steps on lanes: six pendulums, each held by a strand whose natural length
//! follows a motion.

use handc_core::lane::Lane;
use handc_core::lane::functions::{mul_add, sin_cos};
use handc_core::lanes::{LaneVisitor, next_revision};
use handc_core::layout::{
    Block, Coordinate, CoordinateKind, Follow, Layout, Muscle, Quantity, ScenarioLayout, Strand,
};
use handc_core::model::{Instant, Midpoint, Model, ScenarioValues};
use handc_core::shape::{Local, Place, Shape};
use handc_core::simulation::{Settings, Simulation};
use std::sync::Arc;

/// How many.
pub(crate) const PENDULUMS: usize = 6;
const STEP: f64 = 1e-3;
/// Excitation at the start, and how fast it grows (1/s).
pub(crate) const EXCITATION: [f64; 2] = [0.2, 3.0];

/// Of one pendulum: inertia (kg m²), weight times arm (N m), stiffness (N/m).
type Constants = [f64; 3];

struct Pendulum;

/// Length of the strand (m), and its first two derivatives.
fn length<L: Lane>(q: L) -> [L; 3] {
    let arm = L::splat(0.1);
    let (sine, cosine) = sin_cos(q);
    [mul_add(arm, sine, L::splat(0.5)), arm * cosine, -(arm * sine)]
}

impl Shape<1, 1, 1, 1, 0> for Pendulum {
    const CONSTANTS: usize = 3;

    fn evaluate<L: Lane>(
        at: &Local<L, 1, 1, 0>,
        constants: &[f64],
        momentum: &mut [L; 1],
        force: &mut [L; 1],
    ) {
        let [inertia, weight, stiffness] = [0, 1, 2].map(|k| L::load(&constants[k * L::WIDTH..]));
        let [length, length_dq, _] = length(at.q[0]);
        momentum[0] = inertia * at.v[0];
        let tension = stiffness * (length - at.rest[0]);
        force[0] = -(weight * sin_cos(at.q[0]).0) - tension * length_dq;
    }

    fn evaluate_with_matrix<L: Lane>(
        at: &Local<L, 1, 1, 0>,
        constants: &[f64],
        momentum: &mut [L; 1],
        force: &mut [L; 1],
        matrix: &mut [L; 1],
    ) {
        Self::evaluate(at, constants, momentum, force);
        let [inertia, weight, stiffness] = [0, 1, 2].map(|k| L::load(&constants[k * L::WIDTH..]));
        let [length, length_dq, length_dqdq] = length(at.q[0]);
        let bent = stiffness * (length - at.rest[0]) * length_dqdq;
        let force_dq = -(weight * sin_cos(at.q[0]).1 + stiffness * length_dq * length_dq + bent);
        matrix[0] = L::splat(0.25) * at.h * force_dq - inertia / at.h;
    }

    fn mass_matrix<L: Lane>(_q: &[L; 1], constants: &[f64], matrix: &mut [L; 1]) {
        matrix[0] = L::load(constants);
    }

    fn momentum_matrix<L: Lane>(at: &Local<L, 1, 1, 0>, constants: &[f64], matrix: &mut [L; 1]) {
        matrix[0] = L::load(constants) / at.h;
    }

    fn lengths<L: Lane>(q: &[L; 1], _constants: &[f64], lengths: &mut [L; 1]) {
        lengths[0] = length(q[0])[0];
    }
}

/// Which pendulums.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kind {
    /// Whether the first strand's natural length changes with time.
    pub(crate) varies: bool,
    /// Whether all have the same inertia and follow; else each has its own, and the first follows not.
    pub(crate) are_alike: bool,
    /// Whether the first strand is said to be a muscle, whose excitation grows by [`EXCITATION`].
    pub(crate) is_muscular: bool,
    /// Knots of the motion: pose, time (s).
    pub(crate) knots: &'static [(usize, f64)],
}

/// Six pendulums, each held by a strand whose natural length follows a motion.
#[derive(Clone)]
pub(crate) struct Pendulums {
    layout: Arc<Layout>,
    places: Vec<Place<1, 1, 0>>,
    constants: Vec<Constants>,
    kind: Kind,
    revision: u64,
}

impl Pendulums {
    pub(crate) fn new(kind: Kind) -> Self {
        let Kind { varies, are_alike, is_muscular, .. } = kind;
        let muscle = Muscle { fibre: 0, activation: 0, excitation: 0, has_start: true };
        let excitation = Quantity { name: "excitation".to_string(), unit: String::new() };
        let coordinate = |i| Coordinate {
            name: format!("q{i}"),
            kind: CoordinateKind::Angle,
            kinematic: false,
            is_static: false,
            is_internal: false,
        };
        let strand = |i| Strand {
            name: format!("s{i}"),
            has_rest: varies && i == 0,
            rest_varies: varies && i == 0,
            is_prescribed: false,
            actuator: None,
            muscle: (is_muscular && i == 0).then(|| muscle.clone()),
        };
        let block = |i| Block {
            coordinates: vec![i],
            rows: Vec::new(),
            parts: vec![1],
            matrix_offset: i,
            constraint_offset: 0,
        };
        let place = |i| Place { coordinates: [i], strands: [i], inputs: [], matrix: i, width: 1 };
        let strands = (usize::from(!are_alike)..PENDULUMS).collect();
        let scenario = ScenarioLayout {
            name: "move".to_string(),
            follow: vec![Follow { motion: 0, strands }],
            ..ScenarioLayout::default()
        };
        let layout = Layout {
            name: "pendulums".to_string(),
            inputs: if is_muscular { vec![excitation] } else { Vec::new() },
            coordinates: (0..PENDULUMS).map(coordinate).collect(),
            strands: (0..PENDULUMS).map(strand).collect(),
            blocks: (0..PENDULUMS).map(block).collect(),
            scenarios: vec![scenario],
            length_scale: 0.1,
            ..Layout::default()
        };
        let inertia = |i| 1e-3 * (1.0 + if are_alike { 0.0 } else { i as f64 });
        let constants = |i| [inertia(i), 0.05, 2e3];
        Pendulums {
            layout: Arc::new(layout),
            places: (0..PENDULUMS).map(place).collect(),
            constants: (0..PENDULUMS).map(constants).collect(),
            kind,
            revision: next_revision(),
        }
    }
}

impl Model for Pendulums {
    fn layout(&self) -> &Arc<Layout> {
        &self.layout
    }
    fn params(&self) -> &[f64] {
        &[]
    }
    fn set_param(&mut self, _index: usize, _value: f64) {}
    fn evaluate(&mut self, at: &Midpoint, momentum: &mut [f64], force: &mut [f64]) {
        for (place, constants) in self.places.iter().zip(&self.constants) {
            place.evaluate::<Pendulum, 1, 1>(at, constants, momentum, force);
        }
    }
    fn evaluate_with_matrix(
        &mut self,
        at: &Midpoint,
        h: f64,
        momentum: &mut [f64],
        force: &mut [f64],
        matrix: &mut [f64],
    ) {
        for (place, own) in self.places.iter().zip(&self.constants) {
            place.evaluate_with_matrix::<Pendulum, 1, 1>(at, h, own, momentum, force, matrix);
        }
    }
    fn constraints(&mut self, _q: &[f64], _t: f64, _rest: &[f64], _values: &mut [f64]) {}
    fn constraint_jacobian(&mut self, _q: &[f64], _t: f64, _jacobian: &mut [f64]) {}
    fn mass_matrix(&mut self, q: &[f64], matrix: &mut [f64]) {
        for (place, constants) in self.places.iter().zip(&self.constants) {
            place.mass_matrix::<Pendulum, 1, 1>(q, constants, matrix);
        }
    }
    fn potential(&mut self, _q: &[f64], _rest: &[f64]) -> f64 {
        0.0
    }
    fn strand_lengths(&mut self, q: &[f64], lengths: &mut [f64]) {
        for (place, constants) in self.places.iter().zip(&self.constants) {
            place.lengths::<Pendulum, 1, 1>(q, constants, lengths);
        }
    }
    fn inputs(&mut self, t: f64, inputs: &mut [f64]) {
        inputs.fill(EXCITATION[0] + EXCITATION[1] * t);
    }
    fn rests(&mut self, t: f64, _inputs: &[f64], rest: &mut [f64]) {
        if self.kind.varies {
            rest[0] = 0.5 + 0.03 * (9.0 * t).sin();
        }
    }
    fn drives(&mut self, _t: f64, _q: &mut [f64]) {}
    fn start(&mut self, q: &mut [f64], _v: &mut [f64]) {
        q.iter_mut().enumerate().for_each(|(i, q)| *q = 0.02 * i as f64);
    }
    fn scenario(&mut self, _scenario: usize) -> ScenarioValues {
        let pose = |angle| (0..PENDULUMS).map(|i| (i, angle)).collect();
        ScenarioValues {
            step: Some(STEP),
            duration: Some(0.5),
            poses: vec![pose(0.0), pose(0.8), pose(-0.3)],
            motions: vec![self.kind.knots.to_vec()],
            ..ScenarioValues::default()
        }
    }
    fn scenario_inputs(&mut self, _scenario: usize, _t: f64, _inputs: &mut [f64]) {}
    fn scenario_drives(&mut self, _scenario: usize, _t: f64, _q: &mut [f64]) {}
    fn scenario_records(&mut self, _scenario: usize, _at: &Instant, _values: &mut [f64]) {}
    fn revision(&self) -> u64 {
        self.revision
    }
    fn on_lanes(models: &[&Self], visitor: &mut impl LaneVisitor) -> bool {
        visitor.blocks::<Pendulum, 1, 1, 1, 1, 0>(&models[0].places, |run| {
            models[run].constants.as_flattened()
        });
        visitor.is_complete()
    }
}

/// A run whose start is off by so much.
pub(crate) fn run(offset: f64, kind: Kind) -> Simulation<Pendulums> {
    let settings = Settings { start_offset: vec![offset; PENDULUMS], ..Settings::default() };
    Simulation::new(Pendulums::new(kind), &settings).expect("a start")
}

/// Coordinates, momenta and natural lengths at the end of a run in stretches.
pub(crate) fn end(mut run: Simulation<Pendulums>, stretch: usize) -> [Vec<f64>; 3] {
    while run.state.step < run.steps {
        run.advance(stretch.min(run.steps - run.state.step)).expect("steps");
    }
    last(&run)
}

/// Coordinates, momenta and natural lengths now.
pub(crate) fn last(run: &Simulation<Pendulums>) -> [Vec<f64>; 3] {
    [run.state.q.clone(), run.state.p.clone(), run.rest().to_vec()]
}
