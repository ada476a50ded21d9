//! The command line of a run, shared by `handc run` and by every generated crate.

use crate::ensemble;
use crate::error::RunError;
use crate::model::Model;
use crate::simulation::{Settings, Simulation};
use crate::suggest::nearest;
use crate::trajectory::Trajectory;
use std::path::PathBuf;
use std::time::Instant;

/// Options of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunOptions {
    /// Scenario, parameters, step and duration.
    pub settings: Settings,
    /// Result file.
    pub out: Option<PathBuf>,
    /// A row for every N-th step.
    pub every: usize,
    /// An ensemble instead of a single run.
    pub ensemble: Option<ensemble::Plan>,
}

/// The options as text, for a usage message.
pub const OPTIONS: &str = "\
  --scenario S          which scenario; a single one needs no name
  --out F.csv           write the trajectory; without it nothing is written
  --every N             a row for every N-th step (default 1)
  --set PARAM=VALUE     set a parameter (SI units); may be repeated
  --step SECONDS        step instead of the scenario's
  --duration SECONDS    duration instead of the scenario's
  --instances N         run N copies
  --threads T           on T threads (default: all cores)
  --spread PARAM=LO:HI  spread a parameter evenly over the copies; may be repeated
  --spread start=SIGMA  spread the start normally (rad or m), by a fixed seed
  --summary F.csv       write mean, deviation and quantiles over the copies, every N-th step";

impl RunOptions {
    /// Reads options; an error says what is wrong with them.
    pub fn parse(arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut options = RunOptions { every: 1, ..RunOptions::default() };
        let mut instances = None;
        let mut threads = None;
        let mut summary = None;
        let mut spread = Vec::new();
        let mut arguments = arguments.peekable();
        let mut given: Vec<String> = Vec::new();
        while let Some(argument) = arguments.next() {
            let (name, attached) = match argument.split_once('=') {
                Some((name, value)) if name.starts_with("--") => {
                    (name.to_string(), Some(value.to_string()))
                }
                _ => (argument.clone(), None),
            };
            if given.contains(&name) && !matches!(name.as_str(), "--set" | "--spread") {
                return Err(format!("`{name}` is given twice"));
            }
            given.push(name.clone());
            let mut value = || {
                attached
                    .clone()
                    .or_else(|| arguments.next())
                    .ok_or_else(|| format!("`{name}` needs a value"))
            };
            match name.as_str() {
                "--scenario" => options.settings.scenario = Some(value()?),
                "--out" => options.out = Some(PathBuf::from(value()?)),
                "--every" => options.every = count("--every", &value()?)?,
                "--set" => options.settings.set.push(assignment(&value()?)?),
                "--step" => options.settings.step = Some(number("--step", &value()?)?),
                "--duration" => {
                    options.settings.duration = Some(number("--duration", &value()?)?);
                }
                "--instances" => instances = Some(count("--instances", &value()?)?),
                "--threads" => threads = Some(count("--threads", &value()?)?),
                "--summary" => summary = Some(PathBuf::from(value()?)),
                "--spread" => spread.push(ensemble::Spread::parse(&value()?)?),
                other => {
                    let meant = nearest(other, known_options())
                        .map_or_else(String::new, |name| format!(": did you mean `{name}`?"));
                    return Err(format!("unknown option `{other}`{meant}\n\n{OPTIONS}"));
                }
            }
        }
        if let Some(instances) = instances {
            options.ensemble = Some(ensemble::Plan { instances, threads, spread, summary });
        } else if threads.is_some() || !spread.is_empty() || summary.is_some() {
            return Err("`--threads`, `--spread` and `--summary` need `--instances N`".into());
        }
        Ok(options)
    }
}

fn number(name: &str, text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| format!("`{name}` needs a number, not `{text}`"))
}

/// The names in the lines of [`OPTIONS`].
fn known_options() -> impl Iterator<Item = &'static str> {
    OPTIONS.split_whitespace().filter(|word| word.starts_with("--"))
}

fn count(name: &str, text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(value) if value > 0 => Ok(value),
        _ => Err(format!("`{name}` needs a positive whole number, not `{text}`")),
    }
}

/// Reads `PARAM=VALUE`; the value is a finite number.
pub fn assignment(text: &str) -> Result<(String, f64), String> {
    let (name, value) =
        text.split_once('=').ok_or_else(|| format!("`--set` needs PARAM=VALUE, not `{text}`"))?;
    let value = value.trim();
    match number("--set", value)? {
        number if number.is_finite() => Ok((name.trim().to_string(), number)),
        _ => Err(format!("`--set` needs a finite number, not `{value}`")),
    }
}

/// What a caller may watch and stop.
pub trait Observer {
    /// Called after every step or some of them with steps taken and steps in all; `false` ends the run cleanly.
    fn advanced(&mut self, step: usize, steps: usize) -> bool;
    /// A message for the user.
    fn note(&mut self, text: &str) {
        eprintln!("{text}");
    }
}

