//! Results of an ensemble: a row for each copy, on disk as soon as its turn has come.

use super::Ended;
use crate::error::RunError;
use crate::model::Model;
use crate::trajectory::{push_number, row};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

/// One copy that has ended.
#[derive(Debug, Default)]
pub(super) struct One {
    pub(super) steps: usize,
    pub(super) iterations: usize,
    /// Last row.
    pub(super) last: Vec<f64>,
    pub(super) error: Option<RunError>,
}

impl<M: Model> From<Ended<M>> for One {
    fn from(ended: Ended<M>) -> One {
        let mut one = One { error: ended.error, ..One::default() };
        if let Some(mut run) = ended.run {
            row(&mut run, &mut one.last);
            (one.steps, one.iterations) = (run.state.step, run.iterations());
        }
        one
    }
}

/// What has come of the copies so far.
pub(super) struct Results {
    file: Option<(PathBuf, File)>,
    /// Copies that ended before an earlier one.
    waiting: BTreeMap<usize, One>,
    /// The next row's copy.
    next: usize,
    /// Steps of all copies.
    pub(super) steps: usize,
    /// Newton iterations of all copies.
    pub(super) iterations: usize,
    /// What is said of copies that failed.
    pub(super) failed: Vec<String>,
    /// Why rows could not be written.
    pub(super) lost: Option<RunError>,
}

impl Results {
    /// With the header written.
    pub(super) fn new(path: Option<&Path>, header: &[String]) -> Result<Self, RunError> {
        let mut results = Results {
            file: None,
            waiting: BTreeMap::new(),
            next: 0,
            steps: 0,
            iterations: 0,
            failed: Vec::new(),
            lost: None,
        };
        if let Some(path) = path {
            let file = File::create(path).map_err(|error| unwritten(path, &error))?;
            results.file = Some((path.to_path_buf(), file));
            results.write(&format!("instance,steps,{}\n", header.join(",")));
        }
        results.lost.take().map_or(Ok(results), Err)
    }

    /// Takes a copy that has ended, and writes the rows whose turn it is.
    pub(super) fn take(&mut self, copy: usize, one: One) {
        self.waiting.insert(copy, one);
        let mut text = String::new();
        while let Some(one) = self.waiting.remove(&self.next) {
            self.steps += one.steps;
            self.iterations += one.iterations;
            text.push_str(&format!("{},{}", self.next, one.steps));
            for number in one.last {
                text.push(',');
                push_number(&mut text, number);
            }
            text.push('\n');
            if let Some(error) = one.error {
                self.failed.push(format!("instance {}: {error}", self.next));
            }
            self.next += 1;
        }
        self.write(&text);
    }

    fn write(&mut self, text: &str) {
        if let (Some((path, file)), None) = (&mut self.file, &self.lost)
            && let Err(error) = file.write_all(text.as_bytes())
        {
            self.lost = Some(unwritten(path, &error));
        }
    }
}

fn unwritten(path: &Path, error: &std::io::Error) -> RunError {
    RunError::Io(format!("cannot write `{}`: {error}", path.display()))
}
