//! The schemes by which a plant takes a step. `docs/simulation.md` compares them.

/// How a step is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scheme {
    /// Euler's, order 1.
    ExplicitEuler,
    /// Velocities first, then positions with the new ones (symplectic Euler), order 1.
    SemiImplicitEuler,
    /// Heun's (1900), order 2.
    Heun,
    /// The classical one of four stages (Kutta 1901), order 4.
    #[default]
    RungeKutta4,
    /// ROS2 (Verwer, Spee, Blom and Hundsdorfer 1999), order 2 and L-stable: for drives so stiff that the other
    /// schemes need steps far below the control period. Its Jacobian is taken by differences.
    Rosenbrock2,
}

impl Scheme {
    /// All of them.
    pub const ALL: [Scheme; 5] = [
        Scheme::ExplicitEuler,
        Scheme::SemiImplicitEuler,
        Scheme::Heun,
        Scheme::RungeKutta4,
        Scheme::Rosenbrock2,
    ];

    /// For a person.
    pub fn name(self) -> &'static str {
        match self {
            Scheme::ExplicitEuler => "explicit Euler",
            Scheme::SemiImplicitEuler => "semi-implicit Euler",
            Scheme::Heun => "Heun (RK2)",
            Scheme::RungeKutta4 => "Runge-Kutta 4",
            Scheme::Rosenbrock2 => "Rosenbrock 2 (stiff-safe)",
        }
    }
}
