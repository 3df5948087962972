//! The option `--effect ID:JOINT[:SIZE]`.

use dynid_runtime::effects::{EffectTerm, Form, Place, unit_behind};
use dynid_runtime::model::{JointIndex, JointNumber, Model};
use dynid_runtime::report::{capital, significant};
use dynid_runtime::simulation::excitation::{TellError, typical_law};

use crate::commands::effects::effect_named;
use crate::failure::Failure;
use crate::ranges;
use crate::words::{effect_words, joint_number};

/// The law of a joint that a value of the option is for, in a robot with the base parameters `chi`. It depends on the robot
/// alone, so that recordings with other seeds have the same.
pub(super) fn hidden_law(model: &dyn Model, chi: &[f64], text: &str) -> Result<EffectTerm, Failure> {
    let wrong = || {
        Failure::Input(format!("--effect {text}: expected ID:JOINT[:SIZE], as stribeck:1 or stribeck:1:2.5"))
    };
    let robot = model.robot();
    let fields: Vec<&str> = text.split(':').collect();
    let (id, number, size) = match fields[..] {
        [id, number] => (id, number, None),
        [id, number, size] => (id, number, Some(size)),
        _ => return Err(wrong()),
    };
    let effect = effect_named(id)?;
    if !matches!(effect.form(), Form::Joint(_)) {
        let how = effect.words().put_in;
        return Err(Failure::Input(format!("--effect {text}: {id} is no law of a joint, but {how}")));
    }
    let number: usize = number.parse().map_err(|_| wrong())?;
    let JointIndex(joint) = robot.joint_index(JointNumber(number)).ok_or_else(|| {
        let known: Vec<String> = (0..robot.joints()).map(|j| joint_number(robot, j)).collect();
        Failure::Input(format!(
            "--effect {text}: the joints of {} are {}, not {number}",
            robot.name,
            known.join(", ")
        ))
    })?;
    let size = size.map(ranges::law_size).transpose();
    let size = size.map_err(|why| Failure::Input(format!("--effect {text}: size: {why}")))?;
    typical_law(model, chi, (effect, joint), size).map_err(|error| match error {
        TellError::Rows(error) => Failure::Data(error.to_string()),
        other => Failure::Input(format!("--effect {text}: {other}")),
    })
}

/// What was hidden, with its numbers.
pub(super) fn words(term: &EffectTerm) -> String {
    let Form::Joint(law) = term.effect.form() else { return String::new() };
    let (Some(scale), Place::Joint(_)) = (term.scale, term.place) else { return String::new() };
    let quantities = law.parameters(&scale.into(), &term.shape, &term.amplitude, &term.sigma);
    let each: Vec<String> = quantities
        .iter()
        .map(|q| format!("{} {}{}", q.name, significant(q.value, 4), unit_behind(&q.unit)))
        .collect();
    let joints: Vec<String> = term.joints.iter().map(ToString::to_string).collect();
    format!("{} on joint {}: {}", capital(&effect_words(term.id())), joints.join(", "), each.join(", "))
}
