//! Names that were meant, where one that was written is not there.

/// Names listed in a message before the rest is left out.
const LISTED: usize = 40;
/// Similarity (Jaro and Winkler, 0 to 1) from which a name is offered for another one.
const SIMILAR: f64 = 0.75;

/// The name most like `wanted`, where one is like it.
pub fn nearest<'a>(wanted: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let lower = wanted.to_lowercase();
    let scored = names.into_iter().map(|name| (strsim::jaro_winkler(&lower, &name.to_lowercase()), name));
    // The first of those that are equally near, so that the answer does not depend on chance.
    let best = scored.fold(None, |best: Option<(f64, &str)>, next| match best {
        Some(best) if best.0 >= next.0 => Some(best),
        _ => Some(next),
    });
    best.filter(|(score, _)| *score >= SIMILAR).map(|(_, name)| name)
}

/// " (did you mean `...`?)" with the name most like `wanted`, or nothing.
pub fn meant<'a>(wanted: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    nearest(wanted, names).map_or_else(String::new, offered)
}

/// A name that is offered for another one.
pub(super) fn offered(name: &str) -> String {
    format!(" (did you mean `{name}`?)")
}

/// Names one after another, the first forty, each at most forty characters.
pub(super) fn listed<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let shown = |name: &str| name.chars().filter(|c| !c.is_control()).take(LISTED).collect::<String>();
    let mut names = names.into_iter();
    let mut all: Vec<String> = names.by_ref().take(LISTED).map(shown).collect();
    if names.next().is_some() {
        all.push("...".into());
    }
    all.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_is_offered_and_nothing_where_none_is_near() {
        let joints = ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint"];
        assert_eq!(nearest("shoulder_pan", joints), Some("shoulder_pan_joint"));
        assert_eq!(nearest("Elbow_Joint", joints), Some("elbow_joint"));
        assert_eq!(nearest("q1", joints), None);
        assert_eq!(nearest("q1", []), None);
        assert_eq!(meant("elbow_jiont", joints), " (did you mean `elbow_joint`?)");
    }

    #[test]
    fn long_lists_are_cut() {
        let names: Vec<String> = (0..60).map(|k| format!("c{k}")).collect();
        let text = listed(names.iter().map(String::as_str));
        assert!(text.ends_with("c39, ..."), "{text}");
        assert_eq!(listed(["a\n", "b"]), "a, b");
    }
}
