//! Statistics that identification and diagnosis share.

pub(crate) mod moderation;
