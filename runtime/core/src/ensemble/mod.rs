//! Many runs of one model: on the lanes of vectors within a thread, and on threads beside each other.

mod plan;
mod results;
mod spread;
mod summary;

use crate::error::RunError;
use crate::lanes::RUNS;
use crate::model::Model;
use crate::simulation::{Settings, Simulation};
use crate::together::Together;
pub use plan::Plan;
pub(crate) use plan::run;
pub use spread::Spread;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Runs of one model that differ by their settings: parameters, start, inputs, scenario, step.
///
/// ```
/// # use handc_core::ensemble::Ensemble;
/// # use handc_core::model::Model;
/// # use handc_core::simulation::Settings;
/// # use std::sync::Mutex;
/// # fn show<M: Model + Clone + Send + Sync>(hand: &M) {
/// let energies = Mutex::new(vec![f64::NAN; 1000]);
/// Ensemble::new(hand).run(
///     1000,
///     |i| Settings { set: vec![("k".into(), 200.0 + i as f64)], ..Settings::default() },
///     |_, _| {},
///     |i, mut ended| {
///         if let (Some(run), None) = (&mut ended.run, &ended.error) {
///             energies.lock().unwrap()[i] = run.energy();
///         }
///     },
/// );
/// # }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Ensemble<'m, M> {
    model: &'m M,
    threads: usize,
    every: Option<usize>,
}

/// A run that goes on no further.
#[derive(Debug)]
pub struct Ended<M> {
    /// The run where it ended; `None` if it could not start.
    pub run: Option<Simulation<M>>,
    /// Why it ended before its time.
    pub error: Option<RunError>,
}

impl<'m, M: Model + Clone + Send + Sync> Ensemble<'m, M> {
    /// Of a model, on all cores.
    pub fn new(model: &'m M) -> Self {
        let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
        Ensemble { model, threads, every: None }
    }

    /// On so many threads.
    pub fn threads(self, threads: usize) -> Self {
        Ensemble { threads: threads.max(1), ..self }
    }

    /// Visits each run at its start and then after every so many steps.
    pub fn every(self, steps: usize) -> Self {
        Ensemble { every: Some(steps.max(1)), ..self }
    }

    /// Runs instance 0 to `instances` − 1, each with its own settings, to their ends. One that fails
    /// stops no other.
    ///
    /// `visit` sees a run where [`Ensemble::every`] says, and may change it: hold inputs, stop it by
    /// `run.steps = run.state.step`. `ended` takes each run when it is over, in no order. Both are
    /// called from several threads.
    pub fn run(
        &self,
        instances: usize,
        settings: impl Fn(usize) -> Settings + Sync,
        visit: impl Fn(usize, &mut Simulation<M>) + Sync,
        ended: impl Fn(usize, Ended<M>) + Sync,
    ) {
        let threads = self.threads.min(instances);
        // So many that all threads have some.
        let together = RUNS.min(instances.div_ceil(threads.max(1))).max(1);
        let next = AtomicUsize::new(0);
        let work = || {
            loop {
                let first = next.fetch_add(together, Ordering::Relaxed);
                if first >= instances {
                    return;
                }
                let last = instances.min(first + together);
                self.run_some(first..last, &settings, &visit, &ended);
            }
        };
        std::thread::scope(|scope| {
            (1..threads).for_each(|_| drop(scope.spawn(work)));
            work();
        });
    }

    /// Runs up to [`RUNS`] instances together.
    fn run_some(
        &self,
        instances: std::ops::Range<usize>,
        settings: &impl Fn(usize) -> Settings,
        visit: &impl Fn(usize, &mut Simulation<M>),
        ended: &impl Fn(usize, Ended<M>),
    ) {
        let (mut numbers, mut runs) = (Vec::new(), Vec::new());
        for instance in instances {
            match Simulation::new(self.model.clone(), &settings(instance)) {
                Ok(run) => {
                    numbers.push(instance);
                    runs.push(run);
                }
                Err(error) => ended(instance, Ended { run: None, error: Some(error) }),
            }
        }
        let mut errors: Vec<Option<RunError>> = runs.iter().map(|_| None).collect();
        let mut together = Together::new(runs);
        let every = self.every.unwrap_or(usize::MAX);
        let mut step = 0;
        loop {
            if self.every.is_some() && step % every == 0 {
                for ((run, &number), error) in together.runs().iter_mut().zip(&numbers).zip(&errors)
                {
                    if error.is_none() && run.state.step == step {
                        visit(number, run);
                    }
                }
            }
            if together.is_over() {
                break;
            }
            together.advance(every - step % every, |run, error| errors[run] = Some(error));
            step = together.furthest();
        }
        for ((run, number), error) in together.into_runs().into_iter().zip(numbers).zip(errors) {
            ended(number, Ended { run: Some(run), error });
        }
    }
}
