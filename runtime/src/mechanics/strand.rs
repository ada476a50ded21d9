//! Strands: V = ½k(x − x₀)² over the length x of a path, its gradient and its Hessian.

use super::segment::Segment;
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
        for index in 0..self.numbers.strands.len() {
            self.strand_length(workspace, q, index, quarter.is_some());
            let scratch = &workspace.strand;
            let coordinates = &self.structure.strands[index].coordinates;
            let stiffness = self.numbers.strands[index].stiffness;
            let tension = stiffness * (scratch.lengths[index] - rest[index]);
            let length_dq = &scratch.length_dq[index];
            for (i, &row) in coordinates.iter().enumerate() {
                terms.force[row] -= tension * length_dq[i];
            }
            let Some(quarter) = quarter else { continue };
            let (k, f) = (stiffness * quarter, tension * quarter);
            let count = coordinates.len();
            for i in 0..count {
                let k_length_dq = k * length_dq[i];
                for j in 0..=i {
                    let value = k_length_dq * length_dq[j] + f * scratch.length_dqdq[i * count + j];
                    terms.add(self.structure, coordinates[i], coordinates[j], -value);
                    if i != j {
                        terms.add(self.structure, coordinates[j], coordinates[i], -value);
                    }
                }
            }
        }
    }

    /// Length of strand `index` and its derivatives, into the workspace; second derivatives (in the
    /// order of the path's coordinates) if `second`.
    pub(crate) fn strand_length(
        &self,
        workspace: &mut Workspace<S>,
        q: &[S],
        index: usize,
        second: bool,
    ) {
        let path = &self.structure.strands[index];
        let numbers = &self.numbers.strands[index];
        let count = path.coordinates.len();
        let scratch = &mut workspace.strand;
        let mut length = numbers.constant_length;
        let length_dq = &mut scratch.length_dq[index];
        length_dq.fill(S::zero());
        if second {
            scratch.length_dqdq.clear();
            scratch.length_dqdq.resize(count * count, S::zero());
        }
        let segment = &mut scratch.segment;
        for (segment_path, &ends) in path.segments.iter().zip(&numbers.segments) {
            self.segment(&workspace.sin_cos, q, segment_path, ends, second, segment);
            length += segment.length;
            let crossed = segment.crossings.len();
            for (i, a) in segment.crossings.iter().enumerate() {
                let row = position(&path.coordinates, a.coordinate);
                length_dq[row] += a.length_dq;
                if !second {
                    continue;
                }
                for (j, b) in segment.crossings.iter().enumerate() {
                    let column = position(&path.coordinates, b.coordinate);
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
            self.strand_length(workspace, q, index, false);
            *length = workspace.strand.lengths[index];
        }
    }

    /// Moment arms ∂length/∂q of all strands at q (m/rad or 1), s × n by rows.
    pub fn moment_arms(&self, workspace: &mut Workspace<S>, q: &[S], length_dq: &mut [S]) {
        self.prepare(workspace, q);
        length_dq.fill(S::zero());
        for index in 0..self.numbers.strands.len() {
            self.strand_length(workspace, q, index, false);
            for (i, &coordinate) in self.structure.strands[index].coordinates.iter().enumerate() {
                length_dq[index * self.structure.count + coordinate] =
                    workspace.strand.length_dq[index][i];
            }
        }
    }
}

/// Position of a coordinate among the few of a path.
#[inline]
fn position(coordinates: &[usize], coordinate: usize) -> usize {
    coordinates.iter().position(|&c| c == coordinate).unwrap_or(0)
}
