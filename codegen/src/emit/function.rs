//! Functions: scheduled statements, cut where they would get too long for the compiler.

use super::comments::comment;
use super::program::{InputNames, Program};
use crate::symbolic::{Expr, Graph, Node, Symbol, schedule};
use proc_macro2::{Ident, Literal, Span, TokenStream, TokenTree};
use quote::{format_ident, quote};
use std::collections::BTreeSet;

/// Statements that one function may hold; rustc overflows its stack on a few thousand.
const MOST_STATEMENTS: usize = 900;

/// One value that a function writes.
pub struct Output {
    /// Index in its result.
    pub index: usize,
    /// Which result (`h`, `mass`, ...), an index into [`Signature::results`].
    pub result: usize,
    /// The value.
    pub value: Expr,
    /// Title of the group it belongs to; a function that gets too long is cut between groups.
    pub group: String,
}

/// A function to be written.
pub struct Signature<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its documentation.
    pub doc: &'a str,
    /// Arguments: name, and length as a constant of the module.
    pub arguments: &'a [(&'a str, &'a str)],
    /// Letters of names that belong to other functions: `dw` is no part of an energy.
    pub foreign: &'a [&'a str],
    /// Results: name and length; without a length, a place that takes values by their index.
    pub results: &'a [(&'a str, Option<&'a str>)],
}

/// One statement, the values it uses and the value it defines.
struct Statement {
    text: TokenStream,
    defines: Option<Ident>,
    uses: Vec<Ident>,
    group: usize,
}

/// The function, in as many parts as it takes.
pub fn function(
    graph: &Graph,
    inputs: &InputNames,
    signature: &Signature<'_>,
    outputs: &[Output],
) -> TokenStream {
    let values: Vec<Expr> = outputs.iter().map(|o| o.value).collect();
    let order = schedule(graph, &values);
    let program = Program::new(graph, inputs, &values, &order, signature.foreign);
    let statements = statements(graph, inputs, &program, signature, outputs, &order);
    let parts = cut(statements);
    let head = prologue(graph, inputs, &program, &values);
    let names: BTreeSet<String> = head.iter().flat_map(|s| &s.0).map(Ident::to_string).collect();
    let opening = head.into_iter().map(|(_, text)| text).collect();
    write_parts(signature, opening, names, &parts)
}

/// The input of a kind by its index.
type MakeSymbol = fn(usize) -> Symbol;

