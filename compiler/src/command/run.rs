//! `handc run`: the interpreter, with a progress bar on a terminal and a clean end on Ctrl-C.

use handc_core::runner::{self, Observer, RunOptions};
use handc_runtime::interpreter::Interpreter;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Steps between looks at the clock and the keyboard.
const GLANCE: usize = 256;

struct Watcher {
    bar: Option<ProgressBar>,
    stop: Arc<AtomicBool>,
}

impl Observer for Watcher {
    fn advanced(&mut self, step: usize, steps: usize) -> bool {
        if step.is_multiple_of(GLANCE) || step == steps {
            if let Some(bar) = &self.bar {
                bar.set_length(steps as u64);
                bar.set_position(step as u64);
            }
            return step == steps || !self.stop.load(Ordering::Relaxed);
        }
        true
    }
    fn note(&mut self, text: &str) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
        eprintln!("{text}");
    }
}

/// Simulates a model file.
pub fn run(file: &Path, root: Option<&Path>, options: &RunOptions) -> u8 {
    let (_, mechanism) = match super::mechanism(file, root) {
        Ok(found) => found,
        Err(code) => return code,
    };
    let stop = Arc::new(AtomicBool::new(false));
    let seen = Arc::clone(&stop);
    // Without a handler Ctrl-C still ends the run, only less gently.
    let _ = ctrlc::set_handler(move || {
        if seen.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    });
    let bar = std::io::stderr().is_terminal().then(|| {
        let style = ProgressStyle::with_template("{bar:40} {percent}%  {eta}");
        ProgressBar::new(1).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
    });
    let mut watcher = Watcher { bar, stop };
    match runner::run(Interpreter::new(Arc::new(mechanism)), options, &mut watcher) {
        Ok(()) => 0,
        Err(error) => {
            if !error.is_reported() {
                watcher.note(&format!("error: {error}"));
            }
            error.exit_code() as u8
        }
    }
}
