//! Exact numbers that remember how they are written in symbols of the table.

use super::number::Number;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fmt;
use std::sync::Arc;

/// A symbol of the table.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
enum Symbol {
    /// A constant, or pi.
    Named(Arc<str>),
    /// Cosine of an angle.
    Cos(Arc<str>),
    /// Sine of an angle.
    Sin(Arc<str>),
}

/// Symbols with their powers, ascending symbol, no power 0.
type Monomial = Vec<(Symbol, i32)>;

/// Longest sum that is kept in symbols; a longer one says less than its value does.
const MAX_TERMS: usize = 24;

/// A number with its expression: a sum of products of symbols.
#[derive(Debug, Clone, Default)]
pub struct Form {
    value: Number,
    terms: BTreeMap<Monomial, Number>,
}

impl Form {
    /// 0.
    pub fn zero() -> Form {
        Form::default()
    }

    /// 1.
    pub fn one() -> Form {
        Form::number(Number::ONE)
    }

    /// A number without symbols.
    pub fn number(value: Number) -> Form {
        let terms = if value.is_zero() { BTreeMap::new() } else { [(Vec::new(), value)].into() };
        Form { value, terms }
    }

    /// A symbol and what it stands for.
    pub fn named(name: &str, value: Number) -> Form {
        Form::symbol(Symbol::Named(name.into()), value)
    }

    /// Cosine and sine of an angle that is written `angle`.
    pub fn cos_sin(angle: &str, cos: Number, sin: Number) -> (Form, Form) {
        let angle: Arc<str> = angle.into();
        (Form::symbol(Symbol::Cos(angle.clone()), cos), Form::symbol(Symbol::Sin(angle), sin))
    }

    fn symbol(symbol: Symbol, value: Number) -> Form {
        Form { value, terms: [(vec![(symbol, 1)], Number::ONE)].into() }
    }

    /// The number.
    pub fn value(&self) -> Number {
        self.value
    }

    /// Whether the number is 0, however it is written.
    pub fn is_zero(&self) -> bool {
        self.value.is_zero()
    }

    /// Sum.
    pub fn plus(&self, other: &Form) -> Form {
        if other.is_zero() {
            return self.clone();
        }
        if self.is_zero() {
            return other.clone();
        }
        let mut sum = Form { value: self.value + other.value, terms: self.terms.clone() };
        for (monomial, coefficient) in &other.terms {
            sum.add_term(monomial.clone(), *coefficient);
        }
        sum.bounded()
    }

    /// Difference.
    pub fn minus(&self, other: &Form) -> Form {
        self.plus(&other.scaled(-Number::ONE))
    }

    /// Product with a number.
    pub fn scaled(&self, factor: Number) -> Form {
        if factor.is_zero() {
            return Form::zero();
        }
        let terms = self.terms.iter().map(|(monomial, c)| (monomial.clone(), *c * factor)).collect();
        Form { value: self.value * factor, terms }
    }

    /// Product.
    pub fn times(&self, other: &Form) -> Form {
        if self.is_zero() || other.is_zero() {
            return Form::zero();
        }
        let mut product = Form { value: self.value * other.value, terms: BTreeMap::new() };
        for (a, x) in &self.terms {
            for (b, y) in &other.terms {
                product.add_product(a, b, *x * *y);
            }
        }
        product.bounded()
    }

    /// Quotient, in symbols where the divisor is one product; `None` for a division by 0.
    pub fn over(&self, divisor: &Form) -> Option<Form> {
        let inverse_value = divisor.value.inverse()?;
        let mut terms = divisor.terms.iter();
        match (terms.next(), terms.next()) {
            (Some((monomial, coefficient)), None) => {
                let below = monomial.iter().map(|(symbol, power)| (symbol.clone(), -power)).collect();
                let inverse = Form { value: inverse_value, terms: [(below, coefficient.inverse()?)].into() };
                Some(self.times(&inverse))
            }
            _ => Some(Form::number(self.value * inverse_value)),
        }
    }

    fn bounded(self) -> Form {
        if self.terms.len() > MAX_TERMS { Form::number(self.value) } else { self }
    }

    fn add_term(&mut self, monomial: Monomial, coefficient: Number) {
        match self.terms.entry(monomial) {
            Entry::Vacant(slot) => _ = slot.insert(coefficient),
            Entry::Occupied(mut slot) => {
                let sum = *slot.get() + coefficient;
                if sum.is_zero() {
                    slot.remove();
                } else {
                    slot.insert(sum);
                }
            }
        }
    }

    /// Adds a product of two monomials, with cos^2 written as 1 - sin^2.
    fn add_product(&mut self, a: &[(Symbol, i32)], b: &[(Symbol, i32)], coefficient: Number) {
        let mut product: BTreeMap<&Symbol, i32> = BTreeMap::new();
        for (symbol, power) in a.iter().chain(b) {
            *product.entry(symbol).or_default() += power;
        }
        let mut monomial: Monomial =
            product.into_iter().map(|(symbol, power)| (symbol.clone(), power)).collect();
        monomial.retain(|&(_, power)| power != 0);
        let square = monomial.iter_mut().find_map(|(symbol, power)| match symbol {
            Symbol::Cos(angle) if *power >= 2 => {
                *power -= 2;
                Some(Symbol::Sin(angle.clone()))
            }
            _ => None,
        });
        match square {
            None => self.add_term(monomial, coefficient),
            Some(sine) => {
                self.add_product(&monomial, &[], coefficient);
                self.add_product(&monomial, &[(sine, 2)], -coefficient);
            }
        }
    }

