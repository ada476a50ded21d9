//! One small model at two stages: after checking, and as a generated crate.

use handc::emit::package::package;
use handc_dsl::check_file;
use handc_tests::load::{mechanism, repository};

#[test]
fn checked_pendulum() {
    let checked = check_file(&repository("models/pendulum.hdl"), None);
    let text = serde_json::to_string_pretty(&checked.model).expect("JSON");
    insta::assert_snapshot!("checked_pendulum", text);
}

#[test]
fn generated_pendulum() {
    let mechanism = mechanism(&repository("models/pendulum.hdl")).expect("a right model");
    let made = package(&mechanism, "handc-core").expect("a crate");
    let text: String =
        made.files.iter().map(|f| format!("==== {}\n{}\n", f.path, f.text)).collect();
    insta::assert_snapshot!("generated_pendulum", text);
}
