//! How links and joints hang together.

use std::collections::HashSet;

use crate::attributes::Reader;
use crate::joint::Joint;
use crate::link::Link;
use crate::mistake::{Place, shown};

/// Reports joints that mimic what is not there.
pub(crate) fn check_mimics(reader: &mut Reader<'_>, joints: &[Joint]) {
    let names: HashSet<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
    for joint in joints {
        let Some(mimic) = &joint.mimic else { continue };
        if !names.contains(mimic.of.as_str()) {
            let (name, of) = (shown(&joint.name), shown(&mimic.of));
            reader.report(
                mimic.place,
                format!("joint '{name}' mimics '{of}', which is not a joint of the file"),
            );
        }
    }
}

/// Gives links their joints and finds the root; reports loops and what hangs together with nothing.
pub(crate) fn connect(
    reader: &mut Reader<'_>,
    place: Place,
    links: &mut [Link],
    joints: &[Joint],
) -> Option<usize> {
    for (k, joint) in joints.iter().enumerate() {
        if let Some(other) = links[joint.child].joint {
            let (link, first, second) = (&links[joint.child].name, &joints[other].name, &joint.name);
            reader.report(
                joint.place,
                format!(
                    "link '{}' is the child of joint '{}' already: '{}' closes a loop, and dynid takes trees; a parallelogram \
                     is a tree whose bars mimic its joints, any other loop needs a numerical solver, which dynid has not",
                    shown(link),
                    shown(first),
                    shown(second)
                ),
            );
            return None;
        }
        links[joint.child].joint = Some(k);
        links[joint.parent].children.push(k);
    }
    let roots: Vec<usize> = (0..links.len()).filter(|&k| links[k].joint.is_none()).collect();
    match roots[..] {
        [] if links.is_empty() => reader.report(place, "there is no <link> in it"),
        [] => reader.report(place, "every link is the child of a joint: the joints go in a circle"),
        [_, second, ..] => {
            let (first, second) = (&links[roots[0]], &links[second]);
            reader.report(
                second.place,
                format!(
                    "link '{}' hangs together with nothing: the root is '{}'",
                    shown(&second.name),
                    shown(&first.name)
                ),
            );
        }
        [root] => {
            // With one root and one parent a link, what is not reached goes in a circle.
            let mut reached = vec![false; links.len()];
            let mut open = vec![root];
            while let Some(k) = open.pop() {
                reached[k] = true;
                open.extend(links[k].children.iter().map(|&j| joints[j].child));
            }
            match reached.iter().position(|seen| !seen) {
                None => return Some(root),
                Some(k) => {
                    let name = shown(&links[k].name);
                    reader.report(links[k].place, format!("link '{name}' is in a circle of joints"));
                }
            }
        }
    }
    None
}
