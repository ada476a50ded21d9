//! What tendons do, against closed forms: slack, laws, nodes, pulleys, friction, strands that lead,
//! joints without inertia.

#[path = "support/run.rs"]
mod run;

use handc_core::model::Model;
use handc_core::simulation::Simulation;
use handc_runtime::interpreter::Interpreter;
use run::{advance, start, text};

/// A recorded column at the state, by its place in the scenario.
fn records(run: &mut Simulation<Interpreter>, count: usize) -> Vec<f64> {
    let mut values = vec![0.0; count];
    run.records(&mut values);
    values
}

/// The largest departure of the energy from its start in each tenth of a run, in parts of `scale`.
fn energy_by_tenths(run: &mut Simulation<Interpreter>, steps: usize, scale: f64) -> Vec<f64> {
    let first = run.energy();
    (0..10)
        .map(|_| {
            let mut worst: f64 = 0.0;
            for _ in 0..100 {
                advance(run, steps / 1000);
                worst = worst.max((run.energy() - first).abs() / scale);
            }
            worst
        })
        .collect()
}

/// Energy stays near its start and does not wander off with time.
fn bounded(what: &str, model: Interpreter, step: f64, scale: f64, bound: f64) {
    let mut run = start(model, None, step);
    let tenths = energy_by_tenths(&mut run, 1_000_000, scale);
    eprintln!("{what}: {tenths:?} over {} steps", run.state.step);
    assert!(tenths.iter().all(|x| *x < bound), "{what}: {tenths:?}");
    let half = |tenths: &[f64]| tenths.iter().sum::<f64>() / tenths.len() as f64;
    assert!(half(&tenths[5..]) < 1.5 * half(&tenths[..5]) + 1e-12, "{what} drifts: {tenths:?}");
}

#[test]
fn a_cord_that_goes_slack_keeps_its_energy() {
    let model = text(
        "gravity = (0, 0, -9.81) m/s^2;
         joint z: prismatic(z) in world { start = 0.2 m; }
         mass m in z { mass = 0.5 kg; }
         strand cord { path = world (0, 0, 1) m -> z; stiffness = 400 N/m; rest = 1 m; slack = true; slack_width = 40 mm; }",
    );
    // What falls: 0.5 kg over 0.28 m.
    bounded("cord", model, 1e-3, 1.4, 2e-3);
}

#[test]
fn a_toe_region_keeps_its_energy() {
    let model = text(
        "gravity = (0, 0, -9.81) m/s^2;
         param k = 2 N/mm;
         const toe = 10 mm;
         joint a: revolute(y) in world { start = 0.4 rad; }
         mass m in a { mass = 0.5 kg; at = (0, 0, -0.3) m; }
         joint z: prismatic(z) in a at (0, 0, -0.3) m { start = -0.05 m; }
         mass n in z { mass = 0.3 kg; }
         strand tendon {
             path = a (0, 0, -0.1) m -> z; rest = 0.24 m;
             energy = if(x < x0, 0 J, if(x < x0 + toe, k * (x - x0)^3 / (6 * toe), k * ((x - x0)^2 / 2 - toe * (x - x0) / 2 + toe^2 / 6)));
         }",
    );
    bounded("toe", model, 1e-3, 1.0, 3e-3);
}

/// A pendulum pulled aside by three springs that meet in a massless node.
#[test]
fn a_massless_node_keeps_the_energy() {
    let model = text(
        "gravity = (0, 0, -9.81) m/s^2;
         joint a: revolute(y) in world { start = 0.3 rad; }
         mass m in a { mass = 0.4 kg; at = (0, 0, -0.3) m; }
         node knot at (0.2, 0.02, -0.3) m in world { }
         strand s1 { path = a (0, 0, -0.3) m -> knot; stiffness = 40 N/m; rest = 0.02 m; }
         strand s2 { path = knot -> world (0.5, 0.1, -0.3) m; stiffness = 60 N/m; rest = 0.05 m; }
         strand s3 { path = knot -> world (0.4, -0.2, -0.1) m; stiffness = 30 N/m; rest = 0.05 m; }",
    );
    bounded("node", model, 1e-3, 1.0, 3e-3);
}

