//! How large a hidden effect is: by what is seen of it, within what a robot may have.

/// Sizes: barely visible, clear, obvious.
pub const SIZES: [&str; 3] = ["small", "medium", "large"];

/// What each size aims at: torque of the effect that the standard parameters cannot take over, relative to the noise.
pub const VISIBLE: [f64; 3] = [1.0, 2.5, 6.0];
