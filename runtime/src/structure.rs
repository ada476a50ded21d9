//! What can be known of a mechanism without its numbers: chains, paths, blocks.
//!
//! Computed once. The kernels branch on it, so that interpreter and staged code follow the same
//! shape: which link carries the matter of a tree, which joints lie between the two ends of a
//! segment, which coordinates a step couples.

use crate::expression::{Function, Variable};
use crate::mechanism::{ConstraintKind, Mechanism, Motion, Strand};
use crate::resolved::constraint_points;
use crate::run::find_runs;
use handc_core::layout::Block;
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

/// A moving segment: the joints between its ends, met in the middle.
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

/// A tree of links on the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    /// Links outside runs, parents first.
    pub links: Vec<u32>,
    /// Its runs, by number.
    pub runs: Vec<usize>,
    /// The link in whose axes the tree's momenta are expressed; `None` is the world.
    pub hub: Option<u32>,
    /// A run on the hub in whose axes, at its first joint, they are expressed instead.
    pub base: Option<usize>,
    /// Links from the root to the hub, hub included.
    pub trunk: Vec<u32>,
}

/// Where the entries (i, j) and (j, i) of a packed matrix stand, as their even and odd part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pair {
    /// Slot below the diagonal.
    pub even: usize,
    /// Slot above it.
    pub odd: usize,
    /// Whether (i, j) is the one above.
    pub is_above: bool,
}

/// A planar run; see [`crate::run`].
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Links from base to tip.
    pub links: Vec<u32>,
    /// The link that carries it; `None` is the world.
    pub parent: Option<u32>,
    /// Links from the parent to the root.
    pub ancestors: Vec<u32>,
    /// Pairs of links (i, j), j ≤ i; `None` if a coordinate is kinematic.
    pub inner: Vec<Option<Pair>>,
    /// Pairs of a link, tip first, and an ancestor, ancestor by ancestor.
    pub outer: Vec<Option<Pair>>,
}

/// The shape of a mechanism.
#[derive(Clone, Debug, PartialEq)]
pub struct Structure {
    /// Coordinates and links, as many of one as of the other.
    pub count: usize,
    /// Parent of each link.
    pub parents: Vec<Option<u32>>,
    /// Coordinate of each link.
    pub coordinate_of: Vec<usize>,
    /// Link of each coordinate.
    pub link_of: Vec<u32>,
    /// Whether the link or one below it has matter.
    pub has_mass_below: Vec<bool>,
    /// Planar runs.
    pub runs: Vec<Run>,
    /// Trees with matter.
    pub trees: Vec<Tree>,
    /// Paths of the strands.
    pub strands: Vec<StrandPath>,
    /// First row of each constraint; one more entry holds the number of rows.
    pub first_row: Vec<usize>,
    /// Links whose world transform is needed by constraints, forces or gravity.
    pub world_links: Vec<bool>,
    /// Blocks of the step equations.
    pub blocks: Vec<Block>,
    /// Block of each coordinate and its position there; `None` for kinematic ones.
    pub slots: Vec<Option<(usize, usize)>>,
    /// Block of each constraint row and its position there; `None` if it holds no dynamic coordinate.
    pub row_slots: Vec<Option<(usize, usize)>>,
}

impl Structure {
    /// Analyses a mechanism.
    pub fn new(mechanism: &Mechanism) -> Self {
        let count = mechanism.links.len();
        let parents: Vec<_> = mechanism.links.iter().map(|l| l.parent).collect();
        let coordinate_of: Vec<_> = mechanism.links.iter().map(|l| l.coordinate as usize).collect();
        let mut link_of = vec![0; count];
        for (link, &coordinate) in coordinate_of.iter().enumerate() {
            link_of[coordinate] = link as u32;
        }
        let mut first_row = vec![0];
        for constraint in &mechanism.constraints {
            first_row.push(first_row.last().unwrap_or(&0) + constraint.row_suffixes().len());
        }
        let mut structure = Structure {
            count,
            parents,
            coordinate_of,
            link_of,
            has_mass_below: mass_below(mechanism),
            runs: Vec::new(),
            trees: Vec::new(),
            strands: Vec::new(),
            world_links: vec![false; count],
            blocks: Vec::new(),
            slots: vec![None; count],
            row_slots: vec![None; first_row[mechanism.constraints.len()]],
            first_row,
        };
        structure.runs = structure.find_runs(mechanism);
        structure.find_trees(mechanism);
        structure.strands =
            mechanism.strands.iter().map(|s| structure.strand_path(mechanism, s)).collect();
        let mut end = 0;
        for path in &mut structure.strands {
            path.span = end..end + path.coordinates.len();
            end = path.span.end;
        }
        structure.mark_world_links(mechanism);
        structure.find_blocks(mechanism);
        structure.find_strand_slots();
        structure.find_run_pairs();
        structure
    }

