//! Reading the expressions of a table: numbers, pi, `q<j>`, constants, + - * / and parentheses.

use super::expression::Expression;

/// Longest expression that is read, in operators, names and numbers; bounds every recursion over an expression.
const MAX_TOKENS: usize = 200;

/// An expression that may have joint variables added to it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Formula {
    /// Joint variables: number j, sign, and position in the text.
    pub variables: Vec<(usize, i32, usize)>,
    /// Everything else; `None` where there is nothing else.
    pub constant: Option<Expression>,
}

/// What is wrong with an expression and where: characters from its start.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FormulaError {
    pub offset: usize,
    pub message: String,
}

/// Reads an expression. `constants` are the names that it may use.
pub(super) fn parse_formula(text: &str, constants: &[(String, f64)]) -> Result<Formula, FormulaError> {
    let tokens = tokenize(text)?;
    let mut parser = Parser { tokens: &tokens, next: 0, end: text.chars().count(), constants };
    let formula = parser.sum()?;
    match parser.tokens.get(parser.next) {
        None => {}
        Some((Token::Symbol(')'), offset)) => {
            return error(*offset, "')' without its '('");
        }
        Some((_, offset)) => return error(*offset, "expected an operator (+ - * /) before this"),
    }
    if let Some(constant) = &formula.constant {
        let value = constant.value();
        if !value.is_finite() {
            return error(0, format!("'{text}' is not finite ({value})"));
        }
    }
    Ok(formula)
}

fn error<T>(offset: usize, message: impl Into<String>) -> Result<T, FormulaError> {
    Err(FormulaError { offset, message: message.into() })
}

#[derive(Debug, Clone, PartialEq)]
enum Token {
    Number(f64),
    Name(String),
    Symbol(char),
}

fn tokenize(text: &str) -> Result<Vec<(Token, usize)>, FormulaError> {
    let chars: Vec<char> = text.chars().collect();
    let mut tokens = Vec::new();
    let mut at = 0;
    while at < chars.len() {
        let start = at;
        let c = chars[at];
        if c.is_whitespace() {
            at += 1;
            continue;
        }
        if tokens.len() == MAX_TOKENS {
            return error(start, format!("expression longer than {MAX_TOKENS} numbers, names and operators"));
        }
        let take = |at: &mut usize, keep: fn(char) -> bool| {
            while chars.get(*at).is_some_and(|&c| keep(c)) {
                *at += 1;
            }
        };
        let token = if c.is_ascii_digit() || c == '.' && chars.get(at + 1).is_some_and(char::is_ascii_digit) {
            take(&mut at, |c| c.is_ascii_digit() || c == '.');
            if matches!(chars.get(at), Some('e' | 'E')) {
                let sign = usize::from(matches!(chars.get(at + 1), Some('+' | '-')));
                if chars.get(at + 1 + sign).is_some_and(char::is_ascii_digit) {
                    at += 1 + sign;
                    take(&mut at, |c| c.is_ascii_digit());
                }
            }
            let word: String = chars[start..at].iter().collect();
            match word.parse::<f64>() {
                Ok(value) if value.is_finite() => Token::Number(value),
                Ok(_) => return error(start, format!("'{word}' is not a finite number")),
                Err(_) => return error(start, format!("'{word}' is not a number")),
            }
        } else if c.is_alphabetic() || c == '_' || c == '.' {
            take(&mut at, |c| c.is_alphanumeric() || c == '_' || c == '.');
            Token::Name(chars[start..at].iter().collect())
        } else if "+-*/()".contains(c) {
            at += 1;
            Token::Symbol(c)
        } else {
            return error(
                start,
                format!(
                    "'{c}' does not belong in an expression; it has numbers, pi, q<j>, constants, + - * / and parentheses"
                ),
            );
        };
        tokens.push((token, start));
    }
    Ok(tokens)
}

/// The j of `q<j>`.
pub(super) fn joint_variable(name: &str) -> Option<usize> {
    let digits = name.strip_prefix('q')?;
    if digits.is_empty() || digits.starts_with('0') || !digits.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    digits.parse().ok()
}

struct Parser<'a> {
    tokens: &'a [(Token, usize)],
    next: usize,
    end: usize,
    constants: &'a [(String, f64)],
}

