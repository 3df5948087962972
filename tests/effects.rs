//! `dynid effects` tells what the catalogue knows, and `simulate --effect` puts it into a robot.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

mod common;

use common::{Folder, error_of, json_of, words_of};
use dynid_runtime::effects::{EffectKind, Form};

fn run(folder: &Folder, words: &str) -> std::process::Output {
    folder.run(&words.split(' ').collect::<Vec<_>>())
}

#[test]
fn the_table_names_every_effect_and_which_of_them_need_a_baseline() {
    let folder = Folder::new("effects-table");
    let text = words_of(&run(&folder, "effects"));
    for kind in EffectKind::ALL {
        let line = text.lines().find(|line| line.split_whitespace().next() == Some(kind.id())).unwrap();
        assert!(line.contains(kind.words().title) && line.contains(kind.words().looks_like), "{line}");
        assert_eq!(line.contains(" needed "), kind.needs_baseline(), "{line}");
    }
}

#[test]
fn every_effect_is_told_with_its_law_and_a_picture_where_it_has_one() {
    let folder = Folder::new("effects-each");
    for kind in EffectKind::ALL {
        let output = run(&folder, &format!("effects {} --svg law.svg", kind.id()));
        let has_picture = !matches!(kind.form(), Form::Window | Form::Free);
        assert_eq!(output.status.success(), has_picture, "{}: {}", kind.id(), error_of(&output));
        let text = words_of(&run(&folder, &format!("effects {}", kind.id())));
        let words = kind.words();
        for part in [words.title, words.what, words.looks_like, words.experiment, words.source, words.put_in]
        {
            assert!(text.contains(part), "{}: '{part}' is not in {text}", kind.id());
        }
        assert_eq!(text.contains("***"), has_picture, "{}", kind.id());
        assert!(!text.contains("NaN") && !text.contains("inf "), "{text}");
    }
    let svg = std::fs::read_to_string(folder.path("law.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("<style>"), "{svg}");
}

#[test]
fn an_effect_that_is_misspelt_is_asked_about() {
    let folder = Folder::new("effects-misspelt");
    for words in [
        "effects stribek",
        "simulate planar_2r --effect stribek:1 --out sim",
        "excite planar_2r --tell stribek,spring --joint 1 --out plan",
    ] {
        let output = run(&folder, words);
        assert_eq!(output.status.code(), Some(2), "{words}");
        assert!(error_of(&output).contains("did you mean `stribeck`?"), "{words}: {}", error_of(&output));
    }
}

#[test]
fn what_imitates_a_law_comes_with_the_part_that_it_takes() {
    let folder = Folder::new("effects-imitators");
    let known = json_of(&run(&folder, "effects nonlinear_viscous --json -"));
    let first = &known["imitators"][0];
    assert_eq!(first["effect"], "stribeck");
    assert!(first["part"].as_f64().is_some_and(|part| (0.5..1.0).contains(&part)), "{first}");
    let text = words_of(&run(&folder, "effects nonlinear_viscous"));
    assert!(text.contains("dynid excite ROBOT --tell nonlinear_viscous,stribeck --joint JOINT"), "{text}");
}

#[test]
fn every_law_of_a_joint_can_be_put_into_a_robot_and_is_the_same_for_every_seed() {
    let folder = Folder::new("effects-simulated");
    let short = "--motions 1 --period 1 --rate 1000 --out sim";
    for kind in EffectKind::ALL.into_iter().filter(|kind| matches!(kind.form(), Form::Joint(_))) {
        let said = |seed: u32| {
            let words = format!("simulate planar_2r --effect {}:2:0.5 --seed {seed} {short}", kind.id());
            let output = run(&folder, &words);
            assert!(output.status.success(), "{words}: {}", error_of(&output));
            words_of(&output).lines().next().unwrap().to_owned()
        };
        let first = said(1);
        assert!(
            first.starts_with(&format!("Added: {} on joint 2: ", capital(kind.words().title))),
            "{first}"
        );
        assert_eq!(first, said(2));
    }
    for (effect, words) in [
        ("payload:1", "no law of a joint"),
        ("stribeck:3", "joints of planar_2r are 1, 2"),
        ("stribeck", "ID:JOINT"),
        ("stribeck:1:-2", "0.000001"),
        ("stribeck:1 --ripple 0.5", "torque_ripple is an --effect too"),
    ] {
        let output = run(&folder, &format!("simulate planar_2r --effect {effect} {short}"));
        assert_eq!(output.status.code(), Some(2), "{effect}");
        assert!(error_of(&output).contains(words), "{effect}: {}", error_of(&output));
    }
}

fn capital(title: &str) -> String {
    let lower = title.to_lowercase();
    lower[..1].to_uppercase() + &lower[1..]
}

#[test]
fn a_law_in_a_simulation_changes_its_torques_by_its_size() {
    let folder = Folder::new("effects-size");
    let torques = |more: &str| -> Vec<f64> {
        let words =
            format!("simulate planar_2r --noise 0 --motions 1 --period 2 --rate 1000 {more}--out sim");
        let output = run(&folder, &words);
        assert!(output.status.success(), "{}", error_of(&output));
        let file = std::fs::read_dir(folder.path("sim")).unwrap().map(|entry| entry.unwrap().path());
        let csv = file.filter(|path| path.extension().is_some_and(|e| e == "csv")).min().unwrap();
        let text = std::fs::read_to_string(&csv).unwrap();
        std::fs::remove_dir_all(folder.path("sim")).unwrap();
        let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
        let column = header.iter().position(|name| matches!(*name, "tau1" | "u1" | "torque1")).unwrap();
        text.lines().skip(1).map(|line| line.split(',').nth(column).unwrap().parse().unwrap()).collect()
    };
    let (without, with) = (torques(""), torques("--effect stribeck:1:2 "));
    let differences = without.iter().zip(&with).map(|(a, b)| (a - b).abs());
    let largest = differences.fold(0.0_f64, f64::max);
    // The controller follows the same motion, but not to the last digit.
    assert!((1.0..3.0).contains(&largest), "{largest}");
}

#[test]
fn all_limits_that_a_search_lacks_are_named_with_what_to_write() {
    let folder = Folder::new("effects-limits");
    folder.write("arm.yaml", &format!("{}limits: {{velocity: 3}}\n", common::ARM));
    for words in
        ["excite ./arm.yaml --out plan", "excite ./arm.yaml --tell stribeck,spring --joint 1 --out plan"]
    {
        let output = run(&folder, words);
        assert_eq!(output.status.code(), Some(2), "{words}");
        let error = error_of(&output);
        assert!(
            error.contains("no position and acceleration limits") && error.contains("`frames:`"),
            "{error}"
        );
        assert!(error.contains("limits: {position: [<joint 1, joint 2>], acceleration: "), "{error}");
    }
}
