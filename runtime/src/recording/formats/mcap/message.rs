//! Messages that say what joints do: `sensor_msgs/msg/JointState` and `control_msgs/msg/DynamicJointState`.

use super::cdr::{Cdr, Fault};

/// A type of messages that is decoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Names, and lists of positions, velocities and efforts, any of which may be empty.
    JointState,
    /// Names, and for each a list of interfaces with values.
    DynamicJointState,
    /// Any other, by its definition: which of those of the log.
    Defined(usize),
}

/// Signals of a joint in a JointState, in the order of the message.
pub(super) const FIELDS: [&str; 3] = ["position", "velocity", "effort"];

impl Kind {
    pub fn of(name: &str) -> Option<Self> {
        match name {
            "sensor_msgs/msg/JointState" | "sensor_msgs/JointState" => Some(Self::JointState),
            "control_msgs/msg/DynamicJointState" | "control_msgs/DynamicJointState" => {
                Some(Self::DynamicJointState)
            }
            _ => None,
        }
    }
}

/// A signal that is wanted: of a joint, by a name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Signal {
    pub joint: String,
    pub field: String,
    /// Which of the wanted columns it is.
    pub slot: usize,
}

/// Decodes messages that tell of joints; the names of the one before are remembered, as they seldom change.
pub(super) struct Joints {
    pub signals: Vec<Signal>,
    /// Bytes of the names of the message before.
    names: Vec<u8>,
    /// Signals in it: list of the message, place in the list, column.
    plan: Vec<(usize, usize, usize)>,
    /// Names of joints that were seen.
    pub seen: Vec<String>,
}

/// A message of another type than those that tell of joints.
const OTHER: Fault = "its type does not tell of joints";
/// Most names that are remembered for a message to a person.
const MOST_SEEN: usize = 200;

impl Joints {
    pub fn new(signals: Vec<Signal>) -> Self {
        Self { signals, names: Vec::new(), plan: Vec::new(), seen: Vec::new() }
    }

    /// The header stamp of a message, ns; what is wanted of it is handed to `take` as column and value. Values that are
    /// not finite are what drivers send where they know nothing.
    pub fn read(&mut self, kind: Kind, data: &[u8], take: &mut impl FnMut(usize, f64)) -> Result<i64, Fault> {
        let mut cdr = Cdr::new(data)?;
        let stamp = cdr.stamp()?;
        cdr.text()?;
        match kind {
            Kind::JointState => self.joint_state(&mut cdr, take)?,
            Kind::DynamicJointState => self.dynamic(&mut cdr, take)?,
            Kind::Defined(_) => return Err(OTHER),
        }
        Ok(stamp)
    }

    fn joint_state(&mut self, cdr: &mut Cdr<'_>, take: &mut impl FnMut(usize, f64)) -> Result<(), Fault> {
        let (begin, mut again) = (cdr.position(), cdr.clone());
        for _ in 0..cdr.count(4)? {
            cdr.text()?;
        }
        let names = cdr.since(begin);
        let lists = [cdr.doubles()?, cdr.doubles()?, cdr.doubles()?];
        if self.names != names {
            self.names.clear();
            self.names.extend_from_slice(names);
            self.plan.clear();
            for index in 0..again.count(4)? {
                self.plan_joint(index, again.text()?);
            }
        }
        for &(list, index, slot) in &self.plan {
            if let Some(value) = lists[list].get(index).filter(|value| value.is_finite()) {
                take(slot, value);
            }
        }
        Ok(())
    }

    /// Where the wanted signals of the joint at `index` are.
    fn plan_joint(&mut self, index: usize, name: &[u8]) {
        see(&mut self.seen, name);
        for signal in self.signals.iter().filter(|signal| signal.joint.as_bytes() == name) {
            if let Some(list) = FIELDS.iter().position(|field| *field == signal.field) {
                self.plan.push((list, index, signal.slot));
            }
        }
    }

    fn dynamic(&mut self, cdr: &mut Cdr<'_>, take: &mut impl FnMut(usize, f64)) -> Result<(), Fault> {
        let mut joints = Vec::new();
        for _ in 0..cdr.count(4)? {
            joints.push(cdr.text()?);
        }
        let mut fields = Vec::new();
        for index in 0..cdr.count(8)? {
            fields.clear();
            for _ in 0..cdr.count(4)? {
                fields.push(cdr.text()?);
            }
            let values = cdr.doubles()?;
            let Some(joint) = joints.get(index) else { continue };
            see(&mut self.seen, joint);
            for signal in self.signals.iter().filter(|signal| signal.joint.as_bytes() == *joint) {
                let place = fields.iter().position(|field| *field == signal.field.as_bytes());
                if let Some(value) = place.and_then(|k| values.get(k)).filter(|value| value.is_finite()) {
                    take(signal.slot, value);
                }
            }
        }
        Ok(())
    }
}

/// The header stamp of a message; signals in it that are numbers and not yet in `all` are added, `joint.position` and so
/// on.
pub(super) fn signals(kind: Kind, data: &[u8], all: &mut Vec<String>) -> Result<i64, Fault> {
    let mut cdr = Cdr::new(data)?;
    let stamp = cdr.stamp()?;
    cdr.text()?;
    let mut joints = Vec::new();
    for _ in 0..cdr.count(4)? {
        joints.push(String::from_utf8_lossy(cdr.text()?).into_owned());
    }
    let mut add = |joint: &str, field: &str, value: Option<f64>| {
        let name = format!("{joint}.{field}");
        if all.len() < 3 * MOST_SEEN && value.is_some_and(f64::is_finite) && !all.contains(&name) {
            all.push(name);
        }
    };
    match kind {
        Kind::JointState => {
            for field in FIELDS {
                let list = cdr.doubles()?;
                joints.iter().enumerate().for_each(|(k, joint)| add(joint, field, list.get(k)));
            }
        }
        Kind::DynamicJointState => {
            for index in 0..cdr.count(8)? {
                let mut fields = Vec::new();
                for _ in 0..cdr.count(4)? {
                    fields.push(String::from_utf8_lossy(cdr.text()?).into_owned());
                }
                let values = cdr.doubles()?;
                let Some(joint) = joints.get(index) else { continue };
                fields.iter().enumerate().for_each(|(k, field)| add(joint, field, values.get(k)));
            }
        }
        Kind::Defined(_) => return Err(OTHER),
    }
    Ok(stamp)
}

/// Notes the name of a joint.
fn see(seen: &mut Vec<String>, name: &[u8]) {
    if seen.len() < MOST_SEEN && !seen.iter().any(|known| known.as_bytes() == name) {
        seen.push(String::from_utf8_lossy(name).into_owned());
    }
}
