//! Strands while one joint, or two, go through a range.
//!
//! The other coordinates stay at the pose. Where constraints move them along, they are moved by the
//! least change, from one value to the next, so that a loop stays on its branch.

use crate::command::posture::Posture;
use handc_core::linalg::solve_least_norm;
use handc_core::model::Model;
use handc_core::start::project;
use handc_runtime::analysis::linear::Held;
use handc_runtime::analysis::tangent::Tangent;

/// What all strands do at one value.
#[derive(Clone, Debug)]
pub(super) struct Instant {
    /// Lengths (m).
    pub(super) lengths: Vec<f64>,
    /// Derivatives of the lengths by each swept coordinate (m/rad or 1), one list for each; what
    /// constraints move along is in them.
    pub(super) arms: Vec<Vec<f64>>,
    /// Tensions (N).
    pub(super) tensions: Vec<f64>,
}

/// Values of the swept coordinates, and the strands there; `None` where the constraints do not
/// close.
#[derive(Clone, Debug)]
pub(super) struct Sweep {
    /// Coordinates by index.
    pub(super) coordinates: Vec<usize>,
    /// A value of each, and what is there.
    pub(super) instants: Vec<(Vec<f64>, Option<Instant>)>,
    /// The strands that are shown, by index.
    pub(super) strands: Vec<usize>,
}

impl Sweep {
    fn new(
        coordinates: Vec<usize>,
        instants: Vec<(Vec<f64>, Option<Instant>)>,
        chosen: &[usize],
    ) -> Sweep {
        let found = || instants.iter().flat_map(|(_, instant)| instant);
        let count = found().next().map_or(0, |instant| instant.lengths.len());
        let moves = |s: &usize| {
            found().flat_map(|instant| &instant.arms).any(|arms| arms[*s].abs() > STILL)
        };
        let is_chosen = |s: &usize| chosen.is_empty() || chosen.contains(s);
        let strands = (0..count).filter(|s| moves(s) && is_chosen(s)).collect();
        Sweep { coordinates, instants, strands }
    }
}

/// An arm below this is none (m/rad or 1).
const STILL: f64 = 1e-12;

/// `points` values over a range, ends included.
pub(super) fn values([low, high]: [f64; 2], points: usize) -> Vec<f64> {
    let share = |k: usize| k as f64 / (points - 1) as f64;
    (0..points).map(|k| low + (high - low) * share(k)).collect()
}

/// Sweeps one coordinate and shows the strands that it moves, among the chosen ones if there are any.
pub(super) fn line(
    posture: &mut Posture,
    coordinate: usize,
    values: &[f64],
    chosen: &[usize],
) -> Sweep {
    let mut walker = Walker::new(posture, vec![coordinate]);
    let start = walker.posture.q.clone();
    // From the value nearest to the pose outwards, each from its neighbour.
    let near = nearest(values, start[coordinate]);
    let mut found: Vec<Option<Instant>> = vec![None; values.len()];
    let mut q = start.clone();
    for i in near..values.len() {
        found[i] = walker.visit(&mut q, &[values[i]]);
    }
    q = start;
    for i in (0..near).rev() {
        found[i] = walker.visit(&mut q, &[values[i]]);
    }
    let instants = values.iter().map(|value| vec![*value]).zip(found).collect();
    Sweep::new(vec![coordinate], instants, chosen)
}

/// Sweeps two coordinates: for each value of the first all values of the second.
pub(super) fn grid(
    posture: &mut Posture,
    coordinates: [usize; 2],
    values: [&[f64]; 2],
    chosen: &[usize],
) -> Sweep {
    let [first, second] = values;
    let mut walker = Walker::new(posture, coordinates.to_vec());
    let start = walker.posture.q.clone();
    let near = [nearest(first, start[coordinates[0]]), nearest(second, start[coordinates[1]])];
    let mut found: Vec<Option<Instant>> = vec![None; first.len() * second.len()];
    for rows in [(near[0]..first.len()).collect::<Vec<_>>(), (0..near[0]).rev().collect()] {
        let mut from = start.clone();
        for i in rows {
            let mut q = from.clone();
            for j in near[1]..second.len() {
                found[i * second.len() + j] = walker.visit(&mut q, &[first[i], second[j]]);
                if j == near[1] {
                    from = q.clone();
                }
            }
            q = from.clone();
            for j in (0..near[1]).rev() {
                found[i * second.len() + j] = walker.visit(&mut q, &[first[i], second[j]]);
            }
        }
    }
    let places = first.iter().flat_map(|a| second.iter().map(|b| vec![*a, *b]));
    Sweep::new(coordinates.to_vec(), places.zip(found).collect(), chosen)
}

