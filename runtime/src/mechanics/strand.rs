//! Strands: V = ½k(x − x₀)² over the length x of a path, its gradient and its Hessian.

use super::segment::{Order, Segment};
use super::{Mechanics, Terms, Workspace};
use crate::structure::Structure;
use handc_core::scalar::Scalar;

/// Scratch of one evaluation.
#[derive(Clone, Debug)]
pub struct Scratch<S> {
    segment: Segment<S>,
    /// Length of every strand.
    pub(crate) lengths: Vec<S>,
    /// Derivatives of every strand's length by the coordinates of its path.
    pub(crate) length_dq: Vec<Vec<S>>,
    length_dqdq: Vec<S>,
}

impl<S: Scalar> Scratch<S> {
    pub(crate) fn new(structure: &Structure) -> Self {
        Scratch {
            segment: Segment::new(),
            lengths: vec![S::zero(); structure.strands.len()],
            length_dq: structure
                .strands
                .iter()
                .map(|path| vec![S::zero(); path.coordinates.len()])
                .collect(),
            length_dqdq: Vec::new(),
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
        for index in 0..self.numbers.strands.len() {
            self.strand_length(workspace, q, index, order);
            let scratch = &workspace.strand;
            let coordinates = &self.structure.strands[index].coordinates;
            let stiffness = self.numbers.strands[index].stiffness;
            let tension = stiffness * (scratch.lengths[index] - rest[index]);
            let length_dq = &scratch.length_dq[index];
            for (i, &row) in coordinates.iter().enumerate() {
                terms.force[row] -= tension * length_dq[i];
            }
            let (Some(quarter), Some((_, matrix))) = (quarter, &mut terms.matrix) else { continue };
            let (k, f) = (stiffness * quarter, tension * quarter);
            let count = coordinates.len();
            let mut slots = self.structure.strands[index].slots.iter();
            for i in 0..count {
                let k_length_dq = k * length_dq[i];
                for j in 0..=i {
                    let Some(&Some((lower, upper))) = slots.next() else { continue };
                    let value = k_length_dq * length_dq[j] + f * scratch.length_dqdq[i * count + j];
                    matrix[lower] -= value;
                    if i != j {
                        matrix[upper] -= value;
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
        let count = path.coordinates.len();
        let scratch = &mut workspace.strand;
        let mut length = numbers.constant_length;
        let length_dq = &mut scratch.length_dq[index];
        length_dq.fill(S::zero());
        if order == Order::Second {
            scratch.length_dqdq.clear();
            scratch.length_dqdq.resize(count * count, S::zero());
        }
        let segment = &mut scratch.segment;
        for (segment_path, &ends) in path.segments.iter().zip(&numbers.segments) {
            self.segment(&workspace.sin_cos, q, segment_path, ends, order, segment);
            length += segment.length;
            if order == Order::Length {
                continue;
            }
            let crossed = segment.crossings.len();
            for (i, a) in segment.crossings.iter().enumerate() {
                let row = segment_path.positions[i];
                length_dq[row] += a.length_dq;
                if order != Order::Second {
                    continue;
                }
                // The lower triangle is enough, within the strand's order of coordinates.
                for j in 0..=i {
                    let column = segment_path.positions[j];
                    let (row, column) = (row.max(column), row.min(column));
                    scratch.length_dqdq[row * count + column] +=
                        segment.length_dqdq[i * crossed + j];
                }
            }
        }
        scratch.lengths[index] = length;
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
            for (i, &coordinate) in self.structure.strands[index].coordinates.iter().enumerate() {
                length_dq[index * self.structure.count + coordinate] =
                    workspace.strand.length_dq[index][i];
            }
        }
    }
}
