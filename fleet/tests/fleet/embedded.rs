//! In one process.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use dynid_runtime::estimation::observe::Equations;
use dynid_runtime::estimation::{EstimateSettings, RecordedSettings, estimate, observe_recording};
use dynid_runtime::recording::Manifest;

use crate::common::{Fleet, PROGRAM, ask, numbers, pairs, parquet_files};

#[test]
fn parameters_and_standard_deviations_are_those_of_identify() {
    let fleet = Fleet::new(1, 1);
    let out = fleet.out("o");
    fleet.run(&out);
    let manifest = Manifest::read(&fleet.recording("r001", 1).join("recording.yaml")).unwrap();
    let model = dynid::models::find("tx40").unwrap();
    let settings = RecordedSettings::default();
    let observed = observe_recording(&manifest, model, None, &[Equations::Torque], &settings, None).unwrap();
    let expected = estimate(&observed.observations[0], &EstimateSettings::default());
    let found = ask(&out, "SELECT value, sigma, parameter FROM parameters");
    let values = numbers(&out, "SELECT value FROM parameters WHERE sigma IS NOT NULL");
    let sigmas = numbers(&out, "SELECT sigma FROM parameters WHERE sigma IS NOT NULL");
    let determined: Vec<_> = expected.parameters.iter().filter(|p| p.sigma.is_some()).collect();
    assert_eq!(found.iter().map(|b| b.num_rows()).sum::<usize>(), expected.parameters.len());
    assert_eq!(values.len(), determined.len());
    for ((value, sigma), expected) in values.iter().zip(&sigmas).zip(determined) {
        let own = expected.sigma.unwrap();
        assert!((value - expected.value).abs() < 1e-6 * own, "{}: {value} {}", expected.name, expected.value);
        assert!((sigma / own - 1.0).abs() < 1e-6, "{}: {sigma} {own}", expected.name);
    }
}

#[test]
fn a_second_run_does_nothing_and_a_new_day_is_all_that_is_done() {
    let fleet = Fleet::new(2, 3);
    let away = fleet.out("away");
    std::fs::rename(fleet.recording("r002", 3), &away).unwrap();
    let out = fleet.out("o");
    let first = fleet.run(&out);
    assert_eq!((first.recordings, first.reduced, first.days), (5, 5, 3));
    let before = parquet_files(&out);
    let again = fleet.run(&out);
    assert_eq!((again.recordings, again.reduced, again.days), (5, 0, 0));
    assert_eq!(before, parquet_files(&out));
    std::fs::rename(&away, fleet.recording("r002", 3)).unwrap();
    let late = fleet.run(&out);
    assert_eq!((late.recordings, late.reduced, late.days), (6, 1, 1));
    let whole = fleet.out("whole");
    fleet.run(&whole);
    assert_eq!(parquet_files(&whole), parquet_files(&out));
}

#[test]
fn a_run_that_was_killed_goes_on_where_it_was() {
    let fleet = Fleet::new(3, 3);
    let (out, whole) = (fleet.out("o"), fleet.out("whole"));
    let mut run = Command::new(PROGRAM)
        .args([
            "run",
            &fleet.file.display().to_string(),
            "--threads",
            "1",
            "--out",
            &out.display().to_string(),
        ])
        .stderr(Stdio::null())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let is_whole = |path: &std::path::Path| path.extension().is_some_and(|e| e == "parquet");
    let kept = || {
        let files = std::fs::read_dir(out.join("pending"));
        files.map_or(0, |files| files.flatten().filter(|file| is_whole(&file.path())).count())
    };
    let start = Instant::now();
    while kept() < 2 {
        assert!(start.elapsed() < Duration::from_secs(120), "nothing was reduced");
        assert!(run.try_wait().unwrap().is_none(), "it was done before it could be killed");
        std::thread::sleep(Duration::from_millis(5));
    }
    run.kill().unwrap();
    run.wait().unwrap();
    let summary = fleet.run(&out);
    assert!(summary.reduced <= 7, "{summary:?}");
    assert_eq!(summary.recordings, 9);
    fleet.run(&whole);
    assert_eq!(parquet_files(&whole), parquet_files(&out));
}

