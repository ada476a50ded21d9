//! The integrator against motions known in closed form: pendulum, planet, top, and linear systems of
//! which the midpoint rule itself has an exact solution; order two wherever it is not exact.

#[path = "support/formulas.rs"]
mod formulas;
#[path = "support/run.rs"]
mod run;

use formulas::{Elliptic, damped, forced};
use handc_runtime::interpreter::Interpreter;
use run::{Run, advance, apart, model, text};
use std::f64::consts::PI;

/// Runs `model` to the end and returns where it is.
fn run(model: Interpreter, scenario: Option<&str>, h: f64, duration: f64) -> Run {
    let mut run = run::start_for(model, scenario, h, duration);
    let steps = run.steps;
    advance(&mut run, steps);
    assert!((run.state.t - duration).abs() < 1e-9);
    run
}

/// The error falls as h²: 2.00 ± 0.02 at each of three halvings.
fn second_order(what: &str, h: f64, error: impl Fn(f64) -> f64) {
    let errors: Vec<f64> = (0..4).map(|k| error(h / f64::from(1 << k))).collect();
    let orders: Vec<f64> = errors.windows(2).map(|e| (e[0] / e[1]).log2()).collect();
    let shown: Vec<String> = errors.iter().map(|e| format!("{e:.2e}")).collect();
    eprintln!("{what}: errors {}, orders {orders:.4?}", shown.join(" "));
    assert!(orders.iter().all(|order| (order - 2.0).abs() <= 0.02), "{what}: orders {orders:?}");
}

#[test]
fn pendulum_by_elliptic_functions() {
    // sin(θ/2) = k sn(√(g/l) t + K) from rest at θ₀, k = sin(θ₀/2).
    let k = 1.0f64.sin();
    let elliptic = Elliptic::new(k);
    let omega = 9.81f64.sqrt();
    assert!((4.0 * elliptic.quarter() / omega - 2.665870942834926).abs() < 1e-14);
    let t = 6.0;
    let expected = 2.0 * (k * elliptic.sn_cn_dn(omega * t + elliptic.quarter()).0).asin();
    second_order("pendulum", 4e-3, |h| {
        (run(model("pendulum"), None, h, t).state.q[0] - expected).abs()
    });
}

#[test]
fn planet_on_its_ellipse() {
    // Kepler's equation M = E − e sin E; semi-major axis and period 1.
    let (t, e) = (0.8, 0.5f64);
    let mut anomaly = 2.0 * PI * t;
    for _ in 0..50 {
        anomaly -= (anomaly - e * anomaly.sin() - 2.0 * PI * t) / (1.0 - e * anomaly.cos());
    }
    let expected = [anomaly.cos() - e, (1.0 - e * e).sqrt() * anomaly.sin()];
    second_order("planet", 1e-3, |h| {
        let state = run(model("kepler"), None, h, t).state;
        // Angular momentum is quadratic, so that the rule keeps it.
        let turning = state.q[0] * state.p[1] - state.q[1] * state.p[0];
        let first = 0.5 * 10.882796185405306;
        assert!(
            (turning - first).abs() < 1e-11,
            "angular momentum is off by {:.1e}",
            turning - first
        );
        apart(&state.q[..2], &expected)
    });
}

/// Angular momentum in the body's axes, from momenta of the three angles of a free joint.
fn body_momentum(q: &[f64], p: &[f64]) -> [f64; 3] {
    let ((sy, cy), (sz, cz)) = (q[4].sin_cos(), q[5].sin_cos());
    // p = Bᵀ L with the rates about the body's axes ω = B q̇.
    let across = (p[3] - sy * p[5]) / cy;
    [across * cz + p[4] * sz, p[4] * cz - across * sz, p[5]]
}

