//! `dynid effects [ID]`: the catalogue of physics that a diagnosis looks for.

mod known;
mod picture;

use std::path::{Path, PathBuf};

use clap::Args;
use dynid_runtime::diagnosis::{DiagnosisError, Portrait, imitators, portrait};
use dynid_runtime::effects::{EffectKind, unit_behind};
use dynid_runtime::recording::meant;
use dynid_runtime::report::{Plot, Role, SeriesKind, alone, significant};

use crate::failure::Failure;
use crate::models;
use crate::output::{print, table, write, write_json};
use known::{About, Known, axis, put_in, sought, thinned};
use picture::picture;

/// Which effect.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Id of an effect, as a diagnosis tells it [default: a table of all]
    id: Option<String>,
    /// Write what is known of it for other programs; `-` is standard output
    #[arg(long)]
    json: Option<PathBuf>,
    /// Write the picture of its law as SVG
    #[arg(long, requires = "id")]
    svg: Option<PathBuf>,
}

/// The robot that laws are drawn on, and their largest torque, N.m.
const ROBOT: &str = "planar_2r";
const SIZE: f64 = 1.0;

/// Prints the catalogue, or what is known of one effect.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Some(id) = &arguments.id else {
        if let Some(path) = &arguments.json {
            let all: Result<Vec<Known>, Failure> =
                EffectKind::ALL.into_iter().map(|kind| Ok(about(kind)?.known())).collect();
            return write_json(path, &all?);
        }
        print(&overview());
        return Ok(());
    };
    let kind = effect_named(id)?;
    let about = about(kind)?;
    if let Some(path) = &arguments.svg {
        let Some(portrait) = &about.drawn else {
            return Err(Failure::Input(format!("{id} has no picture: {}", kind.form().words())));
        };
        write(path, &alone(&plot(kind, portrait).to_svg()))?;
    }
    if let Some(path) = &arguments.json {
        write_json(path, &about.known())?;
        if path == Path::new("-") {
            return Ok(());
        }
    }
    print(&page(&about));
    Ok(())
}

/// The effect with an id.
///
/// # Errors
/// [`Failure::Input`] with the id that may have been meant, where there is no such effect.
pub(super) fn effect_named(id: &str) -> Result<EffectKind, Failure> {
    EffectKind::from_id(id).ok_or_else(|| {
        Failure::Input(format!(
            "the catalogue has no effect '{id}'{}; `dynid effects` lists them",
            meant(id, EffectKind::ALL.map(EffectKind::id))
        ))
    })
}

/// The law on a small robot, and what imitates it there.
fn about(kind: EffectKind) -> Result<About, Failure> {
    let model = models::find(ROBOT).ok_or_else(|| {
        Failure::Input(format!("this build has no {ROBOT} in robots/, which laws are drawn on"))
    })?;
    let nominal = model.robot().nominal.as_ref();
    let chi = nominal.map(|nominal| model.robot().base_from_standard(&nominal.standard));
    let chi = chi.unwrap_or_else(|| vec![0.0; model.robot().base.len()]);
    let failed = |error: DiagnosisError| Failure::Data(format!("{}: {error}", kind.id()));
    let drawn = portrait(model, &chi, kind, SIZE).map_err(failed)?;
    let worked_out = imitators(model, &chi, kind).map_err(failed)?;
    let mut all: Vec<(EffectKind, Option<f64>)> =
        worked_out.into_iter().map(|(kind, part)| (kind, Some(part))).collect();
    for other in kind.imitators() {
        if all.iter().all(|(known, _)| *known != other) {
            all.push((other, None));
        }
    }
    Ok(About { kind, drawn, imitators: all })
}

fn overview() -> String {
    let rows = EffectKind::ALL.into_iter().map(|kind| {
        let words = kind.words();
        let baseline = if kind.needs_baseline() { "needed" } else { "" };
        vec![words.id.to_owned(), words.title(), baseline.to_owned(), words.looks_like.to_owned()]
    });
    format!(
        "{}\n\n`dynid effects ID` tells its law, with a picture, what imitates it and the motion that shows it.",
        table(&["<id", "<name", "<baseline", "<in a recording"], rows.collect())
    )
}

