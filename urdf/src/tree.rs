//! Which joints move, and which links each of them carries along.

use crate::body::Body;
use crate::document::Urdf;
use crate::joint::JointType;
use crate::mistake::{Mistake, Place, shown};
use crate::pose::Pose;
use dynid_description::bounds::MAX_FRAMES;

/// The part of a URDF that a table describes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tree {
    /// The link that does not move: frame 0 is its frame.
    pub base: usize,
    /// What moves, parents before children.
    pub bodies: Vec<Moving>,
    /// Joints that move in the file and are held at 0 here, with why.
    pub held: Vec<usize>,
}

/// A moving joint, and all links that it carries up to the next ones.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Moving {
    pub joint: usize,
    /// Body that carries it; `None` for the base.
    pub parent: Option<usize>,
    /// What moves it where it has no variable of its own.
    pub follows: Option<Follows>,
    /// Its frame at 0 in the frame of the carrying body.
    pub origin: Pose,
    /// Links with their poses in the frame of the joint's child link, which is the first.
    pub links: Vec<(usize, Pose)>,
}

/// A joint that mimics another: q = multiplier * q of the other + offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Follows {
    /// The joint, which has a variable of its own.
    pub joint: usize,
    pub multiplier: f64,
    /// rad or m.
    pub offset: f64,
}

/// More joints than a table has.
pub(crate) fn too_many(count: usize, place: Place, base: &str) -> Mistake {
    let words = format!(
        "{count} frames for the joints from '{}' on; a table has at most {MAX_FRAMES}: --base and --tip choose a chain",
        shown(base)
    );
    Mistake::new(place, words)
}

/// A multiplier this close to a whole number, relatively, is one: how ratios are rounded in a file.
const WHOLE: f64 = 1e-6;

impl Urdf {
    /// What moves of the links from `base` on, or between `base` and `tip`.
    ///
    /// Without a tip every joint beyond the base moves. With one the joints between them do; the others that move in the
    /// file are held at 0, and their links are carried along.
    ///
    /// # Errors
    /// Links that are not there, a tip that is not beyond the base, joints of which there is no table.
    pub(crate) fn tree(&self, base: Option<&str>, tip: Option<&str>) -> Result<Tree, Vec<Mistake>> {
        let base = base.map_or(Ok(self.root), |name| self.link_named(name, "--base"))?;
        let mut moves = vec![tip.is_none(); self.joints.len()];
        if let Some(name) = tip {
            self.path(base, self.link_named(name, "--tip")?)?.into_iter().for_each(|j| moves[j] = true);
        }
        let mut tree = Tree { base, bodies: Vec::new(), held: Vec::new() };
        let mut mistakes = Vec::new();
        // Depth first, in the order of the file.
        let mut open = vec![(base, None, Pose::identity())];
        while let Some((link, body, pose)) = open.pop() {
            if let Some(k) = body {
                let moving: &mut Moving = &mut tree.bodies[k];
                moving.links.push((link, pose));
            }
            for &j in self.links[link].children.iter().rev() {
                let joint = &self.joints[j];
                let there = pose.then(&joint.origin);
                if joint.kind == JointType::Fixed || !moves[j] {
                    if joint.kind != JointType::Fixed {
                        tree.held.push(j);
                    }
                    open.push((joint.child, body, there));
                } else if let Err(mistake) = self.check_moving(j) {
                    mistakes.push(mistake);
                } else {
                    let follows = self.followed(j).unwrap_or_else(|mistake| {
                        mistakes.push(mistake);
                        None
                    });
                    let links = Vec::new();
                    tree.bodies.push(Moving { joint: j, parent: body, follows, origin: there, links });
                    open.push((joint.child, Some(tree.bodies.len() - 1), Pose::identity()));
                }
            }
        }
        if tree.bodies.len() > MAX_FRAMES {
            let place = self.joints[tree.bodies[MAX_FRAMES].joint].place;
            return Err(vec![too_many(tree.bodies.len(), place, &self.links[base].name)]);
        }
        if tree.bodies.is_empty() && mistakes.is_empty() {
            let words =
                "no joint moves there: expected at least one that is revolute, continuous or prismatic";
            mistakes.push(Mistake::new(self.links[base].place, words));
        }
        mistakes.extend(self.left_behind(&tree));
        tree.held.sort_unstable();
        if mistakes.is_empty() { Ok(self.in_order(tree)) } else { Err(mistakes) }
    }

    /// The link with a name; `what` it is wanted for.
    fn link_named(&self, name: &str, what: &str) -> Result<usize, Vec<Mistake>> {
        self.links.iter().position(|link| link.name == name).ok_or_else(|| {
            let known: Vec<String> = self.links.iter().take(12).map(|link| shown(&link.name)).collect();
            let more = if self.links.len() > 12 { ", ..." } else { "" };
            let place = self.links[self.root].place;
            let words = format!(
                "there is no link '{}' for {what}: links are {}{more}",
                shown(name),
                known.join(", ")
            );
            vec![Mistake::new(place, words)]
        })
    }

    /// Joints from the base to the tip.
    fn path(&self, base: usize, tip: usize) -> Result<Vec<usize>, Vec<Mistake>> {
        let mut path = Vec::new();
        let mut at = tip;
        while at != base {
            let Some(j) = self.links[at].joint else {
                let (base, tip) = (shown(&self.links[base].name), shown(&self.links[tip].name));
                let words = format!("link '{tip}' is not beyond '{base}': no way from --base to --tip");
                return Err(vec![Mistake::new(self.links[at].place, words)]);
            };
            path.push(j);
            at = self.joints[j].parent;
        }
        Ok(path)
    }

