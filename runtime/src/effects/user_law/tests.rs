use super::*;

fn no_shapes() -> BTreeMap<String, [f64; 2]> {
    BTreeMap::new()
}

fn law(text: &str) -> UserLaw {
    UserLaw::new("mine", 1, text, &no_shapes()).unwrap_or_else(|e| panic!("{text}: {e}"))
}

fn values(law: UserLaw, at: &[f64], shape: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; law.constants().len()];
    law.columns(at, shape, None, &mut out);
    out
}

#[test]
fn what_stands_before_each_constant_is_its_column() {
    for (text, at, columns) in [
        ("k1*sin(2*q4) + k2*cos(2*q4)", &[0.3][..], vec![0.6_f64.sin(), 0.6_f64.cos()]),
        ("-(a - 2*b)*q1/4", &[8.0], vec![-2.0, 4.0]),
        ("a*(q1 + b_free_of_a)*0 + b_free_of_a*t", &[3.0, 5.0], Vec::new()),
        ("c*-q1^2 + c", &[3.0], vec![-8.0]),
        ("k*exp(-t/2)*sqrt(abs(q1))", &[2.0, -4.0], vec![2.0 * (-1.0_f64).exp()]),
        ("k*tanh(dq2)*sign(ddq3)*ln(load1)*tan(pi/4)", &[1.0, -0.5, 1.0], vec![0.0]),
    ] {
        if columns.is_empty() {
            assert!(UserLaw::new("mine", 1, text, &no_shapes()).is_err(), "{text}");
            continue;
        }
        for (found, expected) in values(law(text), at, &[]).iter().zip(&columns) {
            assert!((found - expected).abs() < 1e-12, "{text}: {found} {expected}");
        }
        assert_eq!(law(text).constants().len(), columns.len());
    }
}

#[test]
fn a_constant_that_is_neither_before_a_term_nor_declared_is_refused_at_its_place() {
    for (text, offset, name) in [
        ("k*abs(dq2)^p*sign(dq2)", 11, "p"),
        ("sin(k*q1)", 4, "k"),
        ("a*b*q1", 2, "b"),
        ("q1/k", 3, "k"),
        ("k^2*q1", 0, "k"),
        ("a*q1 + c*exp(d)", 13, "d"),
    ] {
        let error = UserLaw::new("mine", 1, text, &no_shapes()).expect_err(text);
        assert_eq!((error.field, error.offset), ("law", offset), "{text}: {error}");
        assert!(error.message.contains(&format!("shapes: {{{name}: [")), "{text}: {error}");
    }
}

#[test]
fn a_term_without_a_constant_and_a_law_without_one_are_refused() {
    for text in ["sin(q1)", "k*q1 + sin(q1)", "3"] {
        assert!(
            UserLaw::new("mine", 1, text, &no_shapes()).is_err_and(|e| e.message.contains("k*(...)")),
            "{text}"
        );
    }
}

#[test]
fn a_name_that_could_be_meant_otherwise_is_refused() {
    for (text, what) in [
        ("k*q", "write q<j>"),
        ("k*q0", "write q<j>"),
        ("k*sin", "write sin(...)"),
        ("k*sinh(q1)", "is no function"),
        ("k.a*q1", "is no name"),
        ("k*q1 $", "does not belong"),
    ] {
        let error = UserLaw::new("mine", 1, text, &no_shapes()).expect_err(text);
        assert!(error.message.contains(what), "{text}: {error}");
    }
}

#[test]
fn a_shape_is_searched_within_its_range() {
    let of = |range| UserLaw::new("mine", 1, "k*abs(dq2)^p", &[("p".to_owned(), range)].into());
    let power = of([0.3, 3.0]).expect("a law");
    let grid = power.grid();
    assert_eq!((grid[0][0], grid[grid.len() - 1][0]), (0.3, 3.0));
    let ratios: Vec<f64> = grid.windows(2).map(|w| w[1][0] / w[0][0]).collect();
    assert!(ratios.iter().all(|r| (r - ratios[0]).abs() < 1e-9), "a range above 0 is geometric");
    let around = of([-1.0, 3.0]).expect("a law");
    let search = around.shape_search();
    assert_eq!(around.grid()[2], [0.0]);
    assert_eq!(search.moved(&[0.0], &vec![(0, -1.0)], 1.0), [-0.5]);
    assert_eq!(search.moved(&[2.9], &vec![(0, 1.0)], 1.0), [3.0]);
    assert!(around.has_shape(&[-1.0]) && !around.has_shape(&[3.1]) && !around.has_shape(&[]));
    assert!(!around.has_shape(&[f64::NAN]));
    assert!((values(power, &[-4.0], &[0.5])[0] - 2.0).abs() < 1e-12);
}

#[test]
fn a_law_is_the_same_after_it_was_saved_and_is_read_with_every_field_checked() {
    let shapes = [("p".to_owned(), [0.3, 3.0])].into();
    let law = UserLaw::new("sag", 1, "k*abs(dq2)^p*sign(dq2)", &shapes).expect("a law");
    let json = serde_json::to_string(&law).expect("it serialises");
    assert_eq!(serde_json::from_str::<UserLaw>(&json).ok(), Some(law));
    for (from, to) in [("k*abs", "k*(abs"), ("\"sag\"", "\"Sag\""), ("0.3", "5.0"), ("\"joint\"", "\"jont\"")]
    {
        assert!(json.contains(from));
        assert!(serde_json::from_str::<UserLaw>(&json.replace(from, to)).is_err(), "{to}");
    }
}

#[test]
fn the_sign_of_a_variable_can_be_given() {
    let law = law("k*abs(dq2)*sign(dq2) + m*sign(q1)");
    assert!(law.has_sign_of(0) && law.has_sign_of(1));
    let mut out = [0.0; 2];
    law.columns(&[2.0, -3.0], &[], Some((0, -1.0)), &mut out);
    assert_eq!(out, [-2.0, -1.0]);
}

#[test]
fn the_formula_with_numbers_keeps_what_is_no_constant() {
    let text = law("k1*sin(2*q4) - k*1.5e3*q4").with_numbers(|name| match name {
        "k1" => Some("7".to_owned()),
        "k" => Some("(-2)".to_owned()),
        _ => None,
    });
    assert_eq!(text, "7*sin(2*q4) - (-2)*1.5e3*q4");
}

#[test]
fn the_unit_of_a_constant_is_the_torques_where_it_stands_before_a_pure_number() {
    let of = |text| law(text).parameters([&[1.0], &[0.1]], [&[], &[]], "N.m")[0].unit.clone();
    assert_eq!(of("k*sin(2*q4)*3"), "N.m");
    assert_eq!(of("k*dq4"), "SI");
}
