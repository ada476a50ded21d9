//! Labels for what belongs to one strand or one joint.
//!
//! The kernels know nothing of labels. Equal nodes are one node, so a strand's share of the graph
//! is labelled by evaluating the mechanism with that strand alone first.

use super::symbols::Symbols;
use crate::graph::{Leaf, Sym, with_origin};
use handc_core::scalar::Scalar;
use handc_runtime::mechanics::{At, Mechanics, Workspace};
use handc_runtime::mechanism::Mechanism;
use handc_runtime::resolved::Resolved;
use handc_runtime::structure::Structure;

/// Makes the nodes that belong to one joint or strand, with its name as their origin.
pub(super) fn prepare(mechanism: &Mechanism, symbols: &Symbols) {
    for (coordinate, &q) in mechanism.coordinates.iter().zip(&symbols.q) {
        with_origin(&coordinate.name, || q.sin_cos());
    }
    let bare = Mechanism {
        bodies: Vec::new(),
        strands: Vec::new(),
        constraints: Vec::new(),
        torques: Vec::new(),
        forces: Vec::new(),
        scenarios: Vec::new(),
        ..mechanism.clone()
    };
    for (strand, &rest) in mechanism.strands.iter().zip(&symbols.rest) {
        let alone = Mechanism { strands: vec![strand.clone()], ..bare.clone() };
        with_origin(&strand.name, || evaluate(&alone, symbols, rest));
    }
}

fn evaluate(mechanism: &Mechanism, symbols: &Symbols, rest: Sym) {
    let structure = Structure::new(mechanism);
    let numbers = Resolved::new(mechanism, &symbols.numbers.params);
    let mechanics = Mechanics { mechanism, structure: &structure, numbers: &numbers };
    let at = At { rest: &[rest], ..symbols.at() };
    let size: usize = structure.blocks.iter().map(|b| b.coordinates.len().pow(2)).sum();
    let mut vectors = [0, 1].map(|_| vec![Sym::zero(); structure.count]);
    let mut matrix = vec![Sym::zero(); size];
    let [momentum, force] = &mut vectors;
    let step = Sym::leaf(Leaf::Step);
    let mut workspace = Workspace::new(&structure);
    mechanics.evaluate(&mut workspace, &at, momentum, force, Some((step, &mut matrix)));
}