impl Parser<'_> {
    fn offset(&self) -> usize {
        self.tokens.get(self.next).map_or(self.end, |&(_, offset)| offset)
    }

    /// Takes the next token if it is one of the symbols.
    fn accept(&mut self, symbols: &str) -> Option<char> {
        match self.tokens.get(self.next) {
            Some((Token::Symbol(c), _)) if symbols.contains(*c) => {
                self.next += 1;
                Some(*c)
            }
            _ => None,
        }
    }

    fn sum(&mut self) -> Result<Formula, FormulaError> {
        let mut left = self.product()?;
        while let Some(op) = self.accept("+-") {
            let mut right = self.product()?;
            if op == '-' {
                right.variables.iter_mut().for_each(|v| v.1 = -v.1);
            }
            left.variables.append(&mut right.variables);
            left.constant = match (left.constant, right.constant, op) {
                (a, None, _) => a,
                (None, b, '+') => b,
                (None, Some(b), _) => Some(negative(b)),
                (Some(a), Some(b), '+') => Some(Expression::Add(Box::new(a), Box::new(b))),
                (Some(a), Some(b), _) => Some(Expression::Sub(Box::new(a), Box::new(b))),
            };
        }
        Ok(left)
    }

    fn product(&mut self) -> Result<Formula, FormulaError> {
        let mut left = self.signed()?;
        while let Some(op) = self.accept("*/") {
            let at = self.offset();
            let right = self.signed()?;
            if let Some(&(j, _, offset)) = left.variables.iter().chain(&right.variables).next() {
                return error(offset, format!("q{j} may only be added: expected q{j} plus a constant"));
            }
            let a = Box::new(left.constant.unwrap_or(Expression::ZERO));
            let b = right.constant.unwrap_or(Expression::ZERO);
            left.constant = Some(if op == '*' {
                Expression::Mul(a, Box::new(b))
            } else if b.value() == 0.0 {
                return error(at, format!("division by zero: {b} is 0"));
            } else {
                Expression::Div(a, Box::new(b))
            });
        }
        Ok(left)
    }

    fn signed(&mut self) -> Result<Formula, FormulaError> {
        match self.accept("+-") {
            Some('-') => {
                let mut operand = self.signed()?;
                operand.variables.iter_mut().for_each(|v| v.1 = -v.1);
                operand.constant = operand.constant.map(negative);
                Ok(operand)
            }
            Some(_) => self.signed(),
            None => self.primary(),
        }
    }

    fn primary(&mut self) -> Result<Formula, FormulaError> {
        let offset = self.offset();
        let Some((token, _)) = self.tokens.get(self.next) else {
            return error(offset, "the expression ends where a number, a name or '(' was expected");
        };
        self.next += 1;
        let constant = match token {
            Token::Number(value) => Expression::Number(*value),
            Token::Name(name) if name == "pi" => Expression::Pi,
            Token::Name(name) => {
                if let Some(j) = joint_variable(name) {
                    return Ok(Formula { variables: vec![(j, 1, offset)], constant: None });
                }
                match self.constants.iter().find(|(known, _)| known == name) {
                    Some((_, value)) => Expression::Constant(name.clone(), *value),
                    None => return error(offset, self.unknown(name)),
                }
            }
            Token::Symbol('(') => {
                let inner = self.sum()?;
                if self.accept(")").is_none() {
                    return error(self.offset(), "expected ')'");
                }
                return Ok(inner);
            }
            Token::Symbol(_) => {
                return error(offset, "expected a number, a name or '(' before this operator");
            }
        };
        Ok(Formula { variables: Vec::new(), constant: Some(constant) })
    }

    fn unknown(&self, name: &str) -> String {
        let word = name.trim_start_matches('.').to_ascii_lowercase();
        if ["nan", "inf", "infinity"].contains(&word.as_str()) {
            return format!("'{name}' is not a finite number");
        }
        let known = self.constants.iter().map(|(known, _)| known.as_str()).chain(["pi"]);
        let names = known.collect::<Vec<_>>().join(", ");
        format!("unknown constant '{name}': expected a number, q<j> or one of {names}")
    }
}

fn negative(operand: Expression) -> Expression {
    match operand {
        Expression::Number(value) if value > 0.0 => Expression::Number(-value),
        other => Expression::Neg(Box::new(other)),
    }
}
