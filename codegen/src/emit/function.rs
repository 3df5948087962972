//! Functions: scheduled statements, cut where they would get too long for the compiler.

use super::program::{InputNames, Program};
use super::statement::{SineCosine, Statement};
use crate::symbolic::{Expr, Graph, Node, Symbol, schedule};
use std::collections::BTreeSet;

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
struct Step {
    statement: Statement,
    uses: Vec<String>,
    group: usize,
}

/// A stretch of a function that is short enough for a compiler.
pub struct Part {
    /// Values that it takes over from the part before it.
    pub taken: Vec<String>,
    /// What it does.
    pub statements: Vec<Statement>,
    /// Values that it hands to the part after it.
    pub handed: Vec<String>,
}

/// The function, in as many parts of at most `most` statements as it takes.
pub fn parts(
    graph: &Graph,
    inputs: &InputNames,
    signature: &Signature<'_>,
    outputs: &[Output],
    most: usize,
) -> Vec<Part> {
    let values: Vec<Expr> = outputs.iter().map(|o| o.value).collect();
    let order = schedule(graph, &values);
    let program = Program::new(graph, inputs, &values, &order, signature.foreign);
    let steps = steps(graph, inputs, &program, signature, outputs, &order);
    linked(prologue(graph, inputs, &program, &values), cut(steps, most))
}

/// The input of a kind by its index.
type MakeSymbol = fn(usize) -> Symbol;

/// The inputs that are used, unpacked, and the sines and cosines.
fn prologue(graph: &Graph, inputs: &InputNames, program: &Program<'_>, values: &[Expr]) -> Vec<Statement> {
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
    let unpacked = families.iter().filter_map(|&(name, count, symbol)| {
        let used = |k: usize| symbols.contains(&symbol(k)).then(|| inputs.symbol(symbol(k)));
        let values: Vec<Option<String>> = (0..count).map(used).collect();
        values.iter().any(Option::is_some).then(|| Statement::Unpack { array: name.to_owned(), values })
    });
    let mut head: Vec<Statement> = unpacked.collect();
    if !angles.is_empty() {
        let is_used = |node: Node| reachable.iter().any(|&at| graph.node(at) == node);
        let pair = |&a: &usize| {
            let (sine, cosine) = program.sine_cosine(a);
            SineCosine {
                sine: is_used(Node::Sine(a)).then_some(sine),
                cosine: is_used(Node::Cosine(a)).then_some(cosine),
                angle: program.angle(a),
            }
        };
        let pairs = angles.iter().map(pair).collect();
        // Right after the positions: a value that is loaded before the branch for large angles is spilled to the stack.
        let place = usize::from(symbols.iter().any(|s| matches!(s, Symbol::Position(_))));
        head.insert(place, Statement::SinesAndCosines(pairs));
    }
    head
}

fn steps(
    graph: &Graph,
    inputs: &InputNames,
    program: &Program<'_>,
    signature: &Signature<'_>,
    outputs: &[Output],
    order: &[Vec<usize>],
) -> Vec<Step> {
    let mut steps = Vec::new();
    let mut group = 0;
    for (at, (output, needed)) in outputs.iter().zip(order).enumerate() {
        let starts = at == 0 || outputs[at - 1].group != output.group;
        group += usize::from(starts);
        if starts && !output.group.is_empty() {
            let statement = Statement::Comment(output.group.clone());
            steps.push(Step { statement, uses: Vec::new(), group });
        }
        for &node in needed {
            if let Some(name) = program.variable(node) {
                let uses = held(graph, inputs, program, graph.operands(node));
                let statement = Statement::Let { name: name.to_owned(), value: program.definition(node) };
                steps.push(Step { statement, uses, group });
            }
        }
        let result = signature.results[output.result].0.to_owned();
        let uses = held(graph, inputs, program, std::iter::once(output.value));
        let statement = Statement::Output { result, index: output.index, value: program.value(output.value) };
        steps.push(Step { statement, uses, group });
    }
    steps
}

/// The variables that expressions read, through everything that is written in place.
fn held(
    graph: &Graph,
    inputs: &InputNames,
    program: &Program<'_>,
    operands: impl Iterator<Item = Expr>,
) -> Vec<String> {
    let mut pending: Vec<Expr> = operands.collect();
    let mut found = Vec::new();
    while let Some(e) = pending.pop() {
        match graph.node(e.node()) {
            Node::Constant(_) => {}
            Node::Symbol(symbol) => found.push(inputs.symbol(symbol)),
            Node::Sine(a) => found.push(program.sine_cosine(a).0),
            Node::Cosine(a) => found.push(program.sine_cosine(a).1),
            _ => match program.variable(e.node()) {
                Some(name) => found.push(name.to_owned()),
                None => pending.extend(graph.operands(e.node())),
            },
        }
    }
    found
}

/// Parts of bounded length, cut between groups where a group fits.
fn cut(steps: Vec<Step>, most: usize) -> Vec<Vec<Step>> {
    let mut parts = Vec::new();
    let mut part: Vec<Step> = Vec::new();
    let mut rest = steps.into_iter().peekable();
    while let Some(group) = rest.peek().map(|s| s.group) {
        let mut members = Vec::new();
        while let Some(step) = rest.next_if(|s| s.group == group && members.len() < most) {
            members.push(step);
        }
        if part.len() + members.len() > most {
            parts.push(std::mem::take(&mut part));
        }
        part.extend(members);
    }
    parts.push(part);
    parts
}

/// Parts that hand the values that are still needed on, the first with what opens the function.
fn linked(opening: Vec<Statement>, parts: Vec<Vec<Step>>) -> Vec<Part> {
    let mut known: BTreeSet<String> = opening.iter().flat_map(Statement::defines).collect();
    let mut later: Vec<BTreeSet<String>> = vec![BTreeSet::new()];
    for part in parts.iter().skip(1).rev() {
        let mut needed = later.last().cloned().unwrap_or_default();
        needed.extend(part.iter().flat_map(|s| s.uses.iter().cloned()));
        later.push(needed);
    }
    let mut opening = Some(opening);
    let mut taken = Vec::new();
    let mut linked = Vec::new();
    for (part, needed) in parts.into_iter().zip(later.into_iter().rev()) {
        let mut statements = opening.take().unwrap_or_default();
        statements.extend(part.into_iter().map(|s| s.statement));
        known.extend(statements.iter().flat_map(Statement::defines));
        let handed: Vec<String> = needed.into_iter().filter(|name| known.contains(name)).collect();
        linked.push(Part { taken, statements, handed: handed.clone() });
        taken = handed;
    }
    linked
}
