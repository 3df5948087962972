//! `dynid excite ROBOT --tell A,B --joint J`: the motion that tells laws of a joint apart.

use dynid_runtime::diagnosis::Distances;
use dynid_runtime::effects::EffectKind;
use dynid_runtime::model::{JointNumber, Model, Robot};
use dynid_runtime::report::{capital, significant};
use dynid_runtime::simulation::excitation::{TellError, TellPlan, TellSettings, Told, tell};
use dynid_runtime::simulation::{Reference, to_csv};

use super::{Arguments, MOST_ROWS};
use crate::commands::effects::effect_named;
use crate::failure::Failure;
use crate::motions::{PLAN, PlannedMotion, plan_text, to_svg};
use crate::output::{Together, print, table};
use crate::words::effect_words;

/// Motions that are printed beside the best.
const PRINTED: usize = 12;

/// Chooses, prints, writes.
pub(super) fn run(
    arguments: &Arguments,
    model: &dyn Model,
    chi: Option<&[f64]>,
    joint: usize,
) -> Result<(), Failure> {
    let robot = model.robot();
    let settings = settings(arguments, robot, joint)?;
    let mut files = Together::in_folder(&arguments.out)?;
    let plan = tell(model, chi, &settings).map_err(|error| match error {
        TellError::Motion(_) | TellError::NoLaw(_) => Failure::Input(format!("{}: {error}", robot.name)),
        other => Failure::Data(format!("{}: {other}", robot.name)),
    })?;
    let Some(best) = plan.candidates.first() else { return Ok(()) };
    if best.motion.duration() * arguments.rate > MOST_ROWS {
        return Err(Failure::Input(format!(
            "--rate {}: the motion would have more than {MOST_ROWS:e} rows",
            arguments.rate
        )));
    }
    let rows = to_csv(&best.motion, arguments.rate);
    let figure = to_svg(&best.motion, robot, &format!("{}: {}", robot.name, best.what));
    let named = PlannedMotion {
        file: files.add("motion1", "csv", &mut |out| out.write_all(rows.as_bytes()))?,
        figure: files.add("motion1", "svg", &mut |out| out.write_all(figure.as_bytes()))?,
    };
    files.commit(PLAN, &plan_text(&robot.name, &[named]), &["motion"])?;
    print(&summary(&plan, best, arguments, joint));
    Ok(())
}

fn settings(arguments: &Arguments, robot: &Robot, joint: usize) -> Result<TellSettings, Failure> {
    let wrong = |what: String| Err(Failure::Input(what));
    let mut effects: Vec<EffectKind> = Vec::new();
    for id in &arguments.tell {
        let effect = effect_named(id)?;
        if effects.contains(&effect) {
            return wrong(format!("--tell: {id} is there twice"));
        }
        effects.push(effect);
    }
    if effects.len() < 2 {
        return wrong("--tell: two laws at least, as in --tell stribeck,presliding_hysteresis".to_owned());
    }
    let Some(index) = robot.joint_index(JointNumber(joint)) else {
        return wrong(format!("--joint {joint}: {} has no such joint", robot.name));
    };
    let (share, reach) = (arguments.motions.share, arguments.motions.reach);
    Ok(TellSettings { effects, joint: index.0, share, reach, seed: arguments.seed })
}

fn summary(plan: &TellPlan, best: &Told, arguments: &Arguments, joint: usize) -> String {
    let names: Vec<String> = plan.laws.iter().map(|law| effect_words(law.effect.id())).collect();
    let mut text = format!(
        "{} on joint {joint} of {}: a motion that tells them apart, in {}\n{}, {} s\n\n",
        capital(&names.join(" or ")),
        arguments.robot,
        arguments.out.display(),
        capital(&best.what),
        significant(best.motion.duration(), 3),
    );
    text.push_str(&format!(
        "How far each law is from what the standard model and the other make of it, in multiples of the noise ({}), for \
         laws as large as {} in an ordinary motion:\n\n",
        significant(plan.noise, 2),
        significant(plan.size, 3),
    ));
    let count = plan.laws.len();
    let pairs: Vec<[usize; 2]> =
        (0..count).flat_map(|a| (0..count).filter(move |&b| b != a).map(move |b| [a, b])).collect();
    let mut header = vec!["<motion".to_owned(), "s".to_owned(), "least".to_owned()];
    header.extend(pairs.iter().map(|&[a, b]| format!("{} from {}", names[a], names[b])));
    let rows = plan.candidates.iter().take(PRINTED).chain([&plan.ordinary]).map(|told| {
        let mut row = vec![
            told.what.clone(),
            significant(told.motion.duration(), 3),
            significant(told.distances.least(), 3),
        ];
        row.extend(pairs.iter().map(|&pair| cell(&told.distances, pair)));
        row
    });
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    text.push_str(&table(&header, rows.collect()));
    if plan.candidates.len() > PRINTED {
        text.push_str(&format!("\n\nand {} that tell less", plan.candidates.len() - PRINTED));
    }
    text
}

/// A distance; one law may contain the other.
fn cell(distances: &Distances, [a, b]: [usize; 2]) -> String {
    distances.apart[a][b].map_or_else(|| "contained".to_owned(), |d| significant(d, 3))
}
