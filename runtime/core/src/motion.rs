//! Motions: poses joined by half-cosines.

/// The part of a motion in which a time lies: between two knots, before the first or after the last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Part {
    /// Poses at its beginning and its end, by index; equal where it rests.
    pub(crate) poses: [usize; 2],
    /// From when on, and until before when (s).
    pub(crate) times: [f64; 2],
}

impl Part {
    /// The part of a motion through `knots` (pose index, time) at time `t`; `None` without knots.
    pub(crate) fn at(knots: &[(usize, f64)], t: f64) -> Option<Part> {
        let (&(first, begin), &(last, end)) = (knots.first()?, knots.last()?);
        Some(match knots.iter().position(|&(_, time)| t < time) {
            None => Part { poses: [last; 2], times: [end, f64::INFINITY] },
            Some(0) => Part { poses: [first; 2], times: [f64::NEG_INFINITY, begin] },
            Some(after) => {
                let ((from, t0), (to, t1)) = (knots[after - 1], knots[after]);
                Part { poses: [from, to], times: [t0, t1] }
            }
        })
    }

    /// Whether the pose stays.
    pub(crate) fn rests(&self) -> bool {
        self.poses[0] == self.poses[1]
    }
}

/// The pose at time `t` of a motion through `knots` (pose index, time), each pose a full
/// configuration: constant before the first knot and after the last, half-cosine between.
pub fn pose_at(poses: &[Vec<f64>], knots: &[(usize, f64)], t: f64, q: &mut [f64]) {
    let Some(part) = Part::at(knots, t) else { return };
    let [from, to] = part.poses.map(|pose| &poses[pose]);
    if part.rests() {
        q.copy_from_slice(from);
        return;
    }
    let [t0, t1] = part.times;
    let weight = 0.5 * (1.0 - (std::f64::consts::PI * (t - t0) / (t1 - t0)).cos());
    for (q, (a, b)) in q.iter_mut().zip(from.iter().zip(to)) {
        *q = a + (b - a) * weight;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_cosine_between_and_constant_outside() {
        let poses = [vec![1.0], vec![3.0]];
        let knots = [(0, 1.0), (1, 2.0), (1, 3.0), (0, 4.0)];
        let at = |t| {
            let mut q = [0.0];
            pose_at(&poses, &knots, t, &mut q);
            q[0]
        };
        assert_eq!(at(0.0), 1.0);
        assert!((at(1.5) - 2.0).abs() < 1e-15);
        assert!(
            (at(1.25) - (1.0 + 2.0 * 0.5 * (1.0 - (0.25 * std::f64::consts::PI).cos()))).abs()
                < 1e-15
        );
        assert_eq!(at(2.5), 3.0);
        assert_eq!(at(9.0), 1.0);
    }
}
