//! What an estimation says. Equation numbers are those of Gautier and Briot.

use crate::model::JointNumber;
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

/// One identified unknown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParameterEstimate {
    /// Base parameter or extra unknown.
    pub name: String,
    /// SI; zero where the data do not determine it.
    pub value: f64,
    /// Standard deviation, for errors that last as the residuals show it where the rows were kept, else by blocks of
    /// time, and where there are too few of them `sigma_white`. `None` where the parameter is not determined.
    pub sigma: Option<f64>,
    /// Standard deviation (18), for errors that are independent from row to row, as the paper assumes.
    #[serde(default)]
    pub sigma_white: Option<f64>,
    /// Standard deviation by leaving out one block of time after the other: right for errors that last up to half a
    /// second, as those of robots do. `None` where not determined or with fewer than five blocks.
    pub sigma_blocks: Option<f64>,
    /// What was added to the value of least squares for the noise of the encoders in its columns; its uncertainty is part
    /// of `sigma`. `None` where that noise is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub correction: Option<f64>,
    /// 100 sigma / |value| (19).
    pub relative_sigma_percent: Option<f64>,
}

/// The standard deviation of the errors of one equation in one trajectory, whose inverse is its weight.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EquationError {
    /// Index of the motion.
    pub trajectory: usize,
    /// Joint (0-based), or 0 for the power model.
    pub equation: usize,
    /// N.m, N or W; `None` where every row is zero, so that there is no error to speak of.
    pub sigma: Option<f64>,
    /// ||Y - W chi|| / ||Y|| over the rows that were used; `None` where all torques Y are zero.
    pub relative_error: Option<f64>,
    /// Rows that were used.
    pub rows: usize,
}

/// A block of time that counts less than half in a robust estimate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BlockWeight {
    /// Index of the motion.
    pub trajectory: usize,
    /// Joint (0-based), or 0 for the power model.
    pub equation: usize,
    /// First and last row, s.
    pub time: [f64; 2],
    /// What it counts, 1 for a block that fits.
    pub weight: f64,
}

/// What a person should know about an estimate before believing it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
#[non_exhaustive]
pub enum Warning {
    /// The data do not determine a parameter; its value was set to zero.
    NotDetermined {
        /// Its name.
        parameter: String,
        /// The parameters that it cannot be told from; empty: it never acted.
        from: Vec<String>,
    },
    /// The scaled observation matrix is nearly singular.
    BadlyConditioned {
        /// Condition number.
        condition: f64,
        /// The parameters that make up the weakest direction, the strongest first.
        parameters: Vec<String>,
    },
    /// Iterated weights gave up on an equation; the weights of (20) from its own fit were used instead.
    WeightCollapsed {
        /// Its joint; `None` for the power model.
        joint: Option<JointNumber>,
        /// Its relative error with iterated weights.
        relative_error: f64,
    },
    /// The model explains less of an equation than no model at all.
    NotExplained {
        /// Its joint; `None` for the power model.
        joint: Option<JointNumber>,
        /// Its relative error.
        relative_error: f64,
    },
    /// Motions with fewer rows of an equation than it has parameters: their error is taken from the others.
    FewRows {
        /// Their joint; `None` for the power model.
        joint: Option<JointNumber>,
        /// How many motions.
        motions: usize,
        /// Of how many that have rows.
        of: usize,
    },
    /// Total least squares: there are no standard deviations.
    NoDeviations,
    /// Total least squares has no solution here; that of least squares is given.
    NoTotalSolution,
    /// More than half of what tells some parameters apart is noise of the encoders: the parameters are not corrected
    /// for it.
    NoisyColumns,
    /// The iteration of the weights had not converged.
    NotConverged {
        /// Iterations made.
        iterations: usize,
    },
}

/// The equation of a joint, or that of the power model.
fn named(joint: Option<JointNumber>) -> String {
    joint.map_or_else(|| "power".to_owned(), |joint| format!("joint {joint}"))
}

