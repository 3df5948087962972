//! `dynid identify REC`: parameters from a recording.

mod gains;
mod load;
pub mod method;
mod payload;
mod physical;
mod rows;
pub mod simulated;

use std::path::{Path, PathBuf};

use clap::Args;
use dynid_runtime::estimation::observe::{Equations, Observation};
use dynid_runtime::estimation::{Estimate, EstimateSettings, Method, estimate};
use dynid_runtime::model::Robot;
use dynid_runtime::model_file::{EvaluatedRows, Identified};
use dynid_runtime::prediction::observed_errors;
use dynid_runtime::report::{percent, significant};

use crate::arguments::{Sampling, Source};
use crate::compared::residual_file;
use crate::estimated::{cells, value};
use crate::failure::Failure;
use crate::origin::recorded_from;
use crate::output::{can_write, print, table, write_json};
use crate::ranges;
use crate::recorded::{self, Recorded, left_out_words};
use crate::speeds::{and_of_speeds, speed_words};
use crate::urdf_files::is_urdf;
use crate::verdict;
use crate::words::joint_number;
use method::Identification;

/// What to identify and where to put it.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    recording: Source,
    #[command(flatten)]
    sampling: Sampling,
    /// idim-ols, idim-wls, pim-ols, pim-wls; robust idim-irls, pim-irls; total least squares idim-tls, pim-tls;
    /// simulating the planned motions: instrumental variables idim-iv, and idim-didim
    #[arg(long, default_value = "idim-wls")]
    method: Identification,
    /// The planned motions, which idim-iv and idim-didim simulate with the robot's nominal controller: a CSV or a folder
    /// as `excite` writes it, one motion for each of the recording
    #[arg(long)]
    planned: Option<PathBuf>,
    /// The power model from dh in closed form instead of differentiating h as in the paper
    #[arg(long)]
    closed_form: bool,
    /// Ratio of the largest to the smallest relative standard deviation among the essential parameters; 10 to 30
    /// is usual
    #[arg(
        long,
        default_value_t = 20.0,
        allow_negative_numbers = true,
        value_parser = ranges::r_sigma,
        value_name = ranges::R_SIGMA,
    )]
    r_sigma: f64,
    /// Identify even where no such robot can have made the recording
    #[arg(long)]
    implausible: bool,
    /// Standard parameters that bodies can have, nearest to a prior; the model is saved with them
    #[arg(long)]
    physical: bool,
    /// The prior: a URDF, a robot YAML with nominal parameters, or a model [default: the recording's robot]
    #[arg(long, requires = "physical")]
    prior: Option<PathBuf>,
    #[command(flatten)]
    load: load::LoadArguments,
    /// Also print what is regrouped into each parameter
    #[arg(long)]
    base: bool,
    /// Save the model for `validate`, `simulate` and `diagnose --reference`
    #[arg(long)]
    out: Option<PathBuf>,
    /// Write a page with the parameters, and the torques measured and predicted
    #[arg(long)]
    report: Option<PathBuf>,
    /// Write states, torques and residuals row by row: a table (.csv, .parquet) or messages (.mcap)
    #[arg(long, value_name = "FILE", value_parser = residual_file)]
    residuals: Option<PathBuf>,
    /// Write the result for other programs; `-` is standard output
    #[arg(long)]
    json: Option<PathBuf>,
}

