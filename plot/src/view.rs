//! From space to paper: an orthographic view, chosen so that shape and motion are seen.

use crate::pose::{PoseFigure, Solid, Spot};

/// Axes of the paper in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct View {
    /// To the right.
    pub(crate) right: Spot,
    /// Upwards.
    pub(crate) up: Spot,
    /// To the reader.
    pub(crate) near: Spot,
    /// Whether all lies in a plane that faces the reader.
    pub(crate) flat: bool,
}

/// Directions tried around the vertical.
const TURNS: usize = 48;
/// Heights of the reader's eye (degrees).
const ELEVATIONS: [f64; 3] = [14.0, 22.0, 30.0];
/// Extent across a plane, against the largest, below which a mechanism counts as plane.
const THIN: f64 = 0.08;
/// Weight of the motion against the shape.
const MOTION: f64 = 1.5;
/// Weight of the distance between bodies on paper against the shape.
const APART: f64 = 6.0;

pub(crate) fn dot(a: Spot, b: Spot) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: Spot, b: Spot) -> Spot {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn minus(a: Spot, b: Spot) -> Spot {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn unit(a: Spot) -> Option<Spot> {
    let norm = dot(a, a).sqrt();
    (norm > 1e-12 && norm.is_finite()).then(|| a.map(|x| x / norm))
}

impl View {
    /// From a direction to the reader.
    fn from(near: Spot, up: Spot) -> Option<View> {
        let right = unit(cross(up, near))?;
        Some(View { right, up: cross(near, right), near, flat: false })
    }

    /// On paper, to the right and upwards (m).
    pub(crate) fn project(&self, spot: Spot) -> [f64; 2] {
        [dot(self.right, spot), dot(self.up, spot)]
    }

    /// The view of a figure: square onto a plane that holds nearly everything, else oblique.
    pub(crate) fn choose(figure: &PoseFigure) -> View {
        let spots: Vec<Vec<Spot>> = figure
            .poses
            .iter()
            .map(|pose| pose.spots().into_iter().map(|(spot, _)| spot).collect())
            .collect();
        let extent = [0, 1, 2].map(|axis| {
            let along = spots.iter().flatten().map(|spot| spot[axis]);
            let (low, high) =
                along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
            (high - low).max(0.0)
        });
        let largest = extent[0].max(extent[1]).max(extent[2]);
        let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
        let flat = |right, up, near| View { right, up, near, flat: true };
        let thin = |axis: usize| extent[axis] <= THIN * largest;
        if thin(2) {
            return flat(x, y, z);
        } else if thin(1) {
            return flat(x, z, [0.0, -1.0, 0.0]);
        } else if thin(0) {
            return flat(y, z, x);
        }
        let up = unit(figure.up).unwrap_or(z);
        let middles = middles(figure);
        let score = |view: &View| view.score(&spots, &middles);
        let candidates: Vec<View> =
            directions(up).filter_map(|near| View::from(near, up)).collect();
        let best = candidates.iter().max_by(|a, b| score(a).total_cmp(&score(b)));
        best.copied().unwrap_or(flat(x, z, [0.0, -1.0, 0.0]))
    }

    /// How much of shape and motion is seen, and how well bodies are apart.
    fn score(&self, spots: &[Vec<Spot>], middles: &[Spot]) -> f64 {
        let (mut shape, mut hidden) = (1e-300, 0.0);
        let all: Vec<Spot> = spots.iter().flatten().copied().collect();
        let count = all.len().max(1) as f64;
        let mean = [0, 1, 2].map(|i| all.iter().map(|s| s[i]).sum::<f64>() / count);
        for spot in &all {
            let from = minus(*spot, mean);
            shape += dot(from, from);
            hidden += dot(self.near, from).powi(2);
        }
        let (mut motion, mut unseen) = (1e-6 * shape, 0.0);
        for pair in spots.windows(2).filter(|pair| pair[0].len() == pair[1].len()) {
            for (a, b) in pair[0].iter().zip(&pair[1]) {
                let moved = minus(*b, *a);
                motion += dot(moved, moved);
                unseen += dot(self.near, moved).powi(2);
            }
        }
        let size = (shape / count).sqrt();
        let places: Vec<[f64; 2]> = middles.iter().map(|m| self.project(*m)).collect();
        let nearest = |i: usize| {
            let others = (0..places.len()).filter(|j| *j != i);
            let apart = |j: usize| {
                (places[i][0] - places[j][0]).hypot(places[i][1] - places[j][1]).min(size)
            };
            others.map(apart).fold(size, f64::min)
        };
        let apart =
            (0..places.len()).map(nearest).sum::<f64>() / (places.len().max(1) as f64 * size);
        -hidden / shape - MOTION * unseen / motion + APART * apart
    }
}

/// Directions to the reader, a little above the horizon.
fn directions(up: Spot) -> impl Iterator<Item = Spot> {
    let level = if up[0].abs() < 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let first = unit(minus(level, up.map(|x| x * dot(level, up)))).unwrap_or(level);
    let second = cross(up, first);
    (0..TURNS).flat_map(move |turn| {
        let (s, c) = (turn as f64 * std::f64::consts::TAU / TURNS as f64).sin_cos();
        ELEVATIONS.into_iter().map(move |elevation| {
            let (rise, level) = elevation.to_radians().sin_cos();
            [0, 1, 2].map(|i| level * (c * first[i] + s * second[i]) + rise * up[i])
        })
    })
}

/// Middles of the bodies of the first and the last pose.
fn middles(figure: &PoseFigure) -> Vec<Spot> {
    let middle = |solid: &Solid| {
        let spots = solid.spots();
        [0, 1, 2].map(|i| spots.iter().map(|s| s[i]).sum::<f64>() / spots.len().max(1) as f64)
    };
    let first = figure.poses.first();
    first.map_or(Vec::new(), |pose| pose.solids.iter().take(60).map(middle).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::Pose;

    fn figure(strand: Vec<Spot>) -> PoseFigure {
        let pose = Pose { strands: vec![strand], ..Pose::default() };
        PoseFigure { title: String::new(), strands: vec![], up: [0.0, 0.0, 1.0], poses: vec![pose] }
    }

    #[test]
    fn a_plane_faces_the_reader() {
        let view = View::choose(&figure(vec![[0.0, 0.0, 0.0], [1.0, 2.0, 0.0]]));
        assert!(view.flat && view.project([3.0, 4.0, 5.0]) == [3.0, 4.0]);
        let view = View::choose(&figure(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 2.0]]));
        assert!(view.flat && view.project([3.0, 4.0, 5.0]) == [3.0, 5.0]);
        assert!(View::choose(&figure(vec![])).flat);
    }

    #[test]
    fn space_is_seen_obliquely() {
        let corners = vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [2.0, 1.0, 0.5]];
        let view = View::choose(&figure(corners));
        assert!(!view.flat);
        let axes = [view.right, view.up, view.near];
        for i in 0..3 {
            for j in 0..3 {
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((dot(axes[i], axes[j]) - expected).abs() < 1e-12);
            }
        }
        assert!(view.up[2] > 0.8);
    }
}
