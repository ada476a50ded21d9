//! Steps on lanes in one go, one by one, with other runs, and number by number: the same motion.

mod pendulums;

use handc_core::lane::use_at_most;
use handc_core::together::Together;
use pendulums::{Kind, end, last, run};

/// The largest angle (rad) of which vectors have a sine.
const LARGEST_ANGLE: f64 = 1e6;

/// Pendulums that differ; their motion begins and ends amid a stretch.
fn kind(varies: bool) -> Kind {
    Kind { varies, are_alike: false, is_muscular: false, knots: &[(0, 0.0023), (1, 0.3307)] }
}

/// What no two ways of rounding do to these pendulums in so many steps.
fn assert_close(found: &[Vec<f64>; 3], expected: &[Vec<f64>; 3], what: &str) {
    for (found, expected) in found.iter().zip(expected) {
        let size = expected.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
        for (x, y) in found.iter().zip(expected) {
            assert!((x - y).abs() <= 1e-10 * size, "{what}: {x} for {y}");
        }
    }
}

#[test]
fn all_ways_lead_to_the_same_motion() {
    // One test, since the width of vectors is the whole program's.
    for varies in [false, true] {
        let run = |offset| run(offset, kind(varies));
        use_at_most(1);
        // Vectors have no sine of the last one's angles: where it begins on lanes, it must leave them.
        let offsets = [0.0, 1e-3, -2e-3, 4e6];
        let expected = offsets.map(|offset| end(run(offset), 1));
        let follow = |q: &f64| (q - 0.8).abs() < 0.2;
        assert!(expected[0][0].iter().skip(1).all(follow), "{:?}", expected[0][0]);
        for lanes in [4, 8] {
            use_at_most(lanes);
            for (offset, expected) in offsets.into_iter().zip(&expected) {
                let one_by_one = end(run(offset), 1);
                assert_close(&one_by_one, expected, "on lanes");
                for stretch in [7, 64, 1000] {
                    let found = end(run(offset), stretch);
                    assert_eq!(found, one_by_one, "{stretch} steps in one go");
                }
            }
            // The last run comes amid a stretch to where vectors have no sine: all go back then.
            let mut runs = offsets[..3].iter().map(|&offset| run(offset)).collect::<Vec<_>>();
            runs.push(run(LARGEST_ANGLE - 0.2));
            assert!(runs[3].state.q.iter().all(|&q| q < LARGEST_ANGLE));
            let mut together = Together::new(runs);
            while !together.is_over() {
                together.advance(usize::MAX, |run, error| panic!("run {run}: {error}"));
            }
            let runs = together.into_runs();
            assert!(runs[3].state.q.iter().any(|&q| q > LARGEST_ANGLE), "{:?}", runs[3].state.q);
            for (run, expected) in runs.into_iter().zip(&expected[..3]) {
                assert_close(&last(&run), expected, "together");
            }
        }
    }
}
