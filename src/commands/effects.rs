//! `dynid effects [ID]`: the catalogue of physics that a diagnosis looks for.

mod picture;

use std::path::{Path, PathBuf};

use clap::Args;
use dynid_runtime::diagnosis::{Portrait, portrait};
use dynid_runtime::effects::{EffectKind, Form, Sought};
use dynid_runtime::recording::meant;
use dynid_runtime::report::{Plot, Role, SeriesKind, alone, significant};
use serde::Serialize;

use crate::failure::Failure;
use crate::models;
use crate::output::{print, table, write, write_json};
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
/// Points of a picture that are written for other programs.
const WRITTEN: usize = 600;

/// A name of a law's formula.
#[derive(Serialize)]
struct Symbol {
    name: String,
    unit: String,
    meaning: &'static str,
}

/// The picture of a law.
#[derive(Serialize)]
struct Drawn {
    joint: usize,
    formula: String,
    variable: String,
    unit: String,
    points: Vec<(f64, f64)>,
}

/// All that is known of an effect.
#[derive(Serialize)]
struct Known {
    id: &'static str,
    title: &'static str,
    what: &'static str,
    torque: &'static str,
    laws: Vec<String>,
    symbols: Vec<Symbol>,
    looks_like: &'static str,
    revealed_by: &'static str,
    imitators: Vec<&'static str>,
    experiment: &'static str,
    needs_baseline: bool,
    sought: &'static str,
    put_in: String,
    source: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    drawn: Option<Drawn>,
}

/// Prints the catalogue, or what is known of one effect.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Some(id) = &arguments.id else {
        if let Some(path) = &arguments.json {
            let all: Result<Vec<Known>, Failure> =
                EffectKind::ALL.into_iter().map(|kind| Ok(known(kind, drawn(kind)?.as_ref()))).collect();
            return write_json(path, &all?);
        }
        print(&overview());
        return Ok(());
    };
    let kind = effect_named(id)?;
    let drawn = drawn(kind)?;
    if let Some(path) = &arguments.svg {
        let Some(portrait) = &drawn else {
            return Err(Failure::Input(format!("{id} has no picture: {}", kind.form().words())));
        };
        write(path, &alone(&plot(kind, portrait).to_svg()))?;
    }
    if let Some(path) = &arguments.json {
        write_json(path, &known(kind, drawn.as_ref()))?;
        if path == Path::new("-") {
            return Ok(());
        }
    }
    print(&page(kind, drawn.as_ref()));
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

/// The law on a small robot.
fn drawn(kind: EffectKind) -> Result<Option<Portrait>, Failure> {
    let model = models::find(ROBOT).ok_or_else(|| {
        Failure::Input(format!("this build has no {ROBOT} in robots/, which laws are drawn on"))
    })?;
    let nominal = model.robot().nominal.as_ref();
    let chi = nominal.map(|nominal| model.robot().base_from_standard(&nominal.standard));
    let chi = chi.unwrap_or_else(|| vec![0.0; model.robot().base.len()]);
    portrait(model, &chi, kind, SIZE).map_err(|error| Failure::Data(format!("{}: {error}", kind.id())))
}

fn overview() -> String {
    let rows = EffectKind::ALL.into_iter().map(|kind| {
        let words = kind.words();
        let baseline = if kind.needs_baseline() { "needed" } else { "" };
        vec![words.id.to_owned(), words.title.to_owned(), baseline.to_owned(), words.looks_like.to_owned()]
    });
    format!(
        "{}\n\n`dynid effects ID` tells its law, with a picture, what imitates it and the motion that shows it.",
        table(&["<id", "<name", "<baseline", "<in a recording"], rows.collect())
    )
}

/// In which recordings it is looked for.
fn sought(kind: EffectKind) -> &'static str {
    match kind.properties().sought {
        Sought::Always => "in every recording",
        Sought::OnlyAgainstBaseline => {
            "only against a recording or a model from before (`--baseline`, `--reference`): in one recording it cannot be \
             told from the standard parameters"
        }
        Sought::NeverAgainstBaseline => "in one recording; against a baseline it is the same in both",
        Sought::Separately => "in every recording, by a search of its own",
    }
}

/// The command that puts it into a simulation, or how else it gets there.
fn put_in(kind: EffectKind) -> String {
    let words = kind.words();
    let id = words.id;
    match kind.form() {
        Form::Joint(_) => format!("{}: dynid simulate ROBOT --effect {id}:JOINT --out DIR", words.put_in),
        Form::Compliance(_) => {
            format!("{}: dynid simulate ROBOT --elastic JOINT:STIFFNESS:DAMPING:PLAY --out DIR", words.put_in)
        }
        _ => words.put_in.to_owned(),
    }
}

/// A motion that tells it from what imitates it, as a command.
fn told_apart(kind: EffectKind) -> Option<String> {
    let of_joint = |kind: &EffectKind| matches!(kind.form(), Form::Joint(_));
    let rival = kind.imitators().into_iter().find(of_joint).filter(|_| of_joint(&kind))?;
    Some(format!("dynid excite ROBOT --tell {},{} --joint JOINT --out DIR", kind.id(), rival.id()))
}

/// Names that mean the same in all formulas: name, unit on a revolute joint, meaning.
const OF_THE_MOTION: [(&str, &str, &str); 4] = [
    ("q", "rad or m", "position of the joint"),
    ("dq", "rad/s or m/s", "speed of the joint"),
    ("ddq", "rad/s2 or m/s2", "acceleration of the joint"),
    ("model torque", "N.m or N", "torque of the standard model"),
];

