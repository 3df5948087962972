//! A skeleton with one segment for each joint, as a URDF has them.

use crate::between::PointSpring;
use crate::body::Body;
use crate::pose::Pose;
use crate::skeleton::{Mimic, Segment, Skeleton, Tendon};

/// A skeleton joint by joint.
pub(crate) struct ByJoint {
    pub segments: Vec<Segment>,
    pub tendons: Vec<Tendon>,
    pub between: Vec<PointSpring>,
    /// For each of `segments` that of the skeleton whose body it carries; none for links between joints about one axis.
    pub carries: Vec<Option<usize>>,
    /// For each its place among the joints that have a variable.
    pub joints: Vec<Option<usize>>,
}

/// A further joint about the axis of a segment, on the link of joint `parent`.
fn further(segment: &Segment, parent: usize, mimic: Mimic) -> Segment {
    Segment {
        parent: Some(parent),
        origin: Pose::identity(),
        position: None,
        velocity: None,
        effort: None,
        body: Body::none(),
        damping: 0.0,
        friction: 0.0,
        armature: 0.0,
        mimic: Some(mimic),
        further: Vec::new(),
        ..segment.clone()
    }
}

impl Skeleton {
    /// The same with one segment for each joint: where further joints stand about an axis, links without a body between them.
    /// Depth first, those on one carrier in their order, as a URDF is read.
    pub(crate) fn by_joint(&self) -> ByJoint {
        let mut all = ByJoint {
            segments: Vec::new(),
            tendons: Vec::new(),
            between: Vec::new(),
            carries: Vec::new(),
            joints: Vec::new(),
        };
        let on = |parent: Option<usize>| {
            (0..self.segments.len()).rev().filter(move |&k| self.segments[k].parent == parent)
        };
        // For each segment its first joint and what carries its body.
        let mut places = vec![[0; 2]; self.segments.len()];
        let mut open: Vec<usize> = on(None).collect();
        while let Some(k) = open.pop() {
            let segment = &self.segments[k];
            let first = all.segments.len();
            let parent = segment.parent.map(|p| places[p][1]);
            all.segments.push(Segment { parent, further: Vec::new(), body: Body::none(), ..segment.clone() });
            let joint = self.segments[..k].iter().filter(|other| other.mimic.is_none()).count();
            all.joints.push(segment.mimic.is_none().then_some(joint));
            for mimic in &segment.further {
                all.segments.push(further(segment, all.segments.len() - 1, *mimic));
                all.joints.push(None);
            }
            let last = all.segments.len() - 1;
            all.segments[last].body = segment.body;
            all.carries.resize(all.segments.len(), None);
            all.carries[last] = Some(k);
            places[k] = [first, last];
            open.extend(on(Some(k)));
        }
        all.segments.iter_mut().flat_map(|s| &mut s.mimic).for_each(|m| m.segment = places[m.segment][0]);
        all.tendons.clone_from(&self.tendons);
        all.between.clone_from(&self.between);
        // What is on a body is on the link that carries it.
        let ends = all.between.iter_mut().flat_map(|spring| &mut spring.ends);
        ends.filter_map(|end| end.0.as_mut()).for_each(|segment| *segment = places[*segment][1]);
        all.tendons.iter_mut().flat_map(|t| &mut t.terms).for_each(|term| term.0 = places[term.0][0]);
        all
    }
}
