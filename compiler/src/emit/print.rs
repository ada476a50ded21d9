//! Statements as Rust tokens.

use super::code::{Expression, Fused, Statement};
use super::literal::{integer, number};
use crate::graph::{Leaf, Sym, Unary};
use handc_core::scalar::Comparison;
use proc_macro2::{Ident, Span, TokenStream};
use quote::quote;
use std::collections::{BTreeSet, HashMap};

/// What the printer needs to know of names.
#[derive(Debug, Default)]
pub struct Names {
    /// Variables.
    pub variables: HashMap<Sym, Ident>,
    /// Unknowns.
    pub leaves: HashMap<Leaf, Ident>,
}

/// Makes tokens and notes which functions of `handc_core::math` they call.
#[derive(Debug)]
pub struct Printer<'a> {
    names: &'a Names,
    over_lanes: bool,
    is_rough: bool,
    /// Names of the functions called.
    pub functions: BTreeSet<&'static str>,
}

/// How tightly an expression binds: sums, products, negations, calls and names.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Binding {
    Sum,
    Product,
    Negation,
    Atom,
}

/// An identifier that was made legal before.
pub fn identifier(text: &str) -> Ident {
    Ident::new(text, Span::call_site())
}

impl<'a> Printer<'a> {
    /// A printer that uses `names`; code over lanes wraps its constants, and may have rough reciprocals.
    pub fn new(names: &'a Names, over_lanes: bool, is_rough: bool) -> Self {
        Printer { names, over_lanes, is_rough, functions: BTreeSet::new() }
    }