fn plot(kind: EffectKind, portrait: &Portrait) -> Plot {
    let torque = format!("torque of joint {}, {}", portrait.joint, portrait.unit);
    Plot::new(kind.words().title(), axis(portrait), torque).with(
        kind.words().title(),
        Role::Law,
        SeriesKind::Points,
        thinned(&portrait.points),
    )
}

fn page(about: &About) -> String {
    let (kind, drawn, words) = (about.kind, about.drawn.as_ref(), about.kind.words());
    let mut parts = vec![format!("{} ({})\n{}", words.title(), words.id, words.what)];
    let mut law = format!("Torque: {}", kind.form().words());
    for formula in drawn.iter().flat_map(|portrait| &portrait.laws) {
        law.push_str(&format!("\n  {formula}"));
    }
    parts.push(law);
    let rows: Vec<Vec<String>> = about
        .symbols()
        .into_iter()
        .map(|symbol| {
            let unit = if symbol.unit == "1" { String::new() } else { symbol.unit };
            vec![format!("  {}", symbol.name), unit, symbol.meaning.to_owned()]
        })
        .collect();
    if !rows.is_empty() {
        parts.push(table(&["<  symbol", "<unit", "<meaning"], rows));
    }
    if let Some(portrait) = drawn {
        let values: Vec<String> = portrait
            .parameters
            .iter()
            .map(|p| format!("{} {}{}", p.name, significant(p.value, 3), unit_behind(&p.unit)))
            .collect();
        let torque = format!("torque of joint {} of a planar arm, {}", portrait.joint, portrait.unit);
        parts.push(format!(
            "{}\n  with {}",
            picture(&portrait.points, &axis(portrait), &torque),
            values.join(", ")
        ));
    }
    let mut lines = vec![
        format!("In a recording   {}", words.looks_like),
        format!("Revealed by      {}", words.revealed_by),
        format!("Looked for       {}", sought(kind)),
    ];
    if !about.imitators.is_empty() {
        lines.push(format!("Imitated by      {}", about.imitated_by()));
    }
    lines.push(format!("Shown by         {}", words.experiment));
    lines.extend(about.told_apart().map(|command| format!("                 {command}")));
    lines.push(format!("Put in by        {}", put_in(kind)));
    lines.push(format!("Literature       {}", words.source));
    parts.push(lines.join("\n"));
    parts.join("\n\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_in_the_formula_of_a_law_is_explained() {
        for kind in EffectKind::ALL {
            let about = about(kind).expect("the small robot can be evaluated");
            let known = about.known();
            assert!(!page(&about).contains("NaN"), "{}", known.id);
            for law in &known.laws {
                let is_name = |c: char| c.is_alphanumeric() || c == '_';
                let names = law.split(|c: char| !is_name(c)).filter(|name| {
                    name.starts_with(char::is_alphabetic)
                        && ![
                            "exp", "sign", "cos", "sin", "max", "where", "beyond", "a", "play", "of",
                            "motor", "link", "x", "dx", "dv", "model", "torque", "joint", "distance",
                            "since", "reversal", "dq_a", "dq_b", "was", "recorded", "at", "t", "d", "r",
                        ]
                        .contains(name)
                });
                for name in names {
                    let told = known
                        .symbols
                        .iter()
                        .any(|symbol| symbol.name == name || words_of(&symbol.name).any(|word| word == name));
                    assert!(
                        told || words_of(kind.words().meaning(name)).next().is_some(),
                        "{}: {name} in '{law}'",
                        known.id
                    );
                }
            }
        }
    }

    fn words_of(text: &str) -> impl Iterator<Item = &str> {
        text.split(' ').filter(|word| !word.is_empty())
    }
}
