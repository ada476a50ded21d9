//! The data of a picture of a mechanism at several instants.

use crate::unit::Unit;

/// A place in space (m).
pub type Spot = [f64; 3];

/// A body's shape.
#[derive(Clone, Debug, PartialEq)]
pub enum Solid {
    /// A bone: a rod between two centres.
    Rod {
        /// One end.
        from: Spot,
        /// The other end.
        to: Spot,
        /// Radius (m).
        radius: f64,
    },
    /// A ball.
    Ball {
        /// Centre.
        center: Spot,
        /// Radius (m).
        radius: f64,
    },
    /// A box by its corners, numbered by the bits x, y, z.
    Block([Spot; 8]),
    /// A mass without a size.
    Mass(Spot),
}

impl Solid {
    /// The places that it spans.
    pub(crate) fn spots(&self) -> Vec<Spot> {
        match self {
            Solid::Rod { from, to, .. } => vec![*from, *to],
            Solid::Ball { center, .. } => vec![*center],
            Solid::Block(corners) => corners.to_vec(),
            Solid::Mass(at) => vec![*at],
        }
    }
    /// Whether it is a rod that is wider than it is long.
    pub(crate) fn is_wheel(&self) -> bool {
        match self {
            Solid::Rod { from, to, radius } => {
                let length = (0..3).map(|i| (to[i] - from[i]).powi(2)).sum::<f64>().sqrt();
                length < 2.0 * radius
            }
            _ => false,
        }
    }
    /// How far it reaches around them (m).
    pub(crate) fn radius(&self) -> f64 {
        match self {
            Solid::Rod { radius, .. } if self.is_wheel() => *radius,
            Solid::Rod { radius, .. } => BONE * radius,
            Solid::Ball { radius, .. } => *radius,
            _ => 0.0,
        }
    }
}

/// Part of a rod's radius at which it is drawn: the bone within the flesh, so that the strands
/// around it are seen.
pub(crate) const BONE: f64 = 0.42;

/// A mechanism at an instant, in world axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pose {
    /// Time (s).
    pub time: f64,
    /// Text below instead of the time.
    pub caption: Option<String>,
    /// Bodies.
    pub solids: Vec<Solid>,
    /// Surfaces that strands wrap.
    pub surfaces: Vec<Solid>,
    /// Lines from joint to joint.
    pub bars: Vec<[Spot; 2]>,
    /// Joints.
    pub joints: Vec<Spot>,
    /// Joints and strand points that the world holds.
    pub anchors: Vec<Spot>,
    /// Path of each strand.
    pub strands: Vec<Vec<Spot>>,
    /// Forces: where each acts, and its components (N).
    pub forces: Vec<(Spot, Spot)>,
}

impl Pose {
    /// Every place with the reach around it.
    pub(crate) fn spots(&self) -> Vec<(Spot, f64)> {
        let plain = |spot: &Spot| (*spot, 0.0);
        let solids = self.solids.iter().chain(&self.surfaces).flat_map(|solid| {
            let radius = solid.radius();
            solid.spots().into_iter().map(move |spot| (spot, radius))
        });
        let lines = self.bars.iter().flatten().chain(&self.joints).chain(&self.anchors);
        let all = solids.chain(lines.map(plain)).chain(self.strands.iter().flatten().map(plain));
        all.filter(|(spot, _)| spot.iter().all(|x| x.abs() < 1e30)).collect()
    }
}

/// A mechanism at several instants.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseFigure {
    /// Title.
    pub title: String,
    /// Names of the strands.
    pub strands: Vec<String>,
    /// What is up, in world axes.
    pub up: Spot,
    /// Poses in order of time.
    pub poses: Vec<Pose>,
}

/// Text of an instant.
pub(crate) fn instant(time: f64, last: f64) -> String {
    let scale = Unit::Prefixed("s").scale(last.abs());
    let value = time * scale.factor;
    let text = if (value - value.round()).abs() < 1e-6 {
        format!("{value:.0}")
    } else {
        format!("{value:.2}").trim_end_matches('0').trim_end_matches('.').to_string()
    };
    format!("t = {text} {}", scale.unit)
}

