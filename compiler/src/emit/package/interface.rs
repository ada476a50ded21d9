//! The generated `interface.rs`: the model as the integrator sees it.

use super::blocks;
use super::imports;
use super::modules::{Placed, folder, path};
use super::names::Names;
use super::tables;
use crate::emit::print::identifier;
use crate::stage::{Group, Module, Staged};
use proc_macro2::TokenStream;
use quote::quote;

/// Calls to functions of one name, with what prepares their arguments.
struct Body {
    calls: TokenStream,
    arguments: Vec<&'static str>,
}

/// Collects the calls of every function `name` in the modules that `wanted` accepts.
fn body(functions: &[Placed], names: &Names, name: &str, wanted: impl Fn(Module) -> bool) -> Body {
    let mut calls = TokenStream::new();
    let mut arguments = Vec::new();
    for placed in functions.iter().filter(|p| wanted(p.module) && p.emitted.name == name) {
        let call = placed.emitted.call(&path(placed.module, names));
        calls.extend(quote!(#call;));
        arguments.extend(placed.emitted.arguments.iter().map(|a| a.name));
    }
    Body { calls, arguments }
}

/// `let q = sized(at.q);` and the like, for those of `sources` that the calls need. Outputs are
/// marked with `&mut`.
fn prelude(needed: &[&str], sources: &[(&str, TokenStream)]) -> TokenStream {
    sources
        .iter()
        .filter(|(name, _)| needed.contains(name))
        .map(|(name, source)| {
            let name = identifier(name);
            quote!(let #name = #source;)
        })
        .collect()
}

/// The arguments of a method, with an underscore before those that its body does not mention.
fn arguments(list: &[(&str, TokenStream)], body: &TokenStream) -> TokenStream {
    let mentioned = imports::mentioned(body);
    list.iter()
        .map(|(name, of)| {
            let name = match mentioned.contains(*name) {
                true => identifier(name),
                false => identifier(&format!("_{name}")),
            };
            quote!(#name: #of,)
        })
        .collect()
}

fn method(name: &str, list: &[(&str, TokenStream)], body: &TokenStream) -> TokenStream {
    let (name, arguments) = (identifier(name), arguments(list, body));
    quote! {
        fn #name(&mut self, #arguments) { #body }
    }
}

/// What every function may read of the model itself.
fn own() -> [(&'static str, TokenStream); 2] {
    [("params", quote!(&self.params)), ("values", quote!(&self.values))]
}

/// The module.
pub(super) fn module(names: &Names, staged: &Staged, functions: &[Placed]) -> TokenStream {
    let input = || quote!(&[f64]);
    let output = || quote!(&mut [f64]);
    let make = |function: &str,
                method_name: &str,
                wanted: &dyn Fn(Module) -> bool,
                sources: Vec<(&'static str, TokenStream)>,
                list: &[(&str, TokenStream)]| {
        let body = body(functions, names, function, wanted);
        let sources: Vec<_> = own().into_iter().chain(sources).collect();
        let prelude = prelude(&body.arguments, &sources);
        let calls = body.calls;
        method(method_name, list, &quote!(#prelude #calls))
    };
    let read = |name: &'static str| {
        let ident = identifier(name);
        (name, quote!(sized(#ident)))
    };
    let write = |name: &'static str, from: &str| {
        let ident = identifier(from);
        (name, quote!(sized_mut(#ident)))
    };
    let f64 = || quote!(f64);
    let methods = [
        (
            Group::Constraints,
            make(
                "rows",
                "constraints",
                &|m| m == Module::Constraints,
                vec![read("q"), read("rest"), write("rows", "rows")],
                &[("q", input()), ("t", f64()), ("rest", input()), ("rows", output())],
            ),
        ),
        (
            Group::Constraints,
            make(
                "jacobian",
                "constraint_jacobian",
                &|m| m == Module::Constraints,
                vec![read("q"), write("jacobian", "jacobian")],
                &[("q", input()), ("t", f64()), ("jacobian", output())],
            ),
        ),
        (
            Group::Time,
            make(
                "inputs",
                "inputs",
                &|m| m == Module::Time,
                vec![write("inputs", "inputs")],
                &[("t", f64()), ("inputs", output())],
            ),
        ),
        (
            Group::Time,
            make(
                "rests",
                "rests",
                &|m| m == Module::Time,
                vec![read("inputs"), write("rest", "rest")],
                &[("t", f64()), ("inputs", input()), ("rest", output())],
            ),
        ),
        (
            Group::Time,
            make(
                "drives",
                "drives",
                &|m| m == Module::Time,
                vec![write("q", "q")],
                &[("t", f64()), ("q", output())],
            ),
        ),
        (
            Group::Time,
            make(
                "start",
                "start",
                &|m| m == Module::Time,
                vec![write("q", "q"), write("v", "v")],
                &[("q", output()), ("v", output())],
            ),
        ),
    ];
    let is_lines = |group: Group| !staged.tables.contains(&group);
    let methods = methods.into_iter().filter(|(group, _)| is_lines(*group)).map(|(_, made)| made);
    let has_commands = functions.iter().any(|placed| placed.emitted.name == "commands");
    let commands = has_commands.then(|| {
        make(
            "commands",
            "commands",
            &|m| m == Module::Strands,
            vec![
                ("q", quote!(sized(at.q))),
                ("v", quote!(sized(at.v))),
                ("t", quote!(at.t)),
                ("rest", quote!(sized(at.rest))),
                ("inputs", quote!(sized(at.inputs))),
                write("tensions", "tensions"),
            ],
            &[("at", quote!(&Midpoint)), ("tensions", output())],
        )
    });
    let has_clearances = functions.iter().any(|placed| placed.emitted.name == "clearances");
    let clearances = has_clearances.then(|| {
        make(
            "clearances",
            "clearances",
            &|m| m == Module::Strands,
            vec![read("q"), write("clearances", "clearances")],
            &[("q", input()), ("clearances", output())],
        )
    });
    let has_numbers = functions.iter().any(|placed| placed.emitted.name == "required_numbers");
    let required_numbers = has_numbers.then(|| {
        make(
            "required_numbers",
            "required_numbers",
            &|m| m == Module::Time,
            vec![write("numbers", "numbers")],
            &[("numbers", output())],
        )
    });
    let potential = is_lines(Group::Energy).then(|| potential(names, functions));
    let scenario_values = scenario_values(names);
    let scenarios = is_lines(Group::Scenarios).then(|| scenarios(names, functions));
    let model = &names.model;
    let blocks = is_lines(Group::Equations).then(|| blocks(names, staged, functions));
    let by_tables = tables::methods(staged);
    let systems = (!staged.systems.is_empty()).then(|| {
        quote! {
            fn systems() -> &'static [System] {
                &SYSTEMS
            }
        }
    });
    let rest = quote! {
        impl Model for #model {
            fn layout(&self) -> &Arc<Layout> {
                &self.layout
            }
            fn params(&self) -> &[f64] {
                &self.params
            }
            fn set_param(&mut self, index: usize, value: f64) {
                self.params[index] = value;
                self.update();
            }
            #systems
            #blocks
            #(#methods)*
            #commands
            #clearances
            #required_numbers
            #potential
            #scenario_values
            #scenarios
            #by_tables
        }
    };
    let core = imports::from(
        quote!(handc_core::model),
        &["Instant", "Midpoint", "Model", "ScenarioValues"],
        &rest,
    );
    let lanes = imports::from(quote!(handc_core::lanes), &["LaneVisitor", "RUNS"], &rest);
    let arrays = imports::from(quote!(handc_core::array), &["sized", "sized_mut"], &rest);
    // Some methods are called like modules, so only modules that there are may be imported.
    let local: Vec<&str> = ["blocks", "constraints", "energy", "scenarios", "strands", "time"]
        .into_iter()
        .filter(|name| match *name {
            "scenarios" => names.scenarios.len() > 0,
            "blocks" => !staged.shapes.is_empty(),
            name => functions.iter().any(|placed| folder(placed.module) == name),
        })
        .collect();
    let local = imports::from(quote!(crate), &local, &rest);
    let types = imports::from(quote!(crate::blocks), &["Blocks"], &rest);
    let systems = (!staged.systems.is_empty()).then(|| {
        quote! {
            use crate::systems::SYSTEMS;
            use handc_core::system::System;
        }
    });
    let indices = imports::from(quote!(crate::layout), &["scenario"], &scenario_arms(&rest, names));
    quote! {
        //! The model as the integrator sees it.

        #local
        #types
        #systems
        use crate::#model;
        #indices
        #arrays
        #lanes
        use handc_core::layout::Layout;
        #core
        use std::sync::Arc;

        #rest
    }
}

/// What is computed block by block.
fn blocks(names: &Names, staged: &Staged, functions: &[Placed]) -> TokenStream {
    let (has, input, output) = (!staged.shapes.is_empty(), quote!(&[f64]), quote!(&mut [f64]));
    let if_any = |body: TokenStream| if has { body } else { TokenStream::new() };
    let at = ("at", quote!(&Midpoint));
    let vectors = [at, ("momentum", output.clone()), ("force", output.clone())];
    let mut all = vec![vectors[0].clone(), ("h", quote!(f64))];
    all.extend(vectors[1..].iter().cloned());
    all.push(("matrix", output.clone()));
    let mut methods = vec![
        method("evaluate", &vectors, &if_any(quote!(self.blocks.evaluate(at, momentum, force);))),
        method(
            "evaluate_with_matrix",
            &all,
            &if_any(quote!(self.blocks.evaluate_with_matrix(at, h, momentum, force, matrix);)),
        ),
        method(
            "mass_matrix",
            &[("q", input.clone()), ("matrix", output.clone())],
            &if_any(quote!(self.blocks.mass_matrix(q, matrix);)),
        ),
    ];
    let model = &names.model;
    let lengths = match names.strands.len() {
        0 => TokenStream::new(),
        _ => quote!(*sized_mut(lengths) = #model::strand_lengths(self, sized(q));),
    };
    methods.push(method("strand_lengths", &[("q", input), ("lengths", output)], &lengths));
    if has && blocks::has_lanes(functions) {
        methods.push(quote! {
            fn revision(&self) -> u64 {
                self.revision
            }
            fn on_lanes(models: &[&Self], visitor: &mut impl LaneVisitor) -> bool {
                let mut of = [&models[0].blocks; RUNS];
                for (place, model) in of.iter_mut().zip(models) {
                    *place = &model.blocks;
                }
                Blocks::on_lanes(&of, visitor)
            }
        });
    }
    methods.into_iter().collect()
}

/// The module of scenario indices is needed only where there are arms that name one.
fn scenario_arms(rest: &TokenStream, names: &Names) -> TokenStream {
    if names.scenarios.len() > 0 { rest.clone() } else { TokenStream::new() }
}

fn potential(names: &Names, functions: &[Placed]) -> TokenStream {
    let sources: Vec<_> =
        own().into_iter().chain([("q", quote!(sized(q))), ("rest", quote!(sized(rest)))]).collect();
    let body = match functions.iter().find(|p| p.module == Module::Energy) {
        Some(placed) => {
            let needed: Vec<_> = placed.emitted.arguments.iter().map(|a| a.name).collect();
            let prelude = prelude(&needed, &sources);
            let call = placed.emitted.call(&path(placed.module, names));
            quote!(#prelude #call)
        }
        None => quote!(0.0),
    };
    let arguments = arguments(&[("q", quote!(&[f64])), ("rest", quote!(&[f64]))], &body);
    quote! {
        fn potential(&mut self, #arguments) -> f64 { #body }
    }
}

/// An arm of a match of scenarios.
fn scenario_arm(names: &Names, index: usize, body: TokenStream) -> TokenStream {
    let constant = identifier(&names.scenarios.constants[index]);
    quote!(scenario::#constant => { #body })
}

fn scenario_values(names: &Names) -> TokenStream {
    let count = names.scenarios.len();
    let values = (0..count).map(|index| {
        let module = path(Module::Scenario(index), names);
        scenario_arm(names, index, quote!(#module numbers(&self.params, &self.values)))
    });
    let values = match count {
        0 => quote!(ScenarioValues::default()),
        _ => quote! {
            match scenario {
                #(#values)*
                _ => ScenarioValues::default(),
            }
        },
    };
    let scenario = arguments(&[("scenario", quote!(usize))], &values);
    quote! {
        fn scenario(&mut self, #scenario) -> ScenarioValues { #values }
    }
}

fn scenarios(names: &Names, functions: &[Placed]) -> TokenStream {
    let count = names.scenarios.len();
    let by_scenario = |function: &str, sources: &[(&'static str, TokenStream)]| {
        let arms: Vec<TokenStream> = (0..count)
            .filter_map(|index| {
                let body = body(functions, names, function, |m| m == Module::Scenario(index));
                let sources: Vec<_> = own().into_iter().chain(sources.iter().cloned()).collect();
                let prelude = prelude(&body.arguments, &sources);
                let calls = body.calls;
                (!calls.is_empty()).then(|| scenario_arm(names, index, quote!(#prelude #calls)))
            })
            .collect();
        match &arms[..] {
            [] => TokenStream::new(),
            arms => quote! {
                match scenario {
                    #(#arms)*
                    _ => {}
                }
            },
        }
    };
    let number = || ("scenario", quote!(usize));
    let f64 = || ("t", quote!(f64));
    let output = || quote!(&mut [f64]);
    let inputs = method(
        "scenario_inputs",
        &[number(), f64(), ("inputs", output())],
        &by_scenario("inputs", &[("inputs", quote!(sized_mut(inputs)))]),
    );
    let drives = method(
        "scenario_drives",
        &[number(), f64(), ("q", output())],
        &by_scenario("drives", &[("q", quote!(sized_mut(q)))]),
    );
    let rests = by_scenario("rests", &[("rest", quote!(sized_mut(rest)))]);
    let rests = (!rests.is_empty())
        .then(|| method("scenario_rests", &[number(), f64(), ("rest", output())], &rests));
    let records = method(
        "scenario_records",
        &[number(), ("at", quote!(&Instant)), ("columns", output())],
        &by_scenario(
            "records",
            &[
                ("q", quote!(sized(at.q))),
                ("v", quote!(sized(at.v))),
                ("t", quote!(at.t)),
                ("inputs", quote!(sized(at.inputs))),
                ("lambda", quote!(sized(at.lambda))),
                ("rest", quote!(sized(at.rest))),
                ("h", quote!(at.h)),
                ("records", quote!(columns)),
            ],
        ),
    );
    quote! {
        #inputs
        #drives
        #rests
        #records
    }
}
