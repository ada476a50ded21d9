//! Strands over spheres and cylinders: no jump over whole sweeps, motions known in closed form, energy
//! through a million steps, and what is said where a strand cannot pass.

#[path = "support/run.rs"]
mod run;

use handc_core::error::{RunError, StepErrorKind};
use handc_core::model::Model;
use handc_core::simulation::{Settings, Simulation};
use handc_runtime::interpreter::Interpreter;
use run::{Run, advance, apart, start, start_for, text};
use std::f64::consts::PI;
use std::sync::Arc;

/// Poses in a sweep.
const POSES: usize = 20_000;

/// What a sweep has seen of a strand.
#[derive(Debug, Default)]
struct Seen {
    touching: usize,
    straight: usize,
    longest: f64,
}

/// Moves the coordinates along `at` from 0 to 1. Between neighbouring poses no moment arm changes by
/// more than `steepest` times their distance, and each length changes by the mean of its moment arms
/// at both, up to `steepest` times the square of the distance: a jump of either would be seen.
fn sweep(body: &str, steepest: f64, at: impl Fn(f64) -> Vec<f64>) -> Vec<Seen> {
    let mut model = text(body);
    let mut bare = model.mechanism().as_ref().clone();
    bare.strands.iter_mut().for_each(|strand| strand.wraps.clear());
    let mut bare = Interpreter::new(Arc::new(bare));
    let layout = model.layout().clone();
    let (n, count) = (layout.coordinates.len(), layout.strands.len());
    let mut seen: Vec<Seen> = (0..count).map(|_| Seen::default()).collect();
    let mut last: Option<(Vec<f64>, Vec<f64>, Vec<f64>)> = None;
    for k in 0..=POSES {
        let q = at(k as f64 / POSES as f64);
        let (mut lengths, mut chords, mut arms) =
            (vec![0.0; count], vec![0.0; count], vec![0.0; count * n]);
        model.strand_lengths(&q, &mut lengths);
        bare.strand_lengths(&q, &mut chords);
        model.moment_arms(&q, &mut arms);
        assert!(lengths.iter().chain(&arms).all(|x| x.is_finite()), "{q:?}: {lengths:?} {arms:?}");
        for s in 0..count {
            let is_longer = lengths[s] > chords[s] + 1e-13;
            *(if is_longer { &mut seen[s].touching } else { &mut seen[s].straight }) += 1;
            seen[s].longest = seen[s].longest.max(lengths[s] - chords[s]);
        }
        if let Some((before, lengths_before, arms_before)) = &last {
            let moved: Vec<f64> = q.iter().zip(before).map(|(a, b)| a - b).collect();
            let distance = moved.iter().map(|x| x * x).sum::<f64>().sqrt();
            for s in 0..count {
                let name = &layout.strands[s].name;
                let rows = [arms_before, &arms].map(|arms| &arms[s * n..(s + 1) * n]);
                let turned = apart(rows[0], rows[1]);
                assert!(
                    turned <= steepest * distance,
                    "{name} at {q:?}: moment arm by {turned:.2e}"
                );
                let slope: f64 = (0..n).map(|c| 0.5 * (rows[0][c] + rows[1][c]) * moved[c]).sum();
                let off = (lengths[s] - lengths_before[s] - slope).abs();
                let rounding = 1e-14;
                let bound = steepest * distance * distance + rounding;
                assert!(off <= bound, "{name} at {q:?}: length by {off:.2e}");
            }
        }
        last = Some((q, lengths, arms));
    }
    eprintln!("{seen:.3?}");
    seen
}

