//! Words that the pages and the lines of progress share.

use std::fmt::Write;

use crate::case::{Before, USUAL_PUSH};
use crate::hide::Hidden;
use crate::options::{Options, Pushed};
use crate::recorder::Recorder;
use crate::score::{Outcome, Score};
use crate::size::VISIBLE;

/// What was hidden, with its magnitude and how much of it can be seen.
pub fn hidden_in_words(hidden: &[Hidden]) -> String {
    let words = |h: &Hidden| {
        format!("{} {:.3} (visible {:.1})", at(h.effect.id(), &joints_of(h)), h.magnitude, h.visible)
    };
    if hidden.is_empty() {
        "nothing".to_owned()
    } else {
        hidden.iter().map(words).collect::<Vec<_>>().join(", ")
    }
}

/// A finished run in a line.
pub fn in_a_line(score: &Score) -> String {
    let hidden: Vec<String> = score
        .hidden
        .iter()
        .map(|(h, outcome)| {
            let what = h.outside.as_ref().map_or(h.effect.id(), |outside| outside.what.as_str());
            let hidden = at(what, &joints_of(h));
            format!("{hidden} (visible {:.1}) {}{}", h.visible, outcome.word(), push_in_words(outcome))
        })
        .collect();
    let mut line = hidden.join(", ");
    if let Some(reason) = &score.refused {
        let _ = write!(line, " refused: {reason}");
    }
    if !score.others.is_empty() {
        let _ = write!(line, " besides: {}", others(score));
    }
    let _ = write!(line, " ({:.1} s)", score.seconds);
    line
}

/// How well a push was told.
fn push_in_words(outcome: &Outcome) -> String {
    outcome.push.map_or_else(String::new, |push| {
        let place = if push.place { "right" } else { "wrong" };
        let error = push.error.map_or_else(String::new, |e| format!(", off by {e:.1} sigma"));
        format!(
            " [overlap {:.2}, {place} place{error}, {} besides, confidence {:.4}]",
            push.overlap, push.besides, push.confidence
        )
    })
}

impl Outcome {
    /// In a word.
    pub fn word(self) -> &'static str {
        match self {
            Outcome { named: true, .. } => "named",
            Outcome { cannot_tell: true, .. } => "cannot tell",
            Outcome { small: true, .. } => "told as small",
            _ => "missed",
        }
    }
}

fn joints_of(hidden: &Hidden) -> Vec<usize> {
    hidden.joint.into_iter().collect()
}

/// An effect and the joints that it is on.
pub fn at(effect: &str, joints: &[usize]) -> String {
    let on: Vec<String> = joints.iter().map(ToString::to_string).collect();
    if on.is_empty() { effect.to_owned() } else { format!("{effect}@{}", on.join("+")) }
}

/// What was found besides what was hidden.
pub fn others(score: &Score) -> String {
    score.others.iter().map(|(effect, joints)| at(effect, joints)).collect::<Vec<_>>().join(" ")
}

/// Adds a line.
pub fn line(text: &mut String, words: &str) {
    text.push_str(words);
    text.push('\n');
}

/// What the sizes mean.
pub fn about_sizes(text: &mut String) {
    let _ = writeln!(
        text,
        "The sizes are relative to what can be seen. *Visible* is the torque of the effect that no refit of the standard \
         parameters can take over, relative to the noise: sqrt(r² - s²)/r0, where r0 is the residual of the standard \
         model without the effect, and r and s are what its parameters leave with the effect and without it on the \
         same motion where sensors have no noise, in a band of 25 Hz or 100 Hz, where it \
         shows more, on the joint where it shows most (a contact: while it lasts). `small` aims at {}, `medium` at {}, \
         `large` at {}; where no robot has that much of an effect, at the most that it may have, and the column says \
         what was seen.\n",
        VISIBLE[0], VISIBLE[1], VISIBLE[2]
    );
}

/// The command that makes a page, up to the file that it goes to.
pub fn command(options: &Options) -> String {
    let mut command = format!(
        "cargo run --release --example concealment -- --robots {} --sizes {} --seeds {}",
        options.robots.join(","),
        options.sizes.join(","),
        options.seeds
    );
    if options.first_seed != 1 {
        let _ = write!(command, " --first-seed {}", options.first_seed);
    }
    if !options.effects.is_empty() {
        let _ = write!(command, " --effects {}", options.effects.join(","));
    }
    if options.together > 1 {
        let _ = write!(command, " --together {}", options.together);
    }
    if options.recorders != [Recorder::White] {
        let names: Vec<String> = options.recorders.iter().map(|r| r.name()).collect();
        let _ = write!(command, " --recorders {}", names.join(","));
    }
    if options.baseline {
        command.push_str(" --baseline");
    }
    match options.reference {
        Some(Before::Model) => command.push_str(" --reference"),
        Some(Before::Motions) => command.push_str(" --reference motions"),
        None => {}
    }
    if options.push == Pushed::Joint {
        command.push_str(" --push joint");
    }
    if options.push_seconds != USUAL_PUSH {
        let _ = write!(command, " --push-seconds {},{}", options.push_seconds[0], options.push_seconds[1]);
    }
    if let Some(seconds) = options.seconds {
        let _ = write!(command, " --seconds {seconds}");
    }
    command
}

/// The upper median; 0 of no values.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
