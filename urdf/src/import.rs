//! A URDF as the YAML of a robot.

use std::fmt::Write as _;

use nalgebra::Vector3;

use crate::body::Body;
use crate::coaxial::links_between;
use crate::document::Urdf;
use crate::ellipsoid_yaml::ellipsoids;
use crate::frames::{Frames, Row, frames};
use crate::import_options::ImportOptions;
use crate::joint::{Joint, JointType};
use crate::link_bounds::Meshes;
use crate::mistake::{Mistake, shown};
use crate::pose::Pose;
use crate::text::{angle, length, number, plain, quoted, tidy, variable};
use crate::tree::{Tree, too_many};
use dynid_description::ParameterKind;
use dynid_description::bounds::MAX_FRAMES;
use dynid_description::{JointKind, Motion};

/// A URDF as a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Imported {
    /// The robot's YAML.
    pub yaml: String,
    /// Name of each joint of the table, in its order.
    pub joints: Vec<String>,
    /// What to know before believing it.
    pub warnings: Vec<Mistake>,
}

/// The modified-DH table of a URDF, with names, limits and nominal values. `file` is what a person calls it.
///
/// # Errors
/// Links that are not there, joints of which there is no table, or more of them than a table has.
pub fn import(urdf: &Urdf, file: &str, options: &ImportOptions) -> Result<Imported, Vec<Mistake>> {
    written(urdf, file, options, None)
}

/// [`import`], with ellipsoids around the `<collision>` geometry of what moves, where it has some. `meshes` reads the vertices
/// of a mesh by the name that the URDF has for its file, or says why it cannot.
///
/// # Errors
/// As [`import`].
pub fn import_with_geometry(
    urdf: &Urdf,
    file: &str,
    options: &ImportOptions,
    meshes: &Meshes<'_>,
) -> Result<Imported, Vec<Mistake>> {
    written(urdf, file, options, Some(meshes))
}

fn written(
    urdf: &Urdf,
    file: &str,
    options: &ImportOptions,
    meshes: Option<&Meshes<'_>>,
) -> Result<Imported, Vec<Mistake>> {
    let tree = urdf.tree(options.base.as_deref(), options.tip.as_deref())?;
    let frames = frames(urdf, &tree);
    if frames.rows.len() > MAX_FRAMES {
        let joint = frames.rows[MAX_FRAMES].body.unwrap_or(tree.bodies.len() - 1);
        let place = urdf.joints[tree.bodies[joint].joint].place;
        return Err(vec![too_many(frames.rows.len(), place, &urdf.links[tree.base].name)]);
    }
    let mut warnings = urdf.warnings.clone();
    warnings.extend(held(urdf, &tree));
    let between = links_between(urdf, &tree);
    warnings.extend(without_mass(urdf, &tree, &between));
    warnings.extend(friction_of_followers(urdf, &tree));
    let writer = Writer { urdf, tree: &tree, frames: &frames, between: &between, options };
    let mut yaml = writer.yaml(file);
    if let Some(meshes) = meshes {
        yaml.push_str(&ellipsoids(urdf, &tree, &frames, &between, meshes));
    }
    let own = tree.bodies.iter().filter(|m| m.follows.is_none());
    let joints = own.map(|m| urdf.joints[m.joint].name.clone()).collect();
    Ok(Imported { yaml, joints, warnings })
}

fn held(urdf: &Urdf, tree: &Tree) -> Vec<Mistake> {
    let joint = |&j: &usize| &urdf.joints[j];
    let words = |joint: &Joint| {
        let child = shown(&urdf.links[joint.child].name);
        let place = joint.place;
        let words = format!(
            "joint '{}' is held at 0: it is not between the base and the tip, and '{child}' is carried along",
            shown(&joint.name)
        );
        Mistake::new(place, words)
    };
    tree.held.iter().map(joint).map(words).collect()
}

fn without_mass(urdf: &Urdf, tree: &Tree, between: &[usize]) -> Vec<Mistake> {
    let massless =
        |links: &[(usize, Pose)]| links.iter().all(|(link, _)| urdf.links[*link].inertial.is_none());
    let words = |link: usize| {
        let words = format!(
            "link '{}' has no <inertial>: its parameters are taken as 0",
            shown(&urdf.links[link].name)
        );
        Mistake::new(urdf.links[link].place, words)
    };
    let bodies = tree.bodies.iter().enumerate().filter(|(k, m)| massless(&m.links) && !between.contains(k));
    bodies.map(|(_, m)| words(m.links[0].0)).collect()
}

fn friction_of_followers(urdf: &Urdf, tree: &Tree) -> Vec<Mistake> {
    let followers = tree.bodies.iter().filter(|m| m.follows.is_some()).map(|m| &urdf.joints[m.joint]);
    let has = |joint: &&Joint| [joint.damping, joint.friction].into_iter().flatten().any(|x| x != 0.0);
    let words = |joint: &Joint| {
        let words = format!(
            "damping and friction of '{}' are left out: a table has friction of joints with a variable of their own",
            shown(&joint.name)
        );
        Mistake::new(joint.place, words)
    };
    followers.filter(has).map(words).collect()
}

