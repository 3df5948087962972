//! What stands above exported code: which robot it is of, what evaluating it costs, what it leaves out.

use super::Export;
use crate::emit::table_lines;

/// Lines of a comment.
pub fn lines(export: &Export<'_>) -> Vec<String> {
    let mut lines = table_lines(&export.table, &export.set, &export.equations);
    let Some(known) = export.known else { return lines };
    lines.push(String::new());
    lines.push("Torques of the identified model: its base parameters and".to_owned());
    lines.extend(known.bodies.iter().map(|body| format!("- in these: {}", body.title)));
    if known.laws.is_empty() && known.bodies.is_empty() {
        lines.push("- nothing beside them.".to_owned());
    }
    lines.extend(known.laws.iter().map(|law| format!("- {}: {}", law.title, law.text)));
    if !known.left_out.is_empty() {
        lines.push(String::new());
        lines.push("Of the model, not in this code:".to_owned());
        lines.extend(known.left_out.iter().map(|what| format!("- {what}")));
    }
    lines
}
