//! A law of the user beside those of the catalogue.

use super::catalogue::EffectKind;
use super::user_law::{LawError, UserLaw};
use std::collections::BTreeMap;

impl UserLaw {
    /// A law of a joint (0-based) from its text and the ranges of its shapes.
    ///
    /// # Errors
    /// An id that is none or one of the catalogue; a text that is no law, or in which a constant that is not declared as
    /// a shape does not stand before a term; a range without an end, or of what is not in the law.
    pub fn new(
        id: &str,
        joint: usize,
        text: &str,
        shapes: &BTreeMap<String, [f64; 2]>,
    ) -> Result<Self, LawError> {
        if EffectKind::from_id(id).is_some() || id == EffectKind::UserLaw.id() {
            let message = format!("'{id}' is an effect of the catalogue; choose another name");
            return Err(LawError { field: "id", offset: 0, message });
        }
        Self::under_any_name(id, joint, text, shapes)
    }
}
