//! One small model at two stages: after checking, and as a generated crate. `HANDC_UPDATE=1` rewrites
//! the expected files.

use handc::emit::package::{Sources, package};
use handc::stage::DEFAULT_BUDGET;
use handc_dsl::check_file;
use handc_tests::expected::expected;
use handc_tests::load::{mechanism, repository};

#[track_caller]
fn stays(name: &str, text: &str) {
    let path = repository("tests/tests/snapshots").join(name);
    expected(&path, text).unwrap_or_else(|wrong| panic!("{wrong}"));
}

#[test]
fn checked_pendulum() {
    let checked = check_file(&repository("models/pendulum.hdl"), None);
    let text = serde_json::to_string_pretty(&checked.model).expect("JSON");
    stays("checked_pendulum.json", &format!("{text}\n"));
}

#[test]
fn generated_pendulum() {
    let mechanism = mechanism(&repository("models/pendulum.hdl")).expect("a right model");
    let made = package(&mechanism, &Sources::carried(), DEFAULT_BUDGET).expect("a crate");
    let text: String =
        made.files.iter().map(|f| format!("==== {}\n{}\n", f.path, f.text)).collect();
    stays("generated_pendulum.txt", &format!("{}\n", text.trim_end()));
}
