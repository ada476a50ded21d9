//! Coordinates that nothing holds, and starts outside limits.

use super::Context;
use handc_core::model::Model;
use handc_dsl::diagnostic::Diagnostic;
use handc_dsl::hir;
use handc_runtime::expression::Variable;
use handc_runtime::mechanism::Role;
use handc_runtime::resolved::Resolved;
use handc_runtime::structure::Structure;

/// Starts outside limits, the joints' own and those of scenarios.
pub(super) fn limits(context: &Context, found: &mut Vec<Diagnostic>) {
    let numbers = Resolved::new(context.mechanism, context.interpreter.params());
    let range = |c: usize| {
        context.mechanism.coordinates[c].limits.map(|l| l.map(|number| numbers.number(number)))
    };
    let mut tell = |c: usize, value: f64, span, whose: &str| {
        let Some([low, high]) = range(c) else { return };
        let slack = 1e-12 * (high - low).abs();
        if value < low - slack || value > high + slack {
            let unit = context.mechanism.coordinates[c].unit();
            found.push(
                Diagnostic::warning(
                    "start-outside-limits",
                    span,
                    format!("{whose} `{}` outside its limits", context.name(c)),
                )
                .label(format!("{value:.4} {unit}, limits {low:.4} to {high:.4} {unit}")),
            );
        }
    };
    for (c, coordinate) in context.model.coordinates.iter().enumerate() {
        if coordinate.drive.is_none() {
            let value = numbers.number(context.mechanism.coordinates[c].start);
            tell(c, value, coordinate.start.span, "the model starts");
        }
    }
    for (scenario, lowered) in context.model.scenarios.iter().zip(&context.mechanism.scenarios) {
        for ((id, expr), (_, number)) in scenario.start.iter().zip(&lowered.start) {
            let whose = format!("scenario `{}` starts", scenario.name.text);
            tell(id.index(), numbers.number(*number), expr.span, &whose);
        }
    }
}

/// Joints that a quasi-static strand spans beside others that none spans.
pub(super) fn half_static(context: &Context, found: &mut Vec<Diagnostic>) {
    let structure = Structure::new(context.mechanism);
    for (coordinate, others) in structure.half_static(context.mechanism) {
        let strands = context.model.strands.iter().zip(&structure.strands);
        let mut spanning =
            strands.filter(|(s, p)| s.quasi_static && p.coordinates.contains(&coordinate));
        let Some((strand, _)) = spanning.next() else { continue };
        let others: Vec<String> =
            others.iter().map(|&c| format!("`{}`", context.name(c))).collect();
        found.push(
            Diagnostic::error(
                "half-static",
                strand.name.span,
                format!(
                    "`{}` makes `{}` quasi-static, but not {}, where the same matter moves",
                    strand.name.text,
                    context.name(coordinate),
                    others.join(", ")
                ),
            )
            .help(
                "inertia is left out of a whole tree or not at all: give `quasi_static = true` to a \
                 strand over each of these joints, or drive them",
            ),
        );
    }
}

/// Coordinates whose joint moves no mass, and that nothing else holds. Returns whether all are held.
pub(super) fn held(context: &Context, found: &mut Vec<Diagnostic>) -> bool {
    let mechanism = context.mechanism;
    let structure = Structure::new(mechanism);
    let n = mechanism.coordinates.len();
    let mut by_mass = vec![false; n];
    for link in 0..structure.links() {
        by_mass[structure.coordinate_of[link]] = structure.has_mass_below[link];
    }
    let mut otherwise = vec![false; n];
    for strand in &structure.strands {
        strand.coordinates.iter().for_each(|&c| otherwise[c] = true);
    }
    for constraint in &mechanism.constraints {
        let coordinates = structure.constraint_coordinates(&constraint.kind);
        coordinates.iter().for_each(|&c| otherwise[c] = true);
    }
    for torque in &mechanism.torques {
        let c = torque.coordinate as usize;
        otherwise[c] |= torque
            .value
            .gradient
            .iter()
            .any(|v| *v == Variable::Coordinate(c as u32) || *v == Variable::Rate(c as u32));
    }
    for (c, coordinate) in mechanism.coordinates.iter().enumerate() {
        let spring = !coordinate.stiffness.is_zero() || !coordinate.damping.is_zero();
        otherwise[c] |= spring || coordinate.drive.is_some() || structure.is_internal[c];
    }
    for scenario in &mechanism.scenarios {
        // Driven in every scenario is held; in some, the others will say so when they run.
        scenario.drives.iter().for_each(|(c, _)| otherwise[*c as usize] = true);
    }
    let mut all = true;
    // Nodes are looked at on their own.
    let is_node = |c: usize| mechanism.coordinates[c].role == Role::Node;
    for c in (0..n).filter(|&c| !by_mass[c] && !otherwise[c] && !is_node(c)) {
        all = false;
        let name = context.name(c);
        let hir::Owner::Joint(joint) = context.model.coordinates[c].owner else { continue };
        let joint = &context.model.joints[joint.index()];
        found.push(
            Diagnostic::error(
                "nothing-moves",
                joint.name.span,
                format!("`{name}` moves nothing: no mass, strand or constraint holds it"),
            )
            .label("this joint carries no mass")
            .help(format!(
                "give it matter: `mass body in {} {{ mass = …; }}`, or a strand or a stiffness",
                joint.name.text
            )),
        );
    }
    all
}