/// Two springs in a row, joined by a node: a pendulum on them moves like one on a spring of half the
/// stiffness, and the node is in the middle of what they have stretched.
#[test]
fn springs_in_a_row() {
    let frame = "gravity = (0, 0, -9.81) m/s^2;
         joint z: prismatic(z) in world { velocity = 0.3 m/s; }
         mass m in z { mass = 0.5 kg; }";
    let mut two = start(
        text(&format!(
            "{frame}
             node n at (0, 0, 0.5) m in world {{ on = line(z); }}
             strand upper {{ path = world (0, 0, 1) m -> n; stiffness = 500 N/m; rest = 0.4 m; }}
             strand lower {{ path = n -> z; stiffness = 500 N/m; rest = 0.4 m; }}"
        )),
        None,
        1e-3,
    );
    let mut one = start(
        text(&format!(
            "{frame}
             strand all {{ path = world (0, 0, 1) m -> z; stiffness = 250 N/m; rest = 0.8 m; }}"
        )),
        None,
        1e-3,
    );
    for _ in 0..50 {
        advance(&mut two, 20);
        advance(&mut one, 20);
        let (q, z) = (two.coordinates().to_vec(), one.state.q[0]);
        assert!((q[0] - z).abs() < 1e-11, "{} against {z}", q[0]);
        assert!((q[1] - 0.5 * (1.0 + z)).abs() < 1e-12, "the node is at {}", q[1]);
        assert!((two.energy() - one.energy()).abs() < 1e-10);
    }
}

/// At every row the forces on a massless node vanish, whatever moves around it.
#[test]
fn a_node_balances_at_every_row() {
    let model = text(
        "joint a: revolute(z) in world { start = 0.2 rad; velocity = 3 rad/s; }
         mass m in a { mass = 0.1 kg; at = (0.1, 0, 0) m; inertia = (1, 1, 1) kg*cm^2; }
         node n at (0.15, 0.1, 0.02) m in world { }
         strand s1 { path = a (0.1, 0, 0) m -> n; stiffness = 200 N/m; rest = 0.05 m; }
         strand s2 { path = n -> world (0.3, 0.1, 0) m; stiffness = 300 N/m; rest = 0.1 m; }
         strand s3 { path = n -> world (0.1, 0.3, 0.1) m; energy = 100 N/m * (x - x0)^2; rest = 0.1 m + 0.02 m * sin(9 rad/s * t); }",
    );
    let mut run = start(model, None, 1e-3);
    for _ in 0..300 {
        advance(&mut run, 3);
        let q = run.coordinates().to_vec();
        let t = run.state.t;
        let (mut rest, v) = (run.rest().to_vec(), vec![0.0; q.len()]);
        run.model.rests(t, &[], &mut rest);
        let (mut p, mut force) = (v.clone(), v.clone());
        let at = handc_core::model::Midpoint { q: &q, v: &v, t, rest: &rest, inputs: &[] };
        run.model.evaluate(&at, &mut p, &mut force);
        let left = force[1..].iter().fold(0.0, |m: f64, f| m.max(f.abs()));
        assert!(left < 1e-11, "{left} N is left at {t} s");
    }
}

/// Strings that go slack and are caught again, with a node between them that has no mass to tell it
/// where to be: every step is taken, and the weight comes to rest where the strings hold it.
#[test]
fn a_node_between_slack_strings() {
    let model = text(
        "gravity = (0, 0, -9.81) m/s^2;
         joint height: prismatic(z) in world at (0, 0, -0.4) m { damping = 3 N*s/m; }
         mass weight in height = sphere { radius = 20 mm; mass = 0.5 kg; }
         node knot at (0, 0, -0.2) m in world { }
         strand left { path = world (-0.2, 0, 0) m -> knot; stiffness = 500 N/m; rest = 0.25 m; slack = true; }
         strand right { path = world (0.3, 0, 0) m -> knot; stiffness = 500 N/m; rest = 0.3 m; slack = true; }
         strand back { path = world (0, 0.2, 0) m -> knot; stiffness = 500 N/m; rest = 0.25 m; slack = true; }
         strand down { path = knot -> height; stiffness = 800 N/m; rest = 0.18 m; slack = true; }
         scenario s { step = 1 ms; duration = 8 s; record tension(down) as pull; record taut(down) as is_taut; }",
    );
    let mut run = start(model, Some("s"), 1e-3);
    let mut went_slack = false;
    for _ in 0..10_000 {
        advance(&mut run, 1);
        went_slack |= records(&mut run, 2)[1] == 0.0;
    }
    assert!(went_slack, "the weight was to be thrown up");
    let tension = records(&mut run, 2)[0];
    let [height, x, y, z] = run.coordinates()[..] else { panic!() };
    let rise = z - (height - 0.4);
    let upwards = tension * rise / (x * x + y * y + rise * rise).sqrt();
    assert!((upwards - 0.5 * 9.81).abs() < 1e-6, "{upwards} N");
}