/// The inputs that are used, unpacked, and the sines and cosines: the names they define, and the text.
fn prologue(
    graph: &Graph,
    inputs: &InputNames,
    program: &Program<'_>,
    values: &[Expr],
) -> Vec<(Vec<Ident>, TokenStream)> {
    let reachable = graph.reachable(values);
    let mut symbols: BTreeSet<Symbol> = BTreeSet::new();
    let mut angles = BTreeSet::new();
    for &at in &reachable {
        match graph.node(at) {
            Node::Symbol(symbol) => {
                symbols.insert(symbol);
            }
            Node::Sine(a) | Node::Cosine(a) => {
                angles.insert(a);
                symbols.extend(graph.angles()[a].terms.iter().map(|t| Symbol::Position(t.0)));
            }
            _ => {}
        }
    }
    let n = inputs.joints.len();
    let families: [(&str, usize, MakeSymbol); 4] = [
        ("q", n, Symbol::Position),
        ("dq", n, Symbol::Velocity),
        ("ddq", n, Symbol::Acceleration),
        ("chi", inputs.parameters.len(), Symbol::Parameter),
    ];
    let mut head = Vec::new();
    for (name, count, symbol) in families {
        let used: Vec<Ident> =
            (0..count).filter(|&k| symbols.contains(&symbol(k))).map(|k| inputs.symbol(symbol(k))).collect();
        if used.is_empty() {
            continue;
        }
        let pattern = (0..count).map(|k| {
            let (symbol, ident) = (symbol(k), inputs.symbol(symbol(k)));
            if symbols.contains(&symbol) { quote!(#ident) } else { quote!(_) }
        });
        let array = Ident::new(name, Span::call_site());
        head.push((used, quote!(let [#(#pattern),*] = *#array;)));
    }
    if !angles.is_empty() {
        let (sines, cosines): (Vec<_>, Vec<_>) = angles.iter().map(|&a| program.sine_cosine(a)).unzip();
        let arguments = angles.iter().map(|&a| program.angle(a));
        let used = |ident: &Ident, node: Node| {
            if reachable.iter().any(|&at| graph.node(at) == node) { quote!(#ident) } else { quote!(_) }
        };
        let sine_pattern = angles.iter().zip(&sines).map(|(&a, s)| used(s, Node::Sine(a)));
        let cosine_pattern = angles.iter().zip(&cosines).map(|(&a, c)| used(c, Node::Cosine(a)));
        let text = quote! {
            let ([#(#sine_pattern),*], [#(#cosine_pattern),*]) = T::sin_cos_each([#(#arguments),*]);
        };
        head.push((sines.into_iter().chain(cosines).collect(), text));
    }
    head
}

fn statements(
    graph: &Graph,
    inputs: &InputNames,
    program: &Program<'_>,
    signature: &Signature<'_>,
    outputs: &[Output],
    order: &[Vec<usize>],
) -> Vec<Statement> {
    let mut statements = Vec::new();
    let mut group = 0;
    for (at, (output, needed)) in outputs.iter().zip(order).enumerate() {
        let starts = at == 0 || outputs[at - 1].group != output.group;
        group += usize::from(starts);
        if starts && !output.group.is_empty() {
            let text = comment(&output.group);
            statements.push(Statement { text, defines: None, uses: Vec::new(), group });
        }
        for &node in needed {
            if let Some(ident) = program.variable(node) {
                let definition = program.definition(node);
                let uses = held(graph, inputs, program, graph.operands(node));
                let text = quote!(let #ident = #definition;);
                statements.push(Statement { text, defines: Some(ident.clone()), uses, group });
            }
        }
        let result = Ident::new(signature.results[output.result].0, Span::call_site());
        let index = Literal::usize_unsuffixed(output.index);
        let value = program.value(output.value);
        let uses = held(graph, inputs, program, std::iter::once(output.value));
        statements.push(Statement { text: quote!(#result[#index] = #value;), defines: None, uses, group });
    }
    statements
}

/// The variables that expressions read, through everything that is written in place.
fn held(
    graph: &Graph,
    inputs: &InputNames,
    program: &Program<'_>,
    operands: impl Iterator<Item = Expr>,
) -> Vec<Ident> {
    let mut pending: Vec<Expr> = operands.collect();
    let mut found = Vec::new();
    while let Some(e) = pending.pop() {
        match graph.node(e.node()) {
            Node::Constant(_) => {}
            Node::Symbol(symbol) => found.push(inputs.symbol(symbol)),
            Node::Sine(a) => found.push(program.sine_cosine(a).0),
            Node::Cosine(a) => found.push(program.sine_cosine(a).1),
            _ => match program.variable(e.node()) {
                Some(ident) => found.push(ident.clone()),
                None => pending.extend(graph.operands(e.node())),
            },
        }
    }
    found
}

/// Parts of bounded length, cut between groups where a group fits.
fn cut(statements: Vec<Statement>) -> Vec<Vec<Statement>> {
    let mut parts = Vec::new();
    let mut part: Vec<Statement> = Vec::new();
    let mut rest = statements.into_iter().peekable();
    while let Some(group) = rest.peek().map(|s| s.group) {
        let mut members = Vec::new();
        while let Some(statement) = rest.next_if(|s| s.group == group && members.len() < MOST_STATEMENTS) {
            members.push(statement);
        }
        if part.len() + members.len() > MOST_STATEMENTS {
            parts.push(std::mem::take(&mut part));
        }
        part.extend(members);
    }
    parts.push(part);
    parts
}

/// The parts as functions, each of which hands the values still needed to the next.
fn write_parts(
    signature: &Signature<'_>,
    opening: TokenStream,
    opened: BTreeSet<String>,
    parts: &[Vec<Statement>],
) -> TokenStream {
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
    let mut known = opened;
    let mut carried: Vec<Ident> = Vec::new();
    let mut text = TokenStream::new();
    for (at, part) in parts.iter().enumerate() {
        let body: TokenStream = part.iter().map(|s| s.text.clone()).collect();
        let mut whole = if at == 0 { opening.clone() } else { TokenStream::new() };
        whole.extend(body);
        known.extend(part.iter().filter_map(|s| s.defines.as_ref()).map(Ident::to_string));
        let later: BTreeSet<&Ident> = parts[at + 1..].iter().flatten().flat_map(|s| &s.uses).collect();
        let handed: Vec<Ident> =
            later.into_iter().filter(|i| known.contains(&i.to_string())).cloned().collect();
        let constant = mentions_constants(&whole).then(|| quote!(let k = T::constant;));
        let next = (at + 1 < parts.len()).then(|| {
            let name = format_ident!("{}_part_{}", signature.name, at + 2);
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
            let count = Literal::usize_unsuffixed(carried.len());
            quote! {
                #[inline(never)]
                fn #name<T: Number>([#(#carried),*]: [T; #count], #(#results),*) #body
            }
        });
        carried = handed;
    }
    text
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
