//! `dynid excite ROBOT`: motions that make the parameters observable, or that tell laws apart.

mod tell;

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use dynid_runtime::model::{Model, Robot};
use dynid_runtime::report::significant;
use dynid_runtime::simulation::excitation::{
    Criterion, ExcitationPlan, ExcitationSettings, Identification, excite,
};
use dynid_runtime::simulation::{Reference, check_standard, to_csv};

use crate::failure::Failure;
use crate::motions::{MotionOptions, PLAN, PlannedMotion, plan_text, to_svg};
use crate::output::{Bar, Together, print, table};
use crate::ranges;
use crate::robots::resolve;
use crate::words::joint_number;

/// What to search, and where to put it.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// A robot's name, or the path of a robot YAML or a URDF
    robot: String,
    /// Folder for motions.yaml, which names a CSV and a figure for each motion
    #[arg(long)]
    out: PathBuf,
    /// A motion that tells these laws apart, in the place of one for the parameters: two or more ids of `cannot tell`
    #[arg(long, value_delimiter = ',', requires = "joint", conflicts_with = "pim", value_name = "ID,ID")]
    tell: Vec<String>,
    /// Number of the joint that has one of these laws
    #[arg(long, requires = "tell")]
    joint: Option<usize>,
    /// For the power model: one motion for each joint, with the joints before it fixed, so that the observation
    /// matrix becomes block-triangular
    #[arg(long)]
    pim: bool,
    #[command(flatten)]
    motions: MotionOptions,
    /// What makes motions better
    #[arg(long, value_enum, default_value = "determinant")]
    criterion: By,
    /// Random starts for each motion
    #[arg(
        long,
        default_value_t = 4,
        allow_negative_numbers = true,
        value_parser = ranges::starts,
        value_name = ranges::STARTS,
    )]
    starts: usize,
    /// Candidate motions tried from each start
    #[arg(
        long,
        default_value_t = 1500,
        allow_negative_numbers = true,
        value_parser = ranges::evaluations,
        value_name = ranges::EVALUATIONS,
    )]
    evaluations: usize,
    /// The same seed gives the same motions
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Rows a second in the CSV files, Hz
    #[arg(
        long,
        default_value_t = 1000.0,
        allow_negative_numbers = true,
        value_parser = ranges::file_rate,
        value_name = ranges::FILE_RATE,
    )]
    rate: f64,
}

/// Most rows of a motion's CSV; it is in memory while it is written.
const MOST_ROWS: f64 = 1e6;

/// What is searched for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum By {
    /// A small condition number of the weighted observation matrix
    Condition,
    /// A large determinant of the information matrix
    Determinant,
}

impl From<By> for Criterion {
    fn from(by: By) -> Self {
        match by {
            By::Condition => Criterion::Condition,
            By::Determinant => Criterion::Determinant,
        }
    }
}

/// Searches, prints, writes.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let dynamics = resolve(&arguments.robot, None)?;
    let model = dynamics.model();
    let robot = model.robot();
    let chi = nominal(robot)?;
    if let Some(joint) = arguments.joint {
        return tell::run(arguments, model, chi.as_deref(), joint);
    }
    let settings = ExcitationSettings {
        kind: arguments.motions.kind(),
        criterion: arguments.criterion.into(),
        identification: if arguments.pim { Identification::Pim } else { Identification::Idim },
        sets: if arguments.pim { robot.joints() } else { 1 },
        starts: arguments.starts,
        evaluations: arguments.evaluations,
        share: arguments.motions.share,
        reach: arguments.motions.reach,
        seed: arguments.seed,
    };
    let mut files = Together::in_folder(&arguments.out)?;
    let plan = search(model, chi.as_deref(), &settings)?;
    let mut named = Vec::new();
    if let Some(longest) = plan.motions.iter().map(|m| m.duration()).find(|d| d * arguments.rate > MOST_ROWS)
    {
        return Err(Failure::Input(format!(
            "--rate {}: a motion of {} s would have more than {MOST_ROWS:e} rows",
            arguments.rate,
            significant(longest, 3)
        )));
    }
    for (k, motion) in plan.motions.iter().enumerate() {
        let title = format!("{}: motion {} of {}", robot.name, k + 1, plan.motions.len());
        let stem = format!("motion{}", k + 1);
        let rows = to_csv(motion, arguments.rate);
        let figure = to_svg(motion, robot, &title);
        named.push(PlannedMotion {
            file: files.add(&stem, "csv", &mut |out| out.write_all(rows.as_bytes()))?,
            figure: files.add(&stem, "svg", &mut |out| out.write_all(figure.as_bytes()))?,
        });
    }
    files.commit(PLAN, &plan_text(&robot.name, &named), &["motion"])?;
    print(&summary(robot, &plan, arguments));
    Ok(())
}

/// Base parameters of the nominal robot, where it has them; checked.
fn nominal(robot: &Robot) -> Result<Option<Vec<f64>>, Failure> {
    let Some(nominal) = &robot.nominal else { return Ok(None) };
    check_standard(robot, &nominal.standard)
        .map_err(|error| Failure::Input(format!("{}: nominal parameters: {error}", robot.name)))?;
    Ok(Some(robot.base_from_standard(&nominal.standard)))
}

fn search(
    model: &dyn Model,
    chi: Option<&[f64]>,
    settings: &ExcitationSettings,
) -> Result<ExcitationPlan, Failure> {
    let bar = Bar::new("motions");
    excite(model, chi, settings, &|share| bar.at((1000.0 * share) as usize, 1000))
        .map_err(|error| Failure::Input(error.to_string()))
}

fn summary(robot: &Robot, plan: &ExcitationPlan, arguments: &Arguments) -> String {
    let mut text = format!(
        "{}: {} motion{} in {}\n",
        robot.name,
        plan.motions.len(),
        if plan.motions.len() == 1 { "" } else { "s" },
        arguments.out.display()
    );
    let rows = plan
        .motions
        .iter()
        .enumerate()
        .map(|(k, motion)| {
            let fixed: Vec<String> = motion.fixed().iter().map(|&j| joint_number(robot, j)).collect();
            let mut row = vec![
                (k + 1).to_string(),
                significant(motion.duration(), 3),
                if fixed.is_empty() { "none".to_owned() } else { fixed.join(" ") },
            ];
            row.extend(plan.blocks[k].iter().map(|&reached| if reached { "x" } else { "0" }.to_owned()));
            row
        })
        .collect();
    let names: Vec<String> = (1..=robot.joints()).map(|j| format!("chi{j}")).collect();
    let mut header = vec!["motion", "s", "<fixed joints"];
    header.extend(names.iter().map(String::as_str));
    text.push_str(&table(&header, rows));
    text.push_str(if arguments.pim {
        "\n\nblocks of the power model's W: x is reached, 0 is zero throughout"
    } else {
        "\n\nblocks of W by joint: x is reached, 0 is zero throughout"
    });
    text.push_str(&format!(
        "\ncondition number of the weighted, scaled W: {} before the search, {} after",
        significant(plan.condition_before, 3),
        significant(plan.condition_after, 3)
    ));
    text.push_str(&format!(
        "\nlog det of the information: {} before, {} after",
        significant(plan.log_determinant_before, 4),
        significant(plan.log_determinant_after, 4)
    ));
    if let Some(share) = plan.torque_share {
        text.push_str(&format!("\nlargest share of a torque limit: {} %", significant(100.0 * share, 3)));
    }
    text
}
