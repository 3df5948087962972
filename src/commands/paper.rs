//! `dynid paper`: the five cases of Gautier and Briot, simulated or on a real recording, beside what they printed.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use clap::Args;
use dynid_runtime::estimation::observe::{Equations, ObserveSettings, observe};
use dynid_runtime::model::Model;
use dynid_runtime::paper::{Campaign, CampaignError, Case, CaseResult, PaperSettings, SeedResult, run_cases};
use dynid_runtime::report::{Panel, Sheet};
use dynid_runtime::signal::{Motion, Preparation, prepare};

use crate::arguments::{Sampling, Source};
use crate::failure::Failure;
use crate::output::{Bar, make_folder, print, table, write, write_page};
use crate::paper_tables::{Results, Rows};
use crate::ranges;
use crate::recorded::read;
use crate::robots::resolve;
use crate::words::joint_number;

/// Simulated or recorded, and where to write.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The robot that is simulated; it must have nominal parameters and limits
    #[arg(long, default_value = "tx40")]
    robot: String,
    /// Cases 1, 3 and 5 on this real recording instead
    #[arg(long)]
    recording: Option<PathBuf>,
    /// Simulated repetitions, each with motions and noise of its own
    #[arg(
        long,
        default_value_t = 5,
        allow_negative_numbers = true,
        value_parser = ranges::seeds,
        value_name = ranges::SEEDS,
    )]
    seeds: u64,
    /// Size of the physics that the model does not know; 1 is that of the real TX-40, 0 none
    #[arg(
        long,
        default_value_t = 1.0,
        allow_negative_numbers = true,
        value_parser = ranges::size,
        value_name = ranges::SIZE,
    )]
    residue: f64,
    /// Factor on the nominal noise
    #[arg(
        long,
        default_value_t = 1.0,
        allow_negative_numbers = true,
        value_parser = ranges::noise,
        value_name = ranges::NOISE,
    )]
    noise: f64,
    /// Points of the single motion
    #[arg(
        long,
        default_value_t = 13,
        allow_negative_numbers = true,
        value_parser = ranges::points,
        value_name = ranges::POINTS,
    )]
    single_points: usize,
    /// Points of each motion of the sets
    #[arg(
        long,
        default_value_t = 13,
        allow_negative_numbers = true,
        value_parser = ranges::points,
        value_name = ranges::POINTS,
    )]
    set_points: usize,
    /// Share of the position range that the motions use; with 13 points and 0.6 they last as long as the public
    /// recording of a TX-40
    #[arg(
        long,
        default_value_t = 0.6,
        allow_negative_numbers = true,
        value_parser = ranges::share,
        value_name = ranges::SHARE,
    )]
    reach: f64,
    /// dh in closed form instead of differentiating h as in the paper
    #[arg(long)]
    closed_form: bool,
    /// Also write the tables and the torques measured and reconstructed to this folder (paper.md and paper.svg, or
    /// paper_recording.md and paper_recording.svg); what an older page has under `## Discussion` stays
    #[arg(long)]
    out: Option<PathBuf>,
}

/// Runs the cases and prints the tables.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let settings = PaperSettings { closed_form: arguments.closed_form, ..PaperSettings::default() };
    if let Some(folder) = &arguments.out {
        make_folder(folder)?;
    }
    match &arguments.recording {
        Some(path) => recorded(path.clone(), &settings, arguments),
        None => simulated(&settings, arguments),
    }
}

