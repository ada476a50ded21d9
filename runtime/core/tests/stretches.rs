//! Steps on lanes in one go, one by one, with other runs, and number by number: the same motion.
//!
//! The model is six pendulums, each held by a strand whose natural length follows a motion.

use handc_core::lane::functions::{mul_add, sin_cos};
use handc_core::lane::{Lane, use_at_most};
use handc_core::lanes::{LaneVisitor, next_revision};
use handc_core::layout::{
    Block, Coordinate, CoordinateKind, Follow, Layout, ScenarioLayout, Strand,
};
use handc_core::model::{Instant, Midpoint, Model, ScenarioValues};
use handc_core::shape::{Local, Place, Shape};
use handc_core::simulation::{Settings, Simulation};
use handc_core::together::Together;
use std::sync::Arc;

const PENDULUMS: usize = 6;
const STEP: f64 = 1e-3;
/// The largest angle (rad) of which vectors have a sine.
const LARGEST_ANGLE: f64 = 1e6;

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

#[derive(Clone)]
struct Pendulums {
    layout: Arc<Layout>,
    places: Vec<Place<1, 1, 0>>,
    constants: Vec<Constants>,
    /// Whether the first strand's natural length changes with time.
    varies: bool,
    revision: u64,
}

impl Pendulums {
    fn new(varies: bool) -> Self {
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
            muscle: None,
        };
        let block = |i| Block {
            coordinates: vec![i],
            rows: Vec::new(),
            parts: vec![1],
            matrix_offset: i,
            constraint_offset: 0,
        };
        let place = |i| Place { coordinates: [i], strands: [i], inputs: [], matrix: i, width: 1 };
        // The first strand follows none.
        let strands = (1..PENDULUMS).collect();
        let scenario = ScenarioLayout {
            name: "move".to_string(),
            follow: vec![Follow { motion: 0, strands }],
            ..ScenarioLayout::default()
        };
        let layout = Layout {
            name: "pendulums".to_string(),
            coordinates: (0..PENDULUMS).map(coordinate).collect(),
            strands: (0..PENDULUMS).map(strand).collect(),
            blocks: (0..PENDULUMS).map(block).collect(),
            scenarios: vec![scenario],
            length_scale: 0.1,
            ..Layout::default()
        };
        let constants = |i| [1e-3 * (1.0 + i as f64), 0.05, 2e3];
        Pendulums {
            layout: Arc::new(layout),
            places: (0..PENDULUMS).map(place).collect(),
            constants: (0..PENDULUMS).map(constants).collect(),
            varies,
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
    fn inputs(&mut self, _t: f64, _inputs: &mut [f64]) {}
    fn rests(&mut self, t: f64, _inputs: &[f64], rest: &mut [f64]) {
        if self.varies {
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
            poses: vec![pose(0.0), pose(0.8)],
            // Begins and ends amid a stretch.
            motions: vec![vec![(0, 0.0023), (1, 0.3307)]],
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
fn run(offset: f64, varies: bool) -> Simulation<Pendulums> {
    let settings = Settings { start_offset: vec![offset; PENDULUMS], ..Settings::default() };
    Simulation::new(Pendulums::new(varies), &settings).expect("a start")
}

/// The state at the end.
fn end(mut run: Simulation<Pendulums>, stretch: usize) -> [Vec<f64>; 3] {
    while run.state.step < run.steps {
        run.advance(stretch.min(run.steps - run.state.step)).expect("steps");
    }
    let rest = run.rest().to_vec();
    [run.state.q, run.state.p, rest]
}

/// What no two ways of rounding do to these pendulums in so many steps.
fn assert_close(found: &[Vec<f64>; 3], expected: &[Vec<f64>; 3], what: &str) {
    for (found, expected) in found.iter().zip(expected) {
        let size = expected.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
        for (x, y) in found.iter().zip(expected) {
            assert!((x - y).abs() <= 1e-10 * size, "{what}: {x} for {y}");
        }
    }
}

#[test]
fn all_ways_lead_to_the_same_motion() {
    // One test, since the width of vectors is the whole program's.
    for varies in [false, true] {
        use_at_most(1);
        // Vectors have no sine of the last one's angles: where it begins on lanes, it must leave them.
        let offsets = [0.0, 1e-3, -2e-3, 4e6];
        let expected = offsets.map(|offset| end(run(offset, varies), 1));
        let follow = |q: &f64| (q - 0.8).abs() < 0.2;
        assert!(expected[0][0].iter().skip(1).all(follow), "{:?}", expected[0][0]);
        for lanes in [4, 8] {
            use_at_most(lanes);
            for (offset, expected) in offsets.into_iter().zip(&expected) {
                let one_by_one = end(run(offset, varies), 1);
                assert_close(&one_by_one, expected, "on lanes");
                for stretch in [7, 64, 1000] {
                    let found = end(run(offset, varies), stretch);
                    assert_eq!(found, one_by_one, "{stretch} steps in one go");
                }
            }
            // The last run comes amid a stretch to where vectors have no sine: all go back then.
            let mut runs =
                offsets[..3].iter().map(|&offset| run(offset, varies)).collect::<Vec<_>>();
            runs.push(run(LARGEST_ANGLE - 0.2, varies));
            assert!(runs[3].state.q.iter().all(|&q| q < LARGEST_ANGLE));
            let mut together = Together::new(runs);
            while !together.is_over() {
                together.advance(usize::MAX, |run, error| panic!("run {run}: {error}"));
            }
            let runs = together.into_runs();
            assert!(runs[3].state.q.iter().any(|&q| q > LARGEST_ANGLE), "{:?}", runs[3].state.q);
            for (run, expected) in runs.into_iter().zip(&expected[..3]) {
                assert_close(
                    &[run.state.q.clone(), run.state.p.clone(), run.rest().to_vec()],
                    expected,
                    "together",
                );
            }
        }
    }
}