    fn check_moving(&self, j: usize) -> Result<(), Mistake> {
        let joint = &self.joints[j];
        let name = shown(&joint.name);
        match joint.kind {
            JointType::Floating | JointType::Planar => {
                let what = if joint.kind == JointType::Planar { "planar" } else { "floating" };
                let child = shown(&self.links[joint.child].name);
                let words = format!(
                    "joint '{name}' is {what}: a table has revolute and prismatic joints. --base '{child}' begins after it"
                );
                Err(Mistake::new(joint.place, words))
            }
            _ => Ok(()),
        }
    }

    /// Joints that mimic one that does not move.
    fn left_behind(&self, tree: &Tree) -> Vec<Mistake> {
        let moves = |joint: usize| tree.bodies.iter().any(|body| body.joint == joint);
        let left = |body: &&Moving| body.follows.is_some_and(|follows| !moves(follows.joint));
        let words = |body: &Moving| {
            let joint = &self.joints[body.joint];
            let (place, of) =
                joint.mimic.as_ref().map_or((joint.place, ""), |mimic| (mimic.place, &mimic.of));
            let words = format!(
                "joint '{}' mimics '{}', which does not move here: choose --base and --tip so that both move, or neither",
                shown(&joint.name),
                shown(of)
            );
            Mistake::new(place, words)
        };
        tree.bodies.iter().filter(left).map(words).collect()
    }

    /// What moves a joint that mimics another, through joints that mimic in their turn.
    fn followed(&self, j: usize) -> Result<Option<Follows>, Mistake> {
        let Some(first) = &self.joints[j].mimic else { return Ok(None) };
        let name = shown(&self.joints[j].name);
        let mistake = |words: String| Err(Mistake::new(first.place, words));
        let mut follows = Follows { joint: j, multiplier: 1.0, offset: 0.0 };
        let mut steps = 0;
        while let Some(mimic) = &self.joints[follows.joint].mimic {
            let Some(of) = self.joints.iter().position(|joint| joint.name == mimic.of) else {
                return Ok(None);
            };
            follows.offset += follows.multiplier * mimic.offset;
            follows = Follows { joint: of, multiplier: follows.multiplier * mimic.multiplier, ..follows };
            steps += 1;
            if steps > self.joints.len() {
                return mistake(format!("joint '{name}' mimics itself, through others"));
            }
        }
        let of = &self.joints[follows.joint];
        let (multiplier, other) = (follows.multiplier, shown(&of.name));
        let is_length = |kind: JointType| kind == JointType::Prismatic;
        if multiplier == 0.0 || !multiplier.is_finite() || !follows.offset.is_finite() {
            return mistake(format!(
                "joint '{name}' mimics '{other}' {multiplier} times: a joint that stands is fixed"
            ));
        }
        if is_length(self.joints[j].kind) {
            return Ok(Some(follows));
        }
        if is_length(of.kind) || of.kind == JointType::Fixed {
            return mistake(format!(
                "joint '{name}' turns and mimics '{other}', which does not: its angle is no sum of angles"
            ));
        }
        let whole = multiplier.round();
        if (multiplier - whole).abs() > WHOLE * multiplier.abs() {
            return mistake(format!(
                "joint '{name}' mimics '{other}' {multiplier} times: a table has sines and cosines of sums of joint angles, \
                 which need whole multiples. --base and --tip choose a chain without it; it is then held at 0"
            ));
        }
        Ok(Some(Follows { multiplier: whole, ..follows }))
    }

    /// The bodies depth first in the order of the file: children are pushed when their parent is met, so that siblings
    /// come before the first one's own children until they are put in order.
    fn in_order(&self, tree: Tree) -> Tree {
        let mut order = Vec::new();
        let children = |parent: Option<usize>| -> Vec<usize> {
            let mut of: Vec<usize> =
                (0..tree.bodies.len()).filter(|&k| tree.bodies[k].parent == parent).collect();
            of.sort_by_key(|&k| std::cmp::Reverse(tree.bodies[k].joint));
            of
        };
        let mut open = children(None);
        while let Some(k) = open.pop() {
            order.push(k);
            open.extend(children(Some(k)));
        }
        let mut place = vec![0; order.len()];
        order.iter().enumerate().for_each(|(new, &old)| place[old] = new);
        let moved = |&k: &usize| {
            let moving = &tree.bodies[k];
            Moving { parent: moving.parent.map(|p| place[p]), ..moving.clone() }
        };
        Tree { bodies: order.iter().map(moved).collect(), ..tree }
    }

    /// What a moving joint carries, about the origin of its child link's frame.
    pub(crate) fn carried(&self, moving: &Moving) -> Body {
        moving.links.iter().fold(Body::none(), |sum, &(link, pose)| sum.with(&self.body_of(link, &pose)))
    }

    /// The body of one link, seen from a frame in which the link's frame has this pose.
    pub(crate) fn body_of(&self, link: usize, pose: &Pose) -> Body {
        self.links[link].inertial.as_ref().map_or(Body::none(), |inertial| inertial.body.seen_from(pose))
    }

    /// Pose of a link in the frame of the root, every joint at 0.
    pub(crate) fn pose_in_root(&self, mut link: usize) -> Pose {
        let mut pose = Pose::identity();
        while let Some(j) = self.links[link].joint {
            pose = self.joints[j].origin.then(&pose);
            link = self.joints[j].parent;
        }
        pose
    }
}
