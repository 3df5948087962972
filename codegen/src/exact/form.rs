//! Exact numbers that remember how they are written in symbols of the table.

use super::surd::{Surd, write_part};
use num_traits::{One, Signed};
use std::collections::BTreeMap;
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

/// A number with its expression: a sum of products of symbols. Two of them are equal where their values are.
#[derive(Debug, Clone, Default)]
pub struct Form {
    value: Surd,
    terms: BTreeMap<Monomial, Surd>,
}

impl Form {
    /// 0.
    pub fn zero() -> Form {
        Form::default()
    }

    /// 1.
    pub fn one() -> Form {
        Form::number(Surd::one())
    }

    /// A number without symbols.
    pub fn number(value: Surd) -> Form {
        let terms = if value.is_zero() { BTreeMap::new() } else { [(Vec::new(), value.clone())].into() };
        Form { value, terms }
    }

    /// A symbol and what it stands for.
    pub fn named(name: &str, value: Surd) -> Form {
        Form::symbol(Symbol::Named(name.into()), value)
    }

    /// Cosine and sine of an angle that is written `angle`.
    pub fn cos_sin(angle: &str, cos: Surd, sin: Surd) -> (Form, Form) {
        let angle: Arc<str> = angle.into();
        (Form::symbol(Symbol::Cos(angle.clone()), cos), Form::symbol(Symbol::Sin(angle), sin))
    }

    fn symbol(symbol: Symbol, value: Surd) -> Form {
        Form { value, terms: [(vec![(symbol, 1)], Surd::one())].into() }
    }

    /// The number.
    pub fn value(&self) -> &Surd {
        &self.value
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
        let mut sum = Form { value: &self.value + &other.value, terms: self.terms.clone() };
        for (monomial, coefficient) in &other.terms {
            sum.add_term(monomial.clone(), coefficient);
        }
        sum
    }

    /// Difference.
    pub fn minus(&self, other: &Form) -> Form {
        self.plus(&other.scaled(&Surd::integer(-1)))
    }

    /// Product with a number.
    pub fn scaled(&self, factor: &Surd) -> Form {
        if factor.is_zero() {
            return Form::zero();
        }
        let terms = self.terms.iter().map(|(monomial, c)| (monomial.clone(), c * factor)).collect();
        Form { value: &self.value * factor, terms }
    }

    /// Product.
    pub fn times(&self, other: &Form) -> Form {
        if self.is_zero() || other.is_zero() {
            return Form::zero();
        }
        let mut product = Form { value: &self.value * &other.value, terms: BTreeMap::new() };
        for (a, x) in &self.terms {
            for (b, y) in &other.terms {
                product.add_product(a, b, &(x * y));
            }
        }
        product
    }

    /// Quotient, in symbols where the divisor is one product; `None` for a division by 0.
    pub fn over(&self, divisor: &Form) -> Option<Form> {
        let value = &self.value * &divisor.value.inverse()?;
        let mut terms = divisor.terms.iter();
        match (terms.next(), terms.next()) {
            (Some((monomial, coefficient)), None) => {
                let below = monomial.iter().map(|(symbol, power)| (symbol.clone(), -power)).collect();
                let inverse =
                    Form { value: divisor.value.inverse()?, terms: [(below, coefficient.inverse()?)].into() };
                Some(self.times(&inverse))
            }
            _ => Some(Form::number(value)),
        }
    }

    fn add_term(&mut self, monomial: Monomial, coefficient: &Surd) {
        let slot = self.terms.entry(monomial).or_default();
        *slot = &*slot + coefficient;
        if slot.is_zero() {
            self.terms.retain(|_, c| !c.is_zero());
        }
    }

    /// Adds a product of two monomials, with sin^2 written as 1 - cos^2.
    fn add_product(&mut self, a: &Monomial, b: &Monomial, coefficient: &Surd) {
        let mut product: BTreeMap<&Symbol, i32> = BTreeMap::new();
        for (symbol, power) in a.iter().chain(b) {
            *product.entry(symbol).or_default() += power;
        }
        let monomial: Monomial = product
            .into_iter()
            .filter(|&(_, power)| power != 0)
            .map(|(symbol, power)| (symbol.clone(), power))
            .collect();
        let square =
            monomial.iter().position(|(symbol, power)| matches!(symbol, Symbol::Sin(_)) && *power >= 2);
        let Some(k) = square else { return self.add_term(monomial, coefficient) };
        let Symbol::Sin(angle) = &monomial[k].0 else { return };
        let cos_squared = vec![(Symbol::Cos(angle.clone()), 2)];
        let mut rest = monomial.clone();
        rest[k].1 -= 2;
        rest.retain(|&(_, power)| power != 0);
        self.add_product(&rest, &Vec::new(), coefficient);
        self.add_product(&rest, &cos_squared, &-coefficient);
    }

    /// `coefficient * what` for a sum: a sign, then the text without one. A coefficient that is a sum is bracketed.
    pub fn signed_product(&self, what: &str) -> (char, String) {
        // Symbols can cancel in value alone; then the number is all there is to say.
        let parts = Parts(self);
        let text = parts.to_string();
        let several = self.terms.values().map(|c| c.terms().len()).sum::<usize>() > 1;
        if several {
            return ('+', format!("({text})*{what}"));
        }
        let (sign, bare) = match text.strip_prefix('-') {
            Some(bare) => ('-', bare),
            None => ('+', text.as_str()),
        };
        (sign, if bare == "1" { what.to_owned() } else { format!("{bare}*{what}") })
    }
}

impl fmt::Display for Form {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Parts(self).fmt(f)
    }
}

struct Parts<'a>(&'a Form);

/// One product of the sum, without its sign.
struct Part<'a>(u8, num_rational::BigRational, &'a Monomial);

impl fmt::Display for Part<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Part(root, coefficient, monomial) = self;
        let unit = *root == 0 && coefficient.is_one();
        if !unit || monomial.is_empty() {
            write_part(f, *root, coefficient)?;
        }
        for (k, (symbol, power)) in monomial.iter().enumerate() {
            match (k > 0 || !unit, *power < 0) {
                (_, true) if k == 0 && unit => f.write_str("1/")?,
                (_, true) => f.write_str("/")?,
                (true, false) => f.write_str("*")?,
                (false, false) => {}
            }
            match symbol {
                Symbol::Named(name) => f.write_str(name)?,
                Symbol::Cos(angle) => write!(f, "cos({angle})")?,
                Symbol::Sin(angle) => write!(f, "sin({angle})")?,
            }
            if power.abs() != 1 {
                write!(f, "^{}", power.abs())?;
            }
        }
        Ok(())
    }
}

impl fmt::Display for Parts<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.terms.is_empty() {
            return f.write_str("0");
        }
        let mut first = true;
        for (monomial, coefficient) in self.0.terms.iter().rev() {
            for (root, a) in coefficient.terms() {
                let sign = match (first, a.is_negative()) {
                    (true, true) => "-",
                    (true, false) => "",
                    (false, true) => " - ",
                    (false, false) => " + ",
                };
                write!(f, "{sign}{}", Part(*root, a.abs(), monomial))?;
                first = false;
            }
        }
        Ok(())
    }
}
