//! Many copies of one run, spread over parameters and starts, on threads.

mod results;
mod spread;

use crate::error::RunError;
use crate::lanes::RUNS;
use crate::model::Model;
use crate::runner::{Observer, RunOptions, summary};
use crate::simulation::{Settings, Simulation, find_param};
use crate::together::Together;
use crate::trajectory::{columns, row};
use results::{One, Results};
use spread::Random;
pub use spread::Spread;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// An ensemble.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Copies.
    pub instances: usize,
    /// Threads; `None`: all cores.
    pub threads: Option<usize>,
    /// How copies differ.
    pub spread: Vec<Spread>,
}

impl Plan {
    /// Settings of one copy.
    fn settings(&self, base: &Settings, coordinates: usize, instance: usize) -> Settings {
        let mut settings = base.clone();
        let place = match self.instances {
            1 => 0.0,
            many => instance as f64 / (many - 1) as f64,
        };
        for spread in &self.spread {
            match spread {
                Spread::Param { name, low, high } => {
                    settings.set.push((name.clone(), low + (high - low) * place));
                }
                Spread::Start { sigma } => {
                    let mut random = Random::new(instance as u64);
                    settings.start_offset =
                        (0..coordinates).map(|_| sigma * random.normal()).collect();
                }
            }
        }
        settings
    }
}

/// Runs every copy to its end; a copy that fails is reported by number and stops no other. With an
/// output file, one row per copy: its number, steps taken, then the last row of its trajectory. Rows
/// are written in order as copies end, so that what was computed is on disk if the rest is not.
pub(crate) fn run<M: Model + Clone + Send + Sync>(
    model: &M,
    options: &RunOptions,
    plan: &Plan,
    observer: &mut impl Observer,
) -> Result<(), RunError> {
    let layout = model.layout();
    for spread in &plan.spread {
        if let Spread::Param { name, .. } = spread {
            find_param(layout, name)?;
        }
    }
    let coordinates = layout.coordinates.len();
    // Options that fit no copy are an error of the command line, said once.
    let first = Simulation::new(model.clone(), &plan.settings(&options.settings, coordinates, 0));
    let header = match first {
        Ok(simulation) => columns(&simulation),
        Err(error @ RunError::Usage(_)) => return Err(error),
        Err(_) => Vec::new(),
    };
    let available = std::thread::available_parallelism().map_or(1, |n| n.get());
    let threads = plan.threads.unwrap_or(available).min(plan.instances);
    let next = AtomicUsize::new(0);
    let results = Mutex::new(Results::new(options.out.as_deref(), &header)?);
    let began = Instant::now();
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let first = next.fetch_add(RUNS, Ordering::Relaxed);
                    if first >= plan.instances {
                        break;
                    }
                    let settings = (first..plan.instances.min(first + RUNS))
                        .map(|i| plan.settings(&options.settings, coordinates, i));
                    let outcomes = run_some(model, settings);
                    if let Ok(mut results) = results.lock() {
                        results.take((first..).zip(outcomes));
                    }
                }
            });
        }
    });
    let wall = began.elapsed().as_secs_f64();
    let results = results.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
    results.failed.iter().for_each(|line| observer.note(line));
    observer.note(&summary(results.steps, wall, results.iterations));
    if let Some(error) = results.lost {
        return Err(error);
    }
    match results.failed.len() {
        0 => Ok(()),
        failed => Err(RunError::Start(format!("{failed} of {} instances failed", plan.instances))),
    }
}

/// Runs up to [`RUNS`] copies to their ends.
fn run_some<M: Model + Clone>(model: &M, settings: impl Iterator<Item = Settings>) -> Vec<One> {
    // What comes of every copy; of those that have started, when they have ended.
    let mut ends = Vec::new();
    let mut started = Vec::new();
    for settings in settings {
        match Simulation::new(model.clone(), &settings) {
            Ok(run) => {
                ends.push(One::default());
                started.push((ends.len() - 1, run));
            }
            Err(error) => ends.push(One { error: Some(error), ..One::default() }),
        }
    }
    let (numbers, runs): (Vec<usize>, Vec<Simulation<M>>) = started.into_iter().unzip();
    let mut together = Together::new(runs);
    while !together.is_over() {
        together.step(|run, error| ends[numbers[run]].error = Some(error));
    }
    for (number, mut run) in numbers.into_iter().zip(together.into_runs()) {
        let one = &mut ends[number];
        row(&mut run, &mut one.last);
        (one.steps, one.iterations) = (run.state.step, run.iterations());
    }
    ends
}
