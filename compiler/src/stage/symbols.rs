//! The unknowns of a model, and its mechanics over them.

use crate::graph::{Leaf, Sym};
use handc_runtime::expression::{Program, StrandQuantity, Variable};
use handc_runtime::mechanics::{At, Mechanics, Workspace};
use handc_runtime::mechanism::Mechanism;
use handc_runtime::resolved::Resolved;
use handc_runtime::structure::Structure;

/// A leaf for every number that varies.
#[derive(Debug)]
pub struct Symbols<'a> {
    /// The model.
    pub mechanism: &'a Mechanism,
    /// Its shape.
    pub structure: &'a Structure,
    /// Its numbers, with parameters as leaves.
    pub numbers: Resolved<Sym>,
    /// Coordinates.
    pub q: Vec<Sym>,
    /// Rates.
    pub v: Vec<Sym>,
    /// Natural lengths.
    pub rest: Vec<Sym>,
    /// Inputs.
    pub inputs: Vec<Sym>,
}

fn leaves(count: usize, leaf: impl Fn(u32) -> Leaf) -> Vec<Sym> {
    (0..count as u32).map(|index| Sym::leaf(leaf(index))).collect()
}

impl<'a> Symbols<'a> {
    /// Makes the leaves in the current graph.
    pub fn new(mechanism: &'a Mechanism, structure: &'a Structure) -> Self {
        let params = leaves(mechanism.params.len(), Leaf::Param);
        Symbols {
            mechanism,
            structure,
            numbers: Resolved::new(mechanism, &params),
            q: leaves(mechanism.coordinates.len(), Leaf::Q),
            v: leaves(mechanism.coordinates.len(), Leaf::V),
            rest: leaves(mechanism.strands.len(), Leaf::Rest),
            inputs: leaves(mechanism.inputs.len(), Leaf::Input),
        }
    }

    /// The mechanics over the symbols.
    pub fn mechanics(&self) -> Mechanics<'_, Sym> {
        Mechanics { mechanism: self.mechanism, structure: self.structure, numbers: &self.numbers }
    }

    /// Scratch space for it.
    pub fn workspace(&self) -> Workspace<Sym> {
        Workspace::new(self.structure)
    }

    /// Where forces are evaluated.
    pub fn at(&self) -> At<'_, Sym> {
        At {
            q: &self.q,
            v: &self.v,
            t: Sym::leaf(Leaf::Time),
            rest: &self.rest,
            inputs: &self.inputs,
        }
    }

    /// The results of a program; strand lengths are worked out from the coordinates.
    pub fn evaluate(&self, program: &Program) -> Vec<Sym> {
        let reads_lengths =
            program.variables().iter().any(|variable| matches!(variable, Variable::Length(_)));
        let mut lengths = vec![Sym::leaf(Leaf::Time); self.mechanism.strands.len()];
        if reads_lengths {
            self.mechanics().strand_lengths(&mut self.workspace(), &self.q, &mut lengths);
        }
        let reads_states =
            program.variables().iter().any(|variable| matches!(variable, Variable::Strand(..)));
        let none = [Sym::leaf(Leaf::Time); StrandQuantity::COUNT];
        let mut states = vec![none; self.mechanism.strands.len()];
        if reads_states {
            let mechanics = self.mechanics();
            mechanics.strand_states(&mut self.workspace(), &self.at(), &mut states);
            for &(row, strand) in &self.structure.prescribed {
                let impulse = Sym::leaf(Leaf::Lambda(row as u32));
                states[strand][StrandQuantity::Tension as usize] = impulse / Sym::leaf(Leaf::Step);
            }
        }
        let read = |variable| match variable {
            Variable::Length(strand) => lengths[strand as usize],
            Variable::Strand(quantity, strand) => states[strand as usize][quantity as usize],
            other => Sym::leaf(crate::graph::leaf(other)),
        };
        let mut values = Vec::new();
        program.evaluate(read, &mut values);
        (0..program.outputs.len()).map(|index| program.output(&values, index)).collect()
    }
}
