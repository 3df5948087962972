//! Words of a report.

/// The words with a capital letter first.
///
/// ```
/// assert_eq!(dynid_runtime::report::capital("the robot"), "The robot");
/// ```
pub fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters
        .next()
        .map_or_else(String::new, |first| first.to_uppercase().collect::<String>() + letters.as_str())
}