/// A knee: one hinge in the axis of a cylinder, all the way round. The line from point to point
/// passes the cylinder on its wrong side for half of it.
#[test]
fn a_hinge_all_the_way_round() {
    let from = "world (-60, 20, 0) mm -> via wrap";
    let knee = format!(
        "joint knee: revolute(z) in world;
         mass shank in knee {{ mass = 1 kg; at = (0, -0.2, 0) m; inertia = (1, 1, 1) g*m^2; }}
         strand over {{ path = {from} cylinder(world, axis = z, radius = 30 mm, side = y) -> knee (50, 10, 0) mm; stiffness = 1 N/m; }}
         strand below {{ path = world (-60, -20, 0) mm -> via wrap cylinder(world, axis = z, radius = 30 mm, side = (0, -1, 7)) -> knee (50, 10, 0) mm; stiffness = 1 N/m; }}
         strand climbs {{ path = {from} cylinder(world (0, 0, 9) mm, axis = z, radius = 30 mm, side = y) -> knee (50, 10, 40) mm; stiffness = 1 N/m; }}
         strand ball {{ path = {from} sphere(world, radius = 30 mm, side = y) -> knee (50, 10, 0) mm; stiffness = 1 N/m; }}
         strand on_knee {{ path = {from} cylinder(knee, axis = z, radius = 30 mm, side = y) -> knee (50, 10, 0) mm; stiffness = 1 N/m; }}
         strand reversed {{ path = knee (50, 10, 0) mm -> via wrap cylinder(world, axis = -z, radius = 30 mm, side = y) -> world (-60, 20, 0) mm; stiffness = 1 N/m; }}"
    );
    let seen = sweep(&knee, 1.0, |x| vec![(2.0 * x - 1.0) * 177.0 * PI / 180.0]);
    for strand in &seen {
        assert!(strand.touching > POSES / 2 && strand.straight > POSES / 8, "{strand:?}");
        assert!(strand.longest > 0.15, "by more than half a turn");
    }
}

/// Three joints, none of them in the axis of a surface, surfaces at the ends of the path and in its
/// middle, and one between points that one joint moves together.
#[test]
fn joints_on_both_sides() {
    let arm = "
        joint a: revolute(z) in world;
        joint b: revolute((0, 1, 4)) in a at (0.1, 0, 0) m;
        joint c: prismatic(x) in b at (0.1, 0, 0) m;
        mass m in c { mass = 1 kg; }
        strand near { path = world (-50, 20, 0) mm -> via wrap cylinder(world (5, 4, 0) mm, axis = (0.1, 0, 1), radius = 15 mm, side = y) -> b (-20, 15, 10) mm -> c (5, 15, 0) mm; stiffness = 1 N/m; }
        strand far { path = world (-50, 20, 0) mm -> a (0, 25, 0) mm -> via wrap cylinder(b, axis = z, radius = 15 mm, side = y) -> c (0, 10, 8) mm; stiffness = 1 N/m; }
        strand middle { path = world (-50, -30, 0) mm -> via wrap sphere(a (50, -15, -8) mm, radius = 20 mm) -> c (0, -10, -8) mm; stiffness = 1 N/m; }
        strand carried { path = b (-30, -30, 0) mm -> via wrap cylinder(a (0.1, 0, 0) m, axis = z, radius = 12 mm, side = (1, -1, 0)) -> b (30, 25, 10) mm; stiffness = 1 N/m; }
        strand two { path = world (-50, 20, 0) mm -> via wrap cylinder(a, axis = z, radius = 15 mm, side = y) -> a (50, 18, 5) mm -> via wrap sphere(b, radius = 15 mm) -> c (-10, 12, 0) mm; stiffness = 1 N/m; }";
    let seen = sweep(arm, 3.0, |x| {
        let turn = 2.0 * PI * x;
        vec![
            -0.3 + 1.1 * turn.sin(),
            -0.4 + 0.9 * (turn + 1.0).cos(),
            0.02 + 0.02 * (2.0 * turn).sin(),
        ]
    });
    for (s, strand) in seen.iter().enumerate() {
        // The strand whose ends one joint carries touches throughout.
        let is_seen = strand.straight > POSES / 20 || s == 3;
        assert!(strand.touching > POSES / 20 && is_seen, "{strand:?}");
    }
}

