//! Exported code against the library: C by the machine's compiler, Rust without std by rustc.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

mod common;

use common::{Folder, MANIFEST, error_of, moving};
use dynid::models;
use dynid_codegen::base::base_set;
use dynid_codegen::robot::parse;
use dynid_codegen::{Real, export_c, export_rust, numeric_robot};
use dynid_runtime::model::{Model, RecursiveModel};
use std::io::Write;
use std::process::{Command, Output, Stdio};

const SAMPLES: usize = 12;
const WARNINGS: [&str; 5] = ["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror"];

/// The machine's C compiler; without one a test is skipped, and says so.
fn compiler() -> Option<String> {
    let name = std::env::var("CC").unwrap_or_else(|_| "cc".to_owned());
    let found = Command::new(&name).arg("--version").output().is_ok_and(|o| o.status.success());
    if !found {
        let _ = writeln!(std::io::stderr(), "skipped: there is no C compiler {name}");
    }
    found.then_some(name)
}

/// The compilers that exported C is tried with: the machine's, and clang where it is another one.
fn compilers() -> Vec<String> {
    let Some(own) = compiler() else { return Vec::new() };
    let clang = Command::new("clang").arg("--version").output().is_ok_and(|o| o.status.success());
    if !clang {
        let _ = writeln!(std::io::stderr(), "skipped: there is no clang");
    }
    let other = (clang && own != "clang").then(|| "clang".to_owned());
    [own].into_iter().chain(other).collect()
}

fn rustc() -> Command {
    let mut command = Command::new(std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned()));
    command.args(["--edition", "2024", "-D", "warnings", "-C", "opt-level=1"]);
    command
}

fn done(command: &mut Command) -> Output {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{command:?}\n{}", error_of(&output));
    output
}

