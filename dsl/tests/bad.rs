//! Every model of `tests/bad` is wrong in the way its name says; beside it stands what is said
//! about it. `HANDC_UPDATE=1 cargo test` rewrites the expected files.

use handc_dsl::{check_file, diagnostic::render};
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/bad")
}

/// Checks one case against its expected text; answers what is wrong.
fn check(path: &Path, update: bool) -> Result<(), String> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let checked = check_file(path, None);
    if checked.diagnostics.is_empty() {
        return Err(format!("{name}: nothing is said about it"));
    }
    let prefix = format!("{}/", path.parent().unwrap_or(Path::new("")).display());
    let found = render(&checked.diagnostics, &checked.sources, false).replace(&prefix, "");
    let expected_path = path.with_extension("stderr");
    if update {
        return std::fs::write(&expected_path, found).map_err(|e| format!("{name}: {e}"));
    }
    let expected = std::fs::read_to_string(&expected_path).unwrap_or_default();
    match expected == found {
        true => Ok(()),
        false => Err(format!("{name}: expected\n{expected}\nfound\n{found}")),
    }
}

#[test]
fn every_bad_model_is_explained() {
    let update = std::env::var_os("HANDC_UPDATE").is_some();
    let mut cases: Vec<PathBuf> = std::fs::read_dir(folder())
        .expect("tests/bad")
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|e| e == "hdl"))
        .collect();
    cases.sort();
    assert!(cases.len() >= 60, "only {} cases", cases.len());
    let wrong: Vec<String> = cases.iter().filter_map(|c| check(c, update).err()).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}
