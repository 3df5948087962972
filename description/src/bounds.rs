//! How large and how small the numbers of a robot are. What lies outside is no robot but a mistake, and squares and
//! products of it would not be finite.

/// Most frames, fixed ones included, that a table has: the recursive engine keeps its scratch on the stack.
pub const MAX_FRAMES: usize = 16;

/// Longest length of a table, m.
pub const LONGEST: f64 = 1e4;

/// Largest angle of a table, rad.
pub const WIDEST: f64 = 1e4;

/// An angle, rad, or a length, m, below this that is not zero is a rounding error: it makes base parameters whose
/// torques nothing can measure.
pub const NEGLIGIBLE: f64 = 1e-8;

/// Largest acceleration of gravity in any direction, m/s2.
pub const HEAVIEST: f64 = 1e4;

/// Largest gear ratio; the smallest that is not zero is one over it.
pub const FASTEST_GEAR: f64 = 1e6;

/// Most joints whose motors turn with other joints too: wrists couple two or three, and the exact arithmetic over a full
/// matrix takes time that grows with the sixth power of its size.
pub const MOST_COUPLED: usize = 8;

/// Largest limit of position, velocity, acceleration or torque, SI. The smallest width of a range is one over it.
pub const WIDEST_LIMIT: f64 = 1e9;

/// Largest value of a standard parameter, a gain of the controller or a noise level, SI.
pub const LARGEST_NOMINAL: f64 = 1e9;
