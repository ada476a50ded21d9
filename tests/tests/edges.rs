//! Where the equations of a step are redundant or singular, or have no solution.

#[path = "support/run.rs"]
mod run;

use handc_core::error::{RunError, StepError, StepErrorKind};
use handc_core::model::Model;
use run::{Run, advance, apart, model, start, start_for, text};

/// A pin of three rows closes a loop that needs two: the same motion, and nothing on the third.
#[test]
fn a_row_too_many() {
    let loop_of = |pin: &str| {
        text(&format!(
            "gravity = (0, 0, -9.81) m/s^2;
             joint a: revolute((0, -1, 0)) in world {{ start = 1 rad; }}
             mass ma in a {{ mass = 0.1 kg; at = (50, 0, 0) mm; inertia = (1, 80, 80) kg*mm^2; }}
             joint b: revolute((0, -1, 0)) in a at (100, 0, 0) mm {{ start = -0.36105209221293266 rad; }}
             mass mb in b {{ mass = 0.35 kg; at = (175, 0, 0) mm; inertia = (1, 80, 80) kg*mm^2; }}
             joint c: revolute((0, -1, 0)) in world at (400, 0, 0) mm {{ start = 1.7892514033875246 rad; }}
             mass mc in c {{ mass = 0.3 kg; at = (150, 0, 0) mm; inertia = (1, 80, 80) kg*mm^2; }}
             constraint pin: coincident(b (350, 0, 0) mm, c (300, 0, 0) mm{pin});"
        ))
    };
    let (mut two, mut three) =
        (start(loop_of(", axes = (x, z)"), None, 0.002), start(loop_of(""), None, 0.002));
    for _ in 0..500 {
        advance(&mut two, 1);
        advance(&mut three, 1);
        // The two are rounded differently, and the motion pulls neighbours apart: tenfold in 0.2 s.
        assert!(apart(&two.state.q, &three.state.q) < 1e-10);
        let [x, y, z] = [0, 1, 2].map(|i| three.state.lambda[i]);
        assert!(y.abs() < 1e-12 && apart(&[x, z], &two.state.lambda) < 1e-9);
    }
    eprintln!("a row too many: {:.1e} apart", apart(&two.state.q, &three.state.q));
}

/// Two welds at one place share what one alone would carry.
#[test]
fn welded_twice() {
    let held = |welds: &str| {
        text(&format!(
            "gravity = (0, 0, -9.81) m/s^2;
             joint swing: revolute(y) in world {{ start = 0.4 rad; }}
             mass arm in swing {{ mass = 1 kg; at = (0.2, 0, 0) m; inertia = (0.001, 0.02, 0.02) kg*m^2; }}
             joint body: free in world at (0.3, 0, 0) m {{ start = (-0.023681701799134 m, 0 m, -0.116825502692595 m, 0 rad, 0.4 rad, 0 rad); }}
             mass load in body {{ mass = 0.5 kg; at = (0.1, 0.05, 0) m; inertia = (0.002, 0.003, 0.004) kg*m^2; }}
             frame seat in swing at (0.3, 0, 0) m;
             {welds}"
        ))
    };
    let mut once = start(held("constraint w: weld(seat, body);"), None, 0.002);
    let welds = "constraint w: weld(seat, body); constraint again: weld(seat, body);";
    let mut twice = start(held(welds), None, 0.002);
    let mut worst: f64 = 0.0;
    for _ in 0..500 {
        advance(&mut once, 1);
        advance(&mut twice, 1);
        assert!(apart(&once.state.q, &twice.state.q) < 1e-10);
        let half: Vec<f64> = once.state.lambda.iter().map(|x| 0.5 * x).collect();
        let scale = half.iter().fold(0.0, |a: f64, x| a.max(x.abs()));
        for lambda in twice.state.lambda.chunks(6) {
            worst = worst.max(apart(lambda, &half) / scale);
        }
    }
    eprintln!("welded twice: multipliers {worst:.1e} from half");
    assert!(worst < 1e-9);
}

/// x = 0, 2x = 0 and y = 0 on weights: rows (1, 2) carry s = −h m g (half in the first step), so that
/// the pseudo-inverse gives s·(1, 2)/5.
#[test]
fn least_norm_by_hand() {
    let weights = text(
        "gravity = (0, 0, -10) m/s^2;
         joint x: prismatic(z) in world;
         mass mx in x { mass = 3 kg; }
         joint y: prismatic(z) in world;
         mass my in y { mass = 1 kg; }
         constraint one: x == 0 m;
         constraint two: 2 * x == 0 m;
         constraint other: y == 0 m;",
    );
    let mut run = start(weights, None, 0.01);
    for step in 0..5 {
        run.step().unwrap();
        let s = -0.01 * 10.0 * if step == 0 { 0.5 } else { 1.0 };
        let expected = [3.0 * s / 5.0, 3.0 * s * 2.0 / 5.0, s];
        assert!(apart(&run.state.lambda, &expected) < 1e-15, "{:?}", run.state.lambda);
        assert!(apart(&run.state.q, &[0.0, 0.0]) < 1e-15);
    }
}

