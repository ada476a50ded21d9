//! `handc compile`: a crate of specialised Rust.

use crate::emit::package::{Package, Sources, package, write_crate};
use crate::graph;
use crate::stage::DEFAULT_BUDGET;
use handc_runtime::mechanism::Mechanism;
use handc_runtime::structure::Structure;
use std::fmt::Write;
use std::path::{Component, Path, PathBuf};
use std::time::Instant;

/// Compiles a model file into a crate with at most so many operations as straight lines; the default
/// folder is `generated/<model>`.
pub fn compile(
    file: &Path,
    root: Option<&Path>,
    out: Option<&Path>,
    force: bool,
    budget: usize,
) -> u8 {
    let began = Instant::now();
    let mechanism = match super::mechanism(file, root) {
        Ok((_, mechanism)) => mechanism,
        Err(code) => return code,
    };
    let folder = match out {
        Some(out) => out.to_path_buf(),
        None => Path::new("generated").join(&mechanism.name),
    };
    let found = match super::core_source::locate(&folder) {
        Ok(found) => found,
        Err(error) => return fail(&error),
    };
    let package = match package(&mechanism, &found.sources, budget) {
        Ok(package) => package,
        Err(error) => return fail(&error.to_string()),
    };
    let mut files = package.files.clone();
    files.extend(found.carried(!package.report.tables.is_empty()));
    let changed = match write_crate(&folder, &files, force) {
        Ok(changed) => changed,
        Err(error) => return fail(&error.to_string()),
    };
    super::print(&format!(
        "{}: {}; {} changed; {:.2} s\nbuild and run it: cargo run --release --manifest-path {} --\n",
        folder.display(),
        package.report,
        super::count(changed, "file"),
        began.elapsed().as_secs_f64(),
        folder.join("Cargo.toml").display()
    ));
    0
}

fn fail(message: &str) -> u8 {
    eprintln!("error: {message}");
    2
}

/// The path from `folder` to `target`, with `/`; both may be relative to the working directory and
/// need not exist.
pub(crate) fn relative(folder: &Path, target: &Path) -> Option<String> {
    let (from, to) = (normal(folder)?, normal(target)?);
    let mut from = from.components().peekable();
    let mut to = to.components().peekable();
    while from.peek().is_some() && from.peek() == to.peek() {
        from.next();
        to.next();
    }
    let up = from.map(|_| "..".to_string());
    let down = to.map(|c| c.as_os_str().to_string_lossy().into_owned());
    let parts: Vec<String> = up.chain(down).collect();
    Some(if parts.is_empty() { ".".into() } else { parts.join("/") })
}

/// An absolute path without `.` and `..`; existing parts are taken as the file system has them.
fn normal(path: &Path) -> Option<PathBuf> {
    if let Ok(found) = path.canonicalize() {
        return Some(found);
    }
    let absolute = std::path::absolute(path).ok()?;
    let mut out = PathBuf::new();
    for component in absolute.components() {
        match component {
            Component::ParentDir => {
                out.pop();
            }
            Component::CurDir => {}
            other => out.push(other),
        }
    }
    // The deepest part that exists may be reached through a link.
    let existing = out.ancestors().find(|a| a.exists())?.to_path_buf();
    let rest = out.strip_prefix(&existing).ok()?.to_path_buf();
    Some(existing.canonicalize().ok()?.join(rest))
}

/// Every node of the step's graph, one a line: handle, operation, origin.
pub(crate) fn graph_text(mechanism: &Mechanism) -> String {
    graph::with_new(|| {
        let structure = Structure::new(mechanism);
        let staged = crate::stage::stage(mechanism, &structure, DEFAULT_BUDGET);
        let mut text = String::new();
        for task in &staged.tasks {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "# {:?} {}", task.module, task.name);
            let symbols: Vec<graph::Sym> = task.outputs.iter().map(|o| o.value).collect();
            for symbol in graph::reachable(&symbols) {
                let label = graph::label_of(symbol);
                let _ = writeln!(text, "%{} = {:?}  {label}", symbol.index(), graph::node(symbol));
            }
            for output in &task.outputs {
                let _ = writeln!(text, "-> {:?} = %{}", output.place, output.value.index());
            }
        }
        text
    })
}

/// The generated crate, file after file.
pub(crate) fn rust_text(mechanism: &Mechanism) -> String {
    match package(mechanism, &Sources::carried(), DEFAULT_BUDGET) {
        Ok(Package { files, .. }) => {
            files.iter().map(|f| format!("// ==== {}\n{}\n", f.path, f.text)).collect()
        }
        Err(error) => format!("{error}\n"),
    }
}

#[cfg(test)]
mod tests {
    use super::relative;
    use std::path::Path;

    #[test]
    fn relative_paths_go_up_and_down() {
        let go = |a: &str, b: &str| relative(Path::new(a), Path::new(b)).unwrap();
        assert_eq!(go("/no/such/a/b", "/no/such/c"), "../../c");
        assert_eq!(go("/no/x/../such/a", "/no/such/a/d/e"), "d/e");
        assert_eq!(go("/no/such", "/no/such"), ".");
    }
}
