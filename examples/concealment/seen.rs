//! The page of what can be seen of each effect.

use std::fmt::Write;

use dynid_runtime::effects::EffectKind;
use dynid_runtime::report::significant;

use crate::case::Case;
use crate::hide::Hidden;
use crate::hiding;
use crate::options::Options;
use crate::size::SIZES;
use crate::words::{about_sizes, command, line, median};

/// What of every effect can be seen, robot by robot, and how much of it that takes.
pub fn what_can_be_seen(
    cases: &[Case],
    seen: &[Option<Vec<Hidden>>],
    options: &Options,
    minutes: f64,
) -> String {
    let mut text = String::from("# What can be seen of a hidden effect\n\n");
    let _ = writeln!(
        text,
        "Each effect of the catalogue in simulated robots, on random joints and motions: how much of it there must be to \
         be seen. No diagnosis takes part.\n\n```\n{} --visible{}\n```\n\n{} cases took {minutes:.1} minutes on {} threads.\n",
        command(options),
        options.out.as_ref().map_or_else(String::new, |path| format!(" --out {}", path.display())),
        cases.len(),
        options.threads
    );
    about_sizes(&mut text);
    line(
        &mut text,
        "In each cell the visible size, and the magnitude that it takes; medians over the seeds (of an even number of seeds the upper one).\n",
    );
    let columns: Vec<(&String, usize)> = options
        .robots
        .iter()
        .flat_map(|r| (0..SIZES.len()).map(move |s| (r, s)))
        .filter(|(_, s)| options.sizes.iter().any(|name| name == SIZES[*s]))
        .collect();
    let header: Vec<String> = columns.iter().map(|(r, s)| format!("{r}, {}", SIZES[*s])).collect();
    let _ = writeln!(text, "| effect | magnitude | {} |", header.join(" | "));
    line(&mut text, &format!("|---|---|{}", "---|".repeat(columns.len())));
    for effect in EffectKind::ALL {
        let cells: Vec<String> =
            columns.iter().map(|(robot, size)| seen_cell(cases, seen, effect, robot, *size)).collect();
        if cells.iter().any(|cell| cell != "-") {
            let _ = writeln!(
                text,
                "| {} | {} | {} |",
                effect.id(),
                hiding::of(effect).map_or("", |h| h.counts),
                cells.join(" | ")
            );
        }
    }
    text
}

/// Medians of what of an effect can be seen in the cases of a robot and size, and of the magnitude that it takes.
fn seen_cell(
    cases: &[Case],
    seen: &[Option<Vec<Hidden>>],
    effect: EffectKind,
    robot: &str,
    size: usize,
) -> String {
    let own: Vec<&Hidden> = (cases.iter().zip(seen))
        .filter(|(c, _)| c.robot == robot && c.size == size)
        .filter_map(|(_, hidden)| hidden.as_ref()?.iter().find(|h| h.effect == effect))
        .collect();
    if own.is_empty() {
        return "-".to_owned();
    }
    let visible = median(own.iter().map(|h| h.visible).collect());
    let magnitude = median(own.iter().map(|h| h.magnitude).collect());
    format!("{visible:.1} ({})", significant(magnitude, 2))
}
