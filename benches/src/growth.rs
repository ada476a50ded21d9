//! How cost grows with the model: fingers side by side, and chains.

use crate::models::{CHAINS, FINGERS, write};
use crate::own::{Own, lines};
use crate::table::figure;
use handc_tests::grown::{chain, fingers};
use std::fmt::Write as _;
use std::time::Duration;

/// Time that a model may take to compile, and a crate to build.
const LIMIT: Duration = Duration::from_secs(120);

/// Time of stepping that can be read off a run's summary (s).
const LONG_ENOUGH: f64 = 0.1;

/// How much higher than asked a power may be measured.
const ALLOWANCE: f64 = 0.15;

/// One size.
#[derive(Clone, Debug)]
struct Size {
    count: usize,
    /// Lines of Rust, and seconds to compile; or why not.
    code: Result<[f64; 2], String>,
    /// µs a step, and seconds to build; or why not.
    time: Result<[f64; 2], String>,
}

/// Both families as markdown, with verdicts.
pub(crate) fn report(own: &Own, rounds: usize) -> String {
    let mut text = String::new();
    let all: Vec<Size> = FINGERS
        .iter()
        .map(|&n| measure(own, &format!("fingers_{n}"), &fingers(n), n, rounds))
        .collect();
    text.push_str(&table("fingers", &all));
    verdict("fingers", 1.0, &all, &mut text);
    let all: Vec<Size> =
        CHAINS.iter().map(|&n| measure(own, &format!("chain_{n}"), &chain(n), n, rounds)).collect();
    text.push_str(&table("links of a chain", &all));
    // The matrix of a chain is full.
    verdict("chains", 2.0, &all, &mut text);
    text
}

fn measure(own: &Own, name: &str, model: &str, count: usize, rounds: usize) -> Size {
    eprintln!("growth: {name}");
    let made = write(&own.folder.join("models"), &format!("{name}.hdl"), model)
        .and_then(|path| own.compile(&path, LIMIT));
    let made = match made {
        Ok(made) => made,
        Err(reason) => return Size { count, code: Err(reason.clone()), time: Err(reason) },
    };
    let build = own.forget(&made).and_then(|()| own.make(&made, false, LIMIT));
    let time = build.and_then(|build| {
        let mut least = f64::INFINITY;
        // Long enough to be timed.
        let first = own.run(&made, &[])?;
        let duration = (LONG_ENOUGH / first.wall.max(1e-4)).ceil().clamp(1.0, 100.0).to_string();
        for _ in 0..rounds {
            let run = own.run(&made, &["--duration", &duration])?;
            least = least.min(run.wall * 1e6 / run.steps);
        }
        Ok([least, build])
    });
    let rust = lines(&made.folder.join("src")) as f64;
    Size { count, code: Ok([rust, made.seconds]), time }
}

fn table(what: &str, sizes: &[Size]) -> String {
    let mut text = format!(
        "\n| {what} | us/step, least | of each | lines of Rust | of each | `handc compile`, s | build, s |\n\
         |---|---|---|---|---|---|---|\n"
    );
    for size in sizes {
        let n = size.count as f64;
        let [time, each, build] = match &size.time {
            Ok([time, build]) => [figure(*time), figure(time / n), figure(*build)],
            Err(reason) => ["-".into(), "-".into(), reason.clone()],
        };
        let [rust, of_each, compile] = match &size.code {
            Ok([rust, compile]) => [format!("{rust}"), figure(rust / n), figure(*compile)],
            Err(reason) => ["-".into(), "-".into(), reason.clone()],
        };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "| {} | {time} | {each} | {rust} | {of_each} | {compile} | {build} |",
            size.count
        );
    }
    text
}

/// Whether code grows linearly and time at most as a power of the size, from a quarter of the largest size
/// on.
fn verdict(what: &str, power_of_time: f64, sizes: &[Size], text: &mut String) {
    let (Some(large), Some(small)) = (sizes.last(), sizes.iter().rev().nth(2)) else { return };
    let code = ("code", 1.0, [&large.code, &small.code]);
    for (name, most, pair) in [code, ("time", power_of_time, [&large.time, &small.time])] {
        let told = match pair {
            [Ok(above), Ok(below)] => {
                let by = (large.count as f64 / small.count as f64).ln();
                let power = (above[0] / below[0]).ln() / by;
                let met = if power <= most + ALLOWANCE { "met" } else { "not met" };
                format!("{met}: as the power {power:.2} of the size")
            }
            _ => "not met: not all sizes were made".to_string(),
        };
        let _ = writeln!(
            text,
            "\n{what}: {name} grows at most as the power {most} from {} to {}: {told}.",
            small.count, large.count
        );
    }
}
