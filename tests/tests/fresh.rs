//! The crates in `generated/` are what the compiler emits now.
//!
//! Where they are not, this test rewrites them and then fails: look at the difference and commit it.

use handc::emit::package::{Package, Sources, package, write_crate};
use handc::stage::DEFAULT_BUDGET;
use handc_tests::load::{mechanism, models, repository};

/// Models whose crates are committed.
const COMMITTED: [&str; 6] = ["finger", "fourbar", "grasp", "hand", "pendulum", "squeezer"];

/// The crate of a model, as `handc compile` makes it in the repository's root.
fn emitted(name: &str) -> Package {
    let path = repository("models").join(format!("{name}.hdl"));
    let mechanism = mechanism(&path).unwrap_or_else(|said| panic!("{said}"));
    let sources = Sources::in_checkout("../../runtime");
    package(&mechanism, &sources, DEFAULT_BUDGET).unwrap_or_else(|error| panic!("{name}: {error}"))
}

#[test]
fn committed_crates_are_fresh() {
    let mut stale = Vec::new();
    for name in COMMITTED {
        let folder = repository("generated").join(name);
        match write_crate(&folder, &emitted(name).files, false) {
            Ok(0) => {}
            Ok(changed) => stale.push(format!("{name}: {changed} files were rewritten")),
            Err(error) => stale.push(format!("{name}: {error}")),
        }
    }
    assert!(stale.is_empty(), "generated crates were stale\n{}", stale.join("\n"));
}

#[test]
fn every_committed_crate_is_known() {
    let entries = std::fs::read_dir(repository("generated")).expect("generated");
    for entry in entries.map(|entry| entry.expect("a readable folder")) {
        if !entry.path().is_dir() {
            continue;
        }
        let name = entry.file_name().to_string_lossy().into_owned();
        assert!(COMMITTED.contains(&name.as_str()), "`generated/{name}` is of no model here");
    }
}

#[test]
fn compiling_twice_gives_the_same_text() {
    for path in models("models") {
        let Ok(mechanism) = mechanism(&path) else { continue };
        let [first, second] = [0, 1]
            .map(|_| package(&mechanism, &Sources::carried(), DEFAULT_BUDGET).expect("a crate"));
        assert!(first.files == second.files, "{} is emitted in two ways", path.display());
    }
}
