//! Many copies of one run, spread over parameters and starts, on threads.

use crate::error::RunError;
use crate::lanes::RUNS;
use crate::model::Model;
use crate::runner::{Observer, RunOptions, summary};
use crate::simulation::{Settings, Simulation, find_param};
use crate::together::Together;
use crate::trajectory::{columns, push_number, row};
use std::io::Write;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// How copies differ.
#[derive(Clone, Debug, PartialEq)]
pub enum Spread {
    /// A parameter, evenly from low in the first copy to high in the last.
    Param {
        /// Name.
        name: String,
        /// Value in the first copy.
        low: f64,
        /// Value in the last copy.
        high: f64,
    },
    /// Every coordinate's start, normally distributed.
    Start {
        /// Standard deviation (rad or m).
        sigma: f64,
    },
}

impl Spread {
    /// Reads `PARAM=LO:HI` or `start=SIGMA`.
    pub fn parse(text: &str) -> Result<Self, String> {
        let wrong = || format!("`--spread` needs PARAM=LO:HI or start=SIGMA, not `{text}`");
        let (name, value) = text.split_once('=').ok_or_else(wrong)?;
        let number =
            |text: &str| text.trim().parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(wrong);
        match value.split_once(':') {
            Some((low, high)) => Ok(Spread::Param {
                name: name.trim().to_string(),
                low: number(low)?,
                high: number(high)?,
            }),
            None if name.trim() == "start" => Ok(Spread::Start { sigma: number(value)? }),
            None => Err(wrong()),
        }
    }
}

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
/// output file, one row per copy: its number, steps taken, then the last row of its trajectory.
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
    let done = Mutex::new(Vec::new());
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
                    if let Ok(mut done) = done.lock() {
                        done.extend((first..).zip(outcomes));
                    }
                }
            });
        }
    });
    let wall = began.elapsed().as_secs_f64();
    let mut done = done.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
    done.sort_by_key(|(instance, _)| *instance);
    let mut text = format!("instance,steps,{}\n", header.join(","));
    let (mut steps, mut iterations, mut failed) = (0, 0, Vec::new());
    for (instance, one) in done {
        steps += one.steps;
        iterations += one.iterations;
        text.push_str(&format!("{instance},{}", one.steps));
        for number in one.last {
            text.push(',');
            push_number(&mut text, number);
        }
        text.push('\n');
        if let Some(error) = one.error {
            failed.push(format!("instance {instance}: {error}"));
        }
    }
    if let Some(path) = &options.out {
        std::fs::File::create(path)
            .and_then(|mut file| file.write_all(text.as_bytes()))
            .map_err(|e| RunError::Io(format!("cannot write `{}`: {e}", path.display())))?;
    }
    failed.iter().for_each(|line| observer.note(line));
    observer.note(&summary(steps, wall, iterations));
    if failed.is_empty() {
        Ok(())
    } else {
        Err(RunError::Start(format!("{} of {} instances failed", failed.len(), plan.instances)))
    }
}

struct One {
    steps: usize,
    iterations: usize,
    last: Vec<f64>,
    error: Option<RunError>,
}

/// Runs up to [`RUNS`] copies to their ends, together as long as none has failed.
fn run_some<M: Model + Clone>(model: &M, settings: impl Iterator<Item = Settings>) -> Vec<One> {
    let mut started: Vec<_> = settings.map(|s| Simulation::new(model.clone(), &s)).collect();
    let mut errors: Vec<Option<RunError>> = started.iter().map(|_| None).collect();
    if started.len() == RUNS && started.iter().all(Result::is_ok) {
        let runs: Vec<Simulation<M>> = started.drain(..).flatten().collect();
        match <[_; RUNS]>::try_from(runs) {
            Ok(mut runs) => {
                together(&mut runs, &mut errors);
                started.extend(runs.map(Ok));
            }
            Err(runs) => started.extend(runs.into_iter().map(Ok)),
        }
    }
    started.into_iter().zip(errors).map(|(run, error)| to_the_end(run, error)).collect()
}

/// Steps all runs until one of them fails.
fn together<M: Model>(runs: &mut [Simulation<M>; RUNS], errors: &mut [Option<RunError>]) {
    let mut together = Together::new(&mut runs[0]);
    let steps = runs.each_ref().map(|run| run.steps).into_iter().min().unwrap_or(0);
    for _ in 0..steps {
        for (outcome, error) in together.step(runs).into_iter().zip(errors.iter_mut()) {
            *error = outcome.err();
        }
        if errors.iter().any(Option::is_some) {
            return;
        }
    }
}

/// Goes on with a copy until it ends or fails.
fn to_the_end<M: Model>(run: Result<Simulation<M>, RunError>, mut error: Option<RunError>) -> One {
    let mut simulation = match run {
        Ok(simulation) => simulation,
        Err(error) => {
            return One { steps: 0, iterations: 0, last: Vec::new(), error: Some(error) };
        }
    };
    while error.is_none() && simulation.state.step < simulation.steps {
        error = simulation.step().err();
    }
    let mut last = Vec::new();
    row(&mut simulation, &mut last);
    One { steps: simulation.state.step, iterations: simulation.iterations(), last, error }
}

/// A small generator of fixed seed (splitmix64), so that an ensemble repeats.
struct Random(u64);

impl Random {
    fn new(seed: u64) -> Self {
        Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x6a09_e667_f3bc_c909)
    }
    /// Uniform in (0, 1).
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64 + f64::EPSILON * 0.25
    }
    /// Standard normal (Box and Muller).
    fn normal(&mut self) -> f64 {
        let (u, v) = (self.uniform(), self.uniform());
        (-2.0 * u.ln()).sqrt() * (2.0 * std::f64::consts::PI * v).cos()
    }
}
