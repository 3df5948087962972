//! What is wanted of messages, and how it is read of their types.

use super::cdr::Fault;
use super::definition::Definition;
use super::message::{FIELDS, Joints, Kind, Signal};
use super::path::Path;
use super::plan::Plan;
use crate::recording::names::{listed, meant};
use crate::recording::topic::Topic;

/// Reads the wanted signals of messages.
pub(super) enum Decoder {
    /// Of joints by their names, in the types that tell of joints.
    Joints(Joints),
    /// By paths, in messages of any type.
    Defined {
        wanted: Vec<(String, Path, usize)>,
        names: Option<String>,
        /// One for each definition that was met.
        plans: Vec<Plan>,
    },
}

/// A signal that no message had.
pub(super) enum Lacking {
    /// Its joint or its list is there.
    Signal(String),
    /// There is no such name.
    Joint { joint: String, meant: String, there: String },
}

/// Whether a column is called as an element of a list: `actual.positions[elbow]`.
pub(super) fn is_path(name: &str) -> bool {
    name.ends_with(']')
}

impl Decoder {
    /// From the signals with their columns; `names` is the path of the names that elements of lists have.
    ///
    /// # Errors
    /// A signal that messages of the topic cannot have.
    pub fn new(topic: &Topic, signals: &[(&str, usize)], names: Option<&str>) -> Result<Self, String> {
        let known = Kind::of(&topic.kind).filter(|_| !signals.iter().any(|(name, _)| is_path(name)));
        let Some(kind) = known else {
            let path = |&(name, slot): &(&str, usize)| {
                let path = Path::parse(name).ok_or_else(|| no_path(name, topic))?;
                Ok::<_, String>((name.to_owned(), path, slot))
            };
            let wanted = signals.iter().map(path).collect::<Result<_, _>>()?;
            return Ok(Self::Defined { wanted, names: names.map(str::to_owned), plans: Vec::new() });
        };
        let signals = signals.iter().map(|(name, slot)| signal(name, *slot, kind));
        Ok(Self::Joints(Joints::new(signals.collect::<Result<_, _>>()?)))
    }

    /// Whether the definitions of types are needed.
    pub fn is_by_definition(&self) -> bool {
        matches!(self, Self::Defined { .. })
    }

    /// Makes ready for messages of a definition.
    ///
    /// # Errors
    /// A path that leads nowhere.
    pub fn define(&mut self, k: usize, definitions: &[Definition]) -> Result<(), String> {
        let Self::Defined { wanted, names, plans } = self else { return Ok(()) };
        while plans.len() <= k {
            let Some(definition) = definitions.get(plans.len()) else { return Ok(()) };
            plans.push(Plan::new(definition.clone(), wanted, names.as_deref())?);
        }
        Ok(())
    }

    /// The stamp of a message, ns; what is wanted of it is handed to `take` as column and value. Values that are not
    /// finite are what drivers send where they know nothing.
    pub fn read(&mut self, kind: Kind, data: &[u8], take: &mut impl FnMut(usize, f64)) -> Result<i64, Fault> {
        match (self, kind) {
            (Self::Defined { plans, .. }, Kind::Defined(k)) => match plans.get_mut(k) {
                Some(plan) => plan.read(data, take),
                None => Err("its type is not known"),
            },
            (Self::Joints(joints), kind) => joints.read(kind, data, take),
            (Self::Defined { .. }, _) => Err("its type is another one"),
        }
    }

    /// The first signal whose column no message had.
    pub fn lacking(&self, lacks: impl Fn(usize) -> bool) -> Option<Lacking> {
        match self {
            Self::Joints(joints) => {
                let Signal { joint, field, .. } = joints.signals.iter().find(|signal| lacks(signal.slot))?;
                if joints.seen.contains(joint) {
                    return Some(Lacking::Signal(format!("{joint}.{field}")));
                }
                Some(there_is_no(joint, &joints.seen))
            }
            Self::Defined { wanted, plans, .. } => {
                let (name, path, _) = wanted.iter().find(|(_, _, slot)| lacks(*slot))?;
                let names = plans.last().map_or(&[][..], Plan::names);
                match &path.element {
                    Some(super::path::Element::Name(joint)) if !names.contains(joint) => {
                        Some(there_is_no(joint, names))
                    }
                    _ => Some(Lacking::Signal(name.clone())),
                }
            }
        }
    }
}

fn there_is_no(joint: &str, there: &[String]) -> Lacking {
    let names = || there.iter().map(String::as_str);
    Lacking::Joint { joint: joint.to_owned(), meant: meant(joint, names()), there: listed(names()) }
}

fn no_path(name: &str, topic: &Topic) -> String {
    format!(
        "`{name}` is asked for; numbers of {} are called by their fields: `wrench.force.x`, `actual.positions[0]`, \
         `actual.positions[elbow]`",
        topic.kind
    )
}

/// A signal of a joint, from the name of its column.
fn signal(name: &str, slot: usize, kind: Kind) -> Result<Signal, String> {
    let Some((joint, field)) = name.rsplit_once('.') else {
        return Err(format!(
            "column `{name}` is asked for; signals of a log are called `joint.position`, `joint.velocity`, \
             `joint.effort`, times `header.stamp` and `log_time`"
        ));
    };
    if kind == Kind::JointState && !FIELDS.contains(&field) {
        return Err(format!("`{name}`: a JointState has {} of each joint", FIELDS.join(", ")));
    }
    Ok(Signal { joint: joint.into(), field: field.into(), slot })
}
