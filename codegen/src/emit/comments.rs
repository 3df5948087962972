//! Comments in generated code, which tokens cannot carry.

use proc_macro2::TokenStream;
use quote::quote;

/// A statement that [`restore`] turns into a comment once the code is formatted.
pub fn comment(text: &str) -> TokenStream {
    quote!(comment!(#text);)
}

/// Formatted code with its comments.
pub fn restore(formatted: &str) -> String {
    let mut text = String::with_capacity(formatted.len());
    for line in formatted.lines() {
        let content = line.trim_start();
        let quoted = content.strip_prefix("comment!(\"").and_then(|rest| rest.strip_suffix("\");"));
        if let Some(quoted) = quoted {
            let indentation = &line[..line.len() - content.len()];
            text.push_str(indentation);
            text.push_str("// ");
            text.push_str(quoted);
        } else {
            text.push_str(line);
        }
        text.push('\n');
    }
    text
}
