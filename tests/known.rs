//! Standard parameters whose values are known: not identified, and what is identified is what the rest of the torques says.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

mod common;

use common::{Folder, error_of, words_of};
use serde_json::Value;

const ARM: &str = "name: weighed
gravity: [0, -9.81, 0]
frames:
  - {j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}
  - {j: 2, sigma: 0, alpha: 0, d: 0.5, theta: q2, r: 0}
limits: {position: 2, velocity: 3, acceleration: 10, torque: 200}
nominal:
  parameters: {XX1: 0.3, YY1: 0.45, ZZ1: 0.6, MX1: 1, M1: 4, Ia1: 0.4, Fv1: 2, Fc1: 1.5, XX2: 0.1, YY2: 0.22, ZZ2: 0.25,
    MX2: 0.7, M2: 3, Ia2: 0.3, Fv2: 1, Fc2: 1}
  controller: {kp: [900, 500], kd: [40, 20], ki: 100}
  noise: {position: 1e-5, torque: 0.5}
";

struct Run(Folder);

impl Run {
    fn ok(&self, words: &[&str]) -> String {
        let output = self.0.run(words);
        assert!(output.status.success(), "{words:?}: {}", error_of(&output));
        words_of(&output)
    }

    /// Identifies the recording with a table that knows this, and reads the model.
    fn identified(&self, known: &str, more: &[&str]) -> Value {
        let nominal = ARM.replace(", Ia2: 0.3", if known.contains("Ia2") { "" } else { ", Ia2: 0.3" });
        self.0.write("table.yaml", &nominal.replace("limits:", &format!("{known}\nlimits:")));
        let recording = std::fs::read_to_string(self.0.path("a/recording.yaml")).unwrap();
        let own = recording.lines().find(|line| line.starts_with("robot:")).unwrap().to_owned();
        self.0.write("a/other.yaml", &recording.replace(&own, "robot: ../table.yaml"));
        self.ok(&[&["identify", "a/other.yaml", "--out", "m.json"], more].concat());
        serde_json::from_str(&std::fs::read_to_string(self.0.path("m.json")).unwrap()).unwrap()
    }
}

fn run(name: &str) -> Run {
    let folder = Folder::new(name);
    folder.write("weighed.yaml", ARM);
    let run = Run(folder);
    run.ok(&["excite", "./weighed.yaml", "--out", "plan", "--starts", "1", "--evaluations", "1"]);
    run.ok(&["simulate", "./weighed.yaml", "--follow", "plan", "--rate", "500", "--out", "a"]);
    run
}

fn of(model: &Value, name: &str) -> [f64; 2] {
    let all = model["base_parameters"].as_array().unwrap();
    let found = all.iter().find(|p| p["name"] == name).unwrap_or_else(|| panic!("no {name}"));
    [found["value"].as_f64().unwrap(), found["sigma"].as_f64().unwrap_or(f64::NAN)]
}

#[test]
fn what_is_known_is_kept_and_makes_the_rest_more_certain() {
    let run = run("known");
    let free = run.identified("", &[]);
    let held = run.identified("known: {Ia2: 0.3, Fc1: 1.5, M2: 3}", &[]);
    assert_eq!((of(&held, "Ia2"), of(&held, "Fc1")), ([0.3, 0.0], [1.5, 0.0]));
    for (name, truth) in [("ZZ2", 0.25), ("Fv1", 2.0), ("ZZ1R", 0.6 + 0.4 + 0.25 * 3.0)] {
        let ([_, before], [value, sigma]) = (of(&free, name), of(&held, name));
        assert!(
            (value - truth).abs() < 5.0 * sigma && sigma < before,
            "{name}: {value} ± {sigma}, ± {before}"
        );
    }
    // The noise decides the error, so that it is the same.
    let errors = [&free, &held].map(|model| model["relative_error"].as_f64().unwrap());
    assert!((errors[0] - errors[1]).abs() < 1e-3, "{errors:?}");
    // The model is whole: its torques are those of the robot, and it can be simulated.
    run.ok(&["validate", "m.json", "a/recording.yaml"]);
    run.ok(&["simulate", "m.json", "--out", "b", "--rate", "500", "--period", "6"]);
    let own = std::fs::read_dir(run.0.path("b")).unwrap().map(|e| std::fs::read_to_string(e.unwrap().path()));
    assert!(own.flatten().any(|text| text.contains("known: {Fc1: 1.5, M2: 3, Ia2: 0.3}")));
    let shown = run.ok(&["show", "./table.yaml", "--base"]);
    assert!(shown.contains("known: Fc1 1.50000, M2 3.00000, Ia2 0.300000"), "{shown}");
    assert!(shown.contains("not identified, because all that is part of them is known: Fc1 Ia2"), "{shown}");
}

#[test]
fn every_way_of_identifying_keeps_what_is_known() {
    let run = run("known_ways");
    for method in ["idim-ols", "idim-irls", "idim-tls", "pim-wls", "iv", "didim"] {
        let planned = ["--planned", "plan"];
        let more: &[&str] = if method == "iv" || method == "didim" { &planned } else { &[] };
        let held = run.identified("known: {Ia2: 0.3}", &[&["--method", method], more].concat());
        assert_eq!(of(&held, "Ia2"), [0.3, 0.0], "{method}");
        let [value, _] = of(&held, "ZZ2");
        assert!((value - 0.25).abs() < 0.05, "{method}: {value}");
    }
    let held = run.identified("known: {Ia2: 0.3, M2: 3}", &["--physical"]);
    let table = &held["table"];
    let standard = table["standard"].as_array().unwrap();
    let at = |name: &str| standard.iter().position(|p| p["name"] == name).unwrap();
    let value = |name: &str| table["nominal"]["standard"][at(name)].as_f64().unwrap();
    assert!((value("M2") - 3.0).abs() < 1e-4 && (value("Ia2") - 0.3).abs() < 1e-5, "{}", value("M2"));
}

#[test]
fn a_value_that_is_wrong_is_not_made_right() {
    let run = run("known_wrong");
    let held = run.identified("known: {Ia2: 0.9}\n", &[]);
    assert_eq!(of(&held, "Ia2"), [0.9, 0.0]);
    let free = run.identified("", &[]);
    let errors = [&held, &free].map(|model| model["relative_error"].as_f64().unwrap());
    assert!(errors[0] > 1.2 * errors[1], "{errors:?}");
}

#[test]
fn a_diagnosis_and_a_plan_of_motions_hold_what_is_known() {
    let run = run("known_diagnosed");
    run.identified("known: {Ia2: 0.3, Fc1: 1.5}", &[]);
    run.ok(&["diagnose", "a/other.yaml", "--out", "d.json"]);
    let found: Value = serde_json::from_str(&std::fs::read_to_string(run.0.path("d.json")).unwrap()).unwrap();
    assert_eq!((of(&found, "Ia2"), of(&found, "Fc1")), ([0.3, 0.0], [1.5, 0.0]));
    assert!(found["effects"].as_array().is_none_or(|effects| effects.is_empty()), "{}", found["effects"]);
    // Fewer unknowns have less information in all, and are as well conditioned.
    let logarithm = |table: &str| -> f64 {
        let words = run.ok(&["excite", table, "--out", "plan2", "--starts", "1", "--evaluations", "1"]);
        let line = words.lines().find(|line| line.starts_with("log det")).unwrap().to_owned();
        line.split_whitespace().rev().nth(1).unwrap().parse().unwrap()
    };
    let (known, free) = (logarithm("./table.yaml"), logarithm("./weighed.yaml"));
    assert!(known < free - 1.0, "{known} {free}");
}