/// Nobody watches.
#[derive(Debug)]
pub struct Unwatched;

impl Observer for Unwatched {
    fn advanced(&mut self, _step: usize, _steps: usize) -> bool {
        true
    }
}

/// Runs a scenario and reports on standard error. Whatever was computed is on disk when this
/// returns, with an error too.
pub fn run<M: Model + Clone + Send + Sync>(
    model: M,
    options: &RunOptions,
    observer: &mut impl Observer,
) -> Result<(), RunError> {
    if let Some(plan) = &options.ensemble {
        return ensemble::run(&model, options, plan, observer);
    }
    let mut simulation = Simulation::new(model, &options.settings)?;
    if simulation.start_moved > 1e-6 {
        observer.note(&format!(
            "note: the start was moved onto the constraints by up to {:.3e} (rad or m)",
            simulation.start_moved
        ));
    }
    let mut trajectory = match &options.out {
        Some(path) => Some(Trajectory::create(path, &simulation)?),
        None => None,
    };
    if let Some(trajectory) = &mut trajectory {
        trajectory.record(&mut simulation)?;
    }
    let steps = simulation.steps;
    if steps == 0 {
        observer.note("note: the duration is shorter than a step: none is taken");
    }
    let mut wall = std::time::Duration::ZERO;
    let mut outcome = Ok(());
    let mut since = Instant::now();
    let mut step = 0;
    while step < steps {
        // To the next row.
        let stretch = options.every - step % options.every;
        let stretch = if trajectory.is_some() { stretch } else { steps };
        match simulation.advance(stretch.min(steps - step)) {
            Ok(taken) => step += taken,
            Err(error) => {
                outcome = Err(error);
                break;
            }
        }
        if let Some(trajectory) = &mut trajectory
            && step % options.every == 0
        {
            wall += since.elapsed();
            outcome = trajectory.record(&mut simulation);
            since = Instant::now();
            if outcome.is_err() {
                break;
            }
        }
        if !observer.advanced(step, steps) {
            observer.note(&format!("stopped at t = {} s", simulation.state.t));
            break;
        }
    }
    wall += since.elapsed();
    if let Some(trajectory) = &mut trajectory {
        trajectory.flush()?;
    }
    if let Err(error @ RunError::Step(_)) = &outcome {
        observer.note(&format!("error: {error}"));
    }
    // The line with the figures ends every run, a failed one too.
    let taken = simulation.state.step;
    observer.note(&summary(taken, wall.as_secs_f64(), simulation.iterations()));
    outcome
}

/// The line that ends every run.
pub fn summary(steps: usize, wall: f64, iterations: usize) -> String {
    let each = steps.max(1) as f64;
    format!(
        "steps {steps}  wall {wall:.4} s  us/step {:.2}  newton/step {:.2}",
        wall * 1e6 / each,
        iterations as f64 / each
    )
}

/// The main function of a generated crate's runner: reads the command line, runs, and returns the
/// exit code: 0 done, 2 the command line is wrong, 3 the run failed.
pub fn main<M: Model + Clone + Send + Sync>(model: M) -> i32 {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments.iter().any(|a| a == "--help" || a == "-h") {
        println!("Runs the model `{}`.\n\nOptions:\n{OPTIONS}", model.layout().name);
        return 0;
    }
    let options = match RunOptions::parse(arguments.into_iter()) {
        Ok(options) => options,
        Err(message) => {
            eprintln!("error: {message}");
            return 2;
        }
    };
    match run(model, &options, &mut Unwatched) {
        Ok(()) => 0,
        Err(error) => {
            if !error.is_reported() {
                eprintln!("error: {error}");
            }
            error.exit_code()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<RunOptions, String> {
        RunOptions::parse(text.split_whitespace().map(str::to_string))
    }

    #[test]
    fn options_are_read() {
        let options = parse("--every 5 --set k=1e3 --set=c=-2 --step=1e-3 --out a.csv");
        let options = options.expect("right options");
        assert_eq!(options.every, 5);
        assert_eq!(options.settings.set, [("k".to_string(), 1e3), ("c".to_string(), -2.0)]);
        assert_eq!(options.settings.step, Some(1e-3));
        assert_eq!(options.out, Some(PathBuf::from("a.csv")));
    }

    #[test]
    fn wrong_options_are_told() {
        for (text, hint) in [
            ("--every 0", "positive whole number"),
            ("--every 2 --every 3", "`--every` is given twice"),
            ("--evry 2", "did you mean `--every`?"),
            ("more", "unknown option `more`"),
            ("--set k", "PARAM=VALUE"),
            ("--set k=nan", "finite"),
            ("--set k=1e999", "finite"),
            ("--step x", "needs a number"),
            ("--out", "needs a value"),
            ("--threads 2", "need `--instances N`"),
            ("--instances 2 --spread k=1:inf", "`--spread` needs"),
        ] {
            let said = parse(text).expect_err(text);
            assert!(said.contains(hint), "{text}: {said}");
        }
    }
}
