//! Whether two tables are the same robot.

use crate::model::{CouplingLaw, Robot};

/// Sixteen hexadecimal digits that two robots share if and only if the same parameters give them the same torques.
///
/// FNV-1a (64 bits, Fowler, Noll and Vo) over, in this order, numbers as the eight bytes of their IEEE double, least
/// significant first, -0 as 0; counts as doubles too; texts as their bytes and a zero byte:
///
/// 1. gravity x y z;
/// 2. the number of frames, then for each: its parent's number (0 for the base), sigma, gamma, b, alpha, d, theta, r;
/// 3. the gear matrix row by row; the number of motors with coupled friction, then each;
/// 4. for each base parameter: its name, then the standard parameter and the coefficient of each term of its combination;
/// 5. for each frame that moves with other variables than its own joint's alone: its index, sigma, then each joint and its
///    coefficient;
/// 6. for each combination of joints that friction or a spring acts on: its name, 0 for friction, 1 for a spring, 2 for one
///    whose position at rest is known and that position, then each joint and its coefficient; of a spring between two points
///    3, or 4 and its length at rest, then for each point the number of its frame (0 for the base) and x y z, then as above.
///
/// Name, description, limits and nominal values have no part in it.
pub fn fingerprint(robot: &Robot) -> String {
    let mut hash = Fnv::default();
    robot.gravity.iter().for_each(|g| hash.number(*g));
    hash.count(robot.frames.len());
    for f in robot.frames.iter() {
        hash.count(f.parent.map_or(0, |p| p + 1));
        hash.count(f.kind as usize);
        [f.gamma, f.b, f.alpha, f.d, f.theta, f.r].into_iter().for_each(|x| hash.number(x));
    }
    robot.drive.gear.iter().for_each(|g| hash.number(*g));
    hash.count(robot.drive.coupled_friction.len());
    robot.drive.coupled_friction.iter().for_each(|m| hash.count(*m));
    for base in robot.base.iter() {
        hash.text(&base.name);
        for (standard, coefficient) in base.combination.iter() {
            hash.count(*standard);
            hash.number(*coefficient);
        }
    }
    for frame in robot.dependent.iter() {
        hash.count(frame.frame);
        hash.count(frame.kind as usize);
        for (joint, coefficient) in frame.terms.iter() {
            hash.count(*joint);
            hash.number(*coefficient);
        }
    }
    for coupling in robot.couplings.iter() {
        hash.text(&coupling.name);
        match coupling.law {
            CouplingLaw::Friction => hash.count(0),
            CouplingLaw::Spring => hash.count(1),
            CouplingLaw::SpringAt(rest) => {
                hash.count(2);
                hash.number(rest);
            }
            CouplingLaw::Between(between) => {
                hash.count(if between.rest.is_none() { 3 } else { 4 });
                between.rest.into_iter().for_each(|rest| hash.number(rest));
                for (frame, point) in between.frames.iter().zip(between.points) {
                    hash.count(frame.map_or(0, |frame| frame + 1));
                    point.into_iter().for_each(|x| hash.number(x));
                }
            }
        }
        for (joint, coefficient) in coupling.terms.iter() {
            hash.count(*joint);
            hash.number(*coefficient);
        }
    }
    format!("{:016x}", hash.0)
}

struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv {
    fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    fn number(&mut self, x: f64) {
        self.bytes(&(if x == 0.0 { 0.0 } else { x }).to_le_bytes());
    }

    fn count(&mut self, n: usize) {
        self.number(n as f64);
    }

    fn text(&mut self, text: &str) {
        self.bytes(text.as_bytes());
        self.bytes(&[0]);
    }
}

/// The first thing in which two tables differ, for a person; `None` where they are the same robot.
pub fn difference(saved: &Robot, now: &Robot) -> Option<String> {
    if fingerprint(saved) == fingerprint(now) {
        return None;
    }
    if saved.joints() != now.joints() {
        return Some(format!("it had {} joints, now {}", saved.joints(), now.joints()));
    }
    if saved.frames.len() != now.frames.len() {
        return Some(format!("it had {} frames, now {}", saved.frames.len(), now.frames.len()));
    }
    for (k, (a, b)) in saved.frames.iter().zip(now.frames.iter()).enumerate() {
        if a.kind != b.kind || a.parent != b.parent {
            return Some(format!("frame {} has another sigma or parent", k + 1));
        }
        let numbers = [
            ("gamma", a.gamma, b.gamma),
            ("b", a.b, b.b),
            ("alpha", a.alpha, b.alpha),
            ("d", a.d, b.d),
            ("theta", a.theta, b.theta),
            ("r", a.r, b.r),
        ];
        if let Some((name, was, is)) = numbers.into_iter().find(|(_, was, is)| was != is) {
            return Some(format!("{name} of frame {} was {was}, now {is}", k + 1));
        }
    }
    if saved.dependent != now.dependent {
        return Some("a frame moves with other joint variables".to_owned());
    }
    if saved.couplings != now.couplings {
        return Some("its friction between links or its springs have changed".to_owned());
    }
    if saved.gravity != now.gravity {
        return Some(format!("gravity was {:?}, now {:?}", saved.gravity, now.gravity));
    }
    if saved.drive != now.drive {
        return Some("its drive has changed".to_owned());
    }
    Some("its parameters are regrouped otherwise".to_owned())
}
