//! The experiment of Gautier and Briot's power-model paper, for any robot: five ways to identify the same robot, and
//! how well each of them reconstructs its torques.

mod campaign;
mod cases;
mod published;

pub use campaign::{Campaign, CampaignError, Motions, SeedResult, Spread, record, spread};
pub use cases::{Case, CaseResult, PaperSettings, mean_difference, parameter_difference, run_cases};
pub use published::{PUBLISHED_DEVIATIONS, PUBLISHED_PARAMETERS, PublishedParameter, published_error};

#[cfg(test)]
mod tests;
