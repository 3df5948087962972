//! A user's own URDF as what identified values are written into, everything else of it byte for byte as it was.

use nalgebra::Vector3;
use roxmltree::{Document, Node};

use crate::body::Body;
use crate::document::Urdf;
use crate::import_options::ImportOptions;
use crate::mistake::Mistake;
use crate::pose::Pose;
use crate::skeleton::{Skeleton, Unlike, matched};
use crate::text::plain;
use crate::tree::Tree;
use crate::write_urdf::inertial;
use dynid_description::{JointKind, Robot};

/// A URDF beside the table of the same robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Template<'a> {
    pub(crate) urdf: &'a Urdf,
    pub(crate) tree: Tree,
    skeleton: Skeleton,
    /// Pose of each joint's frame of the table in that of the template's link.
    pub(crate) in_link: Vec<Pose>,
    /// For each joint of the template the body of the table that its link carries, 0-based among those that move; none where
    /// the link stands between joints about one axis.
    carries: Vec<Option<usize>>,
    /// For each joint of the template its place among those of the table that have a variable.
    joints: Vec<Option<usize>>,
    /// Frame of the table of each of these bodies.
    pub(crate) frames: Vec<usize>,
}

/// What is known of one moving body from a template, seen from the frame of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct TemplateBody {
    /// Frame of the table, 0-based.
    pub frame: usize,
    /// Name of the link whose `<inertial>` identified values are written to.
    pub link: String,
    /// Its own body.
    pub own: Body,
    /// What is fixed on it in other links, whose `<inertial>` stays.
    pub attached: Body,
    /// Names of those links.
    pub attached_links: Vec<String>,
}

/// Values of one joint that a URDF holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointFriction {
    /// `damping`, N.m.s/rad or N.s/m.
    pub damping: f64,
    /// `friction`, N.m or N.
    pub friction: f64,
}

impl<'a> Template<'a> {
    /// Finds the joints of a table in a URDF.
    ///
    /// # Errors
    /// Links that are not there, as in an import; or a table whose axes are elsewhere.
    pub fn new(
        urdf: &'a Urdf,
        robot: &Robot,
        options: &ImportOptions,
    ) -> Result<Self, Result<Unlike, Vec<Mistake>>> {
        let tree = urdf.tree(options.base.as_deref(), options.tip.as_deref()).map_err(Err)?;
        let root = urdf.pose_in_root(tree.base);
        let gravity = root.rotation.transpose() * Vector3::from(options.gravity);
        let skeleton = Skeleton::of_tree(urdf, &tree, gravity);
        let table = Skeleton::of_table(robot, &vec![0.0; robot.standard.len()]).by_joint();
        let in_link = matched(&table.segments, &skeleton).map_err(Ok)?;
        let motions = robot.motions();
        let frames = (0..motions.len()).filter(|&k| motions[k].kind != JointKind::Fixed).collect();
        let (carries, joints) = (table.carries, table.joints);
        Ok(Self { urdf, tree, skeleton, in_link, carries, joints, frames })
    }

    /// What the template knows of each moving body, in the order of the table.
    pub fn bodies(&self) -> Vec<TemplateBody> {
        self.carriers().map(|(k, body)| self.body(k, self.frames[body])).collect()
    }

    /// Joints whose links carry bodies of the table, with these.
    pub(crate) fn carriers(&self) -> impl Iterator<Item = (usize, usize)> {
        self.carries.iter().enumerate().filter_map(|(k, body)| Some((k, (*body)?)))
    }

    /// The link of a segment that carries most: the identified values become its own.
    fn heaviest(&self, k: usize) -> (usize, Pose) {
        let links = &self.tree.bodies[k].links;
        let mass = |link: usize| self.urdf.links[link].inertial.as_ref().map_or(0.0, |i| i.body.mass);
        // The first of those that are as heavy.
        let mut best = links[0];
        for &(link, pose) in &links[1..] {
            if mass(link) > mass(best.0) {
                best = (link, pose);
            }
        }
        best
    }

