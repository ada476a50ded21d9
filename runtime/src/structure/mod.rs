//! What can be known of a mechanism without its numbers: chains, paths, blocks.
//!
//! Computed once. The kernels branch on it, so that interpreter and staged code follow the same
//! shape: which link carries the matter of a tree, which joints lie between the two ends of a
//! segment, which coordinates a step couples.

mod blocks;
mod paths;
mod statics;

use crate::mechanism::{ConstraintKind, Mechanism, Motion};
use crate::resolved::constraint_points;
use crate::run::find_runs;
use handc_core::internal::RATE;
use handc_core::layout::Block;
pub use paths::{PathStep, SegmentPath, StrandPath, segment_path};

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
    /// Whether its inertia is left out: quasi-static strands hold every coordinate of it.
    pub is_static: bool,
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
    /// Coordinates; there are as many links and those of muscles.
    pub count: usize,
    /// Parent of each link.
    pub parents: Vec<Option<u32>>,
    /// Coordinate of each link.
    pub coordinate_of: Vec<usize>,
    /// Link of each coordinate; `None` for those of muscles.
    pub link_of: Vec<Option<u32>>,
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
    /// Rows that prescribe the length of a strand, and the strand.
    pub prescribed: Vec<(usize, usize)>,
    /// Coordinates in static equilibrium: of massless nodes and of trees whose inertia is left out,
    /// where nothing depends on their rates and no constraint holds them.
    pub is_static: Vec<bool>,
    /// Internal coordinates: fibre lengths and activations of muscles
    /// ([`handc_core::internal`]).
    pub is_internal: Vec<bool>,
    /// Blocks of the step equations.
    pub blocks: Vec<Block>,
    /// Block of each coordinate and its position there; `None` for kinematic ones.
    pub slots: Vec<Option<(usize, usize)>>,
    /// Block of each constraint row and its position there; `None` if it holds no dynamic coordinate.
    pub row_slots: Vec<Option<(usize, usize)>>,
    /// Slots of a packed constraint Jacobian that are not zero by structure.
    pub row_entries: Vec<usize>,
}

impl Structure {
    /// Analyses a mechanism.
    pub fn new(mechanism: &Mechanism) -> Self {
        let count = mechanism.coordinates.len();
        let parents: Vec<_> = mechanism.links.iter().map(|l| l.parent).collect();
        let coordinate_of: Vec<_> = mechanism.links.iter().map(|l| l.coordinate as usize).collect();
        let mut link_of = vec![None; count];
        for (link, &coordinate) in coordinate_of.iter().enumerate() {
            link_of[coordinate] = Some(link as u32);
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
            world_links: vec![false; mechanism.links.len()],
            prescribed: Vec::new(),
            is_static: Vec::new(),
            is_internal: vec![false; count],
            blocks: Vec::new(),
            slots: vec![None; count],
            row_slots: vec![None; first_row[mechanism.constraints.len()]],
            row_entries: Vec::new(),
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
        structure.find_prescribed(mechanism);
        structure.find_statics(mechanism);
        structure.find_internals(mechanism);
        structure.mark_world_links(mechanism);
        structure.find_blocks(mechanism);
        structure.find_strand_slots();
        structure.find_run_pairs();
        structure
    }

    fn find_prescribed(&mut self, mechanism: &Mechanism) {
        for (constraint, &row) in mechanism.constraints.iter().zip(&self.first_row) {
            if let ConstraintKind::Length(strand) = constraint.kind {
                self.prescribed.push((row, strand as usize));
            }
        }
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

    /// How many links there are.
    pub fn links(&self) -> usize {
        self.parents.len()
    }

    /// Factor of the step's own rate δ/h in the rate of a coordinate, by half of which the Newton
    /// matrix weighs what depends on it.
    pub fn rate_weight(&self, coordinate: usize) -> f64 {
        if self.is_internal[coordinate] { RATE } else { 1.0 }
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
            (0..self.links() as u32).filter(|&l| self.parents[l as usize].is_none()).collect();
        for root in roots {
            if !self.has_mass_below[root as usize] {
                continue;
            }
            let in_tree = |link: u32| self.chain(Some(link)).contains(&root);
            let in_run = |link: u32| self.runs.iter().any(|run| run.links.contains(&link));
            let links: Vec<u32> = (0..self.links() as u32)
                .filter(|&l| self.has_mass_below[l as usize] && in_tree(l) && !in_run(l))
                .collect();
            let runs = (0..self.runs.len()).filter(|&run| in_tree(self.runs[run].links[0]));
            let runs = runs.collect();
            let (hub, base) = self.hub(mechanism, root);
            let mut trunk = self.chain(hub);
            trunk.reverse();
            self.trees.push(Tree { links, runs, hub, base, trunk, is_static: false });
        }
    }

    /// The link whose axes make the tree's momenta cheapest: the first with matter or a fork, where
    /// inertia is constant; for a single body on sliders first, the frame the sliders carry, where
    /// its linear momentum is constant times its rate. Where a run comes first, what carries it, and
    /// the run.
    fn hub(&self, mechanism: &Mechanism, root: u32) -> (Option<u32>, Option<usize>) {
        let children = |link: u32| -> Vec<u32> {
            (0..self.links() as u32)
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

    /// Coordinates of the links from `link` to the root.
    pub fn chain_coordinates(&self, link: Option<u32>) -> Vec<usize> {
        self.chain(link).iter().map(|&l| self.coordinate_of[l as usize]).collect()
    }
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
