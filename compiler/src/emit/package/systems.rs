//! The generated `systems`: linear systems of constrained blocks as the integrator sees them.

use super::modules::Placed;
use super::names::Names;
use crate::emit::function::Naming;
use crate::emit::literal::integer;
use crate::emit::print::identifier;
use crate::graph::Leaf;
use crate::stage::{Module, Staged, System};
use proc_macro2::TokenStream;
use quote::quote;

/// Names inside the code of a system.
pub(super) struct SystemNames<'a> {
    pub(super) names: &'a Names,
    pub(super) system: &'a System,
}

impl Naming for SystemNames<'_> {
    fn label(&self, leaf: Leaf) -> String {
        self.names.label(leaf)
    }

    fn index(&self, array: &str, index: usize) -> TokenStream {
        self.names.index(array, index)
    }

    fn array_type(&self, array: &str) -> TokenStream {
        if array == "factors" {
            let count = integer(self.system.factors);
            return quote!([f64; #count]);
        }
        self.names.array_type(array)
    }
}

/// A closure that hands slices on to the function `name` of a system as arrays.
fn closure(
    names: &Names,
    functions: &[Placed],
    number: usize,
    name: &str,
    of: &[&str],
) -> TokenStream {
    let module = Module::System(number);
    let own = functions.iter().find(|p| p.module == module && p.emitted.name == name);
    let arguments = own.map_or(&[][..], |placed| &placed.emitted.arguments);
    let parameters = of.iter().map(|name| match arguments.iter().any(|a| a.name == *name) {
        true => identifier(name),
        false => identifier(&format!("_{name}")),
    });
    let arrays = arguments.iter().map(|argument| {
        let name = identifier(argument.name);
        match argument.is_output {
            true => quote!(let #name = sized_mut(#name);),
            false => quote!(let #name = sized(#name);),
        }
    });
    let path = identifier(&names.systems[number]);
    let call = own.map(|placed| placed.emitted.call(&quote!(#path::)));
    quote!(|#(#parameters),*| { #(#arrays)* #call })
}

/// `systems/mod.rs`.
pub(super) fn module(names: &Names, staged: &Staged, functions: &[Placed]) -> TokenStream {
    let modules = names.systems.iter().map(|name| identifier(name));
    let systems = staged.systems.iter().enumerate().map(|(number, system)| {
        let (block, factors) = (integer(system.block), integer(system.factors));
        let closure = |name: &str, of: &[&str]| closure(names, functions, number, name, of);
        let of = ["matrix", "after", "size", "sensitivity", "row_sensitivity"];
        let sensitivities = closure("sensitivities", &of);
        let pull = closure("pull", &["before", "lambda", "pull"]);
        let pull_sizes = closure("pull_sizes", &["before", "lambda", "sizes"]);
        let factor = closure("factor", &["matrix", "before", "after", "factors"]);
        let solve = closure("solve", &["factors", "residual", "gaps", "step", "change"]);
        quote!(System {
            block: #block,
            factors: #factors,
            sensitivities: #sensitivities,
            pull: #pull,
            pull_sizes: #pull_sizes,
            factor: #factor,
            solve: #solve,
        })
    });
    let count = integer(staged.systems.len());
    quote! {
        //! Linear systems of the constrained blocks, eliminated in an order that suits them.

        use handc_core::array::{sized, sized_mut};
        use handc_core::system::System;

        #(pub mod #modules;)*

        /// Those that are written out.
        pub static SYSTEMS: [System; #count] = [#(#systems),*];
    }
}
