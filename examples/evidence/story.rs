//! The stories in words: what was hidden, how it was found, what it turned out to be, and whether it held.

use std::fmt::Write as _;

use dynid_runtime::diagnosis::{Diagnosis, Finding};
use dynid_runtime::effects::EffectKind;
use dynid_runtime::prediction::Evaluation;
use dynid_runtime::report::{percent, significant};

use crate::figures::joint_number;
use crate::stories::{Goal, Story};

/// A story with its outcome.
pub struct Told<'a> {
    /// Which.
    pub story: &'a Story,
    /// What was found.
    pub found: &'a Diagnosis,
    /// The standard model as it is identified, that of the diagnosis, and the model with the findings on the part that
    /// took no part.
    pub compared: &'a Evaluation,
    /// Name and file of each figure.
    pub pictures: &'a [(&'static str, String)],
    /// What the other parts say.
    pub parts: &'a [Part],
}

/// What one part of a recording says when it is diagnosed for itself.
pub struct Part {
    /// Where it begins and ends, s.
    pub span: (f64, f64),
    /// What is named on it.
    pub named: Vec<String>,
    /// Errors on the rest of the recording, of the standard model and with what was found; `None`: there is no rest.
    pub rest: Option<[f64; 2]>,
}

/// The page.
pub fn page(stories: &[String]) -> String {
    let mut text = String::from(
        "# Evidence on real recordings\n\nWhat the standard model (rigid links, rotors, viscous and Coulomb friction, \
         offsets) leaves out in three public recordings, found by `dynid diagnose` without a hint. The diagnosis sees one \
         part of each recording; the other part is predicted afterwards, once. Errors are |measured - predicted| / \
         |measured| of the torques, all joints together unless a joint is named.\n\nThe rules of the diagnosis were chosen by people who had seen \
         these recordings and their errors on both parts. Those for short recordings were chosen with the TX-40's second \
         part and the Panda in view: these are development data, not an independent test. Every number on this page, every \
         figure, and every statement whether a goal was reached was written by\n\n```\ncargo run --release --example evidence -- ../shared/data --out docs\n```\n\n",
    );
    text.push_str(&stories.join("\n"));
    text
}

/// One story.
pub fn told(told: &Told<'_>) -> String {
    let Told { story, found, compared, .. } = told;
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(text, "## {}\n\n{} {}\n", story.title, story.recorded, story.divided);
    located(&mut text, told);
    if found.findings.is_empty() {
        text.push_str("### What was found\n\nNothing.\n\n");
    } else {
        named(&mut text, told);
        shifts(&mut text, found);
    }
    proof(&mut text, story, compared, picture(told, "held_out"));
    parts(&mut text, told.parts);
    open(&mut text, found);
    text
}

fn picture<'a>(told: &'a Told<'_>, name: &str) -> Option<&'a str> {
    told.pictures.iter().find(|(known, _)| *known == name).map(|(_, file)| file.as_str())
}

fn located(text: &mut String, told: &Told<'_>) {
    let found = told.found;
    let _ = writeln!(
        text,
        "### Where the standard model fails\n\nOn the part that is diagnosed the standard model leaves {} in sample. {} \
         candidates, each an effect at a place with all of its shapes, were tried.\n",
        percent(found.before.relative_error),
        found.tried
    );
    text.push_str("| joint | error of the standard model | share of what is unexplained | where it lives |\n|---|---|---|---|\n");
    for m in &found.mismatch {
        let error = found.before.per_joint.get(m.joint - 1).copied().flatten();
        let _ = writeln!(text, "| {} | {} | {} | {} |", m.joint, percent(error), percent(m.share), m.where_);
    }
    text.push('\n');
}

fn named(text: &mut String, told: &Told<'_>) {
    text.push_str("### What was found\n\n");
    for line in &told.found.verdict {
        let _ = writeln!(text, "{line}");
    }
    text.push('\n');
    if let Some(file) = picture(told, "findings") {
        let _ = writeln!(text, "![residuals and laws]({file})\n");
    }
    for finding in &told.found.findings {
        finding_words(text, finding);
    }
    transients(text, told.found);
}

fn finding_words(text: &mut String, finding: &Finding) {
    let title = EffectKind::title_of(&finding.effect);
    let numbers: Vec<String> = finding
        .parameters
        .iter()
        .map(|(name, p)| {
            let sigma =
                if p.sigma > 0.0 { format!(" ± {}", significant(p.sigma, 2)) } else { String::new() };
            format!("{name} {}{sigma} {}", significant(p.value, 3), p.unit)
        })
        .collect();
    let _ = writeln!(
        text,
        "- **{title}.** {} ({}; confidence {}.)",
        finding.sentence,
        numbers.join(", "),
        significant(finding.confidence, 2)
    );
    let others: Vec<String> = (finding.alternatives.iter().take(3))
        .map(|a| {
            let on: Vec<String> = a.joints.iter().map(ToString::to_string).collect();
            let place = if on.is_empty() { String::new() } else { format!(" on joint {}", on.join(" and ")) };
            format!("{}{place}, which {}", a.effect, a.why_not)
        })
        .collect();
    if !others.is_empty() {
        let _ = writeln!(text, "  Considered instead: {}.", others.join("; "));
    }
}

