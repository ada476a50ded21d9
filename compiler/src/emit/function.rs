//! A whole function: signature, bodies of its parts, documentation.

use super::code::{Expression, Output, Place, Statement};
use super::count::Operations;
use super::cut::{Part, cut};
use super::literal::integer;
use super::name::{Taken, snake};
use super::plan::{Order, Plan};
use super::print::{Names, Printer, identifier};
use super::schedule::schedule;
use crate::graph::{Leaf, Node, Sym, Unary, label_of, node};
use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Functions longer than this are cut.
pub const LONGEST_FUNCTION: usize = 1500;

/// What a function is to compute and how it is called.
#[derive(Clone, Debug)]
pub struct Function {
    /// Its name, legal and unique in its module.
    pub name: String,
    /// Lines of documentation; the operation count is added.
    pub doc: Vec<String>,
    /// Its results.
    pub outputs: Vec<Output>,
    /// Most statements in one function.
    pub longest: usize,
}

/// How unknowns and results are called in the crate that the function is part of.
pub trait Naming {
    /// A readable name for the value of an unknown, e.g. `q_index_mcp`.
    fn label(&self, leaf: Leaf) -> String;
    /// The index of an element, e.g. `coordinate::INDEX_MCP`.
    fn index(&self, array: &str, index: usize) -> TokenStream;
    /// The type of an array argument without reference, e.g. `[f64; COORDINATES]`.
    fn array_type(&self, array: &str) -> TokenStream;
    /// Whether the code is generic over the lane type `L`, its constants in a table.
    fn over_lanes(&self) -> bool {
        false
    }
    /// Whether what is computed only steers, so that reciprocals may be rough.
    fn is_rough(&self) -> bool {
        false
    }
}

/// An argument of an emitted function; its name is the same wherever it is passed on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Argument {
    /// Name.
    pub name: &'static str,
    /// Whether it is an array of results.
    pub is_output: bool,
}

/// A function as text, with what its caller and its module must know.
#[derive(Clone, Debug)]
pub struct Emitted {
    /// Name.
    pub name: String,
    /// Tokens of the function and its parts.
    pub tokens: TokenStream,
    /// Arguments in order.
    pub arguments: Vec<Argument>,
    /// Functions of `handc_core::math` that it calls.
    pub functions: BTreeSet<&'static str>,
    /// What it executes.
    pub operations: Operations,
    /// Its statements.
    pub statements: usize,
    /// How many Rust functions it became.
    pub parts: usize,
}

