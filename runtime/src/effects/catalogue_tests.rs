//! Every effect of the catalogue answers everything that is asked of one.

use super::*;
use crate::model::{JointKind, Model, Robot};
use crate::simulation::testing::arm;

const SCALE: Scale = Scale {
    speed: 2.0,
    range: 3.0,
    centre: 0.0,
    torque: 40.0,
    start: 0.0,
    duration: 12.0,
    gear: 100.0,
    fast: 0.0,
    inertia: 0.4,
    kind: JointKind::Revolute,
};

fn robot() -> Robot {
    arm().0.robot().clone()
}

/// Every place of an effect in the robot, with its scales and shapes.
fn everywhere(kind: EffectKind) -> Vec<(Place, Vec<Scale>, Vec<Vec<f64>>)> {
    let robot = robot();
    let scales = vec![SCALE; robot.joints()];
    let places = kind.form().places(&robot);
    places.into_iter().map(|place| (place, scales.clone(), kind.form().all_shapes(place, &scales))).collect()
}

/// Quantities as of a finding at a place with a shape, all amplitudes 0.5.
fn made_up(kind: EffectKind, place: Place, shape: &[f64]) -> Quantities {
    let (a, s) = (vec![0.5; 16], vec![0.01; 16]);
    Quantities::new(match kind.form() {
        Form::Joint(law) | Form::Heard(law) => {
            let count = law.amplitudes(shape);
            let mut list = law.parameters(&SCALE, shape, &a[..count], &s[..count]);
            if place.hears().is_some() {
                list.push(Parameter::new(HEARD_JOINT, 2.0, 0.0, "1"));
            }
            list
        }
        Form::Sensitivity(law) => {
            let variants = law.variants(&robot());
            let own = |v: &Variant| law.quantity(v, 0.5, 0.01);
            if law.together() {
                variants.iter().map(own).collect()
            } else {
                place.variant().and_then(|v| variants.get(v)).map(own).into_iter().collect()
            }
        }
        Form::Compliance(law) => {
            let t = Transmission::from_shape(shape, 0.5, 1.0, 2.0, JointKind::Revolute);
            law.describe(&t)
                .into_iter()
                .map(|(name, value, unit)| Parameter::new(name, value, 0.0, unit))
                .collect()
        }
        Form::Body(_) => BodyEstimate::from_parameters(&a[..10], 0.1).parameters(&s, Some(2)),
        Form::Coupled => CoupledRotor { ratio: shape[0] }.parameters(&a[..3], &s[..3], 0.01),
        Form::Window => vec![Parameter::new("largest_force", 20.0, 0.0, "N")],
        Form::Free => vec![Parameter::new("swing", 2.0, 0.1, "N.m")],
        Form::User => Vec::new(),
    })
}

#[test]
fn every_name_is_its_own_serde_name_and_finds_its_effect() {
    for kind in EffectKind::ALL {
        let json = serde_json::to_string(&kind).expect("an enum serialises");
        assert_eq!(json, format!("\"{}\"", kind.id()));
        assert_eq!(EffectKind::from_id(kind.id()), Some(kind));
        assert_eq!(EffectKind::ALL.iter().filter(|k| k.id() == kind.id()).count(), 1);
    }
}

#[test]
fn every_effect_has_all_of_its_words() {
    for kind in EffectKind::ALL {
        let w = kind.words();
        for text in [w.name, w.what, w.looks_like, w.revealed_by, w.experiment, w.source] {
            assert!(text.len() > 3, "{}", w.id);
        }
        assert!(w.what.ends_with('.') && w.title().starts_with(char::is_uppercase), "{}", w.id);
        for kind_of_joint in [JointKind::Revolute, JointKind::Prismatic] {
            assert!(kind.properties().abscissa.label(kind_of_joint).len() > 5, "{}", w.id);
        }
    }
}

#[test]
fn a_special_case_is_another_effect_of_the_catalogue_that_is_not_made_special_by_it() {
    for kind in EffectKind::ALL {
        assert_eq!(
            kind.special_cases().count(),
            kind.properties().special_case.map_or(0, |c| c.effects.len()),
            "{kind:?}"
        );
        for simpler in kind.special_cases() {
            assert_ne!(simpler, kind);
            assert!(simpler.special_cases().all(|s| s != kind));
        }
    }
}

#[test]
fn an_effect_that_is_searched_has_places_and_finite_shapes_there() {
    for kind in EffectKind::ALL {
        let places = everywhere(kind);
        assert_eq!(places.is_empty(), matches!(kind.form(), Form::Window | Form::Free), "{kind:?}");
        for (place, scales, shapes) in places {
            assert!(!shapes.is_empty() && shapes.iter().flatten().all(|x| x.is_finite()), "{kind:?}");
            let named = kind.form().named_joints(&robot(), place);
            assert!(named.iter().all(|j| *j < scales.len()), "{kind:?} {named:?}");
        }
    }
}