/// Indices of at most `count` instants on the way from the start to the greatest departure from it,
/// by equal shares of way and time. `departure` tells how far the mechanism is from its start.
pub fn instants(departure: &[f64], count: usize) -> Vec<usize> {
    let largest = departure.iter().copied().filter(|d| d.is_finite()).fold(0.0, f64::max);
    let shares = count.saturating_sub(1).max(1) as f64;
    let last = departure.iter().position(|d| *d >= WHOLE * largest).unwrap_or(0);
    let mut chosen = vec![0];
    let mut farthest = 0.0f64;
    for i in 1..=if largest > 0.0 { last } else { 0 } {
        farthest = farthest.max(departure[i]);
        let share = 0.5 * farthest / (WHOLE * largest) + 0.5 * i as f64 / last as f64;
        if i == last || share >= chosen.len() as f64 / shares && chosen.len() + 1 < count {
            chosen.push(i);
        }
    }
    chosen
}

/// Part of the greatest departure that counts as reached.
const WHOLE: f64 = 0.998;

/// Part of its size by which a mechanism must move for more than two poses.
const STILL: f64 = 0.06;

impl PoseFigure {
    /// Only the first and the last pose where little moves between them.
    pub fn without_repetition(mut self) -> Self {
        let (Some(first), Some(last)) = (self.poses.first(), self.poses.last()) else {
            return self;
        };
        let (from, to) = (first.spots(), last.spots());
        let distance =
            |a: &Spot, b: &Spot| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
        let Some((origin, _)) = from.first() else { return self };
        let size = from.iter().map(|(spot, _)| distance(spot, origin)).fold(0.0, f64::max);
        let moved = from.iter().zip(&to).map(|((a, _), (b, _))| distance(a, b)).fold(0.0, f64::max);
        if from.len() == to.len() && moved < STILL * size && self.poses.len() > 2 {
            let last = self.poses.len() - 1;
            self.poses.swap(1, last);
            self.poses.truncate(2);
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instants_lead_to_the_greatest_departure() {
        let away = [0.0, 1.0, 2.0, 3.0, 4.0, 4.0, 2.0, 0.0];
        assert_eq!(instants(&away, 5), [0, 1, 2, 3, 4]);
        assert_eq!(instants(&away, 3), [0, 2, 4]);
        assert_eq!(instants(&[0.0, 0.0], 5), [0]);
        assert_eq!(instants(&[f64::NAN, 1.0], 3), [0, 1]);
        assert_eq!(instants(&[0.0], 1), [0]);
        assert!(instants(&[], 3).len() == 1);
    }

    #[test]
    fn what_hardly_moves_is_drawn_twice() {
        let pose =
            |x: f64| Pose { time: x, bars: vec![[[0.0; 3], [1.0, x, 0.0]]], ..Pose::default() };
        let figure = |step: f64| PoseFigure {
            title: String::new(),
            strands: vec![],
            up: [0.0, 0.0, 1.0],
            poses: (0..5).map(|k| pose(k as f64 * step)).collect(),
        };
        let times = |figure: PoseFigure| figure.poses.iter().map(|p| p.time).collect::<Vec<_>>();
        assert_eq!(times(figure(0.001).without_repetition()), [0.0, 0.004]);
        assert_eq!(times(figure(0.1).without_repetition()).len(), 5);
    }

    #[test]
    fn instants_are_short_texts() {
        assert_eq!(instant(1.25, 4.0), "t = 1.25 s");
        assert_eq!(instant(2.998, 4.0), "t = 3 s");
        assert_eq!(instant(3.0000000001, 4.0), "t = 3 s");
        assert_eq!(instant(0.002, 0.004), "t = 2 ms");
    }
}