impl Emitted {
    /// A call with arguments of the same names.
    pub fn call(&self, path: &TokenStream) -> TokenStream {
        let name = identifier(&self.name);
        let arguments = self.arguments.iter().map(|a| identifier(a.name));
        quote!(#path #name(#(#arguments),*))
    }
}

/// The argument that holds an unknown, and its element; `None` where the argument is the value.
pub fn place_of(leaf: Leaf) -> (&'static str, Option<usize>) {
    let (name, index) = match leaf {
        Leaf::Q(i) => ("q", i),
        Leaf::V(i) => ("v", i),
        Leaf::Time => return ("t", None),
        Leaf::Step => return ("h", None),
        Leaf::Rest(i) => ("rest", i),
        Leaf::Input(i) => ("inputs", i),
        Leaf::Param(i) => ("params", i),
        Leaf::Value(i) => ("values", i),
        Leaf::Lambda(i) => ("lambda", i),
        Leaf::Length(i) => ("lengths", i),
        Leaf::Own(_) | Leaf::Strand(..) => unreachable!("staging replaces {leaf:?}"),
        Leaf::Constant(i) => ("constants", i),
        Leaf::System(array, i) => (array.name(), i),
    };
    (name, Some(index as usize))
}

/// Functions of `handc_core::math` that code may call.
pub const MATH: [&str; 25] = [
    "abs",
    "acos",
    "asin",
    "atan",
    "atan2",
    "cos",
    "exp",
    "floor",
    "if_equal",
    "if_less",
    "if_less_equal",
    "log",
    "max",
    "min",
    "mul_add",
    "mul_sub",
    "neg_mul_add",
    "powf",
    "powi",
    "rough_recip",
    "sin",
    "sin_cos",
    "sqrt",
    "sqrt_recip",
    "tan",
];

/// The order of arguments.
const ORDER: [&str; 20] = [
    "q",
    "v",
    "t",
    "h",
    "rest",
    "inputs",
    "params",
    "values",
    "lambda",
    "lengths",
    "constants",
    "factors",
    "residual",
    "gaps",
    "matrix",
    "before",
    "after",
    "size",
    "momentum_matrix",
    "step",
];

impl Function {
    /// Emits the function.
    pub fn emit(&self, naming: &dyn Naming) -> Emitted {
        // Parts hold the terms of the mechanics; what is returned comes last.
        let order = match naming.over_lanes() && !self.returns() {
            true => Order::TermByTerm,
            false => Order::OutputByOutput,
        };
        let plan = Plan::new(&self.outputs, order);
        let code = schedule(&self.outputs, &plan);
        let statements = &code.statements;
        let cut = cut(statements, self.longest);
        let names = self.names(naming, &plan, statements, &code.made_for);
        let lanes = naming.over_lanes();
        let mut printer = Printer::new(&names, lanes, naming.is_rough());
        let arguments = self.arguments(statements);
        let operations = Operations::of(statements);
        let docs = self.doc.iter().map(String::as_str).map(doc_line);
        let count = doc_line(&format!("{operations}."));
        let header = quote!(#(#docs)* #[doc = ""] #count);
        let name = identifier(&self.name);
        let whole = signature(&arguments, naming);
        let element = element(naming);
        let value = self.returns().then(|| quote!(-> #element));
        let generics = lanes.then(|| quote!(<L: Lane>));
        let inline = lanes.then(|| quote!(#[inline(always)]));
        let tokens = if let [part] = &cut.parts[..] {
            let body = self.body(naming, statements, part, &mut printer);
            quote!(#header #inline pub fn #name #generics(#whole) #value { #body })
        } else {
            let size = integer(cut.workspace);
            let mut calls = Vec::new();
            let mut parts = Vec::new();
            for (number, part) in cut.parts.iter().enumerate() {
                let part_name = format_ident!("{}_part_{}", name, number + 1);
                let arguments = self.arguments(&statements[part.statements.clone()]);
                let passed = arguments.iter().map(|a| identifier(a.name));
                // Parts that have nothing to do with others need no room for it.
                let shares = !part.loads.is_empty() || !part.stores.is_empty();
                let (signature, work) = if shares {
                    let work = quote!(work: &mut [#element; #size]);
                    (signature_with(&arguments, naming, &work), Some(quote!(&mut work)))
                } else {
                    (signature(&arguments, naming), None)
                };
                let body = self.body(naming, statements, part, &mut printer);
                let is_last = number + 1 == cut.parts.len();
                let value = value.as_ref().filter(|_| is_last);
                let end = (!is_last || value.is_none()).then(|| quote!(;));
                calls.push(quote!(#part_name(#(#passed,)* #work) #end));
                parts.push(quote! {
                    #[inline(never)]
                    fn #part_name #generics(#signature) #value { #body }
                });
            }
            let zero = match lanes {
                true => quote!(L::splat(0.0)),
                false => quote!(0.0),
            };
            let room = (cut.workspace > 0).then(|| quote!(let mut work = [#zero; #size];));
            quote! {
                #header
                pub fn #name #generics(#whole) #value {
                    #room
                    #(#calls)*
                }
                #(#parts)*
            }
        };
        Emitted {
            name: self.name.clone(),
            tokens,
            arguments,
            functions: printer.functions,
            operations,
            statements: statements.len(),
            parts: cut.parts.len(),
        }
    }

    fn returns(&self) -> bool {
        self.outputs.iter().any(|output| output.place == Place::Return)
    }

    /// What the statements read and write, in the fixed order.
    fn arguments(&self, statements: &[Statement]) -> Vec<Argument> {
        let mut inputs = BTreeSet::new();
        let mut outputs: Vec<&'static str> = Vec::new();
        for statement in statements {
            statement.expression().walk(&mut |expression| {
                if let Expression::Leaf(leaf) = expression {
                    inputs.insert(place_of(*leaf).0);
                }
            });
            if let Statement::Store(output, _) = statement
                && let Place::Element { array, .. } = self.outputs[*output].place
                && !outputs.contains(&array)
            {
                outputs.push(array);
            }
        }
        let inputs = ORDER.into_iter().filter(|name| inputs.contains(name));
        let inputs = inputs.map(|name| Argument { name, is_output: false });
        inputs.chain(outputs.into_iter().map(|name| Argument { name, is_output: true })).collect()
    }

    /// Names for every unknown and every variable.
    fn names(
        &self,
        naming: &dyn Naming,
        plan: &Plan,
        statements: &[Statement],
        made_for: &[usize],
    ) -> Names {
        let mut taken = Taken::with(ORDER.into_iter().chain(MATH).chain(["work"]));
        for output in &self.outputs {
            if let Place::Element { array, .. } = output.place {
                taken.take(array);
            }
        }
        let mut leaves: BTreeMap<Leaf, String> = BTreeMap::new();
        for &symbol in plan.nodes() {
            if let Node::Leaf(leaf) = node(symbol) {
                leaves.insert(leaf, String::new());
            }
        }
        let mut names = Names::default();
        for (&leaf, name) in &mut leaves {
            *name = match place_of(leaf) {
                (scalar, None) => scalar.to_owned(),
                _ => taken.take(&snake(&naming.label(leaf))),
            };
            names.leaves.insert(leaf, identifier(name));
        }
        let mut counters: HashMap<String, usize> = HashMap::new();
        for (statement, &output) in statements.iter().zip(made_for) {
            for symbol in statement.defines() {
                let wanted = match angle_label(symbol, &leaves) {
                    Some(label) => label,
                    None => {
                        let origin = label_of(symbol);
                        let label =
                            if origin.is_empty() { &self.outputs[output].label } else { &origin };
                        let label = snake(label);
                        let counter = counters.entry(label.clone()).or_default();
                        *counter += 1;
                        format!("{label}_{counter}")
                    }
                };
                names.variables.insert(symbol, identifier(&taken.take(&wanted)));
            }
        }
        names
    }

    fn body(
        &self,
        naming: &dyn Naming,
        statements: &[Statement],
        part: &Part,
        printer: &mut Printer,
    ) -> TokenStream {
        let own = &statements[part.statements.clone()];
        let mut leaves = BTreeSet::new();
        for statement in own {
            statement.expression().walk(&mut |expression| {
                if let Expression::Leaf(leaf) = expression {
                    leaves.insert(*leaf);
                }
            });
        }
        let mut body = TokenStream::new();
        let last = leaves.iter().filter_map(|leaf| match leaf {
            Leaf::Constant(index) => Some(*index as usize),
            _ => None,
        });
        if let Some(last) = last.max() {
            // One check of the length for all constants.
            let count = integer(last + 1);
            body.extend(quote!(let constants = &constants[..#count * L::WIDTH];));
        }
        for leaf in leaves {
            if let Leaf::Constant(index) = leaf {
                let (name, index) = (printer.leaf(leaf), integer(index as usize));
                body.extend(quote!(let #name = L::load(&constants[#index * L::WIDTH..]);));
                continue;
            }
            if let (array, Some(index)) = place_of(leaf) {
                let name = printer.leaf(leaf);
                let (index, array) = (naming.index(array, index), identifier(array));
                body.extend(quote!(let #name = #array[#index];));
            }
        }
        for &(symbol, place) in &part.loads {
            let (name, place) = (printer.variable(symbol), integer(place));
            body.extend(quote!(let #name = work[#place];));
        }
        let kept: HashMap<Sym, usize> = part.stores.iter().copied().collect();
        for statement in own {
            body.extend(printer.statement(statement, |output, value| {
                match &self.outputs[output].place {
                    Place::Return => value,
                    Place::Element { array, index } => {
                        let (index, array) = (naming.index(array, *index), identifier(array));
                        quote!(#array[#index] = #value;)
                    }
                }
            }));
            for symbol in statement.defines() {
                if let Some(&place) = kept.get(&symbol) {
                    let (name, place) = (printer.variable(symbol), integer(place));
                    body.extend(quote!(work[#place] = #name;));
                }
            }
        }
        body
    }
}

/// `sin_index_mcp` for the sine of a coordinate.
fn angle_label(symbol: Sym, leaves: &BTreeMap<Leaf, String>) -> Option<String> {
    let Node::Unary(function @ (Unary::Sin | Unary::Cos), angle) = node(symbol) else {
        return None;
    };
    let Node::Leaf(leaf) = node(angle) else { return None };
    let name = leaves.get(&leaf)?;
    let name = name.strip_prefix("q_").unwrap_or(name);
    Some(format!("{}_{name}", if function == Unary::Sin { "sin" } else { "cos" }))
}

/// What arrays hold.
fn element(naming: &dyn Naming) -> TokenStream {
    if naming.over_lanes() { quote!(L) } else { quote!(f64) }
}

/// A line of documentation.
pub fn doc_line(text: &str) -> TokenStream {
    let text = if text.is_empty() { String::new() } else { format!(" {text}") };
    quote!(#[doc = #text])
}

fn signature(arguments: &[Argument], naming: &dyn Naming) -> TokenStream {
    signature_with(arguments, naming, &TokenStream::new())
}

fn signature_with(arguments: &[Argument], naming: &dyn Naming, last: &TokenStream) -> TokenStream {
    let arguments = arguments.iter().map(|argument| {
        let name: Ident = identifier(argument.name);
        match (argument.name, argument.is_output) {
            ("t" | "h", _) => {
                let element = element(naming);
                quote!(#name: #element,)
            }
            (array, false) => {
                let of = naming.array_type(array);
                quote!(#name: &#of,)
            }
            (array, true) => {
                let of = naming.array_type(array);
                quote!(#name: &mut #of,)
            }
        }
    });
    quote!(#(#arguments)* #last)
}
