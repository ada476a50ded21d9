//! The names of a model as Rust names, each unique in its place.

use crate::emit::function::Naming;
use crate::emit::literal::integer;
use crate::emit::name::{Taken, camel, snake, upper};
use crate::emit::print::identifier;
use crate::graph::{Leaf, SystemArray};
use crate::stage::{Staged, parts};
use handc_core::layout::Layout;
use handc_core::passage::CLEARANCES;
use proc_macro2::{Ident, TokenStream};
use quote::quote;

/// Crates that every crate can see, and folders that cargo uses.
const RESERVED_CRATES: [&str; 11] = [
    "alloc",
    "build",
    "core",
    "deps",
    "examples",
    "handc_core",
    "incremental",
    "main",
    "proc_macro",
    "std",
    "test",
];

/// Type names of a generated crate, and those its code mentions.
const RESERVED_TYPES: &[&str] = &[
    "Arc",
    "Box",
    "Clone",
    "Copy",
    "Debug",
    "Default",
    "Drop",
    "From",
    "Inputs",
    "Instant",
    "Into",
    "Iterator",
    "Layout",
    "Midpoint",
    "Model",
    "None",
    "Ok",
    "Option",
    "Params",
    "PartialEq",
    "Pose",
    "Result",
    "RunError",
    "ScenarioValues",
    "Self",
    "Send",
    "Settings",
    "Simulation",
    "Sized",
    "Some",
    "State",
    "StepError",
    "Stepper",
    "String",
    "Surroundings",
    "Sync",
    "ToString",
    "Vec",
];

/// A list of constants, e.g. `coordinate::INDEX_MCP`.
#[derive(Clone, Debug)]
pub(super) struct Indices {
    /// The module that holds them.
    pub(super) module: &'static str,
    /// The constant that counts them.
    pub(super) count: &'static str,
    /// What they index, for documentation.
    pub(super) what: &'static str,
    /// Names in the model.
    pub(super) originals: Vec<String>,
    /// Names of the constants.
    pub(super) constants: Vec<String>,
}

impl Indices {
    fn new(
        module: &'static str,
        count: &'static str,
        what: &'static str,
        names: impl Iterator<Item = String>,
    ) -> Self {
        let originals: Vec<String> = names.collect();
        let wanted: Vec<String> = originals.iter().map(|name| upper(name)).collect();
        let constants = Taken::default().take_all(wanted.iter().map(String::as_str));
        Indices { module, count, what, originals, constants }
    }

    /// How many.
    pub(super) fn len(&self) -> usize {
        self.constants.len()
    }

    fn path(&self, index: usize) -> TokenStream {
        let (module, constant) = (identifier(self.module), identifier(&self.constants[index]));
        quote!(#module::#constant)
    }
}

/// All names of a generated crate.
#[derive(Clone, Debug)]
pub(super) struct Names {
    /// Package and binary.
    pub(super) package: String,
    /// Library.
    pub(super) library: String,
    /// The model's struct.
    pub(super) model: Ident,
    /// Coordinates.
    pub(super) coordinates: Indices,
    /// Strands.
    pub(super) strands: Indices,
    /// Inputs.
    pub(super) inputs: Indices,
    /// Parameters.
    pub(super) params: Indices,
    /// Constraint rows.
    pub(super) rows: Indices,
    /// Frames.
    pub(super) frames: Indices,
    /// Scenarios.
    pub(super) scenarios: Indices,
    /// Parts of blocks.
    pub(super) parts: Vec<String>,
    /// Modules of the shapes, named after the first part of each.
    pub(super) shapes: Vec<String>,
    /// Modules of the linear systems, named after their blocks.
    pub(super) systems: Vec<String>,
    /// Modules of the scenarios.
    pub(super) scenario_modules: Vec<String>,
    /// Fields of `Params`.
    pub(super) param_fields: Vec<String>,
    /// Fields of `Inputs`.
    pub(super) input_fields: Vec<String>,
    /// Numbers in other arrays, by name.
    pub(super) sizes: Vec<(&'static str, usize)>,
}

fn unique(names: impl Iterator<Item = String>) -> Vec<String> {
    let wanted: Vec<String> = names.map(|name| snake(&name)).collect();
    Taken::default().take_all(wanted.iter().map(String::as_str))
}

impl Names {
    /// Names everything in a layout, and frames and shapes besides.
    pub(super) fn new(layout: &Layout, frames: &[String], staged: &Staged) -> Self {
        let parts = group_names(layout, parts(&layout.blocks).iter().map(|part| part.coordinates));
        let blocks = group_names(layout, layout.blocks.iter().map(|b| &b.coordinates[..]));
        let reserved = |name: &str| RESERVED_CRATES.contains(&name);
        let package = if reserved(&layout.name) || !Taken::is_legal(&layout.name) {
            format!("{}_model", layout.name)
        } else {
            layout.name.clone()
        };
        let mut model = camel(&layout.name);
        if RESERVED_TYPES.contains(&model.as_str()) {
            model.push_str("Mechanism");
        }
        let coordinates = layout.coordinates.iter().map(|c| c.name.clone());
        let params = || layout.params.iter().map(|p| p.name.clone());
        let inputs = || layout.inputs.iter().map(|i| i.name.clone());
        let scenarios = || layout.scenarios.iter().map(|s| s.name.clone());
        let rows = layout.rows.iter().map(|r| r.name.clone());
        let strands = layout.strands.iter().map(|s| s.name.clone());
        let frames = frames.iter().cloned();
        let names = Names {
            library: Taken::with(RESERVED_CRATES).take(&snake(&package)),
            package,
            model: identifier(&model),
            coordinates: Indices::new("coordinate", "COORDINATES", "coordinate", coordinates),
            strands: Indices::new("strand", "STRANDS", "strand", strands),
            inputs: Indices::new("input", "INPUTS", "input", inputs()),
            params: Indices::new("parameter", "PARAMETERS", "parameter", params()),
            rows: Indices::new("row", "ROWS", "constraint row", rows),
            frames: Indices::new("frame", "FRAMES", "frame", frames),
            scenarios: Indices::new("scenario", "SCENARIOS", "scenario", scenarios()),
            shapes: staged.shapes.iter().map(|s| parts[s.places[0].part].clone()).collect(),
            parts,
            systems: staged.systems.iter().map(|s| blocks[s.block].clone()).collect(),
            scenario_modules: unique(scenarios()),
            param_fields: unique(params()),
            input_fields: unique(inputs()),
            sizes: Vec::new(),
        };
        let mut sizes = vec![
            ("MATRIX", layout.matrix_size()),
            ("JACOBIAN", layout.constraint_size()),
            ("ARMS", names.strands.len() * names.coordinates.len()),
            ("POSES", 12 * names.frames.len()),
            ("VALUES", staged.values),
        ];
        if !layout.wraps.is_empty() {
            sizes.push(("CLEARANCES", CLEARANCES * layout.wraps.len()));
        }
        if !layout.requirements.is_empty() {
            sizes.push(("NUMBERS", layout.requirements.len()));
        }
        Names { sizes, ..names }
    }

