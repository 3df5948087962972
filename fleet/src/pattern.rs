//! Paths with `{robot}` and `{day}` in them.

/// What stands in one part of a path.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Piece {
    Text(String),
    Robot,
    Day,
    Anything,
}

/// What a path says of its recording, as far as it was read.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Found {
    /// `{robot}`
    pub robot: Option<String>,
    /// `{day}`
    pub day: Option<String>,
}

/// A path pattern, part by part: `logs/{robot}/{day}/recording.yaml`. A `*` stands for anything within a part.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern(Vec<Vec<Piece>>);

impl Pattern {
    /// Whether a text is one: it names a robot or a day.
    pub fn is_pattern(text: &str) -> bool {
        text.contains("{robot}") || text.contains("{day}")
    }

    /// Reads a pattern.
    ///
    /// # Errors
    /// What is wrong, and the place of it, characters from the beginning.
    pub fn parse(text: &str) -> Result<Self, (usize, String)> {
        let mut parts = Vec::new();
        let mut at = 0;
        for part in text.split('/') {
            parts.push(pieces(part).map_err(|(within, what)| (at + within, what))?);
            at += part.chars().count() + 1;
        }
        let has = |piece: &Piece| parts.iter().flatten().any(|p| p == piece);
        match (has(&Piece::Robot), has(&Piece::Day)) {
            (true, true) => Ok(Self(parts)),
            (false, _) => Err((0, "the path says no {robot}: write it where the robot's name stands".into())),
            _ => Err((0, "the path says no {day}: write it where the date stands, as 2026-03-01".into())),
        }
    }

    /// How many parts the path has.
    pub fn parts(&self) -> usize {
        self.0.len()
    }

    /// The text of a part in which nothing varies.
    pub fn fixed(&self, part: usize) -> Option<&str> {
        match self.0.get(part)?.as_slice() {
            [] => Some(""),
            [Piece::Text(text)] => Some(text),
            _ => None,
        }
    }

    /// What a name says that stands where part `part` is, with what the parts before it said. `None` where it does not fit.
    pub fn matched(&self, part: usize, name: &str, before: &Found) -> Option<Found> {
        matched(self.0.get(part)?, name, before.clone())
    }
}

fn pieces(part: &str) -> Result<Vec<Piece>, (usize, String)> {
    let mut pieces = Vec::new();
    let mut text = String::new();
    let mut rest = part;
    while let Some(next) = rest.chars().next() {
        let at = part.chars().count() - rest.chars().count();
        let (piece, length) = match next {
            '{' if rest.starts_with("{robot}") => (Some(Piece::Robot), 7),
            '{' if rest.starts_with("{day}") => (Some(Piece::Day), 5),
            '{' | '}' => return Err((at, "expected {robot} or {day}".to_owned())),
            '*' => (Some(Piece::Anything), 1),
            other => {
                text.push(other);
                (None, other.len_utf8())
            }
        };
        if let Some(piece) = piece {
            if !text.is_empty() {
                pieces.push(Piece::Text(std::mem::take(&mut text)));
            }
            if !matches!(pieces.last(), None | Some(Piece::Text(_))) {
                return Err((at, "something must stand between two of {robot}, {day} and *".to_owned()));
            }
            pieces.push(piece);
        }
        rest = &rest[length..];
    }
    if !text.is_empty() {
        pieces.push(Piece::Text(text));
    }
    Ok(pieces)
}

/// The shortest texts that fit, from the left.
fn matched(pieces: &[Piece], name: &str, found: Found) -> Option<Found> {
    let Some((piece, rest)) = pieces.split_first() else { return name.is_empty().then_some(found) };
    if let Piece::Text(text) = piece {
        return matched(rest, name.strip_prefix(text.as_str())?, found);
    }
    let ends = name.char_indices().map(|(at, c)| at + c.len_utf8());
    ends.filter_map(|end| {
        let (value, left) = name.split_at(end);
        matched(rest, left, said(piece, value, &found)?)
    })
    .next()
}

/// What a piece says; where it stands twice, it says the same.
fn said(piece: &Piece, value: &str, found: &Found) -> Option<Found> {
    let mut found = found.clone();
    let place = match piece {
        Piece::Robot => &mut found.robot,
        Piece::Day => &mut found.day,
        _ => return Some(found),
    };
    match place {
        Some(before) if before != value => return None,
        _ => *place = Some(value.to_owned()),
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn walk(pattern: &str, path: &str) -> Option<(String, String)> {
        let pattern = Pattern::parse(pattern).expect("a pattern");
        let parts: Vec<&str> = path.split('/').collect();
        if parts.len() != pattern.parts() {
            return None;
        }
        let found = parts
            .iter()
            .enumerate()
            .try_fold(Found::default(), |found, (k, name)| pattern.matched(k, name, &found))?;
        Some((found.robot?, found.day?))
    }

    #[test]
    fn robots_and_days_are_read_out_of_paths() {
        let one = |robot: &str, day: &str| Some((robot.to_owned(), day.to_owned()));
        assert_eq!(
            walk("{robot}/{day}/recording.yaml", "r1/2026-01-01/recording.yaml"),
            one("r1", "2026-01-01")
        );
        assert_eq!(walk("logs/{robot}_{day}-*.yaml", "logs/r_1_2026-x.yaml"), one("r", "1_2026"));
        assert_eq!(walk("{robot}/{robot}-{day}.yaml", "a/a-1.yaml"), one("a", "1"));
        assert_eq!(walk("{robot}/{robot}-{day}.yaml", "a/b-1.yaml"), None);
        assert_eq!(walk("{robot}/{day}.yaml", "a/.yaml"), None);
    }

    #[test]
    fn mistakes_are_told_where_they_stand() {
        assert_eq!(Pattern::parse("a/{robto}/{day}").map_err(|e| e.0), Err(2));
        assert_eq!(Pattern::parse("a/{robot}{day}").map_err(|e| e.0), Err(9));
        assert!(Pattern::parse("a/{robot}").is_err_and(|(_, what)| what.contains("{day}")));
        assert!(Pattern::parse("a/{day}").is_err_and(|(_, what)| what.contains("{robot}")));
    }
}
