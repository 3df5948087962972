//! Integration schemes side by side on a TX-40 in closed loop, and what the simulation is held to:
//! `docs/simulation.md`.
//!
//! `cargo run --release --example integration -- [FILE]`
#![allow(missing_docs)]

use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

use dynid::models;
use dynid::output::write_page;
use dynid_runtime::estimation::observe::Equations;
use dynid_runtime::estimation::{
    EstimateSettings, ParameterEstimate, RecordedSettings, estimate, observe_trajectories,
};
use dynid_runtime::model::{Model, ParameterKind};
use dynid_runtime::paper::Campaign;
use dynid_runtime::report::significant;
use dynid_runtime::simulation::excitation::{
    ExcitationSettings, ExcitingMotion, MotionKind, Profile, excite,
};
use dynid_runtime::simulation::{
    ElasticJoint, LoopSettings, Plant, Reference, Residue, Scheme, SensorSettings, Simulation, simulate,
};

type Failure = Box<dyn Error + Send + Sync>;

/// Rate of the controller in the comparison, Hz: every step size fits into its period.
const RATE: f64 = 1000.0;

/// Steps, s.
const STEPS: [f64; 6] = [1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5];

/// Steps of the reference in a control period; of the fourth-order scheme.
const REFERENCE_STEP: f64 = 5e-6;

fn main() -> Result<(), Failure> {
    let file = std::env::args().nth(1);
    let model = models::find("tx40").ok_or("there is no model of the tx40")?;
    let nominal = model.robot().nominal.as_ref().ok_or("the tx40 has no nominal parameters")?;
    let bench = Bench { model, standard: &nominal.standard };
    let mut text = String::from(
        "# The simulation: which integration scheme, how exact, how fast\n\n\
         Made by `cargo run --release --example integration -- docs/simulation.md`. Times are CPU times of one thread, \
         the least of several runs.\n",
    );
    bench.schemes(&mut text)?;
    bench.exactness(&mut text)?;
    bench.speed(&mut text)?;
    recovery(&mut text)?;
    match file {
        Some(path) => write_page(Path::new(&path), &text)?,
        None => print!("{text}"),
    }
    Ok(())
}

/// The robot that is simulated.
struct Bench<'a> {
    model: &'static dyn Model,
    standard: &'a [f64],
}

