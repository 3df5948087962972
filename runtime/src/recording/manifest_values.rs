//! Values of a manifest that serde has no form for.

use std::fmt;

use serde::de::{self, IntoDeserializer, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::unit::Unit;

fn finite<E: de::Error>(value: f64) -> Result<f64, E> {
    if value.is_finite() { Ok(value) } else { Err(E::custom(format!("{value} is not a finite number"))) }
}

/// A number that is finite, or nothing.
pub(super) fn number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    Option::<f64>::deserialize(deserializer)?.map(finite).transpose()
}

/// Numbers that are finite.
pub(super) fn numbers<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<f64>, D::Error> {
    Vec::<f64>::deserialize(deserializer)?.into_iter().map(finite).collect()
}

/// A character that can separate fields or be a decimal point.
pub(super) fn one_byte<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u8, D::Error> {
    let text = String::deserialize(deserializer)?;
    match (text.as_bytes(), text.as_str()) {
        ([b'\n' | b'\r' | b'"' | b'0'..=b'9' | b'-' | b'+'], _) => {}
        ([byte], _) if byte.is_ascii() => return Ok(*byte),
        (_, "tab" | "\\t") => return Ok(b'\t'),
        _ => {}
    }
    Err(de::Error::custom(format!(
        "`{text}`: one ASCII character is expected, as \",\" \";\" \"\\t\" or \" \""
    )))
}

/// One unit for all joints, or one each.
pub(super) fn one_or_many<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Unit>, D::Error> {
    struct Units;
    impl<'de> Visitor<'de> for Units {
        type Value = Vec<Unit>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a unit, or a list of units, one per joint")
        }

        fn visit_str<E: de::Error>(self, name: &str) -> Result<Self::Value, E> {
            Unit::deserialize(name.into_deserializer()).map(|u| vec![u])
        }

        fn visit_u64<E: de::Error>(self, value: u64) -> Result<Self::Value, E> {
            self.visit_str(&value.to_string())
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
            let mut units = Vec::new();
            while let Some(unit) = seq.next_element()? {
                units.push(unit);
            }
            Ok(units)
        }
    }
    deserializer.deserialize_any(Units)
}
