//! Surfaces that strands wrap: whether the strand can pass them, and on which side.

use super::Context;
use handc_core::model::Model;
use handc_dsl::diagnostic::Diagnostic;
use handc_dsl::hir;
use handc_runtime::mechanism::{Point, Strand};
use handc_runtime::resolved::Resolved;
use handc_runtime::surface::Surface;
use handc_runtime::vector::{Transform, Vec3};

/// Cosine between a hint and the middle of a way below which it does not decide.
const UNCLEAR: f64 = 0.1;

/// Looks at every surface at the start and, if that is fine, at the starts and poses of scenarios.
pub(super) fn wraps(context: &mut Context, found: &mut Vec<Diagnostic>) {
    if context.mechanism.strands.iter().all(|strand| strand.wraps.is_empty()) {
        return;
    }
    for (model, strand) in context.model.strands.iter().zip(&context.mechanism.strands) {
        let lost = model
            .wraps
            .iter()
            .zip(&strand.wraps)
            .filter(|(said, wrap)| said.side.is_some() && wrap.side.is_none());
        for (said, _) in lost {
            let name = &model.name.text;
            let message =
                format!("strand `{name}` has no side on its sphere: `side` has no effect");
            let warning = Diagnostic::warning("unclear-side", said.span, message)
                .label("its points do not stay in one plane through the centre");
            found.push(warning.help(
                "over a sphere a strand slides to the shorter way; leave `side` out, or wrap a \
                 cylinder",
            ));
        }
    }
    for (index, (q, place)) in places(context).into_iter().enumerate() {
        let before = found.len();
        look(context, &q, &place, index == 0, found);
        if found.len() > before {
            return;
        }
    }
}

/// The start, then those of scenarios and their poses, with the words for where that is.
fn places(context: &mut Context) -> Vec<(Vec<f64>, String)> {
    let mut start = context.start();
    context.interpreter.drives(0.0, &mut start);
    let numbers = Resolved::<f64>::new(context.mechanism, context.interpreter.params());
    let moved = |from: &[f64], values: &[(u32, _)]| {
        let mut q = from.to_vec();
        values.iter().for_each(|&(c, value)| q[c as usize] = numbers.number(value));
        q
    };
    let mut places = vec![(start.clone(), "at the start".to_string())];
    for scenario in &context.mechanism.scenarios {
        let own = moved(&start, &scenario.start);
        places.push((own.clone(), format!("at the start of scenario `{}`", scenario.name)));
        let is_used = |pose: usize| {
            let mut knots = scenario.motions.iter().flat_map(|(_, knots)| knots);
            knots.any(|knot| knot.0 as usize == pose)
        };
        let poses = scenario.poses.iter().enumerate().filter(|(index, _)| is_used(*index));
        for (_, (pose, values)) in poses {
            places.push((moved(&own, values), format!("in pose `{pose}`")));
        }
    }
    places
}

fn look(
    context: &mut Context,
    q: &[f64],
    place: &str,
    is_start: bool,
    found: &mut Vec<Diagnostic>,
) {
    let numbers = Resolved::<f64>::new(context.mechanism, context.interpreter.params());
    let poses = context.interpreter.link_poses(q);
    for (model, strand) in context.model.strands.iter().zip(&context.mechanism.strands) {
        for (said, wrap) in model.wraps.iter().zip(&strand.wraps) {
            let surface = numbers.surface(strand, wrap);
            let points = ends(&numbers, &poses, strand, wrap.gap as usize, wrap.center.link);
            let ends = [&model.path[said.gap], &model.path[said.gap + 1]];
            let finding = Finding { strand: &model.name.text, said, ends, place };
            let side = wrap.side.map(|side| numbers.vector(&side));
            let decided = || finding.side(&surface, side, points).filter(|_| is_start);
            let wrong = finding.inside(&surface, points);
            found.extend(wrong.or_else(decided).or_else(|| finding.around(&surface, points)));
        }
    }
}

/// The points before and behind a surface, in the axes of the link that carries it.
fn ends(
    numbers: &Resolved<f64>,
    poses: &[Transform<f64>],
    strand: &Strand,
    gap: usize,
    link: Option<u32>,
) -> [Vec3<f64>; 2] {
    let world = |point: &Point| {
        let position = numbers.vector(&point.position);
        point.link.map_or(position, |link| poses[link as usize].point(position))
    };
    [0, 1].map(|k| {
        let point = world(&strand.points[gap + k]);
        link.map_or(point, |link| poses[link as usize].inverse_point(point))
    })
}

