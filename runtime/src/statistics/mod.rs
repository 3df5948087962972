//! Statistics that identification and diagnosis share.

pub(crate) mod bins;
pub(crate) mod median;
pub(crate) mod moderation;