#[test]
fn top_about_its_middle_axis() {
    // Inertias 1, 2 and 3 g·m² about z, x and y; Landau and Lifshitz, Mechanics, § 37.
    let [i1, i2, i3] = [1e-3f64, 2e-3, 3e-3];
    let (twice_energy, square) = (i2 * 100.0 + i3 * 0.01, i2 * i2 * 100.0 + i3 * i3 * 0.01);
    let (high, low) = (twice_energy * i3 - square, square - twice_energy * i1);
    let elliptic = Elliptic::new(((i2 - i1) * high / ((i3 - i2) * low)).sqrt());
    let rate = ((i3 - i2) * low / (i1 * i2 * i3)).sqrt();
    let period = 4.0 * elliptic.quarter() / rate;
    assert!((period - 3.770207159).abs() < 1e-9);
    let t = 0.9;
    let (sn, cn, dn) = elliptic.sn_cn_dn(rate * t + elliptic.quarter());
    let z = (i1 * high / (i3 - i1)).sqrt() * cn;
    let x = (i2 * high / (i3 - i2)).sqrt() * sn;
    let y = (i3 * low / (i3 - i1)).sqrt() * dn;
    second_order("top", 2e-3, |h| {
        let state = run(model("euler_top"), Some("flip"), h, t).state;
        apart(&body_momentum(&state.q, &state.p), &[x, y, z]) / square.sqrt()
    });
}

#[test]
fn steady_rotation_is_exact() {
    let top = text(
        "joint body: free in world { velocity = (0.3 m/s, 0 m/s, -0.2 m/s, 0 rad/s, 0 rad/s, 7 rad/s); }
         mass top in body { mass = 1 kg; inertia = (0.002, 0.003, 0.001) kg*m^2; }",
    );
    let q = run(top, None, 0.01, 10.0).state.q;
    assert!(apart(&q, &[3.0, 0.0, -2.0, 0.0, 0.0, 70.0]) < 1e-12, "{q:?}");
}

#[test]
fn oscillators_follow_the_rule_exactly() {
    let (h, n) = (0.01, 1000);
    let body = "joint x: prismatic(x) in world { start = 0.1 m; SPRING }
        mass m in x { mass = 2 kg; }";
    let spring = text(&body.replace("SPRING", "stiffness = 50 N/m;"));
    let state = run(spring, None, h, h * n as f64).state;
    let (q, v) = damped(0.1, 0.0, 5.0, h, n);
    eprintln!("spring: {:.1e}, {:.1e}", state.q[0] - q, state.p[0] - 2.0 * v);
    assert!((state.q[0] - q).abs() < 1e-14 && (state.p[0] - 2.0 * v).abs() < 1e-13);

    let damper = text(&body.replace("SPRING", "stiffness = 50 N/m; damping = 0.8 N*s/m;"));
    let state = run(damper, None, h, h * n as f64).state;
    let (q, v) = damped(0.1, 0.2, 5.0, h, n);
    eprintln!("damped: {:.1e}, {:.1e}", state.q[0] - q, state.p[0] - 2.0 * v);
    assert!((state.q[0] - q).abs() < 1e-14 && (state.p[0] - 2.0 * v).abs() < 1e-13);

    // The same oscillator between two strands.
    let strands = text(&format!(
        "{} strand left {{ path = world (-1, 0, 0) m -> x; stiffness = 20 N/m; rest = 1 m; }}
         strand right {{ path = x -> world (2, 0, 0) m; stiffness = 30 N/m; rest = 2 m; }}",
        body.replace("SPRING", "")
    ));
    let state = run(strands, None, h, h * n as f64).state;
    let (q, v) = damped(0.1, 0.0, 5.0, h, n);
    eprintln!("strands: {:.1e}, {:.1e}", state.q[0] - q, state.p[0] - 2.0 * v);
    assert!((state.q[0] - q).abs() < 1e-13 && (state.p[0] - 2.0 * v).abs() < 1e-12);
}

#[test]
fn screw_falls_as_its_pitch_says() {
    // (I + m p²) φ̈ = −m g p; a parabola is exact for the rule.
    let screw = text(
        "gravity = (0, 0, -10) m/s^2;
         joint nut: screw(z, 0.02 m) in world { start = 1 rad; velocity = 3 rad/s; }
         mass body in nut { mass = 2 kg; inertia = (0.02, 0.03, 0.004) kg*m^2; }",
    );
    let state = run(screw, None, 0.01, 5.0).state;
    let acceleration = -2.0 * 10.0 * 0.02 / (0.004 + 2.0 * 0.02 * 0.02);
    let expected = 1.0 + 3.0 * 5.0 + 0.5 * acceleration * 25.0;
    eprintln!("screw: {:.1e} of {expected}", state.q[0] - expected);
    assert!((state.q[0] - expected).abs() < 1e-13 * expected.abs());
}

