//! A mechanism as tables: what a generated crate holds where straight lines would be too many.
//!
//! Loops of the mechanics run over the mechanism as constant data, as in the interpreter. What a step
//! asks for needs no memory of its own; what a user asks for may be asked of a shared reference and
//! takes its room as it goes.

use crate::interpreter::Interpreter;
use crate::mechanics::{Mechanics, Workspace};
use crate::mechanism::Mechanism;
use std::ops::{Deref, DerefMut};
use std::sync::Arc;

/// A mechanism with its numbers, ready to be evaluated.
#[derive(Clone, Debug)]
pub struct Tables(Interpreter);

impl Tables {
    /// With the mechanism's own parameters.
    pub fn new(mechanism: Mechanism) -> Self {
        Tables(Interpreter::new(Arc::new(mechanism)))
    }

    /// Lengths of all strands at q (m).
    pub fn lengths_at(&self, q: &[f64], lengths: &mut [f64]) {
        let (mechanics, mut workspace) = self.mechanics();
        mechanics.strand_lengths(&mut workspace, q, lengths);
    }

    /// Moment arms ∂length/∂q of all strands at q (m/rad or 1), s × n by rows.
    pub fn moment_arms_at(&self, q: &[f64], arms: &mut [f64]) {
        let (mechanics, mut workspace) = self.mechanics();
        mechanics.moment_arms(&mut workspace, q, arms);
    }

    /// Rotation by rows, then origin (m), of every frame in the world at q: twelve numbers each.
    pub fn poses_at(&self, q: &[f64], poses: &mut [f64]) {
        let (mechanics, mut workspace) = self.mechanics();
        let found = mechanics.frame_poses(&mut workspace, q);
        for (numbers, pose) in poses.chunks_exact_mut(12).zip(found) {
            numbers[..9].copy_from_slice(pose.rotation.0.as_flattened());
            numbers[9..].copy_from_slice(&pose.translation.0);
        }
    }

    fn mechanics(&self) -> (Mechanics<'_, f64>, Workspace<f64>) {
        let Tables(interpreter) = self;
        (interpreter.equations(), Workspace::new(interpreter.structure()))
    }
}

impl Deref for Tables {
    type Target = Interpreter;
    fn deref(&self) -> &Interpreter {
        &self.0
    }
}

impl DerefMut for Tables {
    fn deref_mut(&mut self) -> &mut Interpreter {
        &mut self.0
    }
}