/// A surface and what may be said of it.
struct Finding<'a> {
    strand: &'a str,
    said: &'a hir::Wrap,
    ends: [&'a hir::Point; 2],
    place: &'a str,
}

impl Finding<'_> {
    /// A path point in the surface, or two that are opposite each other on a sphere.
    fn inside(&self, surface: &Surface<f64>, points: [Vec3<f64>; 2]) -> Option<Diagnostic> {
        let (strand, place, span) = (self.strand, self.place, self.said.span);
        let [before, behind, apart, _] = surface.clearances(points);
        if surface.radius.is_nan() {
            let message = format!("a surface of strand `{strand}` has a negative radius");
            return Some(Diagnostic::error("inside-surface", self.said.radius.span, message));
        }
        for (clearance, point) in [before, behind].into_iter().zip(self.ends) {
            // On the surface itself the tangent has no length.
            if clearance > 1e-9 * surface.radius {
                continue;
            }
            let message = format!(
                "a path point of strand `{strand}` is inside the surface it wraps, {place}"
            );
            let depth = match -1e3 * clearance {
                depth if depth < 1e-4 => "on it".to_string(),
                depth => format!("{depth:.4} mm inside"),
            };
            let error = Diagnostic::error("inside-surface", span, message);
            return Some(error.also(point.span, depth).help(
                "a strand goes round from outside: make the radius smaller or move the point",
            ));
        }
        if apart > 0.0 {
            return None;
        }
        let message =
            format!("strand `{strand}` runs straight at the centre of its sphere, {place}");
        let error = Diagnostic::error("opposite-points", span, message)
            .label("every way round is equally short")
            .also(self.ends[0].span, "from here")
            .also(self.ends[1].span, "to here");
        Some(
            error
                .help("move one of the points aside, or wrap a cylinder, whose axis tells the way"),
        )
    }

    /// A hint that does not decide, or none where one is needed.
    fn side(
        &self,
        surface: &Surface<f64>,
        hint: Option<Vec3<f64>>,
        points: [Vec3<f64>; 2],
    ) -> Option<Diagnostic> {
        let (strand, place, span) = (self.strand, self.place, self.said.span);
        let flat = |v: Vec3<f64>| surface.form.flat(v);
        let unit = |v: Vec3<f64>| v.scale(1.0 / v.norm_squared().sqrt());
        let [p, q] = points.map(|point| unit(flat(point - surface.center)));
        let Some(hint) = hint else {
            let is_opposite = (p + q).norm_squared() < (2.0 * UNCLEAR).powi(2);
            let message =
                format!("strand `{strand}` might pass its cylinder on either side, {place}");
            let warning = Diagnostic::warning("unclear-side", span, message)
                .label("both ways round are almost equally short");
            return (is_opposite && surface.form.axis().is_some()).then(|| {
                warning.help("say on which side it passes: `side = y`, from the axis to the strand")
            });
        };
        let chord = q - p;
        let normal = surface.form.axis()?.vector();
        // Cosine of the angle to the middle of the nearer way, seen in their plane.
        let cosine = normal.dot(unit(flat(hint)).cross(unit(chord))).abs();
        if !(cosine < UNCLEAR) {
            return None;
        }
        let message =
            format!("`side` does not tell on which side strand `{strand}` passes, {place}");
        let warning = Diagnostic::warning("unclear-side", span, message)
            .label("it is almost at right angles to both ways round");
        Some(warning.help("point it from the centre to the middle of the strand's way"))
    }

    /// A strand that would jump to the other side.
    fn around(&self, surface: &Surface<f64>, points: [Vec3<f64>; 2]) -> Option<Diagnostic> {
        let (strand, place) = (self.strand, self.place);
        (surface.clearances(points)[3] < 0.0).then(|| {
            let message = format!(
                "strand `{strand}` has come too far round its surface from where the model starts, \
                 {place}"
            );
            let error = Diagnostic::error("too-far-round", self.said.span, message)
                .label("it would jump to the other side");
            error.help(
                "the points before and behind may turn against each other by almost half a turn \
                 either way from the model's start; over a sphere `side` serves motions in one plane",
            )
        })
    }
}
