//! Nodes without mass: strands hold them, or nothing does.

use super::Context;
use handc_dsl::diagnostic::Diagnostic;
use handc_dsl::hir::JointKind;
use handc_runtime::structure::Structure;

/// Nodes that no strand holds, or that hang on a single end. Returns whether all are held.
pub(super) fn nodes(context: &Context, found: &mut Vec<Diagnostic>) -> bool {
    let structure = Structure::new(context.mechanism);
    let mut all = true;
    for joint in context.model.joints.iter().filter(|joint| joint.kind == JointKind::Node) {
        let Some(last) = joint.coordinates.last() else { continue };
        let link = structure.link_of[last.index()];
        let Some(first) = structure.link_of[joint.coordinates[0].index()] else { continue };
        if structure.has_mass_below[first as usize] {
            continue;
        }
        // A strand that ends in the node holds it once, one that runs through it twice.
        let mut holds = 0;
        for strand in &context.mechanism.strands {
            let on_node = |point: &handc_runtime::mechanism::Point| point.link == link;
            holds += strand.points.windows(2).filter(|p| on_node(&p[0]) != on_node(&p[1])).count();
        }
        let held = context.mechanism.constraints.iter().any(|constraint| {
            let coordinates = structure.constraint_coordinates(&constraint.kind);
            joint.coordinates.iter().any(|c| coordinates.contains(&c.index()))
        });
        let name = &joint.name.text;
        let (message, help) = match holds {
            _ if held => continue,
            0 => (
                format!("nothing holds the node `{name}`"),
                format!(
                    "let strands end in it or run through it, or give it mass: `node {name} at … {{ mass = 1 g; }}`"
                ),
            ),
            1 => (
                format!(
                    "one strand alone holds the node `{name}`: there is no balance but where it is slack"
                ),
                format!("let a second strand end in `{name}`, or end the first one on a frame"),
            ),
            _ => continue,
        };
        all = false;
        found.push(Diagnostic::error("node-not-held", joint.name.span, message).help(help));
    }
    all
}
