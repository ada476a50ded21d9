//! The generated `model.rs`: the struct and what a user calls on it.

use super::imports;
use super::modules::{Placed, path};
use super::names::Names;
use crate::emit::function::doc_line;
use crate::emit::print::identifier;
use crate::stage::{Group, Module, Staged};
use handc_runtime::mechanism::Mechanism;
use proc_macro2::TokenStream;
use quote::quote;

/// The module.
pub(super) fn module(
    mechanism: &Mechanism,
    names: &Names,
    staged: &Staged,
    functions: &[Placed],
) -> TokenStream {
    let model = &names.model;
    let doc: Vec<_> = match mechanism.doc.is_empty() {
        true => vec![doc_line(&format!("The model `{}`.", mechanism.name))],
        false => mechanism.doc.lines().map(doc_line).collect(),
    };
    let update = match find(functions, Module::Values, "update") {
        Some(placed) => {
            let call = placed.emitted.call(&path(placed.module, names));
            quote! {
                let params = &self.params;
                let values = &mut self.values;
                #call;
            }
        }
        None => TokenStream::new(),
    };
    let has_blocks = !staged.shapes.is_empty();
    let blocks_field = has_blocks.then(|| quote!(pub(crate) blocks: Blocks,));
    let blocks_made = has_blocks.then(|| quote!(blocks: Blocks::new(&params, &values),));
    let blocks_update =
        has_blocks.then(|| quote!(self.blocks = Blocks::new(&self.params, &self.values);));
    let use_blocks = has_blocks.then(|| {
        quote!(
            use crate::blocks::Blocks;
        )
    });
    let has_tables = !staged.tables.is_empty();
    let tables_field = has_tables.then(|| {
        quote! {
            /// What is computed by loops over constant data.
            pub(crate) tables: Tables,
        }
    });
    let tables_made = has_tables.then(|| quote!(tables: Tables::new(mechanism()),));
    let tables_update = has_tables.then(|| quote!(self.tables.set_params(&self.params);));
    let use_mechanism = has_tables.then(|| {
        quote!(
            use crate::mechanism::mechanism;
        )
    });
    let use_tables = has_tables.then(|| {
        quote!(
            use handc_runtime::tables::Tables;
        )
    });
    let strands = strands(names, staged, functions);
    let frames = frames(names, staged, functions);
    let body = quote! {
        #(#doc)*
        #[derive(Clone, Debug)]
        pub struct #model {
            pub(crate) layout: Arc<Layout>,
            pub(crate) params: [f64; PARAMETERS],
            pub(crate) values: [f64; VALUES],
            #blocks_field
            #tables_field
            /// A stamp of the parameters.
            pub(crate) revision: u64,
        }

        impl Default for #model {
            fn default() -> Self {
                Self::new()
            }
        }

        impl #model {
            /// The model with its own parameters.
            pub fn new() -> Self {
                Self::with_params(Params::default())
            }

            /// The model with other parameters.
            pub fn with_params(params: Params) -> Self {
                let params = params.to_array();
                let values = [0.0; VALUES];
                let mut model = Self {
                    layout: Arc::new(layout()),
                    #blocks_made
                    #tables_made
                    params,
                    values,
                    revision: 0,
                };
                model.update();
                model
            }

            /// The parameters by name.
            pub fn parameters(&self) -> Params {
                Params::from_array(&self.params)
            }

            /// Sets all parameters.
            pub fn set_parameters(&mut self, params: Params) {
                self.params = params.to_array();
                self.update();
            }

            /// The model's own inputs at time `t` (s).
            pub fn default_inputs(&mut self, t: f64) -> Inputs {
                let mut inputs = [0.0; INPUTS];
                Model::inputs(self, t, &mut inputs);
                Inputs::from_array(&inputs)
            }

            /// A run of a scenario.
            pub fn simulate(&self, settings: &Settings) -> Result<Simulation<Self>, RunError> {
                Simulation::new(self.clone(), settings)
            }

            /// Takes one step of the discrete Euler-Lagrange equations. On an error the state is
            /// untouched.
            pub fn step(
                &mut self,
                stepper: &mut Stepper,
                state: &mut State,
                around: &Surroundings,
            ) -> Result<(), StepError> {
                stepper.step(self, state, around)
            }

            /// Left side of the step equations at a midpoint without constraint forces,
            /// p0 + (h/2)·f − p; entries of kinematic coordinates mean nothing.
            pub fn residual(
                &mut self,
                at: &Midpoint,
                h: f64,
                p0: &[f64; COORDINATES],
            ) -> [f64; COORDINATES] {
                let mut momentum = [0.0; COORDINATES];
                let mut force = [0.0; COORDINATES];
                self.evaluate(at, &mut momentum, &mut force);
                std::array::from_fn(|i| p0[i] + 0.5 * h * force[i] - momentum[i])
            }

            /// Derivative of the residual by the coordinates at the end of the step, packed by block:
            /// −M/h + ½(L_qv − L_vq) + (h/4)(L_qq + F_q) + ½F_v.
            pub fn jacobian(&mut self, at: &Midpoint, h: f64) -> [f64; MATRIX] {
                let mut momentum = [0.0; COORDINATES];
                let mut force = [0.0; COORDINATES];
                let mut matrix = [0.0; MATRIX];
                self.evaluate_with_matrix(at, h, &mut momentum, &mut force, &mut matrix);
                matrix
            }

            /// Kinetic energy ½vᵀMv of the dynamic coordinates plus potential energy (J).
            pub fn energy(
                &mut self,
                q: &[f64; COORDINATES],
                v: &[f64; COORDINATES],
                rest: &[f64; STRANDS],
            ) -> f64 {
                let mut matrix = [0.0; MATRIX];
                self.mass_matrix(q, &mut matrix);
                let mut energy = self.potential(q, rest);
                for block in &self.layout.blocks {
                    let count = block.coordinates.len();
                    for (i, &row) in block.coordinates.iter().enumerate() {
                        for (j, &column) in block.coordinates.iter().enumerate() {
                            let mass = matrix[block.matrix_offset + i * count + j];
                            energy += 0.5 * v[row] * mass * v[column];
                        }
                    }
                }
                energy
            }

            #strands
            #frames

            /// Works out again what follows from the parameters.
            pub(crate) fn update(&mut self) {
                #update
                #blocks_update
                #tables_update
                self.revision = next_revision();
            }
        }
    };
    let counts = [
        "ARMS",
        "COORDINATES",
        "FRAMES",
        "INPUTS",
        "MATRIX",
        "PARAMETERS",
        "POSES",
        "STRANDS",
        "VALUES",
        "layout",
    ];
    let counts = imports::from(quote!(crate::layout), &counts, &body);
    let types = imports::from(quote!(crate::frames), &["Pose"], &body);
    let local = imports::from(quote!(crate), &["frames", "strands"], &body);
    let local_values = (!update_is_empty(functions)).then(|| {
        quote!(
            use crate::values;
        )
    });
    quote! {
        //! The model and what can be asked of it.

        #use_blocks
        #use_mechanism
        #local
        #local_values
        #types
        #counts
        use crate::parameters::{Inputs, Params};
        use handc_core::error::{RunError, StepError};
        use handc_core::lanes::next_revision;
        use handc_core::layout::Layout;
        use handc_core::model::{Midpoint, Model};
        use handc_core::simulation::{Settings, Simulation};
        use handc_core::step::{State, Stepper, Surroundings};
        #use_tables
        use std::sync::Arc;

        #body
    }
}

