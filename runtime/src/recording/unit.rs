//! Units of recorded channels.

use serde::{Deserialize, Deserializer, de};

/// What a unit measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// rad.
    Angle,
    /// m.
    Length,
    /// rad/s.
    AngularVelocity,
    /// m/s.
    LinearVelocity,
    /// N.m.
    Torque,
    /// N.
    Force,
    /// s.
    Time,
    /// A drive's own unit (A, V, %, counts): SI only through a gain.
    Raw,
}

/// A unit by its name, with the factor to SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// As written.
    pub name: String,
    /// What it measures.
    pub quantity: Quantity,
    /// SI value of one unit; 1 for raw units.
    pub factor: f64,
}

const DEG: f64 = std::f64::consts::PI / 180.0;
const TURN: f64 = 2.0 * std::f64::consts::PI;

const UNITS: &[(&[&str], Quantity, f64)] = &[
    (&["rad"], Quantity::Angle, 1.0),
    (&["mrad"], Quantity::Angle, 1e-3),
    (&["deg", "°"], Quantity::Angle, DEG),
    (&["rev", "turn"], Quantity::Angle, TURN),
    (&["m"], Quantity::Length, 1.0),
    (&["mm"], Quantity::Length, 1e-3),
    (&["um", "µm"], Quantity::Length, 1e-6),
    (&["rad/s"], Quantity::AngularVelocity, 1.0),
    (&["deg/s", "°/s"], Quantity::AngularVelocity, DEG),
    (&["rev/s", "turn/s"], Quantity::AngularVelocity, TURN),
    (&["rpm", "rev/min"], Quantity::AngularVelocity, TURN / 60.0),
    (&["m/s"], Quantity::LinearVelocity, 1.0),
    (&["mm/s"], Quantity::LinearVelocity, 1e-3),
    (&["m/min"], Quantity::LinearVelocity, 1.0 / 60.0),
    (&["N.m", "Nm", "N*m", "N·m"], Quantity::Torque, 1.0),
    (&["mN.m", "mNm", "N.mm", "Nmm"], Quantity::Torque, 1e-3),
    (&["N.cm", "Ncm"], Quantity::Torque, 1e-2),
    (&["kN.m", "kNm"], Quantity::Torque, 1e3),
    (&["N"], Quantity::Force, 1.0),
    (&["mN"], Quantity::Force, 1e-3),
    (&["kN"], Quantity::Force, 1e3),
    (&["s"], Quantity::Time, 1.0),
    (&["ms"], Quantity::Time, 1e-3),
    (&["us", "µs"], Quantity::Time, 1e-6),
    (&["ns"], Quantity::Time, 1e-9),
    (&["min"], Quantity::Time, 60.0),
    (&["A", "mA", "V", "%", "count", "1"], Quantity::Raw, 1.0),
];

impl Unit {
    /// The second.
    pub(super) fn second() -> Self {
        Self { name: "s".into(), quantity: Quantity::Time, factor: 1.0 }
    }

    /// The unit of that name.
    pub fn named(name: &str) -> Option<Self> {
        let (_, quantity, factor) = UNITS.iter().find(|(names, ..)| names.contains(&name))?;
        Some(Self { name: name.into(), quantity: *quantity, factor: *factor })
    }

    /// The names that measure one of `quantities`, for a message.
    pub fn names_of(quantities: &[Quantity]) -> String {
        let names =
            UNITS.iter().filter(|(_, q, _)| quantities.contains(q)).map(|(names, ..)| match q_raw(names) {
                true => names.join(", "),
                false => names[0].to_string(),
            });
        names.collect::<Vec<_>>().join(", ")
    }
}

/// Raw units are listed one by one, the spellings of others by the first.
fn q_raw(names: &[&str]) -> bool {
    names[0] == "A"
}

impl<'de> Deserialize<'de> for Unit {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        Self::named(&name).ok_or_else(|| {
            let all = UNITS.iter().flat_map(|(names, ..)| names.iter().copied().filter(|n| n.is_ascii()));
            let known: Vec<&str> = all.collect();
            de::Error::custom(format!("unknown unit `{name}`, expected one of {}", known.join(" ")))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_lead_to_si() {
        let si = |name: &str| Unit::named(name).map(|u| u.factor);
        assert_eq!(si("rad"), Some(1.0));
        assert_eq!(si("mm"), Some(1e-3));
        assert!(si("deg").is_some_and(|f| (f * 180.0 - std::f64::consts::PI).abs() < 1e-15));
        assert!(si("rpm").is_some_and(|f| (f * 30.0 - std::f64::consts::PI).abs() < 1e-15));
        assert_eq!(si("kN.m"), Some(1e3));
        assert_eq!(si("furlong"), None);
    }

    #[test]
    fn no_name_stands_for_two_units() {
        let mut names: Vec<&str> = UNITS.iter().flat_map(|(names, ..)| names.iter().copied()).collect();
        names.sort_unstable();
        let all = names.len();
        names.dedup();
        assert_eq!(names.len(), all);
    }
}