fn transients(text: &mut String, found: &Diagnosis) {
    for transient in &found.transients {
        let joints: Vec<String> = transient.joints.iter().map(ToString::to_string).collect();
        let _ = writeln!(
            text,
            "\nNot named, because nothing tells it from an event, and in the model all the same, so that parameters and laws are \
             those of the motion after it: {} on joint {}, which has faded after {} s.",
            EffectKind::name_of(&transient.effect),
            joints.join(" and "),
            significant(transient.faded_after, 2)
        );
    }
}

fn shifts(text: &mut String, found: &Diagnosis) {
    if found.shifts.is_empty() {
        return;
    }
    text.push_str(
        "\nParameters that the missing physics had biased:\n\n| parameter | before | after | unit |\n|---|---|---|---|\n",
    );
    for s in &found.shifts {
        let _ = writeln!(
            text,
            "| {} | {} ± {} | {} ± {} | {} |",
            s.name,
            significant(s.before, 3),
            significant(s.sigma_before, 2),
            significant(s.after, 3),
            significant(s.sigma_after, 2),
            s.unit
        );
    }
    text.push('\n');
}

/// The models of an evaluation, in its order.
const MODELS: [&str; 3] = [
    "standard model, `dynid identify`",
    "standard model of the diagnosis, skew taken out",
    "with what was found",
];

fn proof(text: &mut String, story: &Story, compared: &Evaluation, picture: Option<&str>) {
    let _ = writeln!(
        text,
        "### The part that took no part\n\n```\n{}\n```\n\n{} equations of {} Hz bandwidth, {} left out where the joint \
         hardly moves: the same for every model.\n",
        story.commands.join("\n"),
        compared.used(),
        significant(compared.band, 3),
        compared.standing()
    );
    text.push_str("| model | error | above the noise | ratio |\n|---|---|---|---|\n");
    let whole =
        |k: usize| compared.predictions.get(k).and_then(|p| p.errors.relative_error).unwrap_or(f64::NAN);
    for (k, (name, prediction)) in MODELS.iter().zip(&compared.predictions).enumerate() {
        let above = prediction.above_noise().map(|above| above.relative_error);
        let _ = writeln!(
            text,
            "| {name} | {} | {} | {:.2} |",
            percent(whole(k)),
            above.map_or_else(|| "-".to_owned(), percent),
            whole(k) / whole(0)
        );
    }
    if let Some(noise) = compared.predictions.last().and_then(|p| p.noise.as_ref()) {
        let _ = writeln!(
            text,
            "\nNoise of the torques in this band, as the last model has it: {}.",
            percent(noise.relative_error)
        );
    }
    text.push_str("\n| joint | standard model | with what was found | noise |\n|---|---|---|---|\n");
    let (Some(first), Some(last)) = (compared.predictions.first(), compared.predictions.last()) else {
        return;
    };
    for (j, (before, after)) in first.errors.per_joint.iter().zip(&last.errors.per_joint).enumerate() {
        let noise = last.noise.as_ref().and_then(|n| n.per_joint.get(j));
        let noise = noise.map_or_else(|| "-".to_owned(), |n| percent(*n));
        let _ = writeln!(
            text,
            "| {} | {} | {} | {noise} |",
            joint_number(compared, j),
            percent(*before),
            percent(*after)
        );
    }
    if let Some(file) = picture {
        let _ = writeln!(text, "\n![what is left of the torques]({file})");
    }
    goal(text, story, whole(0), whole(compared.predictions.len() - 1));
}

/// Whether the goal was reached, in the figures of the table.
fn goal(text: &mut String, story: &Story, before: f64, after: f64) {
    let (what, most, is) = match story.goal {
        None => return,
        Some(Goal::Ratio(most)) => ("a ratio", most.to_string(), (after / before, most)),
        Some(Goal::Error(most)) => ("an error", percent(most), (after, most)),
    };
    let reached = if is.0 <= is.1 { "reached" } else { "missed" };
    let here = match story.goal {
        Some(Goal::Error(_)) => percent(is.0),
        Some(Goal::Ratio(_)) | None => format!("{:.2}", is.0),
    };
    let _ = writeln!(text, "\nThe goal was {what} of {most} at most; here it is {here}: {reached}.");
}

fn parts(text: &mut String, parts: &[Part]) {
    if parts.is_empty() {
        return;
    }
    text.push_str(
        "\n### The same on other parts\n\nEach part is diagnosed for itself; the rest of the recording is predicted, as \
         above.\n\n| part | named | rest, standard model | rest, with what was found |\n|---|---|---|---|\n",
    );
    for part in parts {
        let rest = part.rest.map(|r| r.map(percent));
        let [before, after] = rest.unwrap_or_else(|| ["-".into(), "-".into()]);
        let (from, to) = part.span;
        let _ = writeln!(text, "| {from} to {to} s | {} | {before} | {after} |", part.named.join(", "));
    }
}

fn open(text: &mut String, found: &Diagnosis) {
    text.push_str("\n### What stays open\n\n");
    let _ = writeln!(
        text,
        "{} of the squared error that remains on held-out motion is more than noise.",
        percent(found.unexplained.share)
    );
    for c in &found.cannot_tell {
        let on: Vec<String> = c.joints.iter().map(ToString::to_string).collect();
        let _ = writeln!(
            text,
            "\nThis motion cannot tell {} on joint {} apart. To tell: {}.",
            c.between.join(" from "),
            on.join(" and "),
            c.experiment
        );
    }
    text.push('\n');
}
