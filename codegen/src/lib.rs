//! From a modified Denavit-Hartenberg table to closed-form Rust.
//!
//! [`robot::parse`] reads a table from YAML, [`base::base_set`] finds the base parameters, [`generate`] writes a module
//! with the robot's data ([`dynid_description::Robot`]), the energy and power rows, the inverse dynamic regressor, mass
//! matrix and bias, and an implementation of `dynid_runtime::model::Model`. Nothing here reads or writes a file.
//!
//! A crate with a robot of its own generates its model in `build.rs`, with dynid-codegen among its build dependencies and
//! dynid-runtime among its dependencies:
//!
//! ```
//! use dynid_codegen::{generate, registry, robot::parse};
//! use std::{env, error::Error, fs, path::Path};
//!
//! fn build(table: &Path, out: &Path) -> Result<(), Box<dyn Error>> {
//!     println!("cargo::rerun-if-changed={}", table.display());
//!     let mistakes = |list: Vec<_>| list.iter().map(ToString::to_string).collect::<Vec<String>>().join("\n");
//!     let robot = parse(&table.display().to_string(), &fs::read(table)?).map_err(mistakes)?;
//!     let module = out.join("arm.rs");
//!     fs::write(&module, generate(&robot)?)?;
//!     fs::write(out.join("registry.rs"), registry(&[("arm", &module)]))?;
//!     Ok(())
//! }
//!
//! # fn script() -> Result<(), Box<dyn Error>> {
//! // fn main() -> Result<(), Box<dyn Error>> {
//! build(Path::new("arm.yaml"), Path::new(&env::var("OUT_DIR")?))
//! // }
//! # }
//! # fn main() -> Result<(), Box<dyn Error>> {
//! #     let folder = env::temp_dir().join(format!("dynid-codegen-example-{}", std::process::id()));
//! #     fs::create_dir_all(&folder)?;
//! #     let yaml = "name: arm\nframes:\n  - {j: 1, sigma: 0, alpha: pi/2, d: 0, theta: q1, r: 0}\n";
//! #     fs::write(folder.join("arm.yaml"), yaml)?;
//! #     build(&folder.join("arm.yaml"), &folder)?;
//! #     assert!(fs::read_to_string(folder.join("arm.rs"))?.contains("impl Model for Dynamics"));
//! #     assert!(fs::read_to_string(folder.join("registry.rs"))?.contains("pub mod arm;"));
//! #     fs::remove_dir_all(&folder)?;
//! #     Ok(())
//! # }
//! ```
//!
//! and takes it in with
//!
//! ```text
//! mod models {
//!     include!(concat!(env!("OUT_DIR"), "/registry.rs"));
//! }
//! // models::arm::Dynamics is a dynid_runtime::model::Model; models::MODELS lists them all.
//! ```
//!
//! A table that is read at run time needs no generated code: [`numeric_robot`] evaluates it for the recursive engine of
//! dynid-runtime, which gives the same numbers more slowly.
#![deny(missing_docs)]

pub mod base;
mod emit;
mod exact;
mod export;
mod generate;
pub mod mechanics;
mod numeric;
pub mod robot;
pub mod symbolic;

pub use export::{
    CFiles, Carried, CasadiFile, ExportError, Known, Law, Real, RustFile, export_c, export_casadi,
    export_rust,
};
pub use generate::{
    Collection, GenerateError, generate, generate_with, operation_counts, read_all, registry,
};
pub use numeric::numeric_robot;

#[cfg(test)]
mod testing;
