//! Bodies: numbers as given, or those of a solid shape.

use super::Lowering;
use crate::graph::Sym;
use handc_core::scalar::Scalar;
use handc_dsl::hir::{Amount, Mass, MassKind};
use handc_runtime::mechanism::Body;
use handc_runtime::vector::{Mat3, Vec3};
use std::f64::consts::PI;

/// Mass, centre and inertia about the centre, in the axes of the frame.
struct Solid {
    mass: Sym,
    center: Vec3<Sym>,
    inertia: Mat3<Sym>,
}

impl Lowering<'_> {
    pub(super) fn body(&mut self, mass: &Mass) -> Body {
        let place = self.places[mass.frame.index()];
        let solid = self.solid(&mass.kind);
        let rotation = place.link_from_frame.rotation;
        let turned = rotation * solid.inertia * rotation.transpose();
        let entries = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
        let center = place.link_from_frame.point(solid.center);
        Body {
            name: mass.name.text.clone(),
            source: self.source(mass.span),
            link: place.link,
            mass: self.number_of(solid.mass),
            center: self.vector_number(center),
            inertia: entries.map(|(i, j)| self.number_of(turned.0[i][j])),
        }
    }

    fn solid(&mut self, kind: &MassKind) -> Solid {
        match kind {
            MassKind::Explicit { mass, at, inertia } => {
                let entries = match inertia {
                    Some(entries) => entries.as_ref().clone().map(|e| self.expr(&e)),
                    None => [Sym::zero(); 6],
                };
                let [xx, yy, zz, xy, xz, yz] = entries;
                Solid {
                    mass: self.expr(mass),
                    center: self.vector(at),
                    inertia: Mat3([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]),
                }
            }
            MassKind::Sphere { at, radius, amount } => {
                let r = self.expr(radius);
                let mass = self.mass(amount, (r * r * r).scale(4.0 / 3.0 * PI));
                let i = (mass * r * r).scale(0.4);
                Solid { mass, center: self.vector(at), inertia: diagonal([i; 3]) }
            }
            MassKind::Box { at, size, amount } => {
                let [x, y, z] = self.vector(size).0;
                let mass = self.mass(amount, x * y * z);
                let moment = |a: Sym, b: Sym| (mass * (a * a + b * b)).scale(1.0 / 12.0);
                let inertia = diagonal([moment(y, z), moment(x, z), moment(x, y)]);
                Solid { mass, center: self.vector(at), inertia }
            }
            MassKind::Cylinder { from, to, radius, amount } => {
                let (a, b, r) = (self.vector(from), self.vector(to), self.expr(radius));
                let length = (b - a).norm_squared().sqrt();
                let mass = self.mass(amount, (r * r * length).scale(PI));
                let axial = (mass * r * r).scale(0.5);
                let across = (mass * ((r * r).scale(3.0) + length * length)).scale(1.0 / 12.0);
                round(mass, a, b, axial, across)
            }
            MassKind::Capsule { from, to, radius, amount } => {
                let (a, b, r) = (self.vector(from), self.vector(to), self.expr(radius));
                let length = (b - a).norm_squared().sqrt();
                let (tube, ball) = ((r * r * length).scale(PI), (r * r * r).scale(4.0 / 3.0 * PI));
                let mass = self.mass(amount, tube + ball);
                let density = mass / (tube + ball);
                let (tube, ball) = (density * tube, density * ball);
                let axial = (tube * r * r).scale(0.5) + (ball * r * r).scale(0.4);
                // A half sphere's centre lies 3r/8 beyond the end of the tube.
                let across = (tube * ((r * r).scale(3.0) + length * length)).scale(1.0 / 12.0)
                    + ball
                        * ((r * r).scale(0.4)
                            + (length * length).scale(0.25)
                            + (length * r).scale(0.375));
                round(mass, a, b, axial, across)
            }
        }
    }

    fn mass(&mut self, amount: &Amount, volume: Sym) -> Sym {
        match amount {
            Amount::Mass(mass) => self.expr(mass),
            Amount::Density(density) => self.expr(density) * volume,
        }
    }
}

fn diagonal([x, y, z]: [Sym; 3]) -> Mat3<Sym> {
    let o = Sym::zero();
    Mat3([[x, o, o], [o, y, o], [o, o, z]])
}

/// A body of revolution about the line from a to b.
fn round(mass: Sym, a: Vec3<Sym>, b: Vec3<Sym>, axial: Sym, across: Sym) -> Solid {
    let axis = super::unit(b - a);
    let mut inertia = diagonal([across; 3]);
    for i in 0..3 {
        for j in 0..3 {
            if i == j && axis.0[i].as_constant() == Some(1.0) {
                inertia.0[i][j] = axial;
            } else {
                inertia.0[i][j] += (axial - across) * axis.0[i] * axis.0[j];
            }
        }
    }
    Solid { mass, center: (a + b).scale(Sym::constant(0.5)), inertia }
}
