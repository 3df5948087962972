//! What moves each row: its own joint variable, or a combination of joint variables.

use super::document::Place;
use super::formula::NO_SOLVER;
use super::reader::Reader;
use dynid_description::bounds::LONGEST;
use dynid_description::{DependentFrame, JointKind, MAX_TERMS};

/// Largest coefficient of a variable in an angle: bars and wrists have 1 or 2, and sines of large multiples are no geometry.
const MOST_TURNS: f64 = 16.0;
/// A coefficient this close to a whole number is one: the rounding of an expression.
const WHOLE: f64 = 1e-12;

/// The moving entry of one row, like terms added up.
pub(super) struct Moving {
    /// `theta` or `r`.
    pub key: &'static str,
    pub kind: JointKind,
    /// Number j of a variable, coefficient, and place in the file.
    pub terms: Vec<(usize, f64, Place)>,
}

impl Moving {
    /// Adds up the variables of an entry of row `j`; one that cancels is reported.
    pub fn new(
        reader: &mut Reader,
        j: usize,
        (key, kind): (&'static str, JointKind),
        found: Vec<(usize, f64, Place)>,
    ) -> Moving {
        let mut terms: Vec<(usize, f64, Place)> = Vec::new();
        for (k, coefficient, at) in found {
            match terms.iter_mut().find(|t| t.0 == k) {
                Some(term) => term.1 += coefficient,
                None => terms.push((k, coefficient, at)),
            }
        }
        for &(k, coefficient, at) in &terms {
            if coefficient == 0.0 {
                reader.report(at, format!("q{k} cancels in {key} of frame {j}: it moves nothing there"));
            } else if let Err(what) = check_coefficient(key, coefficient) {
                reader.report(
                    at,
                    format!("{key} of frame {j}: q{k} has the coefficient {coefficient}; {what}"),
                );
            }
        }
        if let Some(&(_, _, at)) = terms.get(MAX_TERMS) {
            reader.report(
                at,
                format!(
                    "{key} of frame {j} has {} joint variables: expected at most {MAX_TERMS}",
                    terms.len()
                ),
            );
        }
        terms.iter_mut().filter(|_| kind == JointKind::Revolute).for_each(|t| t.1 = t.1.round());
        Moving { key, kind, terms }
    }

    /// Whether row `j` has a variable of its own.
    pub fn is_own(&self, j: usize) -> bool {
        self.terms.iter().any(|t| t.0 == j)
    }
}

fn check_coefficient(key: &str, coefficient: f64) -> Result<(), String> {
    if key == "r" {
        let fits = coefficient.is_finite() && (1.0 / LONGEST..=LONGEST).contains(&coefficient.abs());
        return if fits {
            Ok(())
        } else {
            Err(format!("expected at most {LONGEST} and at least 1/{LONGEST}"))
        };
    }
    if (coefficient - coefficient.round()).abs() > WHOLE {
        return Err(
            "an angle needs whole numbers, because only their sines and cosines are those of sums of joint angles. \
             Let the joint variable be the smaller angle, and put the ratio in drive: gear"
                .to_owned(),
        );
    }
    let fits = coefficient.abs() <= MOST_TURNS;
    if fits { Ok(()) } else { Err(format!("expected at most {MOST_TURNS} in an angle")) }
}

/// The frames that move with other variables than their own, and the variables of every row checked: a row `j` whose entry
/// has `q<j>` in it is the own frame of joint j; other rows may use that variable too.
pub(super) fn dependent_frames(reader: &mut Reader, moving: &[Option<Moving>]) -> Vec<DependentFrame> {
    let own = |j: usize| {
        let row = moving.get(j.wrapping_sub(1)).and_then(Option::as_ref);
        row.filter(|row| row.is_own(j))
    };
    let numbers: Vec<usize> = (1..=moving.len()).filter(|&j| own(j).is_some()).collect();
    let mut dependent = Vec::new();
    for (at, row) in moving.iter().enumerate() {
        let Some(row) = row else { continue };
        let (j, key) = (at + 1, row.key);
        for &(k, _, place) in &row.terms {
            let Some(joint) = own(k) else {
                let known: Vec<String> = numbers.iter().map(|j| format!("q{j}")).collect();
                let why = if k > moving.len() {
                    format!("there is no frame {k}")
                } else {
                    format!("frame {k} has no q{k} in its own row, so that there is no such joint")
                };
                let variables = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
                reader.report(
                    place,
                    format!("{key} of frame {j}: {why}; joint variables of this table: {variables}"),
                );
                continue;
            };
            if row.kind == JointKind::Revolute && joint.kind == JointKind::Prismatic {
                reader.report(
                    place,
                    format!(
                        "{key} of frame {j}: q{k} is a length, and an angle is a sum of angles: {NO_SOLVER}"
                    ),
                );
            }
        }
        let plain = matches!(row.terms.as_slice(), [(k, 1.0, _)] if *k == j);
        if !plain {
            let joint = |k: usize| numbers.iter().position(|&n| n == k);
            let mut terms: Vec<(usize, f64)> =
                row.terms.iter().filter_map(|&(k, c, _)| Some((joint(k)?, c))).collect();
            terms.sort_by_key(|t| t.0);
            dependent.push(DependentFrame { frame: at, kind: row.kind, terms: terms.into() });
        }
    }
    dependent
}