fn update_is_empty(functions: &[Placed]) -> bool {
    find(functions, Module::Values, "update").is_none()
}

fn find<'a>(functions: &'a [Placed], module: Module, name: &str) -> Option<&'a Placed> {
    functions.iter().find(|placed| placed.module == module && placed.emitted.name == name)
}

/// A method that fills an array of results from `q`.
fn by_q(
    names: &Names,
    functions: &[Placed],
    (module, function): (Module, &str),
    array: &str,
) -> (TokenStream, TokenStream) {
    let Some(placed) = find(functions, module, function) else {
        return (quote!(_q), TokenStream::new());
    };
    let call = placed.emitted.call(&path(placed.module, names));
    let has = |name: &str| placed.emitted.arguments.iter().any(|a| a.name == name);
    let params = has("params").then(|| quote!(let params = &self.params;));
    let values = has("values").then(|| quote!(let values = &self.values;));
    let array = identifier(array);
    let q = if has("q") { quote!(q) } else { quote!(_q) };
    (q, quote!(#params #values let #array = &mut #array; #call;))
}

fn strands(names: &Names, staged: &Staged, functions: &[Placed]) -> TokenStream {
    if names.strands.len() == 0 {
        return TokenStream::new();
    }
    let (mut q, outside) = by_q(names, functions, (Module::Strands, "lengths"), "lengths");
    let outside = (!outside.is_empty()).then(|| quote!({ #outside }));
    let has_blocks = !staged.shapes.is_empty();
    let by_tables = staged.tables.contains(&Group::Equations);
    let elsewhere = (has_blocks || by_tables).then(|| {
        q = quote!(q);
        match by_tables {
            true => quote!(self.tables.lengths_at(q, &mut lengths);),
            false => quote!(self.blocks.lengths(q, &mut lengths);),
        }
    });
    let lengths = quote! {
        /// Lengths of all strands (m).
        pub fn strand_lengths(&self, #q: &[f64; COORDINATES]) -> [f64; STRANDS] {
            let mut lengths = [0.0; STRANDS];
            #outside
            #elsewhere
            lengths
        }
    };
    let (q, arms) = if staged.tables.contains(&Group::MomentArms) {
        (quote!(q), quote!(self.tables.moment_arms_at(q, &mut arms);))
    } else if find(functions, Module::Strands, "moment_arms").is_some() {
        by_q(names, functions, (Module::Strands, "moment_arms"), "arms")
    } else {
        return lengths;
    };
    quote! {
        #lengths

        /// Moment arms ∂x/∂q of all strands (m/rad or 1): that of strand s by coordinate c stands
        /// at `s * COORDINATES + c`.
        pub fn moment_arms(&self, #q: &[f64; COORDINATES]) -> [f64; ARMS] {
            let mut arms = [0.0; ARMS];
            { #arms }
            arms
        }
    }
}

fn frames(names: &Names, staged: &Staged, functions: &[Placed]) -> TokenStream {
    if names.frames.len() == 0 {
        return TokenStream::new();
    }
    let (q, poses) = match staged.tables.contains(&Group::Frames) {
        true => (quote!(q), quote!(self.tables.poses_at(q, &mut poses);)),
        false => by_q(names, functions, (Module::Frames, "write_poses"), "poses"),
    };
    quote! {
        /// Poses of all frames in the world.
        pub fn frame_poses(&self, #q: &[f64; COORDINATES]) -> [Pose; FRAMES] {
            let mut poses = [0.0; POSES];
            { #poses }
            std::array::from_fn(|index| Pose::read(&poses, index))
        }
    }
}
