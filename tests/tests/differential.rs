//! Interpreter and compiled code, function by function and step by step.
//!
//! All models and fixtures of the repository and a few hundred random mechanisms go through both.
//! Every step starts from the interpreter's state, so that chaos does not matter.

use handc_runtime::interpreter::Interpreter;
use handc_runtime::mechanism::Mechanism;
use handc_tests::battery::{Battery, build};
use handc_tests::compare::{differences, every_row_moves, requests};
use handc_tests::load::{mechanism, mechanism_of_text, models};
use handc_tests::probe::{Request, answer};
use handc_tests::random;
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// Random models that must run, and seeds that are tried for them.
const WANTED: usize = 210;
const SEEDS: u64 = 600;

/// Lanes that vectors may have: all that the machine has, those of AVX2, none.
const LANES: [usize; 3] = [8, 4, 1];

struct Case {
    mechanism: Mechanism,
    requests: Vec<Request>,
}

struct Everything {
    written: Vec<Case>,
    random: Vec<Case>,
    battery: Battery,
}

/// Every model file of the repository.
fn written() -> Vec<Case> {
    let mut cases = Vec::new();
    for folder in ["models", "tests/fixtures", "tests/cases"] {
        for path in models(folder) {
            let Ok(mut mechanism) = mechanism(&path) else { continue };
            mechanism.name = format!("{}_{}", folder.replace('/', "_"), mechanism.name);
            let requests = requests(&mechanism, 7).expect("a model that starts");
            cases.push(Case { mechanism, requests });
        }
    }
    cases
}

/// Random models that can start.
fn drawn() -> Vec<Case> {
    let mut cases = Vec::new();
    for seed in 0..SEEDS {
        let name = format!("random_{seed}");
        let Some(text) = random::model(&name, seed) else { continue };
        let mechanism =
            mechanism_of_text(&name, &text).unwrap_or_else(|said| panic!("{said}\n{text}"));
        if !every_row_moves(&mechanism) {
            continue;
        }
        if let Some(requests) = requests(&mechanism, seed) {
            cases.push(Case { mechanism, requests });
        }
        if cases.len() == WANTED {
            break;
        }
    }
    cases
}

fn everything() -> &'static Everything {
    static ALL: OnceLock<Everything> = OnceLock::new();
    ALL.get_or_init(|| {
        let (written, random) = (written(), drawn());
        let all: Vec<Mechanism> =
            written.iter().chain(&random).map(|case| case.mechanism.clone()).collect();
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("battery");
        Everything { battery: build(&folder, &all), written, random }
    })
}

/// Asks both sides about all cases.
fn agree(battery: &Battery, cases: &[Case]) {
    let asked: Vec<Request> = cases.iter().flat_map(|case| case.requests.clone()).collect();
    let mut compiled = LANES.map(|lanes| battery.ask(&asked, lanes).into_iter());
    let mut wrong = Vec::new();
    let (mut steps, mut taken) = (0, 0);
    for case in cases {
        let interpreter = Interpreter::new(Arc::new(case.mechanism.clone()));
        for request in &case.requests {
            let expected = answer(interpreter.clone(), request);
            steps += request.starts.len();
            taken += expected.iter().filter(|a| a.what.ends_with(" energy")).count();
            let scenario = request.settings.scenario.as_deref().unwrap_or("none");
            let name = format!("{}, {scenario}", request.model);
            for (compiled, lanes) in compiled.iter_mut().zip(LANES) {
                let found = compiled.next().expect("an answer to every request");
                let name = format!("{name}, {lanes} lanes");
                wrong.extend(differences(&name, &expected, &found));
            }
        }
    }
    assert!(taken * 100 >= steps * 98, "only {taken} of {steps} steps are taken");
    assert!(wrong.is_empty(), "{} differences\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn written_models_agree() {
    let all = everything();
    assert!(all.written.len() >= 20, "only {} models", all.written.len());
    agree(&all.battery, &all.written);
}

#[test]
fn random_mechanisms_agree() {
    let all = everything();
    assert!(all.random.len() >= 200, "only {} random models start", all.random.len());
    agree(&all.battery, &all.random);
}
