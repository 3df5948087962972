//! The definition of a message, as MCAP files of ROS 2 hold it (`ros2msg`): the fields of the message, then those of every
//! message within it, each behind a line `MSG: package/Name`.

use std::collections::HashMap;

use super::path::Path;

/// Longest definition, bytes; most fields of a message with all that is in it; deepest nesting.
const LONGEST: usize = 1 << 20;
const MOST_FIELDS: usize = 20_000;
const DEEPEST: usize = 32;
/// Numeric fields that are listed for a person.
const LISTED: usize = 60;

/// A number of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    Bool,
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Number {
    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "bool" => Self::Bool,
            "int8" => Self::I8,
            "byte" | "char" | "uint8" => Self::U8,
            "int16" => Self::I16,
            "uint16" => Self::U16,
            "int32" => Self::I32,
            "uint32" => Self::U32,
            "int64" => Self::I64,
            "uint64" => Self::U64,
            "float32" => Self::F32,
            "float64" => Self::F64,
            _ => return None,
        })
    }
}

/// What a field holds, one of it or many.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Type {
    Number(Number),
    Text,
    /// A text of wide characters, which is passed over.
    WideText,
    /// Another message, by its place in the definition.
    Message(usize),
}

/// How many of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Many {
    One,
    Fixed(usize),
    Sequence,
}

/// A field of a message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Field {
    pub name: String,
    pub kind: Type,
    pub many: Many,
}

/// A message and all that are in it; the first is the message itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Definition {
    pub messages: Vec<Vec<Field>>,
}

impl Definition {
    /// Reads the text of a `ros2msg` schema; `name` is the type of the message.
    ///
    /// # Errors
    /// Why it cannot be read.
    pub fn parse(name: &str, text: &str) -> Result<Self, String> {
        if text.len() > LONGEST {
            return Err("its definition is longer than 1 MiB".into());
        }
        let sections = sections(name, text);
        let places: HashMap<&str, usize> =
            sections.iter().enumerate().rev().map(|(k, (name, _))| (name.as_str(), k)).collect();
        let mut messages = Vec::new();
        for (name, lines) in &sections {
            let package = name.split('/').next().unwrap_or_default();
            let mut fields = Vec::new();
            for line in lines {
                fields.extend(field(line, package, &places)?);
            }
            messages.push(fields);
        }
        let definition = Self { messages };
        definition.count(0, 0, &mut 0)?;
        Ok(definition)
    }

    /// Counts the fields of a message with all that is in it, which no message is itself.
    fn count(&self, message: usize, depth: usize, count: &mut usize) -> Result<(), String> {
        if depth > DEEPEST {
            return Err("its messages are nested too deeply".into());
        }
        for field in &self.messages[message] {
            *count += 1;
            if *count > MOST_FIELDS {
                return Err(format!("it has more than {MOST_FIELDS} fields"));
            }
            if let Type::Message(inner) = field.kind {
                self.count(inner, depth + 1, count)?;
            }
        }
        Ok(())
    }

    /// The field that a path leads to.
    ///
    /// # Errors
    /// The part of it that is not there.
    pub fn field(&self, path: &Path) -> Result<&Field, String> {
        let mut message = 0;
        let mut steps = path.steps.iter().peekable();
        while let Some((name, _)) = steps.next() {
            let fields = &self.messages[message];
            let Some(field) = fields.iter().find(|field| field.name == *name) else {
                let meant = crate::recording::meant(name, fields.iter().map(|field| field.name.as_str()));
                return Err(format!("there is no field `{name}`{meant}"));
            };
            match (field.kind, steps.peek()) {
                (_, None) => return Ok(field),
                (Type::Message(inner), Some(_)) => message = inner,
                (_, Some(_)) => return Err(format!("`{name}` has no fields")),
            }
        }
        Err("it is empty".into())
    }

    /// Whether a path is a list of texts.
    pub fn is_list_of_names(&self, path: &Path) -> bool {
        self.field(path).is_ok_and(|field| field.kind == Type::Text && field.many != Many::One)
    }

    /// Paths of the numbers, `wrench.force.x`, and of their lists, `actual.positions[]`.
    pub fn numbers(&self) -> Vec<String> {
        let mut all = Vec::new();
        self.numbers_of(0, "", &mut all);
        all
    }

    fn numbers_of(&self, message: usize, before: &str, all: &mut Vec<String>) {
        for field in &self.messages[message] {
            if all.len() >= LISTED {
                return;
            }
            let path = format!("{before}{}", field.name);
            match (field.kind, field.many) {
                (Type::Number(_), Many::One) => all.push(path),
                (Type::Number(_), _) => all.push(format!("{path}[]")),
                (Type::Message(inner), Many::One) => self.numbers_of(inner, &format!("{path}."), all),
                (Type::Message(inner), _) => self.numbers_of(inner, &format!("{path}[0]."), all),
                (Type::Text | Type::WideText, _) => {}
            }
        }
    }
}

