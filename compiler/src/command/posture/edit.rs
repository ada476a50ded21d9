//! Changes of a mechanism that the command line asks for.

use super::Load;
use handc_runtime::expression::{Function, Operation, Program};
use handc_runtime::mechanism::{ConstraintKind, Force, Law, Mechanism, Number, Point};

/// A number that depends on nothing.
pub(crate) fn number(value: f64) -> Number {
    Number::Constant(value)
}

fn constant(value: f64) -> Function {
    let program = Program { operations: vec![Operation::Constant(value)], outputs: vec![0] };
    Function { program, gradient: Vec::new() }
}

/// Adds a force at a frame's origin, in world axes.
pub(crate) fn load(mechanism: &mut Mechanism, load: &Load) {
    let frame = &mechanism.frames[load.frame];
    let point = Point { link: frame.link, position: frame.link_from_frame.translation };
    mechanism.forces.push(Force {
        name: format!("load on {}", frame.name),
        source: String::new(),
        point,
        value: load.force.map(constant),
        axes: None,
    });
}

/// Lets a strand make no force, so that it is only measured.
pub(crate) fn without_force(mechanism: &mut Mechanism, strand: usize) {
    set_law(mechanism, strand, Law::Linear { stiffness: Number::ZERO });
}

/// Commands the tension of a strand (N).
pub(crate) fn commanded(mechanism: &mut Mechanism, strand: usize, tension: f64) {
    set_law(mechanism, strand, Law::Tension(constant(tension)));
}

fn set_law(mechanism: &mut Mechanism, strand: usize, law: Law) {
    let prescribed = ConstraintKind::Length(strand as u32);
    mechanism.constraints.retain(|constraint| constraint.kind != prescribed);
    if let Law::Muscle(muscle) = &mechanism.strands[strand].law {
        // Fibres and activation have no part in it any more: they stay.
        for c in [muscle.fibre, muscle.activation] {
            let coordinate = &mut mechanism.coordinates[c as usize];
            let stays = Program {
                operations: vec![Operation::Constant(match coordinate.start {
                    Number::Constant(value) => value,
                    Number::Value(_) => 0.0,
                })],
                outputs: vec![0],
            };
            coordinate.drive = Some(stays);
        }
    }
    let changed = &mut mechanism.strands[strand];
    changed.law = law;
    changed.damping = Number::ZERO;
    changed.slack = None;
}
