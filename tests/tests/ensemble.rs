//! Ensembles: every instance is a run of its own, whatever runs beside it.

#[path = "support/run.rs"]
mod run;

use handc_core::ensemble::{Ended, Ensemble};
use handc_core::error::RunError;
use handc_core::model::Model;
use handc_core::simulation::{Settings, Simulation};
use handc_runtime::interpreter::Interpreter;
use run::{advance, apart, text};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Instances; two threads and lanes of four or eight divide them unevenly.
const INSTANCES: usize = 21;
const STEPS: usize = 150;

fn arm() -> Interpreter {
    text(
        "param k = 30 N/m;
         input effort = 0 N*m;
         gravity = (0, 0, -9.81) m/s^2;
         joint a: revolute(y) in world { start = 0.3 rad; damping = 0.01 N*m*s/rad; }
         mass ma in a { mass = 0.5 kg; at = (0, 0, -0.2) m; inertia = (1, 1, 1) g*m^2; }
         joint b: revolute(y) in a at (0, 0, -0.3) m { start = -0.2 rad; }
         mass mb in b { mass = 0.2 kg; at = (0, 0, -0.1) m; inertia = (1, 1, 1) g*m^2; }
         strand s { path = world (0.3, 0, 0) m -> a (0, 0, -0.3) m -> b (0.02, 0, -0.1) m; stiffness = k; rest = 0.4 m; }
         torque motor on b = effort;
         scenario swing { step = 1 ms; duration = 0.15 s; }",
    )
}

/// Settings of an instance: parameter, start, rate and input are its own; some step otherwise.
fn settings(instance: usize) -> Settings {
    let i = instance as f64;
    let mut settings = Settings {
        set: vec![("k".into(), 20.0 + i)],
        start: vec![("b".into(), 0.1 * (i - 8.0))],
        velocity: vec![("a".into(), 0.2 * i)],
        inputs: vec![("effort".into(), 0.01 * i)],
        ..Settings::default()
    };
    if instance % 5 == 4 {
        settings.step = Some(2e-3);
    }
    settings
}

fn alone(settings: &Settings) -> Simulation<Interpreter> {
    Simulation::new(arm(), settings).unwrap()
}

/// All instances at their ends, in order.
fn all(
    ensemble: Ensemble<Interpreter>,
    settings: impl Fn(usize) -> Settings + Sync,
    visit: impl Fn(usize, &mut Simulation<Interpreter>) + Sync,
) -> Vec<Ended<Interpreter>> {
    let ends: Mutex<Vec<Option<Ended<Interpreter>>>> =
        Mutex::new((0..INSTANCES).map(|_| None).collect());
    ensemble.run(INSTANCES, settings, visit, |i, ended| ends.lock().unwrap()[i] = Some(ended));
    ends.into_inner().unwrap().into_iter().map(|ended| ended.expect("an end")).collect()
}

#[test]
fn every_instance_is_a_run_of_its_own() {
    let model = arm();
    for threads in [1, 2, 3] {
        let ends = all(Ensemble::new(&model).threads(threads), settings, |_, _| {});
        for (instance, ended) in ends.into_iter().enumerate() {
            assert!(ended.error.is_none());
            let (mut run, mut expected) = (ended.run.unwrap(), alone(&settings(instance)));
            let steps = expected.steps;
            advance(&mut expected, steps);
            assert_eq!((run.state.step, run.steps), (steps, steps), "{instance}");
            assert!(apart(&run.state.q, &expected.state.q) < 1e-12, "{instance}");
            assert!(apart(&run.state.p, &expected.state.p) < 1e-12, "{instance}");
            assert!((run.energy() - expected.energy()).abs() < 1e-12, "{instance}");
        }
    }
}

#[test]
fn one_that_fails_stops_no_other() {
    let model = arm();
    let settings = |instance| match instance {
        3 => Settings { set: vec![("k".into(), -1.0)], ..settings(instance) },
        // A torque that is no number, from the middle on.
        _ => settings(instance),
    };
    let ensemble = Ensemble::new(&model).threads(2).every(50);
    let ends = all(ensemble, settings, |instance, run| {
        if instance == 7 && run.state.step == 50 {
            run.hold_input(0, Some(f64::NAN));
        }
    });
    for (instance, ended) in ends.into_iter().enumerate() {
        match (instance, &ended.error) {
            (3, Some(RunError::Start(text))) => assert!(text.contains("negative"), "{text}"),
            (7, Some(RunError::Step(_))) => {
                let state = ended.run.unwrap().state;
                assert_eq!(state.step, 50);
                assert!(state.q.iter().all(|x| x.is_finite()));
            }
            (3 | 7, other) => panic!("{instance}: {other:?}"),
            (_, error) => assert!(error.is_none(), "{instance}: {error:?}"),
        }
    }
}

#[test]
fn a_controller_sees_every_run_on_its_way() {
    let (model, every) = (arm(), 10);
    let control = |run: &mut Simulation<Interpreter>| {
        let torque = -0.2 * run.state.q[1];
        run.hold_input(0, Some(torque));
    };
    let visits = AtomicUsize::new(0);
    let ends = all(Ensemble::new(&model).threads(2).every(every), settings, |_, run| {
        visits.fetch_add(1, Ordering::Relaxed);
        control(run);
    });
    let mut expected_visits = 0;
    for (instance, ended) in ends.into_iter().enumerate() {
        let mut expected = alone(&settings(instance));
        for step in 0..=expected.steps {
            if step % every == 0 {
                control(&mut expected);
                expected_visits += 1;
            }
            if step < expected.steps {
                expected.step().unwrap();
            }
        }
        let run = ended.run.unwrap();
        assert!(apart(&run.state.q, &expected.state.q) < 1e-12, "{instance}");
    }
    assert_eq!(visits.into_inner(), expected_visits);
    assert!(expected_visits > INSTANCES * STEPS / (2 * every));
}

#[test]
fn unknown_names_are_told() {
    let wrong = |settings: Settings| match Simulation::new(arm(), &settings) {
        Err(error) => error.to_string(),
        Ok(_) => panic!("it starts"),
    };
    let one = |name: &str| vec![(name.to_string(), 1.0)];
    let said = wrong(Settings { start: one("c"), ..Settings::default() });
    assert!(said.contains("no coordinate `c`"), "{said}");
    let said = wrong(Settings { inputs: one("efort"), ..Settings::default() });
    assert!(said.contains("did you mean `effort`?"), "{said}");
    assert_eq!(arm().layout().inputs.len(), 1);
}
