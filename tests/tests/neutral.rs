//! Reference trajectories through mechanisms made from the neutral JSON.

use handc_core::simulation::{Settings, Simulation};
use handc_runtime::expression::Program;
use handc_runtime::interpreter::Interpreter;
use handc_runtime::mechanism::{Mechanism, Number, Scenario};
use handc_tests::neutral::mechanism;
use handc_tests::table::{Table, reference};
use std::sync::Arc;

fn read(name: &str) -> Mechanism {
    let text = std::fs::read_to_string(reference(name)).unwrap();
    mechanism(&serde_json::from_str(&text).unwrap())
}

/// Runs and returns the largest difference to the table over the rows up to `t_end`.
fn difference(mechanism: Mechanism, h: f64, t_end: f64, csv: &str) -> f64 {
    let table = Table::read(&reference(csv));
    let settings = Settings { step: Some(h), duration: Some(t_end), ..Settings::default() };
    let mut simulation = Simulation::new(Interpreter::new(Arc::new(mechanism)), &settings).unwrap();
    let n = simulation.state.q.len();
    let mut worst: f64 = 0.0;
    let compare = |state: &handc_core::step::State, row: &[f64]| {
        (0..n).map(|i| (state.q[i] - row[1 + i]).abs()).fold(0.0, f64::max)
    };
    let mut next = 0;
    for step in 0..=simulation.steps {
        if step > 0 {
            simulation.step().unwrap();
        }
        if next < table.rows.len() && (table.rows[next][0] - simulation.state.t).abs() < 0.1 * h {
            let d = compare(&simulation.state, &table.rows[next]);
            if std::env::var("SHOW").is_ok() && next % 10 == 0 {
                eprintln!("{} {d:.2e}", simulation.state.t);
            }
            worst = worst.max(d);
            next += 1;
        }
    }
    assert!(next > 10, "only {next} rows compared");
    eprintln!(
        "{csv} to {t_end} s: {worst:.2e}, {:.3} newton/step",
        simulation.iterations() as f64 / simulation.steps as f64
    );
    worst
}

fn motion(mechanism: &mut Mechanism, poses: &[Vec<f64>], knots: &[(u32, f64)]) {
    let pose = |p: &Vec<f64>| {
        p.iter().enumerate().map(|(i, &v)| (i as u32, Number::Constant(v))).collect::<Vec<_>>()
    };
    let strands = (0..mechanism.strands.len() as u32).collect();
    mechanism.scenarios.push(Scenario {
        name: "run".into(),
        poses: poses.iter().map(|p| (String::new(), pose(p))).collect(),
        motions: vec![(
            "motion".into(),
            knots.iter().map(|&(p, t)| (p, Number::Constant(t))).collect(),
        )],
        follow: vec![(0, strands)],
        ..Scenario::default()
    });
    let _ = Program::default();
}

fn hand(damping: f64) -> Mechanism {
    let mut hand = read("hand.json");
    let target = |name: &str| match name.rsplit('_').next().unwrap() {
        "ab" if name.contains("thumb") => 0.3,
        "ab" => 0.0,
        "cmc" => 0.5,
        "mcp" if name.contains("thumb") => 0.6,
        "ip" => 0.6,
        "mcp" => 1.1,
        "pip" => 1.3,
        _ => 0.8,
    };
    let fist: Vec<f64> = hand.coordinates.iter().map(|c| target(&c.name)).collect();
    for c in &mut hand.coordinates {
        c.damping = Number::Constant(damping);
    }
    let knots = [(0, 0.0), (1, 4.0), (1, 5.0), (0, 9.0), (0, 10.0)];
    motion(&mut hand, &[Vec::new(), fist], &knots);
    hand
}

#[test]
fn small_systems() {
    // The reference itself departs from the exact solution of the step equations (30 digits) by
    // 5.9e-10 at 250 steps and 1.3e-9 at 300.
    assert!(difference(read("double_pendulum.json"), 0.01, 2.5, "double_pendulum.csv") < 1e-9);
    assert!(difference(read("spring_pendulum.json"), 0.01, 5.0, "spring_pendulum.csv") < 1e-9);
    assert!(difference(read("damped_pendulum.json"), 0.01, 5.0, "damped_pendulum.csv") < 1e-9);
    assert!(difference(read("fourbar_distance.json"), 0.01, 5.0, "fourbar_distance.csv") < 1e-9);
}

#[test]
fn finger_through_three_motions() {
    let mut finger = read("finger.json");
    let poses = [vec![], vec![-0.9, -1.1, -0.6], vec![-0.2, -1.2, -0.7], vec![-1.0, -0.3, -0.2]];
    let knots = [
        (0, 0.0),
        (1, 4.0),
        (1, 8.0),
        (0, 12.0),
        (2, 16.0),
        (2, 20.0),
        (3, 24.0),
        (0, 28.0),
        (0, 30.0),
    ];
    motion(&mut finger, &poses, &knots);
    assert!(difference(finger, 0.01, 30.0, "finger_track.csv") < 1e-9);
}

#[test]
fn hand_closes_and_opens() {
    assert!(difference(hand(0.0), 0.001, 0.2, "hand_close_first200.csv") < 1e-10);
    assert!(difference(hand(0.0), 0.001, 1.0, "hand_close.csv") < 1e-8);
    assert!(difference(hand(0.0), 0.001, 4.0, "hand_close.csv") < 1e-6);
    assert!(difference(hand(0.0), 0.001, 10.0, "hand_close.csv") < 1e-5);
    assert!(difference(hand(1e-4), 0.001, 10.0, "hand_close_damped.csv") < 1e-8);
}