/// The parts of a definition: type and lines of each, the message itself first.
fn sections<'a>(name: &str, text: &'a str) -> Vec<(String, Vec<&'a str>)> {
    let mut sections = vec![(short(name), Vec::new())];
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if line.len() > 3 && line.bytes().all(|byte| byte == b'=') {
            let head = lines.next().unwrap_or_default();
            sections.push((short(head.trim().trim_start_matches("MSG:").trim()), Vec::new()));
        } else if let Some((_, of)) = sections.last_mut() {
            of.push(line);
        }
    }
    sections
}

/// `package/Name`, also of `package/msg/Name`.
fn short(name: &str) -> String {
    name.replace("/msg/", "/")
}

/// The field that a line declares; `None` for a comment, a constant or an empty line.
fn field(line: &str, package: &str, places: &HashMap<&str, usize>) -> Result<Option<Field>, String> {
    let line = line.split('#').next().unwrap_or_default();
    let mut words = line.split_whitespace();
    let (Some(kind), Some(name)) = (words.next(), words.next()) else { return Ok(None) };
    // `float64 X=1`, `float64 X = 1`; a default value has no sign of equality.
    let is_constant = name.contains('=') || words.next().is_some_and(|word| word.starts_with('='));
    if is_constant {
        return Ok(None);
    }
    let (base, many) = match kind.strip_suffix(']').and_then(|rest| rest.rsplit_once('[')) {
        None => (kind, Many::One),
        Some((base, "")) => (base, Many::Sequence),
        Some((base, bound)) if bound.starts_with("<=") => (base, Many::Sequence),
        Some((base, length)) => {
            let length = length.parse().map_err(|_| format!("`{kind} {name}` cannot be read"))?;
            (base, Many::Fixed(length))
        }
    };
    let base = base.split("<=").next().unwrap_or_default();
    let kind = match (Number::of(base), base) {
        (Some(number), _) => Type::Number(number),
        (None, "string") => Type::Text,
        (None, "wstring") => Type::WideText,
        (None, _) => {
            let full = match base {
                "Header" => "std_msgs/Header".to_owned(),
                _ if base.contains('/') => short(base),
                _ => format!("{package}/{base}"),
            };
            let place = places.get(full.as_str());
            Type::Message(*place.ok_or_else(|| format!("its definition has no `{full}`"))?)
        }
    };
    Ok(Some(Field { name: name.to_owned(), kind, many }))
}

#[cfg(test)]
mod tests {
    use super::*;

    const STATE: &str = "# of a controller\nstd_msgs/Header header\nstring[] joint_names\nPoint actual\nint8 OK=1\nint8 BAD = 2\n\
        float64 gain 0.5\nuint8[3] flags\nstring<=5 text\n================================\nMSG: std_msgs/Header\n\
        builtin_interfaces/Time stamp\nstring frame_id\n================================\nMSG: builtin_interfaces/Time\nint32 sec\n\
        uint32 nanosec\n================================\nMSG: p/Point\nfloat64[] positions\nfloat64[<=9] effort\n";

    #[test]
    fn fields_are_those_of_the_text_without_its_constants() {
        let state = Definition::parse("p/msg/State", STATE).expect("a definition");
        let names: Vec<&str> = state.messages[0].iter().map(|field| field.name.as_str()).collect();
        assert_eq!(names, ["header", "joint_names", "actual", "gain", "flags", "text"]);
        assert_eq!(
            state.numbers(),
            [
                "header.stamp.sec",
                "header.stamp.nanosec",
                "actual.positions[]",
                "actual.effort[]",
                "gain",
                "flags[]"
            ]
        );
        let path = |text: &str| Path::parse(text).expect("a path");
        assert_eq!(state.field(&path("actual.effort")).map(|field| field.many), Ok(Many::Sequence));
        let error = state.field(&path("actual.position")).expect_err("no such field");
        assert_eq!(error, "there is no field `position` (did you mean `positions`?)");
    }

    #[test]
    fn what_is_not_there_or_within_itself_is_refused() {
        assert!(Definition::parse("p/A", "B b").expect_err("no B").contains("no `p/B`"));
        let error = Definition::parse("p/A", "A a").expect_err("a message within itself");
        assert!(error.contains("nested"), "{error}");
        assert!(Definition::parse("p/A", "float64[x] a").is_err());
    }
}
