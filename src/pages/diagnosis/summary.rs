//! What `diagnose` prints.

use dynid_runtime::diagnosis::{Diagnosis, Finding};
use dynid_runtime::effects::unit_behind;
use dynid_runtime::report::{capital, percent, significant};

use super::extras::Extras;
use super::page::error_rows;
use crate::errors::noise_words;
use crate::output::table;
use crate::recorded::{Measured, left_out_words, titled};
use crate::words::{
    apart_words, confidence_words, effect_words, joint_words, part_words, small_words, standing_words,
    transient_words,
};

/// The verdict, the errors and the findings for a terminal.
pub fn summary(measured: &Measured, diagnosis: &Diagnosis, extras: &Extras) -> String {
    let mut text = format!("{}\n", titled(&diagnosis.robot, &measured.title));
    for line in left_out_words(&measured.rows) {
        text.push_str(&format!("{line}\n"));
    }
    text.push('\n');
    for sentence in &diagnosis.verdict {
        text.push_str(&format!("{sentence}\n"));
    }
    text.push('\n');
    let header = ["<relative error of the torques", "<band", "before", "after"];
    text.push_str(&table(&header, error_rows(diagnosis, extras)));
    let fitted = extras.evaluation().into_iter().map(|evaluation| ("fitted motion", evaluation));
    let tested = extras.tested.iter().map(|t| ("test recording", &t.evaluation));
    for (which, evaluation) in fitted.chain(tested) {
        if let Some(words) = noise_words(evaluation) {
            text.push_str(&format!("\n{which}: {words}"));
        }
    }
    if let Some(Err(reason)) = &extras.forward {
        text.push_str(&format!("\n{reason}"));
    }
    for finding in &diagnosis.findings {
        text.push_str(&found(finding));
    }
    for c in &diagnosis.cannot_tell {
        text.push_str(&format!("\n\ncannot tell {} apart: {}", apart_words(c, " and "), c.experiment));
    }
    if !diagnosis.standing.is_empty() {
        text.push_str(&format!("\n\nalso missing in both: {}", standing_words(diagnosis)));
    }
    if !diagnosis.transients.is_empty() {
        let transients: Vec<String> = diagnosis.transients.iter().map(transient_words).collect();
        text.push_str(&format!("\n\nalso there, and not told from an event: {}", transients.join("; ")));
    }
    if !diagnosis.small.is_empty() {
        let small: Vec<String> = diagnosis.small.iter().map(small_words).collect();
        text.push_str(&format!("\n\nalso there, and too small to be named: {}", small.join("; ")));
    }
    text
}

fn found(finding: &Finding) -> String {
    let mut text = String::new();
    text.push_str(&format!(
        "\n\n{} on {}\n",
        capital(&effect_words(&finding.effect)),
        joint_words(&finding.joints)
    ));
    text.push_str(&format!("  {}\n", finding.sentence));
    let numbers: Vec<String> = finding
        .parameters
        .iter()
        .map(|(name, p)| {
            let sigma =
                if p.sigma > 0.0 { format!(" +- {}", significant(p.sigma, 2)) } else { String::new() };
            let unit = unit_behind(&p.unit);
            let counts = p.unit == "1" && p.sigma == 0.0 && p.value.fract() == 0.0;
            let value = if counts { p.value.to_string() } else { significant(p.value, 4) };
            format!("{name} {value}{sigma}{unit}")
        })
        .collect();
    text.push_str(&format!("  {}\n", numbers.join(", ")));
    text.push_str(&format!(
        "  held-out error of its joints {} -> {}, {}",
        percent(finding.held_out_before),
        percent(finding.held_out_after),
        confidence_words(finding.confidence)
    ));
    if let Some(on_test) = &finding.on_test {
        text.push_str(&format!("\n  on the test recording {}", part_words(on_test)));
    }
    text
}