fn simulated(settings: &PaperSettings, arguments: &Arguments) -> Result<(), Failure> {
    let dynamics = resolve(&arguments.robot, None)?;
    let model = dynamics.model();
    let robot = model.robot();
    let Some(nominal) = &robot.nominal else {
        return Err(Failure::Input(format!("{} has no nominal parameters to simulate", robot.name)));
    };
    let campaign = Campaign {
        residue: arguments.residue,
        noise: arguments.noise,
        single: Campaign::points(arguments.single_points),
        sets: Campaign::points(arguments.set_points),
        reach: arguments.reach,
        ..Campaign::default()
    };
    let seeds = run_seeds(model, &nominal.standard, &campaign, settings, arguments.seeds)?;
    let results = Results {
        robot,
        truth: Some(robot.base_from_standard(&nominal.standard)),
        seeds: seeds.iter().map(|s| s.cases.as_slice()).collect(),
        published: robot.name == "tx40",
    };
    let said = format!(
        "{}: simulated in closed loop, {} seeds, residue {}, noise {}",
        robot.name, arguments.seeds, arguments.residue, arguments.noise
    );
    print(&text(&said, &results));
    let (Some(folder), Some(first)) = (&arguments.out, seeds.first()) else { return Ok(()) };
    let motion = prepare(&first.single, &Preparation::default()).map_err(|e| Failure::Data(e.to_string()))?;
    let figure = figure(model, &[motion], &first.cases, &settings.observe, &robot.name)?;
    let command = format!("dynid paper --seeds {} --out {}", arguments.seeds, folder.display());
    save(folder, "paper", &markdown(&said, &command, "paper", &results), &figure)
}

/// Every seed, on two threads; the outcome does not depend on their number.
fn run_seeds(
    model: &dyn Model,
    standard: &[f64],
    campaign: &Campaign,
    settings: &PaperSettings,
    seeds: u64,
) -> Result<Vec<SeedResult>, Failure> {
    let settings = PaperSettings {
        observe: ObserveSettings { threads: 1, ..settings.observe.clone() },
        ..settings.clone()
    };
    let bar = Bar::new("seeds");
    let done = AtomicUsize::new(0);
    let workers = std::thread::available_parallelism().map_or(1, usize::from).min(seeds as usize);
    let one = |seed: u64| {
        let outcome = campaign.run(model, standard, &Preparation::default(), &settings, seed, &|_| {});
        bar.at(done.fetch_add(1, Ordering::Relaxed) + 1, seeds as usize);
        outcome.map_err(|error| match error {
            CampaignError::Simulation(error) => Failure::Input(error.to_string()),
            error => Failure::Data(format!("seed {seed}: {error}")),
        })
    };
    let mut all: Vec<(u64, Result<SeedResult, Failure>)> = std::thread::scope(|scope| {
        let handles: Vec<_> = (0..workers as u64)
            .map(|worker| {
                let one = &one;
                let own = (1 + worker..=seeds).step_by(workers);
                scope.spawn(move || own.map(|seed| (seed, one(seed))).collect::<Vec<_>>())
            })
            .collect();
        handles.into_iter().filter_map(|handle| handle.join().ok()).flatten().collect()
    });
    all.sort_by_key(|(seed, _)| *seed);
    all.into_iter().map(|(_, outcome)| outcome).collect()
}

fn recorded(path: PathBuf, settings: &PaperSettings, arguments: &Arguments) -> Result<(), Failure> {
    let sampling = Sampling { band: Some(settings.observe.band), ..Sampling::default() };
    let options = Source::whole(path);
    let recorded = read(&options, &sampling)?;
    let model = recorded.dynamics.model();
    let failed = |error| crate::recorded::observe_failure(&options.recording, &error);
    let settings = PaperSettings { observe: recorded.settings.clone(), ..settings.clone() };
    let cases = run_cases(model, &recorded.motions, None, &settings).map_err(failed)?;
    let robot = model.robot();
    let results = Results { robot, truth: None, seeds: vec![&cases], published: robot.name == "tx40" };
    let said = format!("{}: {}", robot.name, recorded.title);
    print(&text(&said, &results));
    let Some(folder) = &arguments.out else { return Ok(()) };
    let figure = figure(model, &recorded.motions, &cases, &settings.observe, &said)?;
    let command =
        format!("dynid paper --recording {} --out {}", options.recording.display(), folder.display());
    let file = "paper_recording";
    save(folder, file, &markdown(&said, &command, file, &results), &figure)
}

const TABLES: [(&str, &str); 4] = [
    ("Table II", "essential parameters (r_sigma 20), SI; ± is the standard deviation over seeds"),
    ("Table III", "quality of the identification"),
    ("Table IV", "quality of the torque reconstruction on the motion of all joints"),
    ("Standard deviations of Table II", "percent, by the weights of the equations"),
];