fn symbols(kind: EffectKind, drawn: Option<&Portrait>) -> Vec<Symbol> {
    let words = kind.words();
    let quantities = drawn.map_or(&[][..], |portrait| &portrait.quantities);
    let laws = drawn.map_or_else(String::new, |portrait| portrait.laws.join(" "));
    let own = quantities.iter().map(|q| Symbol {
        name: q.name.clone(),
        unit: q.unit.clone(),
        meaning: words.meaning(&q.name),
    });
    let is_quantity = |name: &str| quantities.iter().any(|q| q.name == name);
    let others = words.symbols.iter().filter(|(name, _)| !is_quantity(name));
    let others = others.filter(|(name, _)| quantities.is_empty() || stands_in(&laws, name));
    let others =
        others.map(|&(name, meaning)| Symbol { name: name.to_owned(), unit: String::new(), meaning });
    let motion = OF_THE_MOTION.into_iter().filter(|(name, _, _)| stands_in(&laws, name));
    let motion = motion.map(|(name, unit, meaning)| Symbol { name: name.into(), unit: unit.into(), meaning });
    own.chain(others).chain(motion).collect()
}

/// Whether a name stands in a formula, not as a part of another one.
fn stands_in(formula: &str, name: &str) -> bool {
    let letter = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
    formula.match_indices(name).any(|(at, _)| {
        !letter(formula[..at].chars().next_back()) && !letter(formula[at + name.len()..].chars().next())
    })
}

fn known(kind: EffectKind, drawn: Option<&Portrait>) -> Known {
    let words = kind.words();
    Known {
        id: words.id,
        title: words.title,
        what: words.what,
        torque: kind.form().words(),
        laws: drawn.map_or_else(Vec::new, |portrait| portrait.laws.clone()),
        symbols: symbols(kind, drawn),
        looks_like: words.looks_like,
        revealed_by: words.revealed_by,
        imitators: kind.imitators().into_iter().map(EffectKind::id).collect(),
        experiment: words.experiment,
        needs_baseline: kind.needs_baseline(),
        sought: sought(kind),
        put_in: put_in(kind),
        source: words.source,
        drawn: drawn.map(|portrait| Drawn {
            joint: portrait.joint,
            formula: portrait.formula.clone(),
            variable: axis(portrait),
            unit: portrait.unit.clone(),
            points: thinned(&portrait.points),
        }),
    }
}

/// So many points as a picture needs.
fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    points.iter().copied().step_by(points.len().div_ceil(WRITTEN).max(1)).collect()
}

fn axis(portrait: &Portrait) -> String {
    let along = if portrait.along_motion { " (torques along the motion)" } else { "" };
    format!("{}{along}", portrait.variable)
}

fn plot(kind: EffectKind, portrait: &Portrait) -> Plot {
    let torque = format!("torque of joint {}, {}", portrait.joint, portrait.unit);
    Plot::new(kind.words().title, axis(portrait), torque).with(
        kind.words().title,
        Role::Law,
        SeriesKind::Points,
        thinned(&portrait.points),
    )
}

fn page(kind: EffectKind, drawn: Option<&Portrait>) -> String {
    let words = kind.words();
    let mut parts = vec![format!("{} ({})\n{}", words.title, words.id, words.what)];
    let mut law = format!("Torque: {}", kind.form().words());
    for formula in drawn.iter().flat_map(|portrait| &portrait.laws) {
        law.push_str(&format!("\n  {formula}"));
    }
    parts.push(law);
    let rows: Vec<Vec<String>> = symbols(kind, drawn)
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
            .map(|p| {
                format!(
                    "{} {}{}",
                    p.name,
                    significant(p.value, 3),
                    if p.unit == "1" { String::new() } else { format!(" {}", p.unit) }
                )
            })
            .collect();
        let torque = format!("torque of joint {} of a planar arm, {}", portrait.joint, portrait.unit);
        parts.push(format!(
            "{}\n  with {}",
            picture(&portrait.points, &axis(portrait), &torque),
            values.join(", ")
        ));
    }
    let imitators: Vec<&str> = kind.imitators().into_iter().map(EffectKind::id).collect();
    let mut lines = vec![
        format!("In a recording   {}", words.looks_like),
        format!("Revealed by      {}", words.revealed_by),
        format!("Looked for       {}", sought(kind)),
    ];
    if !imitators.is_empty() {
        lines.push(format!("Imitated by      {}", imitators.join(", ")));
    }
    lines.push(format!("Shown by         {}", words.experiment));
    lines.extend(told_apart(kind).map(|command| format!("                 {command}")));
    lines.push(format!("Put in by        {}", put_in(kind)));
    lines.push(format!("Literature       {}", words.source));
    parts.push(lines.join("\n"));
    parts.join("\n\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_not_found_within_another_one() {
        assert!(stands_in("fs·exp(-(dq / vs)²)", "dq") && !stands_in("fs·exp(-(dq / vs)²)", "q"));
        assert!(!stands_in("ddq", "dq"));
    }

    #[test]
    fn every_name_in_the_formula_of_a_law_is_explained() {
        for kind in EffectKind::ALL {
            let portrait = drawn(kind).expect("the small robot can be evaluated");
            let known = known(kind, portrait.as_ref());
            assert!(!page(kind, portrait.as_ref()).contains("NaN"), "{}", known.id);
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
