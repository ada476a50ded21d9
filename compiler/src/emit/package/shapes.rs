//! The generated modules of like parts: their equations over lanes, where each part's numbers
//! stand, and its constants.

use super::modules::{Placed, simple};
use super::names::Names;
use crate::emit::function::{Naming, doc_line};
use crate::emit::literal::integer;
use crate::emit::print::identifier;
use crate::graph::{Leaf, SystemArray};
use crate::stage::{Module, PartPlace, Shape, shared};
use handc_core::layout::Layout;
use handc_core::shape::FEW;
use proc_macro2::TokenStream;
use quote::quote;

/// Names inside the equations of a shape: those that its parts have in common.
pub(super) struct ShapeNames<'a> {
    pub(super) names: &'a Names,
    pub(super) shape: &'a Shape,
    /// Whether what is computed only steers.
    pub(super) is_rough: bool,
}

impl ShapeNames<'_> {
    fn common(&self, originals: &[String], of: impl Fn(&PartPlace) -> usize) -> String {
        let all: Vec<&str> =
            self.shape.places.iter().map(|place| originals[of(place)].as_str()).collect();
        shared(&all)
    }
}

impl Naming for ShapeNames<'_> {
    fn label(&self, leaf: Leaf) -> String {
        let names = self.names;
        let coordinate =
            |i: u32| self.common(&names.coordinates.originals, |p| p.coordinates[i as usize]);
        match leaf {
            Leaf::Q(i) => format!("q_{}", coordinate(i)),
            Leaf::V(i) => format!("v_{}", coordinate(i)),
            Leaf::Rest(i) => {
                let strand = self.common(&names.strands.originals, |p| p.strands[i as usize]);
                format!("rest_{strand}")
            }
            Leaf::Input(i) => self.common(&names.inputs.originals, |p| p.inputs[i as usize]),
            Leaf::Constant(i) => format!("c_{i}"),
            Leaf::System(SystemArray::Size, i) => format!("size_{}", coordinate(i)),
            Leaf::System(SystemArray::Residual, i) => format!("r_{}", coordinate(i)),
            Leaf::System(SystemArray::Step, i) => format!("step_{}", coordinate(i)),
            other => names.label(other),
        }
    }

    fn index(&self, _array: &str, index: usize) -> TokenStream {
        let index = integer(index);
        quote!(#index)
    }

    fn array_type(&self, array: &str) -> TokenStream {
        let place = &self.shape.places[0];
        let unknowns = self.shape.unknowns;
        let size = integer(match array {
            "q" | "v" => place.coordinates.len(),
            "rest" | "lengths" => place.strands.len(),
            "inputs" => place.inputs.len(),
            "constants" => return quote!([f64]),
            "matrix" | "momentum_matrix" | "factors" => unknowns * unknowns,
            _ => unknowns,
        });
        quote!([L; #size])
    }

    fn over_lanes(&self) -> bool {
        true
    }

    fn is_rough(&self) -> bool {
        self.is_rough
    }
}

/// The five sizes of a shape: unknowns, matrix entries, coordinates, strands, inputs.
pub(super) fn sizes(shape: &Shape) -> [usize; 5] {
    let (n, place) = (shape.unknowns, &shape.places[0]);
    [n, n * n, place.coordinates.len(), place.strands.len(), place.inputs.len()]
}

/// What opens the module, in prose.
pub(super) fn opening(shape: &Shape, all: &[String]) -> String {
    let list: Vec<String> =
        shape.places.iter().map(|place| format!("`{}`", all[place.part])).collect();
    match &list[..] {
        [one] => format!("Step equations of {one}."),
        [first, others @ ..] => format!(
            "Step equations of {first}, and of {}, which differ from it in constants alone.",
            others.join(", ")
        ),
        [] => String::new(),
    }
}

/// What follows the equations in the module of a shape.
pub(super) fn table(
    number: usize,
    shape: &Shape,
    layout: &Layout,
    names: &Names,
    functions: &[Placed],
) -> TokenStream {
    let [n, m, q, s, u] = sizes(shape).map(integer);
    let (blocks, constants) = (integer(shape.places.len()), integer(shape.constants[0].len()));
    let places = shape.places.iter().map(|place| {
        let list = |of: &[usize]| {
            let of = of.iter().map(|&index| integer(index));
            quote!([#(#of),*])
        };
        let (coordinates, strands) = (list(&place.coordinates), list(&place.strands));
        let inputs = list(&place.inputs);
        let [matrix, width] = place.matrix.map(integer);
        quote!(Place {
            coordinates: #coordinates,
            strands: #strands,
            inputs: #inputs,
            matrix: #matrix,
            width: #width,
        })
    });
    let internal = internal(shape, layout);
    let rows = shape.constants.iter().map(|list| {
        let entries = list.iter().map(|&constant| simple(constant, names));
        quote!([#(#entries),*])
    });
    let rows = quote!([#(#rows),*]);
    let mentioned = super::imports::mentioned(&rows);
    let argument = |name: &str| match mentioned.contains(name) {
        true => identifier(name),
        false => identifier(&format!("_{name}")),
    };
    let (params, values) = (argument("params"), argument("values"));
    let method = |name: &str, arguments: TokenStream, has_inputs: bool| {
        method(number, functions, name, &arguments, has_inputs)
    };
    let local = quote!(at: &Local<L, #q, #s, #u>, constants: &[f64]);
    let vectors = quote!(momentum: &mut [L; #n], force: &mut [L; #n]);
    let evaluate = method("evaluate", quote!(#local, #vectors), true);
    let with_matrix =
        method("evaluate_with_matrix", quote!(#local, #vectors, matrix: &mut [L; #m]), true);
    let mass =
        method("mass_matrix", quote!(q: &[L; #q], constants: &[f64], matrix: &mut [L; #m]), false);
    let by_increment = method("momentum_matrix", quote!(#local, matrix: &mut [L; #m]), true);
    let lengths =
        method("lengths", quote!(q: &[L; #q], constants: &[f64], lengths: &mut [L; #s]), false);
    let solvers = solvers(number, shape, functions);
    let is_direct = (solvers.is_some() && shape.unknowns > FEW).then(|| {
        quote!(
            const DIRECT: bool = true;
        )
    });
    let places_doc = doc_line("Where the numbers of each block stand.");
    let equations_doc = doc_line("The equations as the integrator sees them.");
    let constants_doc = doc_line("Constants of each block.");
    quote! {
        #places_doc
        pub static PLACES: [Place<#q, #s, #u>; #blocks] = [#(#places),*];

        #constants_doc
        pub fn constants(
            #params: &[f64; PARAMETERS],
            #values: &[f64; VALUES],
        ) -> [[f64; #constants]; #blocks] {
            #rows
        }

        #equations_doc
        #[derive(Clone, Copy, Debug)]
        pub struct Equations;

        impl Shape<#n, #m, #q, #s, #u> for Equations {
            const CONSTANTS: usize = #constants;
            #internal
            #is_direct

            #evaluate
            #with_matrix
            #mass
            #by_increment
            #lengths
            #solvers
        }
    }
}

/// The methods that factor and solve, where the shape brings its own.
fn solvers(number: usize, shape: &Shape, functions: &[Placed]) -> Option<TokenStream> {
    let of = |name: &str| {
        let of = |p: &&Placed| p.module == Module::Part(number) && p.emitted.name == name;
        functions.iter().find(of)
    };
    let factor = of("factor")?.emitted.call(&quote!(self::));
    let [n, m, ..] = sizes(shape).map(integer);
    let method = |name, arguments| method(number, functions, name, &arguments, false);
    let solve = method("solve", quote!(factors: &[L; #m], residual: &[L; #n], step: &mut [L; #n]));
    let sensitivities = method(
        "sensitivities",
        quote!(matrix: &[L; #m], size: &[L; #n], sensitivity: &mut [L; #n]),
    );
    let change = method(
        "momentum_change",
        quote!(momentum_matrix: &[L; #m], step: &[L; #n], change: &mut [L; #n]),
    );
    Some(quote! {
        #[inline(always)]
        fn factor<L: Lane>(matrix: &[L; #m], factors: &mut [L; #m]) -> u8 {
            is_sound(#factor)
        }
        #solve
        #sensitivities
        #change
    })
}

/// Places of internal coordinates, where there are any.
fn internal(shape: &Shape, layout: &Layout) -> Option<TokenStream> {
    let own = shape.places[0].coordinates[..shape.unknowns].iter().enumerate();
    let places = own.filter(|&(_, &c)| layout.coordinates[c].is_internal);
    let places: Vec<_> = places.map(|(place, _)| integer(place)).collect();
    (!places.is_empty()).then(|| quote!(const INTERNAL: &'static [usize] = &[#(#places),*];))
}

/// A method that calls the function of its name.
fn method(
    number: usize,
    functions: &[Placed],
    name: &str,
    arguments: &TokenStream,
    from_point: bool,
) -> TokenStream {
    let ident = identifier(name);
    let found = functions
        .iter()
        .find(|placed| placed.module == Module::Part(number) && placed.emitted.name == name);
    let Some(placed) = found else {
        // Nothing to compute: every argument goes unread.
        return quote! {
            #[allow(unused_variables)]
            #[inline(always)]
            fn #ident<L: Lane>(#arguments) {}
        };
    };
    let passed = placed.emitted.arguments.iter().map(|argument| {
        let ident = identifier(argument.name);
        match argument.name {
            "q" | "v" | "rest" | "inputs" if from_point => quote!(&at.#ident),
            "t" | "h" => quote!(at.#ident),
            _ => quote!(#ident),
        }
    });
    quote! {
        #[allow(unused_variables)]
        #[inline(always)]
        fn #ident<L: Lane>(#arguments) {
            self::#ident(#(#passed),*);
        }
    }
}
