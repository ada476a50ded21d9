//! `handc export`: the model for another program.

use crate::mjcf;
use handc_core::simulation::Settings;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What to write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// MuJoCo's XML.
    Mjcf,
}

/// Options of an export.
#[derive(Clone, Debug)]
pub struct ExportOptions {
    /// Model file.
    pub file: PathBuf,
    /// Folder that imports may not leave.
    pub root: Option<PathBuf>,
    /// The format.
    pub format: Format,
    /// Where to write; `None` is standard output.
    pub out: Option<PathBuf>,
    /// Scenario, parameters and step.
    pub settings: Settings,
}

/// Writes a model in another format; what the format cannot say goes to standard error.
pub fn export(options: &ExportOptions) -> u8 {
    let mechanism = match super::mechanism(&options.file, options.root.as_deref()) {
        Ok((_, mechanism)) => Arc::new(mechanism),
        Err(code) => return code,
    };
    let made = match options.format {
        Format::Mjcf => mjcf::export(&mechanism, &options.settings),
    };
    let made = match made {
        Ok(made) => made,
        Err(error) => {
            eprintln!("error: {error}");
            return error.exit_code() as u8;
        }
    };
    for note in &made.notes {
        eprintln!("note: {note}");
    }
    for warning in &made.warnings {
        eprintln!("warning: {warning}");
    }
    match &options.out {
        Some(path) => write(path, &made.text),
        None => {
            super::print(&made.text);
            0
        }
    }
}

fn write(path: &Path, text: &str) -> u8 {
    match std::fs::write(path, text) {
        Ok(()) => 0,
        Err(error) => {
            eprintln!("error: cannot write `{}`: {error}", path.display());
            3
        }
    }
}
