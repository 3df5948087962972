//! Cases 1 to 5 of the paper on given recordings.

use crate::estimation::observe::{Equations, Observation, ObserveError, ObserveSettings, observe};
use crate::estimation::{
    Estimate, EstimateSettings, ParameterEstimate, estimate, per_equation, relative_error,
};
use crate::model::Model;
use crate::signal::Motion;

/// One of the paper's ways to identify a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Case {
    /// IDIM-WLS on a single motion of all joints.
    One,
    /// IDIM-WLS on the sets of motions of section IV.B.
    Two,
    /// PIM-WLS on the single motion.
    Three,
    /// PIM-WLS on the sets.
    Four,
    /// IDIM-WLS on the single motion with the equations of joint 1 only.
    Five,
}

impl Case {
    /// All of them.
    pub const ALL: [Case; 5] = [Case::One, Case::Two, Case::Three, Case::Four, Case::Five];

    /// 1 to 5.
    pub fn number(self) -> usize {
        self as usize + 1
    }

    /// What it is, for a person.
    pub fn description(self) -> &'static str {
        match self {
            Case::One => "IDIM-WLS, one motion of all joints",
            Case::Two => "IDIM-WLS, the sets with joints 1..k fixed",
            Case::Three => "PIM-WLS, one motion of all joints",
            Case::Four => "PIM-WLS, the sets with joints 1..k fixed",
            Case::Five => "IDIM-WLS, one motion, joint 1 only",
        }
    }

    fn is_power(self) -> bool {
        matches!(self, Case::Three | Case::Four)
    }

    fn uses_sets(self) -> bool {
        matches!(self, Case::Two | Case::Four)
    }
}

/// How the cases are run.
#[derive(Debug, Clone, PartialEq)]
pub struct PaperSettings {
    /// Rows: band, rate, standstill.
    pub observe: ObserveSettings,
    /// Ratio of the essential parameters; 20 in the paper.
    pub r_sigma: f64,
    /// dh in closed form instead of by filtering and differentiating h, which is what the paper does.
    pub closed_form: bool,
}

impl Default for PaperSettings {
    fn default() -> Self {
        Self { observe: ObserveSettings::default(), r_sigma: 20.0, closed_form: false }
    }
}

/// What one case gives.
#[derive(Debug, Clone, PartialEq)]
pub struct CaseResult {
    /// Which.
    pub case: Case,
    /// The identification, with the essential parameters.
    pub estimate: Estimate,
    /// Base parameters of the simplified model; those that were cancelled or not determined are zero.
    pub chi: Vec<f64>,
    /// How many parameters survived.
    pub survived: usize,
    /// The identification with the same weight for every equation, where there are several a sample (Cases 1 and
    /// 2). The standard deviations that the paper prints for these cases follow it rather than weights joint by
    /// joint.
    pub equal_weights: Option<Estimate>,
    /// Table III: ||Y - W·chi|| / ||Y|| of the weighted system of the identification.
    pub identification_error: f64,
    /// Table IV: ||Y - W·chi|| / ||Y|| of the torques of all joints on the single motion.
    pub reconstruction_error: f64,
    /// The same joint by joint.
    pub per_joint: Vec<f64>,
}

impl CaseResult {
    /// How many parameters survive with the same weight for every equation.
    pub fn survived_equal_weights(&self) -> Option<usize> {
        self.equal_weights.as_ref().map(|equal| essential(equal).len())
    }

    /// Parameters of the whole model, before any is cancelled, whose relative standard deviation is at most
    /// `percent`.
    pub fn known_to(&self, percent: f64) -> usize {
        let known = |sigma: Option<f64>| sigma.is_some_and(|s| s <= percent);
        self.estimate.parameters.iter().filter(|p| known(p.relative_sigma_percent)).count()
    }
}

