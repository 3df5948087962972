//! Every `robots/*.yaml` through the generator into `OUT_DIR`: one module a robot, and their registry.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::{env, fs, io};

fn main() -> ExitCode {
    println!("cargo::rerun-if-changed=robots");
    match run() {
        Ok(mistakes) if mistakes.is_empty() => ExitCode::SUCCESS,
        Ok(mistakes) => {
            mistakes.iter().for_each(|mistake| eprintln!("{mistake}"));
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// Writes the modules, or says what is wrong with the tables.
fn run() -> io::Result<Vec<String>> {
    let mut paths: Vec<PathBuf> =
        fs::read_dir("robots")?.map(|e| e.map(|e| e.path())).collect::<Result<_, _>>()?;
    paths.retain(|path| path.extension().is_some_and(|e| e == "yaml"));
    paths.sort();
    let mut files = Vec::new();
    for path in &paths {
        println!("cargo::rerun-if-changed={}", path.display());
        files.push((path.display().to_string(), fs::read(path)?));
    }
    let modules = match dynid_codegen::generate_all(&files) {
        Ok(modules) => modules,
        Err(mistakes) => return Ok(mistakes.iter().map(ToString::to_string).collect()),
    };
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or_else(|| io::Error::other("OUT_DIR is not set"))?);
    let mut registry = String::new();
    let (mut models, mut operations) = (Vec::new(), Vec::new());
    for module in &modules {
        let path = out.join(format!("{}.rs", module.name));
        write_if_changed(&path, &module.source)?;
        registry.push_str(&format!("#[path = {path:?}]\npub mod {};\n", module.name));
        models.push(format!("&{}::Dynamics", module.name));
        operations.push(format!("&{}::OPERATIONS", module.name));
    }
    registry.push_str(&format!("static MODELS: &[&dyn Model] = &[{}];\n", models.join(", ")));
    registry.push_str(&format!("static OPERATIONS: &[&[Operations]] = &[{}];\n", operations.join(", ")));
    write_if_changed(&out.join("registry.rs"), &registry)?;
    Ok(Vec::new())
}

fn write_if_changed(path: &Path, text: &str) -> io::Result<()> {
    if fs::read_to_string(path).is_ok_and(|old| old == text) { Ok(()) } else { fs::write(path, text) }
}
