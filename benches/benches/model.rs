//! Criterion benches of one model after the other: step, residual, Newton matrix, strand lengths,
//! ensemble, and the compiler.

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use handc::emit::package::{Sources, package};
use handc::stage::DEFAULT_BUDGET;
use handc_core::ensemble::Plan;
use handc_core::model::{Midpoint, Model};
use handc_core::runner::{Observer, RunOptions, run};
use handc_core::simulation::{Settings, Simulation};
use handc_tests::load::{mechanism, repository};
use std::hint::black_box;

/// Nobody watches, and nothing is written.
struct Silent;

impl Observer for Silent {
    fn advanced(&mut self, _step: usize, _steps: usize) -> bool {
        true
    }
    fn note(&mut self, _text: &str) {}
}

/// All benches of a compiled model.
fn model<M: Model + Clone + Send + Sync>(c: &mut Criterion, name: &str, model: M, scenario: &str) {
    let settings = Settings { scenario: Some(scenario.into()), ..Settings::default() };
    let run_of = || Simulation::new(model.clone(), &settings).expect("a start");
    let mut group = c.benchmark_group(name);

    let mut moving = run_of();
    group.bench_function("step", |b| {
        b.iter(|| {
            if moving.state.step >= moving.steps {
                moving = run_of();
            }
            moving.step().expect("a step");
        });
    });

    let mut at = run_of();
    (0..50).for_each(|_| at.step().expect("a step"));
    let (q, v, t) = (at.state.q.clone(), at.state.v.clone(), at.state.t);
    let (rest, inputs, h) = (at.rest().to_vec(), at.inputs().to_vec(), at.h);
    let point = Midpoint { q: &q, v: &v, t, rest: &rest, inputs: &inputs };
    let (mut p, mut f) = (vec![0.0; q.len()], vec![0.0; q.len()]);
    let mut matrix = vec![0.0; at.layout().matrix_size()];
    let mut lengths = vec![0.0; rest.len()];
    let mut asked = model.clone();
    group.bench_function("residual", |b| {
        b.iter(|| asked.evaluate(black_box(&point), &mut p, &mut f));
    });
    group.bench_function("residual and matrix", |b| {
        b.iter(|| asked.evaluate_with_matrix(black_box(&point), h, &mut p, &mut f, &mut matrix));
    });
    group.bench_function("strand lengths", |b| {
        b.iter(|| asked.strand_lengths(black_box(&q), &mut lengths));
    });

    let plan = Plan { instances: 16, threads: Some(1), spread: Vec::new(), summary: None };
    let duration = Some(200.0 * h);
    let settings = Settings { duration, ..settings.clone() };
    let options = RunOptions { settings, out: None, every: 1, ensemble: Some(plan) };
    group.bench_function("ensemble, 16 copies of 200 steps", |b| {
        b.iter_batched(
            || model.clone(),
            |model| run(model, &options, &mut Silent).expect("a run"),
            BatchSize::SmallInput,
        );
    });
    group.finish();
}

fn compiler(c: &mut Criterion) {
    let mut group = c.benchmark_group("compile");
    group.sample_size(10);
    for name in ["finger", "hand", "grasp"] {
        let file = repository("models").join(format!("{name}.hdl"));
        group.bench_function(name, |b| {
            b.iter(|| {
                let mechanism = mechanism(&file).expect("a right model");
                package(&mechanism, &Sources::carried(), DEFAULT_BUDGET).expect("a crate")
            });
        });
    }
    group.finish();
}

fn all(c: &mut Criterion) {
    model(c, "finger", finger::Finger::new(), "track");
    model(c, "hand", hand::Hand::new(), "close");
    model(c, "grasp", grasp::Grasp::new(), "hold");
    compiler(c);
}

criterion_group!(benches, all);
criterion_main!(benches);
