//! From the text of an expression to numbers, names and symbols.

use super::error::{FormulaError, error};

/// Longest expression that is read, in operators, names and numbers; bounds every recursion over an expression.
const MAX_TOKENS: usize = 200;

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Token {
    Number(f64),
    Name(String),
    Symbol(char),
}

/// The tokens, each with its place in characters. `operators` are the symbols beside parentheses; `parts` is what an
/// expression has, for messages.
pub(super) fn tokenize(
    text: &str,
    operators: &str,
    parts: &str,
) -> Result<Vec<(Token, usize)>, FormulaError> {
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
        let token = if c.is_ascii_digit() || c == '.' && chars.get(at + 1).is_some_and(char::is_ascii_digit) {
            number(&chars, &mut at)?
        } else if c.is_alphabetic() || c == '_' || c == '.' {
            take(&chars, &mut at, |c| c.is_alphanumeric() || c == '_' || c == '.');
            Token::Name(chars[start..at].iter().collect())
        } else if operators.contains(c) || "()".contains(c) {
            at += 1;
            Token::Symbol(c)
        } else {
            return error(start, format!("'{c}' does not belong in an expression; it has {parts}"));
        };
        tokens.push((token, start));
    }
    Ok(tokens)
}

fn take(chars: &[char], at: &mut usize, keep: fn(char) -> bool) {
    while chars.get(*at).is_some_and(|&c| keep(c)) {
        *at += 1;
    }
}

fn number(chars: &[char], at: &mut usize) -> Result<Token, FormulaError> {
    let start = *at;
    take(chars, at, |c| c.is_ascii_digit() || c == '.');
    if matches!(chars.get(*at), Some('e' | 'E')) {
        let sign = usize::from(matches!(chars.get(*at + 1), Some('+' | '-')));
        if chars.get(*at + 1 + sign).is_some_and(char::is_ascii_digit) {
            *at += 1 + sign;
            take(chars, at, |c| c.is_ascii_digit());
        }
    }
    let word: String = chars[start..*at].iter().collect();
    match word.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(Token::Number(value)),
        Ok(_) => error(start, format!("'{word}' is not a finite number")),
        Err(_) => error(start, format!("'{word}' is not a number")),
    }
}
