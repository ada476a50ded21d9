//! Why a run failed, in the model's own names.

use std::fmt;

/// A step that could not be taken. The state before it is untouched.
#[derive(Clone, Debug, PartialEq)]
pub struct StepError {
    /// What went wrong.
    pub kind: StepErrorKind,
    /// Time at the start of the step (s).
    pub t: f64,
    /// Number of the step, from 1.
    pub step: usize,
    /// Name of the coordinate or constraint row whose equation is worst.
    pub equation: String,
    /// Its residual: an impulse (N·s or N·m·s) for a coordinate, a gap for a constraint.
    pub residual: f64,
    /// A lower bound of the condition number of the last Newton matrix.
    pub condition: f64,
    /// Newton iterations spent, over all guesses.
    pub iterations: usize,
    /// Which strand cannot do what it is to and why, if that is what went wrong; else empty.
    pub blocked: String,
    /// What to try.
    pub hints: Vec<String>,
}

/// The ways a step can fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepErrorKind {
    /// Newton's method found no solution from any guess.
    NoConvergence,
    /// The Newton matrix is singular.
    Singular,
    /// The equations gave a value that is not finite at the state itself.
    NotFinite,
    /// A strand cannot pass its surface, or a muscle is told what it cannot do.
    Blocked,
}

impl fmt::Display for StepError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let what = match self.kind {
            StepErrorKind::NoConvergence => "the step did not converge",
            StepErrorKind::Singular => "the step's equations are singular",
            StepErrorKind::NotFinite => "the step's equations are not finite",
            StepErrorKind::Blocked => &self.blocked,
        };
        let (t, step) = (rounded(self.t), self.step);
        if self.kind == StepErrorKind::Blocked {
            write!(f, "at t = {t} s (step {step}) {what}")?;
        } else {
            let StepError { equation, residual, condition, iterations, .. } = self;
            write!(
                f,
                "{what} at t = {t} s (step {step}): worst equation `{equation}`, residual \
                 {residual:.3e}, condition at least {condition:.1e}, {iterations} Newton iterations"
            )?;
        }
        for hint in &self.hints {
            write!(f, "\n  try: {hint}")?;
        }
        Ok(())
    }
}

impl std::error::Error for StepError {}

/// A time without the rounding of sums and products.
fn rounded(t: f64) -> f64 {
    (t * 1e12).round() / 1e12
}

/// Why a run ended early or could not begin.
#[derive(Debug)]
pub enum RunError {
    /// The command line or the options do not fit the model (exit code 2).
    Usage(String),
    /// The start cannot be put on the constraints, or is not finite (exit code 3).
    Start(String),
    /// A step failed (exit code 3).
    Step(StepError),
    /// A file could not be written (exit code 3).
    Io(String),
}

impl RunError {
    /// Whether [`crate::runner::run`] has already told the user.
    pub fn is_reported(&self) -> bool {
        matches!(self, RunError::Step(_))
    }
    /// The process's exit code.
    pub fn exit_code(&self) -> i32 {
        match self {
            RunError::Usage(_) => 2,
            _ => 3,
        }
    }
}

impl fmt::Display for RunError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            RunError::Usage(text) | RunError::Start(text) | RunError::Io(text) => f.write_str(text),
            RunError::Step(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for RunError {}

impl From<StepError> for RunError {
    fn from(error: StepError) -> Self {
        RunError::Step(error)
    }
}
