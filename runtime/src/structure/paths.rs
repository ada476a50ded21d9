//! Paths of strands: which joints lie between the two ends of a segment.

use super::Structure;
use crate::mechanism::{Mechanism, Point, Strand, Wrap};
use std::ops::Range;

/// A step along the path from one end of a segment to the frame in which it is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathStep {
    /// From the axes of this link to those of its parent.
    Up(u32),
    /// From the axes of this link's parent to its own.
    Down(u32),
}

impl PathStep {
    /// The link whose joint is crossed.
    pub fn link(self) -> u32 {
        match self {
            PathStep::Up(link) | PathStep::Down(link) => link,
        }
    }
}

/// A moving segment: the joints between its ends, met in the middle; for one over a surface the
/// middle is the link that carries the surface.
#[derive(Clone, Debug, PartialEq)]
pub struct SegmentPath {
    /// From the first point's link to the middle.
    pub first: Vec<PathStep>,
    /// From the second point's link to the middle.
    pub second: Vec<PathStep>,
    /// Positions of the joints crossed, first side then second, among the strand's coordinates.
    pub positions: Vec<usize>,
    /// Where each pair (i, j), j ≤ i, of joints crossed stands in a packed matrix, below the
    /// diagonal; `None` if a coordinate is kinematic.
    pub slots: Vec<Option<usize>>,
    /// Whether it runs over a surface. A joint may then be crossed on both sides.
    pub is_wrapped: bool,
}

/// A strand's moving segments and the coordinates they span.
#[derive(Clone, Debug, PartialEq)]
pub struct StrandPath {
    /// Coordinates, each once, ascending.
    pub coordinates: Vec<usize>,
    /// Where its derivatives stand among those of all strands.
    pub span: Range<usize>,
    /// Moving segments in order.
    pub segments: Vec<SegmentPath>,
    /// Whether no coordinate is crossed by two segments.
    pub crosses_once: bool,
    /// Pairs of coordinates, by position, whose stiffness is not that of one segment alone, and
    /// where they stand in a packed matrix, below the diagonal.
    pub apart: Vec<(usize, usize, usize)>,
}

impl Structure {
    pub(super) fn strand_path(&self, mechanism: &Mechanism, strand: &Strand) -> StrandPath {
        let mut coordinates = Vec::new();
        let mut segments = Vec::new();
        for (gap, pair) in strand.points.windows(2).enumerate() {
            let wrap = strand.wrap(gap);
            let Some([first, second]) = segment_path(mechanism, [pair[0], pair[1]], wrap) else {
                continue;
            };
            for step in first.iter().chain(&second) {
                coordinates.push(self.coordinate_of[step.link() as usize]);
            }
            let (positions, slots) = (Vec::new(), Vec::new());
            let is_wrapped = wrap.is_some();
            segments.push(SegmentPath { first, second, positions, slots, is_wrapped });
        }
        coordinates.sort_unstable();
        coordinates.dedup();
        for path in &mut segments {
            path.positions = path
                .first
                .iter()
                .chain(&path.second)
                .filter_map(|step| {
                    coordinates.binary_search(&self.coordinate_of[step.link() as usize]).ok()
                })
                .collect();
        }
        StrandPath { coordinates, span: 0..0, segments, crosses_once: false, apart: Vec::new() }
    }

    pub(super) fn find_strand_slots(&mut self) {
        let mut strands = std::mem::take(&mut self.strands);
        for path in &mut strands {
            let c = &path.coordinates;
            let slot = |i: usize, j: usize| self.slot(c[i.max(j)], c[i.min(j)]);
            let pairs = |count: usize| (0..count).flat_map(|i| (0..=i).map(move |j| (i, j)));
            let crossings = path.segments.iter().map(|segment| segment.positions.len());
            path.crosses_once = crossings.sum::<usize>() == c.len();
            let covered = |i: usize, j: usize| {
                let covers = |p: &Vec<usize>| p.contains(&i) && p.contains(&j);
                path.crosses_once && path.segments.iter().any(|s| covers(&s.positions))
            };
            let apart = pairs(c.len()).filter(|&(i, j)| !covered(i, j));
            path.apart = apart.filter_map(|(i, j)| Some((i, j, slot(i, j)?))).collect();
            for segment in &mut path.segments {
                let p = &segment.positions;
                segment.slots = pairs(p.len()).map(|(i, j)| slot(p[i], p[j])).collect();
            }
        }
        self.strands = strands;
    }
}

/// Links from `link` to the root, `link` first; empty for the world.
fn chain(mechanism: &Mechanism, link: Option<u32>) -> Vec<u32> {
    std::iter::successors(link, |&link| mechanism.links[link as usize].parent).collect()
}

/// The joints from both points of a segment to its middle; `None` where none of them moves the
/// points or the surface between them against each other.
pub fn segment_path(
    mechanism: &Mechanism,
    points: [Point; 2],
    wrap: Option<&Wrap>,
) -> Option<[Vec<PathStep>; 2]> {
    let [first, second] = points.map(|point| point.link);
    let paths = match wrap {
        None => path_between(mechanism, first, second),
        Some(wrap) => [first, second].map(|link| path_to(mechanism, link, wrap.center.link)),
    };
    paths.iter().any(|path| !path.is_empty()).then_some(paths)
}

/// The joints from the ends of a segment to its middle, split so that both cross about as many.
fn path_between(
    mechanism: &Mechanism,
    first: Option<u32>,
    second: Option<u32>,
) -> [Vec<PathStep>; 2] {
    let whole = path_to(mechanism, first, second);
    let middle = whole.len() / 2;
    let reversed = |step: &PathStep| match *step {
        PathStep::Up(l) => PathStep::Down(l),
        PathStep::Down(l) => PathStep::Up(l),
    };
    [whole[..middle].to_vec(), whole[middle..].iter().rev().map(reversed).collect()]
}

/// The joints from one link to another: up to their common ancestor, then down.
fn path_to(mechanism: &Mechanism, from: Option<u32>, to: Option<u32>) -> Vec<PathStep> {
    let (mut up, mut down) = (chain(mechanism, from), chain(mechanism, to));
    while let (Some(a), Some(b)) = (up.last(), down.last()) {
        if a != b {
            break;
        }
        up.pop();
        down.pop();
    }
    let up = up.iter().map(|&l| PathStep::Up(l));
    up.chain(down.iter().rev().map(|&l| PathStep::Down(l))).collect()
}
