//! Rows about speed: both sides in turn, several rounds, within one process each.

use crate::own::{Crate, Own};
use crate::rival::Rival;
use crate::table::{Row, Series, Target};
use handc_core::simulation::{Settings, Simulation};
use handc_tests::load::interpreter;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Steps that MuJoCo takes alone.
const RIVAL_STEPS: usize = 4000;

/// MuJoCo's integrators.
pub(crate) const INTEGRATORS: [&str; 3] = ["Euler", "implicitfast", "RK4"];

/// A model whose steps are timed.
struct Case {
    /// File in the folder of models.
    file: &'static str,
    /// Scenario of handc's runs, and the one that is exported.
    scenarios: [&'static str; 2],
    /// Duration of a copy in an ensemble.
    short: &'static str,
    /// Copies of an ensemble.
    copies: usize,
    /// Steps of MuJoCo for one of handc's.
    finer: usize,
    /// Targets of a step alone and in an ensemble (µs).
    targets: [Option<f64>; 2],
    /// What MuJoCo's Euler took on the machine for which they were set (µs).
    then: [Option<f64>; 2],
}

/// Why a time may be missed that has no rival beside it.
const SHARED: &str = "The target is that of one machine; how much slower this one is can be seen by MuJoCo's times \
     (9.0 us for the hand by Euler's method there).";

/// What was tried for steps that take longer than their target, alone and in an ensemble.
const TRIED: [&str; 2] = [
    "The targets in microseconds are those of one machine; the ratio says how this one compares. \
     A step is one evaluation with its matrix, one chain of values that wait for each other. What helped and what \
     did not is in docs/performance.md.",
    "The targets in microseconds are those of one machine; the ratio says how this one compares. \
     One evaluation a step is left, a second one where vibrations of stiff strands differ from lane to lane. Tried: \
     vectors whose passes take turns, lists that begin at cache lines, two vectors as one; none was faster \
     (docs/performance.md).",
];

const CASES: [Case; 3] = [
    Case {
        file: "hand",
        scenarios: ["close", "close"],
        short: "2",
        copies: 32,
        finer: 1,
        targets: [Some(1.0), Some(0.25)],
        then: [Some(9.0), Some(9.6)],
    },
    Case {
        file: "finger",
        scenarios: ["long", "track"],
        short: "100",
        copies: 32,
        // At the scenario's 10 ms MuJoCo diverges.
        finer: 10,
        targets: [Some(0.2), Some(0.04)],
        then: [Some(1.9), Some(1.9)],
    },
    Case {
        file: "grasp",
        scenarios: ["hold", "hold"],
        short: "1",
        copies: 16,
        finer: 1,
        targets: [Some(6.0), None],
        then: [None, None],
    },
];

/// Times of one case, a number a round.
#[derive(Default)]
struct Times {
    alone: Series,
    alike: Series,
    together: Series,
    gain: Series,
    rivals: Vec<Series>,
    rivals_together: [Series; 2],
}

/// All rows about speed.
pub(crate) fn rows(
    own: &Own,
    rival: &mut Result<Rival, String>,
    crates: &[Crate],
    rounds: usize,
) -> Result<Vec<Row>, String> {
    let mut rows = Vec::new();
    for case in &CASES {
        let made = crates.iter().find(|c| c.name == case.file).ok_or("no crate")?;
        rows.extend(measure(own, rival, case, made, rounds)?);
    }
    let model = own.folder.join("models/hand.hdl");
    let mut times = Series::default();
    for _ in 0..rounds {
        let run = own.interpret(&model, &["--scenario", "close", "--duration", "2"])?;
        times.0.push(run.wall * 1e6 / run.steps);
    }
    rows.push(Row {
        what: "hand, a step of the interpreter (us)".into(),
        own: Ok(times),
        target: Some(Target::Most(10.0)),
        ratio: None,
        tried: SHARED,
        rivals: Vec::new(),
    });
    let hand = crates.iter().find(|c| c.name == "hand").ok_or("no hand")?;
    rows.push(Row {
        what: "hand, operations of residual and matrix".into(),
        own: operations(&hand.report).map(|n| Series(vec![n])),
        target: Some(Target::Most(3600.0)),
        ratio: None,
        tried: "Four fingers share one set of equations here, with terms that vanish in some of them; apart they would have \
                fewer operations but no lanes. Tried: constants gathered in sums, 4 operations for 240 lines.",
        rivals: Vec::new(),
    });
    let mut compile = Series(vec![hand.seconds]);
    let mut build = Series::default();
    for _ in 0..rounds.min(3) {
        compile.0.push(own.compile(&model, Duration::from_secs(60))?.seconds);
    }
    for _ in 0..rounds.min(2) {
        build.0.push(own.make(hand, true, Duration::from_secs(600))?);
    }
    for (what, series, most) in [
        ("`handc compile` of the hand (s)", compile, 1.0),
        ("release build of its crate from scratch (s)", build, 20.0),
    ] {
        let target = Some(Target::Most(most));
        rows.push(Row {
            what: what.into(),
            own: Ok(series),
            target,
            ratio: None,
            tried: SHARED,
            rivals: Vec::new(),
        });
    }
    Ok(rows)
}

/// The number before `with the Newton matrix` in what `handc compile` says.
pub(crate) fn operations(report: &str) -> Result<f64, String> {
    let before = report.split(" with the Newton matrix").next().unwrap_or_default();
    let word = before.rsplit(|c: char| !c.is_ascii_digit()).find(|word| !word.is_empty());
    word.and_then(|word| word.parse().ok()).ok_or_else(|| "not told".to_string())
}

fn measure(
    own: &Own,
    rival: &mut Result<Rival, String>,
    case: &Case,
    made: &Crate,
    rounds: usize,
) -> Result<Vec<Row>, String> {
    let model = own.folder.join(format!("models/{}.hdl", case.file));
    let [scenario, exported] = case.scenarios;
    let xml = own.export(&model, exported)?;
    let (controls, step) = controls(&own.folder, &model, exported)?;
    let step = step / case.finer as f64;
    let mut times = Times { rivals: vec![Series::default(); 3], ..Times::default() };
    let mut failed = rival.as_ref().err().cloned();
    let copies = case.copies.to_string();
    let (spread, duration) = (["--spread", "start=1e-4"], ["--duration", case.short]);
    for _ in 0..rounds {
        let run = own.run(made, &["--scenario", scenario])?;
        times.alone.0.push(run.wall * 1e6 / run.steps);
        if let Ok(rival) = rival {
            for (integrator, series) in INTEGRATORS.iter().zip(&mut times.rivals) {
                let steps = if *integrator == "RK4" { RIVAL_STEPS / 2 } else { RIVAL_STEPS };
                let asked = rival.ask(&json!({
                    "ask": "speed", "xml": xml, "integrator": integrator, "steps": steps,
                    "instances": 1, "threads": 1, "controls": controls, "repeat": case.finer,
                    "step": step,
                }));
                note(asked, series, &mut failed);
            }
        }
        let base = ["--scenario", scenario, "--instances", &copies, "--threads"];
        let options = |threads| [&base[..], &[threads], &spread, &duration].concat();
        let alike = own.run(made, &[&base[..], &["1"], &duration].concat())?;
        times.alike.0.push(alike.wall * 1e6 / alike.steps);
        let one = own.run(made, &options("1"))?;
        let two = own.run(made, &options("2"))?;
        times.together.0.push(one.wall * 1e6 / one.steps);
        times.gain.0.push((one.wall / one.steps) / (two.wall / two.steps));
        if let Ok(rival) = rival {
            for (threads, series) in [1, 2].into_iter().zip(&mut times.rivals_together) {
                let steps = 500;
                let asked = rival.ask(&json!({
                    "ask": "speed", "xml": xml, "integrator": "Euler", "steps": steps,
                    "instances": 16, "threads": threads, "controls": controls,
                    "repeat": case.finer, "step": step,
                }));
                note(asked, series, &mut failed);
            }
        }
    }
    Ok(as_rows(case, times, failed))
}

fn as_rows(case: &Case, times: Times, failed: Option<String>) -> Vec<Row> {
    let told = |series: Series| match (&failed, series.0.is_empty()) {
        (Some(reason), true) => Err(reason.clone()),
        _ => Ok(series),
    };
    let finer = match case.finer {
        1 => String::new(),
        n => format!("; MuJoCo at 1/{n} of the step, else it diverges"),
    };
    let target = |most: Option<f64>| most.map(Target::Most);
    let ratio = |k: usize| Some(case.then[k]? / case.targets[k]?);
    let ensemble = |how: &str, own, rival| Row {
        what: format!(
            "{}, a step of a copy in an ensemble on one core, copies {how} (us)",
            case.file
        ),
        own: Ok(own),
        target: target(case.targets[1]),
        ratio: ratio(1),
        tried: TRIED[1],
        rivals: vec![("rollout, Euler".into(), rival)],
    };
    let [one, two] = times.rivals_together;
    let gain = Series(one.0.iter().zip(&two.0).map(|(a, b)| a / b).collect());
    let names = INTEGRATORS.iter().map(|name| (*name).to_string());
    vec![
        Row {
            what: format!("{}, a step (us){finer}", case.file),
            own: Ok(times.alone),
            target: target(case.targets[0]),
            ratio: ratio(0),
            tried: TRIED[0],
            rivals: names.zip(times.rivals.into_iter().map(told)).collect(),
        },
        ensemble("alike", times.alike, told(one.clone())),
        ensemble("1e-4 rad apart", times.together, told(one)),
        Row {
            what: format!("{}, gain of an ensemble on two threads", case.file),
            own: Ok(times.gain),
            target: Some(Target::Least(1.9)),
            ratio: None,
            tried: "A gain of two threads needs two idle cores.",
            rivals: vec![("rollout".into(), told(gain))],
        },
    ]
}

/// Adds the microseconds a step of an answer.
fn note(
    asked: Result<serde_json::Value, String>,
    series: &mut Series,
    failed: &mut Option<String>,
) {
    let number = |value: &serde_json::Value| value.as_f64().unwrap_or(f64::NAN);
    match asked {
        Ok(answer) => series.0.push(number(&answer["seconds"]) * 1e6 / number(&answer["steps"])),
        Err(error) => *failed = Some(error),
    }
}

/// How much longer every natural length is than at the start, step by step, where a scenario moves
/// them: MuJoCo's controls, as a file of 64-bit numbers. With it the scenario's step (s).
fn controls(folder: &Path, model: &Path, scenario: &str) -> Result<(Option<PathBuf>, f64), String> {
    let settings = Settings { scenario: Some(scenario.into()), ..Settings::default() };
    let mut run = Simulation::new(interpreter(model), &settings).map_err(|e| e.to_string())?;
    let start = run.rest().to_vec();
    let mut bytes = Vec::new();
    let mut moved = false;
    for _ in 0..RIVAL_STEPS.min(run.steps) {
        run.step().map_err(|e| e.to_string())?;
        for (now, then) in run.rest().iter().zip(&start) {
            moved |= now != then;
            bytes.extend((now - then).to_le_bytes());
        }
    }
    if !moved {
        return Ok((None, run.h));
    }
    let stem = model.file_stem().unwrap_or_default().to_string_lossy();
    let path = folder.join(format!("{stem}-{scenario}.f64"));
    std::fs::write(&path, bytes).map_err(|e| e.to_string())?;
    Ok((Some(path), run.h))
}
