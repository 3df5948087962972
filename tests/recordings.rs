//! Recordings as robots and people have them: looked at, written to start from, read by other packages.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

mod common;

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use common::{Folder, error_of, json_of, words_of};

fn run(folder: &Folder, words: &str) -> Output {
    folder.run(&words.split(' ').collect::<Vec<_>>())
}

#[track_caller]
fn done(folder: &Folder, words: &str) -> Output {
    let output = run(folder, words);
    assert!(output.status.success(), "{words}: {}", error_of(&output));
    output
}

/// Sines of the joints of the URDF, as a motion to follow.
fn motion() -> String {
    let mut text = String::from("t,q1,q2,q3,q4,q5,dq1,dq2,dq3,dq4,dq5,ddq1,ddq2,ddq3,ddq4,ddq5\n");
    for k in 0..4000 {
        let t = f64::from(k) * 0.005;
        let mut state = [[0.0; 5]; 3];
        for j in 0..5 {
            let scale = if j == 3 { 0.08 } else { 0.9 };
            state[0][j] = if j == 3 { 0.15 } else { 0.0 };
            for (rate, amplitude) in [(1.0, 0.5), (2.3, 0.3), (3.7, 0.2)] {
                let (w, phase) = (rate * (0.9 + 0.23 * j as f64), 0.7 * j as f64 + rate);
                let a = scale * amplitude;
                state[0][j] += a * (w * t + phase).sin();
                state[1][j] += a * w * (w * t + phase).cos();
                state[2][j] -= a * w * w * (w * t + phase).sin();
            }
        }
        let numbers: Vec<String> = state.iter().flatten().map(|x| format!("{x:.9}")).collect();
        text.push_str(&format!("{t},{}\n", numbers.join(",")));
    }
    text
}

/// A folder with a URDF.
fn with_urdf(name: &str) -> Folder {
    let folder = Folder::new(name);
    folder.write("arm.urdf", include_str!("urdf/leaning.urdf"));
    folder
}

fn data(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("runtime/tests/data/formats").join(file)
}

#[test]
fn a_bag_and_a_urdf_come_to_a_diagnosis_in_three_commands() {
    let folder = with_urdf("three");
    folder.write("motion.csv", &motion());
    done(
        &folder,
        "simulate arm.urdf --follow motion.csv --format mcap --out sim --rate 1000 --record-every 4",
    );
    let bag = std::fs::read_dir(folder.path("sim")).unwrap().map(|entry| entry.unwrap().path());
    let bag = bag.filter(|path| path.extension().is_some_and(|e| e == "mcap")).min().unwrap();
    std::fs::copy(bag, folder.path("bag.mcap")).unwrap();

    let readme = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/README.md")).unwrap();
    let block = readme.split("```").find(|block| block.contains("dynid look bag.mcap")).unwrap();
    let lines: Vec<&str> =
        block.trim().lines().map(|line| line.trim().strip_prefix("dynid ").unwrap()).collect();
    let [look, identify, diagnose] = lines.as_slice() else { panic!("{block}") };
    let looked = done(&folder, look);
    assert_eq!(error_of(&looked), "");
    let said = words_of(&looked);
    for words in ["/joint_states", "sensor_msgs/msg/JointState", "shoulder.effort", "250"] {
        assert!(said.contains(words), "'{words}' is not in: {said}");
    }
    let yaml = std::fs::read_to_string(folder.path("recording.yaml")).unwrap();
    assert!(
        yaml.contains("robot: ./arm.urdf\n") && yaml.contains("joints: [waist, shoulder, elbow"),
        "{yaml}"
    );
    done(&folder, identify);
    assert!(folder.path("model.json").is_file());
    let diagnosis = json_of(&done(&folder, &format!("{diagnose} --json -")));
    assert!(diagnosis["before"]["relative_error"].as_f64().unwrap() < 0.2, "{diagnosis}");
}

#[test]
fn what_simulate_writes_in_any_format_gives_the_same_parameters() {
    let folder = Folder::new("any-format");
    let values = |format: &str| -> Vec<f64> {
        let simulate =
            format!("simulate planar_2r --out {format} --format {format} --motions 1 --period 4 --rate 1000");
        done(&folder, &simulate);
        let json = json_of(&done(&folder, &format!("identify {format}/recording.yaml --json -")));
        json["base_parameters"].as_array().unwrap().iter().map(|p| p["value"].as_f64().unwrap()).collect()
    };
    let csv = values("csv");
    assert_eq!(csv, values("parquet"), "doubles are written as they are");
    for (a, b) in csv.iter().zip(values("mcap")) {
        approx::assert_relative_eq!(*a, b, max_relative = 1e-4, epsilon = 1e-6);
    }
}

