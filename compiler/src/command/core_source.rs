//! Where a generated crate finds what it links to.
//!
//! In a checkout it is the folder `runtime/core`, and for a crate that holds tables `runtime` too, named
//! by relative paths so that generated text does not depend on the machine. A command that has been
//! moved away from its checkout carries the sources along and writes them beside the crate.

use super::compile::relative;
use crate::emit::package::{File, Sources};
use include_dir::{Dir, include_dir};
use std::path::Path;

/// How a generated crate reaches what it links to.
pub(crate) struct Found {
    /// Paths from the crate's folder.
    pub(crate) sources: Sources,
    is_carried: bool,
}

static CORE: Dir = include_dir!("$CARGO_MANIFEST_DIR/../runtime/core/src");
static RUNTIME: Dir = include_dir!("$CARGO_MANIFEST_DIR/../runtime/src");

const CORE_MANIFEST: &str = "[package]
name = \"handc-core\"
version = \"0.1.0\"
edition = \"2024\"
";

const RUNTIME_MANIFEST: &str = "[package]
name = \"handc-runtime\"
version = \"0.1.0\"
edition = \"2024\"

# Of the compiler alone.
[features]
analysis = []
serde = []

[dependencies]
handc-core = { path = \"../handc-core\" }
";

/// What the features that a generated crate does not ask for need.
const ANALYSIS: &str = "analysis";

/// Finds the sources for a crate in `folder`.
pub(crate) fn locate(folder: &Path) -> Result<Found, String> {
    let checkout = Path::new(env!("CARGO_MANIFEST_DIR")).join("../runtime");
    if checkout.join("Cargo.toml").exists() && checkout.join("core/Cargo.toml").exists() {
        let path = relative(folder, &checkout)
            .ok_or_else(|| format!("no path leads from `{}` to the core", folder.display()))?;
        return Ok(Found { sources: Sources::in_checkout(&path), is_carried: false });
    }
    Ok(Found { sources: Sources::carried(), is_carried: true })
}

impl Found {
    /// Files to write into the crate, if it must bring its sources along.
    pub(crate) fn carried(&self, has_tables: bool) -> Vec<File> {
        if self.is_carried { carried(&self.sources, has_tables) } else { Vec::new() }
    }
}

fn carried(sources: &Sources, has_tables: bool) -> Vec<File> {
    let mut files = Vec::new();
    let mut add = |to: &str, manifest: &str, from: &Dir| {
        files.push(File { path: format!("{to}/Cargo.toml"), text: manifest.into() });
        add_sources(from, &format!("{to}/src"), &mut files);
    };
    add(&sources.core, CORE_MANIFEST, &CORE);
    if has_tables {
        add(&sources.runtime, RUNTIME_MANIFEST, &RUNTIME);
    }
    files
}

/// Adds the files of a folder and of those in it.
fn add_sources(from: &Dir, to: &str, files: &mut Vec<File>) {
    for file in from.files() {
        let (path, text) = (file.path().display(), file.contents_utf8().unwrap_or_default());
        files.push(File { path: format!("{to}/{path}"), text: text.to_string() });
    }
    let folders = from.dirs().filter(|folder| folder.path() != Path::new(ANALYSIS));
    folders.for_each(|folder| add_sources(folder, to, files));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_are_carried_whole() {
        let files = carried(&Sources::carried(), true);
        let text = |path: &str| &files.iter().find(|file| file.path == path).unwrap().text;
        // What a file calls its modules, they are there.
        for folder in ["handc-core/src", "handc-runtime/src"] {
            let root = text(&format!("{folder}/lib.rs"));
            for module in root.lines().filter_map(|line| line.strip_prefix("pub mod ")) {
                let name = module.trim_end_matches(';');
                let places = [format!("{folder}/{name}.rs"), format!("{folder}/{name}/mod.rs")];
                let is_there = files.iter().any(|file| places.contains(&file.path));
                assert_eq!(is_there, name != ANALYSIS, "{name}");
            }
        }
        assert!(text("handc-core/src/step/mod.rs").contains("pub struct Stepper"));
    }

    #[test]
    fn a_crate_with_tables_builds_from_what_is_carried() {
        let folder = std::env::temp_dir().join(format!("handc-carried-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        let sources = Sources::carried();
        let mechanism = crate::stage::tests::hand();
        let package = crate::emit::package::package(&mechanism, &sources, 0).expect("a crate");
        let mut files = package.files;
        files.extend(carried(&sources, true));
        crate::emit::package::write_crate(&folder, &files, true).expect("a folder");
        let checked = std::process::Command::new(env!("CARGO"))
            .args(["check", "--offline", "--quiet", "--manifest-path"])
            .arg(folder.join("Cargo.toml"))
            .env("CARGO_TARGET_DIR", folder.join("target"))
            .env("RUSTFLAGS", "-D warnings")
            .output()
            .expect("cargo");
        assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stderr));
        let _ = std::fs::remove_dir_all(&folder);
    }
}
