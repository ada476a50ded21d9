//! The generated modules of functions.

use super::imports;
use super::names::Names;
use super::shapes::{self, ShapeNames};
use super::systems::SystemNames;
use crate::emit::function::{Emitted, Function, LONGEST_FUNCTION, doc_line};
use crate::emit::literal::{integer, number};
use crate::emit::print::identifier;
use crate::graph::{Leaf, Node, Sym, Unary, node};
use crate::stage::{Group, Module, Staged};
use handc_core::layout::Layout;
use handc_runtime::mechanism::{Mechanism, Scenario};
use proc_macro2::TokenStream;
use quote::quote;

/// A function in its module.
#[derive(Debug)]
pub(super) struct Placed {
    pub(super) module: Module,
    pub(super) emitted: Emitted,
}

/// Emits every task.
pub(super) fn functions(staged: &Staged, names: &Names) -> Vec<Placed> {
    staged
        .tasks
        .iter()
        .map(|task| {
            let function = Function {
                name: task.name.to_owned(),
                doc: task.doc.clone(),
                outputs: task.outputs.clone(),
                longest: LONGEST_FUNCTION,
            };
            let emitted = match task.module {
                Module::Part(number) => {
                    let (shape, is_rough) = (&staged.shapes[number], task.name == "factor");
                    function.emit(&ShapeNames { names, shape, is_rough })
                }
                Module::System(number) => {
                    function.emit(&SystemNames { names, system: &staged.systems[number] })
                }
                _ => function.emit(names),
            };
            Placed { module: task.module, emitted }
        })
        .collect()
}

/// The module of the crate's root that a module is or lies in.
pub(super) fn folder(module: Module) -> &'static str {
    match module {
        Module::Part(_) => "blocks",
        Module::Strands => "strands",
        Module::Constraints => "constraints",
        Module::System(_) => "systems",
        Module::Energy => "energy",
        Module::Frames => "frames",
        Module::Time => "time",
        Module::Scenario(_) => "scenarios",
        Module::Values => "values",
    }
}

