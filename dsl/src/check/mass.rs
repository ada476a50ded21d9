//! Masses: given by numbers or by shape.

use super::depend::May;
use super::options::Options;
use super::range::{NOT_NEGATIVE, POSITIVE};
use super::scope::ScopeId;
use super::{Checker, constant, zero_vector};
use crate::ast::{DeclKind, Shape};
use crate::diagnostic::Diagnostic;
use crate::dimension::Dimension;
use crate::hir::{self, Amount, Expr, MassKind, Vector};
use crate::source::Span;
use crate::suggest::nearest;

/// Options of a shape.
#[rustfmt::skip]
const SHAPES: [(&str, &[&str]); 4] = [
    ("sphere", &["radius", "at", "density", "mass"]),
    ("capsule", &["from", "to", "radius", "density", "mass"]),
    ("cylinder", &["from", "to", "radius", "density", "mass"]),
    ("box", &["size", "at", "density", "mass"]),
];

/// The declaration whose options are read.
struct Body<'o, 'a> {
    scope: ScopeId,
    options: &'o Options<'a>,
    /// What to call it.
    what: &'o str,
    span: Span,
}

impl<'a> Checker<'a> {
    pub(super) fn finish_masses(&mut self) -> Vec<hir::Mass> {
        let mut masses = Vec::new();
        for item in std::mem::take(&mut self.masses) {
            let DeclKind::Mass(frame, shape, block) = &item.decl.kind else { continue };
            let frame = self.frame(item.scope, frame);
            let kind = match shape {
                None => {
                    let options = self.options(block, "a mass", &["mass", "at", "inertia"]);
                    let (scope, what, span) = (item.scope, "a mass", item.name.span);
                    self.explicit(&Body { scope, options: &options, what, span })
                }
                Some(shape) => match SHAPES.iter().find(|s| s.0 == shape.name.text) {
                    Some((name, known)) => {
                        let what = format!("a {name}");
                        let options = self.options(block, &what, known);
                        let (scope, span) = (item.scope, shape.name.span);
                        self.shaped(name, &Body { scope, options: &options, what: &what, span })
                    }
                    None => {
                        self.unknown_shape(shape);
                        None
                    }
                },
            };
            if let (Some(frame), Some(kind)) = (frame, kind) {
                let (frame, span) = (self.frame_ids[frame], item.decl.span);
                masses.push(hir::Mass { name: item.name, frame, kind, span });
            }
        }
        masses
    }

    fn unknown_shape(&mut self, shape: &Shape) {
        let names: Vec<&str> = SHAPES.iter().map(|s| s.0).collect();
        let help = match nearest(&shape.name.text, names.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("known are {}", names.join(", ")),
        };
        let message = format!("unknown shape `{}`", shape.name.text);
        self.report(Diagnostic::error("unknown-shape", shape.name.span, message).help(help));
    }

    fn explicit(&mut self, body: &Body<'_, 'a>) -> Option<MassKind> {
        let mass = self.option(body, "mass", Dimension::MASS, Some("mass = 5 g;"));
        if let Some(mass) = &mass {
            self.must(mass, NOT_NEGATIVE, "a mass cannot be negative");
        }
        let at = self.option_vector(body, "at", Dimension::LENGTH, None);
        let at = at.unwrap_or_else(|| zero_vector(Dimension::LENGTH, body.span));
        let inertia = match body.options.get("inertia") {
            None => None,
            Some(text) => Some(self.inertia(body.scope, text)?),
        };
        Some(MassKind::Explicit { mass: mass?, at, inertia })
    }

    fn inertia(&mut self, scope: ScopeId, text: &'a crate::ast::Expr) -> Option<Box<[Expr; 6]>> {
        let what = "`inertia`";
        let (want, may) = (Dimension::INERTIA, May::PARAMS);
        let long =
            match self.value(scope, text)? {
                super::Value::Vector(items) if items.len() == 6 => true,
                super::Value::Vector(items) if items.len() == 3 => false,
                super::Value::Scalar(e) if super::fold::bare_zero(&e) => false,
                _ => {
                    let message = "`inertia` is a tuple of 3 or 6";
                    self.report(Diagnostic::error("vector", text.span, message).help(
                        "write (Ixx, Iyy, Izz) or (Ixx, Iyy, Izz, Ixy, Ixz, Iyz), then a unit",
                    ));
                    return None;
                }
            };
        let all: [Expr; 6] = if long {
            self.tuple(scope, text, want, what, may)?
        } else {
            let [a, b, c]: [Expr; 3] = self.tuple(scope, text, want, what, may)?;
            let [d, e, f] = zero_vector(want, text.span);
            [a, b, c, d, e, f]
        };
        for moment in &all[..3] {
            self.must(moment, NOT_NEGATIVE, "a moment of inertia cannot be negative");
        }
        Some(Box::new(all))
    }

