//! What is fuzzed: bytes that anybody may have written go in, and nothing panics or runs away. The answers themselves are
//! other tests' matter.

use std::path::Path;
use std::sync::LazyLock;

use dynid_codegen::base::base_set;
use dynid_codegen::numeric_robot;
use dynid_codegen::robot::parse_with_warnings;
use dynid_runtime::estimation::observe::{Equations, ObserveSettings};
use dynid_runtime::estimation::{
    EstimateSettings, RecordedSettings, estimate as estimated, observe_recording,
};
use dynid_runtime::model::{RecursiveModel, Robot};
use dynid_runtime::model_file;
use dynid_runtime::recording::{Column, Layout, Manifest, Rows, TableReader, load, look};
use dynid_urdf::{ImportOptions, Skeleton, Template, write_mjcf, write_urdf};

/// An arm of two joints.
const ARM: &str = "
name: arm
gravity: [0, -9.81, 0]
frames:
  - {j: 1, sigma: 0, alpha: 0, d: 0,   theta: q1, r: 0}
  - {j: 2, sigma: 0, alpha: 0, d: 0.5, theta: q2, r: 0}
drive: {gear: [50, 50]}
";

/// A recording of it.
const RECORDING: &str = "
robot: arm
time: {column: t, unit: s}
position: {columns: [q1, q2], unit: rad}
torque: {columns: [u1, u2], unit: N.m}
trajectories: [{file: rows.csv}]
";

/// The arm, unless its table is wrong, which the target of robots would tell.
static ROBOT: LazyLock<Option<Robot>> = LazyLock::new(|| robot_of(ARM.as_bytes()));

fn robot_of(bytes: &[u8]) -> Option<Robot> {
    let (table, _) = parse_with_warnings("arm.yaml", bytes).ok()?;
    // What generates code for a long table takes minutes; base parameters of four frames show the same.
    (table.frames.len() <= 4).then(|| numeric_robot(&table, &base_set(&table)))
}

/// A robot YAML, to base parameters that are finite.
pub fn robot(bytes: &[u8]) {
    let Some(robot) = robot_of(bytes) else { return };
    let finite = robot.base.iter().flat_map(|b| b.combination.iter()).all(|(_, c)| c.is_finite());
    assert!(finite, "a base parameter is not finite");
    let _ = RecursiveModel::new(robot);
}

/// A URDF, to its table and into a copy of it. What is written as a YAML is one.
pub fn urdf(bytes: &[u8]) {
    let options = ImportOptions::default();
    let Ok(urdf) = dynid_urdf::read(bytes, options.snap) else { return };
    let Ok(imported) = dynid_urdf::import(&urdf, "arm.urdf", &options) else { return };
    // A number may be larger than a robot's; everything else is as the reader wants it.
    let Some(robot) = robot_of(imported.yaml.as_bytes()) else { return };
    let standard: Vec<f64> = robot.nominal.as_ref().map_or_else(Vec::new, |n| n.standard.to_vec());
    if let Ok(template) = Template::new(&urdf, &robot, &options)
        && let Ok(text) = template.patched(bytes, &robot, &standard, &[])
    {
        assert!(dynid_urdf::read(text.as_bytes(), options.snap).is_ok(), "{text}");
    }
    let skeleton = Skeleton::of_table(&robot, &standard);
    let _ = write_mjcf(&skeleton);
    let _ = dynid_urdf::read(write_urdf(&skeleton).as_bytes(), options.snap);
}

/// The YAML of a recording; its files are not there.
pub fn manifest(bytes: &[u8]) {
    let Ok(manifest) = Manifest::parse(Path::new("nowhere/recording.yaml"), bytes) else { return };
    // A path in it could name any file of this machine, so only those that cannot be anywhere else are looked for.
    let here =
        |file: &Option<String>| file.as_ref().is_none_or(|f| !f.contains(['/', '\\']) && !f.contains(".."));
    let channels = [Some(&manifest.position), manifest.velocity.as_ref(), Some(&manifest.torque)];
    let channels = channels.into_iter().flatten().all(|channel| here(&channel.file));
    if channels
        && manifest.trajectories.iter().all(|window| here(&window.file))
        && let Some(robot) = ROBOT.as_ref()
    {
        let _ = load(&manifest, robot);
    }
}