    /// The name of an unknown.
    pub fn leaf(&self, leaf: Leaf) -> &'a Ident {
        &self.names.leaves[&leaf]
    }

    /// The name of a variable.
    pub fn variable(&self, symbol: Sym) -> &'a Ident {
        &self.names.variables[&symbol]
    }

    /// A statement; `store` writes an output's value to its place.
    pub fn statement(
        &mut self,
        statement: &Statement,
        store: impl FnOnce(usize, TokenStream) -> TokenStream,
    ) -> TokenStream {
        match statement {
            Statement::Let(symbol, value) => {
                let (name, value) = (&self.names.variables[symbol], self.whole(value));
                quote!(let #name = #value;)
            }
            Statement::SinCos(sine, cosine, angle) => {
                let (sine, cosine) = (&self.names.variables[sine], &self.names.variables[cosine]);
                let call = self.call("sin_cos", std::slice::from_ref(angle));
                quote!(let (#sine, #cosine) = #call;)
            }
            Statement::SqrtRecip(root, reciprocal, radicand) => {
                let (root, reciprocal) =
                    (&self.names.variables[root], &self.names.variables[reciprocal]);
                let call = self.call("sqrt_recip", std::slice::from_ref(radicand));
                quote!(let (#root, #reciprocal) = #call;)
            }
            Statement::Store(output, value) => {
                let value = self.whole(value);
                store(*output, value)
            }
        }
    }

    fn whole(&mut self, expression: &Expression) -> TokenStream {
        self.expression(expression).0
    }

    /// An operand, in parentheses where it binds less tightly than needed.
    fn operand(&mut self, expression: &Expression, needed: Binding) -> TokenStream {
        let (tokens, binding) = self.expression(expression);
        if binding < needed { quote!((#tokens)) } else { tokens }
    }

    fn call(&mut self, function: &'static str, arguments: &[Expression]) -> TokenStream {
        self.functions.insert(function);
        let function = identifier(function);
        let arguments: Vec<TokenStream> = arguments.iter().map(|a| self.whole(a)).collect();
        quote!(#function(#(#arguments),*))
    }

    fn expression(&mut self, expression: &Expression) -> (TokenStream, Binding) {
        let atom = |tokens| (tokens, Binding::Atom);
        match expression {
            Expression::Constant(value) if self.over_lanes => {
                let value = number(*value);
                atom(quote!(L::splat(#value)))
            }
            Expression::Constant(value) => {
                let negative = value.is_sign_negative() && !value.is_nan();
                (number(*value), if negative { Binding::Negation } else { Binding::Atom })
            }
            Expression::Leaf(leaf) => {
                let name = &self.names.leaves[leaf];
                atom(quote!(#name))
            }
            Expression::Variable(symbol) => {
                let name = &self.names.variables[symbol];
                atom(quote!(#name))
            }
            Expression::Neg(a) => {
                let a = self.operand(a, Binding::Negation);
                (quote!(-#a), Binding::Negation)
            }
            Expression::Add(two) => {
                let [a, b] = self.two(two, Binding::Sum, Binding::Product);
                (quote!(#a + #b), Binding::Sum)
            }
            Expression::Sub(two) => {
                let [a, b] = self.two(two, Binding::Sum, Binding::Product);
                (quote!(#a - #b), Binding::Sum)
            }
            Expression::Mul(two) => {
                let [a, b] = self.two(two, Binding::Product, Binding::Negation);
                (quote!(#a * #b), Binding::Product)
            }
            Expression::Div(two) => {
                let divisor = (two[0] == Expression::Constant(1.0)).then_some(&two[1]);
                match divisor {
                    Some(divisor) if self.is_rough => {
                        atom(self.call("rough_recip", std::slice::from_ref(divisor)))
                    }
                    // It comes from the processor's estimate, without a division.
                    Some(Expression::Call(Unary::Sqrt, radicand)) if self.over_lanes => {
                        let call = self.call("sqrt_recip", std::slice::from_ref(radicand));
                        atom(quote!(#call.1))
                    }
                    _ => {
                        let [a, b] = self.two(two, Binding::Product, Binding::Negation);
                        (quote!(#a / #b), Binding::Product)
                    }
                }
            }
            Expression::Fused(kind, three) => {
                let function = match kind {
                    Fused::MulAdd => "mul_add",
                    Fused::MulSub => "mul_sub",
                    Fused::NegMulAdd => "neg_mul_add",
                };
                atom(self.call(function, three.as_slice()))
            }
            Expression::Call(function, a) => {
                atom(self.call(function_name(*function), std::slice::from_ref(a)))
            }
            Expression::Powf(two) => atom(self.call("powf", two.as_slice())),
            Expression::Atan2(two) => atom(self.call("atan2", two.as_slice())),
            Expression::Min(two) => atom(self.call("min", two.as_slice())),
            Expression::Max(two) => atom(self.call("max", two.as_slice())),
            Expression::Powi(a, exponent) => {
                self.functions.insert("powi");
                let a = self.whole(a);
                let magnitude = integer(exponent.unsigned_abs() as usize);
                let sign = (*exponent < 0).then(|| quote!(-));
                atom(quote!(powi(#a, #sign #magnitude)))
            }
            Expression::Select(comparison, four) => {
                let function = match comparison {
                    Comparison::Less => "if_less",
                    Comparison::LessEqual => "if_less_equal",
                    Comparison::Equal => "if_equal",
                };
                atom(self.call(function, four.as_slice()))
            }
        }
    }

    fn two(&mut self, two: &[Expression; 2], left: Binding, right: Binding) -> [TokenStream; 2] {
        [self.operand(&two[0], left), self.operand(&two[1], right)]
    }
}

/// Functions of `handc_core::math` by node kind.
fn function_name(function: Unary) -> &'static str {
    match function {
        Unary::Neg => "neg",
        Unary::Recip => "recip",
        Unary::Sqrt => "sqrt",
        Unary::Sin => "sin",
        Unary::Cos => "cos",
        Unary::Tan => "tan",
        Unary::Asin => "asin",
        Unary::Acos => "acos",
        Unary::Atan => "atan",
        Unary::Exp => "exp",
        Unary::Log => "log",
        Unary::Floor => "floor",
        Unary::Abs => "abs",
    }
}
