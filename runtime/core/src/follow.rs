//! Natural lengths that follow a motion: the lengths of strands in a moving pose.

use crate::lanes::{LaneConstants, LaneLengths};
use crate::model::Model;
use crate::motion::pose_at;

/// The lengths in the pose that one motion has reached.
#[derive(Clone, Debug, Default)]
pub(crate) struct Followed {
    pose: Vec<f64>,
    next_pose: Vec<f64>,
    lengths: Vec<f64>,
    /// Stamp of the parameters with which `lengths` belong to `pose`; `None` before the first time.
    revision: Option<u64>,
}

impl Followed {
    /// For n coordinates and s strands.
    pub(crate) fn new(coordinates: usize, strands: usize) -> Self {
        Followed {
            pose: vec![0.0; coordinates],
            next_pose: vec![0.0; coordinates],
            lengths: vec![0.0; strands],
            revision: None,
        }
    }

    /// Goes to time `t` of a motion; whether the pose has moved, so that it is to be measured.
    pub(crate) fn move_to<M: Model>(
        &mut self,
        model: &M,
        poses: &[Vec<f64>],
        knots: &[(usize, f64)],
        t: f64,
    ) -> bool {
        pose_at(poses, knots, t, &mut self.next_pose);
        let rests = self.revision == Some(model.revision()) && self.pose == self.next_pose;
        if !rests {
            std::mem::swap(&mut self.pose, &mut self.next_pose);
            self.revision = Some(model.revision());
        }
        !rests
    }

    /// Measures the pose of one run.
    pub(crate) fn measure<M: Model>(&mut self, model: &mut M) {
        model.strand_lengths(&self.pose, &mut self.lengths);
    }

    /// Measures the poses of several runs on lanes; a length that is not a number has stayed
    /// unmeasured, since its strand spans no block or there are no lanes.
    pub(crate) fn measure_on_lanes<M: Model, const R: usize>(
        followed: &mut [Followed; R],
        models: [&M; R],
        constants: &mut LaneConstants,
    ) {
        let stamps = models.map(Model::revision);
        let mut runs = followed.each_mut().map(|Followed { pose, lengths, .. }| {
            lengths.fill(f64::NAN);
            (&pose[..], &mut lengths[..])
        });
        M::on_lanes(&models, &mut LaneLengths::new(&mut runs, &stamps, constants));
    }

    /// Lengths of strands in the measured pose.
    pub(crate) fn lengths(&self) -> &[f64] {
        &self.lengths
    }
}
