//! Base parameters: the closed-form regrouping rules, and what they do not reach.

mod standard;

pub use standard::standard_parameters;

/// What a standard parameter is, in the order of (3).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs)]
pub enum ParameterKind {
    XX,
    XY,
    XZ,
    YY,
    YZ,
    ZZ,
    MX,
    MY,
    MZ,
    M,
    Ia,
    Fv,
    Fc,
    Off,
    Fvm,
    Fcm,
}

/// A standard parameter of a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct StandardParameter {
    /// `ZZ1`, `Ia3`, `Fvm6`: kind and number j of the frame.
    pub name: String,
    /// What it is.
    pub kind: ParameterKind,
    /// Index of its frame in `Robot::frames`.
    pub frame: usize,
}

/// A base parameter: the standard parameter whose column is kept, and what was regrouped into it.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseParameter {
    /// Standard name, with an R when something was regrouped into it.
    pub name: String,
    /// Index of the kept parameter in `BaseSet::standard`.
    pub standard: usize,
    /// chi = sum of coefficient * chi_st[index], ascending index, the kept one with coefficient 1.
    pub combination: Vec<(usize, f64)>,
    /// The same in symbols of the table: `ZZ1 + Ia1 + d3^2*M3`.
    pub relation: String,
    /// SI unit.
    pub unit: String,
}

/// The standard parameters of a robot in the order of chi_st, and its base parameters in the order of chi.
///
/// chi_st: for each frame XX XY XZ YY YZ ZZ MX MY MZ M; where the frame is a joint, Ia Fv Fc off follow, then
/// Fvm Fcm where its motor has coupled friction. Base parameters keep that order.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseSet {
    /// Every standard parameter.
    pub standard: Vec<StandardParameter>,
    /// Every base parameter.
    pub base: Vec<BaseParameter>,
}
