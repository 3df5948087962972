//! Whether confidence and standard deviations mean what they say.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::score::Score;
use crate::words::line;

/// Edges between classes of confidence.
const EDGES: [f64; 5] = [0.0, 0.9, 0.93, 0.939, 1.01];

/// Standard deviations of an interval that holds 95 of 100.
const INTERVAL: f64 = 1.96;

/// Findings that are true by what confidence they were told with, and how often the intervals of numbers hold the truth.
pub fn calibration(text: &mut String, scores: &[Score]) {
    line(text, "## Confidence and intervals\n");
    line(text, "| told with | findings | true | a false one in |");
    line(text, "|---|---|---|---|");
    let told: Vec<(f64, bool)> = scores.iter().flat_map(|s| s.told.iter().copied()).collect();
    for edge in EDGES.windows(2) {
        let class: Vec<bool> =
            told.iter().filter(|(c, _)| (edge[0]..edge[1]).contains(c)).map(|(_, truth)| *truth).collect();
        let words = match edge {
            [low, _] if *low == 0.0 => format!("less than {}", edge[1]),
            [low, high] if *high > 1.0 => format!("{low} and more"),
            _ => format!("{} to {}", edge[0], edge[1]),
        };
        let right = class.iter().filter(|truth| **truth).count();
        let wrong = class.len() - right;
        let rarity =
            if wrong == 0 { "-".to_owned() } else { format!("{:.0}", class.len() as f64 / wrong as f64) };
        let _ = writeln!(text, "| {words} | {} | {right} | {rarity} |", class.len());
    }
    text.push('\n');
    let mut quantities: BTreeMap<(&str, &str), Vec<f64>> = BTreeMap::new();
    for (effect, quantity, deviation) in scores.iter().flat_map(|s| &s.numbers) {
        quantities.entry((effect, quantity)).or_default().push(*deviation);
    }
    if quantities.is_empty() {
        return;
    }
    line(
        text,
        "Of the numbers of effects that were named, those that are within 1.96 of their own standard deviations of the \
         truth; 95 of 100 are expected. In the last column the median distance, 0.67 expected.\n",
    );
    line(text, "| effect | number | within | median distance |");
    line(text, "|---|---|---|---|");
    for ((effect, quantity), mut deviations) in quantities {
        deviations.iter_mut().for_each(|d| *d = d.abs());
        deviations.sort_by(f64::total_cmp);
        let within = deviations.iter().filter(|d| **d <= INTERVAL).count();
        let (count, median) = (deviations.len(), deviations[deviations.len() / 2]);
        let _ = writeln!(text, "| {effect} | {quantity} | {within}/{count} | {median:.2} |");
    }
    text.push('\n');
}