impl Bench<'_> {
    fn chi(&self) -> Vec<f64> {
        self.model.robot().base_from_standard(self.standard)
    }

    /// A motion through points with a stop at each, so that joints reverse and rest.
    fn motion(&self, points: usize) -> Result<ExcitingMotion, Failure> {
        let profile = Profile::TrapezoidalAcceleration;
        let kind = MotionKind::PointToPoint { points, profile, pause: 0.15 };
        let settings = ExcitationSettings { kind, reach: 0.5, ..ExcitationSettings::default() };
        let plan = excite(self.model, Some(&self.chi()), &settings, &|_| {})?;
        plan.motions.into_iter().next().ok_or_else(|| "there is no motion".into())
    }

    /// The closed loop without noise, in steps of at most `step`; with its CPU time, s.
    fn run(
        &self,
        motion: &ExcitingMotion,
        elastic: &[ElasticJoint],
        scheme: Scheme,
        step: f64,
    ) -> Result<(Simulation, f64), Failure> {
        let mut plant = Plant::with_effects(self.model, self.standard, elastic, Vec::new())?;
        plant.set_scheme(scheme);
        let mut settings = LoopSettings::nominal(self.model, &self.chi(), motion, RATE, 1);
        settings.sensors = SensorSettings::default();
        // A step of exactly 1 / k of the period must not be rounded to k + 1 of them.
        settings.longest_step = step * (1.0 + 1e-9);
        let clock = Clock::start();
        let run = simulate(&mut plant, motion, &settings, &mut |_| {})?;
        Ok((run, clock.seconds()))
    }

    fn schemes(&self, text: &mut String) -> Result<(), Failure> {
        let motion = self.motion(6)?;
        let stiff = ElasticJoint { joint: 2, stiffness: 2e6, damping: 20.0, play: 0.0 };
        let _ = write!(
            text,
            "\n## Schemes\n\nThe TX-40 with its nominal parameters in closed loop, controlled at {RATE} Hz, through 6 \
             points with a stop of 0.15 s at each: {} s in which every joint reverses and rests. Friction holds at rest \
             and reversals are located in every scheme alike. The error is the largest over joints and control samples \
             against the fourth-order scheme in steps of {REFERENCE_STEP:e} s.\n",
            significant(motion.duration(), 3)
        );
        for (title, elastic) in [
            ("rigid joints", &[][..]),
            ("joint 3 on a spring of 2e6 N.m/rad, an oscillation of 0.8 kHz", &[stiff][..]),
        ] {
            let (exact, _) = self.run(&motion, elastic, Scheme::RungeKutta4, REFERENCE_STEP)?;
            let _ = write!(
                text,
                "\nWith {title}:\n\n| scheme | step, ms | position error, rad | velocity error, rad/s | CPU ms for a \
                 second |\n| --- | ---: | ---: | ---: | ---: |\n"
            );
            for scheme in Scheme::ALL {
                for step in STEPS {
                    let mut fastest = f64::INFINITY;
                    let mut outcome = None;
                    for _ in 0..3 {
                        match self.run(&motion, elastic, scheme, step) {
                            Ok((run, seconds)) => {
                                fastest = fastest.min(seconds);
                                outcome = Some(run);
                            }
                            Err(_) => break,
                        }
                    }
                    let cells = match outcome {
                        None => "leaves all bounds | | ".to_owned(),
                        Some(run) => format!(
                            "{} | {} | {}",
                            significant(largest_difference(&run.truth.q, &exact.truth.q), 2),
                            significant(largest_difference(&run.truth.dq, &exact.truth.dq), 2),
                            significant(1e3 * fastest / motion.duration(), 3)
                        ),
                    };
                    let _ = writeln!(text, "| {} | {} | {cells} |", scheme.name(), 1e3 * step);
                }
            }
        }
        Ok(())
    }

    fn exactness(&self, text: &mut String) -> Result<(), Failure> {
        let n = self.model.robot().joints();
        let robot = self.model.robot();
        let free: Vec<f64> = robot
            .standard
            .iter()
            .zip(self.standard)
            .map(|(p, &x)| if p.kind > ParameterKind::Ia { 0.0 } else { x })
            .collect();
        let chi = robot.base_from_standard(&free);
        let mut plant = Plant::new(self.model, &chi)?;
        let mut h = vec![0.0; chi.len()];
        let mut energy = |q: &[f64], dq: &[f64]| {
            self.model.energy(q, dq, &mut h);
            h.iter().zip(&chi).map(|(a, b)| a * b).sum::<f64>()
        };
        let mut state = plant.state(&vec![0.3; n], &vec![0.8; n]);
        let before = energy(&state.q, &state.dq);
        let (mut kinetic, mut drift) = (0.0_f64, 0.0_f64);
        for _ in 0..50_000 {
            plant.advance(&mut state, &vec![0.0; n], 2e-4)?;
            let now = energy(&state.q, &state.dq);
            kinetic = kinetic.max(now - energy(&state.q, &vec![0.0; n]));
            drift = drift.max((now - before).abs());
        }
        let _ = write!(
            text,
            "\n## Energy\n\nThe TX-40 without friction, let go and falling about for 10 s in steps of 0.2 ms: its energy \
             stays within {} of the largest kinetic energy at every step (wanted: 1e-8). The tests of \
             `runtime/src/simulation` assert it for a branched arm with a prismatic axis and coupled motors, and that \
             forward dynamics undo inverse dynamics to 1e-10; `tests/simulation.rs` for the generated robots.\n",
            significant(drift / kinetic, 2)
        );
        Ok(())
    }

    fn speed(&self, text: &mut String) -> Result<(), Failure> {
        let campaign = Campaign::default();
        let motion = self.motion(8)?;
        let _ = write!(
            text,
            "\n## Speed\n\nOne second of the TX-40 at 5 kHz, controller with feed-forward, encoder and torque noise and the \
             log of every sample included (wanted: 25 ms on one core):\n\n| robot | CPU ms for a second |\n| --- | ---: |\n"
        );
        for (name, size) in
            [("nominal", 0.0), ("nominal, with Stribeck, load and uneven friction and ripple", 1.0)]
        {
            let mut fastest = f64::INFINITY;
            for _ in 0..7 {
                let residue = Residue::typical(self.model.robot(), self.standard, size).boxed();
                let effects = if size > 0.0 { vec![residue] } else { Vec::new() };
                let mut plant = Plant::with_effects(self.model, self.standard, &[], effects)?;
                let settings = LoopSettings::nominal(self.model, &self.chi(), &motion, campaign.rate, 1);
                let clock = Clock::start();
                simulate(&mut plant, &motion, &settings, &mut |_| {})?;
                fastest = fastest.min(clock.seconds());
            }
            let _ = writeln!(text, "| {name} | {} |", significant(1e3 * fastest / motion.duration(), 3));
        }
        Ok(())
    }
}

