//! Constants as text.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

/// The shortest digits that give the same number back, with a sign if negative.
pub fn number(value: f64) -> TokenStream {
    if value.is_nan() {
        return quote!(f64::NAN);
    }
    let magnitude = if value.is_infinite() {
        quote!(f64::INFINITY)
    } else {
        // `{:?}` writes exponents where digits would be many, and always a point or an exponent.
        let text = format!("{:?}", value.abs());
        match text.parse::<Literal>() {
            Ok(literal) => quote!(#literal),
            Err(_) => {
                let literal = Literal::f64_unsuffixed(value.abs());
                quote!(#literal)
            }
        }
    };
    if value.is_sign_negative() { quote!(-#magnitude) } else { magnitude }
}

/// An index or a size.
pub fn integer(value: usize) -> Literal {
    Literal::usize_unsuffixed(value)
}