/// Over a ball a strand slides to whichever side is nearer: no hint is needed, and nothing jumps as
/// long as the points do not stand opposite each other.
#[test]
fn over_a_ball_in_space() {
    let shoulder = "
        joint up: revolute(y) in world;
        joint round: revolute(x) in up;
        mass arm in round { mass = 1 kg; at = (0.2, 0, 0) m; inertia = (1, 1, 1) g*m^2; }
        strand s { path = world (0, 5, 50) mm -> via wrap sphere(world, radius = 25 mm) -> round (40, 15, 5) mm; stiffness = 1 N/m; }";
    let seen = sweep(shoulder, 2.0, |x| {
        let turn = 2.0 * PI * x;
        vec![0.2 + 1.0 * turn.sin(), 2.0 * (2.0 * turn).cos()]
    });
    assert!(seen[0].touching > POSES / 4 && seen[0].straight > POSES / 4);
}

/// Without a hint a strand takes the way that is shorter at the start, and keeps it. Turned too far from
/// there it has no length, rather than a jump to the other side.
#[test]
fn the_shorter_way_is_kept() {
    let body = |side: &str| {
        format!(
            "joint a: revolute(z) in world {{ start = -1 rad; }}
             mass m in a {{ mass = 1 kg; at = (0.2, 0, 0) m; inertia = (1, 1, 1) g*m^2; }}
             strand s {{ path = world (-60, 0, 0) mm -> via wrap cylinder(world, axis = z, radius = 30 mm{side}) -> a (50, 0, 0) mm; stiffness = 1 N/m; }}
             strand r {{ path = world (-60, 0, 0) mm -> via wrap cylinder(a, axis = z, radius = 30 mm{side}) -> a (50, 0, 0) mm; stiffness = 1 N/m; }}"
        )
    };
    // It starts below, turning by pi - 1, and may go on to 2 pi - 1 and back to 0 and to -1.
    for side in ["", ", side = -y"] {
        let seen = sweep(&body(side), 1.0, |x| vec![-1.0 + 3.1 * (2.0 * x - 1.0)]);
        assert!(seen[0].touching > POSES / 2 && seen[0].straight > POSES / 8);
        let mut model = text(&body(side));
        let mut lengths = [0.0; 2];
        for (q, is_known) in [
            (-1.0 + PI - 0.05, true),
            (-1.0 + PI - 0.02, false),
            (-1.0 + PI + 0.02, false),
            (-1.0 + PI + 0.05, true),
        ] {
            model.strand_lengths(&[q], &mut lengths);
            assert_eq!(lengths.map(f64::is_finite), [is_known; 2], "{q}");
        }
    }
    // What is said of a run that goes there, of one of the two, which come there together.
    let mut run = start(
        text(&body("").replace("start = -1 rad", "start = -1 rad; velocity = 40 rad/s")),
        None,
        1e-3,
    );
    failure(&mut run, &["` cannot pass", "would jump to the other side"]);
}

/// A drum on its own axis: the moment arm is its radius, and the spring that the cord makes turns it
/// harmonically, of which the midpoint rule's exact motion is known.
#[test]
fn a_drum_swings_like_a_spring() {
    let (h, steps) = (0.01, 1000);
    let drum = text(
        "joint a: revolute(z) in world { start = 0.3 rad; }
         mass m in a { mass = 1 kg; inertia = (1, 1, 3) g*m^2; }
         strand s { path = world (-80, 30, 0) mm -> via wrap cylinder(a, axis = z, radius = 30 mm, side = y) -> a (35, 0, 0) mm; stiffness = 200 N/m; }",
    );
    // Turning by 0.8 rad to either side it stays wound.
    let mut run = start(drum, None, h);
    let rest = run.rest()[0];
    run.state.p[0] = 3e-3 * 3.0;
    let energy = run.energy();
    let mut worst: f64 = 0.0;
    let omega = (200.0 * 0.03f64.powi(2) / 3e-3).sqrt();
    for step in 1..=steps {
        run.step().unwrap();
        let mut length = [0.0];
        run.model.strand_lengths(&run.state.q, &mut length);
        assert!((length[0] - rest + 0.03 * (run.state.q[0] - 0.3)).abs() < 1e-15);
        // q = 0.3 + A sin(n·2 atan(hω/2)), with the amplitude that the rule's first step gives.
        let amplitude = 3.0 / omega;
        let phase = 2.0 * f64::from(step) * (0.5 * h * omega).atan();
        worst = worst.max((run.state.q[0] - 0.3 - amplitude * phase.sin()).abs());
    }
    eprintln!("drum: {worst:.1e}, energy {:.1e}", run.energy() - energy);
    assert!(worst < 1e-12 && (run.energy() - energy).abs() < 1e-15);
}

