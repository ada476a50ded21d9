//! Interpreter and compiled code, function by function and step by step.
//!
//! All models and fixtures of the repository and a few hundred random mechanisms go through both; all of
//! the former and some of the latter are compiled again with little or no room for straight lines, so that
//! loops over tables take their place.
//! Every step starts from the interpreter's state, so that chaos does not matter.

use handc::stage::DEFAULT_BUDGET;
use handc_runtime::interpreter::Interpreter;
use handc_runtime::mechanism::Mechanism;
use handc_tests::battery::{Battery, build};
use handc_tests::compare::{differences, every_row_moves, requests};
use handc_tests::grown::{chain, fingers};
use handc_tests::load::{mechanism, mechanism_of_text, models};
use handc_tests::probe::{Request, answer};
use handc_tests::random;
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// Random models that must run, and seeds that are tried for them.
const WANTED: usize = 210;
const SEEDS: u64 = 600;

/// One random model of so many is compiled with tables too.
const WITH_TABLES: usize = 5;
/// Room for some groups of functions, and not for others.
const SMALL_BUDGET: usize = 1000;
/// Lanes that vectors may have: all that the machine has, those of AVX2, none.
const LANES: [usize; 3] = [8, 4, 1];

struct Case {
    mechanism: Mechanism,
    budget: usize,
    requests: Vec<Request>,
}

impl Case {
    /// `None` for a model that cannot start.
    fn new(mechanism: Mechanism, budget: usize, seed: u64) -> Option<Case> {
        let requests = requests(&mechanism, seed)?;
        Some(Case { mechanism, budget, requests })
    }

    /// The same model and questions, compiled with another budget.
    fn with_budget(&self, budget: usize) -> Case {
        let mut mechanism = self.mechanism.clone();
        mechanism.name = format!("{}_within_{budget}", mechanism.name);
        let mut requests = self.requests.clone();
        requests.iter_mut().for_each(|request| request.model.clone_from(&mechanism.name));
        Case { mechanism, budget, requests }
    }
}

struct Everything {
    written: Vec<Case>,
    random: Vec<Case>,
    battery: Battery,
}

/// Every model file of the repository, and two large models.
fn written() -> Vec<Case> {
    let mut cases = Vec::new();
    for folder in ["models", "tests/fixtures", "tests/cases"] {
        for path in models(folder) {
            let Ok(mut mechanism) = mechanism(&path) else { continue };
            mechanism.name = format!("{}_{}", folder.replace('/', "_"), mechanism.name);
            let case = Case::new(mechanism, DEFAULT_BUDGET, 7).expect("a model that starts");
            cases.extend([0, SMALL_BUDGET].map(|budget| case.with_budget(budget)));
            cases.push(case);
        }
    }
    for (name, text) in [("chain_128", chain(128)), ("fingers_64", fingers(64))] {
        let mechanism = mechanism_of_text(name, &text).unwrap_or_else(|said| panic!("{said}"));
        cases.extend(Case::new(mechanism, DEFAULT_BUDGET, 7));
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
        if let Some(case) = Case::new(mechanism, DEFAULT_BUDGET, seed) {
            cases.push(case);
        }
        if cases.len() == WANTED {
            break;
        }
    }
    let few = cases.iter().step_by(WITH_TABLES).enumerate();
    let tables: Vec<Case> =
        few.map(|(number, case)| case.with_budget([0, SMALL_BUDGET][number % 2])).collect();
    cases.extend(tables);
    cases
}

fn everything() -> &'static Everything {
    static ALL: OnceLock<Everything> = OnceLock::new();
    ALL.get_or_init(|| {
        let (written, random) = (written(), drawn());
        let all: Vec<(Mechanism, usize)> = written
            .iter()
            .chain(&random)
            .map(|case| (case.mechanism.clone(), case.budget))
            .collect();
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
