//! Lanes that are alike measure natural lengths of steps to come: the same bits as one by one.

mod pendulums;

use handc_core::lane::use_at_most;
use handc_core::together::Together;
use pendulums::{Kind, end, last, run};

/// Like pendulums, whose motion turns at any place within a vector of steps.
const ALIKE: Kind = Kind {
    varies: false,
    are_alike: true,
    is_muscular: false,
    knots: &[(0, 0.0023), (1, 0.1511), (2, 0.3187), (2, 0.3304), (0, 0.4506)],
};

/// How runs end that go together, in stretches.
fn together(offsets: &[f64], stretch: usize) -> Vec<[Vec<f64>; 3]> {
    let mut together = Together::new(offsets.iter().map(|&offset| run(offset, ALIKE)).collect());
    while !together.is_over() {
        together.advance(stretch, |run, error| panic!("run {run}: {error}"));
    }
    together.into_runs().iter().map(last).collect()
}

#[test]
fn stretches_end_like_steps_one_by_one() {
    // One test, since the width of vectors is the whole program's.
    for lanes in [1, 4, 8] {
        use_at_most(lanes);
        let one_by_one = end(run(1e-3, ALIKE), 1);
        assert!(one_by_one[0].iter().all(|q| q.abs() < 0.2), "{:?}", one_by_one[0]);
        for stretch in [2, 3, 7, 64, 1000] {
            let found = end(run(1e-3, ALIKE), stretch);
            assert_eq!(found, one_by_one, "{stretch} steps in one go, {lanes} lanes");
        }
        // Copies that differ in their start alone, on vectors with and without lanes left over.
        for offsets in [&[0.0, 1e-3, -2e-3, 5e-4][..], &[0.0, 1e-3, 3e-3]] {
            let one_by_one = together(offsets, 1);
            for stretch in [7, 64, usize::MAX] {
                let found = together(offsets, stretch);
                assert_eq!(found, one_by_one, "{stretch} steps in one go, {lanes} lanes");
            }
        }
    }
}
