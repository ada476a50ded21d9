//! Where a generated crate finds what it links to.
//!
//! In a checkout it is the folder `runtime/core`, named by a relative path so that generated text
//! does not depend on the machine. A command that has been moved away from its checkout carries the
//! sources along and writes them beside the crate.

use super::compile::relative;
use crate::emit::package::File;
use std::path::Path;

/// How a generated crate reaches the core.
pub(crate) struct Core {
    /// Path from the crate's folder.
    pub(crate) path: String,
    /// Files to write into the crate, if it must bring the core along.
    pub(crate) files: Vec<File>,
}

macro_rules! sources {
    ($($file:literal)*) => {
        &[$(($file, include_str!(concat!("../../../runtime/core/src/", $file, ".rs")))),*]
    };
}

const SOURCES: &[(&str, &str)] = sources![
    "array" "ensemble/mod" "ensemble/results" "ensemble/spread" "error" "follow" "frequency"
    "lane/mod" "lane/sine" "lane/sweep" "lane/x4" "lanes/lengths" "lanes/mod" "lanes/step"
    "layout" "lib" "linalg" "lookup" "math" "model" "motion" "newton" "passage" "predict" "runner"
    "scalar" "shape" "simulation" "solve" "start" "statics" "step/attempt" "step/lanes" "step/mod"
    "step/report" "suggest" "together" "trajectory"
];

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
    files.extend(SOURCES.iter().map(|(name, text)| File {
        path: format!("handc-core/src/{name}.rs"),
        text: (*text).to_string(),
    }));
    Ok(Core { path: "handc-core".into(), files })
}

#[cfg(test)]
mod tests {
    use super::SOURCES;

    #[test]
    fn every_source_of_the_core_is_carried() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../runtime/core/src");
        let (mut open, mut found) = (vec![std::path::PathBuf::from(folder)], Vec::new());
        while let Some(folder) = open.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                match path.extension() {
                    None => open.push(path),
                    Some(_) => found.push(path.with_extension("")),
                }
            }
        }
        let mut found: Vec<&str> =
            found.iter().map(|path| path.strip_prefix(folder).unwrap().to_str().unwrap()).collect();
        found.sort_unstable();
        let carried: Vec<&str> = SOURCES.iter().map(|(name, _)| *name).collect();
        assert_eq!(found, carried);
    }
}