/// A cable through a node: one tension on both sides, whatever hangs there; the pulley lies where the
/// two directions balance the third strand.
#[test]
fn a_pulley_shares_one_tension() {
    let model = text(
        "gravity = (0, 0, -9.81) m/s^2;
         joint a: prismatic(z) in world at (0.1, 0, -0.4) m { damping = 5 N*s/m; }
         mass ma in a { mass = 0.2 kg; }
         node pulley at (0, 0, -0.05) m in world { }
         strand up { path = world (0, 0, 0.3) m -> pulley; stiffness = 2000 N/m; rest = 0.34 m; }
         strand cable { path = a -> pulley -> world (-0.1, 0, -0.4) m; stiffness = 1000 N/m; rest = 0.7 m; }
         scenario s { step = 2 ms; duration = 1 s; record tension(cable) as c; record tension(up) as u; record pulley.x as x; record pulley.z as z; }",
    );
    let mut run = start(model, Some("s"), 2e-3);
    advance(&mut run, 5000);
    let [c, u, x, z] = records(&mut run, 4)[..] else { panic!() };
    let a = run.state.q[0];
    let (left, right) = ([-0.1 - x, -0.4 - z], [0.1 - x, a - 0.4 - z]);
    let unit = |d: [f64; 2]| d.map(|e| e / (d[0] * d[0] + d[1] * d[1]).sqrt());
    let (l, r, up) = (unit(left), unit(right), unit([-x, 0.3 - z]));
    for i in 0..2 {
        assert!((c * (l[i] + r[i]) + u * up[i]).abs() < 1e-10 * c, "{c} {u} {x} {z}");
    }
    // The weight hangs on one side's tension.
    assert!((-c * r[1] - 0.2 * 9.81).abs() < 1e-9, "{}", -c * r[1]);
}

/// A rope over a guide that turns it by 90 degrees: pulled up slowly, the spring feels the weight
/// times exp(μπ/2); let down, the weight over it (Euler and Eytelwein).
#[test]
fn friction_is_that_of_a_capstan() {
    let model = text(
        "gravity = (0, 0, -9.81) m/s^2;
         input pulled = 0 m;
         joint z: prismatic(z) in world at (0, 0, -0.5) m { damping = 20 N*s/m; }
         mass m in z { mass = 1 kg; }
         strand rope {
             path = world (-0.5, 0, 0) m -> world (0, 0, 0) m -> z;
             stiffness = 2000 N/m; rest = 0.99 m - pulled; friction = 0.3; friction_speed = 0.01 mm/s;
         }
         scenario up { step = 1 ms; duration = 1 s; input pulled = 0.02 m/s * t; record tension(rope) as rope; record dissipation(rope) as lost; }
         scenario down { step = 1 ms; duration = 1 s; input pulled = -0.02 m/s * t; record tension(rope) as rope; record dissipation(rope) as lost; }",
    );
    let ratio = (0.3 * std::f64::consts::FRAC_PI_2).exp();
    for (scenario, sign) in [("up", 1.0), ("down", -1.0)] {
        let mut run = start(model.clone(), Some(scenario), 1e-3);
        advance(&mut run, 3000);
        let [tension, lost] = records(&mut run, 2)[..] else { panic!() };
        // The joint's own damping takes its part of the load.
        let load = 9.81 + sign * 20.0 * 0.02;
        let expected = load * f64::powf(ratio, sign);
        assert!((tension / expected - 1.0).abs() < 1e-5, "{scenario}: {tension} N, {expected} N");
        let power = (tension - load).abs() * 0.02;
        assert!((lost / power - 1.0).abs() < 1e-4, "{scenario}: {lost} W, {power} W");
    }
}

