//! Strands: V = ½k(x − x₀)² over the length x of a path, its gradient and its Hessian.

use super::segment::{Order, Segments};
use super::{Mechanics, Terms, Workspace};
use crate::structure::Structure;
use handc_core::scalar::Scalar;

/// Scratch of one evaluation.
#[derive(Clone, Debug)]
pub struct Scratch<S> {
    /// Segments of one strand.
    segments: Segments<S>,
    /// Length of every strand.
    pub(crate) lengths: Vec<S>,
    /// Derivatives of every strand's length by the coordinates of its path, one after another
    /// ([`StrandPath::span`](crate::structure::StrandPath)).
    pub(crate) length_dq: Vec<S>,
}

impl<S: Scalar> Scratch<S> {
    pub(crate) fn new(structure: &Structure) -> Self {
        let strands = &structure.strands;
        Scratch {
            segments: Segments::new(),
            lengths: vec![S::zero(); strands.len()],
            length_dq: vec![S::zero(); strands.last().map_or(0, |path| path.span.end)],
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
            if let (Some(quarter), Some((_, matrix))) = (quarter, &mut terms.matrix) {
                self.add_stiffness(
                    workspace,
                    index,
                    (stiffness * quarter, tension * quarter),
                    matrix,
                );
            }
        }
    }

    /// Subtracts k·x_i x_j + f·x_ij of the strand just evaluated, below the diagonals of `matrix`.
    /// With d_ij = (D_ij − d_i d_j)/d, the products of a pair that only one segment crosses are
    /// taken together, (k − f/d)·d_i d_j + (f/d)·D_ij.
    fn add_stiffness(
        &self,
        workspace: &Workspace<S>,
        index: usize,
        (k, f): (S, S),
        matrix: &mut [S],
    ) {
        let path = &self.structure.strands[index];
        let Scratch { segments, length_dq, .. } = &workspace.strand;
        let length_dq = &length_dq[path.span.clone()];
        for &(row, column, slot) in &path.apart {
            matrix[slot] -= k * length_dq[row] * length_dq[column];
        }
        let mut first = 0;
        let mut squares = segments.squares.iter();
        for (segment, &inverse) in path.segments.iter().zip(&segments.inverse) {
            let across = f * inverse;
            // Over a surface the squares are whole, and nothing is taken off along the strand.
            let along = match (path.crosses_once, segment.is_wrapped) {
                (true, true) => k,
                (false, true) => S::zero(),
                (true, false) => k - across,
                (false, false) => -across,
            };
            let dq = &segments.length_dq[first..first + segment.positions.len()];
            first += dq.len();
            let mut entries = segment.slots.iter().zip(&mut squares);
            for (i, &row_dq) in dq.iter().enumerate() {
                let row = along * row_dq;
                for (&column_dq, (slot, &square)) in dq[..=i].iter().zip(&mut entries) {
                    if let Some(slot) = *slot {
                        matrix[slot] -= row * column_dq + across * square;
                    }
                }
            }
        }
    }

    /// Length of strand `index` and its derivatives, into the workspace; what second derivatives are
    /// made of stays with the segments, if wanted.
    pub(crate) fn strand_length(
        &self,
        workspace: &mut Workspace<S>,
        q: &[S],
        index: usize,
        order: Order,
    ) {
        let path = &self.structure.strands[index];
        let numbers = &self.numbers.strands[index];
        let Scratch { segments, lengths, length_dq } = &mut workspace.strand;
        segments.begin(numbers.constant_length);
        for (segment_path, resolved) in path.segments.iter().zip(&numbers.segments) {
            self.segment(&workspace.sin_cos, q, segment_path, resolved, order, segments);
        }
        lengths[index] = segments.length;
        if order == Order::Length {
            return;
        }
        let length_dq = &mut length_dq[path.span.clone()];
        length_dq.fill(S::zero());
        let positions = path.segments.iter().flat_map(|segment| &segment.positions);
        for (&position, &dq) in positions.zip(&segments.length_dq) {
            length_dq[position] += dq;
        }
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

    /// Tensions of all strands at q with the given natural lengths (N).
    pub fn strand_tensions(
        &self,
        workspace: &mut Workspace<S>,
        q: &[S],
        rest: &[S],
        tensions: &mut [S],
    ) {
        self.strand_lengths(workspace, q, tensions);
        for (index, tension) in tensions.iter_mut().enumerate() {
            *tension = self.numbers.strands[index].stiffness * (*tension - rest[index]);
        }
    }
}
