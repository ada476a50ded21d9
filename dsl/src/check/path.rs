//! Paths of strands: points, and the surfaces wrapped between them.

use super::depend::May;
use super::range::POSITIVE;
use super::scope::ScopeId;
use super::{Checker, constant};
use crate::ast::{PathOption, Station, Wrap};
use crate::diagnostic::Diagnostic;
use crate::dimension::Dimension;
use crate::hir::{self, Surface, Vector};
use crate::source::Span;
use crate::suggest::nearest;

const SURFACES: [&str; 2] = ["sphere", "cylinder"];

/// What is said of a surface, as far as it could be read.
#[derive(Default)]
struct Said {
    radius: Option<hir::Expr>,
    axis: Option<Vector>,
    side: Option<Vector>,
    /// Names of the options given, wrong ones too.
    given: Vec<String>,
}

impl<'a> Checker<'a> {
    /// The points of a path and the surfaces between them.
    pub(super) fn path(
        &mut self,
        scope: ScopeId,
        paths: &'a [PathOption],
        broken: bool,
        span: Span,
    ) -> Option<(Vec<hir::Point>, Vec<hir::Wrap>)> {
        for again in paths.iter().skip(1) {
            self.report(
                Diagnostic::error("duplicate", again.span, "`path` is given twice")
                    .also(paths[0].span, "first given here"),
            );
        }
        let Some(path) = paths.first() else {
            if !broken {
                let error = Diagnostic::error("missing-option", span, "a strand needs `path`");
                self.report(error.help("add `path = world (0, 0, 0) mm -> tip;` to its block"));
            }
            return None;
        };
        let is_point = |station: &&Station| matches!(station, Station::Point(_));
        if path.stations.iter().filter(is_point).count() < 2 {
            let message = "a path has at least two points";
            let error = Diagnostic::error("path", path.span, message);
            self.report(error.help("join points with `->`"));
            return None;
        }
        let is_in_order = self.order(&path.stations);
        let (mut points, mut wraps) = (Vec::new(), Vec::new());
        for station in &path.stations {
            match station {
                Station::Point(point) => points.push(self.point(scope, point)),
                Station::Wrap(wrap) => {
                    wraps.push(self.wrap(scope, wrap, points.len().saturating_sub(1)));
                }
            }
        }
        let points: Option<Vec<_>> = points.into_iter().collect();
        let wraps: Option<Vec<_>> = wraps.into_iter().collect();
        points.zip(wraps).filter(|_| is_in_order)
    }

    /// Complains about surfaces that do not stand between two points.
    fn order(&mut self, stations: &'a [Station]) -> bool {
        let before = self.out.len();
        for end in [stations.first(), stations.last()] {
            if let Some(Station::Wrap(wrap)) = end {
                let message = "a path begins and ends with a point";
                let error = Diagnostic::error("path", wrap.span, message);
                self.report(error.help("a surface is wrapped between two points: `A -> via wrap sphere(F, radius = 5 mm) -> B`"));
            }
        }
        for pair in stations.windows(2) {
            if let [Station::Wrap(first), Station::Wrap(second)] = pair {
                let message = "two surfaces follow each other without a point between them";
                self.report(
                    Diagnostic::error("path", second.span, message)
                        .also(first.span, "the strand comes from this one")
                        .help("put a point between them, through which the strand slides"),
                );
            }
        }
        self.out.len() == before
    }

    fn wrap(&mut self, scope: ScopeId, wrap: &'a Wrap, gap: usize) -> Option<hir::Wrap> {
        let center = self.point(scope, &wrap.center);
        let word = &wrap.surface;
        if !SURFACES.contains(&word.text.as_str()) {
            let message = format!("no surface is called `{}`", word.text);
            let help = match nearest(&word.text, SURFACES) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("known are {}", SURFACES.join(", ")),
            };
            self.report(Diagnostic::error("unknown-surface", word.span, message).help(help));
            return None;
        }
        let is_cylinder = word.text == "cylinder";
        let known: &[&str] =
            if is_cylinder { &["radius", "axis", "side"] } else { &["radius", "side"] };
        let said = self.surface_options(scope, wrap, known);
        for need in known.iter().filter(|n| **n != "side" && !said.given.iter().any(|g| g == *n)) {
            let what = &word.text;
            let message = format!("a {what} to be wrapped needs `{need}`");
            let example =
                if is_cylinder { "F, axis = z, radius = 5 mm" } else { "F, radius = 5 mm" };
            let error = Diagnostic::error("missing-option", wrap.span, message);
            self.report(error.help(format!("write `via wrap {what}({example})`")));
        }
        let has_side = said.given.iter().any(|g| g == "side");
        if has_side && said.side.is_none() {
            return None;
        }
        let surface = match said.axis {
            _ if !is_cylinder => Surface::Sphere,
            Some(axis) => {
                if let Some(side) = &said.side
                    && along(side, &axis)
                {
                    let message = "`side` of a cylinder points along its axis";
                    let error = Diagnostic::error("axis", side[0].span.to(side[2].span), message);
                    self.report(error.help("point it from the axis to where the strand passes"));
                }
                Surface::Cylinder { axis }
            }
            None => return None,
        };
        let (center, radius, side) = (center?, said.radius?, said.side);
        Some(hir::Wrap { gap, surface, center, radius, side, span: wrap.span })
    }

    fn surface_options(&mut self, scope: ScopeId, wrap: &'a Wrap, known: &[&str]) -> Said {
        let mut said = Said::default();
        for option in &wrap.options {
            let Some(name) = &option.name else { continue };
            if said.given.contains(&name.text) {
                let message = format!("`{}` is given twice", name.text);
                self.report(Diagnostic::error("duplicate", name.span, message));
                continue;
            }
            let what = &wrap.surface.text;
            match name.text.as_str() {
                other if !known.contains(&other) => {
                    let message = format!("a {what} has no option `{other}`");
                    let help = format!("known are {}", known.join(", "));
                    self.report(Diagnostic::error("unknown-option", name.span, message).help(help));
                }
                "radius" => {
                    let (want, what) = (Dimension::LENGTH, "`radius` of a surface");
                    said.radius = self.expect(scope, &option.value, want, what, May::PARAMS);
                    if let Some(radius) = &said.radius {
                        self.must(radius, POSITIVE, "a radius must be positive");
                    }
                }
                "axis" => said.axis = self.axis(scope, &option.value, "the axis of a cylinder"),
                _ => said.side = self.axis(scope, &option.value, "`side` of a surface"),
            }
            said.given.push(name.text.clone());
        }
        said
    }
}

/// Whether two constant vectors are parallel, but for rounding.
fn along(a: &Vector, b: &Vector) -> bool {
    let numbers = |v: &Vector| -> Option<Vec<f64>> { v.iter().map(constant).collect() };
    let (Some(a), Some(b)) = (numbers(a), numbers(b)) else { return false };
    let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let cross: Vec<f64> =
        (0..3).map(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]).collect();
    norm(&cross) <= 1e-12 * norm(&a) * norm(&b)
}