fn nearest(values: &[f64], wanted: f64) -> usize {
    let apart = |i: &usize| (values[*i] - wanted).abs();
    (0..values.len()).min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap_or(0)
}

struct Walker<'a> {
    posture: &'a mut Posture,
    coordinates: Vec<usize>,
    /// Coordinates that constraints do not move.
    held: Vec<bool>,
}

impl<'a> Walker<'a> {
    fn new(posture: &'a mut Posture, coordinates: Vec<usize>) -> Self {
        let mut held = posture.driven.clone();
        coordinates.iter().for_each(|&c| held[c] = true);
        Walker { posture, coordinates, held }
    }

    /// Goes to a value from `q`, which is left where the constraints close.
    fn visit(&mut self, q: &mut Vec<f64>, values: &[f64]) -> Option<Instant> {
        let mut next = q.clone();
        self.coordinates.iter().zip(values).for_each(|(&c, value)| next[c] = *value);
        let rest = self.posture.rest.clone();
        project(&mut self.posture.model, &mut next, &rest, &self.held).ok()?;
        let asked = std::mem::replace(&mut self.posture.q, next);
        let settled = self.posture.settle_nodes();
        *q = std::mem::replace(&mut self.posture.q, asked);
        settled.ok()?;
        let (n, s) = (q.len(), self.posture.rest.len());
        let mut lengths = vec![0.0; s];
        let mut by_coordinate = vec![0.0; s * n];
        let model = &mut self.posture.model;
        model.strand_lengths(q, &mut lengths);
        model.moment_arms(q, &mut by_coordinate);
        let tensions = self.posture.tensions(q, &rest);
        let arms = (0..self.coordinates.len())
            .map(|k| {
                let motion = self.motion(q, k);
                let arm = |row: &[f64]| row.iter().zip(&motion).map(|(a, m)| a * m).sum();
                by_coordinate.chunks(n).map(arm).collect()
            })
            .collect();
        Some(Instant { lengths, arms, tensions })
    }

    /// Motion of all coordinates with the k-th swept one, the other swept ones at rest: the least
    /// that keeps the constraints, and what massless nodes do.
    fn motion(&mut self, q: &[f64], k: usize) -> Vec<f64> {
        let layout = self.posture.model.layout().clone();
        let swept = self.coordinates[k];
        let mut motion = vec![0.0; q.len()];
        motion[swept] = 1.0;
        if !layout.rows.is_empty() {
            self.follow_constraints(q, swept, &mut motion);
        }
        self.follow_nodes(q, motion)
    }

    /// What massless nodes add to a motion as they stay balanced.
    fn follow_nodes(&mut self, q: &[f64], motion: Vec<f64>) -> Vec<f64> {
        let statics = self.posture.model.layout().massless(&self.posture.driven);
        if statics.is_empty() {
            return motion;
        }
        let mut driven = vec![true; q.len()];
        statics.into_iter().for_each(|c| driven[c] = false);
        let (rest, inputs) = (self.posture.rest.clone(), self.posture.inputs.clone());
        let held = Held { t: 0.0, rest: &rest, inputs: &inputs, driven: &driven };
        let tangent = Tangent::at(&mut self.posture.model, q, &held);
        tangent.and_then(|tangent| tangent.balanced(&motion)).unwrap_or(motion)
    }

    /// The least motion that keeps the constraints.
    fn follow_constraints(&mut self, q: &[f64], swept: usize, motion: &mut [f64]) {
        let model = &mut self.posture.model;
        let layout = model.layout().clone();
        let mut jacobian = vec![0.0; layout.constraint_size()];
        model.constraint_jacobian(q, 0.0, &mut jacobian);
        for block in layout.blocks.iter().filter(|block| block.coordinates.contains(&swept)) {
            let free = block.free(&self.held);
            let (width, rows) = (block.coordinates.len(), block.rows.len());
            let entry = |r: usize, c: usize| jacobian[block.constraint_offset + r * width + c];
            let local = block.coordinates.iter().position(|&c| c == swept).unwrap_or(0);
            let right: Vec<f64> = (0..rows).map(|r| -entry(r, local)).collect();
            let matrix: Vec<f64> =
                (0..rows).flat_map(|r| free.iter().map(move |&(c, _)| entry(r, c))).collect();
            let found = solve_least_norm(&matrix, rows, free.len(), &right).x;
            free.iter().zip(found).for_each(|(&(_, c), value)| motion[c] = value);
        }
    }
}