/// A strand that leads has its length at every step, and the work of its tension is the change of
/// energy, to second order. At both ends the strand is at rest, since the energy of a row leaves out what
/// a moving constraint moves.
#[test]
fn a_leading_strand_does_the_work_of_its_tension() {
    let model = text(
        "gravity = (0, 0, -9.81) m/s^2;
         joint a: revolute(y) in world { start = 0.3 rad; }
         mass m in a { mass = 0.5 kg; at = (0.02, 0, -0.3) m; inertia = (1, 1, 1) g*m^2; }
         joint b: revolute(x) in a at (0, 0, -0.3) m { start = 0.2 rad; velocity = 2 rad/s; }
         mass n in b { mass = 0.3 kg; at = (0, 0.03, -0.1) m; inertia = (0.5, 0.5, 0.5) g*m^2; }
         strand lead { path = world (0.3, 0, 0) m -> a (0, 0, -0.25) m; drive = 0.34 m - 0.03 m * cos(3.141592653589793 rad/s * t); }
         scenario s { step = 1 ms; duration = 1 s; record tension(lead) as tension; record length(lead) as x; }",
    );
    let misses: Vec<f64> = [2e-3, 1e-3]
        .iter()
        .map(|&h| {
            let mut run = start(model.clone(), Some("s"), h);
            let (first, mut work) = (run.energy(), 0.0);
            // A multiplier acts where its step began: half of it belongs to the step before.
            let (mut x, mut moved) = (records(&mut run, 2)[1], 0.0);
            for _ in 0..(1.0 / h).round() as usize {
                advance(&mut run, 1);
                let now = records(&mut run, 2);
                let wanted = 0.34 - 0.03 * (std::f64::consts::PI * run.state.t).cos();
                assert!((now[1] - wanted).abs() < 1e-14, "{} against {wanted}", now[1]);
                work -= 0.5 * now[0] * (now[1] - x + moved);
                (x, moved) = (now[1], now[1] - x);
            }
            let last = records(&mut run, 2)[0];
            (run.energy() - first - work + 0.5 * last * moved).abs()
        })
        .collect();
    eprintln!("work missed: {misses:?}");
    assert!(misses[1] < 2e-4 && misses[0] / misses[1] > 3.3, "{misses:?}");
}

/// Joints without inertia are where a slow, damped motion of the same joints ends.
#[test]
fn a_quasi_static_finger_rests_where_a_damped_one_comes_to_rest() {
    let finger = |option: &str, damping: &str| {
        text(&format!(
            "gravity = (0, -9.81, 0) m/s^2;
             joint a: revolute(z) in world {{ start = -0.2 rad; {damping} }}
             mass ma in a {{ mass = 40 g; at = (20, 0, 0) mm; inertia = (1, 2, 2) kg*mm^2; }}
             joint b: revolute(z) in a at (40, 0, 0) mm {{ start = -0.3 rad; {damping} }}
             mass mb in b {{ mass = 20 g; at = (15, 0, 0) mm; inertia = (1, 1, 1) kg*mm^2; }}
             strand below {{ path = world (-30, -12, 0) mm -> a (10, -10, 0) mm -> a (30, -9, 0) mm -> b (8, -8, 0) mm; stiffness = 300 N/m; rest = 60 mm; {option} }}
             strand short {{ path = world (-30, -12, 0) mm -> a (10, -12, 0) mm; stiffness = 200 N/m; rest = 38 mm; }}
             strand above {{ path = world (-30, 12, 0) mm -> a (10, 10, 0) mm -> a (36, 9, 0) mm -> b (4, 8, 0) mm; stiffness = 300 N/m; rest = 70 mm; }}"
        ))
    };
    let mut still = start(finger("quasi_static = true;", ""), None, 10e-3);
    let mut slow = start(finger("", "damping = 1e-3 N*m*s/rad;"), None, 1e-3);
    let at_once = still.coordinates().to_vec();
    advance(&mut still, 100);
    advance(&mut slow, 20_000);
    let rests = still.coordinates().to_vec();
    for i in 0..2 {
        assert!((rests[i] - at_once[i]).abs() < 1e-12, "{rests:?} {at_once:?}");
        assert!((rests[i] - slow.state.q[i]).abs() < 1e-9, "{rests:?} {:?}", slow.state.q);
        assert_eq!(still.state.p[i], 0.0);
    }
}

