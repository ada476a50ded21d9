//! Bodies that no matter can make.

use super::Context;
use handc_core::model::Model;
use handc_dsl::diagnostic::Diagnostic;
use handc_dsl::hir::MassKind;
use handc_runtime::resolved::Resolved;
use nalgebra::{Matrix3, SymmetricEigen};

/// Inertias that break the triangle inequality, and radii of gyration beyond the body.
pub(super) fn bodies(context: &Context, found: &mut Vec<Diagnostic>) {
    let numbers = Resolved::new(context.mechanism, context.interpreter.params());
    for (mass, body) in context.model.masses.iter().zip(&context.mechanism.bodies) {
        let m = numbers.number(body.mass);
        let name = &mass.name.text;
        if m < 0.0 {
            found.push(
                Diagnostic::error("negative-mass", mass.span, format!("`{name}` has mass {m} kg"))
                    .help("a mass is positive"),
            );
            continue;
        }
        let MassKind::Explicit { inertia: Some(_), .. } = &mass.kind else { continue };
        let [xx, yy, zz, xy, xz, yz] = body.inertia.map(|i| numbers.number(i));
        let moments = SymmetricEigen::new(Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz));
        let mut moments: Vec<f64> = moments.eigenvalues.iter().copied().collect();
        moments.sort_by(f64::total_cmp);
        let [a, b, c] = [moments[0], moments[1], moments[2]];
        let slack = 1e-9 * c.abs();
        if a < -slack || a + b < c - slack {
            found.push(
                Diagnostic::warning(
                    "impossible-inertia",
                    mass.span,
                    format!("no body has the inertia of `{name}`"),
                )
                .label(format!("principal moments {a:.3e}, {b:.3e}, {c:.3e} kg*m^2"))
                .help(if a < -slack {
                    "principal moments are not negative; check signs of the products of inertia"
                } else {
                    "the largest principal moment is at most the sum of the others; check the \
                     order (Ixx, Iyy, Izz) and the units"
                }),
            );
            continue;
        }
        let gyration = (c / m).sqrt();
        let size = body_size(context, &numbers, body.link);
        if m > 0.0 && size > 0.0 && gyration > 2.0 * size {
            found.push(
                Diagnostic::warning(
                    "large-gyration",
                    mass.span,
                    format!("the radius of gyration of `{name}` is larger than the body"),
                )
                .label(format!(
                    "{:.1} mm, while what is fixed in its frame reaches {:.1} mm",
                    gyration * 1e3,
                    size * 1e3
                ))
                .help("check the unit of `inertia`: 1 kg*m^2 is 1e9 g*mm^2"),
            );
        }
        if m == 0.0 && c > 0.0 {
            found.push(Diagnostic::warning(
                "inertia-without-mass",
                mass.span,
                format!("`{name}` has inertia but no mass"),
            ));
        }
    }
}

/// How far what is fixed in a link reaches from its origin (m).
fn body_size(context: &Context, numbers: &Resolved<f64>, link: Option<u32>) -> f64 {
    let mechanism = context.mechanism;
    let mut points = Vec::new();
    points.extend(
        mechanism
            .links
            .iter()
            .filter(|l| l.parent == link)
            .map(|l| l.parent_from_joint.translation),
    );
    points.extend(
        mechanism.frames.iter().filter(|f| f.link == link).map(|f| f.link_from_frame.translation),
    );
    points.extend(mechanism.bodies.iter().filter(|b| b.link == link).map(|b| b.center));
    let strands = mechanism.strands.iter().flat_map(|s| &s.points);
    points.extend(strands.filter(|p| p.link == link).map(|p| p.position));
    points.iter().map(|p| numbers.vector(p).norm_squared().sqrt()).fold(0.0, f64::max)
}
