//! What the integrator keeps: momentum, energy without drift, the way back, constraints.

#[path = "support/run.rs"]
mod run;

use handc_core::model::Model;
use handc_core::step::State;
use run::{advance, apart, model, start, text};

/// Two plates in a plane, joined by two strands; three points in space, joined by three. Linear
/// momentum, and angular momentum about the origin, stay to 1e-9: of their size for the points, of
/// one plate's momentum for the plates, whose angles keep growing.
#[test]
fn momentum_of_bodies_joined_by_strands() {
    let plates = text(
        "joint a: planar(z) in world { velocity = (0.3 m/s, -0.2 m/s, 2 rad/s); }
         mass ma in a { mass = 0.5 kg; at = (0.05, 0.02, 0) m; inertia = (1, 1, 2) g*m^2; }
         joint b: planar(z) in world { start = (0.4 m, 0.1 m, 0.3 rad); velocity = (-0.15363 m/s, 0.03384 m/s, -1 rad/s); }
         mass mb in b { mass = 0.8 kg; at = (-0.03, 0, 0) m; inertia = (2, 2, 4) g*m^2; }
         strand s1 { path = a (0.1, 0, 0) m -> b (-0.1, 0.05, 0) m; stiffness = 40 N/m; rest = 0.15 m; }
         strand s2 { path = a (0, 0.1, 0) m -> b (-0.1, -0.05, 0) m; stiffness = 60 N/m; rest = 0.2 m; }",
    );
    let total = |state: &State| {
        let (q, p) = (&state.q, &state.p);
        // The angle turns each plate about its own sliders' origin.
        let spin = |k: usize| q[k] * p[k + 1] - q[k + 1] * p[k] + p[k + 2];
        [p[0] + p[3], p[1] + p[4], spin(0) + spin(3)]
    };
    let mut run = start(plates, None, 0.005);
    let first = total(&run.state);
    let mut worst: f64 = 0.0;
    for _ in 0..200 {
        advance(&mut run, 1000);
        worst = worst.max(apart(&total(&run.state), &first));
    }
    eprintln!("plates: {worst:.1e} of {first:.2?} over {} steps", run.state.step);
    assert!(worst < 1e-9 * 0.14);

    let point = |name: &str, place: &str, x: f64, y: f64, z: f64| {
        format!(
            "joint {name}x: prismatic(x) in world at {place} m {{ velocity = {x} m/s; }}
             joint {name}y: prismatic(y) in {name}x {{ velocity = {y} m/s; }}
             joint {name}z: prismatic(z) in {name}y {{ velocity = {z} m/s; }}
             mass {name}m in {name}z {{ mass = 0.4 kg; }}\n"
        )
    };
    let strand = |a: &str, b: &str| {
        format!("strand {a}{b} {{ path = {a}z -> {b}z; stiffness = 30 N/m; rest = 0.3 m; }}\n")
    };
    let points = point("a", "(0, 0, 0)", 0.5, 0.1, -0.2)
        + &point("b", "(0.4, 0, 0.1)", -0.1, 0.6, 0.3)
        + &point("c", "(0, 0.5, 0)", 0.2, 0.0, 0.4)
        + &strand("a", "b")
        + &strand("b", "c")
        + &strand("c", "a");
    let offsets = [[0.0, 0.0, 0.0], [0.4, 0.0, 0.1], [0.0, 0.5, 0.0]];
    let total = |state: &State| {
        let mut sum = [0.0; 6];
        for (k, offset) in offsets.iter().enumerate() {
            let x = [0, 1, 2].map(|i| state.q[3 * k + i] + offset[i]);
            let p = &state.p[3 * k..3 * k + 3];
            for i in 0..3 {
                let (j, l) = ((i + 1) % 3, (i + 2) % 3);
                sum[i] += p[i];
                sum[3 + i] += x[j] * p[l] - x[l] * p[j];
            }
        }
        sum
    };
    let mut run = start(text(&points), None, 0.005);
    let first = total(&run.state);
    let (mut linear, mut angular): (f64, f64) = (0.0, 0.0);
    for _ in 0..100 {
        advance(&mut run, 1000);
        let now = total(&run.state);
        linear = linear.max(apart(&now[..3], &first[..3]));
        angular = angular.max(apart(&now[3..], &first[3..]));
    }
    eprintln!("points: {linear:.1e}, {angular:.1e} of {first:.2?} over {} steps", run.state.step);
    assert!(linear < 1e-9 * 0.2 && angular < 1e-9 * 0.05);
}