/// Identifies, prints, saves.
pub(super) fn run(arguments: &Arguments, line: &[String]) -> Result<(), Failure> {
    if let Some(loaded) = &arguments.load.loaded {
        return gains::run(arguments, loaded);
    }
    can_write([&arguments.json, &arguments.out, &arguments.residuals, &arguments.report])?;
    if let Some(reference) = &arguments.load.reference {
        return payload::run(arguments, reference);
    }
    simulated::check(arguments.method, arguments.planned.as_deref())?;
    let power = Equations::Power { closed_form: arguments.closed_form };
    let equations: &[Equations] =
        if arguments.method.method().is_power() { &[power, Equations::Torque] } else { &[Equations::Torque] };
    let recorded::Observed { recorded, observations, whole } =
        recorded::read_observed(&arguments.recording, &arguments.sampling, equations)?;
    let (mut identified, estimate) = identify(&recorded, whole, &observations, arguments)?;
    let mut words = summary(&recorded, &identified, &estimate, arguments);
    if let Some(torques) = observations.last().filter(|_| arguments.physical) {
        let robot = recorded.dynamics.model().robot();
        // A URDF that is the robot has more than its table: links by name, and their geometry.
        let own = Some(Path::new(&recorded.robot)).filter(|path| is_urdf(path));
        let prior = arguments.prior.as_deref().or(own);
        let bodies = physical::make_physical(&mut identified, robot, torques, prior)?;
        words.push_str(&format!("\n\n{bodies}"));
    }
    if arguments.json.as_deref() != Some(Path::new("-")) {
        print(&words);
    }
    if let Some(path) = &arguments.json {
        // A triangle of numbers that only a saved model is asked for.
        write_json(path, &Identified { covariance: None, ..identified.clone() })?;
    }
    if let Some(path) = &arguments.out {
        let recording = Some(recorded_from(&arguments.recording, path)?);
        write_json(path, &Identified { recording, ..identified.clone() })?;
    }
    if arguments.report.is_some() || arguments.residuals.is_some() {
        rows::write(arguments, line, &recorded, whole, &identified)?;
    }
    Ok(())
}

/// Equations for each parameter below which the errors that are left are no measure of what the parameters are worth:
/// half as many degrees of freedom as parameters.
const LEAST_ROWS_PER_PARAMETER: f64 = 1.5;

/// Identifies from the observation of the method's equations; the last one is of the torques.
fn identify(
    recorded: &Recorded,
    whole: bool,
    observations: &[Observation],
    arguments: &Arguments,
) -> Result<(Identified, Estimate), Failure> {
    let model = recorded.dynamics.model();
    let settings = &recorded.settings;
    let [observation, ..] = observations else {
        return Err(Failure::Data("nothing was observed".to_owned()));
    };
    let torques = observations.last().unwrap_or(observation);
    let mut estimate = estimate(
        observation,
        &EstimateSettings {
            r_sigma: Some(arguments.r_sigma),
            ..EstimateSettings::for_method(arguments.method.method())
        },
    );
    if estimate.degrees_of_freedom == 0 || estimate.rows_per_parameter() < LEAST_ROWS_PER_PARAMETER {
        return Err(Failure::Data(format!(
            "{}: {} equations cannot determine {} parameters: record longer, or raise --band",
            arguments.recording.recording.display(),
            estimate.rows,
            model.robot().base.len(),
        )));
    }
    let mut warnings = speed_words(&recorded.speeds, model.robot());
    if !arguments.implausible {
        let doubts = doubts(recorded, torques, &estimate, arguments);
        warnings.extend(doubts.map_err(|failure| and_of_speeds(failure, &warnings))?);
    }
    let mut simulated = None;
    if let Some(plan) = &arguments.planned {
        let recording = arguments.recording.recording.as_path();
        simulated::at_once(whole, recording)?;
        let plan = simulated::Plan::read(plan, model.robot().joints())?;
        let method = arguments.method;
        let task =
            simulated::Task { method, recorded, recording, plan: &plan, r_sigma: Some(arguments.r_sigma) };
        let found = task.identify(torques, &estimate)?;
        estimate = found.estimate;
        simulated = Some(found.simulated);
        warnings.extend(found.warnings);
    }
    let chi = estimate.chi();
    let errors = observed_errors(torques, &chi);
    let mut rows = EvaluatedRows::observed(observation, settings.band, &estimate, errors);
    rows.rows_left_out = Some(recorded.rows.rows.left_out);
    let mut identified = Identified::new(model.robot(), &recorded.robot, rows, &estimate);
    identified.method = arguments.method.name().to_owned();
    identified.simulated = simulated;
    identified.warnings.extend(warnings);
    Ok((identified, estimate))
}

/// What is doubtful in the data, by the weighted estimate of the torques.
fn doubts(
    recorded: &Recorded,
    torques: &Observation,
    found: &Estimate,
    arguments: &Arguments,
) -> Result<Vec<String>, Failure> {
    let path = &arguments.recording.recording;
    if found.method == Method::IdimWls {
        return verdict::check(path, &recorded.judged(), torques, found);
    }
    verdict::check(path, &recorded.judged(), torques, &estimate(torques, &EstimateSettings::default()))
}