/// A weight on a cord that winds up on a peg, without gravity: its speed v stays, and with the free
/// length l the cord turns by v/l, so that l² = l₀² − 2rvt (Huygens' involute). The cord is stiff.
#[test]
fn a_weight_winds_itself_up() {
    for surface in [
        "cylinder(world, axis = z, radius = 50 mm, side = y)",
        "sphere(world, radius = 50 mm, side = y)",
    ] {
        let error = |stiffness: f64| {
            let weight = text(&format!(
                "joint x: prismatic(x) in world {{ start = 0.55 m; }}
                 joint y: prismatic(y) in x {{ start = 0.05 m; velocity = -1 m/s; }}
                 mass m in y {{ mass = 1 kg; }}
                 strand s {{ path = world (-0.3, 0.05, 0) m -> via wrap {surface} -> y; stiffness = {stiffness} N/m; rest = 0.85 m - 1 N * {stretch} m / {stiffness} N; }}",
                stretch = 1.0 / 0.55
            ));
            let mut run = start(weight, None, 2e-5);
            let mut worst: f64 = 0.0;
            for _ in 0..25 {
                advance(&mut run, 1000);
                let free = (0.55f64 * 0.55 - 2.0 * 0.05 * run.state.t).sqrt();
                let turned = (0.55 - free) / 0.05;
                let (s, c) = turned.sin_cos();
                let expected = [0.05 * s + free * c, 0.05 * c - free * s];
                worst = worst.max(apart(&run.state.q, &expected));
            }
            assert!(run.state.t > 0.49 && run.state.q[1] < -0.3);
            worst
        };
        let errors = [1e5, 2e5].map(error);
        eprintln!("wound up on a {surface}: {:.2e}, {:.2e}", errors[0], errors[1]);
        // What is left is the stretch of the cord.
        assert!(errors[0] < 1e-4 && (errors[0] / errors[1] - 2.0).abs() < 0.1);
    }
}

