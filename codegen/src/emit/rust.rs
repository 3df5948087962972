//! Functions as Rust.

use super::comments::comment;
use super::function::{Part, Signature};
use super::statement::{Binding, Formula, Statement};
use proc_macro2::{Ident, Literal, Span, TokenStream, TokenTree};
use quote::{format_ident, quote};

/// The parts of a function, each of which calls the next.
pub fn function(signature: &Signature<'_>, parts: &[Part]) -> TokenStream {
    let results: Vec<TokenStream> = signature
        .results
        .iter()
        .map(|(name, length)| {
            let (name, length) = (ident(name), length.map(length_tokens));
            match length {
                Some(length) => quote!(#name: &mut [T; #length]),
                None => quote!(#name: &mut impl IndexMut<usize, Output = T>),
            }
        })
        .collect();
    let result_names: Vec<Ident> = signature.results.iter().map(|(name, _)| ident(name)).collect();
    let mut text = TokenStream::new();
    for (at, part) in parts.iter().enumerate() {
        let whole: TokenStream = part.statements.iter().map(statement).collect();
        let constant = mentions_constants(&whole).then(|| quote!(let k = T::constant;));
        let next = (at + 1 < parts.len()).then(|| {
            let name = format_ident!("{}_part_{}", signature.name, at + 2);
            let handed = part.handed.iter().map(|name| ident(name));
            quote!(#name([#(#handed),*], #(#result_names),*);)
        });
        let body = quote!({ #constant #whole #next });
        text.extend(if at == 0 {
            let (name, doc) = (ident(signature.name), format!(" {}", signature.doc));
            let arguments = signature.arguments.iter().map(|(name, length)| {
                let (name, length) = (ident(name), length_tokens(length));
                quote!(#name: &[T; #length])
            });
            quote! {
                #[doc = #doc]
                pub fn #name<T: Number>(#(#arguments,)* #(#results),*) #body
            }
        } else {
            let name = format_ident!("{}_part_{}", signature.name, at + 1);
            let taken = part.taken.iter().map(|name| ident(name));
            let count = Literal::usize_unsuffixed(part.taken.len());
            quote! {
                #[inline(never)]
                fn #name<T: Number>([#(#taken),*]: [T; #count], #(#results),*) #body
            }
        });
    }
    text
}

fn statement(statement: &Statement) -> TokenStream {
    match statement {
        Statement::Unpack { array, values } => {
            let (array, pattern) = (ident(array), values.iter().map(|v| used(v.as_ref())));
            quote!(let [#(#pattern),*] = *#array;)
        }
        Statement::SinesAndCosines(pairs) => {
            let sines = pairs.iter().map(|p| used(p.sine.as_ref()));
            let cosines = pairs.iter().map(|p| used(p.cosine.as_ref()));
            let angles = pairs.iter().map(|p| formula(&p.angle));
            quote! {
                let ([#(#sines),*], [#(#cosines),*]) = T::sin_cos_each([#(#angles),*]);
            }
        }
        Statement::Comment(text) => comment(text),
        Statement::Let { name, value } => {
            let (name, value) = (ident(name), formula(value));
            quote!(let #name = #value;)
        }
        Statement::Output { result, index, value } => {
            let (result, index, value) = (ident(result), Literal::usize_unsuffixed(*index), formula(value));
            quote!(#result[#index] = #value;)
        }
    }
}

/// A name in a pattern, or a place for what is not used.
fn used(name: Option<&String>) -> TokenStream {
    match name {
        Some(name) => {
            let name = ident(name);
            quote!(#name)
        }
        None => quote!(_),
    }
}

fn formula(formula: &Formula) -> TokenStream {
    match formula {
        Formula::Constant(value) => {
            let literal = Literal::f64_unsuffixed(value.abs());
            if *value < 0.0 { quote!(k(-#literal)) } else { quote!(k(#literal)) }
        }
        Formula::Variable(name) => {
            let name = ident(name);
            quote!(#name)
        }
        Formula::Minus(a) => {
            let a = at_least(a, Binding::Atom);
            quote!(-#a)
        }
        Formula::Sign(a) => {
            let a = at_least(a, Binding::Atom);
            quote!(#a.sign())
        }
        Formula::InverseRoot(a) => {
            let a = at_least(a, Binding::Atom);
            quote!(#a.inverse_root())
        }
        Formula::Sum(a, b) => {
            let (a, b) = (at_least(a, Binding::Sum), at_least(b, Binding::Product));
            quote!(#a + #b)
        }
        Formula::Difference(a, b) => {
            let (a, b) = (at_least(a, Binding::Sum), at_least(b, Binding::Product));
            quote!(#a - #b)
        }
        Formula::Product(a, b) => {
            let (a, b) = (at_least(a, Binding::Product), at_least(b, Binding::Sign));
            quote!(#a * #b)
        }
        Formula::Accumulated { total, factors, subtracted } => {
            let total = at_least(total, Binding::Atom);
            let [a, b] = factors.each_ref().map(self::formula);
            if *subtracted { quote!(#total.sub_product(#a, #b)) } else { quote!(#total.add_product(#a, #b)) }
        }
    }
}

/// A formula as an operand that must bind at least so tightly.
fn at_least(operand: &Formula, binding: Binding) -> TokenStream {
    let tokens = formula(operand);
    if operand.binding() < binding { quote!((#tokens)) } else { tokens }
}

fn ident(name: &str) -> Ident {
    Ident::new(name, Span::call_site())
}

/// `N`, or `N * N`.
fn length_tokens(text: &str) -> TokenStream {
    let mut tokens = TokenStream::new();
    for factor in text.split(" * ") {
        let factor = ident(factor);
        let times = (!tokens.is_empty()).then(|| quote!(*));
        tokens.extend(quote!(#times #factor));
    }
    tokens
}

/// Whether a text calls `k`, the constructor of constants.
fn mentions_constants(text: &TokenStream) -> bool {
    text.clone().into_iter().any(|token| match token {
        TokenTree::Ident(name) => name == "k",
        TokenTree::Group(group) => mentions_constants(&group.stream()),
        _ => false,
    })
}
