//! The generated `layout.rs`: counts, named indices, and the layout as data.

use super::imports;
use super::names::{Indices, Names};
use crate::emit::function::doc_line;
use crate::emit::literal::{integer, number};
use crate::emit::print::identifier;
use handc_core::layout::{Block, CoordinateKind, Layout, Muscle, Quantity, ScenarioLayout};
use proc_macro2::TokenStream;
use quote::quote;

/// The module.
pub(super) fn module(layout: &Layout, names: &Names) -> TokenStream {
    let lists = names.indices();
    let counts = lists.iter().map(|list| {
        let (count, value) = (identifier(list.count), integer(list.len()));
        let doc = doc_line(&format!("Number of {}s.", list.what));
        quote!(#doc pub const #count: usize = #value;)
    });
    let sizes = names.sizes.iter().map(|(name, size)| {
        let (doc, value) = (doc_line(size_doc(name)), integer(*size));
        let name = identifier(name);
        quote!(#doc pub const #name: usize = #value;)
    });
    let modules = lists.iter().filter(|list| list.len() > 0).map(|list| indices(list));
    let data = data(layout);
    let types = [
        "Block",
        "ConstraintRow",
        "Coordinate",
        "CoordinateKind",
        "Follow",
        "Layout",
        "Muscle",
        "Quantity",
        "Requirement",
        "ScenarioLayout",
        "Strand",
        "Wrap",
    ];
    let uses = imports::from(quote!(handc_core::layout), &types, &data);
    quote! {
        //! Names, counts and indices of the model.

        #uses

        #(#counts)*
        #(#sizes)*
        #(#modules)*
        #data
    }
}

fn size_doc(name: &str) -> &'static str {
    match name {
        "MATRIX" => "Numbers in a packed Newton or mass matrix.",
        "JACOBIAN" => "Numbers in a packed constraint Jacobian.",
        "ARMS" => "Numbers in a matrix of moment arms.",
        "NUMBERS" => "Numbers that must lie in their ranges.",
        "CLEARANCES" => "Numbers that tell how passable surfaces are.",
        "POSES" => "Numbers in the poses of all frames.",
        _ => "Numbers that follow from parameters.",
    }
}

fn indices(list: &Indices) -> TokenStream {
    let module = identifier(list.module);
    let opening = doc_line(&format!("Positions by {} name.", list.what));
    let constants = list.constants.iter().zip(&list.originals).enumerate().map(
        |(index, (constant, original))| {
            let (doc, constant) = (doc_line(&format!("`{original}`.")), identifier(constant));
            let index = integer(index);
            quote!(#doc pub const #constant: usize = #index;)
        },
    );
    quote! {
        #opening
        pub mod #module {
            #(#constants)*
        }
    }
}

fn list(values: &[usize]) -> TokenStream {
    let values = values.iter().map(|&value| integer(value));
    quote!(vec![#(#values),*])
}

fn quantity(quantity: &Quantity) -> TokenStream {
    let (name, unit) = (&quantity.name, &quantity.unit);
    quote!(Quantity { name: #name.into(), unit: #unit.into() })
}

fn block(block: &Block) -> TokenStream {
    let (coordinates, rows, parts) =
        (list(&block.coordinates), list(&block.rows), list(&block.parts));
    let matrix_offset = integer(block.matrix_offset);
    let constraint_offset = integer(block.constraint_offset);
    quote!(Block {
        coordinates: #coordinates,
        rows: #rows,
        parts: #parts,
        matrix_offset: #matrix_offset,
        constraint_offset: #constraint_offset,
    })
}

fn scenario(scenario: &ScenarioLayout) -> TokenStream {
    let (name, driven) = (&scenario.name, list(&scenario.driven));
    let follow = scenario.follow.iter().map(|follow| {
        let (motion, strands) = (integer(follow.motion), list(&follow.strands));
        quote!(Follow { motion: #motion, strands: #strands })
    });
    let records = &scenario.records;
    quote!(ScenarioLayout {
        name: #name.into(),
        driven: #driven,
        follow: vec![#(#follow),*],
        records: vec![#(#records.into()),*],
    })
}

fn muscle(muscle: Option<&Muscle>) -> TokenStream {
    let Some(muscle) = muscle else { return quote!(None) };
    let [fibre, activation, excitation] =
        [muscle.fibre, muscle.activation, muscle.excitation].map(integer);
    let has_start = muscle.has_start;
    quote!(Some(Muscle {
        fibre: #fibre,
        activation: #activation,
        excitation: #excitation,
        has_start: #has_start,
    }))
}

fn data(layout: &Layout) -> TokenStream {
    let name = &layout.name;
    let params = layout.params.iter().map(quantity);
    let inputs = layout.inputs.iter().map(quantity);
    let coordinates = layout.coordinates.iter().map(|c| {
        let (name, kinematic) = (&c.name, c.kinematic);
        let (is_static, is_internal) = (c.is_static, c.is_internal);
        let kind = match c.kind {
            CoordinateKind::Angle => quote!(Angle),
            CoordinateKind::Length => quote!(Length),
            CoordinateKind::Ratio => quote!(Ratio),
        };
        quote!(Coordinate {
            name: #name.into(),
            kind: CoordinateKind::#kind,
            kinematic: #kinematic,
            is_static: #is_static,
            is_internal: #is_internal,
        })
    });
    let strands = layout.strands.iter().map(|s| {
        let (name, has_rest, is_prescribed) = (&s.name, s.has_rest, s.is_prescribed);
        let rest_varies = s.rest_varies;
        let actuator = match s.actuator {
            Some(input) => {
                let input = integer(input);
                quote!(Some(#input))
            }
            None => quote!(None),
        };
        let muscle = muscle(s.muscle.as_ref());
        quote!(Strand {
            name: #name.into(),
            has_rest: #has_rest,
            rest_varies: #rest_varies,
            is_prescribed: #is_prescribed,
            actuator: #actuator,
            muscle: #muscle,
        })
    });
    let wraps = layout.wraps.iter().map(|wrap| {
        let (strand, surface) = (integer(wrap.strand), &wrap.surface);
        quote!(Wrap { strand: #strand, surface: #surface.into() })
    });
    let requirements = layout.requirements.iter().map(|r| {
        let (text, source) = (&r.text, &r.source);
        let (least, most) = (number(r.least), number(r.most));
        quote!(Requirement {
            text: #text.into(),
            source: #source.into(),
            least: #least,
            most: #most,
        })
    });
    let rows = layout.rows.iter().map(|r| {
        let name = &r.name;
        quote!(ConstraintRow { name: #name.into() })
    });
    let blocks = layout.blocks.iter().map(block);
    let scenarios = layout.scenarios.iter().map(scenario);
    let length_scale = number(layout.length_scale);
    quote! {
        /// The layout as data.
        pub fn layout() -> Layout {
            Layout {
                name: #name.into(),
                params: vec![#(#params),*],
                inputs: vec![#(#inputs),*],
                coordinates: vec![#(#coordinates),*],
                strands: vec![#(#strands),*],
                wraps: vec![#(#wraps),*],
                requirements: vec![#(#requirements),*],
                rows: vec![#(#rows),*],
                blocks: vec![#(#blocks),*],
                scenarios: vec![#(#scenarios),*],
                length_scale: #length_scale,
            }
        }
    }
}