#[test]
fn a_look_tells_what_is_in_a_file_and_what_only_a_person_knows() {
    let folder = Folder::new("look");
    let look = |file: &str, more: &[&str]| {
        let path = data(file);
        let mut words = vec!["look", path.to_str().unwrap(), "--json", "-"];
        words.extend(more);
        json_of(&folder.run(&words))
    };
    let log = look("several.mcap", &[]);
    assert_eq!(
        (&log["topics"][0]["name"], &log["topic"]),
        (&"/joint_states".into(), &"/joint_states".into())
    );
    let names: Vec<&str> =
        log["signals"].as_array().unwrap().iter().map(|s| s["name"].as_str().unwrap()).collect();
    assert!(names.contains(&"elbow.effort") && names.contains(&"finger.position"), "{names:?}");
    let open = log["open"].to_string();
    assert!(open.contains("--robot") && open.contains("--unit"), "{open}");

    let table = look("types.parquet", &["--unit", "N.m", "--robot", "planar_2r"]);
    assert_eq!(table["open"], serde_json::json!([]));
    let yaml = table["recording"].as_str().unwrap();
    for line in [
        "time: {column: t, unit: ns",
        "position: {columns: [q1, q2]}",
        "torque: {columns: [u1, u2], unit: N.m}",
    ] {
        assert!(yaml.contains(line), "'{line}' is not in: {yaml}");
    }
    assert!(table["wrong"].to_string().contains("`u1` lacks a number in 2 of 40 rows"), "{}", table["wrong"]);

    folder.write(
        "german.csv",
        &(0..50)
            .map(|k| format!("{},{};0,5;1,{k}\n", k / 10, k % 10))
            .fold(String::from("t;q1;u1\n"), |a, b| a + &b),
    );
    let text = json_of(&folder.run(&["look", "german.csv", "--json", "-"]));
    assert!(text["recording"].as_str().unwrap().contains("delimiter: \";\", decimal: \",\""), "{text}");
    assert!(text["wrong"].to_string().contains("`q1` is 0.5 all the time"), "{}", text["wrong"]);

    let two = folder.run(&["look", data("two_topics.mcap").to_str().unwrap()]);
    assert!(words_of(&two).contains("several topics tell of joints"), "{}", words_of(&two));
    let lists = look("lists.parquet", &[]);
    assert!(lists["signals"].to_string().contains("observation.state[3]"));
    let none = folder.run(&["look", "german.cvs"]);
    assert_eq!(none.status.code(), Some(2));
    assert!(error_of(&none).contains("did you mean `german.csv`"), "{}", error_of(&none));
}

#[test]
fn a_recording_yaml_is_looked_at_too() {
    let folder = Folder::new("look-yaml");
    folder.write("recording.yaml", common::MANIFEST).write("motion.csv", &common::moving(300));
    let said = words_of(&done(&folder, "look recording.yaml"));
    assert!(said.contains("motion.csv") && said.contains("300"), "{said}");
    assert_eq!(run(&folder, "look recording.yaml --out x.yaml").status.code(), Some(2));
}

#[test]
fn what_init_writes_is_a_robot_and_a_recording() {
    let folder = Folder::new("init");
    done(&folder, "init");
    done(&folder, "show ./robot.yaml");
    let moving = common::moving(900).replacen("u1,u2", "tau1,tau2", 1);
    folder.write("motion1.csv", &moving);
    let read = run(&folder, "look recording.yaml");
    assert!(read.status.success(), "{}", error_of(&read));
    let again = run(&folder, "init");
    assert_eq!(again.status.code(), Some(2));
    assert!(error_of(&again).contains("robot.yaml"));
}

#[test]
fn a_wrong_layout_and_a_wrong_column_are_told_with_what_mends_them() {
    let folder = Folder::new("layout");
    let text = common::moving(300);
    folder.write("recording.yaml", common::MANIFEST).write("motion.csv", &text.replace(',', ";"));
    let error = error_of(&run(&folder, "identify recording.yaml"));
    assert!(error.contains("`layout: {header: true, delimiter: \";\"}`"), "{error}");
    folder.write("motion.csv", &text.replace(',', ";").replace('.', ","));
    folder.write("semicolon.yaml", &common::MANIFEST.replace("\",\"", "\";\""));
    let error = error_of(&run(&folder, "identify semicolon.yaml"));
    assert!(error.contains("decimal: \",\""), "{error}");
    folder.write("motion.csv", &text);
    folder.write("column.yaml", &common::MANIFEST.replace("q1", "Q1"));
    assert!(error_of(&run(&folder, "identify column.yaml")).contains("did you mean `q1`"));
    assert!(error_of(&run(&folder, "identify recordin.yaml")).contains("did you mean `recording.yaml`"));
}

