//! Strands: V = ½k(x − x₀)² over the length x of a path, its gradient and its Hessian.

use super::segment::{Order, Segment, hinge_segment};
use super::{Mechanics, Terms, Workspace};
use crate::resolved::ResolvedSegment;
use crate::structure::Structure;
use handc_core::scalar::Scalar;

/// Scratch of one evaluation.
#[derive(Clone, Debug)]
pub struct Scratch<S> {
    segment: Segment<S>,
    /// Length of every strand.
    pub(crate) lengths: Vec<S>,
    /// Derivatives of every strand's length by the coordinates of its path, one after another
    /// ([`StrandPath::span`](crate::structure::StrandPath)).
    pub(crate) length_dq: Vec<S>,
    /// Second derivatives of one strand, lower triangle.
    length_dqdq: Vec<S>,
}

impl<S: Scalar> Scratch<S> {
    pub(crate) fn new(structure: &Structure) -> Self {
        let strands = &structure.strands;
        Scratch {
            segment: Segment::new(),
            lengths: vec![S::zero(); strands.len()],
            length_dq: vec![S::zero(); strands.last().map_or(0, |path| path.span.end)],
            length_dqdq: vec![S::zero(); strands.iter().map(|p| p.slots.len()).max().unwrap_or(0)],
        }
    }
}

impl<S: Scalar> Mechanics<'_, S> {
    /// Adds the force and the stiffness of every strand.
    pub(crate) fn add_strands(
        &self,
        workspace: &mut Workspace<S>,
        q: &[S],
        rest: &[S],
        terms: &mut Terms<S>,
    ) {
        let quarter = terms.matrix.as_ref().map(|(h, _)| h.scale(0.25));
        let order = if quarter.is_some() { Order::Second } else { Order::First };
        for (index, path) in self.structure.strands.iter().enumerate() {
            self.strand_length(workspace, q, index, order);
            let scratch = &workspace.strand;
            let stiffness = self.numbers.strands[index].stiffness;
            let tension = stiffness * (scratch.lengths[index] - rest[index]);
            let length_dq = &scratch.length_dq[path.span.clone()];
            for (&row, &dq) in path.coordinates.iter().zip(length_dq) {
                terms.force[row] -= tension * dq;
            }
            let (Some(quarter), Some((_, matrix))) = (quarter, &mut terms.matrix) else { continue };
            let (k, f) = (stiffness * quarter, tension * quarter);
            let mut entries = path.slots.iter().zip(&scratch.length_dqdq);
            for (i, &row_dq) in length_dq.iter().enumerate() {
                let k_row = k * row_dq;
                for (&column_dq, (slot, &dqdq)) in length_dq[..=i].iter().zip(&mut entries) {
                    if let Some(slot) = *slot {
                        matrix[slot] -= k_row * column_dq + f * dqdq;
                    }
                }
            }
        }
    }

    /// Length of strand `index` and its derivatives, into the workspace; second derivatives (lower
    /// triangle, in the order of the path's coordinates) if wanted.
    pub(crate) fn strand_length(
        &self,
        workspace: &mut Workspace<S>,
        q: &[S],
        index: usize,
        order: Order,
    ) {
        let path = &self.structure.strands[index];
        let numbers = &self.numbers.strands[index];
        let Scratch { segment, lengths, length_dq, length_dqdq } = &mut workspace.strand;
        let length_dq = &mut length_dq[path.span.clone()];
        let length_dqdq = &mut length_dqdq[..path.slots.len()];
        length_dq.fill(S::zero());
        if order == Order::Second {
            length_dqdq.fill(S::zero());
        }
        let mut length = numbers.constant_length;
        for (segment_path, resolved) in path.segments.iter().zip(&numbers.segments) {
            let ends = match (*resolved, segment_path.hinge) {
                (ResolvedSegment::Hinge { cosine, sine, constant }, Some(link)) => {
                    let sin_cos = workspace.sin_cos[link as usize];
                    let hinge = (cosine, sine, constant);
                    let (d, dq, dqdq) = hinge_segment(hinge, sin_cos, order);
                    length += d;
                    if order != Order::Length {
                        length_dq[segment_path.positions[0]] += dq;
                    }
                    if order == Order::Second {
                        length_dqdq[segment_path.pairs[0]] += dqdq;
                    }
                    continue;
                }
                (ResolvedSegment::Ends(first, second), _) => (first, second),
                (ResolvedSegment::Hinge { .. }, None) => unreachable!("a hinge without a link"),
            };
            self.segment(&workspace.sin_cos, q, segment_path, ends, order, segment);
            length += segment.length;
            for (crossing, &position) in segment.crossings.iter().zip(&segment_path.positions) {
                length_dq[position] += crossing.length_dq;
            }
            for (&dqdq, &pair) in segment.length_dqdq.iter().zip(&segment_path.pairs) {
                length_dqdq[pair] += dqdq;
            }
        }
        lengths[index] = length;
    }

    /// Lengths of all strands at q (m).
    pub fn strand_lengths(&self, workspace: &mut Workspace<S>, q: &[S], lengths: &mut [S]) {
        self.prepare(workspace, q);
        for (index, length) in lengths.iter_mut().enumerate() {
            self.strand_length(workspace, q, index, Order::Length);
            *length = workspace.strand.lengths[index];
        }
    }

    /// Moment arms ∂length/∂q of all strands at q (m/rad or 1), s × n by rows.
    pub fn moment_arms(&self, workspace: &mut Workspace<S>, q: &[S], length_dq: &mut [S]) {
        self.prepare(workspace, q);
        length_dq.fill(S::zero());
        for index in 0..self.numbers.strands.len() {
            self.strand_length(workspace, q, index, Order::First);
            let path = &self.structure.strands[index];
            let found = &workspace.strand.length_dq[path.span.clone()];
            for (&coordinate, &dq) in path.coordinates.iter().zip(found) {
                length_dq[index * self.structure.count + coordinate] = dq;
            }
        }
    }
}
