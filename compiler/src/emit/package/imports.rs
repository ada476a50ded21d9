//! The `use` lines of a generated module: what its code mentions and nothing else.

use super::names::Names;
use crate::emit::function::MATH;
use crate::emit::print::identifier;
use proc_macro2::{TokenStream, TokenTree};
use quote::quote;
use std::collections::BTreeSet;

/// Every identifier in `tokens` that stands for itself: not what follows `::` or a dot, which is
/// looked up in what stands before it.
pub(super) fn mentioned(tokens: &TokenStream) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut open = vec![tokens.clone()];
    while let Some(stream) = open.pop() {
        let mut before = [' '; 2];
        for tree in stream {
            let mut last = ' ';
            match tree {
                TokenTree::Ident(ident) => {
                    let is_member = before == [':'; 2] || (before[1] == '.' && before[0] != '.');
                    if !is_member {
                        found.insert(ident.to_string());
                    }
                }
                TokenTree::Group(group) => open.push(group.stream()),
                TokenTree::Punct(punct) => last = punct.as_char(),
                TokenTree::Literal(_) => {}
            }
            before = [before[1], last];
        }
    }
    found
}

/// Those of `candidates` that `tokens` mention, imported from `path`.
pub(super) fn from(path: TokenStream, candidates: &[&str], tokens: &TokenStream) -> TokenStream {
    let mentioned = mentioned(tokens);
    let used: BTreeSet<&str> =
        candidates.iter().copied().filter(|name| mentioned.contains(*name)).collect();
    let used: Vec<_> = used.into_iter().map(identifier).collect();
    match &used[..] {
        [] => TokenStream::new(),
        [one] => quote!(use #path::#one;),
        many => quote!(use #path::{#(#many),*};),
    }
}

/// Imports of the equations of a shape.
pub(super) fn of_equations(names: &Names, tokens: &TokenStream) -> TokenStream {
    let lists = names.indices();
    let mut local: Vec<&str> = lists.iter().flat_map(|list| [list.module, list.count]).collect();
    local.extend(names.sizes.iter().map(|(name, _)| *name));
    let local = from(quote!(crate::layout), &local, tokens);
    let functions = from(quote!(handc_core::lane::functions), &MATH, tokens);
    let shape = from(quote!(handc_core::shape), &["Local", "Place", "Shape", "is_sound"], tokens);
    quote! {
        #local
        use handc_core::lane::Lane;
        #functions
        #shape
    }
}

/// Imports of straight-line code: named indices, array sizes, and mathematical functions.
pub(super) fn of_functions(names: &Names, tokens: &TokenStream) -> TokenStream {
    let lists = names.indices();
    let mut local: Vec<&str> = lists.iter().flat_map(|list| [list.module, list.count]).collect();
    local.extend(names.sizes.iter().map(|(name, _)| *name));
    let local = from(quote!(crate::layout), &local, tokens);
    let math = from(quote!(handc_core::math), &MATH, tokens);
    quote!(#local #math)
}