/// Energy of the elastic pendulum over a million steps: it swings with the step's error, and a line
/// through it climbs by less than a hundredth of that swing over the whole run.
#[test]
fn energy_does_not_drift() {
    let mut run = start(model("spring_pendulum"), Some("resonance"), 0.01);
    run.state.q[0] = 0.2;
    let first = run.energy();
    let (samples, between) = (10_000, 100);
    let mut energies = Vec::with_capacity(samples);
    for _ in 0..samples {
        advance(&mut run, between);
        energies.push(run.energy() - first);
    }
    let n = samples as f64;
    let (mean_x, mean) = (0.5 * (n - 1.0), energies.iter().sum::<f64>() / n);
    let across = |f: &dyn Fn(f64, f64) -> f64| -> f64 {
        energies.iter().enumerate().map(|(i, e)| f(i as f64 - mean_x, e - mean)).sum()
    };
    let climb = across(&|x, e| x * e) / across(&|x, _| x * x) * n;
    let swing = energies.iter().fold(0.0, |a: f64, e| a.max(e.abs()));
    eprintln!(
        "energy {first:.3} J: swing {swing:.1e} J, climb {climb:.1e} J in {} steps",
        run.state.step
    );
    assert!(swing < 5e-3 * first.abs());
    assert!(climb.abs() < 0.01 * swing);
}

/// N steps, all momenta turned over, N steps: back at the start, with momenta turned over.
#[test]
fn the_way_back() {
    let cases = [
        ("spring_pendulum", "resonance", 0.01, 2000),
        ("double_pendulum", "slow", 0.005, 1000),
        ("fourbar", "fall", 0.005, 1000),
        ("grasp", "hold", 0.001, 300),
    ];
    for (name, scenario, h, steps) in cases {
        let mut run = start(model(name), Some(scenario), h);
        let before = run.state.q.clone();
        advance(&mut run, steps);
        let rows = run.state.lambda.len();
        let negative = |x: &[f64]| x.iter().map(|x| -x).collect::<Vec<f64>>();
        let state = &run.state;
        let (p, v) = (negative(&state.p), negative(&state.v));
        run.state = State::new(state.q.clone(), p, v, rows);
        advance(&mut run, steps);
        let off = apart(&run.state.q, &before);
        eprintln!("{name}: back to {off:.1e} after {steps} steps each way");
        assert!(off < 1e-9, "{name} comes back to {off:.1e}");
    }
}

/// At every step the constraints hold to 1e-13 of the model's length.
#[test]
fn constraints_hold() {
    let cases = [
        ("fourbar", "fall", 1e-3, 5000),
        ("fourbar", "driven", 1e-3, 5000),
        ("squeezer", "run", 5e-5, 600),
        ("slider_crank", "coast", 5e-4, 5000),
        ("grasp", "hold", 1e-3, 1000),
        ("grasp", "settle", 1e-3, 1000),
    ];
    for (name, scenario, h, steps) in cases {
        let mut run = start(model(name), Some(scenario), h);
        let mut gap = vec![0.0; run.state.lambda.len()];
        let mut worst: f64 = 0.0;
        for _ in 0..steps {
            run.step().unwrap();
            run.model.constraints(&run.state.q, run.state.t, &[], &mut gap);
            worst = gap.iter().fold(worst, |a, g| a.max(g.abs()));
        }
        let length = run.layout().length_scale;
        let per_step = run.iterations() as f64 / steps as f64;
        eprintln!("{name} {scenario}: {worst:.1e} of {length} m, {per_step:.2} newton/step");
        assert!(worst <= 1e-13 * length, "{name} {scenario}: {worst:.1e} m");
    }
}