#[test]
fn a_recording_that_cannot_be_used_is_a_row_and_the_others_are_as_without_it() {
    let fleet = Fleet::new(4, 1);
    let (sound, out) = (fleet.out("sound"), fleet.out("o"));
    fleet.run(&sound);
    let data = |robot: &str| {
        let files = std::fs::read_dir(fleet.recording(robot, 1)).unwrap().flatten();
        files.map(|f| f.path()).find(|p| p.extension().is_some_and(|e| e == "csv")).unwrap()
    };
    std::fs::write(data("r002"), b"\x00\xff\x13 no table").unwrap();
    std::fs::write(fleet.recording("r003", 1).join("recording.yaml"), "robot: tx40\ntime: [\n").unwrap();
    // The sign of one torque: no such robot can have made it.
    let manifest = fleet.recording("r004", 1).join("recording.yaml");
    let text = std::fs::read_to_string(&manifest).unwrap();
    let swapped = text.replacen("q1, q2", "q2, q1", 1).replacen("q1\", \"q2", "q2\", \"q1", 1);
    assert_ne!(text, swapped, "{text}");
    std::fs::write(&manifest, swapped).unwrap();
    let summary = fleet.run(&out);
    assert_eq!((summary.reduced, summary.days), (4, 1));
    let outcomes = pairs(&out, "SELECT robot, outcome FROM screening ORDER BY robot");
    let outcomes: Vec<&str> = outcomes.iter().map(|(_, outcome)| outcome.as_str()).collect();
    assert_eq!(outcomes, ["used", "unreadable", "unreadable", "refused"]);
    let why = pairs(&out, "SELECT robot, message FROM screening WHERE robot = 'r003'");
    assert!(why[0].1.contains("recording.yaml:"), "{why:?}");
    let of_first = "SELECT value FROM parameters WHERE robot = 'r001' AND value IS NOT NULL";
    assert_eq!(numbers(&out, of_first), numbers(&sound, of_first));
    assert_eq!(pairs(&out, "SELECT DISTINCT robot, 'x' FROM parameters").len(), 1);
    // Done is done, with what was wrong.
    assert_eq!(fleet.run(&out).reduced, 0);
}

#[test]
fn functions_of_queries_give_what_the_tables_hold() {
    let fleet = Fleet::new(1, 2);
    let out = fleet.out("o");
    fleet.run(&out);
    let path = fleet.file.display();
    let of_day = "day = DATE '2026-03-02'";
    let asked = numbers(
        &out,
        &format!(
            "SELECT solved['value'] FROM (SELECT unnest(dynid_solve(dynid_merge(factor))) AS solved FROM \
             dynid_factors('{path}') WHERE {of_day}) WHERE solved['value'] IS NOT NULL"
        ),
    );
    let kept = numbers(&out, &format!("SELECT value FROM parameters WHERE {of_day} AND value IS NOT NULL"));
    assert!(kept.len() > 30);
    assert_eq!(asked, kept);
    let rise = numbers(
        &out,
        "SELECT dynid_rise(a.factor, b.factor) FROM factors a, factors b WHERE a.day = DATE '2026-03-02' AND b.day = DATE \
         '2026-03-01'",
    );
    assert_eq!(rise, numbers(&out, &format!("SELECT rise FROM screening WHERE {of_day}")));
}

#[test]
fn a_gear_that_wears_is_found_where_errors_rose_and_nothing_else_is_looked_for() {
    let fleet = Fleet::new(2, 6);
    // It is as its sibling for four days: how much it differs from day to day must be known first.
    for day in 1..5 {
        for file in std::fs::read_dir(fleet.recording("r001", day)).unwrap().flatten() {
            std::fs::copy(file.path(), fleet.recording("r002", day).join(file.file_name())).unwrap();
        }
    }
    fleet.write(
        "recordings: logs/{robot}/{day}/recording.yaml\nout: results\ndiagnosis: {error_rises: 1.5}\n",
    );
    let out = fleet.out("o");
    fleet.run(&out);
    let found = pairs(&out, "SELECT DISTINCT robot, 'found' FROM findings");
    assert_eq!(found, [("r002".to_owned(), "found".to_owned())]);
    let found = pairs(&out, "SELECT joints, effect FROM findings WHERE effect = 'friction_level_change'");
    assert!(found.iter().any(|(joints, _)| joints.split(' ').any(|joint| joint == "2")), "{found:?}");
    let certain =
        pairs(&out, "SELECT robot, CAST(rose AS VARCHAR) FROM screening WHERE robot = 'r002' ORDER BY day");
    assert_eq!((certain[0].1.as_str(), certain[5].1.as_str()), ("false", "true"));
}

