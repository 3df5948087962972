//! Sentences for a person.

use crate::diagnosis::explanation::free_form::in_words;
use crate::diagnosis::outcome::{Diagnosis, Finding, Mismatch, NotJudged};
use crate::diagnosis::reference::Reference;
use crate::diagnosis::rules;
use crate::effects::{EffectKind, FreeLaw, Parameter, Place, Quantities, UserLaw};
use crate::model::{JointIndex, JointKind, Robot};
use crate::report::{capital, change_of_error, percent, significant};

impl Finding {
    /// Its quantities by name.
    fn quantities(&self) -> Quantities {
        let list = self.parameters.iter();
        Quantities::new(list.map(|(name, p)| Parameter::new(name, p.value, p.sigma, &p.unit)).collect())
    }

    /// The law with the numbers that were found, in SI units; `None` where no formula of one line says it.
    pub fn formula(&self) -> Option<String> {
        if let Some(law) = self.term.place.law() {
            let number = |name: &str| self.parameters.get(name).map(|p| signed(p.value));
            return Some(law.with_numbers(number));
        }
        let formula = EffectKind::from_id(&self.effect)?.effect().formula(&self.quantities());
        (!formula.is_empty()).then_some(formula)
    }
}

/// What was found, where, how large, and what it gains.
pub(in crate::diagnosis) fn sentence(robot: &Robot, effect: EffectKind, f: &Finding) -> String {
    let words = effect.words();
    let place = match f.joints.as_slice() {
        [] => format!("On the whole {}", robot.name),
        [j] => format!("On joint {j}"),
        many => {
            format!("On joints {}", many.iter().map(ToString::to_string).collect::<Vec<_>>().join(" and "))
        }
    };
    if let Some(law) = f.term.place.law() {
        return of_law(&place, law, f);
    }
    if !f.variables.is_empty() {
        return free_form(robot, &place, f);
    }
    let detail = effect.effect().detail(&f.quantities());
    format!(
        "{place}: {}. {}: {detail}. Held-out error of {} {}.",
        words.name,
        capital(words.what.trim_end_matches('.')),
        if f.joints.is_empty() { "all joints" } else { "its joints" },
        change_of_error(f.held_out_before, f.held_out_after)
    )
}

/// A number that may stand anywhere in a formula.
fn signed(x: f64) -> String {
    if x < 0.0 { format!("({})", significant(x, 3)) } else { significant(x, 3) }
}

/// A law of the user with its constants.
fn of_law(place: &str, law: UserLaw, f: &Finding) -> String {
    format!(
        "{place}: your law {}, {}, with {}. Held-out error of its joints {}.",
        law.id(),
        law.text(),
        f.quantities().all(),
        change_of_error(f.held_out_before, f.held_out_after)
    )
}

/// What became of the laws of the user that were not named.
pub(in crate::diagnosis) fn of_user(
    robot: &Robot,
    laws: &[UserLaw],
    untried: &[UserLaw],
    d: &Diagnosis,
) -> Vec<String> {
    let named = |law: &UserLaw| d.terms().iter().any(|term| term.place == Place::Law(*law));
    let words = |law: &UserLaw| {
        let number = robot.joint_number(JointIndex(law.joint())).0;
        let what = format!("Your law {} on joint {number}", law.id());
        let rival = d.cannot_tell.iter().find_map(|c| {
            let other = |id: &&String| *id != law.id();
            c.between.iter().any(|id| id == law.id()).then(|| c.between.iter().find(other)).flatten()
        });
        if let Some(rival) = rival {
            format!("{what} was tried; this motion cannot tell it from {rival}.")
        } else if untried.contains(law) {
            format!(
                "{what} was not tried: on this motion the standard model makes the torque of one of its terms, or the law has no finite value."
            )
        } else {
            format!(
                "{what} was tried and is not named: this recording does not show it beside what was found."
            )
        }
    };
    laws.iter().filter(|law| !named(law)).map(words).collect()
}

/// What depends on variables that the words of its effect do not say.
fn free_form(robot: &Robot, place: &str, f: &Finding) -> String {
    let number = |j: usize| robot.joint_number(JointIndex(j)).0;
    let law = FreeLaw::from_shape(&f.term.shape, robot.joints());
    let variables = law.map_or_else(String::new, |law| in_words(&law, number));
    let proposal = f
        .proposal
        .as_ref()
        .map_or_else(String::new, |formula| format!(" A proposal that fits it within its band: {formula}."));
    format!(
        "{place}: a torque that depends on {}, and on nothing else; {}.{proposal} Held-out error of its joints {}.",
        variables,
        f.term.effect.effect().detail(&f.quantities()),
        change_of_error(f.held_out_before, f.held_out_after)
    )
}

/// Unit of the torque of the joint with this number: that of a prismatic joint is a force.
pub(in crate::diagnosis) fn torque_unit(robot: &Robot, number: usize) -> &'static str {
    let kinds = robot.joint_kinds();
    let joint = (0..robot.joints()).find(|&j| robot.joint_number(JointIndex(j)).0 == number);
    joint.map_or(JointKind::Revolute, |j| kinds[j]).torque_unit()
}