    fn find_run_pairs(&mut self) {
        let mut runs = std::mem::take(&mut self.runs);
        for run in &mut runs {
            let pair = |a: &u32, b: &u32| {
                self.pair(self.coordinate_of[*a as usize], self.coordinate_of[*b as usize])
            };
            let links = &run.links;
            let inner = links.iter().enumerate();
            run.inner = inner.flat_map(|(i, a)| links[..=i].iter().map(|b| pair(a, b))).collect();
            let outer = run.ancestors.iter();
            run.outer = outer.flat_map(|b| links.iter().rev().map(|a| pair(a, b))).collect();
        }
        self.runs = runs;
    }

    fn find_strand_slots(&mut self) {
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

    /// Links from `link` to the root, `link` first; empty for the world.
    pub fn chain(&self, link: Option<u32>) -> Vec<u32> {
        let mut chain = Vec::new();
        let mut at = link;
        while let Some(link) = at {
            chain.push(link);
            at = self.parents[link as usize];
        }
        chain
    }

    /// Position of (i, j) in a packed matrix, for two coordinates of one block.
    #[inline]
    pub fn slot(&self, i: usize, j: usize) -> Option<usize> {
        let ((block, row), (other, column)) = (self.slots[i]?, self.slots[j]?);
        if block != other {
            return None;
        }
        let block = &self.blocks[block];
        Some(block.matrix_offset + row * block.coordinates.len() + column)
    }

    /// Where (i, j) and (j, i) stand in a packed matrix.
    #[inline]
    pub fn pair(&self, i: usize, j: usize) -> Option<Pair> {
        let (slot, mirrored) = (self.slot(i, j)?, self.slot(j, i)?);
        let (even, odd) = (slot.max(mirrored), slot.min(mirrored));
        Some(Pair { even, odd, is_above: slot < mirrored })
    }

    /// Position of (row, coordinate) in a packed constraint Jacobian.
    #[inline]
    pub fn row_slot(&self, row: usize, coordinate: usize) -> Option<usize> {
        let ((block, i), (other, j)) = (self.row_slots[row]?, self.slots[coordinate]?);
        if block != other {
            return None;
        }
        let block = &self.blocks[block];
        Some(block.constraint_offset + i * block.coordinates.len() + j)
    }

    fn find_runs(&self, mechanism: &Mechanism) -> Vec<Run> {
        let runs = find_runs(mechanism).into_iter().map(|links| {
            let parent = self.parents[links[0] as usize];
            let (inner, outer) = (Vec::new(), Vec::new());
            Run { links, parent, ancestors: self.chain(parent), inner, outer }
        });
        runs.collect()
    }

    fn find_trees(&mut self, mechanism: &Mechanism) {
        let roots: Vec<u32> =
            (0..self.count as u32).filter(|&l| self.parents[l as usize].is_none()).collect();
        for root in roots {
            if !self.has_mass_below[root as usize] {
                continue;
            }
            let in_tree = |link: u32| self.chain(Some(link)).contains(&root);
            let in_run = |link: u32| self.runs.iter().any(|run| run.links.contains(&link));
            let links: Vec<u32> = (0..self.count as u32)
                .filter(|&l| self.has_mass_below[l as usize] && in_tree(l) && !in_run(l))
                .collect();
            let runs = (0..self.runs.len()).filter(|&run| in_tree(self.runs[run].links[0]));
            let runs = runs.collect();
            let (hub, base) = self.hub(mechanism, root);
            let mut trunk = self.chain(hub);
            trunk.reverse();
            self.trees.push(Tree { links, runs, hub, base, trunk });
        }
    }

    /// The link whose axes make the tree's momenta cheapest: the first with matter or a fork, where
    /// inertia is constant; for a single body on sliders first, the frame the sliders carry, where
    /// its linear momentum is constant times its rate. Where a run comes first, what carries it, and
    /// the run.
    fn hub(&self, mechanism: &Mechanism, root: u32) -> (Option<u32>, Option<usize>) {
        let children = |link: u32| -> Vec<u32> {
            (0..self.count as u32)
                .filter(|&l| {
                    self.parents[l as usize] == Some(link) && self.has_mass_below[l as usize]
                })
                .collect()
        };
        let mut anchor = root;
        loop {
            let below = children(anchor);
            if below.len() != 1 || mechanism.bodies.iter().any(|b| b.link == Some(anchor)) {
                break;
            }
            anchor = below[0];
        }
        if let Some(run) = self.runs.iter().position(|run| run.links.contains(&anchor)) {
            return (self.runs[run].parent, Some(run));
        }
        if !children(anchor).is_empty() {
            return (Some(anchor), None);
        }
        let mut slider = None;
        for &link in self.chain(Some(anchor)).iter().rev() {
            match mechanism.links[link as usize].motion {
                Motion::Prismatic { .. } => slider = Some(link),
                _ => break,
            }
        }
        (slider.or(Some(anchor)), None)
    }

    fn strand_path(&self, mechanism: &Mechanism, strand: &Strand) -> StrandPath {
        let mut coordinates = Vec::new();
        let mut segments = Vec::new();
        for pair in strand.points.windows(2) {
            if pair[0].link == pair[1].link {
                continue;
            }
            let [first, second] = path_between(mechanism, pair[0].link, pair[1].link);
            for step in first.iter().chain(&second) {
                coordinates.push(self.coordinate_of[step.link() as usize]);
            }
            let (positions, slots) = (Vec::new(), Vec::new());
            segments.push(SegmentPath { first, second, positions, slots });
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

    fn mark_world_links(&mut self, mechanism: &Mechanism) {
        let mut marked = Vec::new();
        for constraint in &mechanism.constraints {
            marked.extend(constraint_points(&constraint.kind).iter().map(|p| p.link));
        }
        for force in &mechanism.forces {
            marked.extend([force.point.link, force.axes]);
        }
        for link in marked {
            for link in self.chain(link) {
                self.world_links[link as usize] = true;
            }
        }
    }

    /// Coordinates that a function of the state moves with.
    pub fn function_coordinates(&self, function: &Function) -> Vec<usize> {
        let mut coordinates = Vec::new();
        for variable in &function.gradient {
            match *variable {
                Variable::Coordinate(i) | Variable::Rate(i) => coordinates.push(i as usize),
                Variable::Length(s) => {
                    coordinates.extend(&self.strands[s as usize].coordinates);
                }
                _ => {}
            }
        }
        coordinates.sort_unstable();
        coordinates.dedup();
        coordinates
    }

    /// Coordinates of the links from `link` to the root.
    pub fn chain_coordinates(&self, link: Option<u32>) -> Vec<usize> {
        self.chain(link).iter().map(|&l| self.coordinate_of[l as usize]).collect()
    }

    /// Coordinates that each row of a constraint moves with.
    pub fn constraint_coordinates(&self, kind: &ConstraintKind) -> Vec<usize> {
        let mut coordinates = match kind {
            ConstraintKind::Equation(function) => self.function_coordinates(function),
            other => constraint_points(other)
                .iter()
                .flat_map(|point| self.chain_coordinates(point.link))
                .collect(),
        };
        coordinates.sort_unstable();
        coordinates.dedup();
        coordinates
    }

    fn find_blocks(&mut self, mechanism: &Mechanism) {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for link in 0..self.count {
            if self.has_mass_below[link] {
                groups.push(self.chain_coordinates(Some(link as u32)));
            }
        }
        groups.extend(self.strands.iter().map(|s| s.coordinates.clone()));
        for torque in &mechanism.torques {
            let mut group = self.function_coordinates(&torque.value);
            group.push(torque.coordinate as usize);
            groups.push(group);
        }
        for force in &mechanism.forces {
            let mut group = self.chain_coordinates(force.point.link);
            group.extend(self.chain_coordinates(force.axes));
            for component in &force.value {
                group.extend(self.function_coordinates(component));
            }
            groups.push(group);
        }
        let rows: Vec<Vec<usize>> =
            mechanism.constraints.iter().map(|c| self.constraint_coordinates(&c.kind)).collect();
        let unconstrained = groups.len();
        groups.extend(rows.iter().cloned());
        let dynamic: Vec<bool> = mechanism.coordinates.iter().map(|c| c.drive.is_none()).collect();
        for group in &mut groups {
            group.retain(|&c| dynamic[c]);
        }
        let root = components(self.count, &groups);
        let part_root = components(self.count, &groups[..unconstrained]);
        let mut block_of_root = vec![usize::MAX; self.count];
        for coordinate in (0..self.count).filter(|&c| dynamic[c]) {
            let block = &mut block_of_root[root[coordinate]];
            if *block == usize::MAX {
                *block = self.blocks.len();
                self.blocks.push(Block {
                    coordinates: Vec::new(),
                    rows: Vec::new(),
                    parts: Vec::new(),
                    matrix_offset: 0,
                    constraint_offset: 0,
                });
            }
            let members = &mut self.blocks[*block].coordinates;
            self.slots[coordinate] = Some((*block, members.len()));
            members.push(coordinate);
        }
        for (constraint, coordinates) in rows.iter().enumerate() {
            let Some(first) = coordinates.iter().find(|&&c| dynamic[c]) else { continue };
            let block = block_of_root[root[*first]];
            for row in self.first_row[constraint]..self.first_row[constraint + 1] {
                self.row_slots[row] = Some((block, self.blocks[block].rows.len()));
                self.blocks[block].rows.push(row);
            }
        }
        let (mut matrix_offset, mut constraint_offset) = (0, 0);
        for block in &mut self.blocks {
            let mut roots: Vec<usize> = Vec::new();
            for (local, &coordinate) in block.coordinates.iter().enumerate() {
                let root = part_root[coordinate];
                match roots.iter().position(|&r| r == root) {
                    Some(part) => block.parts[part].push(local),
                    None => {
                        roots.push(root);
                        block.parts.push(vec![local]);
                    }
                }
            }
            block.matrix_offset = matrix_offset;
            block.constraint_offset = constraint_offset;
            matrix_offset += block.coordinates.len() * block.coordinates.len();
            constraint_offset += block.coordinates.len() * block.rows.len();
        }
    }
}

/// Links from `link` to the root, `link` first; empty for the world.
fn chain(mechanism: &Mechanism, link: Option<u32>) -> Vec<u32> {
    std::iter::successors(link, |&link| mechanism.links[link as usize].parent).collect()
}

/// The joints from the ends of a segment to its middle, split so that both cross about as many.
pub fn path_between(
    mechanism: &Mechanism,
    first: Option<u32>,
    second: Option<u32>,
) -> [Vec<PathStep>; 2] {
    let (mut up, mut down) = (chain(mechanism, first), chain(mechanism, second));
    while let (Some(a), Some(b)) = (up.last(), down.last()) {
        if a != b {
            break;
        }
        up.pop();
        down.pop();
    }
    // The whole path from first to second: up to the common ancestor, then down.
    let up = up.iter().map(|&l| PathStep::Up(l));
    let whole: Vec<PathStep> = up.chain(down.iter().rev().map(|&l| PathStep::Down(l))).collect();
    let middle = whole.len() / 2;
    let reversed = |step: &PathStep| match *step {
        PathStep::Up(l) => PathStep::Down(l),
        PathStep::Down(l) => PathStep::Up(l),
    };
    [whole[..middle].to_vec(), whole[middle..].iter().rev().map(reversed).collect()]
}

/// Which links, or one below them, have matter.
pub fn mass_below(mechanism: &Mechanism) -> Vec<bool> {
    let mut has_mass_below = vec![false; mechanism.links.len()];
    for link in mechanism.bodies.iter().filter_map(|body| body.link) {
        has_mass_below[link as usize] = true;
    }
    for (link, l) in mechanism.links.iter().enumerate().rev() {
        if let (true, Some(parent)) = (has_mass_below[link], l.parent) {
            has_mass_below[parent as usize] = true;
        }
    }
    has_mass_below
}

/// Connected components of coordinates that share a group: a representative per coordinate.
fn components(count: usize, groups: &[Vec<usize>]) -> Vec<usize> {
    let mut parent: Vec<usize> = (0..count).collect();
    fn find(parent: &mut [usize], mut i: usize) -> usize {
        while parent[i] != i {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        i
    }
    for group in groups {
        for pair in group.windows(2) {
            let (a, b) = (find(&mut parent, pair[0]), find(&mut parent, pair[1]));
            parent[a.max(b)] = a.min(b);
        }
    }
    (0..count).map(|i| find(&mut parent, i)).collect()
}
