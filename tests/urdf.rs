//! URDFs as robots: the table has the torques that Pinocchio has of the file (`benches/peers/urdf_reference.py`), tables
//! written as URDF come back the same, and what is wrong is told with its place.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

mod common;

use std::path::{Path, PathBuf};

use common::{Folder, error_of, words_of};
use dynid_codegen::base::base_set;
use dynid_codegen::numeric_robot;
use dynid_codegen::robot::parse;
use dynid_runtime::model::{ParameterKind, RecursiveModel, Robot, torques_at};
use dynid_urdf::{ImportOptions, Skeleton, import, read, write_urdf};
use proptest::prelude::*;

fn inputs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/urdf")
}

fn robot_of(yaml: &str) -> Robot {
    let table = parse("arm.yaml", yaml.as_bytes()).unwrap_or_else(|mistakes| panic!("{mistakes:?}\n{yaml}"));
    numeric_robot(&table, &base_set(&table))
}

fn imported(urdf: &str, options: &ImportOptions) -> Robot {
    let urdf = read(urdf.as_bytes(), options.snap).unwrap_or_else(|mistakes| panic!("{mistakes:?}"));
    robot_of(&import(&urdf, "arm.urdf", options).unwrap_or_else(|mistakes| panic!("{mistakes:?}")).yaml)
}

/// Nominal standard parameters of bodies alone.
fn bodies(robot: &Robot) -> Vec<f64> {
    let nominal = robot.nominal.as_ref().unwrap();
    let kinds = robot.standard.iter().zip(nominal.standard.iter());
    kinds.map(|(p, x)| if ParameterKind::INERTIAL.contains(&p.kind) { *x } else { 0.0 }).collect()
}

#[test]
fn a_table_has_the_torques_that_pinocchio_has_of_the_urdf() {
    for name in ["leaning", "twins", "winch"] {
        let urdf = std::fs::read_to_string(inputs().join(format!("{name}.urdf"))).unwrap();
        let reference = std::fs::read_to_string(inputs().join(format!("{name}.json"))).unwrap();
        let reference: serde_json::Value = serde_json::from_str(&reference).unwrap();
        let states: Vec<[Vec<f64>; 3]> = serde_json::from_value(reference["states"].clone()).unwrap();
        let torques: Vec<Vec<f64>> = serde_json::from_value(reference["torques"].clone()).unwrap();
        let robot = imported(&urdf, &ImportOptions::default());
        let chi = robot.base_from_standard(&bodies(&robot));
        let model = RecursiveModel::new(robot).unwrap();
        let largest = torques.iter().flatten().fold(0.0_f64, |most, t| most.max(t.abs()));
        for ([q, dq, ddq], expected) in states.iter().zip(&torques) {
            for (own, expected) in torques_at(&model, &chi, q, dq, ddq).iter().zip(expected) {
                assert!((own - expected).abs() < 1e-12 * largest, "{name}: {own} {expected}");
            }
        }
    }
}

#[test]
fn joints_that_mimic_others_are_rows_that_move_with_them() {
    let urdf = std::fs::read(inputs().join("winch.urdf")).unwrap();
    let options = ImportOptions::default();
    let urdf = read(&urdf, options.snap).unwrap();
    let imported = import(&urdf, "winch.urdf", &options).unwrap();
    assert_eq!(imported.joints, ["turn", "lift"]);
    let robot = robot_of(&imported.yaml);
    assert_eq!((robot.joints(), robot.frames.len()), (2, 6));
    for entry in ["theta: -q2 + 0.3,", "theta: -q2 + 0.4,", "r: 0.15*q2 + ", "r: -0.15*q2 + "] {
        assert!(imported.yaml.contains(entry), "{entry}: {}", imported.yaml);
    }
    let chain = ImportOptions { base: Some("arm".to_owned()), tip: Some("plate".to_owned()), ..options };
    let mistakes = import(&urdf, "winch.urdf", &chain).unwrap_err();
    assert!(mistakes.len() == 1 && mistakes[0].message.contains("does not move here"), "{mistakes:?}");
}

