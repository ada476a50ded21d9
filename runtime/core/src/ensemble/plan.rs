//! An ensemble as the command line asks for it: copies that are spread over parameters and starts.

use super::Ensemble;
use super::results::Results;
use super::spread::{Random, Spread};
use super::summary::Summary;
use crate::error::RunError;
use crate::model::Model;
use crate::runner::{Observer, RunOptions, summary};
use crate::simulation::{Settings, Simulation, find_param};
use crate::trajectory::{columns, row};
use std::path::PathBuf;
use std::sync::Mutex;
use std::time::Instant;

/// What is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Copies.
    pub instances: usize,
    /// Threads; `None`: all cores.
    pub threads: Option<usize>,
    /// How copies differ.
    pub spread: Vec<Spread>,
    /// Where mean, deviation and quantiles over the copies go, a row for every instant.
    pub summary: Option<PathBuf>,
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
    let settings = |copy| plan.settings(&options.settings, coordinates, copy);
    // Columns are those of the first copy that starts. Options that fit no copy are an error of the
    // command line, said once.
    let (mut header, mut rows) = (vec!["t".to_string()], 0);
    for copy in 0..plan.instances {
        match Simulation::new(model.clone(), &settings(copy)) {
            Ok(simulation) => {
                (header, rows) = (columns(&simulation), simulation.steps / options.every + 1);
                break;
            }
            Err(error @ RunError::Usage(_)) => return Err(error),
            Err(_) => {}
        }
    }
    let table = match &plan.summary {
        Some(_) => Some(Mutex::new(Summary::new(&header, rows, plan.instances)?)),
        None => None,
    };
    let results = Mutex::new(Results::new(options.out.as_deref(), &header)?);
    let mut ensemble = Ensemble::new(model);
    if let Some(threads) = plan.threads {
        ensemble = ensemble.threads(threads);
    }
    if table.is_some() {
        ensemble = ensemble.every(options.every);
    }
    let began = Instant::now();
    ensemble.run(
        plan.instances,
        settings,
        |copy, run| {
            let mut numbers = Vec::new();
            row(run, &mut numbers);
            if let Some(Ok(mut table)) = table.as_ref().map(Mutex::lock) {
                table.take(copy, &numbers);
            }
        },
        |copy, ended| {
            if let Ok(mut results) = results.lock() {
                results.take(copy, ended.into());
            }
        },
    );
    let wall = began.elapsed().as_secs_f64();
    let results = results.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
    results.failed.iter().for_each(|line| observer.note(line));
    observer.note(&summary(results.steps, wall, results.iterations));
    if let (Some(path), Some(Ok(table))) = (&plan.summary, table.map(Mutex::into_inner)) {
        table.write(path)?;
    }
    if let Some(error) = results.lost {
        return Err(error);
    }
    match results.failed.len() {
        0 => Ok(()),
        failed => Err(RunError::Start(format!("{failed} of {} instances failed", plan.instances))),
    }
}
