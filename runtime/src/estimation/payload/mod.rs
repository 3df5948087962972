//! A payload on the last link: what is known of it, its columns, and what a loaded recording says of it.

mod difference;
mod known;
mod quantities;

pub use difference::{PayloadError, PayloadFit, ReferenceModel, payload_of};
pub use known::{KnownPayload, KnownPayloadError};
pub(super) use known::{Split, base_of_body};
pub use quantities::{PayloadBody, Quantity};