#[test]
fn axes_that_are_nearly_parallel_have_a_frame_between_them_and_right_angles_have_none() {
    let urdf = std::fs::read_to_string(inputs().join("twins.urdf")).unwrap();
    let exact = imported(&urdf, &ImportOptions::default());
    let snapped = imported(&urdf, &ImportOptions { snap: 1e-3, ..ImportOptions::default() });
    assert_eq!((exact.frames.len(), snapped.frames.len()), (5, 4));
    assert_eq!(exact.joints(), 4);
    assert!(snapped.base.len() < exact.base.len());
    let longest =
        exact.frames.iter().flat_map(|f| [f.b, f.d, f.r]).fold(0.0_f64, |most, x| most.max(x.abs()));
    assert!(longest < 2.0, "{longest} m");
}

#[test]
fn a_table_written_as_urdf_comes_back_with_the_same_base_parameters() {
    let mut count = 0;
    for entry in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("robots")).unwrap() {
        let robot = robot_of(&std::fs::read_to_string(entry.unwrap().path()).unwrap());
        // A URDF has no words for a bar that turns with the difference of two joints.
        if !robot.dependent.is_empty() {
            continue;
        }
        let standard = bodies(&robot);
        let size = robot.gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
        let text = write_urdf(&Skeleton::of_table(&robot, &standard));
        let again =
            imported(&text, &ImportOptions { gravity: [0.0, 0.0, -size], ..ImportOptions::default() });
        // Fixed frames have become part of what carries them: parameters are told apart by kind and joint.
        let named = |robot: &Robot, standard: &[f64]| -> Vec<(ParameterKind, usize, f64)> {
            let joints = robot.joint_of_frame();
            let chi = robot.base_from_standard(standard);
            let of = |(b, value): (&dynid_runtime::model::BaseParameter, f64)| {
                let p = &robot.standard[b.standard];
                ParameterKind::INERTIAL.contains(&p.kind).then(|| (p.kind, joints[p.frame].unwrap(), value))
            };
            robot.base.iter().zip(chi).filter_map(of).collect()
        };
        let (before, after) = (named(&robot, &standard), named(&again, &bodies(&again)));
        assert_eq!(before.len(), after.len(), "{}\n{text}", robot.name);
        for (a, b) in before.iter().zip(&after) {
            assert_eq!((a.0, a.1), (b.0, b.1), "{}", robot.name);
            let scale = before.iter().filter(|c| c.0 == a.0).fold(a.2.abs(), |most, c| most.max(c.2.abs()));
            assert!((a.2 - b.2).abs() <= 1e-12 * scale, "{}: {a:?} {b:?}", robot.name);
        }
        count += 1;
    }
    assert_eq!(count, 9);
}

const HEAD: &str = "<robot name=\"arm\">\n<link name=\"a\"/>\n<link name=\"b\"/>\n<link name=\"c\"/>\n";

fn joint(name: &str, kind: &str, ends: [&str; 2], more: &str) -> String {
    let [parent, child] = ends;
    format!(
        "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/>{more}</joint>\n"
    )
}

