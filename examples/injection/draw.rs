//! A law of the catalogue at a random place with a random shape.

use dynid_runtime::diagnosis::joint_scales;
use dynid_runtime::effects::{EffectKind, EffectTerm, Form, Place, TermScale};
use dynid_runtime::model::Model;
use dynid_runtime::signal::Motion;

use crate::random::Random;

/// Draws the place, the shape and the direction of the amplitudes; the size is 1 in the units of the law.
pub fn draw(
    effect: EffectKind,
    model: &dyn Model,
    motions: &[Motion],
    chi: &[f64],
    random: &mut Random,
) -> Option<EffectTerm> {
    let robot = model.robot();
    let scales = joint_scales(model, motions, chi);
    let places = effect.form().places(robot);
    let place = *places.get(random.below(places.len()))?;
    let shapes = effect.form().shapes(place, &scales);
    let shape = shapes.get(random.below(shapes.len()))?.clone();
    let amplitude = match effect.form() {
        Form::Joint(law) | Form::Heard(law) => {
            let signed = |x: f64| if law.only_positive() { x } else { 2.0 * x - 1.0 };
            (0..law.amplitudes(&shape)).map(|_| signed(random.share())).collect()
        }
        Form::Body(_) => body(random),
        Form::Sensitivity(_) | Form::Coupled => vec![if random.share() < 0.5 { -1.0 } else { 1.0 }],
        Form::Compliance(_) | Form::Window | Form::Free | Form::User => return None,
    };
    let scale = place.law_of().and_then(|j| scales.get(j)).map(|s| TermScale::from(*s));
    let numbers = effect.form().named_joints(robot, place);
    let sigma = vec![0.0; amplitude.len()];
    Some(EffectTerm {
        effect,
        place,
        joints: numbers.iter().map(|j| j + 1).collect(),
        shape,
        amplitude,
        sigma,
        scale,
        wrenches: Vec::new(),
    })
}

/// A cube of 6 cm and 1 kg beside the origin of its frame.
fn body(random: &mut Random) -> Vec<f64> {
    let [x, y, z] = [0.0; 3].map(|_| random.within(-0.1, 0.1));
    let own = 0.06 * 0.06 / 6.0;
    let (xx, yy, zz) = (own + y * y + z * z, own + x * x + z * z, own + x * x + y * y);
    vec![xx, -x * y, -x * z, yy, -y * z, zz, x, y, z, 1.0]
}

/// Whether an effect is at a place that is no joint's.
pub fn is_of_the_robot(place: Place) -> bool {
    place.joint().is_none()
}
