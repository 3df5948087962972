//! What `challenge` prints and writes: the table, the cases in detail, the score.

use dynid_runtime::diagnosis::Diagnosis;
use dynid_runtime::diagnosis::scoring::{LEAST_GAP, Scored, TestErrors, label};
use dynid_runtime::report::{percent, significant};

use crate::output::table;

/// The table of the cases, and how many are solved.
pub(super) fn summary(scores: &[Scored]) -> String {
    let rows = scores.iter().map(row).collect();
    let header = [
        "<case",
        "<named",
        "<missed",
        "<false alarms",
        "before",
        "after",
        "true effect",
        "gap closed",
        "s",
        "<",
    ];
    let mut text = table(&header, rows);
    for s in scores {
        if let Some(reason) = &s.refused {
            text.push_str(&format!("\n{}: no diagnosis: {reason}", s.case));
        }
    }
    let judged = |by_naming: bool| {
        let of: Vec<bool> =
            scores.iter().filter(|s| s.gap_closed.is_none() == by_naming).filter_map(|s| s.solved).collect();
        (of.iter().filter(|solved| **solved).count(), of.len())
    };
    let ((naming, by_naming), (test, by_test)) = (judged(true), judged(false));
    text.push_str(&format!(
        "\n\n{} of {} cases solved: {test} of {by_test} judged by naming and by the error on test.yaml, {naming} of \
         {by_naming} by naming only (nothing hidden, or a gap on test.yaml below {} of the error)",
        naming + test,
        by_naming + by_test,
        percent(LEAST_GAP)
    ));
    text
}

/// A case in the table.
fn row(s: &Scored) -> Vec<String> {
    let words = |list: &[String]| list.join(" ");
    let error =
        |get: fn(&TestErrors) -> Option<f64>| s.test.as_ref().and_then(get).map_or("-".into(), percent);
    let verdict = match (s.solved, s.gap_closed) {
        (None, _) => "no truth",
        (Some(true), Some(_)) => "solved",
        (Some(true), None) => "solved, by naming",
        (Some(false), _) => "not solved",
    };
    vec![
        s.case.clone(),
        words(&s.naming.named),
        words(&s.naming.missed),
        words(&s.naming.false_alarms),
        error(|t| Some(t.before)),
        error(|t| Some(t.after)),
        error(|t| t.true_effect),
        s.gap_closed.map_or_else(|| "-".to_owned(), percent),
        significant(s.seconds, 2),
        verdict.to_owned(),
    ]
}

/// What was found in a case and what was considered; `None` where there is no diagnosis.
pub(super) fn details(name: &str, found: Option<&Diagnosis>) -> String {
    let mut text = format!("\n{name}");
    let Some(found) = found else { return text };
    for line in &found.verdict {
        text.push_str(&format!("\n  {line}"));
    }
    for f in &found.findings {
        let numbers: Vec<String> = f
            .parameters
            .iter()
            .map(|(name, p)| {
                format!("{name} {} +- {} {}", significant(p.value, 4), significant(p.sigma, 2), p.unit)
            })
            .collect();
        text.push_str(&format!(
            "\n  {}: share {}, confidence {:.4}; {}",
            label(&f.effect, &f.joints),
            percent(f.share),
            f.confidence,
            numbers.join(", ")
        ));
        for a in &f.alternatives {
            text.push_str(&format!("\n    not {}: {}", label(&a.effect, &a.joints), a.why_not));
        }
    }
    for c in &found.cannot_tell {
        text.push_str(&format!("\n  cannot tell {}", label(&c.sides().join(" from "), &c.joints)));
    }
    for m in &found.mismatch {
        text.push_str(&format!("\n  joint {}: {} of the mismatch, {}", m.joint, percent(m.share), m.where_));
    }
    text.push_str(&format!(
        "\n  held out ({}) {} -> {}, skew {} ms, unexplained {}",
        found.held_out.how,
        percent(found.held_out.before),
        percent(found.held_out.after),
        significant(1e3 * found.delay, 3),
        percent(found.unexplained.share)
    ));
    text
}

/// The score for other programs.
pub(super) fn for_programs(scores: &[Scored]) -> serde_json::Value {
    let count = |holds: &dyn Fn(&Scored) -> bool| scores.iter().filter(|s| holds(s)).count();
    let judged = |s: &Scored| s.solved.is_some();
    serde_json::json!({
        "cases": scores,
        "solved": count(&|s| s.solved == Some(true)),
        "judged": count(&judged),
        "judged_by_naming_only": count(&|s| judged(s) && s.gap_closed.is_none()),
        "solved_by_naming_only": count(&|s| s.solved == Some(true) && s.gap_closed.is_none()),
    })
}
