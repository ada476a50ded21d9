//! Motions: poses joined by half-cosines.

/// The pose at time `t` of a motion through `knots` (pose index, time), each pose a full
/// configuration: constant before the first knot and after the last, half-cosine between.
pub fn pose_at(poses: &[Vec<f64>], knots: &[(usize, f64)], t: f64, q: &mut [f64]) {
    let Some(&(last, end)) = knots.last() else { return };
    if t >= end {
        q.copy_from_slice(&poses[last]);
        return;
    }
    let after = knots.iter().position(|&(_, time)| t < time).unwrap_or(0);
    if after == 0 {
        q.copy_from_slice(&poses[knots[0].0]);
        return;
    }
    let ((from, t0), (to, t1)) = (knots[after - 1], knots[after]);
    let weight = 0.5 * (1.0 - (std::f64::consts::PI * (t - t0) / (t1 - t0)).cos());
    for (q, (a, b)) in q.iter_mut().zip(poses[from].iter().zip(&poses[to])) {
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