/// Path inside the crate: `blocks::index`.
pub(super) fn path(module: Module, names: &Names) -> TokenStream {
    let folder = identifier(folder(module));
    let inner = match module {
        Module::Part(index) => &names.shapes[index],
        Module::System(index) => &names.systems[index],
        Module::Scenario(index) => &names.scenario_modules[index],
        _ => return quote!(#folder::),
    };
    let inner = identifier(inner);
    quote!(#folder::#inner::)
}

/// File inside `src`: `blocks/index.rs`.
pub(super) fn file(module: Module, names: &Names) -> String {
    format!("{}.rs", path(module, names).to_string().replace(' ', "").trim_end_matches("::"))
        .replace("::", "/")
}

fn opening(module: Module, mechanism: &Mechanism, staged: &Staged, names: &Names) -> String {
    match module {
        Module::Part(index) => shapes::opening(&staged.shapes[index], &names.parts),
        Module::Scenario(index) => {
            let scenario = &mechanism.scenarios[index];
            format!("Scenario `{}`.", scenario.name)
        }
        Module::System(index) => {
            format!("Linear system of the block `{}`, in a fixed order.", names.systems[index])
        }
        Module::Strands => "Strands: lengths and moment arms.".to_owned(),
        Module::Constraints => "Constraints: rows and their derivatives.".to_owned(),
        Module::Energy => "Energy.".to_owned(),
        Module::Frames => "Poses of the named frames.".to_owned(),
        Module::Time => "Start values and functions of time.".to_owned(),
        Module::Values => "Numbers that follow from parameters.".to_owned(),
    }
}

/// Modules in order, each with its functions.
pub(super) fn modules(
    mechanism: &Mechanism,
    staged: &Staged,
    layout: &Layout,
    names: &Names,
    functions: &[Placed],
) -> Vec<(Module, TokenStream)> {
    let mut list: Vec<Module> = functions.iter().map(|placed| placed.module).collect();
    list.extend((0..mechanism.scenarios.len()).map(Module::Scenario));
    if staged.tables.contains(&Group::Frames) {
        // For the type of poses.
        list.push(Module::Frames);
    }
    list.sort_unstable();
    list.dedup();
    list.into_iter()
        .map(|module| {
            let own = functions.iter().filter(|placed| placed.module == module);
            let mut body: TokenStream = own.map(|placed| placed.emitted.tokens.clone()).collect();
            let mut doc = vec![opening(module, mechanism, staged, names)];
            match module {
                Module::Scenario(index) => {
                    let scenario = &mechanism.scenarios[index];
                    if !scenario.doc.is_empty() {
                        doc.push(String::new());
                        doc.extend(scenario.doc.lines().map(str::to_owned));
                    }
                    body.extend(numbers(scenario, &staged.scenario_numbers[index], names));
                }
                Module::Part(number) => {
                    let shape = &staged.shapes[number];
                    body.extend(shapes::table(number, shape, layout, names, functions));
                }
                Module::Frames => body.extend(poses()),
                _ => {}
            }
            let core = imports::from(quote!(handc_core::model), &["ScenarioValues"], &body);
            let uses = match module {
                Module::Part(_) => imports::of_equations(names, &body),
                _ => imports::of_functions(names, &body),
            };
            let docs = doc.iter().map(|line| {
                let text = if line.is_empty() { String::new() } else { format!(" {line}") };
                quote!(#![doc = #text])
            });
            (module, quote!(#(#docs)* #core #uses #body))
        })
        .collect()
}

/// The pose type of `frames.rs`, and its reading from the flat array.
fn poses() -> TokenStream {
    quote! {
        /// Where a frame stands in the world.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Pose {
            /// Rotation by rows: takes vectors in frame axes to world axes.
            pub rotation: [[f64; 3]; 3],
            /// Origin in the world (m).
            pub origin: [f64; 3],
        }

        impl Pose {
            /// From the twelve numbers that start at `12 * index`.
            pub fn read(numbers: &[f64; POSES], index: usize) -> Pose {
                let at = |k: usize| numbers[12 * index + k];
                Pose {
                    rotation: [[at(0), at(1), at(2)], [at(3), at(4), at(5)], [at(6), at(7), at(8)]],
                    origin: [at(9), at(10), at(11)],
                }
            }
        }
    }
}

/// A constant, a parameter or a value; hoisting has left nothing else.
pub(super) fn simple(symbol: Sym, names: &Names) -> TokenStream {
    use crate::emit::function::{Naming, place_of};
    match node(symbol) {
        Node::Constant(bits) => number(f64::from_bits(bits)),
        Node::Leaf(leaf @ (Leaf::Param(_) | Leaf::Value(_))) => match place_of(leaf) {
            (array, Some(index)) => {
                let (index, array) = (names.index(array, index), identifier(array));
                quote!(#array[#index])
            }
            (scalar, None) => {
                let scalar = identifier(scalar);
                quote!(#scalar)
            }
        },
        Node::Unary(Unary::Neg, inner) => {
            let inner = simple(inner, names);
            quote!(-#inner)
        }
        other => unreachable!("a scenario's number depends on parameters alone, not on {other:?}"),
    }
}

/// `numbers`: the scenario's numbers with the current parameters.
fn numbers(scenario: &Scenario, symbols: &[Sym], names: &Names) -> TokenStream {
    let mut next = symbols.iter().map(|&symbol| simple(symbol, names));
    let mut take = || next.next().unwrap_or_default();
    let mut option = |given: bool| {
        if given {
            let value = take();
            quote!(Some(#value))
        } else {
            quote!(None)
        }
    };
    let step = option(scenario.step.is_some());
    let duration = option(scenario.duration.is_some());
    let tolerance = option(scenario.tolerance.is_some());
    let mut pairs = |list: &[(u32, handc_runtime::mechanism::Number)]| {
        let pairs = list.iter().map(|(index, _)| {
            let (index, value) = (integer(*index as usize), next.next().unwrap_or_default());
            quote!((#index, #value))
        });
        quote!(vec![#(#pairs),*])
    };
    let set = pairs(&scenario.set);
    let start = pairs(&scenario.start);
    let velocity = pairs(&scenario.velocity);
    let poses: Vec<_> = scenario.poses.iter().map(|(_, list)| pairs(list)).collect();
    let motions: Vec<_> = scenario.motions.iter().map(|(_, list)| pairs(list)).collect();
    let doc = doc_line("Its numbers with the current parameters.");
    let body = quote! {
        ScenarioValues {
            set: #set,
            step: #step,
            duration: #duration,
            tolerance: #tolerance,
            start: #start,
            velocity: #velocity,
            poses: vec![#(#poses),*],
            motions: vec![#(#motions),*],
        }
    };
    let mentioned = imports::mentioned(&body);
    let argument = |name: &str| match mentioned.contains(name) {
        true => identifier(name),
        false => identifier(&format!("_{name}")),
    };
    let (params, values) = (argument("params"), argument("values"));
    quote! {
        #doc
        pub fn numbers(#params: &[f64; PARAMETERS], #values: &[f64; VALUES]) -> ScenarioValues {
            #body
        }
    }
}