#[test]
fn bead_on_a_turning_arm() {
    // r̈ = Ω²r; the rule gives r₀ cosh(nφ), tanh(φ/2) = hΩ/2.
    let bead = text(
        "joint arm: revolute(z) in world { drive = 2 rad/s * t; }
         joint bead: prismatic(x) in arm { start = 0.1 m; }
         mass m in bead { mass = 0.5 kg; }",
    );
    let (h, n) = (0.01, 100);
    let state = run(bead, None, h, h * f64::from(n)).state;
    let expected = 0.1 * (f64::from(n) * 2.0 * (0.5 * h * 2.0).atanh()).cosh();
    eprintln!("bead: {:.1e} of {expected}", state.q[1] - expected);
    assert!((state.q[1] - expected).abs() < 1e-13 * expected);
    assert_eq!(state.q[0], 2.0 * state.t);
}

#[test]
fn free_particle_on_a_driven_turntable() {
    // Straight in the world, x = 0.2 + 0.3 t, y = 0.1 t, seen from the angle 1 − cos 2t.
    let turntable = || {
        text(
            "joint table: revolute(z) in world { drive = 1 - cos(2 rad/s * t); }
             joint x: prismatic(x) in table { start = 0.2 m; velocity = 0.3 m/s; }
             joint y: prismatic(y) in x { velocity = 0.1 m/s; }
             mass m in y { mass = 0.5 kg; }",
        )
    };
    let t = 1.5f64;
    let (s, c) = (1.0 - (2.0 * t).cos()).sin_cos();
    let (x, y) = (0.2 + 0.3 * t, 0.1 * t);
    let expected = [x * c + y * s, y * c - x * s];
    second_order("turntable", 5e-3, |h| {
        apart(&run(turntable(), None, h, t).state.q[1..], &expected)
    });
}

#[test]
fn forces_inputs_and_moving_rests_are_second_order() {
    let t = 2.0;
    let expected = forced(0.5, 6.0, 3.0, 4.0, t);
    let slider = "joint x: prismatic(x) in world { damping = 2 N*s/m; }
        mass m in x { mass = 2 kg; }";
    let pushes = [
        ("an input", "input u = 6 N * cos(4 rad/s * t); torque push on x = u - 72 N/m * x;"),
        (
            "a force at a point",
            "force push at x = (6 N * cos(4 rad/s * t) - 72 N/m * x, 1 N, 2 N);",
        ),
        (
            "a moving natural length",
            "strand s { path = world (-1, 0, 0) m -> x; stiffness = 72 N/m;
                rest = 1 m + (1 / 12) m * cos(4 rad/s * t); }",
        ),
        (
            "damping by an expression",
            "torque push on x = 6 N * cos(4 rad/s * t) - 72 N/m * x + 2 N*s/m * rate(x);
             torque drag on x = -2 N*s/m * rate(x);",
        ),
    ];
    for (what, push) in pushes {
        second_order(what, 0.01, |h| {
            let model = text(&format!("{slider}\n{push}"));
            (run(model, None, h, t).state.q[0] - expected).abs()
        });
    }
}

#[test]
fn squeezer_reaches_its_known_angles() {
    // Hairer and Wanner, Solving Ordinary Differential Equations II, VII.7: at t = 0.03 s.
    let known = [
        ("beta", 15.8107711963),
        ("Theta", -15.7563710598),
        ("gamma", 0.0408222401),
        ("phi", -0.5347301163),
        ("delta", 0.5244099659),
        ("Omega", 0.5347301163),
        ("epsilon", 1.0480807410),
    ];
    second_order("squeezer", 0.03 / 2400.0, |h| {
        let run = run(model("squeezer"), None, h, 0.03);
        let error = |name: &str, expected: f64| {
            let found = run.layout().coordinates.iter().position(|c| c.name == name).unwrap();
            (run.state.q[found] - expected).abs()
        };
        known.iter().map(|&(name, value)| error(name, value)).fold(0.0, f64::max)
    });
}
