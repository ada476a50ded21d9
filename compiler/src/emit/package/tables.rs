//! What a generated crate leaves to loops over tables: the methods that hand it on, and the generated
//! `mechanism.rs` with the mechanism as constant data.

use super::manifest::MARKER;
use super::write::File;
use crate::emit::data::Data;
use crate::emit::print::identifier;
use crate::stage::{Group, Staged};
use handc_runtime::mechanism::Mechanism;
use proc_macro2::{Ident, TokenStream};
use quote::quote;
use std::fmt::Write;

/// Lists of more items than this are functions of their own.
const SHORT: usize = 4;
/// Items that one function makes; the optimiser's time grows faster than the length of functions.
const PIECE: usize = 16;

/// The methods of `Model` that a group answers, with their arguments.
fn methods_of(group: Group) -> &'static [(&'static str, &'static [&'static str])] {
    match group {
        Group::Equations => &[
            ("evaluate", &["at", "momentum", "force"]),
            ("evaluate_with_matrix", &["at", "h", "momentum", "force", "matrix"]),
            ("mass_matrix", &["q", "matrix"]),
            ("strand_lengths", &["q", "lengths"]),
        ],
        Group::Constraints => &[
            ("constraints", &["q", "t", "rest", "rows"]),
            ("constraint_jacobian", &["q", "t", "jacobian"]),
        ],
        Group::Strands => {
            &[("commands", &["at", "tensions"]), ("clearances", &["q", "clearances"])]
        }
        Group::Time => &[
            ("inputs", &["t", "values"]),
            ("rests", &["t", "inputs", "lengths"]),
            ("drives", &["t", "path"]),
            ("start", &["path", "rates"]),
            ("required_numbers", &["numbers"]),
        ],
        Group::Scenarios => &[
            ("scenario_inputs", &["scenario", "t", "values"]),
            ("scenario_drives", &["scenario", "t", "path"]),
            ("scenario_rests", &["scenario", "t", "lengths"]),
            ("scenario_records", &["scenario", "instant", "values"]),
        ],
        Group::Energy => &[("potential", &["q", "rest"])],
        Group::Systems | Group::MomentArms | Group::Frames => &[],
    }
}

/// The type of an argument.
fn type_of(argument: &str) -> TokenStream {
    match argument {
        "at" => quote!(&Midpoint),
        "instant" => quote!(&Instant),
        "t" | "h" => quote!(f64),
        "scenario" => quote!(usize),
        "q" | "rest" | "inputs" => quote!(&[f64]),
        _ => quote!(&mut [f64]),
    }
}

/// Methods of `Model` that hand on to the tables.
pub(super) fn methods(staged: &Staged) -> TokenStream {
    let all = staged.tables.iter().flat_map(|&group| methods_of(group));
    all.map(|(name, arguments)| {
        let method = identifier(name);
        let names: Vec<Ident> = arguments.iter().map(|argument| identifier(argument)).collect();
        let types = arguments.iter().map(|argument| type_of(argument));
        let result = (*name == "potential").then(|| quote!(-> f64));
        let end = result.is_none().then(|| quote!(;));
        quote! {
            fn #method(&mut self, #(#names: #types),*) #result {
                self.tables.#method(#(#names),*) #end
            }
        }
    })
    .collect()
}

/// The module `mechanism.rs`.
pub(super) fn mechanism(mechanism: &Mechanism) -> File {
    let Data::Fields(name, fields) = Data::of(mechanism) else {
        unreachable!("a mechanism is a structure")
    };
    let (mut whole, mut lists) = (String::new(), String::new());
    for (field, data) in &fields {
        let value = match data {
            Data::List(items) if items.len() > SHORT => match &items[0] {
                Data::Fields(item, _) => {
                    list(field, item, items, &mut lists);
                    format!("{field}()")
                }
                _ => data.print(8, [field.len() + 2, 1]),
            },
            _ => data.print(8, [field.len() + 2, 1]),
        };
        // Writing to a string cannot fail.
        let _ = writeln!(whole, "        {field}: {value},");
    }
    let text = format!(
        "// {MARKER} from the model; changes here are lost.\n\n\
         //! The mechanism as constant data, for what loops over tables compute.\n\n\
         use handc_runtime::expression::*;\n\
         use handc_runtime::mechanism::Number::*;\n\
         use handc_runtime::mechanism::*;\n\n\
         /// All of it.\n\
         pub(crate) fn mechanism() -> {name} {{\n    {name} {{\n{whole}    }}\n}}\n{lists}"
    );
    File { path: "src/mechanism.rs".to_owned(), text }
}

/// A function that makes a list, in pieces if it is long.
fn list(field: &str, item: &str, items: &[Data], text: &mut String) {
    let piece = |name: &str, items: &[Data]| {
        let list = Data::List(items.to_vec()).print(4, [0, 0]);
        format!("\nfn {name}() -> Vec<{item}> {{\n    {list}\n}}\n")
    };
    if items.len() <= PIECE {
        text.push_str(&piece(field, items));
        return;
    }
    let pieces: Vec<&[Data]> = items.chunks(PIECE).collect();
    let names = (0..pieces.len()).map(|number| format!("{field}_{number}"));
    let calls: Vec<String> = names.clone().map(|name| format!("        {name}(),\n")).collect();
    let _ = write!(
        text,
        "\nfn {field}() -> Vec<{item}> {{\n    [\n{}    ]\n    .concat()\n}}\n",
        calls.concat()
    );
    for (name, items) in names.zip(pieces) {
        text.push_str(&piece(&name, items));
    }
}