/// Steps until one fails, which must leave the state as it was, however often it is tried.
fn failure(run: &mut Run) -> StepError {
    for _ in 0..10_000 {
        let before = run.state.clone();
        if let Err(error) = run.step() {
            assert_eq!(run.state, before);
            let RunError::Step(first) = error else { panic!("{error}") };
            let Err(RunError::Step(second)) = run.step() else { panic!("fails only once") };
            assert_eq!(run.state, before);
            assert_eq!((&first.kind, &first.equation), (&second.kind, &second.equation));
            eprintln!("{first}");
            return first;
        }
        assert!(run.state.q.iter().chain(&run.state.p).all(|x| x.is_finite()));
    }
    panic!("no step fails");
}

#[test]
fn a_step_that_cannot_be_taken() {
    // The slider runs away from what two bars can reach.
    let torn = text(
        "joint a: revolute(z) in world { start = 0.8 rad; }
         mass ma in a { mass = 1 kg; at = (0.5, 0, 0) m; inertia = (0.1, 0.1, 0.1) kg*m^2; }
         joint b: revolute(z) in a at (1, 0, 0) m { start = -1.6 rad; }
         mass mb in b { mass = 1 kg; at = (0.5, 0, 0) m; inertia = (0.1, 0.1, 0.1) kg*m^2; }
         joint s: prismatic(x) in world { drive = 2 m * cos(0.8) + if(t < 0.05 s, 0 m, 1 m); }
         constraint pin: coincident(b (1, 0, 0) m, s, axes = (x, y));",
    );
    let error = failure(&mut start(torn, None, 0.01));
    assert_ne!(error.kind, StepErrorKind::NotFinite);
    assert!(error.equation.starts_with("pin") && (error.t - 0.04).abs() < 1e-9, "{error}");
    assert!(error.to_string().contains("t = 0.04"), "{error}");
}

#[test]
fn what_is_not_a_number_is_never_a_state() {
    let slider = "joint x: prismatic(x) in world { start = 0.1 m; velocity = -1 m/s; }
        joint far: prismatic(y) in world; mass mfar in far { mass = 1 kg; }
        mass m in x { mass = 1 kg; }";
    let cases = [
        ("torque bad on x = 1 N * log(0.05 - t / 1 s);", Some(StepErrorKind::NotFinite), 0.045),
        // Its slope has no bound at the end of its range: Newton may fail before the root does.
        ("torque bad on x = 1 N * sqrt(x / 1 m);", None, 0.0),
        (
            "strand s { path = world (0.1, 0, 0) m -> x; stiffness = 1 N/m; rest = 1 m; }",
            Some(StepErrorKind::NotFinite),
            0.0,
        ),
    ];
    for (what, kind, earliest) in cases {
        let mut run = start(text(&format!("{slider} {what}")), None, 0.01);
        if what.starts_with("strand") {
            // At rest on the point to which the strand is tied.
            run.state.p.fill(0.0);
            run.state.v.fill(0.0);
        }
        let error = failure(&mut run);
        assert_eq!(error.equation, "x", "{what}: {error}");
        assert!(kind.is_none_or(|kind| kind == error.kind), "{what}: {error}");
        assert!(error.t >= earliest - 0.0101, "{error}");
        assert!(error.to_string().contains(&format!("t = {} s", error.t)), "{error}");
    }
}

/// A mass hangs on two strands in a row, with a massless point between them: springs in series, of
/// which the rule's exact motion is known.
#[test]
fn a_point_without_mass() {
    let (h, n) = (0.01, 1000);
    let series = text(
        "joint y: prismatic(x) in world { start = 1.06 m; }
         joint x: prismatic(x) in world { start = 2.1 m; }
         mass m in x { mass = 2 kg; }
         strand one { path = world -> y; stiffness = 20 N/m; rest = 1 m; }
         strand two { path = y -> x; stiffness = 30 N/m; rest = 1 m; }",
    );
    let mut run = start(series, None, h);
    let energy = run.energy();
    advance(&mut run, n);
    let phase = 2.0 * n as f64 * (0.5 * h * (12.0f64 / 2.0).sqrt()).atan();
    let x = 0.1 * phase.cos();
    let errors = [run.state.q[0] - 1.0 - 0.6 * x, run.state.q[1] - 2.0 - x].map(f64::abs);
    let energy = run.energy() - energy;
    eprintln!("springs in series: {:.1e}, {:.1e}, energy {energy:.1e}", errors[0], errors[1]);
    // Without inertia the midpoint alone is determined: rounding flips from step to step.
    assert!(errors[0] < 2e-11 && errors[1] < 1e-13 && energy.abs() < 1e-13);
    assert!(run.state.p[0].abs() < 1e-13);
}

/// The split of the tendon lies in the finger's plane: what it is beside it dies away, but not to numbers
/// so small that they slow the processor down.
#[test]
fn what_dies_away() {
    let model = model("extensor");
    let beside = model.layout().coordinates.iter().position(|c| c.name == "split.y").unwrap();
    let mut run = start_for(model, Some("stretch"), 1e-3, 2.0);
    advance(&mut run, 500);
    for _ in 0..500 {
        advance(&mut run, 1);
        let y = run.state.q[beside].abs();
        assert!(y < 1e-40 && (y == 0.0 || y > 1e-70), "{y:e}");
    }
}