/// Values in [-1, 1) that never change.
fn values(seed: u64, count: usize) -> Vec<f64> {
    let mut x = seed;
    let mut next = || {
        x = x.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (x >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    (0..count).map(|_| next()).collect()
}

/// q, dq, ddq of a sample.
fn state(n: usize, sample: usize) -> [Vec<f64>; 3] {
    let x = values(17 + sample as u64, 3 * n);
    [x[..n].iter().map(|x| 3.0 * x).collect(), x[n..2 * n].to_vec(), x[2 * n..].to_vec()]
}

/// h, dh, IDM, M, N and tau of the library.
fn expected(model: &dyn Model, chi: &[f64], [q, dq, ddq]: &[Vec<f64>; 3]) -> Vec<f64> {
    let (n, nb, entries) = (q.len(), chi.len(), model.pattern().columns.len());
    let (mut h, mut dh, mut idm) = (vec![0.0; nb], vec![0.0; nb], vec![0.0; entries]);
    let (mut mass, mut bias, mut tau) = (vec![0.0; n * n], vec![0.0; n], vec![0.0; n]);
    model.energy(q, dq, &mut h);
    model.power(q, dq, ddq, &mut dh);
    model.idm(q, dq, ddq, &mut idm);
    model.mass_and_bias(chi, q, dq, &mut mass, &mut bias);
    model.torque(chi, q, dq, ddq, &mut tau);
    [h, dh, idm, mass, bias, tau].concat()
}

/// A program that reads chi, then states, and prints the bits of all that the functions give.
fn driver(name: &str, real: &str) -> String {
    let upper = name.to_uppercase();
    format!(
        r#"#include "{name}.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
static void show(const {real} *values, int count)
{{
    for (int k = 0; k < count; k++) {{
        double value = (double)values[k];
        uint64_t bits;
        memcpy(&bits, &value, sizeof bits);
        printf("%016" PRIx64 "\n", bits);
    }}
}}
static int get({real} *values, int count)
{{
    for (int k = 0; k < count; k++) {{
        double value;
        if (scanf("%lf", &value) != 1)
            return 0;
        values[k] = ({real})value;
    }}
    return 1;
}}
int main(void)
{{
    static {real} chi[{upper}_NB], q[{upper}_N], dq[{upper}_N], ddq[{upper}_N], h[{upper}_NB], dh[{upper}_NB];
    static {real} idm[{upper}_ENTRIES], mass[{upper}_N * {upper}_N], bias[{upper}_N], tau[{upper}_N];
    if (!get(chi, {upper}_NB))
        return 1;
    while (get(q, {upper}_N) && get(dq, {upper}_N) && get(ddq, {upper}_N)) {{
        {name}_energy(q, dq, h);
        {name}_power(q, dq, ddq, dh);
        {name}_idm(q, dq, ddq, idm);
        {name}_mass_and_bias(chi, q, dq, mass, bias);
        {name}_tau(chi, q, dq, ddq, tau);
        show(h, {upper}_NB);
        show(dh, {upper}_NB);
        show(idm, {upper}_ENTRIES);
        show(mass, {upper}_N * {upper}_N);
        show(bias, {upper}_N);
        show(tau, {upper}_N);
    }}
    return 0;
}}
"#
    )
}

/// The same program in Rust, over a crate `robot` that knows no std.
fn rust_driver(name: &str) -> String {
    format!(
        r#"use robot::{name}::*;
fn show(values: &[f64]) {{
    values.iter().for_each(|x| println!("{{:016x}}", x.to_bits()));
}}
fn main() {{
    let text = std::io::read_to_string(std::io::stdin()).unwrap();
    let all: Vec<f64> = text.split_whitespace().map(|x| x.parse().unwrap()).collect();
    let (chi, states) = all.split_at(NB);
    let chi: &[f64; NB] = chi.try_into().unwrap();
    for state in states.chunks_exact(3 * N) {{
        let [q, dq, ddq] = [0, 1, 2].map(|k| <&[f64; N]>::try_from(&state[k * N..(k + 1) * N]).unwrap());
        let (mut h, mut dh, mut idm_entries) = ([0.0; NB], [0.0; NB], [0.0; ENTRIES]);
        let (mut mass, mut bias, mut torques) = ([0.0; N * N], [0.0; N], [0.0; N]);
        energy(q, dq, &mut h);
        power(q, dq, ddq, &mut dh);
        idm(q, dq, ddq, &mut idm_entries);
        mass_and_bias(chi, q, dq, &mut mass, &mut bias);
        tau(chi, q, dq, ddq, &mut torques);
        show(&h);
        show(&dh);
        show(&idm_entries);
        show(&mass);
        show(&bias);
        show(&torques);
    }}
}}
"#
    )
}

/// A crate without std that takes sine and cosine from the C library, as firmware does.
fn without_std(name: &str) -> String {
    // Only a robot with a spring between points asks for it.
    let (sqrt, root) = if name == "sprung" {
        (
            "safe fn sqrt(x: f64) -> f64;",
            "fn inverse_root(self) -> f64 { if self > 0.0 { 1.0 / sqrt(self) } else { 0.0 } }",
        )
    } else {
        ("", "")
    };
    format!(
        r#"#![no_std]
#[path = "{name}.rs"]
pub mod {name};
use {name}::Number;
unsafe extern "C" {{
    {sqrt}
    safe fn sin(x: f64) -> f64;
    safe fn cos(x: f64) -> f64;
}}
impl Number for f64 {{
    fn constant(value: f64) -> f64 {{
        value
    }}
    fn sin_cos(self) -> (f64, f64) {{
        (sin(self), cos(self))
    }}
    fn sign(self) -> f64 {{
        if self > 0.0 {{ 1.0 }} else if self < 0.0 {{ -1.0 }} else {{ 0.0 }}
    }}
    {root}
}}
"#
    )
}

/// What a program prints of chi and the states, as numbers.
fn printed(folder: &Folder, program: &str, text: &str) -> Vec<f64> {
    let mut child = Command::new(folder.path(program))
        .current_dir(&folder.0)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let text = text.to_owned();
    let writer = std::thread::spawn(move || stdin.write_all(text.as_bytes()));
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap().unwrap();
    assert!(output.status.success(), "{program}: {}", error_of(&output));
    let number = |line: &str| f64::from_bits(u64::from_str_radix(line, 16).unwrap());
    String::from_utf8(output.stdout).unwrap().lines().map(number).collect()
}

/// chi and the states as the programs read them.
fn inputs(chi: &[f64], n: usize) -> String {
    let states = (0..SAMPLES).flat_map(|t| state(n, t).concat());
    chi.iter().copied().chain(states).map(|x| format!("{x:?}\n")).collect()
}

fn assert_close(found: &[f64], model: &dyn Model, chi: &[f64], tolerance: f64, what: &str) {
    let n = model.robot().joints();
    let expected: Vec<f64> = (0..SAMPLES).flat_map(|t| expected(model, chi, &state(n, t))).collect();
    assert_eq!(found.len(), expected.len(), "{what}");
    for (k, (a, b)) in found.iter().zip(&expected).enumerate() {
        assert!((a - b).abs() <= tolerance * b.abs().max(20.0), "{what}, value {k}: {a} and {b}");
    }
}

/// Whether programs that a compiler makes with sanitizers run here.
fn has_sanitizers(cc: &str, folder: &Folder) -> bool {
    folder.write("empty.c", "int main(void) { return 0; }\n");
    let mut trial = Command::new(cc);
    trial.args(["-fsanitize=address,undefined", "empty.c", "-o", "empty"]).current_dir(&folder.0);
    let made = trial.output().is_ok_and(|o| o.status.success());
    let runs = made && Command::new(folder.path("empty")).output().is_ok_and(|o| o.status.success());
    if !runs {
        let _ = writeln!(std::io::stderr(), "skipped: {cc} has no sanitizers");
    }
    runs
}

/// An arm with a coil spring to its forearm and a gas spring under its upper arm.
fn sprung() -> RecursiveModel {
    let yaml = "name: sprung\nframes:\n  - {j: 1, sigma: 0, alpha: 0.3, d: 0, theta: q1, r: 0}\n  \
                - {j: 2, sigma: 0, alpha: -pi/2, d: 0.5, theta: q2, r: 0.1}\nsprings:\n  \
                - {between: [{frame: 0, point: [0.2, 0.5, 0]}, {frame: 2, point: [0.15, 0, 0]}], name: coil, rest: 0.2}\n  \
                - {between: [{frame: 0, point: [0, -0.35, 0.1]}, {frame: 1, point: [0.25, -0.05, 0]}], name: gas}\n";
    let table = parse("sprung.yaml", yaml.as_bytes()).unwrap();
    RecursiveModel::new(numeric_robot(&table, &base_set(&table))).unwrap()
}

#[test]
fn exported_c_compiles_without_a_warning_and_gives_the_numbers_of_the_library_under_sanitizers() {
    // Friction of a belt, springs, and a prismatic joint.
    let table = parse("tethered.yaml", include_bytes!("formats/tethered.yaml")).unwrap();
    let tethered = RecursiveModel::new(numeric_robot(&table, &base_set(&table))).unwrap();
    let sprung = sprung();
    for cc in compilers() {
        let folder = Folder::new(&format!("export-{}", cc.replace('/', "-")));
        let sanitizers = has_sanitizers(&cc, &folder);
        for model in models::all().iter().copied().chain([&tethered as &dyn Model, &sprung]) {
            let (robot, n) = (model.robot(), model.robot().joints());
            let chi = values(3, robot.base.len());
            for (real, kind, tolerance) in [(Real::Double, "double", 1e-12), (Real::Single, "float", 1e-4)] {
                let files = export_c(robot, None, real).unwrap();
                let name = &files.name;
                folder.write(&format!("{name}.h"), &files.header).write(&format!("{name}.c"), &files.source);
                folder.write("main.c", &driver(name, kind));
                let mut command = Command::new(&cc);
                command.args(WARNINGS).arg("-O1");
                if sanitizers {
                    command.args(["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]);
                }
                command.args(["main.c", &format!("{name}.c"), "-lm", "-o", "main"]).current_dir(&folder.0);
                done(&mut command);
                let found = printed(&folder, "main", &inputs(&chi, n));
                assert_close(&found, model, &chi, tolerance, &format!("{name} {kind} {cc}"));
            }
        }
    }
}

/// What CasADi does with a library: asks for shapes, lends room, calls; with inputs and outputs that are not there.
const CASADI_DRIVER: &str = r#"#include "tx40.h"
#include <stdio.h>
#include <string.h>
typedef long long int casadi_int;
casadi_int casadi_tx40_idm_n_in(void);
casadi_int casadi_tx40_mass_and_bias_n_out(void);
const char *casadi_tx40_tau_name_in(casadi_int i);
const casadi_int *casadi_tx40_idm_sparsity_out(casadi_int i);
const casadi_int *casadi_tx40_tau_sparsity_in(casadi_int i);
int casadi_tx40_idm_work(casadi_int *a, casadi_int *b, casadi_int *c, casadi_int *d);
int casadi_tx40_mass_and_bias_work(casadi_int *a, casadi_int *b, casadi_int *c, casadi_int *d);
int casadi_tx40_idm(const double **arg, double **res, casadi_int *iw, double *w, int mem);
int casadi_tx40_tau(const double **arg, double **res, casadi_int *iw, double *w, int mem);
int casadi_tx40_mass_and_bias(const double **arg, double **res, casadi_int *iw, double *w, int mem);
static double chi[TX40_NB], q[TX40_N] = {0.3, -1, 2, 0.5, 1, -2}, dq[TX40_N] = {1, 2, -1, 0.5, 3, 1};
static double w[10000], entries[TX40_ENTRIES], tau[TX40_N], product[TX40_N], bias[TX40_N];
int main(void)
{
    const double *state[4] = {chi, q, dq, 0};
    double *out[2] = {tau, 0};
    casadi_int arg, res, iw, room;
    int column;
    for (column = 0; column < TX40_NB; column++)
        chi[column] = 0.1 * column - 2;
    if (casadi_tx40_idm_n_in() != 3 || strcmp(casadi_tx40_tau_name_in(0), "chi") || casadi_tx40_tau_name_in(4))
        return 1;
    if (casadi_tx40_tau_sparsity_in(0)[0] != TX40_NB || casadi_tx40_tau_sparsity_in(0)[2] != 1)
        return 2;
    casadi_tx40_idm_work(&arg, &res, &iw, &room);
    if (arg != 3 || res != 1 || iw != 0 || room > 10000)
        return 3;
    /* Accelerations that are not there are zero. */
    casadi_tx40_tau(state, out, 0, w, 0);
    out[0] = entries;
    casadi_tx40_idm(state + 1, out, 0, w, 0);
    const casadi_int *sparsity = casadi_tx40_idm_sparsity_out(0), *starts = sparsity + 2, *rows = starts + TX40_NB + 1;
    if (sparsity[0] != TX40_N || sparsity[1] != TX40_NB || starts[TX40_NB] != TX40_ENTRIES)
        return 4;
    for (column = 0; column < TX40_NB; column++)
        for (casadi_int e = starts[column]; e < starts[column + 1]; e++)
            product[rows[e]] += entries[e] * chi[column];
    for (int j = 0; j < TX40_N; j++)
        if (tau[j] - product[j] > 1e-9 || product[j] - tau[j] > 1e-9)
            return 5;
    /* A mass matrix that is not wanted. */
    casadi_tx40_mass_and_bias_work(0, 0, 0, &room);
    out[0] = 0;
    out[1] = bias;
    casadi_tx40_mass_and_bias(state, out, 0, w, 0);
    out[1] = 0;
    casadi_tx40_mass_and_bias(state, out, 0, w, 0);
    return casadi_tx40_mass_and_bias_n_out() == 2 && bias[1] != 0 ? 0 : 6;
}
"#;

/// The same by CasADi itself.
const CASADI_SCRIPT: &str = r#"
import casadi, numpy as np
load = lambda name: casadi.external(f"casadi_tx40_{name}", "./tx40.so")
tau, idm, forward, h = load("tau"), load("idm"), load("mass_and_bias"), load("energy")
rng = np.random.default_rng(1)
chi, q, dq, ddq = rng.normal(size=60), *rng.normal(size=(3, 6))
assert idm.size_out(0) == (6, 60) and idm.nnz_out() == 164
torque = np.array(tau(chi, q, dq, ddq)).ravel()
assert np.allclose(torque, np.array(casadi.mtimes(idm(q, dq, ddq), chi)).ravel(), atol=1e-10)
mass, bias = forward(chi, q, dq)
column = np.array(tau(chi, q, dq, ddq) - tau(chi, q, dq, 0)).ravel()
assert np.allclose(np.array(casadi.mtimes(mass, ddq)).ravel(), column, atol=1e-10)
assert h(q, dq).shape == (1, 60)
x = casadi.MX.sym("x", 6)
symbolic = casadi.Function("f", [x], [casadi.sumsqr(tau(chi, x, dq, ddq))])
assert abs(float(symbolic(q)) - (torque**2).sum()) < 1e-8
print("as CasADi has it")
"#;

#[test]
fn casadi_loads_the_functions_that_are_exported_for_it() {
    for cc in compilers() {
        let folder = Folder::new(&format!("export-casadi-{}", cc.replace('/', "-")));
        let made = folder.run(&["export", "tx40", "--to", "c", "--casadi", "--out", "."]);
        assert!(made.status.success(), "{}", error_of(&made));
        folder.write("main.c", CASADI_DRIVER);
        let mut command = Command::new(&cc);
        command.args(WARNINGS).arg("-O1").current_dir(&folder.0);
        if has_sanitizers(&cc, &folder) {
            command.args(["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]);
        }
        done(command.args(["main.c", "tx40.c", "tx40_casadi.c", "-lm", "-o", "main"]));
        done(&mut Command::new(folder.path("main")));
        let mut library = Command::new(&cc);
        library.args(["-O1", "-shared", "-fPIC", "tx40.c", "tx40_casadi.c", "-lm", "-o", "tx40.so"]);
        done(library.current_dir(&folder.0));
        let python = std::env::var("DYNID_PYTHON").unwrap_or_else(|_| "python3".to_owned());
        let there = Command::new(&python).args(["-c", "import casadi"]).output();
        if !there.is_ok_and(|o| o.status.success()) {
            let _ = writeln!(
                std::io::stderr(),
                "skipped: {python} has no casadi (DYNID_PYTHON names one that has)"
            );
            continue;
        }
        let ran = done(Command::new(&python).args(["-c", CASADI_SCRIPT]).current_dir(&folder.0));
        assert!(String::from_utf8_lossy(&ran.stdout).contains("as CasADi has it"));
    }
    let folder = Folder::new("export-casadi-refused");
    for other in [&["rust"][..], &["c", "--real", "f32"]] {
        let words = [&["export", "tx40", "--casadi", "--out", ".", "--to"][..], other].concat();
        let refused = folder.run(&words);
        assert!(refused.status.code() == Some(2) && error_of(&refused).contains("--casadi"));
    }
}

#[test]
fn exported_rust_compiles_without_std_and_gives_the_bits_of_exported_c() {
    let sprung = sprung();
    for name in ["tx40", "stanford", "scara4", "sprung"] {
        let folder = Folder::new(&format!("export-rust-{name}"));
        let model = models::find(name).unwrap_or(&sprung);
        let (robot, n) = (model.robot(), model.robot().joints());
        let chi = values(3, robot.base.len());
        folder.write(&format!("{name}.rs"), &export_rust(robot, None).unwrap().source);
        folder.write("robot.rs", &without_std(name)).write("main.rs", &rust_driver(name));
        done(rustc().args(["--crate-type", "rlib", "robot.rs"]).current_dir(&folder.0));
        done(rustc().args(["--extern", "robot=librobot.rlib", "main.rs"]).current_dir(&folder.0));
        let found = printed(&folder, "main", &inputs(&chi, n));
        assert_close(&found, model, &chi, 1e-12, name);

        let Some(cc) = compiler() else { continue };
        let files = export_c(robot, None, Real::Double).unwrap();
        folder.write(&format!("{name}.h"), &files.header).write(&format!("{name}.c"), &files.source);
        folder.write("main.c", &driver(name, "double"));
        let mut command = Command::new(&cc);
        command.args(["-std=c99", "-O2", "-ffp-contract=off", "main.c", &format!("{name}.c"), "-lm"]);
        done(command.args(["-o", "main_c"]).current_dir(&folder.0));
        let bits = |values: Vec<f64>| values.into_iter().map(f64::to_bits).collect::<Vec<_>>();
        assert_eq!(bits(found), bits(printed(&folder, "main_c", &inputs(&chi, n))), "{name}");
    }
}

/// Terms of a model: what a formula says goes in, what none says is named.
const EFFECTS: &str = r#"[
  {"effect": "stribeck", "place": {"joint": 0}, "joints": [1], "shape": [0.2], "amplitude": [1.5], "sigma": [0.0],
   "scale": {"speed": 2.0, "range": 3.0, "torque": 10.0, "duration": 5.0, "gear": 50.0, "prismatic": false}},
  {"effect": "load_dependent_friction", "place": {"joint": 1}, "joints": [2], "shape": [], "amplitude": [0.07],
   "sigma": [0.0],
   "scale": {"speed": 2.0, "range": 3.0, "torque": 10.0, "duration": 5.0, "gear": 50.0, "prismatic": false}},
  {"effect": "presliding_hysteresis", "place": {"joint": 1}, "joints": [2], "shape": [0.1], "amplitude": [0.5],
   "sigma": [0.0],
   "scale": {"speed": 2.0, "range": 3.0, "torque": 10.0, "duration": 5.0, "gear": 50.0, "prismatic": false}},
  {"effect": "payload", "place": {"link": 1}, "joints": [], "shape": [],
   "amplitude": [0.0, 0.0, 0.0, 0.0, 0.0, 0.08, 0.3, -0.1, 0.0, 2.0],
   "sigma": [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]}
]"#;

/// The payload among them, by the names of the link's parameters.
const BODY: [(&str, f64); 4] = [("ZZ2", 0.08), ("MX2", 0.3), ("MY2", -0.1), ("M2", 2.0)];

/// An identified planar_2r with effects, as a file; its base parameters.
fn identified(folder: &Folder) -> Vec<f64> {
    folder.write("motion.csv", &moving(900)).write("recording.yaml", MANIFEST);
    let made = folder.run(&["identify", "recording.yaml", "--out", "plain.json"]);
    assert!(made.status.success(), "{}", error_of(&made));
    let text = std::fs::read_to_string(folder.path("plain.json")).unwrap();
    let mut model: serde_json::Value = serde_json::from_str(&text).unwrap();
    model["effects"] = serde_json::from_str(EFFECTS).unwrap();
    model["covariance"] = serde_json::Value::Null;
    folder.write("model.json", &model.to_string());
    let parameters = model["base_parameters"].as_array().unwrap();
    parameters.iter().map(|p| p["value"].as_f64().unwrap()).collect()
}

/// Torques of the identified arm, and what the two laws that are formulas add.
fn torques_with_laws(chi: &[f64], [q, dq, ddq]: &[Vec<f64>; 3]) -> [f64; 2] {
    let model = models::find("planar_2r").unwrap();
    let robot = model.robot();
    let value = |name: &str| BODY.iter().find(|(other, _)| *other == name).map_or(0.0, |(_, value)| *value);
    let body: Vec<f64> = robot.standard.iter().map(|p| value(&p.name)).collect();
    let with_body: Vec<f64> = chi.iter().zip(robot.base_from_standard(&body)).map(|(a, b)| a + b).collect();
    let mut tau = [0.0; 2];
    model.torque(&with_body, q, dq, ddq, &mut tau);
    // The load of a law is that of the parameters that it was fitted beside.
    let (mut mass, mut bias) = ([0.0; 4], [0.0; 2]);
    model.mass_and_bias(chi, q, dq, &mut mass, &mut bias);
    let load = mass[2] * ddq[0] + mass[3] * ddq[1] + bias[1];
    tau[0] += 1.5 * (-(dq[0] / 0.2).powi(2)).exp() * dq[0].signum();
    tau[1] += 0.07 * load.abs() * dq[1].signum();
    tau
}

#[test]
fn an_identified_model_is_exported_with_its_parameters_and_laws_and_says_what_is_left_out() {
    let folder = Folder::new("export-model");
    let chi = identified(&folder);
    for target in ["c", "rust"] {
        let made = folder.run(&["export", "model.json", "--to", target, "--out", "code"]);
        assert!(made.status.success(), "{}", error_of(&made));
        let told = error_of(&made);
        assert!(told.contains("on joint 2") && told.contains("memory"), "{told}");
    }
    let header = std::fs::read_to_string(folder.path("code/planar_2r.h")).unwrap();
    assert!(header.contains("not in this code") && header.contains("exp("), "{header}");
    assert!(header.contains("in these: Payload"), "{header}");
    let states: String =
        (0..SAMPLES).flat_map(|t| state(2, t).concat()).map(|x| format!("{x:?}\n")).collect();

    folder.write(
        "main.rs",
        r#"#[path = "code/planar_2r.rs"]
mod planar_2r;
fn main() {
    let text = std::io::read_to_string(std::io::stdin()).unwrap();
    let all: Vec<f64> = text.split_whitespace().map(|x| x.parse().unwrap()).collect();
    for x in all.chunks_exact(6) {
        let mut tau = [0.0; 2];
        planar_2r::model_tau(&[x[0], x[1]], &[x[2], x[3]], &[x[4], x[5]], &mut tau);
        tau.iter().for_each(|x| println!("{:016x}", x.to_bits()));
    }
}
"#,
    );
    done(rustc().args(["--cfg", "feature=\"std\"", "main.rs", "-o", "in_rust"]).current_dir(&folder.0));
    let mut programs = vec!["in_rust"];
    if let Some(cc) = compiler() {
        folder.write(
            "main.c",
            r#"#include "code/planar_2r.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
int main(void)
{
    double x[6], tau[2];
    while (scanf("%lf%lf%lf%lf%lf%lf", x, x + 1, x + 2, x + 3, x + 4, x + 5) == 6) {
        planar_2r_model_tau(x, x + 2, x + 4, tau);
        for (int k = 0; k < 2; k++) {
            uint64_t bits;
            memcpy(&bits, tau + k, sizeof bits);
            printf("%016" PRIx64 "\n", bits);
        }
    }
    return 0;
}
"#,
        );
        let mut command = Command::new(&cc);
        command.args(WARNINGS).args(["-O2", "main.c", "code/planar_2r.c", "-lm", "-o", "in_c"]);
        done(command.current_dir(&folder.0));
        programs.push("in_c");
    }
    for program in programs {
        let found = printed(&folder, program, &states);
        let expected: Vec<f64> = (0..SAMPLES).flat_map(|t| torques_with_laws(&chi, &state(2, t))).collect();
        assert_eq!(found.len(), expected.len());
        for (a, b) in found.iter().zip(expected) {
            assert!((a - b).abs() < 1e-11 * b.abs().max(1.0), "{program}: {a} and {b}");
        }
    }
}

#[test]
fn a_robot_by_path_is_exported_under_its_own_name() {
    let folder = Folder::new("export-path");
    folder.write("arm.yaml", common::ARM);
    let made = folder.run(&["export", "./arm.yaml", "--to", "c", "--out", "deep/code"]);
    assert!(made.status.success(), "{}", error_of(&made));
    let source = std::fs::read_to_string(folder.path("deep/code/arm.c")).unwrap();
    assert!(source.contains("void arm_tau(") && !source.contains("malloc"), "{source}");
    let refused = folder.run(&["export", "nobody", "--to", "c", "--out", "code"]);
    assert_eq!(refused.status.code(), Some(2));
    let refused = folder.run(&["export", "tx40", "--to", "rust", "--real", "f32", "--out", "code"]);
    assert!(refused.status.code() == Some(2) && error_of(&refused).contains("--real"));
}

/// The snippets of the README, as a reader copies them.
#[test]
fn the_snippets_of_the_readme_run() {
    let folder = Folder::new("export-readme");
    let readme = include_str!("../README.md");
    let block = |language: &str| {
        let start = format!("   ```{language}\n");
        let text = readme.split(&start).nth(1).unwrap_or_else(|| panic!("no {language} in the README"));
        let lines = text.split("   ```").next().unwrap().lines();
        lines.map(|line| format!("{}\n", line.strip_prefix("   ").unwrap_or(line))).collect::<String>()
    };
    for target in ["c", "rust"] {
        let words = ["export", "tx40", "--to", target, "--out", "exported"];
        assert!(readme.contains(&format!("dynid {}", words.join(" "))));
        assert!(folder.run(&words).status.success());
    }
    let rust = "rustc --edition 2024 -O --cfg 'feature=\"std\"' main.rs -o main_rust";
    assert!(readme.contains(rust));
    folder.write("main.rs", &block("rust"));
    let shell = |line: &str| done(Command::new("sh").args(["-c", line]).current_dir(&folder.0));
    shell(rust);
    let in_rust = shell("./main_rust").stdout;
    assert!(String::from_utf8_lossy(&in_rust).contains("N.m"), "{in_rust:?}");
    if compiler().is_some() {
        let c = "cc -O3 main.c exported/tx40.c -lm -o main_c";
        assert!(readme.contains(c));
        folder.write("main.c", &block("c"));
        shell(c);
        let in_c = shell("./main_c").stdout;
        assert_eq!(String::from_utf8_lossy(&in_c), String::from_utf8_lossy(&in_rust));
    }
}
