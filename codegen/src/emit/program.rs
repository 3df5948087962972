//! Expressions as Rust statements: what gets a name, what is written in place, and with which sign.

use crate::symbolic::{Angle, Expr, Graph, Node, Symbol};
use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::{format_ident, quote};
use std::collections::HashSet;

/// Names of the inputs of a robot's functions.
#[derive(Debug, Clone)]
pub struct InputNames {
    /// Number j of the frame of each joint: `q<j>`, `dq<j>`, `ddq<j>`.
    pub joints: Vec<usize>,
    /// Base parameters.
    pub parameters: Vec<String>,
}

impl InputNames {
    /// The variable of an input.
    pub fn symbol(&self, symbol: Symbol) -> Ident {
        match symbol {
            Symbol::Position(k) => format_ident!("q{}", self.joints[k]),
            Symbol::Velocity(k) => format_ident!("dq{}", self.joints[k]),
            Symbol::Acceleration(k) => format_ident!("ddq{}", self.joints[k]),
            Symbol::Parameter(k) => Ident::new(&self.parameters[k], Span::call_site()),
        }
    }

    /// `23` for q2 + q3, `2m3` for q2 - q3.
    fn angle(&self, angle: &Angle) -> String {
        let wide = angle.terms.iter().any(|t| self.joints[t.0] > 9);
        let mut text = String::new();
        for (at, &(joint, k)) in angle.terms.iter().enumerate() {
            if k < 0 {
                text.push('m');
            } else if wide && at > 0 {
                text.push('_');
            }
            if k.abs() != 1 {
                text.push_str(&format!("{}x", k.abs()));
            }
            text.push_str(&self.joints[joint].to_string());
        }
        text
    }
}

/// Source text with how tightly its outermost operator binds.
struct Piece {
    tokens: TokenStream,
    binding: Binding,
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Binding {
    Sum,
    Product,
    Sign,
    Atom,
}

impl Piece {
    fn atom(tokens: TokenStream) -> Self {
        Piece { tokens, binding: Binding::Atom }
    }

