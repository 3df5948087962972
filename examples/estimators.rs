//! Bias, spread and torque error of every estimator, over seeds and noise levels: `docs/estimators.md`.
//!
//! `cargo run --release --example estimators -- [SEEDS] [FILE]`
#![allow(missing_docs)]

use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;

use dynid::models;
use dynid::output::{Bar, write_page};
use dynid_runtime::estimation::observe::{Equations, ObserveSettings, observe};
use dynid_runtime::estimation::{
    EquationError, EstimateSettings, Instruments, Method, estimate, instrumental_variables, relative_error,
};
use dynid_runtime::model::Model;
use dynid_runtime::paper::{Campaign, Motions, spread};
use dynid_runtime::recording::Trajectory;
use dynid_runtime::report::significant;
use dynid_runtime::signal::{Motion, Preparation, prepare};
use dynid_runtime::simulation::excitation::ExcitingMotion;
use dynid_runtime::simulation::{
    DidimSettings, Experiment, LoopSettings, Plant, SensorSettings, didim, simulate, simulated_motions,
};

type Failure = Box<dyn Error + Send + Sync>;

/// Control and recording rate, Hz.
const RATE: f64 = 1000.0;

/// The power model as in the paper: h is differentiated.
const POWER: Equations = Equations::Power { closed_form: false };

const METHODS: [(&str, Method); 8] = [
    ("IDIM-OLS", Method::IdimOls),
    ("IDIM-WLS", Method::IdimWls),
    ("IDIM-IRLS", Method::IdimIrls),
    ("IDIM-TLS", Method::IdimTls),
    ("PIM-OLS", Method::PimOls),
    ("PIM-WLS", Method::PimWls),
    ("PIM-IRLS", Method::PimIrls),
    ("PIM-TLS", Method::PimTls),
];

/// What one estimator made of one seed.
struct Outcome {
    name: &'static str,
    chi: Vec<f64>,
    sigma: Vec<f64>,
    torque_error: f64,
}

/// One motion, recorded with noise.
struct Recorded {
    settings: LoopSettings,
    trajectory: Trajectory,
    prepared: Motion,
}

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let seeds: u64 = arguments.next().map_or(Ok(30), |x| x.parse())?;
    let file = arguments.next();
    let model = models::find("tx40").ok_or("there is no model of the tx40")?;
    let robot = model.robot();
    let nominal = robot.nominal.as_ref().ok_or("the tx40 has no nominal parameters")?;
    let chi = robot.base_from_standard(&nominal.standard);
    let campaign = Campaign { rate: RATE, residue: 0.0, ..Campaign::default() };
    let motions = campaign.plan(model, &chi, &|_| {})?;
    let mut text = format!(
        "# Estimators side by side\n\n\
         Made by `cargo run --release --example estimators -- {seeds} docs/estimators.md`.\n\n\
         The TX-40 with its nominal parameters, simulated in closed loop at {RATE} Hz without unmodelled physics, on \
         the motion of all joints and the six sets with joints 1..k fixed; {seeds} seeds of noise on encoders and \
         torques. All estimators use the sets. Bias and spread are root mean squares over the base parameters, each \
         in units of the standard deviation that IDIM-WLS states for it at that noise. The torque error is that of \
         the torques of the motion of all joints, run without noise. DIDIM and IV start from parameters 20 % too small.\n"
    );
    for noise in [1.0, 100.0] {
        let bar = Bar::new("seeds");
        let mut all: Vec<Vec<Outcome>> = Vec::new();
        for seed in 1..=seeds {
            all.push(one_seed(model, &chi, &motions, noise, seed)?);
            bar.at(seed as usize, seeds as usize);
        }
        drop(bar);
        write_table(&mut text, noise, &all, &chi);
    }
    match file {
        Some(path) => write_page(Path::new(&path), &text)?,
        None => print!("{text}"),
    }
    Ok(())
}

fn record(
    model: &dyn Model,
    chi: &[f64],
    motion: &ExcitingMotion,
    noise: f64,
    seed: u64,
) -> Result<Recorded, Failure> {
    let mut settings = LoopSettings::nominal(model, chi, motion, RATE, seed);
    settings.sensors.position_noise.iter_mut().for_each(|sigma| *sigma *= noise);
    let run = simulate(&mut Plant::new(model, chi)?, motion, &settings, &mut |_| {})?;
    let prepared = prepare(&run.recorded, &Preparation::default())?;
    Ok(Recorded { settings, trajectory: run.recorded, prepared })
}