#[test]
fn what_is_wrong_in_a_urdf_is_told_with_its_place() {
    let folder = Folder::new("urdf-wrong");
    let one = joint("j1", "revolute", ["a", "b"], "<axis xyz=\"0 0 1\"/>");
    let whole = |rest: &str| format!("{HEAD}{one}{rest}</robot>");
    let chain = joint("j2", "revolute", ["b", "c"], "");
    let cases: [(String, &[&str]); 19] = [
        ("<robot".to_owned(), &["w.urdf:1:", "not XML"]),
        ("<sdf/>".to_owned(), &["w.urdf:1:1", "<robot>", "<sdf>"]),
        (whole(""), &["w.urdf:4:1", "'c' hangs together with nothing"]),
        (whole(&joint("j2", "revolute", ["a", "b"], "")), &["w.urdf:6:1", "closes a loop"]),
        (format!("{HEAD}{one}{}</robot>", joint("j0", "fixed", ["b", "a"], "")), &["circle"]),
        (whole(&joint("j2", "revolute", ["b", "d"], "")), &["w.urdf:6:", "no link 'd'"]),
        (whole(&joint("j2", "hinge", ["b", "c"], "")), &["w.urdf:6:1", "'hinge'", "revolute"]),
        (whole(&joint("j2", "floating", ["b", "c"], "")), &["w.urdf:6:1", "floating", "--base"]),
        (
            whole(&joint("j2", "revolute", ["b", "c"], "<mimic joint=\"j1\" multiplier=\"0.5\"/>")),
            &["w.urdf:6:", "mimics 'j1' 0.5 times", "whole multiples", "--tip"],
        ),
        (
            whole(&joint("j2", "revolute", ["b", "c"], "<mimic joint=\"j1\" multiplier=\"0\"/>")),
            &["w.urdf:6:", "mimics 'j1' 0 times", "fixed"],
        ),
        (
            whole(&joint("j2", "revolute", ["b", "c"], "<mimic joint=\"j2\"/>")),
            &["w.urdf:6:", "'j2' mimics itself"],
        ),
        (
            format!(
                "{HEAD}{}{}</robot>",
                joint("j1", "prismatic", ["a", "b"], ""),
                joint("j2", "revolute", ["b", "c"], "<mimic joint=\"j1\"/>")
            ),
            &["w.urdf:6:", "'j2' turns and mimics 'j1'", "no sum of angles"],
        ),
        (
            whole(&joint("j2", "revolute", ["b", "c"], "<mimic joint=\"j9\"/>")),
            &["w.urdf:6:", "'j9'", "not a joint"],
        ),
        (
            whole(&joint("j2", "revolute", ["b", "c"], "<axis xyz=\"0 0 0\"/>")),
            &["w.urdf:6:", "axis", "zero"],
        ),
        (
            whole(&joint("j2", "revolute", ["b", "c"], "<origin xyz=\"0 0 x\"/>")),
            &["w.urdf:6:", "'x'", "finite"],
        ),
        (whole(&joint("j2", "revolute", ["b", "c"], "<origin xyz=\"0 0\"/>")), &["w.urdf:6:", "3 numbers"]),
        (whole(&joint("j2", "revolute", ["b", "c"], "<origin rpy=\"${pi} 0 0\"/>")), &["w.urdf:6:", "xacro"]),
        (
            "<robot name=\"arm\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\">\n<xacro:arm/></robot>"
                .to_owned(),
            &["w.urdf:2:1", "xacro", "expanded"],
        ),
        (
            whole(&chain).replace("<link name=\"a\"/>", "<link name=\"a\"/><link name=\"a\"/>"),
            &["w.urdf:2:17", "twice"],
        ),
    ];
    for (text, expected) in cases {
        folder.write("w.urdf", &text);
        let output = folder.run(&["import", "w.urdf", "--out", "w.yaml"]);
        let error = error_of(&output);
        assert_eq!(output.status.code(), Some(2), "{text}: {error}");
        expected.iter().for_each(|part| assert!(error.contains(part), "'{part}' is not in: {error}"));
    }
    folder.write("w.urdf", &whole(&chain));
    for (words, expected) in [
        (["--base", "x"], "no link 'x'"),
        (["--tip", "y"], "no link 'y'"),
        (["--base", "c"], "no joint moves"),
    ] {
        let output = folder.run(&["import", "w.urdf", "--out", "w.yaml", words[0], words[1]]);
        assert_eq!(output.status.code(), Some(2));
        assert!(error_of(&output).contains(expected), "{}", error_of(&output));
    }
    let output = folder.run(&["import", "w.urdf", "--out", "w.yaml"]);
    assert!(output.status.success(), "{}", error_of(&output));
    assert!(error_of(&output).contains("link 'b' has no <inertial>"), "{}", error_of(&output));
    std::fs::write(folder.path("w.urdf"), b"<robot name=\"\xff\"/>").unwrap();
    let output = folder.run(&["show", "w.urdf"]);
    assert!(error_of(&output).contains("w.urdf:1:14: the file is not UTF-8"), "{}", error_of(&output));
}

