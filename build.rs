//! Every `robots/*.yaml` through the generator into `OUT_DIR`: one module a robot, and their registry. A module is
//! generated again only where its robot or the generator has changed.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::{env, fs, io};

use dynid_codegen::robot::RobotTable;

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
    let collection = match dynid_codegen::read_all(&files) {
        Ok(collection) => collection,
        Err(mistakes) => return Ok(mistakes.iter().map(ToString::to_string).collect()),
    };
    collection.warnings.iter().for_each(|warning| println!("cargo::warning={warning}"));
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or_else(|| io::Error::other("OUT_DIR is not set"))?);
    let generator = generator()?;
    let mut modules = Vec::new();
    for robot in &collection.robots {
        let path = out.join(format!("{}.rs", robot.name));
        if let Err(error) = generate(robot, &path, generator)? {
            return Ok(vec![format!("robots/: {}: {error}", robot.name)]);
        }
        modules.push((robot.name.as_str(), path));
    }
    let modules: Vec<_> = modules.iter().map(|(name, path)| (*name, path.as_path())).collect();
    write_if_changed(&out.join("registry.rs"), &dynid_codegen::registry(&modules))?;
    Ok(Vec::new())
}

/// Writes the module of a robot, unless the one that is there was made from the same robot by the same generator.
fn generate(robot: &RobotTable, path: &Path, generator: u64) -> io::Result<Result<(), String>> {
    let mut hasher = DefaultHasher::new();
    (generator, format!("{robot:?}")).hash(&mut hasher);
    let key = format!("{:016x}", hasher.finish());
    let made_from = path.with_extension("made_from");
    if path.is_file() && fs::read_to_string(&made_from).is_ok_and(|known| known == key) {
        return Ok(Ok(()));
    }
    match dynid_codegen::generate(robot) {
        Ok(source) => {
            write_if_changed(path, &source)?;
            fs::write(&made_from, key)?;
            Ok(Ok(()))
        }
        Err(error) => Ok(Err(error.to_string())),
    }
}

/// What stands for the generator: this program, by its length and time.
fn generator() -> io::Result<u64> {
    let own = fs::metadata(env::current_exe()?)?;
    let mut hasher = DefaultHasher::new();
    (own.len(), own.modified()?).hash(&mut hasher);
    Ok(hasher.finish())
}

fn write_if_changed(path: &Path, text: &str) -> io::Result<()> {
    if fs::read_to_string(path).is_ok_and(|old| old == text) { Ok(()) } else { fs::write(path, text) }
}