#[test]
fn two_runs_do_not_write_to_one_folder() {
    let fleet = Fleet::new(1, 1);
    let out = fleet.out("o");
    std::fs::create_dir_all(&out).unwrap();
    let lock = std::fs::File::create(out.join(".lock")).unwrap();
    lock.lock().unwrap();
    let run = Command::new(PROGRAM)
        .args(["run", &fleet.file.display().to_string(), "--out", &out.display().to_string()])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&run.stderr);
    assert!(!run.status.success() && said.contains("another run writes to it"), "{said}");
}

#[test]
fn a_run_ends_with_its_alarms_and_pages_that_lead_to_each_robot() {
    let fleet = Fleet::new(3, 18);
    let bad = fleet.recording("r001", 4).join("recording.yaml");
    std::fs::write(bad, "robot: tx40\ntime: [\n").unwrap();
    // The last robot is the second one up to the 15th day, and then one with other gears.
    for day in 1..16 {
        for file in std::fs::read_dir(fleet.recording("r002", day)).unwrap().flatten() {
            std::fs::copy(file.path(), fleet.recording("r003", day).join(file.file_name())).unwrap();
        }
    }
    // Names of folders are names of robots.
    std::fs::rename(fleet.folder.path().join("logs/r002"), fleet.folder.path().join("logs/r 2 & co"))
        .unwrap();
    let out = fleet.out("o");
    let told = || {
        let arguments = ["run", &fleet.file.display().to_string(), "--out", &out.display().to_string()];
        let run = Command::new(PROGRAM).args(arguments).output().unwrap();
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        String::from_utf8(run.stdout).unwrap()
    };
    let first = told();
    assert!(
        first.starts_with(
            "18 days (18 worked out now), 54 recordings (54 reduced now): 53 used, 1 unreadable\n"
        ),
        "{first}"
    );
    let alarms: Vec<&str> = first.lines().skip(2).take_while(|line| !line.starts_with("look at")).collect();
    assert!(
        !alarms.is_empty() && first.contains(&format!("{0} alarms, {0} of them new", alarms.len())),
        "{first}"
    );
    for alarm in &alarms {
        assert!(
            alarm.starts_with("new  r003  F") && alarm.contains("jumped on about 2026-03-16; siblings "),
            "{alarm}"
        );
        assert!(alarm.contains(" meanwhile (median of 2)"), "{alarm}");
    }
    let page = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
    let pages = || ["fleet.html", "robots/r003.html", "robots/r~202~20~26~20co.html"].map(page);
    let before = pages();
    let [all, worn, other] = &before;
    assert!(all.contains("<a href=\"robots/r003.html\">r003</a> <span class=\"note\">tx40</span>"), "{all}");
    assert!(all.contains("<a href=\"robots/r~202~20~26~20co.html\">r 2 &amp; co</a>"));
    assert!(worn.contains("jumped up on about 2026-03-16") && worn.contains("Recordings: 18 used."));
    assert!(other.contains("No alarm; "));
    assert!(page("robots/r001.html").contains("recording.yaml:"));
    // The same again, and pages that were lost.
    std::fs::remove_file(out.join("fleet.html")).unwrap();
    let again = told();
    assert!(
        again.contains("18 days (0 worked out now)") && again.contains("alarms, 0 of them new"),
        "{again}"
    );
    assert_eq!(before, pages());
}