/// A CSV file in a few layouts.
pub fn table(bytes: &[u8]) {
    let header = [Column::Name("t".into()), Column::Name("q1".into()), Column::Index(2)];
    let none = [Column::Index(0), Column::Index(3)];
    for (layout, wanted) in [
        (Layout::default(), &header[..]),
        (Layout { header: false, delimiter: b' ', decimal: b',', skip: 1 }, &none[..]),
        (Layout { header: false, delimiter: b';', ..Layout::default() }, &none[..]),
    ] {
        let Ok(mut reader) = TableReader::new(bytes, "rows.csv", &layout, wanted) else { continue };
        let mut rows = Rows::new(wanted.len());
        while reader.read(&mut rows, 1000).is_ok_and(|count| count > 0) {}
    }
}

/// A .npy file with the columns of the recording.
pub fn array(bytes: &[u8]) {
    let by_index = RECORDING
        .replace("rows.csv", "rows.npy")
        .replace("column: t", "column: 0")
        .replace("[q1, q2]", "[1, 2]")
        .replace("[u1, u2]", "[3, 4]");
    loaded("rows.npy", bytes, &by_index);
}

/// An MCAP file with joints of the names that the corpus has, and a look at whatever is in it.
pub fn mcap(bytes: &[u8]) {
    let log =
        "robot: arm\njoints: [elbow, shoulder]\ntorque: {unit: N.m}\ntrajectories: [{file: rows.mcap}]\n";
    loaded("rows.mcap", bytes, log);
    let topic = "/arm_controller/state";
    let by_fields = log.replace("rows.mcap", &format!("rows.mcap, topic: {topic}"))
        + "fields: {position: actual.positions, torque: actual.effort}\n";
    loaded("rows.mcap", bytes, &by_fields);
    looked_at("rows.mcap", bytes, None);
    looked_at("rows.mcap", bytes, Some(topic));
}

/// A Parquet file: columns, and numbers of lists.
pub fn parquet(bytes: &[u8]) {
    let columns = RECORDING.replace("rows.csv", "rows.parquet");
    loaded("rows.parquet", bytes, &columns);
    let lists = columns
        .replace("column: t", "column: timestamp")
        .replace("[q1, q2]", "['observation.state[0]', 'action[1]']")
        .replace("[u1, u2]", "['observation.state[2]', 'action[3]']");
    loaded("rows.parquet", bytes, &lists);
    looked_at("rows.parquet", bytes, None);
}

/// A data file as `look` reads it.
fn looked_at(file: &str, bytes: &[u8], topic: Option<&str>) {
    let Ok(folder) = tempfile::tempdir() else { return };
    let path = folder.path().join(file);
    if std::fs::write(&path, bytes).is_ok() {
        let _ = look(&path, file, topic);
    }
}

/// A saved model.
pub fn model(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let Ok(identified) = model_file::read(text) else { return };
    let Some(table) = &identified.table else { return };
    let _ = identified.chi(table);
    let _ = model_file::to_yaml(table);
}

/// A CSV file, to the parameters of the arm.
pub fn estimate(bytes: &[u8]) {
    let (Some(robot), Some((folder, manifest))) = (ROBOT.as_ref(), written("rows.csv", bytes, RECORDING))
    else {
        return;
    };
    let Ok(model) = RecursiveModel::new(robot.clone()) else { return };
    let rows = ObserveSettings { threads: 1, ..ObserveSettings::default() };
    let settings = RecordedSettings { rows, ..RecordedSettings::default() };
    let observed = observe_recording(&manifest, &model, None, &[Equations::Torque], &settings, None);
    for observation in observed.iter().flat_map(|observed| &observed.observations) {
        let _ = estimated(observation, &EstimateSettings::default());
    }
    drop(folder);
}

fn loaded(file: &str, bytes: &[u8], manifest: &str) {
    if let (Some(robot), Some((_folder, manifest))) = (ROBOT.as_ref(), written(file, bytes, manifest)) {
        let _ = load(&manifest, robot);
    }
}

/// A file in a folder of its own, and the manifest beside it; none where this machine has no room for them.
fn written(file: &str, bytes: &[u8], manifest: &str) -> Option<(tempfile::TempDir, Manifest)> {
    let folder = tempfile::tempdir().ok()?;
    std::fs::write(folder.path().join(file), bytes).ok()?;
    let manifest = Manifest::parse(&folder.path().join("recording.yaml"), manifest.as_bytes()).ok()?;
    Some((folder, manifest))
}
