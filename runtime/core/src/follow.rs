//! Natural lengths that follow a motion: the lengths of strands in a moving pose.

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

    /// Goes to time `t` of a motion and measures the pose there, unless it was measured already.
    pub(crate) fn move_to<M: Model>(
        &mut self,
        model: &mut M,
        poses: &[Vec<f64>],
        knots: &[(usize, f64)],
        t: f64,
    ) {
        pose_at(poses, knots, t, &mut self.next_pose);
        let rests = self.revision == Some(model.revision()) && self.pose == self.next_pose;
        if !rests {
            std::mem::swap(&mut self.pose, &mut self.next_pose);
            self.revision = Some(model.revision());
            model.strand_lengths(&self.pose, &mut self.lengths);
        }
    }

    /// Lengths of strands in the measured pose.
    pub(crate) fn lengths(&self) -> &[f64] {
        &self.lengths
    }
}
