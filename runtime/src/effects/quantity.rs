//! Quantities of an effect that a person knows, and how they are written.

use serde::{Deserialize, Serialize};

/// A quantity with its standard deviation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its value, SI.
    pub value: f64,
    /// Standard deviation; 0 where it is not known.
    pub sigma: f64,
    /// SI unit.
    pub unit: String,
}

impl Parameter {
    /// A quantity.
    pub fn new(name: &str, value: f64, sigma: f64, unit: &str) -> Self {
        Self { name: name.into(), value, sigma, unit: unit.into() }
    }
}

/// The quantities of one finding, to be put into its sentence and its formula.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Quantities {
    list: Vec<Parameter>,
    /// Whether names stand for values.
    by_name: bool,
}

impl Quantities {
    /// From a list.
    pub fn new(list: Vec<Parameter>) -> Self {
        Self { list, by_name: false }
    }

    /// The same quantities written by their names, as for the formula of a law without numbers.
    #[must_use]
    pub fn by_name(self) -> Self {
        Self { by_name: true, ..self }
    }

    /// Their names.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.list.iter().map(|p| p.name.as_str())
    }

    /// Whether there is one with this name.
    pub fn has(&self, name: &str) -> bool {
        self.get(name).is_some()
    }

    /// The value, where there is one with this name.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.get(name).map(|p| p.value)
    }

    /// All of them by name: `k1 = 0.31 ± 0.02 N.m, k2 = ...`.
    pub fn all(&self) -> String {
        let each: Vec<String> =
            self.list.iter().map(|p| format!("{} = {}", p.name, self.text(&p.name))).collect();
        each.join(", ")
    }

    /// Value and unit: `0.31 N.m`; empty where there is none.
    pub fn value(&self, name: &str) -> String {
        self.get(name).map_or_else(String::new, |p| match self.by_name {
            true => p.name.clone(),
            false => format!("{}{}", short(p.value), unit_behind(&p.unit)),
        })
    }

    /// What is added, with its sign before it: `+ 0.31 rad`, `- 0.31 rad`.
    pub fn added(&self, name: &str) -> String {
        match self.get(name) {
            Some(p) if p.value < 0.0 && !self.by_name => {
                format!("- {}{}", short(-p.value), unit_behind(&p.unit))
            }
            _ => format!("+ {}", self.value(name)),
        }
    }

    /// Value, standard deviation where it is known and smaller than the value, and unit: `0.31 ± 0.02 N.m`; empty
    /// where there is none.
    pub fn text(&self, name: &str) -> String {
        self.get(name).map_or_else(String::new, |p| {
            if p.sigma > 0.0 && p.sigma < p.value.abs() {
                format!("{} ± {}{}", short(p.value), short(p.sigma), unit_behind(&p.unit))
            } else {
                format!("{}{}", short(p.value), unit_behind(&p.unit))
            }
        })
    }

    fn get(&self, name: &str) -> Option<&Parameter> {
        self.list.iter().find(|p| p.name == name)
    }
}

/// A unit behind its number: nothing for a number without one, which is written `1` in data.
///
/// ```
/// use dynid_runtime::effects::unit_behind;
/// assert_eq!(format!("0.31{}, 4{}", unit_behind("N.m"), unit_behind("1")), "0.31 N.m, 4");
/// ```
pub fn unit_behind(unit: &str) -> String {
    if unit == "1" { String::new() } else { format!(" {unit}") }
}

/// A number with three significant digits.
fn short(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    let digits = (2 - x.abs().log10().floor() as i32).clamp(0, 9) as usize;
    format!("{x:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_deviation_is_written_only_where_it_says_something() {
        let q = Quantities::new(vec![
            Parameter::new("known", 0.3123, 0.0214, "N.m"),
            Parameter::new("vague", 0.3123, 2.0, "1"),
        ]);
        assert_eq!(q.text("known"), "0.312 ± 0.0214 N.m");
        assert_eq!(q.value("known"), "0.312 N.m");
        assert_eq!(q.text("vague"), "0.312");
        assert_eq!(q.text("missing"), "");
        assert_eq!(q.clone().by_name().value("known"), "known");
        assert!(q.has("vague") && !q.has("missing"));
    }
}