/// Through contact the stiffness jumps, yet the energy swings about its start without drift: a weight
/// on a pendulum whose cord meets a peg and leaves it again in every swing, and a weight on a ball.
#[test]
fn energy_through_a_million_steps() {
    let peg = "
        gravity = (0, 0, -9.81) m/s^2;
        joint swing: revolute(y) in world { start = 1 rad; }
        mass bob in swing { mass = 0.1 kg; at = (0, 0, -0.3) m; inertia = (1, 1, 1) kg*mm^2; }
        strand cord { path = world (80, 0, 60) mm -> via wrap cylinder(world (0, 0, -120) mm, axis = y, radius = 25 mm, side = -x) -> swing (0, 0, -0.28) m; stiffness = 150 N/m; rest = 0.33 m; }";
    let ball = "
        gravity = (0, 0, -9.81) m/s^2;
        joint a: revolute(y) in world { start = 0.9 rad; velocity = 0.5 rad/s; }
        joint b: revolute(x) in a { start = 0.3 rad; velocity = 2 rad/s; }
        mass bob in b { mass = 0.1 kg; at = (0, 0, -0.3) m; inertia = (1, 1, 1) kg*mm^2; }
        strand cord { path = world (60, 10, 80) mm -> via wrap sphere(world (0, 0, -10) mm, radius = 40 mm) -> b (0, 0, -0.2) m; stiffness = 300 N/m; rest = 0.25 m; }";
    for (what, body, bound) in [("peg", peg, 2e-5), ("ball", ball, 6e-4)] {
        let mut run = start_for(text(body), None, 1e-3, 1001.0);
        let mut bare = run.model.mechanism().as_ref().clone();
        bare.strands[0].wraps.clear();
        let mut bare = Interpreter::new(Arc::new(bare));
        let first = run.energy();
        let (mut tenths, mut contacts, mut was_touching) = (Vec::new(), 0, false);
        for _ in 0..10 {
            let mut worst: f64 = 0.0;
            for _ in 0..100_000 {
                run.step().unwrap();
                worst = worst.max((run.energy() - first).abs());
                let (mut length, mut chord) = ([0.0], [0.0]);
                run.model.strand_lengths(&run.state.q, &mut length);
                bare.strand_lengths(&run.state.q, &mut chord);
                let touches = length[0] > chord[0] + 1e-12;
                contacts += usize::from(touches && !was_touching);
                was_touching = touches;
            }
            tenths.push(worst);
        }
        let shown: Vec<String> = tenths.iter().map(|x| format!("{x:.2e}")).collect();
        eprintln!("{what}: energy {first:.3} J, off by {} J, {contacts} contacts", shown.join(" "));
        assert!(contacts > 200 && tenths.iter().all(|&worst| worst < bound));
        let most = |part: &[f64]| part.iter().copied().fold(0.0, f64::max);
        assert!(most(&tenths[5..]) < 1.5 * most(&tenths[..5]), "it drifts");
    }
}

/// Steps until one fails, which must leave the state as it was and name the strand.
fn failure(run: &mut Run, what: &[&str]) {
    for _ in 0..10_000 {
        let before = run.state.clone();
        let Err(error) = run.step() else {
            assert!(run.state.q.iter().chain(&run.state.p).all(|x| x.is_finite()));
            continue;
        };
        assert_eq!(run.state, before);
        let said = error.to_string();
        let RunError::Step(error) = error else { panic!("{said}") };
        assert_eq!(error.kind, StepErrorKind::Blocked, "{said}");
        let when = format!("at t = {} s", (error.t * 1e12).round() / 1e12);
        for words in what.iter().chain(&[when.as_str()]) {
            assert!(said.contains(words), "no `{words}` in: {said}");
        }
        return;
    }
    panic!("no step fails");
}

#[test]
fn a_point_that_enters_the_surface() {
    let body = |surface: &str, more: &str| {
        text(&format!(
            "gravity = (0, 0, -9.81) m/s^2;
             joint fall: prismatic(z) in world at (0, 0, 0.2) m {{ {more} }}
             mass lump in fall {{ mass = 0.1 kg; }}
             strand cord {{ path = world (0.2, 0, 0.05) m -> via wrap {surface} -> fall; stiffness = 1 N/m; }}"
        ))
    };
    let cylinder = "cylinder(world, axis = y, radius = 50 mm)";
    let says = ["strand `cord`", "the cylinder in `world`", "the point behind it is"];
    failure(&mut start(body(cylinder, ""), None, 1e-3), &says);
    // Driven there.
    let drive = "drive = -1 m/s * t;";
    let says = ["strand `cord`", "the sphere in `world`", "the point behind it is"];
    let sphere = "sphere(world, radius = 50 mm)";
    let mut driven = start(body(sphere, drive), None, 1e-3);
    // Nothing else moves, so that the steps themselves have no equation to fail.
    advance(&mut driven, 151);
    let said = driven.passable().expect_err("inside").to_string();
    assert!(says.iter().all(|words| said.contains(words)), "{said}");
    assert!(said.contains("at t = 0.151 s (step 151)"), "{said}");
    // An end stop keeps it out.
    let stop = "limits = (-0.12, 1) m; limit_stiffness = 1000 N/m;";
    advance(&mut start(body(cylinder, stop), None, 1e-3), 1000);
}

