//! A law in a model file: what it was made from, and every field of it checked when it is read.

use super::{Definition, UserLaw};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use std::collections::BTreeMap;

/// A law as it is saved.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Saved {
    id: String,
    joint: usize,
    law: String,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    shapes: BTreeMap<String, [f64; 2]>,
}

impl Serialize for UserLaw {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Definition { id, joint, text, shapes, .. } = self.0;
        let shapes = shapes.iter().map(|r| (r.name.clone(), [r.low, r.high])).collect();
        Saved { id: id.clone(), joint: *joint, law: text.clone(), shapes }.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for UserLaw {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let Saved { id, joint, law, shapes } = Saved::deserialize(deserializer)?;
        Self::new(&id, joint, &law, &shapes)
            .map_err(|e| de::Error::custom(format!("the law '{id}' of a user: {e}")))
    }
}