/// The honest Monte Carlo: simulated with noise, identified as `dynid identify` does, for every robot.
fn recovery(text: &mut String) -> Result<(), Failure> {
    const SEEDS: u64 = 50;
    let _ = write!(
        text,
        "\n## Do the parameters come back?\n\nEvery robot with its nominal parameters and noise, one Fourier motion of 8 s \
         in closed loop at 2 kHz, recorded at 1 kHz and identified as `dynid identify` does; {SEEDS} seeds of motion and \
         noise (wanted: 95 % of the parameters within three of their standard deviations). Random motions, and motions \
         that were searched for with {SEARCHED} candidates:\n\n| robot | parameters | random, % within 3 sigma | least \
         seed | searched, % within 3 sigma | least seed |\n| --- | ---: | ---: | ---: | ---: | ---: |\n"
    );
    for &model in models::all() {
        let Some(nominal) = &model.robot().nominal else { continue };
        let chi = model.robot().base_from_standard(&nominal.standard);
        let _ = write!(text, "| {} | {} |", model.robot().name, chi.len());
        for evaluations in [0, SEARCHED] {
            let (mut whole, mut least) = (0.0, 1.0_f64);
            for seed in 1..=SEEDS {
                let share = within_three_sigma(model, &chi, evaluations, seed)?;
                whole += share / SEEDS as f64;
                least = least.min(share);
            }
            let percent = |x: f64| significant(100.0 * x, 3);
            let _ = write!(text, " {} | {} |", percent(whole), percent(least));
        }
        text.push('\n');
    }
    Ok(())
}

/// Candidate motions of a search.
const SEARCHED: usize = 300;

fn within_three_sigma(model: &dyn Model, chi: &[f64], evaluations: usize, seed: u64) -> Result<f64, Failure> {
    let settings = ExcitationSettings { evaluations, seed, ..Default::default() };
    let plan = excite(model, Some(chi), &settings, &|_| {})?;
    let motion = plan.motions.first().ok_or("there is no motion")?;
    let mut settings = LoopSettings::nominal(model, chi, motion, 2000.0, seed);
    settings.record_every = 2;
    let recorded = simulate(&mut Plant::new(model, chi)?, motion, &settings, &mut |_| {})?.recorded;
    let settings = RecordedSettings::default();
    let observed = observe_trajectories(&[recorded], model, &[Equations::Torque], &settings, None)?;
    let observation = observed.observations.first().ok_or("there are no equations")?;
    let found = estimate(observation, &EstimateSettings { block_sigmas: false, ..Default::default() });
    let back = |(p, truth): &(&ParameterEstimate, &f64)| {
        p.sigma.is_some_and(|sigma| (p.value - *truth).abs() <= 3.0 * sigma)
    };
    let within = found.parameters.iter().zip(chi).filter(back).count();
    Ok(within as f64 / chi.len() as f64)
}

fn largest_difference(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).fold(0.0, |m, (x, y)| m.max((x - y).abs()))
}

/// CPU time of this thread where the system tells it (Linux), time on the wall elsewhere.
struct Clock {
    cpu: Option<f64>,
    wall: Instant,
}

impl Clock {
    fn start() -> Self {
        Self { cpu: Self::cpu(), wall: Instant::now() }
    }

    fn cpu() -> Option<f64> {
        let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
        text.split_whitespace().next()?.parse::<f64>().ok().map(|nanoseconds| 1e-9 * nanoseconds)
    }

    fn seconds(&self) -> f64 {
        match (self.cpu, Self::cpu()) {
            (Some(before), Some(after)) => after - before,
            _ => self.wall.elapsed().as_secs_f64(),
        }
    }
}