#[test]
fn a_file_of_one_long_line_is_read_in_no_time() {
    let mut text = String::from("<robot name=\"arm\"><link name=\"l0\"/>");
    for k in 0..40_000 {
        let kind = if k % 2 == 0 { "fixed" } else { "revolute" };
        text.push_str(&format!("<link name=\"l{}\"/>", k + 1));
        text.push_str(
            joint(&format!("j{k}"), kind, [&format!("l{k}"), &format!("l{}", k + 1)], "").trim_end(),
        );
    }
    let start = std::time::Instant::now();
    let urdf = read((text + "</robot>").as_bytes(), 1e-8).unwrap();
    let mistakes = import(&urdf, "arm.urdf", &ImportOptions::default()).unwrap_err();
    assert!(mistakes[0].to_string().contains("20000 frames"), "{mistakes:?}");
    let chain = ImportOptions { base: Some("l39990".to_owned()), ..ImportOptions::default() };
    assert_eq!(import(&urdf, "arm.urdf", &chain).unwrap().joints.len(), 5);
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
}

/// What a number, a name or a tag may become.
const PIECES: [&str; 16] = [
    "1e308",
    "-1e9",
    "1e-300",
    "nan",
    "inf",
    "0",
    "-0.0",
    "1.5708",
    "3.14159265359",
    "${x}",
    "",
    "base",
    "fixed",
    "mimic",
    "<",
    "\"",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn whatever_becomes_of_a_urdf_it_is_answered(
        which in 0..3_usize,
        changes in prop::collection::vec((any::<prop::sample::Index>(), 0..PIECES.len(), 0..4_u8), 1..5),
    ) {
        let name = ["leaning.urdf", "twins.urdf", "winch.urdf"][which];
        let mut text = std::fs::read_to_string(inputs().join(name)).unwrap();
        for (at, piece, kind) in changes {
            // Words between quotes, spaces and brackets.
            let ends: Vec<usize> = text.match_indices(['"', ' ', '<', '>', '/']).map(|(k, _)| k).collect();
            let k = at.index(ends.len().max(2) - 1);
            let Some((start, end)) = ends.get(k).zip(ends.get(k + 1)).map(|(a, b)| (a + 1, *b)) else { break };
            match kind {
                0 | 1 => text.replace_range(start..end, PIECES[piece]),
                2 => text.replace_range(start..end, ""),
                _ => { let again = text[start..end].to_owned(); text.insert_str(end, &again); }
            }
        }
        let options = ImportOptions::default();
        if let Ok(urdf) = read(text.as_bytes(), options.snap)
            && let Ok(imported) = import(&urdf, name, &options)
            && let Err(mistakes) = parse("table", imported.yaml.as_bytes())
        {
            // Only what is larger than a robot is not in a table.
            for mistake in mistakes {
                let words = mistake.to_string();
                prop_assert!(words.contains("expected at"), "{}\n{}", words, imported.yaml);
            }
        }
    }
}

#[test]
fn a_chain_of_a_tree_carries_the_other_joints_along_and_says_so() {
    let folder = Folder::new("urdf-chain");
    folder.write("twins.urdf", &std::fs::read_to_string(inputs().join("twins.urdf")).unwrap());
    let output = folder.run(&["import", "twins.urdf", "--tip", "left_lower", "--out", "left.yaml"]);
    assert!(words_of(&output).contains("joints turn, left_shoulder, left_elbow"), "{}", error_of(&output));
    assert!(error_of(&output).contains("'right_shoulder' is held at 0"), "{}", error_of(&output));
    let left = robot_of(&std::fs::read_to_string(folder.path("left.yaml")).unwrap());
    let mass = |robot: &Robot| {
        bodies(robot)
            .iter()
            .zip(robot.standard.iter())
            .filter(|(_, p)| p.kind == ParameterKind::M)
            .map(|(m, _)| m)
            .sum::<f64>()
    };
    approx::assert_relative_eq!(mass(&left), 9.0 + 2.1 + 1.1 + 1.9, max_relative = 1e-14);
    // The same by path, wherever a robot is asked for.
    let shown = folder.run(&["show", "twins.urdf"]);
    assert!(words_of(&shown).contains("4 joints"), "{}", error_of(&shown));
}
