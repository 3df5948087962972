//! Where a number is in a message: `wrench.force.x`, `actual.positions[0]`, `actual.positions[elbow]`.

/// An element of a list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Element {
    /// By its place, from 0.
    Place(usize),
    /// By the name at the same place in the list of names.
    Name(String),
}

/// A path to a number or a list of numbers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Path {
    /// Fields from the outside, each with the place of one in a list of messages.
    pub steps: Vec<(String, Option<usize>)>,
    /// Which of a list of numbers.
    pub element: Option<Element>,
}

impl Path {
    /// Reads a path; `None` where it is none.
    pub fn parse(text: &str) -> Option<Self> {
        let (fields, element) = match text.strip_suffix(']').and_then(|rest| rest.rsplit_once('[')) {
            None => (text, None),
            Some((fields, key)) => {
                let element = match key.parse() {
                    Ok(place) => Element::Place(place),
                    Err(_) if key.is_empty() => return None,
                    Err(_) => Element::Name(key.to_owned()),
                };
                (fields, Some(element))
            }
        };
        let step = |text: &str| match text.strip_suffix(']').and_then(|rest| rest.split_once('[')) {
            None => is_name(text).then(|| (text.to_owned(), None)),
            Some((name, place)) => Some((is_name(name).then(|| name.to_owned())?, Some(place.parse().ok()?))),
        };
        let steps: Option<Vec<_>> = fields.split('.').map(step).collect();
        Some(Self { steps: steps?, element })
    }
}

fn is_name(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|c| c.is_alphanumeric() || c == '_')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_fields_and_an_element() {
        let steps = |names: &[(&str, Option<usize>)]| -> Vec<(String, Option<usize>)> {
            names.iter().map(|(name, place)| ((*name).to_owned(), *place)).collect()
        };
        let path = Path::parse("points[1].positions[left.elbow]").expect("a path");
        assert_eq!(path.steps, steps(&[("points", Some(1)), ("positions", None)]));
        assert_eq!(path.element, Some(Element::Name("left.elbow".into())));
        assert_eq!(Path::parse("a.b[2]").expect("a path").element, Some(Element::Place(2)));
        assert_eq!(Path::parse("wrench.force.x").expect("a path").element, None);
        for none in ["", "a..b", "a[]", "[1]", "a[x].b", "a b"] {
            assert_eq!(Path::parse(none), None, "{none}");
        }
    }
}
