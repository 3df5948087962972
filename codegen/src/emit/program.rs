//! Expressions as formulas of statements: what gets a name, what is written in place, and with which sign.

use super::statement::Formula;
use crate::symbolic::{Angle, Expr, Graph, Node, Symbol};
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
    pub fn symbol(&self, symbol: Symbol) -> String {
        match symbol {
            Symbol::Position(k) => format!("q{}", self.joints[k]),
            Symbol::Velocity(k) => format!("dq{}", self.joints[k]),
            Symbol::Acceleration(k) => format!("ddq{}", self.joints[k]),
            Symbol::Parameter(k) => self.parameters[k].clone(),
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

/// Names for the values of one function.
pub struct Program<'a> {
    graph: &'a Graph,
    inputs: &'a InputNames,
    uses: Vec<usize>,
    variables: Vec<Option<String>>,
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
            variables[node] = Some(name);
        }
        Program { graph, inputs, uses, variables, angle_names }
    }

    /// The variable that holds a node, unless it is written in place.
    pub fn variable(&self, node: usize) -> Option<&str> {
        self.variables[node].as_deref()
    }

    /// The variables of sine and cosine of an angle.
    pub fn sine_cosine(&self, angle: usize) -> (String, String) {
        let name = &self.angle_names[angle];
        (format!("s{name}"), format!("c{name}"))
    }

    /// The angle itself, from the joint variables.
    pub fn angle(&self, angle: usize) -> Formula {
        let angle = &self.graph.angles()[angle];
        let mut total: Option<Formula> = None;
        for &(joint, k) in &angle.terms {
            let q = Formula::Variable(self.inputs.symbol(Symbol::Position(joint)));
            let term = match k.abs() {
                1 => q,
                k => product(Formula::Constant(f64::from(k)), q),
            };
            total = Some(match total {
                None if k < 0 => Formula::Minus(Box::new(term)),
                None => term,
                Some(total) => added(total, term, k < 0),
            });
        }
        let rest = angle.constant.rest;
        match total {
            None => Formula::Constant(rest),
            Some(total) if rest == 0.0 => total,
            Some(total) => added(total, Formula::Constant(rest.abs()), rest < 0.0),
        }
    }

    /// The value of a node that has a variable, as the right side of its `let`.
    pub fn definition(&self, node: usize) -> Formula {
        self.operation(Expr::new(node, false))
    }

    /// The value of an output, or of an operand.
    pub fn value(&self, e: Expr) -> Formula {
        if let Some(value) = self.graph.constant_value(e) {
            return Formula::Constant(value);
        }
        let held = match self.graph.node(e.node()) {
            Node::Symbol(symbol) => Some(self.inputs.symbol(symbol)),
            Node::Sine(angle) => Some(self.sine_cosine(angle).0),
            Node::Cosine(angle) => Some(self.sine_cosine(angle).1),
            _ => self.variables[e.node()].clone(),
        };
        match held.map(Formula::Variable) {
            Some(variable) if e.is_negative() => Formula::Minus(Box::new(variable)),
            Some(variable) => variable,
            None => self.operation(e),
        }
    }

    fn operation(&self, e: Expr) -> Formula {
        match self.graph.node(e.node()) {
            Node::Sum(..) => self.sum(e),
            Node::Product(a, b) => {
                let left = match self.graph.constant_value(a) {
                    Some(value) if e.is_negative() => Formula::Constant(-value),
                    _ if e.is_negative() => Formula::Minus(Box::new(self.value(a))),
                    _ => self.value(a),
                };
                product(left, self.value(b))
            }
            Node::Sign(a) => {
                let sign = Formula::Sign(Box::new(self.value(a)));
                if e.is_negative() { Formula::Minus(Box::new(sign)) } else { sign }
            }
            Node::InverseRoot(a) => {
                let root = Formula::InverseRoot(Box::new(self.value(a)));
                if e.is_negative() { Formula::Minus(Box::new(root)) } else { root }
            }
            _ => self.value(e),
        }
    }

    /// A sum with all sums that are used nowhere else written into it, products accumulated.
    fn sum(&self, e: Expr) -> Formula {
        let mut terms = Vec::new();
        self.collect_terms(e, true, &mut terms);
        let is_product = |e: &Expr| {
            self.variables[e.node()].is_none() && matches!(self.graph.node(e.node()), Node::Product(..))
        };
        // Start from a plain positive term, else from a positive product, so that no sign costs anything.
        let start = terms
            .iter()
            .position(|t| !t.is_negative() && !is_product(t))
            .or_else(|| terms.iter().position(|t| !t.is_negative()))
            .unwrap_or(0);
        let first = terms.remove(start);
        let mut total = self.value(first);
        terms.sort_by_key(|t| !is_product(t));
        for term in terms {
            total = match self.graph.node(term.node()) {
                Node::Product(a, b) if is_product(&term) => Formula::Accumulated {
                    total: Box::new(total),
                    factors: Box::new([self.value(a), self.value(b)]),
                    subtracted: term.is_negative(),
                },
                _ => added(total, self.value(term.magnitude()), term.is_negative()),
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

fn product(a: Formula, b: Formula) -> Formula {
    Formula::Product(Box::new(a), Box::new(b))
}

fn added(total: Formula, term: Formula, subtracted: bool) -> Formula {
    let (total, term) = (Box::new(total), Box::new(term));
    if subtracted { Formula::Difference(total, term) } else { Formula::Sum(total, term) }
}
