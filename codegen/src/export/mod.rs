//! A robot's functions as code that needs nothing of dynid: C99, and Rust without std.
//!
//! Both are written from the statements that the generated Rust is written from: the same operations in the same order
//! under the same names.

mod c;
mod casadi;
mod header;
mod law;
mod rust;

use crate::base::BaseSet;
use crate::mechanics::{Equations, ModelError};
use crate::numeric::table_of;
use crate::robot::RobotTable;
use dynid_description::Robot;
use law::LawFormula;

/// What is known of one robot beside its table: an identified model.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Known {
    /// Base parameters, in the robot's order.
    pub chi: Vec<f64>,
    /// Bodies that the robot carries beside it.
    pub bodies: Vec<Carried>,
    /// Torques that its standard model leaves out.
    pub laws: Vec<Law>,
    /// What belongs to the model and is not in the code, each with its reason.
    pub left_out: Vec<String>,
}

/// A body that a link carries.
#[derive(Debug, Clone, PartialEq)]
pub struct Carried {
    /// What it is, for a comment.
    pub title: String,
    /// What it adds to the base parameters, in the robot's order. The loads that laws look at are those without it.
    pub chi: Vec<f64>,
}

/// A torque on one joint by a formula of the motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Law {
    /// The joint, 0-based.
    pub joint: usize,
    /// What it is, for a comment.
    pub title: String,
    /// Its torque, N.m or N: numbers, `pi`, `q<j>`, `dq<j>`, `ddq<j>`, `load<j>` (torque of inertia and gravity of joint
    /// j), functions, `+ - * / ^` and parentheses, as in a law of the user.
    pub text: String,
}

/// The floating-point type of exported C.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Real {
    /// `float`.
    Single,
    /// `double`.
    Double,
}

/// Why there is no code.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The robot has no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Parameters of another robot.
    #[error("{found} parameters: the robot has {expected}")]
    Parameters {
        /// Values given.
        found: usize,
        /// Base parameters of the robot.
        expected: usize,
    },
    /// A law that cannot be read.
    #[error("{title}: {message}")]
    Law {
        /// Title of the law.
        title: String,
        /// What is wrong.
        message: String,
    },
    /// The text that was written is not Rust; a bug of the generator.
    #[error("the generated code does not parse: {0}")]
    Syntax(String),
}

/// A header and a source.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CFiles {
    /// What both files are called, without `.h` and `.c`, and what every name in them begins with.
    pub name: String,
    /// The header.
    pub header: String,
    /// The source.
    pub source: String,
}

/// A source beside those of C.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CasadiFile {
    /// What the file is called, without `.c`.
    pub name: String,
    /// Its text.
    pub source: String,
}

/// A Rust module.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RustFile {
    /// What the file is called, without `.rs`.
    pub name: String,
    /// Its text.
    pub source: String,
}

/// A robot in C99: h, dh, IDM with its pattern, M and N, tau, and the torques of what is known of it.
///
/// The source needs the C library's mathematics and allocates nothing.
///
/// # Errors
/// A robot without a model, parameters of another one, a law that cannot be read.
pub fn export_c(robot: &Robot, known: Option<&Known>, real: Real) -> Result<CFiles, ExportError> {
    Ok(c::files(&Export::new(robot, known)?, real))
}

/// The functions of [`export_c`] with double numbers as CasADi loads them from a library: `casadi_<robot>_tau` and so on.
///
/// # Errors
/// As [`export_c`].
pub fn export_casadi(robot: &Robot, known: Option<&Known>) -> Result<CasadiFile, ExportError> {
    Ok(casadi::file(&Export::new(robot, known)?))
}

/// A robot as a Rust module that depends on nothing but `core`.
///
/// # Errors
/// As [`export_c`]; [`ExportError::Syntax`] is a bug of the generator.
pub fn export_rust(robot: &Robot, known: Option<&Known>) -> Result<RustFile, ExportError> {
    let export = Export::new(robot, known)?;
    let source = rust::module(&export).map_err(|error| ExportError::Syntax(error.to_string()))?;
    Ok(RustFile { name: export.name, source })
}

/// Everything that goes into the code of one robot.
struct Export<'a> {
    /// A name that both languages take.
    name: String,
    table: RobotTable,
    set: BaseSet,
    equations: Equations,
    known: Option<&'a Known>,
    /// The laws of `known`, read.
    laws: Vec<LawFormula>,
}

impl<'a> Export<'a> {
    fn new(robot: &Robot, known: Option<&'a Known>) -> Result<Self, ExportError> {
        let (table, set) = table_of(robot);
        let equations = Equations::derive(&table, &set)?;
        let mut laws = Vec::new();
        if let Some(known) = known {
            let expected = set.base.len();
            let counts = known.bodies.iter().map(|body| body.chi.len()).chain([known.chi.len()]);
            if let Some(found) = counts.into_iter().find(|&found| found != expected) {
                return Err(ExportError::Parameters { found, expected });
            }
            let numbers: Vec<usize> = table.joint_frames().iter().map(|&f| table.frames[f].j).collect();
            for law in &known.laws {
                let title = law.title.clone();
                let formula = law::read(&law.text, &numbers).map_err(|error| ExportError::Law {
                    title,
                    message: format!("character {}: {}", error.offset + 1, error.message),
                })?;
                laws.push(formula);
            }
        }
        Ok(Export { name: identifier(&robot.name), table, set, equations, known, laws })
    }

    /// `pattern().0[i]..pattern().0[i + 1]` are the entries of row i, `pattern().1` their columns.
    fn pattern(&self) -> (Vec<usize>, Vec<usize>) {
        let entries = self.equations.pattern();
        let rows = (0..=self.equations.idm.len()).map(|i| entries.iter().filter(|e| e.0 < i).count());
        (rows.collect(), entries.iter().map(|e| e.1).collect())
    }

    /// The known parameters with those of the bodies that are carried.
    fn parameters(&self) -> Vec<f64> {
        let Some(known) = self.known else { return Vec::new() };
        let mut chi = known.chi.clone();
        for body in &known.bodies {
            chi.iter_mut().zip(&body.chi).for_each(|(value, added)| *value += added);
        }
        chi
    }

    /// The known parameters with those of friction and offsets zero: their torques are the loads.
    fn load_parameters(&self) -> Vec<f64> {
        let moves = |k: usize| self.set.standard[self.set.base[k].standard].kind.is_load();
        let chi = self.known.map_or(&[][..], |known| &known.chi);
        chi.iter().enumerate().map(|(k, &x)| if moves(k) { x } else { 0.0 }).collect()
    }

    /// Whether a law looks at a load.
    fn needs_loads(&self) -> bool {
        self.laws.iter().any(|law| law.inputs().any(|input| input.array == "load"))
    }
}

/// Small letters, digits and underscores, beginning with a letter.
fn identifier(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
    let text: String = name.chars().map(plain).collect();
    if text.starts_with(|c: char| c.is_ascii_lowercase()) { text } else { format!("robot_{text}") }
}