#[test]
fn temperature_and_load_of_a_recording_stand_beside_its_parameters_and_the_table_wins() {
    let fleet = Fleet::new(3, 1);
    let plain = fleet.out("plain");
    fleet.run(&plain);
    let also = |robot: &str, keys: &str| {
        let manifest = fleet.recording(robot, 1).join("recording.yaml");
        let text = std::fs::read_to_string(&manifest).unwrap();
        std::fs::write(&manifest, format!("{text}\n{keys}\n")).unwrap();
        std::fs::write(fleet.recording(robot, 1).join("slow.csv"), "celsius,kg\n20,1\n22,2\n24,\n").unwrap();
    };
    also("r001", "temperature: {file: slow.csv, columns: [celsius]}\nload: {file: slow.csv, columns: [kg]}");
    also("r002", "temperature: {file: slow.csv, columns: [celsius]}");
    also("r003", "temperature: {file: slow.csv, columns: [kelvin]}");
    let line = |robot: &str, said: &str| {
        format!("{robot},2026-03-01,logs/{robot}/2026-03-01/recording.yaml,{said}\n")
    };
    let list = [line("r001", ""), line("r002", "31.5"), line("r003", "")].concat();
    std::fs::write(fleet.folder.path().join("list.csv"), format!("robot,day,recording,temperature\n{list}"))
        .unwrap();
    fleet.write("recordings: list.csv\ndiagnosis: {enabled: false}\n");
    let out = fleet.out("o");
    fleet.run(&out);
    let known = |column: &str| {
        pairs(
            &out,
            &format!("SELECT DISTINCT robot, CAST({column} AS VARCHAR) FROM parameters ORDER BY robot"),
        )
    };
    let told: Vec<String> = known("temperature").into_iter().map(|(_, value)| value).collect();
    assert_eq!(told, ["22.0", "31.5", ""]);
    let told: Vec<String> = known("load").into_iter().map(|(_, value)| value).collect();
    assert_eq!(told, ["1.5", "", ""]);
    // What cannot be read of them is told, and the recording is used all the same.
    let third = pairs(&out, "SELECT outcome, message FROM screening WHERE robot = 'r003'");
    assert!(third[0].0 == "used" && third[0].1.contains("temperature and load are not known: "), "{third:?}");
    let values = "SELECT value FROM parameters WHERE value IS NOT NULL ORDER BY robot, parameter";
    assert_eq!(numbers(&out, values), numbers(&plain, values));
}

#[test]
fn a_recording_that_was_replaced_under_its_name_is_done_again_with_its_day() {
    let fleet = Fleet::new(2, 3);
    let out = fleet.out("o");
    let bad = fleet.recording("r002", 3).join("recording.yaml");
    let good = std::fs::read(&bad).unwrap();
    std::fs::write(&bad, "robot: tx40\ntime: [\n").unwrap();
    fleet.run(&out);
    let before = parquet_files(&out);
    // Data of the second day in the place of the first: the robot's reference is of that day.
    for file in std::fs::read_dir(fleet.recording("r001", 2)).unwrap().flatten() {
        std::fs::copy(file.path(), fleet.recording("r001", 1).join(file.file_name())).unwrap();
    }
    std::fs::write(&bad, good).unwrap();
    let again = fleet.run(&out);
    assert_eq!((again.recordings, again.reduced, again.replaced, again.days), (6, 2, 2, 2));
    let after = parquet_files(&out);
    assert_eq!(before["parameters/2026-03-02.parquet"], after["parameters/2026-03-02.parquet"]);
    let of_day = |day: u32| {
        let robot = "robot = 'r001' AND value IS NOT NULL ORDER BY parameter";
        numbers(&out, &format!("SELECT value FROM parameters WHERE day = DATE '2026-03-0{day}' AND {robot}"))
    };
    assert_eq!(of_day(1), of_day(2));
    let whole = fleet.out("whole");
    fleet.run(&whole);
    for name in ["references.parquet", "parameters/2026-03-01.parquet", "factors/2026-03-03.parquet"] {
        assert_eq!(parquet_files(&whole)[name], after[name], "{name}");
    }
    assert_eq!(fleet.run(&out).days, 0);
}
