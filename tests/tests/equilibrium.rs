//! Static equilibrium: closed forms, the end of long damped runs, stiffness against differences, and
//! what has no equilibrium.

#[path = "support/run.rs"]
mod run;

use handc_core::model::Model;
use handc_core::start::project;
use handc_runtime::analysis::equilibrium::{Equilibrium, EquilibriumError, equilibrium};
use handc_runtime::analysis::linear::Held;
use handc_runtime::analysis::tangent::{Stability, Tangent};
use handc_runtime::interpreter::Interpreter;
use run::{Run, advance, apart, model, start, start_for, text};
use std::f64::consts::PI;

/// The rest that is found from the start of a run, with its natural lengths.
fn rest_of(run: &mut Run) -> Result<Equilibrium, EquilibriumError> {
    let (q, rest) = (run.state.q.clone(), run.rest().to_vec());
    let (inputs, driven) = (run.inputs().to_vec(), run.driven().to_vec());
    let held = Held { t: 0.0, rest: &rest, inputs: &inputs, driven: &driven };
    equilibrium(&mut run.model, &q, &held)
}

fn rest_of_text(body: &str) -> Result<Equilibrium, EquilibriumError> {
    rest_of(&mut start(text(body), None, 1e-3))
}

/// The zero of a function between two places of different sign.
fn bisect(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    assert!(f(low) * f(high) < 0.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if f(low) * f(middle) <= 0.0 { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

#[test]
fn a_lever_on_a_spring() {
    // k q = m g l cos q for a lever that is level at q = 0 and sinks when positive.
    let found = rest_of_text(
        "gravity = (0, 0, -9.81) m/s^2;
         joint q: revolute(y) in world { stiffness = 0.4 N*m/rad; }
         mass m in q { mass = 0.2 kg; at = (0.15, 0, 0) m; }",
    )
    .unwrap();
    let torque = 0.2 * 9.81 * 0.15;
    let expected = bisect(|q| 0.4 * q - torque * q.cos(), 0.0, 1.5);
    assert!((found.q[0] - expected).abs() < 1e-14, "{:?} {expected}", found.q);
    // Stiffness k + m g l sin q.
    let stiffness = 0.4 + torque * expected.sin();
    assert!((found.tangent.directions[0].stiffness - stiffness).abs() < 1e-13);
    assert_eq!(found.tangent.stability(), Stability::Stable);
}

#[test]
fn a_pendulum_leaves_its_upper_rest() {
    let found = rest_of_text(
        "gravity = (0, 0, -9.81) m/s^2;
         joint q: revolute(y) in world { start = 180 deg; damping = 1 N*m*s/rad; }
         mass m in q { mass = 1 kg; at = (0, 0, -1) m; }",
    )
    .unwrap();
    assert_eq!(found.left, 1);
    let turns = found.q[0] / (2.0 * PI);
    assert!((turns - turns.round()).abs() < 1e-13, "{:?}", found.q);
    // Damping is no stiffness.
    assert!((found.tangent.directions[0].stiffness - 9.81).abs() < 1e-12);
}

#[test]
fn a_weight_on_a_strand() {
    // A slider of lengths: x = m g / k below the natural length, beside one that nothing pushes.
    let found = rest_of_text(
        "gravity = (0, 0, -9.81) m/s^2;
         joint z: prismatic(z) in world { start = -0.1 m; }
         mass m in z { mass = 0.3 kg; }
         joint y: prismatic(y) in z;
         mass n in y { mass = 0.1 kg; }
         strand s { path = world -> z; stiffness = 80 N/m; rest = 0.1 m; }",
    )
    .unwrap();
    assert!((found.q[0] + 0.1 + 0.4 * 9.81 / 80.0).abs() < 1e-15, "{:?}", found.q);
    assert_eq!(found.tangent.stability(), Stability::Neutral);
}

#[test]
fn a_loop_at_rest_is_where_a_damped_run_ends() {
    // The four-bar with friction in its joints, and a slider-crank on a spring.
    let fourbar = "gravity = (0, 0, -9.81) m/s^2;
         joint crank: revolute((0, -1, 0)) in world { start = 1.0 rad; damping = 0.05 N*m*s/rad; }
         mass crank_bar in crank = box { at = (50, 0, 0) mm; size = (100, 10, 10) mm; mass = 0.1 kg; }
         joint coupler: revolute((0, -1, 0)) in crank at (100, 0, 0) mm { start = -0.361 rad; damping = 0.05 N*m*s/rad; }
         mass coupler_bar in coupler = box { at = (175, 0, 0) mm; size = (350, 10, 10) mm; mass = 0.35 kg; }
         joint rocker: revolute((0, -1, 0)) in world at (400, 0, 0) mm { start = 1.789 rad; }
         mass rocker_bar in rocker = box { at = (150, 0, 0) mm; size = (300, 10, 10) mm; mass = 0.3 kg; }
         constraint pin: coincident(coupler (350, 0, 0) mm, rocker (300, 0, 0) mm, axes = (x, z));";
    let slider = "gravity = (0, -9.81, 0) m/s^2;
         joint crank: revolute(z) in world { start = 0.3; damping = 0.02 N*m*s/rad; }
         mass disc in crank { mass = 0.5 kg; at = (0.05, 0, 0) m; }
         joint rod: revolute(z) in crank at (50, 0, 0) mm { start = -0.4; }
         mass rod_bar in rod { mass = 0.3 kg; at = (0.1, 0, 0) m; }
         joint piston: prismatic(x) in world { start = 0.24 m; stiffness = 20 N/m; rest = 0.2 m; damping = 1 N*s/m; }
         mass piston_body in piston { mass = 0.4 kg; }
         constraint pin: coincident(rod (200, 0, 0) mm, piston, axes = (x, y));";
    for (body, h, duration) in [(fourbar, 2e-3, 60.0), (slider, 2e-3, 60.0)] {
        let mut run = start_for(text(body), None, h, duration);
        let found = rest_of(&mut run).unwrap();
        let steps = run.steps;
        advance(&mut run, steps);
        let apart = apart(&found.q, &run.state.q);
        eprintln!("{apart:.1e} from the end of the run, {} steps", found.steps);
        assert!(apart < 1e-9, "{:?} {:?}", found.q, run.state.q);
        // Multipliers are forces: those of the run, over its step.
        let forces: Vec<f64> = run.state.lambda.iter().map(|l| l / h).collect();
        let scale = forces.iter().fold(0.0, |a: f64, f| a.max(f.abs()));
        for (reaction, force) in found.tangent.reaction.iter().zip(&forces) {
            assert!((reaction - force).abs() < 1e-7 * scale, "{reaction} {force}");
        }
        assert_eq!(found.tangent.stability(), Stability::Stable);
    }
}

#[test]
fn a_hand_with_other_natural_lengths_rests_where_slow_motion_ends() {
    let hand = handc_tests::load::repository("tests/fixtures/hand_damped.hdl");
    let hand = handc_tests::load::interpreter(&hand);
    let mut run = start_for(hand, None, 1e-3, 1.0);
    // Natural lengths of a pose away from the start, and flexors pulled.
    let mut q = run.state.q.clone();
    q.iter_mut().for_each(|q| *q += 0.1);
    let mut rest = run.rest().to_vec();
    run.model.strand_lengths(&q, &mut rest);
    for (strand, rest) in run.layout().strands.clone().iter().zip(&mut rest) {
        if strand.name.contains("fdp") || strand.name.contains("fpl") {
            *rest -= 0.002;
        }
    }
    let (inputs, driven) = (run.inputs().to_vec(), run.driven().to_vec());
    let held = Held { t: 0.0, rest: &rest, inputs: &inputs, driven: &driven };
    let start = run.state.q.clone();
    let found = equilibrium(&mut run.model, &start, &held).unwrap();
    assert_eq!(found.tangent.stability(), Stability::Stable);
    // Motion without mass, c·v = f, comes to the same rest.
    let mut q = start;
    for _ in 0..200_000 {
        let at = Tangent::at(&mut run.model, &q, &held).unwrap();
        let most = at.residual.iter().fold(0.0, |a: f64, f| a.max(f.abs()));
        if most < 1e-12 {
            break;
        }
        q.iter_mut().zip(&at.residual).for_each(|(q, f)| *q += 4.0 * f);
    }
    let apart = apart(&found.q, &q);
    eprintln!("hand: {apart:.1e}, {} steps", found.steps);
    assert!(apart < 1e-7, "{apart:.1e}");
}

/// The force left over a little way along each direction, against the tangent stiffness.
fn stiffness_holds(model: &mut Interpreter, start: &[f64], held: &Held) -> f64 {
    let mut q = start.to_vec();
    project(model, &mut q, held.rest, held.driven).unwrap();
    let at = Tangent::at(model, &q, held).unwrap();
    let mut worst: f64 = 0.0;
    for direction in &at.directions {
        let size = 1e-5;
        let mut along = |sign: f64| {
            let mut there: Vec<f64> =
                q.iter().zip(&direction.shape).map(|(q, s)| q + sign * size * s).collect();
            project(model, &mut there, held.rest, held.driven).unwrap();
            let residual = Tangent::at(model, &there, held).unwrap().residual;
            residual.iter().zip(&direction.shape).map(|(f, s)| f * s).sum::<f64>()
        };
        let found = -(along(1.0) - along(-1.0)) / (2.0 * size);
        worst = worst.max((found - direction.stiffness).abs() / at.stiffest().max(1e-3));
    }
    worst
}

#[test]
fn stiffness_is_the_slope_of_the_force_on_the_constraints() {
    for name in ["fourbar", "slider_crank", "squeezer", "grasp", "hand"] {
        let model = model(name);
        let scenario = model.layout().scenarios[0].name.clone();
        let mut run = start(model, Some(&scenario), 1e-3);
        let (mut q, rest) = (run.state.q.clone(), run.rest().to_vec());
        q.iter_mut().enumerate().for_each(|(i, q)| *q += 0.01 * (i as f64).sin());
        let (inputs, driven) = (run.inputs().to_vec(), run.driven().to_vec());
        let held = Held { t: 0.0, rest: &rest, inputs: &inputs, driven: &driven };
        let worst = stiffness_holds(&mut run.model, &q, &held);
        eprintln!("{name}: {worst:.1e} of the stiffness");
        assert!(worst < 2e-6, "{name}: {worst:.1e}");
    }
}

#[test]
fn what_nothing_holds_is_told() {
    let wheel = "joint q: revolute(z) in world;
         mass m in q { mass = 1 kg; at = (0.1, 0, 0) m; }
         joint r: revolute(z) in q at (0.2, 0, 0) m { stiffness = 1 N*m/rad; }
         mass n in r { mass = 1 kg; at = (0.1, 0, 0) m; }
         torque w on q = 0.01 N*m;";
    let error = rest_of_text(wheel).unwrap_err();
    let EquilibriumError::NotFound { coordinate, force, moved, .. } = &error else {
        panic!("{error}")
    };
    assert_eq!((coordinate.as_str(), moved.as_str()), ("q", "q"));
    assert!((force - 0.01).abs() < 1e-15);
    assert!(error.to_string().contains("something that holds `q`"), "{error}");
}
