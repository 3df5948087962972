//! Laws of each joint that tell how much a law of this joint varies from one stretch of motion to the next.

use crate::diagnosis::candidates::nuisances::friction_columns;
use crate::diagnosis::candidates::trial::columns;
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::effects::{EffectKind, Place, ToldBy};

/// The first companions of a joint that are columns of its level of friction: viscous and Coulomb.
pub(in crate::diagnosis) const LEVELS: usize = 2;

/// Per joint its viscous and its Coulomb friction, then the laws of the catalogue that act on it alone, each with the middle of its grid of shapes: values on the
/// joint's rows.
pub(in crate::diagnosis) fn companions(context: &Context<'_>, design: &Design) -> Vec<Vec<Vec<f64>>> {
    let robot = context.model.robot();
    let levels = |j| friction_columns(context, design, j).into_iter().take(LEVELS).collect();
    let mut out: Vec<Vec<Vec<f64>>> = (0..design.joints).map(levels).collect();
    for effect in EffectKind::ALL {
        let form = effect.form();
        // What must be told from simpler laws varies as they do, which would count twice.
        if effect.properties().special_case.is_some_and(|case| case.told_by == ToldBy::Certainty) {
            continue;
        }
        for place in form.places(robot) {
            let Place::Joint(joint) = place else { continue };
            let shapes = form.shapes(place, &context.scales);
            let Some(shape) = shapes.get(shapes.len() / 2) else { continue };
            for column in columns(context, design, effect, place, shape, false) {
                let on_joint = column.into_iter().find(|(j, _)| *j == joint).map(|(_, values)| values);
                out[joint].extend(on_joint.filter(|c| c.iter().all(|x| x.is_finite())));
            }
        }
    }
    out
}
