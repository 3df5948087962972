//! A parameter that the dynamics can show.

use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// A base parameter: a standard parameter with what was regrouped into it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BaseParameter {
    /// Standard name, with an R when something was regrouped into it (`ZZ1R`).
    pub name: Cow<'static, str>,
    /// Index in `Robot::standard` of the parameter whose column of IDM_st is kept.
    pub standard: usize,
    /// chi = sum of coefficient * `chi_st[index]`; the kept parameter itself has coefficient 1.
    pub combination: Cow<'static, [(usize, f64)]>,
    /// The relation in symbols of the table: `ZZ1 + Ia1 + d3^2*M3 + ...`.
    pub relation: Cow<'static, str>,
    /// SI unit: `kg.m2`, `N.m.s/rad`, ...
    pub unit: Cow<'static, str>,
}
