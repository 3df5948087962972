//! Torque ripple that was seen as lines, as findings.

use crate::diagnosis::candidates::order_line::Line;
use crate::diagnosis::explanation::finding::{named_on, told, unit_term};
use crate::diagnosis::explanation::quantities::propagate;
use crate::diagnosis::explanation::words;
use crate::diagnosis::outcome::Finding;
use crate::diagnosis::rules::LINE_COVERED;
use crate::diagnosis::search::line::JointLines;
use crate::diagnosis::search::state::Search;
use crate::diagnosis::settings::Settings;
use crate::effects::{EffectKind, EffectTerm, Form, Place};

/// One finding per joint with lines that are not in the model already, with all of their orders.
///
/// The amplitudes are those of the full rate: rows may be smoothed or filtered more than the wave can take.
pub(in crate::diagnosis) fn findings(search: &Search<'_>, settings: &Settings) -> Vec<Finding> {
    let of_all = |number: fn(&JointLines) -> usize| search.lines.iter().map(number).sum::<usize>() as f64;
    let (known, tried) = (of_all(|lines| lines.known), of_all(|lines| lines.tried));
    let level = 1.0 - settings.confidence_of_one_search();
    let doubt = |line: &Line| if line.known { known } else { tried } * line.p_value;
    let of_joint = |(j, found): (usize, &JointLines)| {
        let sure: Vec<&Line> = found.lines.iter().filter(|line| doubt(line) <= level).collect();
        finding(search, j, (found, sure), doubt)
    };
    search.lines.iter().enumerate().filter_map(of_joint).collect()
}

/// The lines of a joint as a finding; `doubt` is the probability that noise has one like it anywhere.
fn finding(
    search: &Search<'_>,
    joint: usize,
    (found, sure): (&JointLines, Vec<&Line>),
    doubt: impl Fn(&Line) -> f64,
) -> Option<Finding> {
    let model = &search.model;
    let (effect, place) = (EffectKind::TorqueRipple, Place::Joint(joint));
    let near = LINE_COVERED as f64 * found.resolution;
    let in_model = |line: &Line| {
        let same = model.terms.iter().filter(|t| t.effect == effect && t.place == place);
        same.flat_map(|t| &t.shape).any(|order| (order - line.order).abs() <= near)
    };
    let lines: Vec<&Line> = sure.into_iter().filter(|l| !in_model(l)).collect();
    let strongest = lines.first()?;
    let shape: Vec<f64> = lines.iter().map(|l| l.order).collect();
    let amplitude: Vec<f64> = lines.iter().flat_map(|l| [l.cosine, l.sine]).collect();
    let sigma: Vec<f64> = lines.iter().flat_map(|l| [l.sigma; 2]).collect();
    let scale = &model.context.scales[joint];
    let Form::Joint(law) = effect.form() else { return None };
    // A wave's phase at both ends of what was travelled tells its order (the Cramer-Rao bound of a sine's frequency).
    let of_order = |l: &&Line| l.sigma / (l.amplitude() * found.spread).max(1e-300);
    let shape_sigma: Vec<f64> = lines.iter().map(of_order).collect();
    let parameters =
        propagate(|shape| law.parameters(scale, shape, &amplitude, &sigma), &shape, &shape_sigma);
    let share: f64 = lines.iter().map(|l| l.share).sum::<f64>().min(1.0);
    let before = strongest.rms / found.torque.max(1e-300);
    let mut finding = Finding {
        confidence: told(1.0 - doubt(strongest)),
        significance: strongest.amplitude() / strongest.sigma.max(1e-300),
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
