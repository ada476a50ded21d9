//! Every model of `tests/lint` deserves the remark that its name says; beside it stands what is said
//! about it. `HANDC_UPDATE=1 cargo test` rewrites the expected files.

use handc::lint::lint;
use handc::lower::lower;
use handc_dsl::check_file;
use handc_tests::expected::expected;
use handc_tests::load::{models, said};
use std::path::Path;

/// What `handc check` shows of a file.
fn shown(path: &Path) -> String {
    let mut checked = check_file(path, None);
    if let Some(model) = &checked.model {
        let mechanism = lower(model, &checked.sources);
        checked.diagnostics.extend(lint(model, &mechanism));
    }
    let folder = format!("{}/", path.parent().unwrap_or(Path::new("")).display());
    said(&checked).replace(&folder, "")
}

/// Checks one case; answers what is wrong.
fn check(path: &Path) -> Result<(), String> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let found = shown(path);
    if found.is_empty() != name.ends_with("_is_fine") {
        return Err(format!("{name}: said is\n{found}"));
    }
    expected(&path.with_extension("stderr"), &found)
}

#[test]
fn every_remark_is_made() {
    let cases = models("tests/lint");
    assert!(cases.len() >= 12, "only {} cases", cases.len());
    let wrong: Vec<String> = cases.iter().filter_map(|c| check(c).err()).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}