    /// As a factor of a product in a sum: its sign, and the text without it, which is empty for 1. A sum is bracketed.
    pub fn signed_factor(&self) -> (char, String) {
        let text = self.to_string();
        if with_cosines(&self.terms).len() > 1 {
            return ('+', format!("({text})"));
        }
        let (sign, rest) = match text.strip_prefix('-') {
            Some(rest) => ('-', rest),
            None => ('+', text.as_str()),
        };
        (sign, if rest == "1" { String::new() } else { rest.to_owned() })
    }
}

/// `d3^2 + 2*rl3*sin(alpha)`.
impl fmt::Display for Form {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.terms.is_empty() {
            return f.write_str("0");
        }
        for (k, (monomial, coefficient)) in with_cosines(&self.terms).iter().rev().enumerate() {
            let text = written(monomial, *coefficient);
            match (k, text.strip_prefix('-')) {
                (0, _) => f.write_str(&text)?,
                (_, Some(rest)) => write!(f, " - {rest}")?,
                (_, None) => write!(f, " + {text}")?,
            }
        }
        Ok(())
    }
}

/// The sum with every x - x sin^2 in it as x cos^2.
fn with_cosines(terms: &BTreeMap<Monomial, Number>) -> BTreeMap<Monomial, Number> {
    let mut terms = terms.clone();
    let pair = |terms: &BTreeMap<Monomial, Number>| {
        terms.iter().find_map(|(monomial, &coefficient)| {
            monomial.iter().enumerate().find_map(|(k, (symbol, power))| {
                let Symbol::Sin(angle) = symbol else { return None };
                let mut rest = monomial.clone();
                rest[k].1 -= 2;
                rest.retain(|(_, power)| *power != 0);
                let opposite = *power >= 2 && terms.get(&rest) == Some(&-coefficient);
                let mut cosine = rest.clone();
                cosine.push((Symbol::Cos(angle.clone()), 2));
                cosine.sort();
                opposite.then(|| (monomial.clone(), rest, cosine))
            })
        })
    };
    while let Some((sine, rest, cosine)) = pair(&terms) {
        terms.remove(&sine);
        if let Some(coefficient) = terms.remove(&rest) {
            terms.insert(cosine, coefficient);
        }
    }
    terms
}

/// One product of the sum.
fn written(monomial: &Monomial, coefficient: Number) -> String {
    let one = |(symbol, power): &(Symbol, i32)| {
        let text = match symbol {
            Symbol::Named(name) => name.to_string(),
            Symbol::Cos(angle) => format!("cos({angle})"),
            Symbol::Sin(angle) => format!("sin({angle})"),
        };
        if power.abs() == 1 { text } else { format!("{text}^{}", power.abs()) }
    };
    let above: Vec<String> = monomial.iter().filter(|(_, power)| *power > 0).map(one).collect();
    let below: String =
        monomial.iter().filter(|(_, power)| *power < 0).map(|p| format!("/{}", one(p))).collect();
    let number = coefficient.to_string();
    let factors = match (number.as_str(), above.is_empty()) {
        (_, true) => number,
        ("1", _) => above.join("*"),
        ("-1", _) => format!("-{}", above.join("*")),
        _ => format!("{number}*{}", above.join("*")),
    };
    factors + &below
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::decimal;

    fn symbol(name: &str, value: f64) -> Form {
        Form::named(name, decimal(value).into())
    }

    #[test]
    fn sums_of_products_read_as_they_are_written_in_a_table() {
        let (d, r) = (symbol("d3", 0.5), symbol("rl3", -0.25));
        let square = d.plus(&r).times(&d.plus(&r));
        assert_eq!(square.to_string(), "rl3^2 + d3^2 + 2*d3*rl3");
        assert_eq!(square.value().real(), 0.0625);
        assert_eq!(d.minus(&r.times(&d)).to_string(), "-d3*rl3 + d3");
        assert_eq!(d.over(&r.times(&r)).map(|f| f.to_string()), Some("d3/rl3^2".to_owned()));
        assert_eq!(d.minus(&d).to_string(), "0");
    }

    #[test]
    fn squares_of_sine_and_cosine_are_written_the_short_way() {
        let (cos, sin) = Form::cos_sin("lean", decimal(0.6).into(), decimal(0.8).into());
        assert_eq!(Form::one().minus(&cos.times(&cos)).to_string(), "sin(lean)^2");
        assert_eq!(cos.times(&cos).plus(&sin.times(&sin)).to_string(), "1");
        assert_eq!(cos.times(&cos).times(&sin).to_string(), "cos(lean)^2*sin(lean)");
    }

    #[test]
    fn a_difference_of_different_symbols_with_one_value_is_zero() {
        let difference = symbol("d3", 0.225).minus(&symbol("rl4", 0.225));
        assert!(difference.is_zero());
    }

    #[test]
    fn factors_carry_their_sign_before_what_they_multiply() {
        let d = symbol("d3", 0.5);
        assert_eq!(Form::one().signed_factor(), ('+', String::new()));
        assert_eq!(d.scaled(Number::from(-2)).signed_factor(), ('-', "2*d3".to_owned()));
        assert_eq!(d.plus(&Form::one()).signed_factor(), ('+', "(d3 + 1)".to_owned()));
    }
}
