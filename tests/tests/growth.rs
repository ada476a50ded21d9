//! Generated crates grow no faster than their models, and hold no more straight lines than they may.

use handc::emit::package::{Package, Sources, package};
use handc::stage::{DEFAULT_BUDGET, Group};
use handc_tests::grown::{chain, fingers};
use handc_tests::load::mechanism_of_text;

fn compiled(name: &str, text: &str, budget: usize) -> Package {
    let mechanism = mechanism_of_text(name, text).unwrap_or_else(|said| panic!("{said}"));
    package(&mechanism, &Sources::carried(), budget).unwrap_or_else(|error| panic!("{error}"))
}

fn operations(package: &Package) -> usize {
    package.report.functions.iter().map(|(_, operations)| operations.total()).sum()
}

#[test]
fn chains_are_straight_lines_until_they_are_long() {
    let short = compiled("chain_16", &chain(16), DEFAULT_BUDGET);
    assert_eq!(short.report.tables, []);
    let [half, whole] = [64, 128].map(|n| compiled("chain", &chain(n), DEFAULT_BUDGET));
    for long in [&half, &whole] {
        assert_eq!(long.report.tables, [Group::Equations]);
        assert!(operations(long) <= DEFAULT_BUDGET);
    }
    let growth = whole.report.lines as f64 / half.report.lines as f64;
    assert!((1.8..2.05).contains(&growth), "twice the links, {growth:.2} times the lines");
}

#[test]
fn like_fingers_share_straight_lines() {
    let [half, whole] = [32, 64].map(|n| compiled("fingers", &fingers(n), DEFAULT_BUDGET));
    assert!(!whole.report.tables.contains(&Group::Equations));
    let growth = whole.report.lines as f64 / half.report.lines as f64;
    assert!((1.8..2.05).contains(&growth), "twice the fingers, {growth:.2} times the lines");
}

#[test]
fn a_budget_goes_to_what_a_step_asks_first() {
    let text = fingers(4);
    let none = compiled("fingers", &text, 0);
    assert_eq!(operations(&none), 0);
    assert!(none.files.iter().any(|file| file.path == "src/mechanism.rs"));
    let mut before = none.report.tables.len();
    for budget in [840, 1200, 2000, 4000] {
        let some = compiled("fingers", &text, budget);
        assert!(operations(&some) <= budget, "{} of {budget}", operations(&some));
        assert!(!some.report.tables.contains(&Group::Equations), "{budget}");
        assert!(some.report.tables.len() <= before);
        before = some.report.tables.len();
    }
    assert_eq!(before, 0);
    let manifest = |package: &Package| package.files[0].text.contains("handc-runtime");
    assert!(manifest(&none) && !manifest(&compiled("fingers", &text, 4000)));
}