impl std::fmt::Display for Warning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Warning::NotDetermined { parameter, from } if from.is_empty() => {
                write!(
                    f,
                    "{parameter} is not determined: nothing in the recording depends on it; set to zero"
                )
            }
            Warning::NotDetermined { parameter, from } => {
                write!(f, "{parameter} cannot be told from {} in this motion; set to zero", from.join(", "))
            }
            Warning::BadlyConditioned { condition, parameters } => write!(
                f,
                "badly conditioned ({condition:.0}): this motion hardly tells {} apart",
                parameters.join(", ")
            ),
            Warning::WeightCollapsed { joint, relative_error } => write!(
                f,
                "{}: iterated weights gave up on it (error {:.0} %); the weights of its own fit were used",
                named(*joint),
                100.0 * relative_error
            ),
            Warning::NotExplained { joint: Some(joint), relative_error } => write!(
                f,
                "joint {joint}: the model does not explain its torque (error {:.0} %)",
                100.0 * relative_error
            ),
            Warning::NotExplained { joint: None, relative_error } => write!(
                f,
                "the model does not explain the power of the joints (error {:.0} %)",
                100.0 * relative_error
            ),
            Warning::FewRows { joint, of: 1, .. } => write!(
                f,
                "{}: fewer equations than parameters, so that its own error says little (a longer motion or a wider \
                 --band gives more)",
                named(*joint)
            ),
            Warning::FewRows { joint, motions, of } => write!(
                f,
                "{}: {motions} of {of} motions have fewer equations than parameters, so that their own error says little; \
                 their weights rest on all motions together (longer motions or a wider --band give more)",
                named(*joint)
            ),
            Warning::NoDeviations => write!(
                f,
                "total least squares gives no standard deviations: its assumption, errors of the columns that are \
                 independent and of one relative size, does not hold for columns that come from one position signal"
            ),
            Warning::NoTotalSolution => {
                write!(f, "total least squares has no solution here: the values are those of least squares")
            }
            Warning::NoisyColumns => write!(
                f,
                "more than half of what tells some parameters apart is noise of the positions: inertias come out too small; \
                 lower --band, or move faster"
            ),
            Warning::NotConverged { iterations } => {
                write!(f, "the weights had not converged after {iterations} iterations")
            }
        }
    }
}

/// The simplified model of the paper: parameters that the data determine well compared with the best.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Essential {
    /// The parameters that are kept, with their own estimates.
    pub parameters: Vec<ParameterEstimate>,
    /// Parameters that were cancelled, in the order of cancelling.
    pub cancelled: Vec<String>,
    /// ||Y - W chi|| / ||Y|| with the kept parameters.
    pub relative_error: f64,
}

/// An identified set of parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// How it was made.
    pub method: Method,
    /// Base parameters, then extra unknowns, in the order of the observation.
    pub parameters: Vec<ParameterEstimate>,
    /// Errors per trajectory and equation.
    pub errors: Vec<EquationError>,
    /// ||Y - W chi|| / ||Y|| over all rows that were used.
    pub relative_error: f64,
    /// The same per equation.
    pub per_equation: Vec<f64>,
    /// Rows that were used, all equations.
    pub rows: usize,
    /// Rows minus parameters.
    pub degrees_of_freedom: usize,
    /// Condition number of the weighted W with columns of unit length.
    pub condition: f64,
    /// Iterations of the weights.
    pub iterations: usize,
    /// Blocks of time that count less than half, where the estimate is robust.
    pub low_blocks: Vec<BlockWeight>,
    /// What to know before believing it.
    pub warnings: Vec<Warning>,
    /// The simplified model, where it was asked for.
    pub essential: Option<Essential>,
}

impl Estimate {
    /// The parameters as a vector in the order of the observation's unknowns.
    pub fn chi(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.value).collect()
    }
}