fn tables(results: &Results<'_>) -> [Rows; 4] {
    [results.parameters(), results.identification(), results.reconstruction(), results.deviations()]
}

fn text(said: &str, results: &Results<'_>) -> String {
    let mut text = format!("{said}\n");
    for case in Case::ALL {
        let _ = write!(text, "\ncase {}: {}", case.number(), case.description());
    }
    for ((number, what), rows) in TABLES.iter().zip(tables(results)) {
        let header: Vec<&str> = rows.header.iter().map(String::as_str).collect();
        let _ = write!(text, "\n\n{number}: {what}\n{}", table(&header, rows.rows));
    }
    text.push_str("\n\nWhat the paper found, and in how many of our runs it holds:");
    for finding in results.findings() {
        let _ = write!(text, "\n  {finding}");
    }
    text
}

fn markdown(said: &str, command: &str, file: &str, results: &Results<'_>) -> String {
    let mut text = format!(
        "# The power-model paper, side by side\n\n\
         Gautier and Briot, Dynamic parameter identification of a 6 DOF industrial robot using power model. Made by \
         `{command}`; {said}.\n\n"
    );
    for case in Case::ALL {
        let _ = writeln!(text, "- Case {}: {}", case.number(), case.description());
    }
    text.push_str("\nWhat the paper found, and in how many of our runs it holds:\n\n");
    for finding in results.findings() {
        let _ = writeln!(text, "- {finding}");
    }
    for ((number, what), rows) in TABLES.iter().zip(tables(results)) {
        let _ = writeln!(text, "\n## {number}: {what}\n");
        let cells = |row: &[String]| format!("| {} |", row.join(" | "));
        let names: Vec<String> = rows.header.iter().map(|h| h.trim_start_matches('<').to_owned()).collect();
        let lines: Vec<String> =
            rows.header.iter().map(|h| if h.starts_with('<') { "---" } else { "---:" }.to_owned()).collect();
        let _ = writeln!(text, "{}\n{}", cells(&names), cells(&lines));
        for row in &rows.rows {
            let _ = writeln!(text, "{}", cells(row));
        }
    }
    let _ = write!(
        text,
        "\n## Torques measured and reconstructed (Figs. 2 to 4)\n\n![measured and reconstructed torques]({file}.svg)"
    );
    text
}

fn save(folder: &Path, file: &str, page: &str, figure: &str) -> Result<(), Failure> {
    make_folder(folder)?;
    write(&folder.join(format!("{file}.svg")), figure)?;
    write_page(&folder.join(format!("{file}.md")), page)
}

/// The torques of the first motion, measured and reconstructed by the cases, joint by joint (Figs. 2 to 4).
fn figure(
    model: &dyn Model,
    motions: &[Motion],
    cases: &[CaseResult],
    settings: &ObserveSettings,
    title: &str,
) -> Result<String, Failure> {
    let settings = ObserveSettings { keep_rows: true, ..settings.clone() };
    let observation = observe(model, &motions[..1], Equations::Torque, None, &settings, None)
        .map_err(|error| Failure::Data(error.to_string()))?;
    let shown: Vec<&CaseResult> =
        cases.iter().filter(|r| !matches!(r.case, Case::Five | Case::Two)).collect();
    let panels = observation
        .rows
        .iter()
        .flatten()
        .map(|rows| {
            let curve = |values: &[f64]| rows.time.iter().copied().zip(values.iter().copied()).collect();
            let mut lines = vec![("measured".to_owned(), curve(&rows.y))];
            for result in &shown {
                lines.push((format!("case {}", result.case.number()), curve(&rows.predict(&result.chi))));
            }
            Panel {
                title: format!("torque of joint {}, N.m", joint_number(model.robot(), rows.equation)),
                lines,
            }
        })
        .collect();
    let sheet = Sheet {
        title: format!("{title}: torques measured and reconstructed"),
        x: "time, s".to_owned(),
        columns: 2,
        panel: [560.0, 230.0],
        panels,
    };
    Ok(sheet.to_svg())
}
