//! Where a frame stands, and the right angles that its numbers mean.

use roxmltree::Node;

use crate::angles::{rounding, snapped};
use crate::attributes::{Reader, first};
use crate::pose::Pose;

/// How right angles are read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rounding {
    /// How far an angle may be from a multiple of pi/4 to be taken for one, rad.
    pub snap: f64,
    /// The coarsest rounding of a right angle that was taken as it stands, rad.
    pub coarsest: Option<f64>,
}

/// `xyz` and `rpy` of an <origin>, with what is meant to be a right angle as one.
pub(crate) fn read_origin(reader: &mut Reader<'_>, node: Node<'_, '_>, angles: &mut Rounding) -> Pose {
    let Some(origin) = first(node, "origin") else { return Pose::identity() };
    let xyz = reader.triple(origin, "xyz").map_or([0.0; 3], |(xyz, _)| xyz.map(|(_, x)| x));
    let rpy = reader.triple(origin, "rpy").map_or([0.0; 3], |(rpy, _)| {
        rpy.map(|(text, angle)| {
            let taken = snapped(angle, angles.snap);
            if taken == angle
                && let Some(off) = rounding(text, angle).filter(|off| *off > angles.snap)
            {
                angles.coarsest = Some(angles.coarsest.map_or(off, |known: f64| known.max(off)));
            }
            taken
        })
    });
    Pose::from_xyz_rpy(xyz, rpy)
}