#[test]
fn bounds_contain_the_grid_and_moves_stay_within_them() {
    for kind in EffectKind::ALL {
        for (place, scales, shapes) in everywhere(kind) {
            let grid: Vec<&[f64]> = shapes.iter().map(Vec::as_slice).collect();
            let search = kind.form().shape_search(place, &scales, &grid);
            assert_eq!(search.steps.len(), search.bounds.len(), "{kind:?}");
            for shape in &shapes {
                for (x, [low, high]) in shape.iter().zip(&search.bounds) {
                    assert!(low <= x && x <= high, "{kind:?}: {x} is not in {low} to {high}");
                }
                for along in search.moves(shape.len()) {
                    let next = search.moved(shape, &along, 1.0);
                    assert!(next.iter().all(|x| x.is_finite()), "{kind:?}");
                }
            }
        }
    }
}

#[test]
fn sentences_and_formulas_have_all_of_their_numbers() {
    for kind in EffectKind::ALL {
        let mut cases: Vec<Quantities> = Vec::new();
        for (place, _, shapes) in everywhere(kind) {
            cases.extend(shapes.iter().map(|shape| made_up(kind, place, shape)));
        }
        if cases.is_empty() {
            cases.push(made_up(kind, Place::Robot, &[]));
        }
        for q in cases {
            let (detail, formula) = (kind.effect().detail(&q), kind.effect().formula(&q));
            assert!(detail.len() > 10, "{kind:?}: {detail}");
            for text in [detail, formula] {
                let gap = text.contains("  ") || text.contains("()") || text.contains("by ,");
                assert!(!gap && text.trim() == text, "{kind:?}: '{text}'");
                assert!(!text.contains("NaN") && !text.contains("inf"), "{kind:?}: '{text}'");
            }
        }
    }
}

#[test]
fn every_quantity_and_every_name_of_a_formula_has_a_meaning() {
    for kind in EffectKind::ALL {
        let words = kind.words();
        assert!(words.put_in.len() > 10, "{}", words.id);
        assert!(words.symbols.iter().all(|(name, what)| !name.is_empty() && what.len() > 3), "{}", words.id);
        for (place, _, shapes) in everywhere(kind) {
            for shape in shapes {
                let q = made_up(kind, place, &shape);
                for name in q.names() {
                    assert!(!words.meaning(name).is_empty(), "{}: {name}", words.id);
                }
                let formula = kind.effect().formula(&q.by_name());
                assert!(!formula.contains("0.5"), "{}: '{formula}' has a number", words.id);
            }
        }
    }
}

#[test]
fn every_law_of_a_joint_fills_its_columns() {
    let at = At {
        time: 0.7,
        q: 0.4,
        dq: 1.1,
        ddq: 2.0,
        sign: 1.0,
        load: 9.0,
        link: 8.0,
        gravity: 5.0,
        torque: 12.0,
        friction: 2.0,
    };
    for kind in EffectKind::ALL {
        let (Form::Joint(law) | Form::Heard(law)) = kind.form() else { continue };
        for shape in law.all_shapes(&SCALE) {
            let mut out = vec![f64::NAN; law.amplitudes(&shape)];
            law.law(&SCALE, &shape, &at, 0.5, &mut out);
            assert!(out.iter().all(|x| x.is_finite()), "{kind:?} {shape:?}: {out:?}");
        }
    }
}

/// Formulas that leave the program are the laws themselves.
#[test]
fn closed_forms_are_the_laws_that_the_effects_have() {
    let robot = robot();
    let mut compared = Vec::new();
    for kind in EffectKind::ALL {
        let Form::Joint(law) = kind.form() else { continue };
        for shape in law.all_shapes(&SCALE) {
            let amplitude: Vec<f64> =
                (0..law.amplitudes(&shape)).map(|k| (1.3 * k as f64 + 0.4).cos()).collect();
            let term = EffectTerm {
                effect: kind,
                place: Place::Joint(1),
                joints: vec![2],
                shape: shape.clone(),
                sigma: vec![0.0; amplitude.len()],
                amplitude: amplitude.clone(),
                scale: Some(SCALE.into()),
                wrenches: Vec::new(),
            };
            let Ok(forms) = term.closed_forms(&robot) else { continue };
            compared.push(kind);
            let text = format!("k*({})", forms[0].text);
            let formula = UserLaw::new("formula", 1, &text, &Default::default()).expect("a law");
            let names = formula.inputs();
            for (q, dq, load) in [(0.3, 1.2, -7.0), (-1.9, -0.02, 4.0), (2.8, -3.0, 0.5)] {
                let at = At { q, dq, load, sign: f64::signum(dq), ..At::default() };
                let mut columns = vec![0.0; amplitude.len()];
                law.law(&SCALE, &shape, &at, 0.0, &mut columns);
                let expected: f64 = columns.iter().zip(&amplitude).map(|(c, a)| c * a).sum();
                let value = |name: &String| match name.as_str() {
                    "q2" => q,
                    "dq2" => dq,
                    _ => load,
                };
                let variables: Vec<f64> = names.iter().map(value).collect();
                let mut found = [0.0];
                formula.columns(&variables, &[], None, &mut found);
                assert!((found[0] - expected).abs() < 1e-12, "{}: {text}", kind.id());
            }
        }
    }
    compared.dedup();
    assert!(compared.len() >= 7, "{compared:?}");
}
