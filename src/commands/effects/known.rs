//! What is known of an effect, for a person and for other programs.

use dynid_runtime::diagnosis::Portrait;
use dynid_runtime::effects::{EffectKind, Form, Sought};
use serde::Serialize;

/// Points of a picture that are written for other programs.
const WRITTEN: usize = 600;

/// A name of a law's formula.
#[derive(Serialize)]
pub(super) struct Symbol {
    pub name: String,
    pub unit: String,
    pub meaning: &'static str,
}

/// The picture of a law.
#[derive(Serialize)]
pub(super) struct Drawn {
    joint: usize,
    formula: String,
    variable: String,
    unit: String,
    points: Vec<(f64, f64)>,
}

/// A law that imitates another one.
#[derive(Serialize)]
pub(super) struct Imitator {
    effect: &'static str,
    /// The part of what the standard model leaves of the law that it takes on the motion that is drawn; `None` where it is no
    /// law of a joint.
    part: Option<f64>,
}

/// An effect with what was worked out of it.
pub(super) struct About {
    pub kind: EffectKind,
    /// Its law on a small robot; `None` where it has none.
    pub drawn: Option<Portrait>,
    /// What imitates it, with the part that it takes where that was worked out.
    pub imitators: Vec<(EffectKind, Option<f64>)>,
}

/// All that is known of an effect, for other programs.
#[derive(Serialize)]
pub(super) struct Known {
    pub id: &'static str,
    pub title: String,
    pub what: &'static str,
    pub torque: &'static str,
    pub laws: Vec<String>,
    pub symbols: Vec<Symbol>,
    pub looks_like: &'static str,
    pub revealed_by: &'static str,
    pub imitators: Vec<Imitator>,
    pub experiment: &'static str,
    pub needs_baseline: bool,
    pub sought: &'static str,
    pub put_in: String,
    pub source: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drawn: Option<Drawn>,
}

/// In which recordings it is looked for.
pub(super) fn sought(kind: EffectKind) -> &'static str {
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
pub(super) fn put_in(kind: EffectKind) -> String {
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

impl About {
    /// A motion that tells it from what imitates it best, as a command; `None` where no motion does.
    pub(super) fn told_apart(&self) -> Option<String> {
        let of_joint = |kind: &EffectKind| matches!(kind.form(), Form::Joint(_));
        let contains = |other: &EffectKind| other.special_cases().any(|simpler| simpler == self.kind);
        let mut rivals = self.imitators.iter().map(|(kind, _)| *kind);
        let rival = rivals.find(|kind| of_joint(kind) && !contains(kind)).filter(|_| of_joint(&self.kind))?;
        let ids = format!("{},{}", self.kind.id(), rival.id());
        Some(format!("dynid excite ROBOT --tell {ids} --joint JOINT --out DIR"))
    }

    /// The names of its formulas and of its quantities.
    pub(super) fn symbols(&self) -> Vec<Symbol> {
        let (words, drawn) = (self.kind.words(), self.drawn.as_ref());
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
        let motion =
            motion.map(|(name, unit, meaning)| Symbol { name: name.into(), unit: unit.into(), meaning });
        own.chain(others).chain(motion).collect()
    }

    /// For other programs.
    pub(super) fn known(&self) -> Known {
        let (kind, words, drawn) = (self.kind, self.kind.words(), self.drawn.as_ref());
        Known {
            id: words.id,
            title: words.title(),
            what: words.what,
            torque: kind.form().words(),
            laws: drawn.map_or_else(Vec::new, |portrait| portrait.laws.clone()),
            symbols: self.symbols(),
            looks_like: words.looks_like,
            revealed_by: words.revealed_by,
            imitators: self
                .imitators
                .iter()
                .map(|(kind, part)| Imitator { effect: kind.id(), part: *part })
                .collect(),
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

    /// What imitates it, in words.
    pub(super) fn imitated_by(&self) -> String {
        let one = |(kind, part): &(EffectKind, Option<f64>)| match part {
            Some(part) => format!("{} ({:.0} % of it)", kind.id(), 100.0 * part),
            None => kind.id().to_owned(),
        };
        self.imitators.iter().map(one).collect::<Vec<_>>().join(", ")
    }
}

/// Names that mean the same in all formulas: name, unit on a revolute joint, meaning.
const OF_THE_MOTION: [(&str, &str, &str); 4] = [
    ("q", "rad or m", "position of the joint"),
    ("dq", "rad/s or m/s", "speed of the joint"),
    ("ddq", "rad/s2 or m/s2", "acceleration of the joint"),
    (
        "model torque",
        "N.m or N",
        "torque of the drive: of the standard model and of the other laws of the joint",
    ),
];

/// Whether a name stands in a formula, not as a part of another one.
pub(super) fn stands_in(formula: &str, name: &str) -> bool {
    let letter = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
    formula.match_indices(name).any(|(at, _)| {
        !letter(formula[..at].chars().next_back()) && !letter(formula[at + name.len()..].chars().next())
    })
}

/// So many points as a picture needs.
pub(super) fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    points.iter().copied().step_by(points.len().div_ceil(WRITTEN).max(1)).collect()
}

pub(super) fn axis(portrait: &Portrait) -> String {
    let along = if portrait.along_motion { " (torques along the motion)" } else { "" };
    format!("{}{along}", portrait.variable)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_not_found_within_another_one() {
        assert!(stands_in("fs·exp(-(dq / vs)²)", "dq") && !stands_in("fs·exp(-(dq / vs)²)", "q"));
        assert!(!stands_in("ddq", "dq"));
    }
}