#[test]
fn points_that_come_to_stand_opposite_each_other() {
    let run = |surface: &str| {
        let model = text(&format!(
            "joint a: revolute(z) in world {{ drive = 1 rad/s * (t - 0.0234375 s); }}
             joint b: prismatic(x) in a at (0.05, 0, 0) m;
             mass m in b {{ mass = 0.1 kg; }}
             strand s {{ path = world (-0.06, 0, 0) m -> via wrap {surface} -> b; stiffness = 1 N/m; rest = 0.15 m; }}"
        ));
        // The middle of the second step is exactly opposite.
        start(model, None, 0.015625)
    };
    failure(&mut run("sphere(world, radius = 20 mm)"), &["strand `s`", "opposite each other"]);
    // A cylinder has an axis to go round.
    advance(&mut run("cylinder(world, axis = z, radius = 20 mm, side = y)"), 10);
}

#[test]
fn a_start_that_cannot_be() {
    let refused = |radius: f64| {
        let model = text(
            "param thick = 10 mm;
             joint a: revolute(z) in world;
             mass m in a { mass = 1 kg; inertia = (1, 1, 1) g*m^2; }
             strand s { path = world (-60, 20, 0) mm -> via wrap sphere(world, radius = thick) -> a (50, 10, 0) mm; stiffness = 1 N/m; }",
        );
        let set = vec![("thick".to_string(), radius)];
        let settings =
            Settings { step: Some(1e-3), duration: Some(1.0), set, ..Settings::default() };
        Simulation::new(model, &settings).err().map(|error| (error.exit_code(), error.to_string()))
    };
    assert_eq!(refused(0.04), None);
    for (radius, words) in [
        (0.06, ["at the start strand `s` cannot pass", "the point behind it is 9.01"]),
        (-0.01, ["a radius must be positive, and is -0.01 at the start", "(m.hdl:5)"]),
    ] {
        let (code, said) = refused(radius).expect("it cannot begin");
        assert!(code == 3 && words.iter().all(|words| said.contains(words)), "{said}");
    }
}

/// A sphere has a side where all moves in its plane; parameters that leave it are found at the start.
#[test]
fn a_sphere_has_a_side_in_its_plane_alone() {
    let model = text(
        "param off = 0 mm;
         joint a: revolute(z) in world;
         mass m in a { mass = 1 kg; inertia = (1, 1, 1) g*m^2; }
         strand kept { path = world (-60, 0, 0) mm -> via wrap sphere(world, radius = 20 mm, side = y) -> a (50 mm, 0 mm, off); stiffness = 1 N/m; }",
    );
    // Straight through the centre it runs round on its side, by the radius.
    let (mut length, mut arm) = ([0.0], [0.0]);
    let mut at_zero = model.clone();
    at_zero.strand_lengths(&[0.0], &mut length);
    at_zero.moment_arms(&[0.0], &mut arm);
    let [p, q] = [60.0f64, 50.0].map(|x| (x * x - 400.0).sqrt());
    let arc = 20.0 * (PI - (20f64 / 60.0).acos() - (20f64 / 50.0).acos());
    assert!((1e3 * length[0] - (p + q + arc)).abs() < 1e-12, "{length:?}");
    assert!((arm[0] + 0.02).abs() < 1e-16, "{arm:?}");
    let set = vec![("off".to_string(), 1e-3)];
    let settings = Settings { step: Some(1e-3), duration: Some(1.0), set, ..Settings::default() };
    let Err(said) = Simulation::new(model, &settings) else { panic!("it starts beside its plane") };
    let said = said.to_string();
    assert!(said.contains("strand `kept` cannot pass the sphere"), "{said}");
}
