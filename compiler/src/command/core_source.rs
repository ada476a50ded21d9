//! Where a generated crate finds what it links to.
//!
//! In a checkout it is the folder `runtime/core`, named by a relative path so that generated text
//! does not depend on the machine. A command that has been moved away from its checkout carries the
//! sources along and writes them beside the crate.

use super::compile::relative;
use crate::emit::package::File;
use include_dir::{Dir, include_dir};
use std::path::Path;

/// How a generated crate reaches the core.
pub(crate) struct Core {
    /// Path from the crate's folder.
    pub(crate) path: String,
    /// Files to write into the crate, if it must bring the core along.
    pub(crate) files: Vec<File>,
}

static SOURCES: Dir = include_dir!("$CARGO_MANIFEST_DIR/../runtime/core/src");

const MANIFEST: &str = "[package]
name = \"handc-core\"
version = \"0.1.0\"
edition = \"2024\"
";

/// Finds the core for a crate in `folder`.
pub(crate) fn locate(folder: &Path) -> Result<Core, String> {
    let checkout = Path::new(env!("CARGO_MANIFEST_DIR")).join("../runtime/core");
    if checkout.join("Cargo.toml").exists() {
        let path = relative(folder, &checkout)
            .ok_or_else(|| format!("no path leads from `{}` to the core", folder.display()))?;
        return Ok(Core { path, files: Vec::new() });
    }
    let mut files = vec![File { path: "handc-core/Cargo.toml".into(), text: MANIFEST.into() }];
    add_sources(&SOURCES, "handc-core/src", &mut files);
    Ok(Core { path: "handc-core".into(), files })
}

/// Adds the files of a folder and of those in it.
fn add_sources(from: &Dir, to: &str, files: &mut Vec<File>) {
    for file in from.files() {
        let (path, text) = (file.path().display(), file.contents_utf8().unwrap_or_default());
        files.push(File { path: format!("{to}/{path}"), text: text.to_string() });
    }
    from.dirs().for_each(|folder| add_sources(folder, to, files));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_core_is_carried_whole() {
        let mut files = Vec::new();
        add_sources(&SOURCES, "core", &mut files);
        let text = |path: &str| &files.iter().find(|file| file.path == path).unwrap().text;
        // What a file calls its modules, they are there.
        for module in text("core/lib.rs").lines().filter_map(|line| line.strip_prefix("pub mod ")) {
            let name = module.trim_end_matches(';');
            let places = [format!("core/{name}.rs"), format!("core/{name}/mod.rs")];
            assert!(files.iter().any(|file| places.contains(&file.path)), "{name}");
        }
        assert!(text("core/step/mod.rs").contains("pub struct Stepper"));
    }
}
