//! What must hold of the parts of a robot.

/// What must hold of one part of a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Constraint {
    /// The body of a frame, 0-based, has a density that is nowhere negative, and is within its ellipsoid.
    Body(usize),
    /// The rotor inertia of a motor, 0-based, is positive.
    Rotor(usize),
}