    /// Every list of constants.
    pub(super) fn indices(&self) -> [&Indices; 7] {
        [
            &self.coordinates,
            &self.strands,
            &self.inputs,
            &self.params,
            &self.rows,
            &self.frames,
            &self.scenarios,
        ]
    }

    fn list_of(&self, array: &str) -> Option<&Indices> {
        Some(match array {
            "q" | "v" | "momentum" | "force" => &self.coordinates,
            "residual" | "step" | "size" | "sensitivity" | "pull" | "sizes" => &self.coordinates,
            "rest" | "lengths" | "tensions" => &self.strands,
            "inputs" => &self.inputs,
            "params" => &self.params,
            "lambda" | "rows" | "gaps" | "change" | "row_sensitivity" => &self.rows,
            _ => return None,
        })
    }

    /// The constant that holds the size of an array.
    pub(super) fn size_of(&self, array: &str) -> &'static str {
        match (self.list_of(array), array) {
            (Some(list), _) => list.count,
            (None, "matrix") => "MATRIX",
            (None, "jacobian" | "before" | "after") => "JACOBIAN",
            (None, "arms") => "ARMS",
            (None, "poses") => "POSES",
            (None, "clearances") => "CLEARANCES",
            (None, "numbers") => "NUMBERS",
            (None, _) => "VALUES",
        }
    }
}

/// For each group of coordinates the path that they share, or the first one's name.
fn group_names<'a>(layout: &Layout, groups: impl Iterator<Item = &'a [usize]>) -> Vec<String> {
    let groups: Vec<&[usize]> = groups.collect();
    if let [_] = groups[..] {
        return vec!["whole".to_owned()];
    }
    unique(groups.into_iter().map(|group| {
        let name = |c: &usize| layout.coordinates[*c].name.as_str();
        let first = group.first().map_or("part", name);
        let path: Vec<&str> = first.split('.').collect();
        (1..path.len())
            .rev()
            .map(|count| path[..count].join("."))
            .find(|path| group.iter().all(|c| name(c).starts_with(&format!("{path}."))))
            .unwrap_or_else(|| first.to_owned())
    }))
}

impl Naming for Names {
    fn label(&self, leaf: Leaf) -> String {
        match leaf {
            Leaf::Q(i) => format!("q_{}", self.coordinates.originals[i as usize]),
            Leaf::V(i) => format!("v_{}", self.coordinates.originals[i as usize]),
            Leaf::Rest(i) => format!("rest_{}", self.strands.originals[i as usize]),
            Leaf::Length(i) => format!("length_{}", self.strands.originals[i as usize]),
            Leaf::Param(i) => self.params.originals[i as usize].clone(),
            Leaf::Input(i) => self.inputs.originals[i as usize].clone(),
            Leaf::Own(_) | Leaf::Strand(..) => unreachable!("staging replaces {leaf:?}"),
            Leaf::Lambda(i) => format!("lambda_{}", self.rows.originals[i as usize]),
            Leaf::Value(i) => format!("value_{i}"),
            Leaf::Constant(i) => format!("c_{i}"),
            Leaf::System(array, i) => {
                let named = |list: &Indices| list.originals[i as usize].clone();
                match array {
                    SystemArray::Matrix => format!("j_{i}"),
                    SystemArray::Before => format!("g_before_{i}"),
                    SystemArray::After => format!("g_after_{i}"),
                    SystemArray::Factors => format!("factor_{i}"),
                    SystemArray::Size => format!("size_{}", named(&self.coordinates)),
                    SystemArray::Residual => format!("r_{}", named(&self.coordinates)),
                    SystemArray::Gaps => format!("gap_{}", named(&self.rows)),
                    SystemArray::Momentum => format!("p_{i}"),
                    SystemArray::Step => format!("step_{}", named(&self.coordinates)),
                }
            }
            Leaf::Time => "t".to_owned(),
            Leaf::Step => "h".to_owned(),
        }
    }

    fn index(&self, array: &str, index: usize) -> TokenStream {
        match self.list_of(array) {
            Some(list) => list.path(index),
            None => {
                let index = integer(index);
                quote!(#index)
            }
        }
    }

    fn array_type(&self, array: &str) -> TokenStream {
        // Each scenario has its own number of columns.
        if array == "records" {
            return quote!([f64]);
        }
        let size = identifier(self.size_of(array));
        quote!([f64; #size])
    }
}
