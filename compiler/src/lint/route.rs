//! Routes of strands: points that coincide, and joints without a moment arm.

use super::Context;
use handc_core::model::Model;
use handc_dsl::diagnostic::Diagnostic;
use handc_runtime::mechanism::Mechanism;
use handc_runtime::resolved::Resolved;
use handc_runtime::structure::Structure;

/// Poses tried, besides the start.
const TRIES: usize = 6;

/// Looks at every strand at the start and at a few poses around it.
pub(super) fn routes(context: &mut Context, found: &mut Vec<Diagnostic>) {
    let structure = Structure::new(context.mechanism);
    let (n, count) = (structure.count, context.mechanism.strands.len());
    let start = context.start();
    coincident(context, found);
    let mut largest = vec![0.0f64; count * n];
    let mut arms = vec![0.0; count * n];
    let mut finite = vec![true; count];
    for pose in poses(&start) {
        context.interpreter.moment_arms(&pose, &mut arms);
        for (known, arm) in largest.iter_mut().zip(&arms) {
            *known = known.max(arm.abs());
        }
        for (strand, finite) in finite.iter_mut().enumerate() {
            *finite &= arms[strand * n..(strand + 1) * n].iter().all(|x| x.is_finite());
        }
    }
    let scale = context.interpreter.layout().length_scale;
    for (index, strand) in context.model.strands.iter().enumerate() {
        if !finite[index] {
            continue;
        }
        for &c in &structure.strands[index].coordinates {
            let is_rotation = !context.mechanism.coordinates[c].is_length;
            if is_rotation && largest[index * n + c] < 1e-9 * scale {
                let joint = context.name(c).to_string();
                let name = &strand.name.text;
                found.push(
                    Diagnostic::warning(
                        "no-moment-arm",
                        strand.name.span,
                        format!("strand `{name}` has no moment arm about `{joint}`"),
                    )
                    .label(format!("it runs through the axis of `{joint}`"))
                    .help("move a path point off the joint's axis, or leave the point out"),
                );
            }
        }
    }
}

/// The start, and poses around it from a fixed sequence.
pub(super) fn poses(start: &[f64]) -> Vec<Vec<f64>> {
    let golden = 0.618_033_988_749_894_9;
    let mut all = vec![start.to_vec()];
    for k in 1..=TRIES {
        let shift = |i: usize| ((k * 31 + i * 17 + 7) as f64 * golden).fract() - 0.5;
        all.push(start.iter().enumerate().map(|(i, q)| q + 0.6 * shift(i)).collect());
    }
    all
}

/// Consecutive points in one place.
fn coincident(context: &mut Context, found: &mut Vec<Diagnostic>) {
    let start = context.start();
    let world = place(context, &start);
    let scale = context.interpreter.layout().length_scale;
    let tolerance = 1e-9 * scale;
    let mechanism: &Mechanism = context.mechanism;
    for (strand, lowered) in context.model.strands.iter().zip(&mechanism.strands) {
        for (i, pair) in lowered.points.windows(2).enumerate() {
            // A strand that goes round a surface may come back to where it was.
            if lowered.wrap(i).is_some() {
                continue;
            }
            let (a, b) =
                (world(pair[0].link, pair[0].position), world(pair[1].link, pair[1].position));
            let distance = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
            if distance > tolerance {
                continue;
            }
            let (first, second) = (&strand.path[i], &strand.path[i + 1]);
            let message =
                format!("two consecutive points of `{}` are in one place", strand.name.text);
            let diagnostic = if pair[0].link == pair[1].link {
                Diagnostic::warning("coincident-points", second.span, message)
                    .help("leave one of them out")
            } else {
                Diagnostic::error("coincident-points", second.span, message).help(
                    "between two moving frames the length of such a segment has no derivative; \
                     move one of the points",
                )
            };
            found.push(diagnostic.also(first.span, "the same place at the start"));
        }
    }
}

type Placer<'a> = Box<dyn Fn(Option<u32>, [handc_runtime::mechanism::Number; 3]) -> [f64; 3] + 'a>;

/// World positions of points at q.
fn place<'a>(context: &mut Context<'a>, q: &[f64]) -> Placer<'a> {
    let mechanism = context.mechanism;
    let numbers = Resolved::new(mechanism, context.interpreter.params());
    let poses = context.interpreter.link_poses(q);
    Box::new(move |link, position| {
        let p = numbers.vector(&position);
        match link {
            Some(link) => poses[link as usize].point(p).0,
            None => p.0,
        }
    })
}