/// What the YAML is written from.
struct Writer<'a> {
    urdf: &'a Urdf,
    tree: &'a Tree,
    frames: &'a Frames,
    /// Bodies that are none: links between joints about one axis.
    between: &'a [usize],
    options: &'a ImportOptions,
}

impl Writer<'_> {
    fn joint(&self, body: usize) -> &Joint {
        &self.urdf.joints[self.tree.bodies[body].joint]
    }

    fn yaml(&self, file: &str) -> String {
        let mut text = String::new();
        // Writing to a String cannot fail.
        let base = shown(&self.urdf.links[self.tree.base].name);
        let _ = writeln!(text, "# Written by `dynid import` from {}.", shown(file));
        let _ = writeln!(
            text,
            "# Frame 0 is the frame of link {base}; z of frame j is the axis of joint j, so that q is that of the URDF.\n\
             # Angles within {} rad of a multiple of pi/4 are taken for it; fixed links are part of what carries them.",
            plain(self.options.snap)
        );
        let _ = writeln!(text, "name: {}", identifier(&self.urdf.name));
        let _ = writeln!(text, "description: {}", quoted(&self.description(file)));
        let _ = writeln!(text, "gravity: [{}]", self.gravity().map(length).join(", "));
        text.push_str("frames:                           # modified DH; angles in rad, lengths in m\n");
        let rows: Vec<(String, &str)> =
            self.frames.rows.iter().enumerate().map(|(k, row)| self.row(k + 1, row)).collect();
        let widest = rows.iter().map(|(row, _)| row.chars().count()).max().unwrap_or_default();
        for (row, name) in &rows {
            let _ = writeln!(text, "  - {row:widest$}   # {}", shown(name));
        }
        text.push_str(&self.drive());
        text.push_str(&self.massless());
        text.push_str(&self.limits());
        text.push_str(&self.nominal());
        text
    }

    fn description(&self, file: &str) -> String {
        let tip = self.options.tip.as_deref().map_or_else(String::new, |tip| format!(" to {}", shown(tip)));
        let base = shown(&self.urdf.links[self.tree.base].name);
        format!("{} of {}, {base}{tip}", shown(&self.urdf.name), shown(file))
    }

    /// Gravity in frame 0.
    fn gravity(&self) -> [f64; 3] {
        let base = self.urdf.pose_in_root(self.tree.base);
        let gravity = base.rotation.transpose() * Vector3::from(self.options.gravity);
        let rounding = 1e-14 * gravity.norm();
        [gravity.x, gravity.y, gravity.z].map(|g| tidy(g, rounding))
    }

    fn row(&self, j: usize, row: &Row) -> (String, &str) {
        let screw = &row.screw;
        let follows = row.body.and_then(|k| self.tree.bodies[k].follows);
        let offset = follows.map_or(0.0, |follows| follows.offset);
        let (mut theta, mut r) = (angle(screw.theta), length(screw.r));
        let entry = |constant: &str| match follows.and_then(|f| Some((f, self.number_of(f.joint)?))) {
            Some((follows, number)) => {
                let motion = Motion { kind: row.kind, terms: vec![(number, follows.multiplier)] };
                motion.entry(|number| number, constant)
            }
            None => variable(j, constant),
        };
        let sigma = match row.kind {
            JointKind::Revolute => {
                theta = entry(&angle(screw.theta + offset));
                0
            }
            JointKind::Prismatic => {
                r = entry(&length(screw.r + offset));
                1
            }
            JointKind::Fixed => 2,
        };
        let parent = if row.parent + 1 == j { String::new() } else { format!("parent: {}, ", row.parent) };
        let (gamma, b) = (angle(screw.gamma), length(screw.b));
        let branch =
            if gamma == "0" && b == "0" { String::new() } else { format!("gamma: {gamma}, b: {b}, ") };
        let (alpha, d) = (angle(screw.alpha), length(screw.d));
        let name = row.body.map_or("between two axes that are nearly parallel", |k| &self.joint(k).name);
        let text = format!(
            "{{j: {j}, {parent}sigma: {sigma}, {branch}alpha: {alpha}, d: {d}, theta: {theta}, r: {r}}}"
        );
        (text, name)
    }

    /// Number of the row of a joint.
    fn number_of(&self, joint: usize) -> Option<usize> {
        let body = self.tree.bodies.iter().position(|m| m.joint == joint)?;
        self.frames.number.get(body).copied()
    }

    /// The joints that have a variable of their own.
    fn own_joints(&self) -> impl Iterator<Item = &Joint> {
        let own = self.tree.bodies.iter().filter(|m| m.follows.is_none());
        own.map(|m| &self.urdf.joints[m.joint])
    }

    /// Rows between the joints of one sum.
    fn massless(&self) -> String {
        if self.between.is_empty() {
            return String::new();
        }
        let rows: Vec<String> = self.between.iter().map(|&k| self.frames.number[k].to_string()).collect();
        format!(
            "massless: [{}]            # between joints about one axis, of which one mimics another\n",
            rows.join(", ")
        )
    }

    fn drive(&self) -> String {
        let gears: Vec<Option<f64>> = self.own_joints().map(|joint| joint.gear).collect();
        if gears.iter().flatten().all(|gear| *gear == 1.0) {
            return String::new();
        }
        let gears: Vec<String> = gears.iter().map(|gear| number(gear.unwrap_or(1.0))).collect();
        format!(
            "drive: {{gear: [{}]}}            # mechanicalReduction of the transmissions\n",
            gears.join(", ")
        )
    }

    /// Limits that every joint has; the reader takes no list with gaps.
    fn limits(&self) -> String {
        let joints: Vec<&Joint> = self.own_joints().collect();
        let mut text = String::new();
        let position = |joint: &&Joint| match (joint.kind, joint.limit.position) {
            (JointType::Continuous, _) => Some("2*pi".to_owned()),
            (_, Some([low, high])) if -low == high => Some(number(high)),
            (_, Some([low, high])) => Some(format!("[{}, {}]", number(low), number(high))),
            (_, None) => None,
        };
        let one = |value: Option<f64>| value.map(number);
        let lists: [(&str, Vec<Option<String>>); 3] = [
            ("position", joints.iter().map(position).collect()),
            ("velocity", joints.iter().map(|j| one(j.limit.velocity)).collect()),
            ("torque", joints.iter().map(|j| one(j.limit.effort)).collect()),
        ];
        for (key, list) in lists {
            let missing: Vec<String> =
                joints.iter().zip(&list).filter(|(_, x)| x.is_none()).map(|(j, _)| shown(&j.name)).collect();
            if let Some(list) = list.into_iter().collect::<Option<Vec<String>>>() {
                let why = key == "position" && joints.iter().any(|j| j.kind == JointType::Continuous);
                let why = if why { "   # 2*pi where the joint is continuous" } else { "" };
                let _ = writeln!(text, "  {key}: [{}]{why}", list.join(", "));
            } else {
                let _ = writeln!(text, "  # {key}: the URDF gives none for {}", missing.join(", "));
            }
        }
        let head =
            if text.lines().all(|line| line.trim_start().starts_with('#')) { "# limits:" } else { "limits:" };
        format!("{head}                           # those of the URDF\n{text}")
    }

    fn nominal(&self) -> String {
        let mut lines = String::new();
        for k in 0..self.tree.bodies.len() {
            let joint = self.joint(k);
            let j = self.frames.number[k];
            let mut named = Vec::new();
            let body = self.body(k).parameters();
            // What is nothing beside the body's other numbers of the unit is rounding.
            let largest = |part: &[f64]| part.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            let size = [largest(&body[..6]), largest(&body[6..9]), body[9]];
            for (i, kind) in ParameterKind::INERTIAL.iter().enumerate() {
                let size = size[usize::from(i > 5) + usize::from(i > 8)];
                if body[i].abs() > 1e-15 * size {
                    named.push(format!("{}{j}: {}", kind.symbol(), number(body[i])));
                }
            }
            let friction = [(ParameterKind::Fv, joint.damping), (ParameterKind::Fc, joint.friction)];
            for (kind, value) in friction.into_iter().filter(|_| self.tree.bodies[k].follows.is_none()) {
                if let Some(value) = value.filter(|x| *x != 0.0) {
                    named.push(format!("{}{j}: {}", kind.symbol(), number(value)));
                }
            }
            if !named.is_empty() {
                let _ = writeln!(lines, "    {},", named.join(", "));
            }
        }
        if lines.is_empty() {
            return String::new();
        }
        format!(
            "nominal:\n  # <inertial> of the links about the origins of the frames; <dynamics>: damping as Fv, friction as Fc.\n  \
             parameters: {{\n{lines}  }}\n"
        )
    }

    /// What a row carries, about the origin of its frame.
    fn body(&self, k: usize) -> Body {
        self.urdf.carried(&self.tree.bodies[k]).seen_from(&self.frames.in_link[k].inverse())
    }
}

/// A name as an identifier of Rust, which a robot's name has to be.
pub(crate) fn identifier(name: &str) -> String {
    let letter = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
    let mut name: String = name.chars().take(60).map(letter).collect();
    let keyword = KEYWORDS.split(' ').any(|word| word == name);
    if keyword || name.bytes().all(|b| b == b'_') {
        name.push_str("robot");
    }
    if name.starts_with(|c: char| c.is_ascii_digit()) {
        name.insert(0, '_');
    }
    name
}

/// Words that Rust keeps for itself.
const KEYWORDS: &str = "as break const continue crate else enum extern false fn for if impl in let loop match mod move mut \
    pub ref return self static struct super trait true type unsafe use where while async await dyn abstract become box do \
    final macro override priv typeof unsized virtual yield try gen raw union";
