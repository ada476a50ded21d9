//! A muscle that is excited by more than it can be: the run ends there, alone and with others, and
//! keeps what it has computed.

mod pendulums;

use handc_core::together::Together;
use pendulums::{EXCITATION, Kind, end, last, run};

fn muscular() -> Kind {
    Kind { varies: false, are_alike: true, is_muscular: true, knots: &[(0, 0.0), (1, 0.3)] }
}

/// The last step at whose middle the excitation is one at most.
fn last_step() -> usize {
    ((1.0 - EXCITATION[0]) / EXCITATION[1] / 1e-3 + 0.5) as usize
}

/// Where a run is that ends before.
fn until_then() -> [Vec<f64>; 3] {
    let mut run = run(0.0, muscular());
    run.steps = last_step();
    end(run, 1)
}

#[test]
fn a_run_ends_where_its_excitation_leaves_its_range() {
    for stretch in [1, 64] {
        let mut run = run(0.0, muscular());
        let error = loop {
            match run.advance(stretch) {
                Ok(taken) => assert!(taken > 0),
                Err(error) => break error.to_string(),
            }
        };
        assert_eq!(run.state.step, last_step(), "{stretch} steps in one go");
        // Natural lengths have been fed for the step that was not taken.
        assert_eq!(last(&run)[..2], until_then()[..2], "nothing is lost");
        assert!(error.contains("the excitation of muscle `s0` is 1.0"), "{error}");
    }
}

#[test]
fn runs_that_go_together_end_there_too() {
    let mut together =
        Together::new([0.0, 1e-3, 2e-3].map(|offset| run(offset, muscular())).into());
    let mut failed = Vec::new();
    while !together.is_over() {
        together.advance(usize::MAX, |run, _| failed.push(run));
    }
    assert_eq!(failed, [0, 1, 2]);
    for run in together.into_runs() {
        assert_eq!(run.state.step, last_step());
    }
}