/// The input of an actuated strand is its natural length: the length at the start until it is set.
#[test]
fn an_actuated_strand_starts_as_it_is() {
    let model = text(
        "joint a: revolute(z) in world { start = 0.3 rad; damping = 0.01 N*m*s/rad; }
         mass m in a { mass = 0.1 kg; at = (0.1, 0, 0) m; }
         strand s { path = world (0, 0.1, 0) m -> a (0.1, 0, 0) m; stiffness = 200 N/m; actuated = true; }
         strand r { path = world (0, -0.1, 0) m -> a (0.1, 0, 0) m; stiffness = 200 N/m; }
         scenario still { step = 1 ms; duration = 1 s; record s.rest as rest; }
         scenario pulled { step = 1 ms; duration = 1 s; input s.rest = 0.05 m; record s.rest as rest; record length(s) as x; }",
    );
    let mut run = start(model.clone(), Some("still"), 1e-3);
    let mut length = vec![0.0; 2];
    run.model.strand_lengths(&[0.3], &mut length);
    advance(&mut run, 100);
    assert_eq!(records(&mut run, 1)[0], length[0]);
    assert!((run.state.q[0] - 0.3).abs() < 1e-14);
    let mut run = start(model, Some("pulled"), 1e-3);
    advance(&mut run, 900);
    let found = records(&mut run, 2);
    assert_eq!(found[0], 0.05);
    assert!(found[1] < 0.9 * length[0], "{found:?}");
}

/// Second order with every force of a strand: errors fall fourfold with half the step.
#[test]
fn strands_with_rates_are_of_second_order() {
    let model = text(
        "gravity = (0, 0, -9.81) m/s^2;
         joint a: revolute(y) in world { start = 0.4 rad; velocity = 1 rad/s; }
         mass m in a { mass = 0.3 kg; at = (0, 0, -0.2) m; inertia = (1, 1, 1) g*m^2; }
         node n at (0.2, 0, -0.1) m in world { }
         strand s1 { path = n -> a (0, 0, -0.2) m; stiffness = 50 N/m; rest = 0.1 m; damping = 0.4 N*s/m; }
         strand s2 { path = n -> world (0.3, 0, 0) m; stiffness = 80 N/m; rest = 0.08 m; }
         strand s3 { path = n -> world (0.3, 0.1, -0.2) m; stiffness = 60 N/m; rest = 0.08 m; }
         strand s4 { path = n -> world (0.3, -0.1, -0.2) m; stiffness = 60 N/m; rest = 0.08 m; }
         strand rough { path = world (-0.3, 0, -0.3) m -> world (-0.1, 0, -0.1) m -> a (0, 0, -0.15) m; stiffness = 60 N/m; rest = 0.3 m; friction = 0.2; friction_speed = 0.2 m/s; }
         strand pull { path = world (-0.2, 0, 0) m -> a (0, 0, -0.1) m; tension = 0.5 N + 0.2 N * sin(5 rad/s * t) + 1 N*s/m * rate(x); }",
    );
    let end = |h: f64| {
        let mut run = start(model.clone(), None, h);
        advance(&mut run, (0.6 / h).round() as usize);
        run.state.q[0]
    };
    let [a, b, c] = [2e-3, 1e-3, 0.5e-3].map(end);
    let order = ((a - b) / (b - c)).log2();
    assert!((order - 2.0).abs() < 0.02, "order {order}: {a} {b} {c}");
}
