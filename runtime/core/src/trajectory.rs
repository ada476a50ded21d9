//! The result file: CSV, one row per instant, numbers with 17 significant digits.
//!
//! Rows go to disk whole, so that a file cut off at any moment holds valid rows only.

use crate::error::RunError;
use crate::model::Model;
use crate::simulation::Simulation;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Bytes collected before they are written.
const CHUNK: usize = 1 << 16;

/// Writes a run to a CSV file.
#[derive(Debug)]
pub struct Trajectory {
    file: File,
    path: PathBuf,
    buffer: String,
    row: Vec<f64>,
    records: usize,
}

/// Column names of a run, in order.
pub fn columns<M: Model>(simulation: &Simulation<M>) -> Vec<String> {
    let layout = simulation.layout();
    let mut names = vec!["t".to_string()];
    names.extend(layout.coordinates.iter().map(|c| c.name.clone()));
    for (coordinate, driven) in layout.coordinates.iter().zip(simulation.driven()) {
        if !driven {
            names.push(format!("p.{}", coordinate.name));
        }
    }
    names.extend(layout.rows.iter().map(|r| format!("lambda.{}", r.name)));
    names.push("energy".to_string());
    if let Some(scenario) = simulation.scenario() {
        names.extend(layout.scenarios[scenario].records.iter().cloned());
    }
    names
}

/// The numbers of the current row, in the order of [`columns`].
pub fn row<M: Model>(simulation: &mut Simulation<M>, row: &mut Vec<f64>) {
    row.clear();
    row.push(simulation.state.t);
    row.extend_from_slice(simulation.coordinates());
    for (i, &driven) in simulation.driven().iter().enumerate() {
        if !driven {
            row.push(simulation.state.p[i]);
        }
    }
    row.extend_from_slice(&simulation.state.lambda);
    row.push(simulation.energy());
    let records = match simulation.scenario() {
        Some(scenario) => simulation.layout().scenarios[scenario].records.len(),
        None => 0,
    };
    let first = row.len();
    row.resize(first + records, 0.0);
    simulation.records(&mut row[first..]);
}

impl Trajectory {
    /// Creates the file and writes the header.
    pub fn create<M: Model>(path: &Path, simulation: &Simulation<M>) -> Result<Self, RunError> {
        let fail = |error| RunError::Io(format!("cannot write `{}`: {error}", path.display()));
        let file = File::create(path).map_err(fail)?;
        let mut trajectory = Trajectory {
            file,
            path: path.to_path_buf(),
            buffer: String::with_capacity(2 * CHUNK),
            row: Vec::new(),
            records: 0,
        };
        trajectory.buffer.push_str(&columns(simulation).join(","));
        trajectory.buffer.push('\n');
        Ok(trajectory)
    }

    /// Adds the current row.
    pub fn record<M: Model>(&mut self, simulation: &mut Simulation<M>) -> Result<(), RunError> {
        let mut numbers = std::mem::take(&mut self.row);
        row(simulation, &mut numbers);
        if numbers.iter().any(|number| number.is_nan()) {
            // A step sees the middle of its way; its end may lie where a strand cannot pass.
            simulation.passable()?;
        }
        for (i, number) in numbers.iter().enumerate() {
            if i > 0 {
                self.buffer.push(',');
            }
            push_number(&mut self.buffer, *number);
        }
        self.row = numbers;
        self.buffer.push('\n');
        self.records += 1;
        if self.buffer.len() > CHUNK { self.flush() } else { Ok(()) }
    }

    /// Rows recorded so far.
    pub fn rows(&self) -> usize {
        self.records
    }

    /// Writes what is collected.
    pub fn flush(&mut self) -> Result<(), RunError> {
        let written = self.file.write_all(self.buffer.as_bytes());
        self.buffer.clear();
        written.map_err(|error| {
            RunError::Io(format!("cannot write `{}`: {error}", self.path.display()))
        })
    }
}

/// A number with 17 significant digits; integers of few digits stay short.
pub fn push_number(text: &mut String, number: f64) {
    use std::fmt::Write;
    if number == 0.0 {
        text.push('0');
    } else {
        // Writing to a string cannot fail.
        let _ = write!(text, "{number:.16e}");
    }
}