fn one_seed(
    model: &dyn Model,
    chi: &[f64],
    motions: &Motions,
    noise: f64,
    seed: u64,
) -> Result<Vec<Outcome>, Failure> {
    let single = record(model, chi, &motions.single, noise, 100 * seed)?;
    let sets = (1..)
        .zip(&motions.sets)
        .map(|(k, motion)| record(model, chi, motion, noise, 100 * seed + k))
        .collect::<Result<Vec<_>, Failure>>()?;
    let rows = ObserveSettings::default();
    let prepared: Vec<Motion> = sets.iter().map(|r| r.prepared.clone()).collect();
    // What the robot would do without noise: noise that the controller feeds back shakes a joint through rest, and
    // the friction of such rows is nobody's error.
    let settings = LoopSettings { sensors: SensorSettings::default(), ..single.settings };
    let quiet = simulate(&mut Plant::new(model, chi)?, &motions.single, &settings, &mut |_| {})?;
    let clean = observe(model, &[quiet.truth], Equations::Torque, None, &rows, None)?;
    let mut outcomes = Vec::new();
    let mut add = |name, chi: Vec<f64>, sigma: Vec<f64>| {
        let torque_error = relative_error(&clean, &chi).unwrap_or(f64::NAN);
        outcomes.push(Outcome { name, chi, sigma, torque_error });
    };
    add("the true parameters", chi.to_vec(), vec![0.0; chi.len()]);
    let torques = observe(model, &prepared, Equations::Torque, None, &rows, None)?;
    let power = observe(model, &prepared, POWER, None, &rows, None)?;
    for (name, method) in METHODS {
        let observation = if method.is_power() { &power } else { &torques };
        let settings = EstimateSettings { block_sigmas: false, ..EstimateSettings::for_method(method) };
        let found = estimate(observation, &settings);
        let sigma = found.parameters.iter().map(|p| p.sigma.unwrap_or(f64::NAN)).collect();
        add(name, found.chi(), sigma);
    }
    let experiments: Vec<Experiment<'_>> = sets
        .iter()
        .zip(&motions.sets)
        .map(|(r, motion)| Experiment { reference: motion, settings: &r.settings, recorded: &r.trajectory })
        .collect();
    let start: Vec<f64> = chi.iter().map(|x| 0.8 * x).collect();
    for (name, equations) in [("IDIM-DIDIM", Equations::Torque), ("PIM-DIDIM", POWER)] {
        let found = didim(model, &experiments, &start, &DidimSettings { equations, ..Default::default() })?;
        let sigma = found.estimate.parameters.iter().map(|p| p.sigma.unwrap_or(f64::NAN)).collect();
        add(name, found.estimate.chi(), sigma);
    }
    let simulated = simulated_motions(model, &experiments, &start)?;
    let instruments = Instruments::new(model, &simulated);
    let observation = observe(model, &prepared, Equations::Torque, Some(&instruments), &rows, None)?;
    let weighted = estimate(&torques, &EstimateSettings::for_method(Method::IdimWls));
    let sigma_of = |trajectory: usize, equation: usize| {
        let of = |e: &&EquationError| e.trajectory == trajectory && e.equation == equation;
        weighted.errors.iter().find(of).and_then(|e| e.sigma).unwrap_or(1.0)
    };
    let sigmas: Vec<f64> = observation.groups.iter().map(|g| sigma_of(g.trajectory, g.equation)).collect();
    if let Ok(found) = instrumental_variables(&observation, &sigmas) {
        add("IDIM-IV", found.chi, found.sigma);
    }
    Ok(outcomes)
}

fn write_table(text: &mut String, noise: f64, all: &[Vec<Outcome>], truth: &[f64]) {
    let of = |name: &str| all.iter().filter_map(|s| s.iter().find(|o| o.name == name)).collect::<Vec<_>>();
    let weighted = of("IDIM-WLS");
    let scale: Vec<f64> = (0..truth.len())
        .map(|k| spread(weighted.iter().map(|o| o.sigma[k])).map_or(1.0, |s| s.mean))
        .collect();
    // Writing to a String cannot fail.
    let _ = write!(
        text,
        "\n## Encoder noise {noise} times nominal, torque noise nominal\n\n\
         | estimator | seeds | bias / sigma | spread / sigma | within 3 of its own sigmas, % | torque error |\n\
         | --- | ---: | ---: | ---: | ---: | ---: |\n"
    );
    let names: Vec<&str> = all.first().map_or(Vec::new(), |first| first.iter().map(|o| o.name).collect());
    for name in names {
        let outcomes = of(name);
        let (mut bias, mut deviation, mut within, mut counted) = (0.0, 0.0, 0, 0);
        for k in 0..truth.len() {
            let Some(s) = spread(outcomes.iter().map(|o| o.chi[k] - truth[k])) else { continue };
            bias += (s.mean / scale[k]).powi(2);
            deviation += (s.deviation / scale[k]).powi(2);
            for outcome in outcomes.iter().filter(|o| o.sigma[k].is_finite()) {
                counted += 1;
                within += usize::from((outcome.chi[k] - truth[k]).abs() <= 3.0 * outcome.sigma[k]);
            }
        }
        let exact = name == "the true parameters";
        let root = |sum: f64| significant((sum / truth.len() as f64).sqrt(), 3);
        let error = spread(outcomes.iter().map(|o| o.torque_error));
        let words = |s: dynid_runtime::paper::Spread| {
            // The same number for every seed, but for its last digit.
            if s.deviation <= 1e-12 * s.mean {
                return significant(s.mean, 3);
            }
            format!("{} ±{}", significant(s.mean, 3), significant(s.deviation, 2))
        };
        let _ = writeln!(
            text,
            "| {name} | {} | {} | {} | {} | {} |",
            outcomes.len(),
            root(bias),
            root(deviation),
            if exact || counted == 0 {
                "-".to_owned()
            } else {
                significant(100.0 * within as f64 / counted as f64, 3)
            },
            error.map_or_else(String::new, words),
        );
    }
}
