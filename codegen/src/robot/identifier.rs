//! Names that become Rust.

/// Whether a name can be a Rust identifier; if not, why and what was expected.
pub(super) fn check_identifier(name: &str) -> Result<(), String> {
    let expected = "expected a letter, then letters, digits and _";
    let mut chars = name.chars();
    let starts = chars.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_');
    if !starts || !chars.all(|c| c.is_ascii_alphanumeric() || c == '_') || name.bytes().all(|b| b == b'_') {
        return Err(format!("is not a Rust identifier: {expected}"));
    }
    match syn::parse_str::<syn::Ident>(name) {
        Ok(_) if name != "gen" => Ok(()),
        _ => Err("is a keyword of Rust: choose another name".to_owned()),
    }
}
