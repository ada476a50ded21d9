//! The generated `parameters.rs`: parameters and inputs by name.

use super::names::Names;
use crate::emit::function::doc_line;
use crate::emit::literal::number;
use crate::emit::print::identifier;
use handc_runtime::mechanism::Mechanism;
use proc_macro2::TokenStream;
use quote::quote;

/// A field: its name, documentation and unit.
struct Field<'a> {
    name: &'a str,
    original: &'a str,
    doc: &'a str,
    unit: &'a str,
}

/// The module.
pub(super) fn module(mechanism: &Mechanism, names: &Names) -> TokenStream {
    let params: Vec<Field> = mechanism
        .params
        .iter()
        .zip(&names.param_fields)
        .map(|(p, name)| Field { name, original: &p.name, doc: &p.doc, unit: &p.unit })
        .collect();
    let inputs: Vec<Field> = mechanism
        .inputs
        .iter()
        .zip(&names.input_fields)
        .map(|(i, name)| Field { name, original: &i.name, doc: &i.doc, unit: &i.unit })
        .collect();
    let params = record("Params", "Parameters of the model.", "PARAMETERS", &params);
    let inputs = record("Inputs", "External inputs, constant over a step.", "INPUTS", &inputs);
    let defaults = mechanism.params.iter().map(|p| number(p.default));
    quote! {
        //! Parameters and inputs by name.

        use crate::layout::{INPUTS, PARAMETERS};

        /// Defaults of the parameters.
        const DEFAULTS: [f64; PARAMETERS] = [#(#defaults),*];

        #params

        impl Default for Params {
            /// The model's own values.
            fn default() -> Self {
                Params::from_array(&DEFAULTS)
            }
        }

        #inputs
    }
}

fn record(name: &str, opening: &str, count: &str, fields: &[Field]) -> TokenStream {
    let (name, count) = (identifier(name), identifier(count));
    let opening = doc_line(opening);
    let idents: Vec<_> = fields.iter().map(|field| identifier(field.name)).collect();
    let docs = fields.iter().map(|field| {
        let unit = if field.unit.is_empty() { "1" } else { field.unit };
        let lines = field.doc.lines().map(doc_line);
        let last = doc_line(&format!("`{}` ({unit}).", field.original));
        quote!(#(#lines)* #last)
    });
    quote! {
        #opening
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct #name {
            #(#docs pub #idents: f64,)*
        }

        impl #name {
            /// In the order of the model.
            pub fn to_array(self) -> [f64; #count] {
                [#(self.#idents),*]
            }

            /// From values in the order of the model.
            pub fn from_array(&[#(#idents),*]: &[f64; #count]) -> Self {
                Self { #(#idents),* }
            }
        }
    }
}
