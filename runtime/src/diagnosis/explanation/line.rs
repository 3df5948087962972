//! Torque ripple that was seen as lines, as findings.

use crate::diagnosis::candidates::order_line::Line;
use crate::diagnosis::explanation::finding::{named_on, told, unit_term};
use crate::diagnosis::explanation::quantities::propagate;
use crate::diagnosis::explanation::words;
use crate::diagnosis::outcome::Finding;
use crate::diagnosis::search::state::Search;
use crate::diagnosis::settings::Settings;
use crate::effects::{EffectKind, EffectTerm, Form, Place};

/// One finding per joint with lines that are not in the model already, with all of their orders.
///
/// The amplitudes are those of the full rate: rows may be smoothed or filtered more than the wave can take.
pub(in crate::diagnosis) fn findings(search: &Search<'_>, settings: &Settings) -> Vec<Finding> {
    let of_joint = |(j, lines): (usize, Vec<&Line>)| finding(search, j, &lines);
    search.lines_beside_model(settings).into_iter().filter_map(of_joint).collect()
}

/// The lines of a joint as a finding, strongest first.
fn finding(search: &Search<'_>, joint: usize, lines: &[&Line]) -> Option<Finding> {
    let (model, found) = (&search.model, &search.lines[joint]);
    let (effect, place) = (EffectKind::TorqueRipple, Place::Joint(joint));
    let strongest = lines.first()?;
    let shape: Vec<f64> = lines.iter().map(|l| l.order).collect();
    let amplitude: Vec<f64> = lines.iter().flat_map(|l| [l.cosine, l.sine]).collect();
    let sigma: Vec<f64> = lines.iter().flat_map(|l| [l.sigma; 2]).collect();
    let scale = &model.context.scales[joint];
    let Form::Joint(law) = effect.form() else { return None };
    // A wave's phase at both ends of what was travelled tells its order (the Cramer-Rao bound of a sine's frequency).
    let of_order = |l: &&Line| 1.0 / (l.above * found.spread).max(1e-300);
    let shape_sigma: Vec<f64> = lines.iter().map(of_order).collect();
    let parameters =
        propagate(|shape| law.parameters(scale, shape, &amplitude, &sigma), &shape, &shape_sigma);
    let share: f64 = lines.iter().map(|l| l.share).sum::<f64>().min(1.0);
    let before = strongest.rms / found.torque.max(1e-300);
    let mut finding = Finding {
        confidence: told(1.0 - search.doubt(strongest)),
        significance: strongest.above,
        parameters: parameters.iter().map(|p| (p.name.clone(), p.into())).collect(),
        held_out_before: before,
        held_out_after: before * (1.0 - share).sqrt(),
        share,
        ..Finding::of(EffectTerm {
            joints: named_on(model.context.model.robot(), effect, place),
            amplitude,
            sigma,
            scale: Some(model.context.scales[joint].into()),
            ..unit_term(effect, place, shape)
        })
    };
    finding.sentence = words::sentence(model.context.model.robot(), effect, &finding);
    Some(finding)
}
