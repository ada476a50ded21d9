//! The generated `blocks/mod.rs`: all parts of blocks together, with their constants.

use super::imports;
use super::modules::Placed;
use super::names::Names;
use super::shapes::sizes;
use crate::emit::literal::integer;
use crate::emit::print::identifier;
use crate::stage::{Module, Shape, Staged};
use proc_macro2::{Ident, TokenStream};
use quote::quote;

/// Whether the equations can be computed on lanes: none was cut into several functions.
pub(super) fn has_lanes(functions: &[Placed]) -> bool {
    let mut parts =
        functions.iter().filter(|p| matches!(p.module, Module::Part(_))).map(|p| &p.emitted);
    parts.all(|emitted| emitted.parts == 1)
}

/// `Equations` of a shape with its first two sizes, or with all.
fn equations(module: &Ident, shape: &Shape, count: usize) -> TokenStream {
    let sizes = sizes(shape).into_iter().take(count).map(integer);
    quote!(#module::Equations, #(#sizes),*)
}

/// The module.
pub(super) fn module(names: &Names, staged: &Staged, functions: &[Placed]) -> TokenStream {
    let modules: Vec<Ident> = names.shapes.iter().map(|name| identifier(name)).collect();
    let shapes = || modules.iter().zip(&staged.shapes);
    let fields = shapes().map(|(module, shape)| {
        let (blocks, count) = (integer(shape.places.len()), integer(shape.constants[0].len()));
        quote!(#module: [[f64; #count]; #blocks],)
    });
    let every = |call: &dyn Fn(TokenStream) -> TokenStream| -> TokenStream {
        shapes()
            .map(|(module, shape)| {
                let call = call(equations(module, shape, 2));
                quote! {
                    for (place, constants) in #module::PLACES.iter().zip(&self.#module) {
                        #call
                    }
                }
            })
            .collect()
    };
    let evaluate = every(&|of| quote!(place.evaluate::<#of>(at, constants, momentum, force);));
    let with_matrix = every(&|of| {
        quote! {
            place.evaluate_with_matrix::<#of>(at, h, constants, momentum, force, matrix);
        }
    });
    let mass = every(&|of| quote!(place.mass_matrix::<#of>(q, constants, matrix);));
    let lengths = every(&|of| quote!(place.lengths::<#of>(q, constants, lengths);));
    let on_lanes = has_lanes(functions).then(|| {
        let calls = shapes().map(|(module, shape)| {
            let of = equations(module, shape, 5);
            quote! {
                visitor.blocks::<#of>(&#module::PLACES, |run| of[run].#module.as_flattened());
            }
        });
        quote! {
            /// Shows all parts of several runs, each with its own constants, to a visitor.
            pub fn on_lanes(of: &[&Blocks], visitor: &mut impl LaneVisitor) -> bool {
                #(#calls)*
                visitor.is_complete()
            }
        }
    });
    let use_lanes = has_lanes(functions).then(|| {
        quote!(
            use handc_core::lanes::LaneVisitor;
        )
    });
    let made = shapes().map(|(module, _)| quote!(#module: #module::constants(params, values),));
    let body = quote! {
        #(pub mod #modules;)*

        /// Constants of all parts.
        #[derive(Clone, Debug)]
        pub struct Blocks {
            #(#fields)*
        }

        impl Blocks {
            /// With the given parameters and what follows from them.
            pub fn new(params: &[f64; PARAMETERS], values: &[f64; VALUES]) -> Self {
                Self { #(#made)* }
            }

            /// Momentum p = ∂L/∂v and force f = ∂L/∂q + F at the midpoint of a step.
            pub fn evaluate(&self, at: &Midpoint, momentum: &mut [f64], force: &mut [f64]) {
                #evaluate
            }

            /// As [`Blocks::evaluate`], and the Newton matrix, packed by block.
            pub fn evaluate_with_matrix(
                &self,
                at: &Midpoint,
                h: f64,
                momentum: &mut [f64],
                force: &mut [f64],
                matrix: &mut [f64],
            ) {
                #with_matrix
            }

            /// Mass matrix, packed by block.
            pub fn mass_matrix(&self, q: &[f64], matrix: &mut [f64]) {
                #mass
            }

            /// Lengths of the strands that span a part (m).
            pub fn lengths(&self, q: &[f64], lengths: &mut [f64]) {
                #lengths
            }

            #on_lanes
        }
    };
    let local = imports::from(quote!(crate::layout), &["PARAMETERS", "VALUES"], &body);
    quote! {
        //! Step equations, part by part: coordinates that the Newton matrix couples without the help of
        //! constraints. Like parts share one module.

        #local
        #use_lanes
        use handc_core::model::Midpoint;

        #body
    }
}