    pub(crate) fn body(&self, k: usize, frame: usize) -> TemplateBody {
        let (target, _) = self.heaviest(k);
        let to_table = self.in_link[k].inverse();
        let seen = |(link, pose): &(usize, Pose)| self.urdf.body_of(*link, &to_table.then(pose));
        let links = &self.tree.bodies[k].links;
        let mut body = TemplateBody {
            frame,
            link: self.urdf.links[target].name.clone(),
            own: Body::none(),
            attached: Body::none(),
            attached_links: Vec::new(),
        };
        for entry in links {
            if entry.0 == target {
                body.own = seen(entry);
            } else if self.urdf.links[entry.0].inertial.is_some() {
                body.attached = body.attached.with(&seen(entry));
                body.attached_links.push(self.urdf.links[entry.0].name.clone());
            }
        }
        body
    }

    /// Names of the joints that have a variable, in the order of the table.
    pub fn joints(&self) -> Vec<&str> {
        let mut own: Vec<(usize, &str)> = self
            .joints
            .iter()
            .zip(&self.skeleton.segments)
            .filter_map(|(joint, segment)| Some(((*joint)?, segment.joint.as_str())))
            .collect();
        own.sort_unstable_by_key(|(joint, _)| *joint);
        own.into_iter().map(|(_, name)| name).collect()
    }

    /// Link of each segment that keeps its `<inertial>` apart, and its new body in the link's own frame.
    fn own_bodies(&self, robot: &Robot, standard: &[f64]) -> Vec<(usize, Body)> {
        // Fixed frames of the table are part of what carries them.
        let table = Skeleton::of_table(robot, standard);
        let one = |(k, body): (usize, usize)| {
            let (target, pose) = self.heaviest(k);
            let known = self.body(k, self.frames[body]);
            let own = table.segments[body].body.without(&known.attached);
            (target, own.seen_from(&pose.inverse().then(&self.in_link[k])))
        };
        self.carriers().map(one).collect()
    }

    /// The URDF with these standard parameters and frictions, one for each joint with a variable; joints that mimic others stay
    /// as they are.
    ///
    /// Where a body has no mass its `<inertial>` stays. `bytes` are those that the URDF was read from.
    ///
    /// # Errors
    /// Bytes of another file.
    pub fn patched(
        &self,
        bytes: &[u8],
        robot: &Robot,
        standard: &[f64],
        friction: &[JointFriction],
    ) -> Result<String, Mistake> {
        let other = || Mistake::new(crate::mistake::START, "not the file that the template was read from");
        let text = crate::document::utf8(bytes)?;
        let document = Document::parse(text).map_err(|_| other())?;
        let node = |start: usize| {
            document.root_element().children().find(|n| n.is_element() && n.range().start == start)
        };
        let mut edits = Vec::new();
        for (link, body) in self.own_bodies(robot, standard) {
            let found = node(self.urdf.links[link].range.start).ok_or_else(other)?;
            edits.extend(edit_link(text, found, &body));
        }
        for (moving, joint) in self.tree.bodies.iter().zip(&self.joints) {
            let Some(friction) = joint.and_then(|j| friction.get(j)) else { continue };
            let found = node(self.urdf.joints[moving.joint].range.start).ok_or_else(other)?;
            edits.extend(edit_joint(text, found, friction));
        }
        Ok(applied(text, edits))
    }

    /// The template's joints with a table's standard parameters, in the template's frames and with its names; in frames of the
    /// table where links stand between joints about one axis, which are no bodies.
    pub fn skeleton(&self, robot: &Robot, standard: &[f64]) -> Skeleton {
        let whole = Skeleton::of_table(robot, standard);
        let table = whole.by_joint();
        if self.carries.contains(&None) {
            return self.renamed(whole);
        }
        let mut skeleton = self.skeleton.clone();
        skeleton.gravity = whole.gravity;
        skeleton.tendons = table.tendons;
        skeleton.between = table.between;
        for (segment, point) in skeleton.between.iter_mut().flat_map(|spring| &mut spring.ends) {
            if let Some(pose) = segment.and_then(|k| self.in_link.get(k)) {
                *point = pose.rotation * *point + pose.translation;
            }
        }
        for ((own, new), pose) in skeleton.segments.iter_mut().zip(table.segments).zip(&self.in_link) {
            own.body = new.body.seen_from(pose);
            (own.damping, own.friction, own.armature) = (new.damping, new.friction, new.armature);
        }
        skeleton
    }
}

