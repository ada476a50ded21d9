//! Several runs of one model that step together, each in a lane.

use crate::error::RunError;
use crate::lanes::{LaneConstants, LaneStep, RUNS};
use crate::model::Model;
use crate::simulation::Simulation;

/// Constants that runs have in common places.
#[derive(Clone, Debug)]
pub struct Together {
    constants: LaneConstants,
}

/// How one step of each of several runs ended.
pub type Outcomes = [Result<(), RunError>; RUNS];

impl Together {
    /// For runs of this run's model.
    pub fn new<M: Model>(first: &mut Simulation<M>) -> Self {
        Together { constants: first.fresh_lane_constants() }
    }

    /// Takes one step of every run. Where lanes cannot, runs step one by one; a run that fails is
    /// left as it was, and the others have stepped.
    pub fn step<M: Model>(&mut self, runs: &mut [Simulation<M>; RUNS]) -> Outcomes {
        Simulation::prepare_together(runs, &mut self.constants);
        if !runs.iter().all(|run| run.is_on_lanes()) {
            return runs.each_mut().map(Simulation::finish_alone);
        }
        let parts = runs.each_mut().map(Simulation::lane_run);
        let models = parts.each_ref().map(|(_, model)| *model);
        let stamps = models.map(Model::revision);
        let mut lanes = parts.map(|(run, _)| run);
        let mut step = LaneStep::new(&mut lanes, &stamps, &mut self.constants);
        let complete = M::on_lanes(&models, &mut step);
        let ends = lanes.each_ref().map(|run| (complete && !run.failed, run.iterations));
        let mut next = ends.into_iter();
        runs.each_mut().map(|run| match next.next() {
            Some((true, iterations)) => {
                run.finish_on_lanes(iterations);
                Ok(())
            }
            _ => run.finish_alone(),
        })
    }
}