/// Runs the cases. `single` is the motion (or motions) with all joints moving; without `sets` only Cases 1, 3 and 5
/// are run. Torques are reconstructed on `single` for every case.
///
/// # Errors
/// Motions that cannot be observed.
pub fn run_cases(
    model: &dyn Model,
    single: &[Motion],
    sets: Option<&[Motion]>,
    settings: &PaperSettings,
) -> Result<Vec<CaseResult>, ObserveError> {
    let power = Equations::Power { closed_form: settings.closed_form };
    let seen =
        |motions: &[Motion], equations| observe(model, motions, equations, None, &settings.observe, None);
    let torques = seen(single, Equations::Torque)?;
    let mut results = Vec::new();
    for case in Case::ALL {
        let motions = match (case.uses_sets(), sets) {
            (false, _) => single,
            (true, Some(sets)) => sets,
            (true, None) => continue,
        };
        let observation = match case {
            Case::One => torques.clone(),
            Case::Five => first_joint_only(&torques),
            _ if case.is_power() => seen(motions, power)?,
            _ => seen(motions, Equations::Torque)?,
        };
        results.push(one_case(case, &observation, &torques, settings.r_sigma));
    }
    Ok(results)
}

fn first_joint_only(torques: &Observation) -> Observation {
    let mut observation = torques.clone();
    observation.groups.retain(|g| g.equation == 0);
    for block in &mut observation.blocks {
        block.equations.retain(|g| g.equation == 0);
    }
    observation.rows = None;
    observation
}

fn one_case(case: Case, observation: &Observation, torques: &Observation, r_sigma: f64) -> CaseResult {
    let settings = EstimateSettings {
        weighted: true,
        r_sigma: Some(r_sigma),
        block_sigmas: false,
        ..EstimateSettings::default()
    };
    let estimate = estimate(observation, &settings);
    let equal_weights = matches!(case, Case::One | Case::Two)
        .then(|| self::estimate(observation, &EstimateSettings { weighted: false, ..settings }));
    let kept = essential(&estimate);
    let mut chi = vec![0.0; observation.unknowns.len()];
    for parameter in kept {
        if let Some(k) = observation.unknowns.iter().position(|name| *name == parameter.name) {
            chi[k] = parameter.value;
        }
    }
    CaseResult {
        case,
        survived: kept.len(),
        equal_weights,
        identification_error: weighted_error(observation, &estimate, &chi),
        reconstruction_error: relative_error(torques, &chi).unwrap_or(f64::NAN),
        per_joint: per_equation(torques, &chi).into_iter().map(|error| error.unwrap_or(f64::NAN)).collect(),
        chi,
        estimate,
    }
}

/// The parameters of the simplified model.
fn essential(estimate: &Estimate) -> &[ParameterEstimate] {
    estimate.essential.as_ref().map_or(&estimate.parameters, |e| &e.parameters)
}

/// ||Y - W·chi|| / ||Y|| with every group divided by its standard deviation.
fn weighted_error(observation: &Observation, estimate: &Estimate, chi: &[f64]) -> f64 {
    let (mut residual, mut whole) = (0.0, 0.0);
    for error in &estimate.errors {
        let group = observation
            .groups
            .iter()
            .find(|g| g.trajectory == error.trajectory && g.equation == error.equation);
        let Some(group) = group else { continue };
        // A group of zeros adds nothing to either sum.
        let sigma = error.sigma.unwrap_or(1.0);
        residual += group.squares_left(chi) / sigma.powi(2);
        whole += group.squares_measured() / sigma.powi(2);
    }
    if whole > 0.0 { (residual / whole).sqrt() } else { 0.0 }
}

/// |other - reference| / |reference| in percent, where both keep parameter k.
pub fn parameter_difference(other: &CaseResult, reference: &CaseResult, k: usize) -> Option<f64> {
    let (a, b) = (other.chi[k], reference.chi[k]);
    (a != 0.0 && b != 0.0).then(|| 100.0 * ((a - b) / b).abs())
}

/// Mean of [`parameter_difference`] over the parameters that both keep; `None` where there are none.
pub fn mean_difference(other: &CaseResult, reference: &CaseResult) -> Option<f64> {
    let all: Vec<f64> =
        (0..other.chi.len()).filter_map(|k| parameter_difference(other, reference, k)).collect();
    (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
}
