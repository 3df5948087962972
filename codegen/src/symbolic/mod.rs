//! The project's own symbolic engine: a hash-consed expression graph and what a generator needs on it.
//!
//! ```
//! use dynid_codegen::symbolic::{Angle, Graph, Symbol};
//! let mut g = Graph::new();
//! let (s, c) = g.sin_cos(&Angle::joint(0));
//! let ss = g.mul(s, s);
//! let cc = g.mul(c, c);
//! assert_eq!(g.add(ss, cc), Graph::ONE);
//! let dq = g.symbol(Symbol::Velocity(0));
//! let minus_sine_rate = g.mul(s, dq);
//! assert_eq!(g.time_derivative(c), -minus_sine_rate);
//! ```

mod angle;
mod arithmetic;
mod count;
mod differentiate;
mod evaluate;
mod expr;
mod factor;
mod graph;
mod schedule;
mod trigonometry;

pub use angle::{Angle, ConstantAngle};
pub use count::OperationCounts;
pub use evaluate::Point;
pub use expr::{Expr, Node, Symbol};
pub use graph::Graph;
pub use schedule::schedule;