/// A contact.
pub(in crate::diagnosis) fn contact(robot: &Robot, f: &Finding) -> String {
    let windows: Vec<String> = f
        .contacts
        .iter()
        .map(|w| {
            let place = if w.force == [0.0; 3] {
                let joints: Vec<String> = w
                    .joint_torques
                    .iter()
                    .map(|t| {
                        let unit = torque_unit(robot, t.joint);
                        format!("{} ({} {unit})", t.joint, significant(t.largest, 3))
                    })
                    .collect();
                format!("joint {}", joints.join(" and "))
            } else {
                format!("link {}", w.link)
            };
            format!("{} from {:.2} s to {:.2} s on {place}", w.motion, w.window[0], w.window[1])
        })
        .collect();
    let much = if f.parameters.contains_key("largest_force") {
        f.quantities().text("largest_force")
    } else {
        f.quantities().text("largest_joint_torque")
    };
    let why = if f.contacts.iter().any(|w| w.force != [0.0; 3]) {
        " Several joints jump together in the ratio of one force on one link."
    } else {
        ""
    };
    format!("Something pushed the robot, with up to {much}: {}.{why}", windows.join("; "))
}

/// Joints about which nothing is said.
pub(in crate::diagnosis) fn not_judged(joints: &[NotJudged]) -> Option<String> {
    let list: Vec<String> = joints.iter().map(|j| j.joint.to_string()).collect();
    match list.as_slice() {
        [] => None,
        [one] => Some(format!("Joint {one} hardly moves: nothing is said about it.")),
        [most @ .., last] => {
            Some(format!("Joints {} and {last} hardly move: nothing is said about them.", most.join(", ")))
        }
    }
}

/// What a comparison with a reference rests on, `alone` or beside the motions that it is from.
pub(in crate::diagnosis) fn of_reference(reference: &Reference, alone: bool) -> String {
    if !alone {
        return "Compared with the motions from before: a change is judged against how much these differ."
            .to_owned();
    }
    let judged = "Compared with a model: a change is judged against how much this recording varies from stretch to stretch";
    let text = if reference.between_motions().is_empty() {
        format!("{judged}; how much the robot differs from day to day this model does not tell.")
    } else {
        format!("{judged}, and against how much the motions differ that the model is from.")
    };
    if !reference.is_diagonal() {
        return text;
    }
    let alone = "Its file has no covariance of all of its numbers: those are taken to vary by themselves";
    format!("{text} {alone}, so that less of a change shows.")
}

/// Where what is missing lies, where nothing names it.
fn something_missing(d: &Diagnosis) -> String {
    format!("Something is missing that cannot be named{}", most_of_it(d.mismatch.first()))
}

/// On which joint most of something is, and what orders it there.
fn most_of_it(most: Option<&Mismatch>) -> String {
    let Some(most) = most else { return String::new() };
    let how = most.where_.trim_start_matches("while moving; ");
    let how = if how.starts_with("changes") || how.starts_with("has") {
        format!("it {how}")
    } else {
        how.to_owned()
    };
    format!(", most of it on joint {}: {how}", most.joint)
}

/// The joint on which most is gained, where all joints together, of which others have the larger torques, hardly show it.
fn of_one_joint(d: &Diagnosis) -> Option<String> {
    if d.held_out.after < rules::SHOWS_IN_ALL * d.held_out.before {
        return None;
    }
    let gain = |f: &Finding| f.held_out_after / f.held_out_before;
    let of_one = d.findings.iter().filter(|f| f.joints.len() == 1 && gain(f) < rules::SHOWS_IN_ALL);
    let most = of_one.min_by(|a, b| gain(a).total_cmp(&gain(b)))?;
    let of_joint = change_of_error(most.held_out_before, most.held_out_after);
    Some(format!(" of all joints together, and {of_joint} on joint {}", most.joints[0]))
}

/// What is said where motions do not show what predicts other motion.
fn not_shown(d: &Diagnosis) -> Option<String> {
    let (fitted, held_out) = (d.after.relative_error?, d.held_out.after);
    (held_out > rules::NOT_SHOWN * fitted).then(|| {
        format!(
            "The motions do not show what one needs to know of the others: the error is {} where they were fitted, and {} where \
             they were held out. A law that is no larger than that is not found; motions that move all joints, fast and over \
             their travel, show more (`dynid excite`).",
            percent(fitted),
            percent(held_out)
        )
    })
}

/// The verdict first.
pub(in crate::diagnosis) fn verdict(d: &Diagnosis) -> Vec<String> {
    let mut lines = Vec::new();
    let unexplained = d.unexplained.share > rules::UNEXPLAINED;
    if d.findings.is_empty() {
        let head = if unexplained {
            something_missing(d)
        } else {
            "Nothing is missing that this recording can show".to_owned()
        };
        lines.push(format!(
            "{head}. The held-out error of the standard model is {}, and none of {} things tried improves it reliably.",
            percent(d.held_out.before),
            d.tried
        ));
    } else {
        let names: Vec<String> = d
            .findings
            .iter()
            .map(|f| {
                let title = EffectKind::name_of(&f.effect);
                match f.joints.as_slice() {
                    [] => title.to_owned(),
                    joints => {
                        let list: Vec<String> = joints.iter().map(ToString::to_string).collect();
                        format!("{title} on joint {}", list.join(" and "))
                    }
                }
            })
            .collect();
        lines.push(format!("The standard model leaves out: {}.", names.join("; ")));
        lines.push(format!(
            "With it, the error on motion that was held out ({}) {}{}.",
            d.held_out.how,
            change_of_error(d.held_out.before, d.held_out.after),
            of_one_joint(d).unwrap_or_default()
        ));
    }
    lines.extend(not_shown(d));
    if unexplained {
        lines.push(format!(
            "{:.0} % of what remains is not noise: something is left that nothing in the catalogue explains{}.",
            100.0 * d.unexplained.share,
            // Without a finding the first line has said it.
            most_of_it(d.unexplained.most.as_ref().filter(|_| !d.findings.is_empty()))
        ));
    }
    lines
}
