//! What a model of a robot computes. Equation numbers are those of Gautier and Briot.

use std::borrow::Cow;

use super::block::Line;
use super::states::States;
use dynid_description::Robot;

/// Where the inverse dynamic regressor can be non-zero: the block-triangular form (5), entry by entry.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    /// `rows[i]..rows[i + 1]` are the entries of joint i; length n + 1.
    pub rows: Cow<'static, [usize]>,
    /// Base parameter (column) of each entry, ascending within a row.
    pub columns: Cow<'static, [usize]>,
    /// The first entry that has the value of each entry at every state, itself where there is none before it:
    /// parallel axes share the columns of their couples, and offsets are all 1.
    pub same_as: Cow<'static, [usize]>,
}

/// Arithmetic of one evaluation of a generated function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Operations {
    /// `h`, `dh`, `IDM`, `M, N` or `tau`.
    pub function: &'static str,
    /// Multiplications.
    pub multiplications: usize,
    /// Additions, subtractions and changes of sign.
    pub additions: usize,
    /// Sine and cosine of one angle, taken together.
    pub sine_cosine_pairs: usize,
}

/// The dynamics of one robot in its base parameters chi (n joints, nb parameters).
///
/// Slices have exactly the lengths named; the methods allocate nothing and never fail on finite input.
/// Shapes that do not fit are a bug of the caller and panic.
pub trait Model: Send + Sync {
    /// The robot this is a model of.
    fn robot(&self) -> &Robot;

    /// Which entries of IDM are computed; the others are zero for every state.
    fn pattern(&self) -> &Pattern;

    /// Energy row h(q, dq) of (10): nb values, J per unit parameter; springs have their potential. Friction columns are zero,
    /// those of offsets too: where the weight that a prismatic joint lifts was regrouped into its offset (`off2R`), h chi
    /// lacks its potential, which is the offset times q of that joint, and the power row has its rate.
    /// [`energies`](super::energies) are complete.
    fn energy(&self, q: &[f64], dq: &[f64], h: &mut [f64]);

    /// Power row dh(q, dq, ddq) of (10), friction included: nb values, W per unit parameter.
    fn power(&self, q: &[f64], dq: &[f64], ddq: &[f64], dh: &mut [f64]);

    /// Inverse dynamic regressor of (4): the entries of `pattern`, in its order.
    fn idm(&self, q: &[f64], dq: &[f64], ddq: &[f64], entries: &mut [f64]);

    /// [`Model::idm`] for many samples: entry e of sample t is written to `out[e * stride + t]`.
    ///
    /// Allocation-free; `stride` is at least the number of samples.
    fn idm_block(&self, states: States<'_>, stride: usize, out: &mut [f64]);

    /// [`Model::idm`] for many samples in the order in which they are computed: entry e of the i-th [`Line`] of
    /// samples is written to `out[i * width + e]`, what lies behind the last sample is of no meaning.
    ///
    /// About twice as fast as [`Model::idm_block`]. `width` is at least the number of entries.
    fn idm_lines(&self, states: States<'_>, width: usize, out: &mut [Line]);

    /// [`Model::power`] for many samples: column k of sample t is written to `out[k * stride + t]`.
    fn power_block(&self, states: States<'_>, stride: usize, out: &mut [f64]);

    /// [`Model::energy`] for many samples (`states.ddq` is not read).
    fn energy_block(&self, states: States<'_>, stride: usize, out: &mut [f64]);

    /// Mass matrix M(q) (n x n, row-major, both triangles) and bias N(q, dq) of (1) for given base parameters:
    /// centrifugal, Coriolis and gravity torques and those of springs, with the rotor inertias; friction and offsets are not
    /// included.
    fn mass_and_bias(&self, chi: &[f64], q: &[f64], dq: &[f64], mass: &mut [f64], bias: &mut [f64]);

    /// Torques IDM(q, dq, ddq) chi of (4) for given base parameters, friction, rotor inertias and offsets included:
    /// n values, N.m or N. By Newton-Euler, in less time than the regressor takes.
    fn torque(&self, chi: &[f64], q: &[f64], dq: &[f64], ddq: &[f64], torque: &mut [f64]);

    /// [`Model::torque`] for many samples: joint j of sample t is written to `out[j * stride + t]`.
    fn torque_block(&self, chi: &[f64], states: States<'_>, stride: usize, out: &mut [f64]);
}
