//! The generated crate: its files, from a mechanism.
//!
//! [`names`] settles every name first; [`modules`] holds the straight-line functions, [`layout`]
//! and [`parameters`] the model's names and shape, [`model`] the struct with what a user calls, and
//! [`interface`] the same for the integrator; [`write`](mod@write) puts it all on disk.

mod blocks;
mod imports;
mod interface;
mod layout;
mod manifest;
mod model;
mod modules;
mod names;
mod parameters;
mod shapes;
mod spacing;
mod systems;
mod tables;
#[cfg(test)]
mod tests;
mod write;

use super::count::Operations;
use crate::graph;
use crate::stage::{Group, Module, Staged, stage};
use handc_core::layout::Layout;
use handc_runtime::interpreter::layout as layout_of;
use handc_runtime::mechanism::Mechanism;
use handc_runtime::structure::Structure;
use proc_macro2::TokenStream;
use std::fmt;
pub use write::{File, WriteError, write_crate};

/// A crate ready to be written.
#[derive(Clone, Debug)]
pub struct Package {
    /// Name of the package and of its runner.
    pub name: String,
    /// Files, the manifest first.
    pub files: Vec<File>,
    /// What it is made of.
    pub report: Report,
}

/// Size of a generated crate.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Module, name and operations of every function.
    pub functions: Vec<(String, Operations)>,
    /// Operations of one evaluation of momentum and force over all blocks.
    pub evaluate: Operations,
    /// The same with the Newton matrix.
    pub evaluate_with_matrix: Operations,
    /// What is left to loops over tables.
    pub tables: Vec<Group>,
    /// Lines of Rust.
    pub lines: usize,
    /// Nodes of the symbolic graph.
    pub nodes: usize,
}

impl fmt::Display for Report {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        write!(
            formatter,
            "{} functions, {} lines; {} operations for momentum and force, {} with the Newton \
             matrix",
            self.functions.len(),
            self.lines,
            self.evaluate.total(),
            self.evaluate_with_matrix.total()
        )?;
        if !self.tables.is_empty() {
            let groups: Vec<String> = self.tables.iter().map(Group::to_string).collect();
            write!(formatter, "; by tables: {}", groups.join(", "))?;
        }
        Ok(())
    }
}

/// Why a crate could not be made.
#[derive(Clone, Debug, PartialEq)]
pub struct PackageError {
    /// The file whose tokens are not Rust.
    pub file: String,
    /// What the parser says.
    pub message: String,
}

impl fmt::Display for PackageError {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        write!(formatter, "the generated `{}` is not legal Rust: {}", self.file, self.message)
    }
}

impl std::error::Error for PackageError {}

/// Where a crate finds what it links to: paths from its folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sources {
    /// The core.
    pub core: String,
    /// The mechanics, for a crate that holds tables.
    pub runtime: String,
}

impl Sources {
    /// In a checkout whose folder `runtime` is at the path.
    pub fn in_checkout(runtime: &str) -> Self {
        Sources { core: format!("{runtime}/core"), runtime: runtime.to_owned() }
    }

    /// Beside the crate's own sources.
    pub fn carried() -> Self {
        Sources { core: "handc-core".to_owned(), runtime: "handc-runtime".to_owned() }
    }
}

/// Makes the crate of a mechanism, with at most so many operations as straight lines; the rest is left
/// to loops over tables.
pub fn package(
    mechanism: &Mechanism,
    sources: &Sources,
    budget: usize,
) -> Result<Package, PackageError> {
    let structure = Structure::new(mechanism);
    let layout = layout_of(mechanism, &structure);
    graph::with_new(|| assemble(mechanism, &structure, &layout, sources, budget))
}

fn assemble(
    mechanism: &Mechanism,
    structure: &Structure,
    layout: &Layout,
    links: &Sources,
    budget: usize,
) -> Result<Package, PackageError> {
    let staged = stage(mechanism, structure, budget);
    let frames: Vec<String> = mechanism.frames.iter().map(|frame| frame.name.clone()).collect();
    let names = names::Names::new(layout, &frames, &staged);
    let functions = modules::functions(&staged, &names);
    let modules = modules::modules(mechanism, &staged, layout, &names, &functions);
    let list: Vec<Module> = modules.iter().map(|(module, _)| *module).collect();
    let mut sources: Vec<(String, TokenStream)> = vec![
        ("lib.rs".to_owned(), manifest::library(mechanism, layout, &names, &staged, &list)),
        ("main.rs".to_owned(), manifest::runner(mechanism, &names)),
        ("layout.rs".to_owned(), layout::module(layout, &names)),
        ("parameters.rs".to_owned(), parameters::module(mechanism, &names)),
        ("model.rs".to_owned(), model::module(mechanism, &names, &staged, &functions)),
        ("interface.rs".to_owned(), interface::module(&names, &staged, &functions)),
    ];
    if !staged.shapes.is_empty() {
        let module = blocks::module(&names, &staged, &functions);
        sources.push(("blocks/mod.rs".to_owned(), module));
    }
    if !staged.systems.is_empty() {
        sources.push(("systems/mod.rs".to_owned(), systems::module(&names, &staged, &functions)));
    }
    sources.extend(manifest::folders(&names, &list));
    sources.extend(modules.into_iter().map(|(m, tokens)| (modules::file(m, &names), tokens)));
    let mut files = vec![File {
        path: "Cargo.toml".to_owned(),
        text: manifest::manifest(&names, &staged, links),
    }];
    if !staged.tables.is_empty() {
        files.push(tables::mechanism(mechanism));
    }
    for (file, tokens) in sources {
        let parsed = syn::parse2(tokens)
            .map_err(|error| PackageError { file: file.clone(), message: error.to_string() })?;
        let text = format!(
            "// {} from the model; changes here are lost.\n\n{}",
            manifest::MARKER,
            spacing::spaced(&prettyplease::unparse(&parsed))
        );
        files.push(File { path: format!("src/{file}"), text });
    }
    let report = report(&functions, &staged, &names, &files);
    Ok(Package { name: names.package, files, report })
}

fn report(
    functions: &[modules::Placed],
    staged: &Staged,
    names: &names::Names,
    files: &[File],
) -> Report {
    let mut report = Report {
        lines: files.iter().skip(1).map(|file| file.text.lines().count()).sum(),
        nodes: graph::node_count(),
        tables: staged.tables.iter().copied().collect(),
        ..Report::default()
    };
    for placed in functions {
        let emitted = &placed.emitted;
        let file = modules::file(placed.module, names);
        report.functions.push((format!("{file}: {}", emitted.name), emitted.operations));
        let Module::Part(number) = placed.module else { continue };
        for _ in &staged.shapes[number].places {
            match emitted.name.as_str() {
                "evaluate" => report.evaluate += emitted.operations,
                "evaluate_with_matrix" => report.evaluate_with_matrix += emitted.operations,
                _ => {}
            }
        }
    }
    report
}