fn summary(
    recorded: &Recorded,
    identified: &Identified,
    estimate: &Estimate,
    arguments: &Arguments,
) -> String {
    let robot = recorded.dynamics.model().robot();
    let mut text = format!("{}\n", recorded.heading());
    for line in left_out_words(&recorded.rows) {
        text.push_str(&format!("{line}\n"));
    }
    text.push_str(&format!(
        "{} on {} samples, {} equations of {} Hz bandwidth, condition number {}\n\n",
        identified.method,
        identified.samples,
        estimate.rows,
        significant(identified.band, 3),
        identified.condition_number.map_or_else(|| "unknown".to_owned(), |c| significant(c, 3)),
    ));
    text.push_str(&parameters(robot, identified, arguments.base));
    if let Some(essential) = &identified.essential_parameters {
        text.push_str(&format!(
            "\n\n{} of {} parameters are essential (r_sigma {}), error with them {}; cancelled: {}",
            essential.parameters.len(),
            identified.base_parameters.len(),
            significant(arguments.r_sigma, 3),
            percent(essential.relative_error),
            if essential.cancelled.is_empty() { "none".to_owned() } else { essential.cancelled.join(" ") },
        ));
    }
    if let Some(simulated) = &identified.simulated {
        text.push_str(&format!("\n\n{}", simulated::words(simulated)));
    }
    text.push_str("\n\n");
    text.push_str(&equations(identified));
    if let Some(power) = identified.power_relative_error {
        text.push_str(&format!("\n\nrelative error of the power {}", percent(power)));
    }
    text.push_str(&format!(
        "\n\nrelative error of the torques {} in the {} Hz band; per joint:",
        percent(identified.relative_error),
        significant(identified.band, 3)
    ));
    for (joint, error) in identified.per_joint.iter().enumerate() {
        text.push_str(&format!(" {}: {}", joint_number(robot, joint), percent(*error)));
    }
    for p in &identified.base_parameters {
        if let Some(doubt) = &p.doubt {
            text.push_str(&format!("\n! {} is {doubt}", p.name));
        }
    }
    for warning in &identified.warnings {
        text.push_str(&format!("\nwarning: {warning}"));
    }
    text
}

fn parameters(robot: &Robot, identified: &Identified, relations: bool) -> String {
    let essential = identified.essential_parameters.as_ref();
    let simulated = identified.simulated.as_ref();
    let rows = identified
        .base_parameters
        .iter()
        .enumerate()
        .map(|(k, p)| {
            let kept = essential.and_then(|e| e.parameters.iter().find(|kept| kept.name == p.name));
            let mut row = cells(p);
            if let Some(simulated) = simulated {
                row.push(simulated.values.get(k).map_or_else(String::new, |&v| significant(v, 4)));
            }
            row.push(kept.map_or_else(String::new, value));
            if relations {
                let relation = robot.base.iter().find(|b| b.name == p.name).map_or("", |b| &b.relation);
                row.push(format!("= {relation}"));
            }
            row
        })
        .collect();
    let mut header = vec!["<parameter", "value", "sigma", "sigma %", "sigma, white", "<unit"];
    header.extend(simulated.map(|s| s.compared_with.as_str()));
    header.push("essential");
    if relations {
        header.push("<");
    }
    table(&header, rows)
}

/// Which equations were used and which were not.
fn equations(identified: &Identified) -> String {
    let rows = identified
        .equations
        .iter()
        .map(|e| {
            vec![
                e.trajectory.clone(),
                if e.joint == 0 { "power".to_owned() } else { e.joint.to_string() },
                e.used.to_string(),
                e.standstill.to_string(),
                e.fixed.to_string(),
                e.windows.to_string(),
                e.edges.to_string(),
                e.relative_error.map_or_else(|| "-".to_owned(), percent),
            ]
        })
        .collect();
    table(
        &["<trajectory", "joint", "used", "standstill", "fixed", "outside window", "at ends", "error"],
        rows,
    )
}
