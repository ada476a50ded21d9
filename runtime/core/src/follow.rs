//! Natural lengths that follow a motion: the lengths of strands in a moving pose.

use crate::lanes::{LaneConstants, LaneLengths};
use crate::model::Model;
use crate::motion::pose_at;

/// The lengths in the pose that one motion has reached.
#[derive(Clone, Debug)]
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

    /// Lengths of the wanted strands at time `t` of a motion; a pose that rests is not measured
    /// again.
    pub(crate) fn at<M: Model>(
        &mut self,
        model: &mut M,
        constants: &mut LaneConstants,
        poses: &[Vec<f64>],
        knots: &[(usize, f64)],
        t: f64,
        wanted: &[usize],
    ) -> &[f64] {
        pose_at(poses, knots, t, &mut self.next_pose);
        if self.revision != Some(model.revision()) || self.pose != self.next_pose {
            std::mem::swap(&mut self.pose, &mut self.next_pose);
            self.revision = Some(model.revision());
            self.measure(model, constants, wanted);
        }
        &self.lengths
    }

    fn measure<M: Model>(
        &mut self,
        model: &mut M,
        constants: &mut LaneConstants,
        wanted: &[usize],
    ) {
        // Strands that span no block stay unmeasured on lanes.
        self.lengths.fill(f64::NAN);
        let mut lengths =
            LaneLengths::new(&self.pose, &mut self.lengths, model.revision(), constants);
        if !M::on_lanes(&[model], &mut lengths)
            || wanted.iter().any(|&strand| self.lengths[strand].is_nan())
        {
            model.strand_lengths(&self.pose, &mut self.lengths);
        }
    }
}