impl Template<'_> {
    /// A table's bodies and joints by the names of the template.
    fn renamed(&self, mut table: Skeleton) -> Skeleton {
        let mut first = 0;
        for (k, body) in self.carriers() {
            table.segments[body].link.clone_from(&self.skeleton.segments[k].link);
            table.segments[body].joint.clone_from(&self.skeleton.segments[first].joint);
            first = k + 1;
        }
        table.base.clone_from(&self.skeleton.base);
        table
    }
}

/// Bytes that are replaced.
struct Edit {
    start: usize,
    end: usize,
    text: String,
}

fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|n| n.is_element() && n.tag_name().name() == name)
}

/// The white space before a byte on its line, and how lines end in the file.
fn indent(text: &str, at: usize) -> (&str, &str) {
    let line = text[..at].rfind('\n').map_or(0, |newline| newline + 1);
    let spaces = text[line..at].len() - text[line..at].trim_start_matches([' ', '\t']).len();
    let newline = if text[..line].ends_with("\r\n") { "\r\n" } else { "\n" };
    (&text[line..line + spaces], newline)
}

fn edit_link(text: &str, link: Node<'_, '_>, body: &Body) -> Option<Edit> {
    if let Some(old) = child(link, "inertial") {
        let range = old.range();
        let (spaces, newline) = indent(text, range.start);
        return Some(Edit { start: range.start, end: range.end, text: inertial(body, spaces, newline)? });
    }
    let (spaces, newline) = indent(text, link.range().start);
    let inside = format!("{spaces}  ");
    Some(inserted(
        text,
        link,
        &format!("{newline}{inside}{}", inertial(body, &inside, newline)?),
        &format!("{newline}{spaces}"),
    ))
}

fn edit_joint(text: &str, joint: Node<'_, '_>, friction: &JointFriction) -> Vec<Edit> {
    let values = [("damping", friction.damping), ("friction", friction.friction)];
    let Some(dynamics) = child(joint, "dynamics") else {
        let (spaces, newline) = indent(text, joint.range().start);
        let [damping, friction] = values.map(|(name, value)| format!("{name}=\"{}\"", plain(value)));
        let element = format!("{newline}{spaces}  <dynamics {damping} {friction}/>");
        return vec![inserted(text, joint, &element, &format!("{newline}{spaces}"))];
    };
    let mut edits = Vec::new();
    let mut missing = String::new();
    for (name, value) in values {
        match dynamics.attribute_node(name) {
            Some(attribute) => {
                let range = attribute.range_value();
                edits.push(Edit { start: range.start, end: range.end, text: plain(value) });
            }
            None => missing.push_str(&format!(" {name}=\"{}\"", plain(value))),
        }
    }
    if !missing.is_empty() {
        let at = dynamics.range().start + "<dynamics".len();
        edits.push(Edit { start: at, end: at, text: missing });
    }
    edits
}

/// Text at the end of an element, which may have no content yet; `before_end` is what then stands before its end tag.
fn inserted(text: &str, node: Node<'_, '_>, content: &str, before_end: &str) -> Edit {
    let range = node.range();
    let source = &text[range.clone()];
    if let Some(open) = source.strip_suffix("/>") {
        let name: String =
            source[1..].chars().take_while(|c| !c.is_whitespace() && *c != '/' && *c != '>').collect();
        let start = range.start + open.trim_end().len();
        return Edit { start, end: range.end, text: format!(">{content}{before_end}</{name}>") };
    }
    // After the last child that is no white space, or after the opening tag.
    let last = node.last_element_child().map(|child| child.range().end);
    let open = || {
        range.start
            + node
                .first_child()
                .map_or_else(|| source.rfind("</").unwrap_or(0), |c| c.range().start - range.start)
    };
    let start = last.unwrap_or_else(open);
    Edit { start, end: start, text: content.to_owned() }
}

/// The text with every edit done.
fn applied(text: &str, mut edits: Vec<Edit>) -> String {
    edits.sort_by_key(|edit| (edit.start, edit.end));
    let mut out = String::with_capacity(text.len() + 1024);
    let mut at = 0;
    for edit in edits {
        // Elements of one robot do not overlap; a link that were met twice is edited once.
        if edit.start < at {
            continue;
        }
        out.push_str(&text[at..edit.start]);
        out.push_str(&edit.text);
        at = edit.end;
    }
    out + &text[at..]
}

#[cfg(test)]
#[path = "template_tests.rs"]
mod tests;