    /// The text as an operand that must bind at least so tightly.
    fn at_least(self, binding: Binding) -> TokenStream {
        let tokens = self.tokens;
        if self.binding < binding { quote!((#tokens)) } else { tokens }
    }
}

/// Names for the values of one function.
pub struct Program<'a> {
    graph: &'a Graph,
    inputs: &'a InputNames,
    uses: Vec<usize>,
    variables: Vec<Option<Ident>>,
    angle_names: Vec<String>,
}

impl<'a> Program<'a> {
    /// Decides which operations get a name: those with a name of their own and those used more than once.
    ///
    /// A name whose letters are in `foreign` belongs to a quantity that the function is not about and that happens to
    /// be the same expression; it would mislead.
    pub fn new(
        graph: &'a Graph,
        inputs: &'a InputNames,
        outputs: &[Expr],
        order: &[Vec<usize>],
        foreign: &[&str],
    ) -> Self {
        let uses = graph.uses(outputs);
        let mut taken: HashSet<String> = HashSet::new();
        let mut unique = |name: String| {
            let mut candidate = name.clone();
            let mut suffix = 1;
            while !taken.insert(candidate.clone()) {
                suffix += 1;
                candidate = format!("{name}_{suffix}");
            }
            candidate
        };
        let angle_names = graph.angles().iter().map(|angle| unique(inputs.angle(angle))).collect();
        let mut variables = vec![None; graph.len()];
        let mut temporaries = 0;
        for &node in order.iter().flatten() {
            let letters =
                |name: &str| name.split(|c: char| c.is_ascii_digit()).next().unwrap_or("").to_owned();
            let own = graph.name_of(node).filter(|name| !foreign.contains(&letters(name).as_str()));
            let name = match own {
                Some(name) => unique(name.to_owned()),
                None if uses[node] > 1 => {
                    temporaries += 1;
                    format!("t{temporaries}")
                }
                None => continue,
            };
            variables[node] = Some(Ident::new(&name, Span::call_site()));
        }
        Program { graph, inputs, uses, variables, angle_names }
    }

    /// The variable that holds a node, unless it is written in place.
    pub fn variable(&self, node: usize) -> Option<&Ident> {
        self.variables[node].as_ref()
    }

    /// The variables of sine and cosine of an angle.
    pub fn sine_cosine(&self, angle: usize) -> (Ident, Ident) {
        let name = &self.angle_names[angle];
        (format_ident!("s{}", name), format_ident!("c{}", name))
    }

    /// The angle itself, from the joint variables.
    pub fn angle(&self, angle: usize) -> TokenStream {
        let angle = &self.graph.angles()[angle];
        let mut text = TokenStream::new();
        for (at, &(joint, k)) in angle.terms.iter().enumerate() {
            let q = self.inputs.symbol(Symbol::Position(joint));
            let term = match k.abs() {
                1 => quote!(#q),
                k => {
                    let k = Literal::f64_unsuffixed(f64::from(k));
                    quote!(k(#k) * #q)
                }
            };
            text.extend(match (at, k < 0) {
                (0, false) => term,
                (0, true) => quote!(-#term),
                (_, false) => quote!(+ #term),
                (_, true) => quote!(- #term),
            });
        }
        if angle.constant.rest != 0.0 {
            let rest = Literal::f64_unsuffixed(angle.constant.rest.abs());
            text.extend(if angle.constant.rest < 0.0 { quote!(- k(#rest)) } else { quote!(+ k(#rest)) });
        }
        text
    }

    /// The value of a node that has a variable, as the right side of its `let`.
    pub fn definition(&self, node: usize) -> TokenStream {
        self.operation(Expr::new(node, false)).tokens
    }

    /// The value of an output.
    pub fn value(&self, e: Expr) -> TokenStream {
        self.piece(e).tokens
    }

    fn piece(&self, e: Expr) -> Piece {
        if let Some(value) = self.graph.constant_value(e) {
            return constant(value);
        }
        let held = match self.graph.node(e.node()) {
            Node::Symbol(symbol) => Some(self.inputs.symbol(symbol)),
            Node::Sine(angle) => Some(self.sine_cosine(angle).0),
            Node::Cosine(angle) => Some(self.sine_cosine(angle).1),
            _ => self.variables[e.node()].clone(),
        };
        match held {
            Some(ident) if e.is_negative() => Piece { tokens: quote!(-#ident), binding: Binding::Sign },
            Some(ident) => Piece::atom(quote!(#ident)),
            None => self.operation(e),
        }
    }

    fn operation(&self, e: Expr) -> Piece {
        match self.graph.node(e.node()) {
            Node::Sum(..) => self.sum(e),
            Node::Product(a, b) => {
                let left = match self.graph.constant_value(a) {
                    Some(value) if e.is_negative() => constant(-value),
                    _ if e.is_negative() => negated(self.piece(a)),
                    _ => self.piece(a),
                };
                let left = left.at_least(Binding::Product);
                let right = self.piece(b).at_least(Binding::Sign);
                Piece { tokens: quote!(#left * #right), binding: Binding::Product }
            }
            Node::Sign(a) => {
                let a = self.piece(a).at_least(Binding::Atom);
                let sign = Piece::atom(quote!(#a.sign()));
                if e.is_negative() { negated(sign) } else { sign }
            }
            _ => self.piece(e),
        }
    }

    /// A sum with all sums that are used nowhere else written into it, products accumulated.
    fn sum(&self, e: Expr) -> Piece {
        let mut terms = Vec::new();
        self.collect_terms(e, true, &mut terms);
        let product = |e: &Expr| {
            self.variables[e.node()].is_none() && matches!(self.graph.node(e.node()), Node::Product(..))
        };
        // Start from a plain positive term, else from a positive product, so that no sign costs anything.
        let start = terms
            .iter()
            .position(|t| !t.is_negative() && !product(t))
            .or_else(|| terms.iter().position(|t| !t.is_negative()))
            .unwrap_or(0);
        let first = terms.remove(start);
        let mut total = self.piece(first);
        terms.sort_by_key(|t| !product(t));
        for term in terms {
            let magnitude = term.magnitude();
            total = match self.graph.node(term.node()) {
                Node::Product(a, b) if product(&term) => {
                    let accumulator = total.at_least(Binding::Atom);
                    let (a, b) = (self.piece(a).tokens, self.piece(b).tokens);
                    Piece::atom(if term.is_negative() {
                        quote!(#accumulator.sub_product(#a, #b))
                    } else {
                        quote!(#accumulator.add_product(#a, #b))
                    })
                }
                _ => {
                    let left = total.at_least(Binding::Sum);
                    let right = self.piece(magnitude).at_least(Binding::Product);
                    let tokens =
                        if term.is_negative() { quote!(#left - #right) } else { quote!(#left + #right) };
                    Piece { tokens, binding: Binding::Sum }
                }
            };
        }
        total
    }

    fn collect_terms(&self, e: Expr, top: bool, terms: &mut Vec<Expr>) {
        match self.graph.node(e.node()) {
            Node::Sum(a, b) if top || (self.variables[e.node()].is_none() && self.uses[e.node()] == 1) => {
                for term in [a, b] {
                    self.collect_terms(if e.is_negative() { -term } else { term }, false, terms);
                }
            }
            _ => terms.push(e),
        }
    }
}

fn constant(value: f64) -> Piece {
    let literal = Literal::f64_unsuffixed(value.abs());
    Piece::atom(if value < 0.0 { quote!(k(-#literal)) } else { quote!(k(#literal)) })
}

fn negated(piece: Piece) -> Piece {
    let tokens = piece.at_least(Binding::Atom);
    Piece { tokens: quote!(-#tokens), binding: Binding::Sign }
}
