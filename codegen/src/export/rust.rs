//! Rust that depends on nothing but `core`.

use super::law::{FUNCTIONS, LawFormula};
use super::{Export, header};
use crate::emit::{Binding, restore, rust_functions};
use proc_macro2::{Ident, Literal, Punct, Spacing, Span, TokenStream};
use quote::quote;
use std::collections::BTreeSet;

/// The source of a robot's module, formatted.
pub fn module(export: &Export<'_>) -> Result<String, syn::Error> {
    let file = syn::parse2(tokens(export))?;
    let code = restore(&prettyplease::unparse(&file));
    let lines = header::lines(export).into_iter().chain(USE.lines().map(str::to_owned));
    let head: String = lines.map(|line| format!("//! {line}").trim_end().to_owned() + "\n").collect();
    Ok(format!("{head}\n{code}"))
}

/// How the module is used, as lines of its documentation.
const USE: &str = "
The module needs `core` only. Its functions take any `Number`; `f64` and `f32` are ones where the crate that holds the
module has a feature `std`. Without it, implement `Number` for a type of your own over the sine and cosine of your
platform.";

fn tokens(export: &Export<'_>) -> TokenStream {
    let (rows, columns) = export.pattern();
    let [n, nb, entries] =
        [rows.len() - 1, export.set.base.len(), columns.len()].map(Literal::usize_unsuffixed);
    let numbers = |values: &[usize]| values.iter().map(|&x| Literal::usize_unsuffixed(x)).collect::<Vec<_>>();
    let (rows, columns) = (numbers(&rows), numbers(&columns));
    let names = export.set.base.iter().map(|p| p.name.as_ref());
    let functions = rust_functions(&export.table, &export.set, &export.equations);
    let number = number(export);
    let known = known(export);
    quote! {
        #![allow(dead_code, non_snake_case, unused_variables, unexpected_cfgs, clippy::all)]

        use core::ops::{Add, Div, IndexMut, Mul, Neg, Sub};

        /// Number of joints.
        pub const N: usize = #n;
        /// Number of base parameters.
        pub const NB: usize = #nb;
        /// Number of entries of IDM that are not identically zero.
        pub const ENTRIES: usize = #entries;
        /// Row i of IDM has the entries `ROWS[i]..ROWS[i + 1]`.
        pub const ROWS: [usize; N + 1] = [#(#rows),*];
        /// The base parameter of each entry of IDM.
        pub const COLUMNS: [usize; ENTRIES] = [#(#columns),*];
        /// The names of the base parameters.
        pub const NAMES: [&str; NB] = [#(#names),*];

        #number
        #functions
        #known
    }
}

/// The trait, with the functions that the laws need, and its implementations.
fn number(export: &Export<'_>) -> TokenStream {
    let names: BTreeSet<&str> = export.laws.iter().flat_map(LawFormula::functions).collect();
    let plain = names.iter().filter(|name| **name != "powf").map(|name| ident(name));
    let declared = plain.clone().map(|name| {
        let doc = format!(" `{name}` of the number.");
        quote!(#[doc = #doc] fn #name(self) -> Self;)
    });
    let roots = export.table.couplings.iter().any(|c| c.law.between().is_some());
    let declared_root = roots.then(|| {
        quote!(
            #[doc = " 1 / sqrt of the number, 0 where it is not above 0."]
            fn inverse_root(self) -> Self;
        )
    });
    let power = names.contains("powf");
    let declared_power = power.then(|| {
        quote!(
            #[doc = " The number to a power."]
            fn powf(self, power: Self) -> Self;
        )
    });
    let implementations = ["f64", "f32"].map(|real| {
        let real = ident(real);
        let functions = plain.clone().map(|name| quote!(fn #name(self) -> Self { #real::#name(self) }));
        let power = power.then(|| quote!(fn powf(self, power: Self) -> Self { #real::powf(self, power) }));
        let root = roots.then(|| {
            quote!(
                fn inverse_root(self) -> Self {
                    if self > 0.0 { 1.0 / #real::sqrt(self) } else { 0.0 }
                }
            )
        });
        quote! {
            #[cfg(feature = "std")]
            impl Number for #real {
                fn constant(value: f64) -> Self {
                    value as #real
                }
                fn sin_cos(self) -> (Self, Self) {
                    (#real::sin(self), #real::cos(self))
                }
                fn sign(self) -> Self {
                    if self > 0.0 { 1.0 } else if self < 0.0 { -1.0 } else { 0.0 }
                }
                fn add_product(self, a: Self, b: Self) -> Self {
                    if cfg!(target_feature = "fma") { #real::mul_add(a, b, self) } else { self + a * b }
                }
                fn sub_product(self, a: Self, b: Self) -> Self {
                    if cfg!(target_feature = "fma") { #real::mul_add(-a, b, self) } else { self - a * b }
                }
                #root
                #(#functions)*
                #power
            }
        }
    });
    quote! {
        /// What the functions compute with.
        pub trait Number:
            Copy
            + Add<Output = Self>
            + Sub<Output = Self>
            + Mul<Output = Self>
            + Div<Output = Self>
            + Neg<Output = Self>
        {
            /// The number that stands for a constant.
            fn constant(value: f64) -> Self;
            /// Sine and cosine of an angle, rad.
            fn sin_cos(self) -> (Self, Self);
            /// -1, 0 or 1 with the sign of the number.
            fn sign(self) -> Self;
            /// self + a * b.
            fn add_product(self, a: Self, b: Self) -> Self {
                self + a * b
            }
            /// self - a * b.
            fn sub_product(self, a: Self, b: Self) -> Self {
                self - a * b
            }
            /// Sines and cosines of several angles, rad.
            fn sin_cos_each<const K: usize>(angles: [Self; K]) -> ([Self; K], [Self; K]) {
                let pairs = angles.map(Self::sin_cos);
                (pairs.map(|p| p.0), pairs.map(|p| p.1))
            }
            #declared_root
            #(#declared)*
            #declared_power
        }
        #(#implementations)*
    }
}

/// Parameters and torques of the identified model.
fn known(export: &Export<'_>) -> TokenStream {
    let Some(known) = export.known else { return TokenStream::new() };
    let chi = export.parameters().into_iter().map(float);
    let inputs: BTreeSet<_> = export.laws.iter().flat_map(LawFormula::inputs).collect();
    let inputs = inputs.iter().filter(|i| i.array != "load").map(|input| {
        let (name, array, joint) =
            (ident(&input.name), ident(input.array), Literal::usize_unsuffixed(input.joint));
        quote!(let #name = #array[#joint];)
    });
    let (constant, loads) = if export.needs_loads() {
        let values = export.load_parameters();
        let values = values.iter().map(|&x| float(x));
        (
            quote! {
                /// The same with friction and offsets zero.
                const CHI_LOAD: [f64; NB] = [#(#values),*];
            },
            quote! {
                let mut load = [k(0.0); N];
                self::tau(&CHI_LOAD.map(T::constant), q, dq, ddq, &mut load);
            },
        )
    } else {
        (TokenStream::new(), TokenStream::new())
    };
    let terms = known.laws.iter().zip(&export.laws).map(|(law, formula)| {
        let title = crate::emit::comment(&law.title);
        let (joint, value) = (Literal::usize_unsuffixed(law.joint), law_tokens(formula));
        quote! {
            #title
            tau[#joint] = tau[#joint] + #value;
        }
    });
    quote! {
        /// The base parameters of the identified model.
        pub const CHI: [f64; NB] = [#(#chi),*];
        #constant
        /// Torques of the identified model, all that it leaves to its laws included.
        pub fn model_tau<T: Number>(q: &[T; N], dq: &[T; N], ddq: &[T; N], tau: &mut [T; N]) {
            let k = T::constant;
            #(#inputs)*
            self::tau(&CHI.map(T::constant), q, dq, ddq, tau);
            #loads
            #(#terms)*
        }
    }
}

fn law_tokens(law: &LawFormula) -> TokenStream {
    match law {
        LawFormula::Number(x) => {
            let x = float(*x);
            quote!(k(#x))
        }
        LawFormula::Input(input) if input.array == "load" => {
            let joint = Literal::usize_unsuffixed(input.joint);
            quote!(load[#joint])
        }
        LawFormula::Input(input) => {
            let name = ident(&input.name);
            quote!(#name)
        }
        LawFormula::Negative(a) => {
            let a = law_at_least(a, Binding::Atom);
            quote!(-#a)
        }
        LawFormula::Combined('^', both) => {
            let (a, b) = (law_at_least(&both[0], Binding::Atom), law_tokens(&both[1]));
            quote!(#a.powf(#b))
        }
        LawFormula::Combined(operator, both) => {
            let [left, right] = LawFormula::operands(*operator);
            let (a, b) = (law_at_least(&both[0], left), law_at_least(&both[1], right));
            let operator = Punct::new(*operator, Spacing::Alone);
            quote!(#a #operator #b)
        }
        LawFormula::Call(function, a) => {
            let (name, a) = (FUNCTIONS[*function][2], law_tokens(a));
            // The trait has both of one angle; the one that is not used costs nothing where they are inlined.
            match name {
                "sin" => quote!(T::sin_cos(#a).0),
                "cos" => quote!(T::sin_cos(#a).1),
                _ => {
                    let name = ident(name);
                    quote!(T::#name(#a))
                }
            }
        }
    }
}

/// A law as an operand that must bind at least so tightly.
fn law_at_least(operand: &LawFormula, binding: Binding) -> TokenStream {
    let tokens = law_tokens(operand);
    if operand.binding() < binding { quote!((#tokens)) } else { tokens }
}

fn float(value: f64) -> TokenStream {
    let literal = Literal::f64_unsuffixed(value.abs());
    if value < 0.0 { quote!(-#literal) } else { quote!(#literal) }
}

fn ident(name: &str) -> Ident {
    Ident::new(name, Span::call_site())
}
