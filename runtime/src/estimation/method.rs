//! The methods of identification by their names. Equation numbers are those of Gautier and Briot.

use serde::{Deserialize, Serialize};

/// Which model is identified, and how its equations are weighted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Inverse dynamic model, ordinary least squares (15).
    IdimOls,
    /// Inverse dynamic model, one weight per joint and trajectory (20).
    IdimWls,
    /// Power model, ordinary least squares.
    PimOls,
    /// Power model, one weight per trajectory (21).
    PimWls,
    /// Inverse dynamic model, weighted, blocks of time that do not fit count less.
    IdimIrls,
    /// Inverse dynamic model, weighted, with errors in the columns as well.
    IdimTls,
    /// Power model, weighted, blocks of time that do not fit count less.
    PimIrls,
    /// Power model, weighted, with errors in the columns as well.
    PimTls,
}

impl Method {
    /// Every method, in the order in which they are listed to a person.
    pub const ALL: [Method; 8] = [
        Method::IdimOls,
        Method::IdimWls,
        Method::PimOls,
        Method::PimWls,
        Method::IdimIrls,
        Method::IdimTls,
        Method::PimIrls,
        Method::PimTls,
    ];

    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Method::IdimOls => "idim-ols",
            Method::IdimWls => "idim-wls",
            Method::PimOls => "pim-ols",
            Method::PimWls => "pim-wls",
            Method::IdimIrls => "idim-irls",
            Method::IdimTls => "idim-tls",
            Method::PimIrls => "pim-irls",
            Method::PimTls => "pim-tls",
        }
    }

    /// Whether the power model is identified.
    pub fn is_power(self) -> bool {
        matches!(self, Method::PimOls | Method::PimWls | Method::PimIrls | Method::PimTls)
    }

    /// Whether equations are weighted.
    pub fn is_weighted(self) -> bool {
        !matches!(self, Method::IdimOls | Method::PimOls)
    }

    /// How the weighted equations are solved.
    pub fn solver(self) -> Solver {
        match self {
            Method::IdimIrls | Method::PimIrls => Solver::Robust,
            Method::IdimTls | Method::PimTls => Solver::Total,
            _ => Solver::LeastSquares,
        }
    }
}

/// How the equations are solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Solver {
    /// Least squares (15).
    #[default]
    LeastSquares,
    /// Blocks of time that do not fit count less: Huber's M-estimator.
    Robust,
    /// Errors in the columns as well as in Y.
    Total,
}

impl std::str::FromStr for Method {
    type Err = String;

    fn from_str(text: &str) -> Result<Method, String> {
        let names: Vec<&str> = Method::ALL.iter().map(|m| m.name()).collect();
        Method::ALL
            .into_iter()
            .find(|m| m.name() == text)
            .ok_or_else(|| format!("no method is called {text:?}: one of {}", names.join(", ")))
    }
}
