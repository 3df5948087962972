//! From motions to parameters: observation rows, orthogonal factors, estimators, statistics.

mod factor;
mod householder;
pub mod observe;
mod solve;

pub use factor::{BLOCK_ROWS, Factor};
pub use solve::{RANK_TOLERANCE, Solution};
