//! Shapes: the step equations that like parts of blocks share.
//!
//! The fingers of a hand obey the same equations with other constants. A compiled model writes them
//! once, generic over the [`Lane`], and says for each part of a block where its numbers stand
//! ([`Place`]) and what its constants are. A part is what the Newton matrix couples without the help
//! of constraints; a block without constraints is one part. Here is how one part is evaluated number
//! by number; a private module works on several at once.

use crate::array::sized_mut;
use crate::lane::Lane;
use crate::model::Midpoint;
use crate::newton::factors::{self, SMALL_PIVOT};

/// Of a block of at most so many unknowns the Newton matrix is made anew and factored in every step on
/// lanes; where there are more, factors without structure would cost more than further evaluations.
pub const FEW: usize = 6;

/// Pivots that have shrunk by more than this want pivoting.
const MOST_SHRINKAGE: f64 = 1.0 / SMALL_PIVOT;

/// Where the numbers of a part stand in the model's vectors.
///
/// `Q` coordinates, of which the part's own come first and others that it reads after them; `S`
/// strands; `U` inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place<const Q: usize, const S: usize, const U: usize> {
    /// Coordinates by index.
    pub coordinates: [usize; Q],
    /// Strands by index.
    pub strands: [usize; S],
    /// Inputs by index.
    pub inputs: [usize; U],
    /// Where the part's matrix starts in packed storage.
    pub matrix: usize,
    /// How far its rows are apart there: the number of coordinates of its block.
    pub width: usize,
}

/// The midpoint of a step, in the part's own order.
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

/// Equations of like parts of `N` coordinates; `M` = N² entries in their matrices by rows.
///
/// `constants` holds [`Shape::CONSTANTS`] numbers for every lane, the lanes of one constant side by
/// side. Entries that are zero by structure are not written.
pub trait Shape<const N: usize, const M: usize, const Q: usize, const S: usize, const U: usize> {
    /// How many numbers differ between parts or depend on parameters.
    const CONSTANTS: usize;
    /// Internal coordinates of a block by place ([`crate::internal`]).
    const INTERNAL: &'static [usize] = &[];
    /// Whether the Newton matrix is made anew and factored in every step on lanes, and leads to its end in
    /// one correction: where unknowns are few, or where the matrix has few entries, if the block has no
    /// constraints.
    const DIRECT: bool = N <= FEW;

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
    /// By how much the momentum changes with the increment, M/h + ½∂p/∂q; asked only where
    /// [`Shape::DIRECT`] holds and the block has no constraints.
    fn momentum_matrix<L: Lane>(at: &Local<L, Q, S, U>, constants: &[f64], matrix: &mut [L; M]);
    /// Lengths of the strands (m).
    fn lengths<L: Lane>(q: &[L; Q], constants: &[f64], lengths: &mut [L; S]);

    /// Factors of the Newton matrix for [`Shape::solve`], in an order of the shape's own; returns the lanes,
    /// as bits, where no pivot was small.
    #[inline(always)]
    fn factor<L: Lane>(matrix: &[L; M], factors: &mut [L; M]) -> u8 {
        factors::factor::<L, N, M>(matrix, factors)
    }
    /// The step that the matrix makes of a residual.
    #[inline(always)]
    fn solve<L: Lane>(factors: &[L; M], residual: &[L; N], step: &mut [L; N]) {
        factors::solve::<L, N, M>(factors, residual, step);
    }
    /// Σ|Jᵢⱼ|·size(j) of each row of the Newton matrix.
    #[inline(always)]
    fn sensitivities<L: Lane>(matrix: &[L; M], size: &[L; N], sensitivity: &mut [L; N]) {
        factors::row_sizes::<L, N, M>(matrix, size, sensitivity);
    }
    /// What a step makes of [`Shape::momentum_matrix`].
    #[inline(always)]
    fn momentum_change<L: Lane>(matrix: &[L; M], step: &[L; N], change: &mut [L; N]) {
        factors::product::<L, N, M>(matrix, step, change);
    }
}

/// Lanes, as bits, where no pivot has shrunk so far that pivoting would be wanted.
#[inline(always)]
pub fn is_sound<L: Lane>(shrinkage: L) -> u8 {
    shrinkage.less(L::splat(MOST_SHRINKAGE))
}

impl<const Q: usize, const S: usize, const U: usize> Place<Q, S, U> {
    /// The part's own numbers out of the model's.
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

    /// Momentum and force of the part, into the model's vectors.
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

    /// As [`Place::evaluate`], and the Newton matrix into the part's own entries of the packed one,
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
        self.with_entries::<N, M>(matrix, |matrix| {
            Sh::evaluate_with_matrix(&self.local(at, h), constants, &mut p, &mut f, matrix);
        });
        self.scatter(&p, momentum);
        self.scatter(&f, force);
    }

    /// Mass matrix of the part.
    pub fn mass_matrix<Sh: Shape<N, M, Q, S, U>, const N: usize, const M: usize>(
        &self,
        q: &[f64],
        constants: &[f64],
        matrix: &mut [f64],
    ) {
        let q = self.coordinates.map(|c| q[c]);
        self.with_entries::<N, M>(matrix, |matrix| Sh::mass_matrix(&q, constants, matrix));
    }

    /// Lets the part's entries of a packed matrix be written.
    #[inline(always)]
    fn with_entries<const N: usize, const M: usize>(
        &self,
        matrix: &mut [f64],
        write: impl FnOnce(&mut [f64; M]),
    ) {
        let matrix = &mut matrix[self.matrix..];
        if self.width == N {
            write(sized_mut(matrix));
            return;
        }
        let mut own = [0.0; M];
        write(&mut own);
        for (own, row) in own.chunks_exact(N).zip(matrix.chunks_mut(self.width)) {
            row[..N].copy_from_slice(own);
        }
    }

    /// Lengths of the part's strands, into the model's vector.
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
