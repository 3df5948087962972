//! Methods that simulate the planned motions: what they need, what they say, and that they agree with least squares.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

mod common;

use common::{Folder, error_of, json_of, words_of};
use serde_json::Value;

/// A planned motion of a robot, and a recording of it.
fn recorded(name: &str) -> Folder {
    let folder = Folder::new(name);
    for words in [
        "excite planar_2r --out plan --period 5 --starts 1 --evaluations 1",
        "simulate planar_2r --follow plan --out rec --rate 1000 --record-every 2 --seed 3",
    ] {
        let output = folder.run(&words.split(' ').collect::<Vec<_>>());
        assert!(output.status.success(), "{words}: {}", error_of(&output));
    }
    folder
}

fn identified(folder: &Folder, words: &str) -> Value {
    let mut all = vec!["identify", "rec/recording.yaml", "--json", "-"];
    all.extend(words.split(' '));
    let output = folder.run(&all);
    assert!(output.status.success(), "{words}: {}", error_of(&output));
    json_of(&output)
}

#[test]
fn instrumental_variables_and_didim_agree_with_least_squares_and_say_what_they_compare_with() {
    let folder = recorded("planned");
    let least_squares = identified(&folder, "--method idim-wls");
    for (method, name) in [("iv", "idim-iv"), ("didim", "idim-didim")] {
        let found = identified(&folder, &format!("--method {method} --planned plan"));
        assert_eq!(found["method"], name);
        let simulated = &found["simulated"];
        assert_eq!(simulated["compared_with"], "idim-wls");
        assert!(simulated["apart"].as_array().unwrap().iter().all(|a| a.as_f64().unwrap() < 0.01));
        let parameters = found["base_parameters"].as_array().unwrap();
        let usual = least_squares["base_parameters"].as_array().unwrap();
        for ((p, q), value) in parameters.iter().zip(usual).zip(simulated["values"].as_array().unwrap()) {
            assert_eq!(q["value"], *value);
            let [p_value, sigma, q_value] =
                [&p["value"], &p["sigma"], &q["value"]].map(|v| v.as_f64().unwrap());
            assert!((p_value - q_value).abs() < 3.0 * sigma, "{method}: {p} {q}");
        }
        let words =
            ["identify", "rec/recording.yaml", "--planned", "plan", "--method", method, "--report", "r.html"];
        let output = folder.run(&words);
        let said = words_of(&output);
        assert!(said.contains(name) && said.contains("idim-wls") && said.contains("apart"), "{said}");
        assert_eq!(method == "didim", said.contains("change in each iteration"), "{said}");
        let page = std::fs::read_to_string(folder.path("r.html")).unwrap();
        assert!(page.contains("Beside idim-wls") && page.contains("difference / sigma"));
    }
}

#[test]
fn a_plan_that_is_missing_or_of_other_motions_is_refused_in_words() {
    let folder = recorded("planned-refused");
    let refused = |words: &str, status: i32, parts: &[&str]| {
        let mut all = vec!["identify", "rec/recording.yaml"];
        all.extend(words.split(' '));
        let output = folder.run(&all);
        let error = error_of(&output);
        assert_eq!(output.status.code(), Some(status), "{words}: {error}");
        assert!(parts.iter().all(|part| error.contains(part)), "{words}: {error}");
    };
    refused("--method iv", 2, &["planned motions", "--planned", "dynid excite"]);
    refused("--method didim", 2, &["DIDIM", "--planned"]);
    refused("--planned plan", 2, &["idim-wls", "--planned"]);
    refused("--method magic", 2, &["magic", "idim-iv", "idim-didim"]);
    refused("--method iv --planned nowhere", 2, &["nowhere", "dynid excite"]);
    // Half of the motion was planned.
    let short =
        words_of(&folder.run(&["excite", "planar_2r", "--out", "short", "--period", "2", "--starts", "1"]));
    assert!(!short.is_empty());
    refused("--method iv --planned short", 2, &["planned motion lasts", "time 0"]);
}

#[test]
fn a_plan_that_was_not_followed_is_said() {
    let folder = recorded("planned-other");
    let other = "excite planar_2r --out other --period 5 --starts 1 --evaluations 1 --seed 9";
    assert!(folder.run(&other.split(' ').collect::<Vec<_>>()).status.success());
    let output = folder.run(&["identify", "rec/recording.yaml", "--method", "iv", "--planned", "other"]);
    let all = words_of(&output) + &error_of(&output);
    assert!(all.contains("away from where it was recorded"), "{all}");
}