#[test]
fn completions_and_the_manual_name_every_command() {
    let folder = Folder::new("completions");
    for shell in ["bash", "zsh", "fish"] {
        let text = words_of(&done(&folder, &format!("completions {shell}")));
        assert!(text.contains("identify") && text.contains("look"), "{shell}");
    }
    let manual = words_of(&done(&folder, "man"));
    assert!(manual.starts_with(".ie") || manual.contains(".TH"), "{}", &manual[..80]);
    assert!(manual.contains("DYNID LOOK") && manual.contains("DYNID DIAGNOSE"));
}

/// The official packages read what `simulate` writes, number for number.
#[test]
fn official_packages_read_what_is_written() {
    let Some(python) = std::env::var_os("DYNID_PYTHON") else {
        let _ = writeln!(
            std::io::stderr(),
            "skipped: DYNID_PYTHON names no Python with mcap, mcap-ros2-support and pyarrow"
        );
        return;
    };
    let folder = Folder::new("official");
    for format in ["csv", "parquet", "mcap"] {
        done(
            &folder,
            &format!("simulate planar_2r --out {format} --format {format} --motions 1 --period 2 --rate 500"),
        );
    }
    folder.write(
        "check.py",
        "import csv, glob\n\
         import pyarrow.parquet as pq\n\
         from mcap.reader import make_reader\n\
         from mcap_ros2.decoder import DecoderFactory\n\
         rows = [[float(x) for x in row] for row in list(csv.reader(open(glob.glob('csv/*.csv')[0])))[1:]]\n\
         table = pq.read_table(glob.glob('parquet/*.parquet')[0])\n\
         assert table.column_names == ['t', 'q1', 'q2', 'tau1', 'tau2'], table.column_names\n\
         assert [list(row) for row in zip(*(column.to_pylist() for column in table.columns))] == rows\n\
         reader = make_reader(open(glob.glob('mcap/*.mcap')[0], 'rb'), decoder_factories=[DecoderFactory()])\n\
         summary = reader.get_summary()\n\
         assert summary.statistics.message_count == len(rows), summary\n\
         read = [m.ros_msg if hasattr(m, 'ros_msg') else m.decoded_message for m in reader.iter_decoded_messages()]\n\
         assert len(read) == len(rows), (len(read), len(rows))\n\
         for message, row in zip(read, rows):\n\
         \x20   assert list(message.name) == ['joint1', 'joint2']\n\
         \x20   assert list(message.position) == row[1:3] and list(message.effort) == row[3:5]\n\
         \x20   stamp = message.header.stamp.sec - 1_000_000_000 + 1e-9 * message.header.stamp.nanosec\n\
         \x20   assert abs(stamp - row[0]) < 1e-9\n",
    );
    let output = Command::new(python).arg("check.py").current_dir(&folder.0).output().unwrap();
    assert!(output.status.success(), "{}", error_of(&output));
}

#[test]
fn gains_that_are_given_stand_in_the_yaml_and_others_have_a_place_to_be_filled_in() {
    let folder = Folder::new("gains");
    folder.write("m.csv", "t,q1,q2,i1,i2\n0,0,0,1,2\n0.01,0.1,0.2,2,1\n0.02,0.2,0.1,1,1\n");
    let looked = words_of(&done(&folder, "look m.csv --robot planar_2r --unit A --gain 11.5,-7 --out -"));
    assert!(looked.contains("columns: [i1, i2], unit: A, gain: [11.5, -7]}"), "{looked}");
    let without = words_of(&done(&folder, "look m.csv --robot planar_2r --unit A --out -"));
    assert!(without.contains("# to be filled in: , gain: [N.m per A of each joint]}"), "{without}");
    let output = run(&folder, "look m.csv --robot planar_2r --unit A --gain 11.5 --out -");
    assert_eq!(output.status.code(), Some(2));
    assert!(
        error_of(&output).contains("--gain has 1 numbers, but the robot has 2 joints"),
        "{}",
        error_of(&output)
    );
}

#[test]
fn a_topic_of_any_type_is_looked_at_and_written_as_columns() {
    let folder = Folder::new("topic");
    std::fs::copy(data("controller.mcap"), folder.path("log.mcap")).unwrap();
    let none = words_of(&done(&folder, "look log.mcap"));
    assert!(none.contains("--topic looks at another one"), "{none}");
    let look = "look log.mcap --topic /arm_controller/state --robot planar_2r --unit N.m --out r.yaml";
    let said = words_of(&done(&folder, look));
    for words in ["actual.positions[elbow]", "actual.effort[shoulder]", "load"] {
        assert!(said.contains(words), "'{words}' is not in: {said}");
    }
    let yaml = std::fs::read_to_string(folder.path("r.yaml")).unwrap();
    assert!(
        yaml.contains("position: {columns: [\"actual.positions[elbow]\", \"actual.positions[shoulder]\"]}"),
        "{yaml}"
    );
    assert!(yaml.contains("topic: /arm_controller/state"), "{yaml}");
    let motions = json_of(&done(&folder, "look r.yaml --json -"));
    assert_eq!(motions[0]["rows"], 40, "{motions}");
}
