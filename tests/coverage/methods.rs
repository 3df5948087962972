//! What is made of a recording: every method, as the command line runs it.

use dynid_runtime::estimation::observe::{Equations, Observation, ObserveError, ObserveSettings, observe};
use dynid_runtime::estimation::{
    EstimateSettings, Instruments, Method, RecordedSettings, Take, estimate, instrumental_variables,
    observe_in_pieces, observe_trajectories,
};
use dynid_runtime::recording::Trajectory;
use dynid_runtime::simulation::{DidimSettings, Experiment, didim, simulated_motions};

use super::cases::{Case, Recording};

pub const NAMES: [&str; 8] =
    ["idim-ols", "idim-wls", "idim-irls", "pim-ols", "pim-wls", "pim-irls", "idim-iv", "idim-didim"];

/// Values with their standard deviations, by one method.
pub struct Outcome {
    pub method: String,
    pub chi: Vec<f64>,
    pub sigma: Vec<Option<f64>>,
}

pub fn all(case: &Case<'_>, recording: &Recording, band: Option<f64>, wanted: &[String]) -> Vec<Outcome> {
    let rows = ObserveSettings { threads: 1, ..ObserveSettings::default() };
    let settings = RecordedSettings { band, rows, ..RecordedSettings::default() };
    let mut outcomes = Vec::new();
    for power in [false, true] {
        let methods: Vec<Method> = Method::ALL
            .into_iter()
            .filter(|m| m.is_power() == power && wanted.iter().any(|w| w == m.name()))
            .collect();
        if methods.is_empty() {
            continue;
        }
        let equations = if power { Equations::Power { closed_form: false } } else { Equations::Torque };
        let observation = &observed(case, &recording.trajectories, equations, &settings);
        for method in methods {
            let settings = EstimateSettings { r_sigma: None, ..EstimateSettings::for_method(method) };
            let found = estimate(observation, &settings);
            let sigma = found.parameters.iter().map(|p| p.sigma).collect();
            outcomes.push(Outcome { method: method.name().to_owned(), chi: found.chi(), sigma });
        }
    }
    let simulated = |name: &str| wanted.iter().any(|w| w == name);
    if simulated("idim-didim") || simulated("idim-iv") {
        outcomes.extend(with_simulated_states(case, recording, &settings, &simulated));
    }
    outcomes
}

/// The equations as `dynid identify` has them: of a recording with more rows than are held, piece by piece.
fn observed(
    case: &Case<'_>,
    trajectories: &[Trajectory],
    equations: Equations,
    settings: &RecordedSettings,
) -> Observation {
    let mut read = |take: &mut Take<'_, ObserveError>| {
        trajectories.iter().try_for_each(|piece| take(piece.clone(), piece.name.clone()))
    };
    let (whole, ()) = observe_in_pieces(case.model, &[equations], settings, &mut read, None).unwrap();
    whole.observations.into_iter().next().unwrap()
}

/// Instrumental variables and DIDIM: both simulate the motions that were planned, from the parameters of IDIM-WLS.
fn with_simulated_states(
    case: &Case<'_>,
    recording: &Recording,
    settings: &RecordedSettings,
    wanted: &dyn Fn(&str) -> bool,
) -> Vec<Outcome> {
    let experiments: Vec<Experiment<'_>> = recording
        .trajectories
        .iter()
        .zip(&recording.settings)
        .zip(&recording.motions)
        .map(|((recorded, settings), reference)| Experiment { reference, settings, recorded })
        .collect();
    let observed =
        observe_trajectories(&recording.trajectories, case.model, &[Equations::Torque], settings, None)
            .unwrap();
    let rows = ObserveSettings { acceleration_noise: Vec::new(), keep_rows: true, ..observed.settings };
    let weighted = estimate(&observed.observations[0], &EstimateSettings::default());
    let mut outcomes = Vec::new();
    if wanted("idim-iv") {
        let motions = simulated_motions(case.model, &experiments, &weighted.chi()).unwrap();
        let instruments = Instruments::new(case.model, &motions);
        let observation =
            observe(case.model, &observed.motions, Equations::Torque, Some(&instruments), &rows, None)
                .unwrap();
        let error = |trajectory: usize, equation: usize| {
            let of = weighted.errors.iter().find(|e| (e.trajectory, e.equation) == (trajectory, equation));
            of.and_then(|e| e.sigma).unwrap_or(1.0)
        };
        let errors: Vec<f64> = observation.groups.iter().map(|g| error(g.trajectory, g.equation)).collect();
        let found = instrumental_variables(&observation, &errors).unwrap();
        let sigma = found.sigma.into_iter().map(Some).collect();
        outcomes.push(Outcome { method: "idim-iv".to_owned(), chi: found.chi, sigma });
    }
    if wanted("idim-didim") {
        let settings = DidimSettings { observe: rows, ..DidimSettings::default() };
        let found = didim(case.model, &experiments, &weighted.chi(), &settings).unwrap().estimate;
        let sigma = found.parameters.iter().map(|p| p.sigma).collect();
        outcomes.push(Outcome { method: "idim-didim".to_owned(), chi: found.chi(), sigma });
    }
    outcomes
}