    fn shaped(&mut self, name: &str, body: &Body<'_, 'a>) -> Option<MassKind> {
        let amount = self.amount(body);
        let length = Dimension::LENGTH;
        let radius = match name {
            "box" => None,
            _ => self.option(body, "radius", length, Some("radius = 9 mm;")),
        };
        if let Some(radius) = &radius {
            self.must(radius, POSITIVE, "a radius must be positive");
        }
        match name {
            "sphere" => {
                let at = self.centre(body);
                Some(MassKind::Sphere { at, radius: radius?, amount: amount? })
            }
            "box" => {
                let at = self.centre(body);
                let size =
                    self.option_vector(body, "size", length, Some("size = (1, 2, 3) cm;"))?;
                for edge in &size {
                    self.must(edge, POSITIVE, "an edge of a box must be positive");
                }
                Some(MassKind::Box { at, size, amount: amount? })
            }
            _ => {
                let from = self.option_vector(body, "from", length, Some("from = (0, 0, 0) mm;"));
                let to = self.option_vector(body, "to", length, Some("to = (40, 0, 0) mm;"));
                let (from, to, radius, amount) = (from?, to?, radius?, amount?);
                let same = |(a, b): (&Expr, &Expr)| {
                    constant(a).zip(constant(b)).is_some_and(|(a, b)| a == b)
                };
                if name == "capsule" {
                    return Some(MassKind::Capsule { from, to, radius, amount });
                }
                if from.iter().zip(&to).all(same) {
                    let message = "`from` and `to` of a cylinder coincide";
                    self.report(Diagnostic::error("value", to[0].span, message));
                }
                Some(MassKind::Cylinder { from, to, radius, amount })
            }
        }
    }

    fn centre(&mut self, body: &Body<'_, 'a>) -> Vector {
        self.option_vector(body, "at", Dimension::LENGTH, None)
            .unwrap_or_else(|| zero_vector(Dimension::LENGTH, body.span))
    }

    /// Density or mass: one of the two.
    fn amount(&mut self, body: &Body<'_, 'a>) -> Option<Amount> {
        let (density, mass) = (body.options.setting("density"), body.options.setting("mass"));
        match (density, mass) {
            (Some(density), Some(mass)) => {
                let message = format!("{} takes `density` or `mass`, not both", body.what);
                self.report(
                    Diagnostic::error("amount", mass.span, message)
                        .also(density.span, "the density"),
                );
                None
            }
            (None, None) => {
                self.missing(
                    body.options,
                    body.span,
                    body.what,
                    "density` or `mass",
                    "density = 1100 kg/m^3;",
                );
                None
            }
            (Some(_), None) => {
                let density = self.option(body, "density", Dimension::DENSITY, None)?;
                self.must(&density, NOT_NEGATIVE, "a density cannot be negative");
                Some(Amount::Density(density))
            }
            (None, Some(_)) => {
                let mass = self.option(body, "mass", Dimension::MASS, None)?;
                self.must(&mass, NOT_NEGATIVE, "a mass cannot be negative");
                Some(Amount::Mass(mass))
            }
        }
    }

    /// A number among the options; `example` is given where it may not be missing.
    fn option(
        &mut self,
        body: &Body<'_, 'a>,
        name: &str,
        want: Dimension,
        example: Option<&str>,
    ) -> Option<Expr> {
        let Some(text) = body.options.get(name) else {
            if let Some(example) = example {
                self.missing(body.options, body.span, body.what, name, example);
            }
            return None;
        };
        let what = format!("`{name}` of {}", body.what);
        self.expect(body.scope, text, want, &what, May::PARAMS)
    }

    fn option_vector(
        &mut self,
        body: &Body<'_, 'a>,
        name: &str,
        want: Dimension,
        example: Option<&str>,
    ) -> Option<Vector> {
        let Some(text) = body.options.get(name) else {
            if let Some(example) = example {
                self.missing(body.options, body.span, body.what, name, example);
            }
            return None;
        };
        let what = format!("`{name}` of {}", body.what);
        self.vector(body.scope, text, want, &what, May::PARAMS)
    }
}
