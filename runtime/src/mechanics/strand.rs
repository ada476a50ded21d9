//! Strands: forces along paths, from the tension of a law and the derivatives of a length.

use super::law::Pull;
use super::segment::{Order, Segments};
use super::{At, Mechanics, Terms, Workspace};
use crate::expression::{StrandQuantity, StrandState};
use crate::mechanism::Law;
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
    /// Their rates of change, of the strand last evaluated.
    length_dqdt: Vec<S>,
}

impl<S: Scalar> Scratch<S> {
    pub(crate) fn new(structure: &Structure) -> Self {
        let strands = &structure.strands;
        let derivatives = strands.last().map_or(0, |path| path.span.end);
        Scratch {
            segments: Segments::new(),
            lengths: vec![S::zero(); strands.len()],
            length_dq: vec![S::zero(); derivatives],
            length_dqdt: vec![S::zero(); derivatives],
        }
    }
}

impl<S: Scalar> Mechanics<'_, S> {
    /// Adds the force −T·x_q of every strand, and its derivatives
    /// −(h/4)(T_x x_q x_qᵀ + T x_qq + T_ẋ x_q (x_qq v)ᵀ) − ½T_ẋ x_q x_qᵀ.
    pub(crate) fn add_strands(
        &self,
        workspace: &mut Workspace<S>,
        at: &At<S>,
        terms: &mut Terms<S>,
    ) {
        let h = terms.matrix.as_ref().map(|(h, _)| *h);
        let order = if h.is_some() { Order::Second } else { Order::First };
        for (index, path) in self.structure.strands.iter().enumerate() {
            self.strand_length(workspace, at.q, index, order);
            let strand = &self.mechanism.strands[index];
            if strand.law == Law::Prescribed {
                continue;
            }
            if self.numbers.strands[index].friction.is_some() {
                self.add_sliding(workspace, at, index, terms);
                continue;
            }
            let rate = if strand.has_rate() {
                self.strand_rate(workspace, index, at.v)
            } else {
                S::zero()
            };
            let length = workspace.strand.lengths[index];
            let pull = self.pull(workspace, at, index, (length, rate), h.is_some());
            let length_dq = &workspace.strand.length_dq[path.span.clone()];
            for (&row, &dq) in path.coordinates.iter().zip(length_dq) {
                terms.force[row] -= pull.tension * dq;
            }
            let Some(h) = h else { continue };
            let quarter = h.scale(0.25);
            let mut along = pull.length_slope * quarter;
            if let Some(slope) = pull.rate_slope {
                along += slope.scale(0.5);
                self.add_turning(workspace, index, at.v, slope * quarter, terms);
            }
            if let Some((_, matrix)) = &mut terms.matrix {
                self.add_stiffness(workspace, index, (along, pull.tension * quarter), matrix);
            }
            self.add_others(workspace, index, &pull, h, terms);
        }
        self.add_muscles(workspace, at, terms);
    }

    /// Rate ẋ = x_q·v of the strand just evaluated.
    pub(crate) fn strand_rate(&self, workspace: &Workspace<S>, index: usize, v: &[S]) -> S {
        let path = &self.structure.strands[index];
        let length_dq = &workspace.strand.length_dq[path.span.clone()];
        let mut rate = S::zero();
        for (&coordinate, &dq) in path.coordinates.iter().zip(length_dq) {
            rate += dq * v[coordinate];
        }
        rate
    }

    /// Subtracts `weight`·x_i (x_qq v)_j of the strand just evaluated: its rate changes as its
    /// moment arms do.
    fn add_turning(
        &self,
        workspace: &mut Workspace<S>,
        index: usize,
        v: &[S],
        weight: S,
        terms: &mut Terms<S>,
    ) {
        let path = &self.structure.strands[index];
        let Scratch { segments, length_dq, length_dqdt, .. } = &mut workspace.strand;
        let length_dq = &length_dq[path.span.clone()];
        let turning = &mut length_dqdt[path.span.clone()];
        turning.fill(S::zero());
        let (mut first, mut squares) = (0, segments.squares.iter());
        for (segment, &inverse) in path.segments.iter().zip(&segments.inverse) {
            let positions = &segment.positions;
            let dq = &segments.length_dq[first..first + positions.len()];
            first += dq.len();
            let rate_of = |position: usize| v[path.coordinates[position]];
            let mut rate = S::zero();
            // Over a surface the squares are whole, and nothing is taken off along the strand.
            if !segment.is_wrapped {
                for (&position, &dq) in positions.iter().zip(dq) {
                    rate += dq * rate_of(position);
                }
            }
            for (i, &row) in positions.iter().enumerate() {
                turning[row] -= inverse * dq[i] * rate;
                for &column in &positions[..=i] {
                    let Some(&square) = squares.next() else { continue };
                    turning[row] += inverse * square * rate_of(column);
                    if column != row {
                        turning[column] += inverse * square * rate_of(row);
                    }
                }
            }
        }
        let coordinates = &path.coordinates;
        for i in 0..coordinates.len() {
            let own = -(weight * length_dq[i] * turning[i]);
            terms.add(self.structure, coordinates[i], coordinates[i], own);
            for j in 0..i {
                let pair = self.structure.pair(coordinates[i], coordinates[j]);
                let below = length_dq[i] * turning[j];
                let above = length_dq[j] * turning[i];
                let half = weight.scale(-0.5);
                terms.add_pair(pair, half * (below + above), half * (below - above));
            }
        }
    }

    /// Subtracts what a commanded tension changes with other coordinates and rates.
    fn add_others(
        &self,
        workspace: &Workspace<S>,
        index: usize,
        pull: &Pull<S>,
        h: S,
        terms: &mut Terms<S>,
    ) {
        let path = &self.structure.strands[index];
        let length_dq = &workspace.strand.length_dq[path.span.clone()];
        for (column, slope) in self.others(pull, h) {
            for (&row, &dq) in path.coordinates.iter().zip(length_dq) {
                self.add_entry(row, column, -(slope * dq), terms);
            }
        }
    }

    /// What a tension changes with other coordinates and rates, as the Newton matrix weighs it.
    pub(super) fn others(&self, pull: &Pull<S>, h: S) -> Vec<(usize, S)> {
        let quarter = h.scale(0.25);
        let by_q = pull.dq.iter().map(|&(column, slope)| (column, quarter * slope));
        let by_v = pull.dv.iter().map(|&(column, slope)| {
            (column, slope.scale(0.5 * self.structure.rate_weight(column)))
        });
        by_q.chain(by_v).collect()
    }

    /// Adds one entry before even and odd parts are unfolded.
    pub(super) fn add_entry(&self, row: usize, column: usize, value: S, terms: &mut Terms<S>) {
        if row == column {
            terms.add(self.structure, row, row, value);
        } else {
            let half = value.scale(0.5);
            terms.add_pair(self.structure.pair(row, column), half, half);
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
        let Scratch { segments, lengths, length_dq, .. } = &mut workspace.strand;
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

    /// What all strands do at a state, in the order of [`StrandQuantity`]; what is of muscles is zero
    /// for others.
    pub fn strand_states(
        &self,
        workspace: &mut Workspace<S>,
        at: &At<S>,
        states: &mut [StrandState<S>],
    ) {
        self.prepare(workspace, at.q);
        for (index, state) in states.iter_mut().enumerate() {
            self.strand_length(workspace, at.q, index, Order::First);
            let rate = self.strand_rate(workspace, index, at.v);
            let length = workspace.strand.lengths[index];
            let pull = self.pull(workspace, at, index, (length, rate), false);
            let mut dissipation = pull.dissipation;
            if self.numbers.strands[index].friction.is_some() {
                dissipation += pull.tension * self.sliding_loss(at, index);
            }
            *state = [S::zero(); StrandQuantity::COUNT];
            state[..4].copy_from_slice(&[rate, pull.tension, pull.taut, dissipation]);
            self.see_muscle(at, index, state);
        }
    }
}
