//! What a step of the models takes that tendons are the matter of: the shipped ones, compiled and by the
//! interpreter.

use crate::own::Own;
use crate::speed::operations;
use crate::table::Series;
use handc_tests::load::repository;
use std::fmt::Write;
use std::time::Duration;

/// Model, scenario, and how long it runs (s): long enough to be timed.
const MODELS: [(&str, &str, &str); 7] = [
    ("finger_muscle", "close", "20"),
    ("finger_muscle", "sway", "20"),
    ("extensor", "stretch", "20"),
    ("extensor", "mallet", "20"),
    ("shadow_finger", "grip", "20"),
    ("finger_kinematic", "track", "100"),
    ("hand_kinematic", "close", "100"),
];

/// The table.
pub(crate) fn report(own: &Own, rounds: usize) -> Result<String, String> {
    let limit = Duration::from_secs(600);
    let mut out = String::from(
        "\nMicroseconds a step of whole models.\n\n\
         | model | scenario | operations with the matrix | compiled | interpreter |\n|---|---|---|---|---|\n",
    );
    for (name, scenario, duration) in MODELS {
        let path = repository(&format!("models/{name}.hdl"));
        let made = own.compile(&path, limit)?;
        own.make(&made, false, limit)?;
        let options = ["--scenario", scenario, "--duration", duration];
        let (mut compiled, mut interpreted) = (Series::default(), Series::default());
        for _ in 0..rounds.max(3) {
            let run = own.run(&made, &options)?;
            compiled.0.push(run.wall * 1e6 / run.steps);
            let run = own.interpret(&path, &options)?;
            interpreted.0.push(run.wall * 1e6 / run.steps);
        }
        let operations = operations(&made.report)?;
        let (compiled, interpreted) = (compiled.least(), interpreted.least());
        let _ = writeln!(
            out,
            "| `{name}` | `{scenario}` | {operations} | {compiled:.2} | {interpreted:.1} |"
        );
    }
    Ok(out)
}
