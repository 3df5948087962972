//! From the table, symbolically: kinematics, energy h, power dh, inverse dynamic rows, mass matrix and bias, torques.
//!
//! ```
//! use dynid_codegen::{base::base_set, mechanics::Equations, robot::parse, symbolic::Graph};
//!
//! let yaml = b"
//! name: pendulum
//! gravity: [0, -9.81, 0]
//! frames:
//!   - {j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}
//! ";
//! let table = parse("pendulum.yaml", yaml).expect("a table without mistakes");
//! let set = base_set(&table);
//! let equations = Equations::derive(&table, &set).expect("its motor turns with its joint");
//!
//! // The torque of the inertia about the axis is the acceleration; an offset acts as it is.
//! let column = |name: &str| set.base.iter().position(|p| p.name == name).expect("a base parameter");
//! let shown = equations.idm[0][column("ZZ1R")];
//! assert_eq!(shown, equations.graph.clone().symbol(dynid_codegen::symbolic::Symbol::Acceleration(0)));
//! assert_eq!(equations.idm[0][column("off1")], Graph::ONE);
//! ```

mod between;
mod columns;
mod drive;
mod energy;
mod error;
mod forward;
mod geometry;
mod inverse;
mod model;
mod motion;
mod torque;
mod vector;

pub use error::ModelError;
pub use geometry::{Geometry, Link, Rotation};
pub use model::{Equations, ModelCounts};
pub use torque::TorqueEquations;

#[cfg(test)]
mod random_tables;
#[cfg(test)]
mod tests;
