//! Places along a way, for pictures.

use super::Surface;
use crate::vector::Vec3;

impl Surface<f64> {
    /// Places on the surface from the first point of contact to the last, in the link's axes: `count`
    /// of them, or none where the strand does not touch.
    pub fn trace(&self, points: [Vec3<f64>; 2], count: usize) -> Vec<Vec3<f64>> {
        let (turn, way) = (self.turn(points), self.way(points));
        if way.cross_straight != 0.0 || !way.length.is_finite() {
            return Vec::new();
        }
        let angle = (turn.length - turn.tangents[0] - turn.tangents[1]) / self.radius;
        let normal = match self.form.axis() {
            None => way.ends[0].binormal,
            Some(axis) => axis.vector().scale(turn.sign),
        };
        // Along the axis the way climbs evenly.
        let rise = normal.dot(points[1] - points[0]);
        let climb = rise / turn.length;
        let level = turn.length / way.length;
        let contact = points[0] - way.ends[0].direction.scale(turn.tangents[0] / level);
        let arm = contact - self.center;
        let height = normal.dot(arm);
        let first = arm - normal.scale(height);
        let second = normal.cross(first);
        let share = |k: usize| k as f64 / (count.max(2) - 1) as f64;
        let place = |k: usize| {
            let (s, c) = (share(k) * angle).sin_cos();
            let along = height + climb * share(k) * angle * self.radius;
            self.center + first.scale(c) + second.scale(s) + normal.scale(along)
        };
        (0..count).map(place).collect()
    }
}
