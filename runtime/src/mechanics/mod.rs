//! The mechanics: discrete Euler-Lagrange residual and Newton matrix over any scalar.
//!
//! Written once. [`Mechanics`] borrows a mechanism, its structure and its numbers; each file below
//! adds one kind of term to the momentum, the force and the Newton matrix
//!
//! −M/h + ½(L_qv − L_vq) + (h/4)(L_qq + F_q) + ½F_v
//!
//! of the midpoint rule. Vectors are indexed by coordinate; matrices are packed by block
//! ([`Structure::slot`]).

pub mod constraint;
pub mod energy;
pub mod force;
mod friction;
pub mod inertia;
pub mod joint;
mod law;
mod muscle;
mod ramp;
mod run;
pub mod segment;
pub mod strand;
pub mod world;
mod wrap;

use crate::mechanism::Mechanism;
use crate::resolved::Resolved;
use crate::structure::{Pair, Structure};
use handc_core::scalar::Scalar;

/// A mechanism ready to be evaluated over the scalar `S`.
#[derive(Clone, Copy, Debug)]
pub struct Mechanics<'a, S> {
    /// Constant data.
    pub mechanism: &'a Mechanism,
    /// Its shape.
    pub structure: &'a Structure,
    /// Its numbers.
    pub numbers: &'a Resolved<S>,
}

/// Where forces are evaluated; see `handc_core::model::Midpoint`.
#[derive(Clone, Copy, Debug)]
pub struct At<'a, S> {
    /// Coordinates.
    pub q: &'a [S],
    /// Rates.
    pub v: &'a [S],
    /// Time.
    pub t: S,
    /// Natural length of every strand.
    pub rest: &'a [S],
    /// Inputs.
    pub inputs: &'a [S],
}

/// What an evaluation adds to.
#[derive(Debug)]
pub struct Terms<'a, S> {
    /// Momentum ∂L/∂q̇.
    pub momentum: &'a mut [S],
    /// Force ∂L/∂q + F.
    pub force: &'a mut [S],
    /// Step and packed Newton matrix, if wanted.
    pub matrix: Option<(S, &'a mut [S])>,
}

impl<S: Scalar> Terms<'_, S> {
    /// Adds `value` at (i, j), if a matrix is wanted and both coordinates are dynamic.
    #[inline]
    fn add(&mut self, structure: &Structure, i: usize, j: usize, value: S) {
        if let (Some((_, matrix)), Some(slot)) = (&mut self.matrix, structure.slot(i, j)) {
            matrix[slot] += value;
        }
    }
    /// Adds `even + odd` at (i, j) and `even − odd` at (j, i), before [`Terms::unfold`].
    #[inline]
    fn add_pair(&mut self, pair: Option<Pair>, even: S, odd: S) {
        if let (Some((_, matrix)), Some(pair)) = (&mut self.matrix, pair) {
            matrix[pair.even] += even;
            matrix[pair.odd] += if pair.is_above { -odd } else { odd };
        }
    }
    /// Turns even parts below the diagonals and odd parts above them into the matrix. What is even
    /// by nature is so summed once and not twice.
    fn unfold(&mut self, structure: &Structure) {
        let Some((_, matrix)) = &mut self.matrix else { return };
        for block in &structure.blocks {
            let count = block.coordinates.len();
            for i in 1..count {
                for j in 0..i {
                    let lower = block.matrix_offset + i * count + j;
                    let upper = block.matrix_offset + j * count + i;
                    let (even, odd) = (matrix[lower], matrix[upper]);
                    matrix[lower] = even + odd;
                    matrix[upper] = even - odd;
                }
            }
        }
    }
}

/// Scratch space of the kernels, allocated once.
#[derive(Clone, Debug)]
pub struct Workspace<S> {
    pub(crate) sin_cos: Vec<(S, S)>,
    pub(crate) inertia: inertia::Scratch<S>,
    pub(crate) run: run::Scratch<S>,
    pub(crate) strand: strand::Scratch<S>,
    pub(crate) world: Vec<world::WorldLink<S>>,
    pub(crate) values: Vec<S>,
}

impl<S: Scalar> Workspace<S> {
    /// For a mechanism of the given shape.
    pub fn new(structure: &Structure) -> Self {
        Workspace {
            sin_cos: vec![(S::zero(), S::one()); structure.links()],
            inertia: inertia::Scratch::new(structure.links()),
            run: run::Scratch::new(),
            strand: strand::Scratch::new(structure),
            world: vec![world::WorldLink::default(); structure.links()],
            values: Vec::new(),
        }
    }
}

impl<S: Scalar> Mechanics<'_, S> {
    /// The numbers of the mechanism's requirements.
    pub fn required_numbers(&self, numbers: &mut [S]) {
        for (slot, requirement) in numbers.iter_mut().zip(&self.mechanism.requirements) {
            *slot = self.numbers.number(requirement.number);
        }
    }

    /// Momentum and force at a midpoint, and the Newton matrix where a step `h` is given.
    /// All outputs are overwritten.
    pub fn evaluate(
        &self,
        workspace: &mut Workspace<S>,
        at: &At<S>,
        momentum: &mut [S],
        force: &mut [S],
        matrix: Option<(S, &mut [S])>,
    ) {
        momentum.fill(S::zero());
        force.fill(S::zero());
        let mut terms = Terms { momentum, force, matrix };
        if let Some((_, matrix)) = &mut terms.matrix {
            matrix.fill(S::zero());
        }
        self.prepare(workspace, at.q);
        self.add_inertia(workspace, at.q, at.v, &mut terms);
        self.add_strands(workspace, at, &mut terms);
        terms.unfold(self.structure);
        self.add_joints(at, &mut terms);
        self.add_torques(workspace, at, &mut terms);
        self.add_forces(workspace, at, &mut terms);
    }

    /// Sine and cosine of every rotating coordinate.
    pub(crate) fn prepare(&self, workspace: &mut Workspace<S>, q: &[S]) {
        for (link, joint) in self.numbers.joints.iter().enumerate() {
            if joint.rotates {
                workspace.sin_cos[link] = q[self.structure.coordinate_of[link]].sin_cos();
            }
        }
    }
}
