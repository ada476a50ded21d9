//! Each scenario at its start: constraints that depend on each other, and steps too long for the
//! stiffest vibration.

use super::{Context, settings};
use handc_core::error::RunError;
use handc_core::model::Model;
use handc_core::simulation::{Settings, Simulation};
use handc_dsl::diagnostic::Diagnostic;
use handc_dsl::source::Span;
use handc_runtime::analysis::linear::{Held, Linear};
use handc_runtime::analysis::modes::{Mode, modes};
use std::collections::BTreeSet;

/// Beyond this many coordinates the dense decompositions would keep the user waiting.
const LARGEST: usize = 160;

/// Looks at every scenario, or at the bare model if there is none.
pub(super) fn poses(context: &mut Context, found: &mut Vec<Diagnostic>) {
    if context.mechanism.coordinates.len() > LARGEST {
        return;
    }
    let mut said = BTreeSet::new();
    let scenarios = &context.model.scenarios;
    if scenarios.is_empty() {
        let bare = Settings { step: Some(1e-3), duration: Some(1e-3), ..settings(None) };
        look(context, &bare, None, context.model.name.span, &mut said, found);
    }
    for scenario in scenarios {
        let span = scenario.step.as_ref().map_or(scenario.name.span, |step| step.span);
        let mut wanted = settings(Some(&scenario.name.text));
        // A step or duration left to the command line is no reason not to look.
        wanted.step = scenario.step.is_none().then_some(1e-3);
        wanted.duration = scenario.duration.is_none().then_some(1e-3);
        let step = scenario.step.is_some().then_some(span);
        look(context, &wanted, step, scenario.name.span, &mut said, found);
    }
}

fn look(
    context: &mut Context,
    wanted: &Settings,
    step: Option<Span>,
    scenario: Span,
    said: &mut BTreeSet<String>,
    found: &mut Vec<Diagnostic>,
) {
    let simulation = match Simulation::new(context.interpreter.clone(), wanted) {
        Ok(simulation) => simulation,
        Err(RunError::Start(message)) => {
            let first = message.lines().next().unwrap_or("").to_string();
            found.push(Diagnostic::warning("start-off-constraints", scenario, first).help(
                "constraints may contradict each other, or the start is too far from a closed \
                     configuration",
            ));
            return;
        }
        Err(_) => return,
    };
    let (q, h) = (simulation.state.q.clone(), simulation.h);
    let (rest, inputs) = (simulation.rest().to_vec(), simulation.inputs().to_vec());
    let driven = simulation.driven().to_vec();
    context.interpreter = simulation.model;
    let held = Held { t: 0.0, rest: &rest, inputs: &inputs, driven: &driven };
    let linear = Linear::at(&mut context.interpreter, &q, &held);
    let rank = linear.rank();
    redundant(context, &linear, &rank.dependencies, (&q, &rest), said, found);
    let Some(step) = step else { return };
    let modes = modes(&linear.mass, &linear.stiffness, linear.n, &rank.null_space);
    if let Some(fastest) = modes.last() {
        let omega = fastest.omega_squared.max(0.0).sqrt();
        if omega * h > 1.0 {
            too_fast(context, fastest, omega, h, &q, step, found);
        }
    }
}

/// Rows that depend on others here and at configurations nearby: redundant.
fn redundant(
    context: &mut Context,
    linear: &Linear,
    dependencies: &[Vec<(usize, f64)>],
    (q, rest): (&[f64], &[f64]),
    said: &mut BTreeSet<String>,
    found: &mut Vec<Diagnostic>,
) {
    if dependencies.is_empty() {
        return;
    }
    let m = linear.constraints.len() / linear.n.max(1);
    let everywhere = super::route::poses(q).iter().skip(1).all(|pose| {
        let mut near = pose.clone();
        let driven: Vec<bool> = linear.free.iter().map(|free| !free).collect();
        if handc_core::start::project(&mut context.interpreter, &mut near, rest, &driven).is_err() {
            return true;
        }
        let rest = vec![0.0; context.mechanism.strands.len()];
        let inputs = vec![0.0; context.mechanism.inputs.len()];
        let held = Held { t: 0.0, rest: &rest, inputs: &inputs, driven: &driven };
        let there = Linear::at(&mut context.interpreter, &near, &held);
        m - there.rank().rank >= dependencies.len()
    });
    if !everywhere {
        return;
    }
    let layout = context.interpreter.layout().clone();
    for group in dependencies {
        let names: Vec<String> =
            group.iter().map(|(row, _)| format!("`{}`", layout.rows[*row].name)).collect();
        let text = names.join(", ");
        if !said.insert(text.clone()) {
            continue;
        }
        let spans: BTreeSet<usize> =
            group.iter().filter_map(|(row, _)| constraint_of(context, *row)).collect();
        let mut spans = spans.into_iter().map(|c| &context.model.constraints[c]);
        let Some(first) = spans.next() else { continue };
        let message = if group.len() == 1 {
            format!("constraint row {text} holds by itself: no coordinate can change it")
        } else {
            format!("constraint rows {text} depend on each other")
        };
        let mut diagnostic = Diagnostic::warning("redundant-constraint", first.name.span, message)
            .label("one row is redundant; its multiplier is shared in the least-norm way")
            .help("leave a row out, for a planar loop with `axes = (…)`");
        for other in spans {
            diagnostic = diagnostic.also(other.name.span, "together with this");
        }
        found.push(diagnostic);
    }
}

fn constraint_of(context: &Context, row: usize) -> Option<usize> {
    let mut first = 0;
    for (index, constraint) in context.mechanism.constraints.iter().enumerate() {
        first += constraint.row_suffixes().len();
        if row < first {
            return Some(index);
        }
    }
    None
}

/// The step is too long for a vibration; names the strand that stiffens it most.
fn too_fast(
    context: &mut Context,
    mode: &Mode,
    omega: f64,
    h: f64,
    q: &[f64],
    step: Span,
    found: &mut Vec<Diagnostic>,
) {
    let n = q.len();
    let count = context.mechanism.strands.len();
    let mut arms = vec![0.0; count * n];
    context.interpreter.moment_arms(q, &mut arms);
    let numbers =
        handc_runtime::resolved::Resolved::new(context.mechanism, context.interpreter.params());
    let stiffest = (0..count)
        .map(|s| {
            let stretch: f64 = (0..n).map(|i| arms[s * n + i] * mode.shape[i]).sum();
            (s, numbers.strands[s].stiffness.unwrap_or(0.0) * stretch * stretch)
        })
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .filter(|(_, share)| *share > 0.2 * mode.omega_squared);
    let moved = (0..n)
        .max_by(|&a, &b| mode.shape[a].abs().total_cmp(&mode.shape[b].abs()))
        .map(|c| context.name(c).to_string())
        .unwrap_or_default();
    let mut diagnostic = Diagnostic::warning(
        "long-step",
        step,
        format!("the step is long for the stiffest vibration: h*omega = {:.2}", omega * h),
    )
    .label(format!("omega = {omega:.0} rad/s, mostly in `{moved}`"))
    .help(format!("a step of {:.1e} s brings h*omega to 0.5", 0.5 / omega));
    if let Some((s, _)) = stiffest {
        let strand = &context.model.strands[s];
        diagnostic = diagnostic
            .also(strand.name.span, format!("strand `{}` makes it stiff", strand.name.text));
    }
    found.push(diagnostic);
}
