//! From motions to parameters: observation rows, orthogonal factors, estimators, statistics.

mod bandwidth;
mod blocks;
mod essential;
mod estimate;
mod factor;
mod householder;
mod identified;
mod instrumental;
pub mod observe;
mod outcome;
mod physical;
mod piecewise;
mod robust;
mod solve;
mod total;
mod weights;

pub use bandwidth::{Bandwidth, choose_bandwidth};
pub use estimate::{EstimateSettings, errors_against, estimate, per_equation, relative_error};
pub use factor::{BLOCK_ROWS, Factor};
pub use identified::{EquationRows, EssentialParameters, Identified, NamedParameter, Observed};
pub use instrumental::{InstrumentalError, InstrumentalEstimate, Instruments, instrumental_variables};
pub use outcome::{
    BlockWeight, EquationError, Essential, Estimate, Method, ParameterEstimate, Solver, Warning,
};
pub use physical::{PhysicalFit, physical_fit};
pub use piecewise::Piecewise;
pub use solve::{RANK_TOLERANCE, Solution};
