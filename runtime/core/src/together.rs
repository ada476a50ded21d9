//! Several runs of one model that step together, each in lanes of its own.

use crate::error::RunError;
use crate::lanes::{Around, Lanes, Outcome, RUNS, Told};
use crate::model::Model;
use crate::simulation::Simulation;

/// Runs that step together until each has come to its end or failed. While they step, their
/// coordinates and momenta stay on the lanes; they are written back when someone asks for the runs.
#[derive(Clone, Debug)]
pub struct Together<M> {
    runs: Vec<Simulation<M>>,
    /// The runs that go on, in order.
    active: Vec<usize>,
    lanes: Lanes,
    /// Whether the lanes hold the states of the active runs, and whether the runs do.
    is_held: bool,
    is_written: bool,
}

impl<M: Model> Together<M> {
    /// Runs of any number and scenario; those of one scenario, up to [`RUNS`], can share lanes.
    pub fn new(mut runs: Vec<Simulation<M>>) -> Self {
        Together {
            lanes: runs.first_mut().map(Simulation::fresh_lanes).unwrap_or_default(),
            active: (0..runs.len()).collect(),
            runs,
            is_held: false,
            is_written: true,
        }
    }

    /// Whether no run goes on.
    pub fn is_over(&self) -> bool {
        self.active.iter().all(|&number| self.runs[number].is_over())
    }

    /// Steps that the runs which go on have taken.
    pub fn furthest(&self) -> usize {
        self.runs.iter().map(|run| run.state.step).max().unwrap_or(0)
    }

    /// The runs at their states. What is changed in them counts in the next step.
    pub fn runs(&mut self) -> &mut [Simulation<M>] {
        self.write();
        self.is_held = false;
        &mut self.runs
    }

    /// The runs at their states, and no more steps.
    pub fn into_runs(mut self) -> Vec<Simulation<M>> {
        self.write();
        self.runs
    }

    /// Takes one step of every run that goes on. Tells `fails` the number of a run that could not; it
    /// is left as it was and does not go on.
    pub fn step(&mut self, fails: impl FnMut(usize, RunError)) {
        self.advance(1, fails);
    }

    /// Takes up to `steps` steps, at least one, of every run that goes on, as many as go without a look
    /// at the states. Tells `fails` as [`Together::step`].
    pub fn advance(&mut self, steps: usize, mut fails: impl FnMut(usize, RunError)) {
        if self.active.iter().any(|&number| self.runs[number].is_over()) {
            self.write();
            self.is_held = false;
            self.active.retain(|&number| !self.runs[number].is_over());
        }
        let bits = if self.may_use_lanes() { self.steps_on_lanes(steps) } else { u8::MAX };
        if bits == 0 {
            return;
        }
        self.write();
        self.is_held = false;
        let (runs, mut lane) = (&mut self.runs, 0..);
        self.active.retain(|&number| {
            let has_stepped = lane.next().is_some_and(|lane| lane < RUNS && bits >> lane & 1 == 0);
            if has_stepped {
                return true;
            }
            match runs[number].step_by_numbers() {
                Ok(()) => true,
                Err(error) => {
                    fails(number, error);
                    false
                }
            }
        });
    }

    fn may_use_lanes(&self) -> bool {
        let Some(&first) = self.active.first() else { return false };
        let alike = |run: &Simulation<M>| (run.scenario(), run.state.step);
        let first = alike(&self.runs[first]);
        let may = |run: &Simulation<M>| run.may_use_lanes() && alike(run) == first;
        self.active.len() <= RUNS && self.active.iter().all(|&number| may(&self.runs[number]))
    }

    /// Steps all active runs on lanes; returns those that could not, as bits by their place among
    /// the active ones.
    fn steps_on_lanes(&mut self, mut count: usize) -> u8 {
        let Together { runs, active, lanes, .. } = self;
        count = lanes.reach(count);
        for &number in active.iter() {
            count = count.min(runs[number].left());
        }
        for &number in active.iter() {
            count = count.min(runs[number].look_ahead(count));
        }
        if count == 0 {
            return u8::MAX;
        }
        let first = &runs[active[0]];
        let mut models = [&first.model; RUNS];
        let mut around = [Around::NOTHING; RUNS];
        let mut courses = [first.courses(); RUNS];
        let mut told = [Told::NOTHING; RUNS];
        for (lane, &number) in active.iter().enumerate() {
            let run = &runs[number];
            models[lane] = &run.model;
            around[lane] = run.around_on_lanes();
            courses[lane] = run.courses();
            told[lane] = run.told().unwrap_or(Told::NOTHING);
        }
        let models = &models[..active.len()];
        if !lanes.arrange(models) || !self.is_held {
            let taken_up: Vec<_> = active.iter().map(|&number| runs[number].taken_up()).collect();
            lanes.take_up(&taken_up);
        }
        lanes.begin(&around);
        lanes.tell(&told[..active.len()]);
        let (taken, bits) = match lanes.step(models, &courses, count) {
            Outcome::Stepped(taken) => (taken, 0),
            Outcome::Failed(bits) => (1, bits),
            Outcome::Unavailable => {
                active.iter().for_each(|&number| runs[number].leave_lanes());
                return u8::MAX;
            }
        };
        (self.is_held, self.is_written) = (true, false);
        for (lane, &number) in active.iter().enumerate() {
            match bits >> lane & 1 {
                0 => runs[number].pass_on_lanes(taken, lanes.iterations(lane)),
                _ => runs[number].pause_lanes(),
            }
        }
        bits
    }

    /// Writes the states back from the lanes.
    fn write(&mut self) {
        if !std::mem::replace(&mut self.is_written, true) {
            for (lane, &number) in self.active.iter().enumerate() {
                self.runs[number].write_back(&self.lanes, lane);
            }
        }
    }
}
