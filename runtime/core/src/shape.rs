//! Shapes: the step equations that like blocks share.
//!
//! The fingers of a hand obey the same equations with other constants. A compiled model writes them
//! once, generic over the [`Lane`], and says for each block where its numbers stand ([`Place`]) and
//! what its constants are. Here is how one block is evaluated number by number; a private module
//! takes steps of several blocks at once.

use crate::array::sized_mut;
use crate::lane::Lane;
use crate::model::Midpoint;

/// Where the numbers of a block stand in the model's vectors.
///
/// `Q` coordinates, of which the block's own come first and kinematic ones after them; `S` strands;
/// `U` inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place<const Q: usize, const S: usize, const U: usize> {
    /// Coordinates by index.
    pub coordinates: [usize; Q],
    /// Strands by index.
    pub strands: [usize; S],
    /// Inputs by index.
    pub inputs: [usize; U],
    /// Where the block's matrix starts in packed storage.
    pub matrix: usize,
}

/// The midpoint of a step, in the block's own order.
#[derive(Clone, Copy, Debug)]
pub struct Local<L, const Q: usize, const S: usize, const U: usize> {
    /// Coordinates (rad or m).
    pub q: [L; Q],
    /// Rates.
    pub v: [L; Q],
    /// Time (s).
    pub t: L,
    /// Step (s); read by the Newton matrix alone.
    pub h: L,
    /// Natural lengths (m).
    pub rest: [L; S],
    /// Inputs.
    pub inputs: [L; U],
}

/// Equations of like blocks of `N` coordinates; `M` = N² entries in their matrices by rows.
///
/// `constants` holds [`Shape::CONSTANTS`] numbers for every lane, the lanes of one constant side by
/// side. Entries that are zero by structure are not written.
pub trait Shape<const N: usize, const M: usize, const Q: usize, const S: usize, const U: usize> {
    /// How many numbers differ between blocks or depend on parameters.
    const CONSTANTS: usize;
    /// Internal coordinates of a block by place ([`crate::internal`]).
    const INTERNAL: &'static [usize] = &[];

    /// Momentum ∂L/∂q̇ and force ∂L/∂q + F.
    fn evaluate<L: Lane>(
        at: &Local<L, Q, S, U>,
        constants: &[f64],
        momentum: &mut [L; N],
        force: &mut [L; N],
    );
    /// As [`Shape::evaluate`], and the Newton matrix.
    fn evaluate_with_matrix<L: Lane>(
        at: &Local<L, Q, S, U>,
        constants: &[f64],
        momentum: &mut [L; N],
        force: &mut [L; N],
        matrix: &mut [L; M],
    );
    /// Mass matrix.
    fn mass_matrix<L: Lane>(q: &[L; Q], constants: &[f64], matrix: &mut [L; M]);
    /// Lengths of the strands (m).
    fn lengths<L: Lane>(q: &[L; Q], constants: &[f64], lengths: &mut [L; S]);
}

impl<const Q: usize, const S: usize, const U: usize> Place<Q, S, U> {
    /// The block's own numbers out of the model's.
    #[inline(always)]
    fn local(&self, at: &Midpoint, h: f64) -> Local<f64, Q, S, U> {
        Local {
            q: self.coordinates.map(|c| at.q[c]),
            v: self.coordinates.map(|c| at.v[c]),
            t: at.t,
            h,
            rest: self.strands.map(|s| at.rest[s]),
            inputs: self.inputs.map(|u| at.inputs[u]),
        }
    }

    /// Momentum and force of the block, into the model's vectors.
    pub fn evaluate<Sh: Shape<N, M, Q, S, U>, const N: usize, const M: usize>(
        &self,
        at: &Midpoint,
        constants: &[f64],
        momentum: &mut [f64],
        force: &mut [f64],
    ) {
        let (mut p, mut f) = ([0.0; N], [0.0; N]);
        Sh::evaluate(&self.local(at, 0.0), constants, &mut p, &mut f);
        self.scatter(&p, momentum);
        self.scatter(&f, force);
    }

    /// As [`Place::evaluate`], and the Newton matrix into the block's own part of the packed one,
    /// which holds zeros where the structure has them.
    pub fn evaluate_with_matrix<Sh: Shape<N, M, Q, S, U>, const N: usize, const M: usize>(
        &self,
        at: &Midpoint,
        h: f64,
        constants: &[f64],
        momentum: &mut [f64],
        force: &mut [f64],
        matrix: &mut [f64],
    ) {
        let (mut p, mut f) = ([0.0; N], [0.0; N]);
        let matrix = sized_mut(&mut matrix[self.matrix..]);
        Sh::evaluate_with_matrix(&self.local(at, h), constants, &mut p, &mut f, matrix);
        self.scatter(&p, momentum);
        self.scatter(&f, force);
    }

    /// Mass matrix of the block.
    pub fn mass_matrix<Sh: Shape<N, M, Q, S, U>, const N: usize, const M: usize>(
        &self,
        q: &[f64],
        constants: &[f64],
        matrix: &mut [f64],
    ) {
        let matrix = sized_mut(&mut matrix[self.matrix..]);
        Sh::mass_matrix(&self.coordinates.map(|c| q[c]), constants, matrix);
    }

    /// Lengths of the block's strands, into the model's vector.
    pub fn lengths<Sh: Shape<N, M, Q, S, U>, const N: usize, const M: usize>(
        &self,
        q: &[f64],
        constants: &[f64],
        lengths: &mut [f64],
    ) {
        let mut own = [0.0; S];
        Sh::lengths(&self.coordinates.map(|c| q[c]), constants, &mut own);
        for (&strand, length) in self.strands.iter().zip(own) {
            lengths[strand] = length;
        }
    }

    fn scatter<const N: usize>(&self, own: &[f64; N], all: &mut [f64]) {
        for (&c, value) in self.coordinates.iter().zip(own) {
            all[c] = *value;
        }
    }
}
