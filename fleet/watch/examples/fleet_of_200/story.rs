//! What happens to the robots of a fleet.

use crate::Failure;
use crate::arm::{Arm, Estimates, normal};
use dynid_fleet_watch::{Observation, Series};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

pub const ROBOTS: usize = 200;
pub const DAYS: usize = 60;
pub const FIRST_DAY: i64 = 20_500;
/// Part of the days without a recording, and of days with something else on the flange.
const MISSING: f64 = 0.08;
const OUTLIERS: f64 = 0.01;
/// Part of the robots that log no temperature.
const WITHOUT_TEMPERATURE: f64 = 0.2;

/// What is wrong with a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// Friction of a joint (1 or 2) rises by this part of itself a day.
    Wear { joint: usize, rate: f64 },
    /// A payload of half a kilogram slides outwards by so many metres and rattles from then on.
    LoosePayload { shift: f64 },
    /// The motor of joint 2 is another one.
    SwappedMotor,
}

/// One robot.
pub struct Robot {
    pub name: String,
    pub fault: Option<(Fault, usize)>,
    seed: u64,
    temperature_known: bool,
}

pub struct Story {
    pub robots: Vec<Robot>,
}

impl Story {
    /// Five wearing gears, two loose payloads, one swapped motor; or none of it.
    pub fn of(seed: u64, faults: bool) -> Self {
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut robots: Vec<Robot> = (0..ROBOTS)
            .map(|k| Robot {
                name: format!("arm-{k:03}"),
                fault: None,
                seed: 1_000_000 * seed + k as u64,
                temperature_known: rng.random::<f64>() >= WITHOUT_TEMPERATURE,
            })
            .collect();
        let mut place = |fault: &mut dyn FnMut(&mut Pcg64) -> Fault| loop {
            let robot: &mut Robot = &mut robots[(rng.random::<f64>() * ROBOTS as f64) as usize % ROBOTS];
            if robot.fault.is_none() {
                let onset = 15 + (rng.random::<f64>() * 20.0) as usize;
                robot.fault = Some((fault(&mut rng), onset));
                break;
            }
        };
        if faults {
            for k in 0..5 {
                place(&mut |rng| Fault::Wear { joint: 1 + k % 2, rate: 0.006 + 0.014 * rng.random::<f64>() });
            }
            (0..2).for_each(|_| {
                place(&mut |rng| Fault::LoosePayload { shift: 0.02 + 0.03 * rng.random::<f64>() })
            });
            place(&mut |_| Fault::SwappedMotor);
        }
        Self { robots }
    }
}

/// A robot on one day.
pub struct Today {
    pub day: usize,
    pub temperature: f64,
    pub standard: Vec<f64>,
    pub swapped: bool,
}

impl Robot {
    /// Its days with a recording.
    pub fn days(&self, arm: &Arm) -> Vec<Today> {
        let mut rng = Pcg64::seed_from_u64(self.seed);
        let own: Vec<f64> = arm.standard.iter().map(|x| x * (1.0 + 0.03 * normal(&mut rng))).collect();
        let hall = 2.0 * normal(&mut rng);
        let slope = 1.0 + 0.15 * normal(&mut rng);
        let phase = rng.random::<f64>() * 7.0;
        // Memories: warmth, friction of both joints, offsets.
        let mut memory: Vec<f64> = (0..7).map(|_| normal(&mut rng)).collect();
        let factors = [0.8_f64, 0.5, 0.5, 0.5, 0.5, 0.7, 0.7];
        let mut days = Vec::new();
        for day in 0..DAYS {
            memory
                .iter_mut()
                .zip(factors)
                .for_each(|(m, f)| *m = f * *m + (1.0 - f * f).sqrt() * normal(&mut rng));
            let season = 6.0 * (TAU * day as f64 / 240.0).sin()
                + if (day as f64 + phase) % 7.0 < 2.0 { -1.5 } else { 0.0 };
            let temperature = 30.0 + hall + season + 1.5 * memory[0];
            let mut standard = own.clone();
            self.vary(arm, &mut standard, slope * (temperature - 30.0), &memory, &mut rng);
            let swapped = self.suffer(arm, &mut standard, day, &mut rng);
            let (missing, odd): (f64, f64) = (rng.random(), rng.random());
            if odd < OUTLIERS {
                standard[arm.place("MX2")] += 0.1;
                standard[arm.place("Fc1")] *= 1.3;
                standard[arm.place("Fc2")] *= 1.3;
            }
            if missing >= MISSING {
                days.push(Today { day, temperature, standard, swapped });
            }
        }
        days
    }

    /// Friction falls with warmth and wanders by some per cent; offsets wander.
    fn vary(&self, arm: &Arm, standard: &mut [f64], warmth: f64, memory: &[f64], rng: &mut Pcg64) {
        for joint in 1..=2 {
            let mut scale =
                |name: &str, factor: f64| standard[arm.place(&format!("{name}{joint}"))] *= factor;
            scale("Fv", (-0.012 * warmth).exp() * (1.0 + 0.03 * memory[joint] + 0.01 * normal(rng)));
            scale("Fc", (-0.004 * warmth).exp() * (1.0 + 0.02 * memory[2 + joint] + 0.01 * normal(rng)));
            standard[arm.place(&format!("off{joint}"))] += 0.03 * memory[4 + joint];
        }
    }

    /// What the fault does on a day; whether the motor is another one.
    fn suffer(&self, arm: &Arm, standard: &mut [f64], day: usize, rng: &mut Pcg64) -> bool {
        let Some((fault, onset)) = self.fault else { return false };
        let since = (day + 1).saturating_sub(onset) as f64;
        let rattle = 0.003 * normal(rng);
        if since == 0.0 {
            return false;
        }
        match fault {
            Fault::Wear { joint, rate } => {
                standard[arm.place(&format!("Fc{joint}"))] *= 1.0 + rate * since;
                standard[arm.place(&format!("Fv{joint}"))] *= 1.0 + 0.5 * rate * since;
            }
            Fault::LoosePayload { shift } => {
                let (mass, radius, moved) = (0.5, 0.3, shift + rattle);
                standard[arm.place("MX2")] += mass * moved;
                standard[arm.place("ZZ2")] += mass * ((radius + moved).powi(2) - radius * radius);
            }
            Fault::SwappedMotor => return true,
        }
        false
    }

    /// Whether a parameter is not what it was; all of a robot with another motor.
    pub fn is_changed(&self, arm: &Arm, parameter: usize) -> bool {
        let Some((fault, onset)) = self.fault else { return false };
        let mut standard = arm.standard.clone();
        let mut rng = Pcg64::seed_from_u64(1);
        self.suffer(arm, &mut standard, onset + 10, &mut rng);
        fault == Fault::SwappedMotor || arm.chi(&standard)[parameter] != arm.chi(&arm.standard)[parameter]
    }
}

/// Every estimate by an identification of its own.
pub fn estimates_by_identification(arm: &Arm, story: &Story) -> Result<Vec<Series>, Failure> {
    let half = |part: usize| -> Result<Vec<Series>, Failure> {
        let mut all = Vec::new();
        for robot in story.robots.iter().skip(part).step_by(2) {
            let mut rng = Pcg64::seed_from_u64(robot.seed + 77);
            let days = robot.days(arm);
            let estimates: Result<Vec<Estimates>, Failure> =
                days.iter().map(|d| arm.identify(&arm.chi(&d.standard), d.swapped, &mut rng)).collect();
            all.extend(series(arm, robot, &days, &estimates?));
        }
        Ok(all)
    };
    std::thread::scope(|scope| {
        let threads = [scope.spawn(|| half(0)), scope.spawn(|| half(1))];
        let mut all = Vec::new();
        for thread in threads {
            all.extend(thread.join().unwrap()?);
        }
        Ok(all)
    })
}

/// Estimates whose errors are drawn from those of identifications.
pub fn simulated_estimates(arm: &Arm, story: &Story) -> Vec<Series> {
    let one = |robot: &Robot| {
        let mut rng = Pcg64::seed_from_u64(robot.seed + 77);
        let days = robot.days(arm);
        let estimates: Vec<Estimates> = days.iter().map(|d| drawn(arm, d, &mut rng)).collect();
        series(arm, robot, &days, &estimates)
    };
    story.robots.iter().flat_map(one).collect()
}

fn drawn(arm: &Arm, today: &Today, rng: &mut Pcg64) -> Estimates {
    let chi = arm.chi(&today.standard);
    let errors = &arm.errors[rng.random_range(0..arm.errors.len())];
    let one = |i: usize| {
        let factor = if today.swapped { arm.swapped[i] } else { 1.0 };
        (chi[i] * factor + errors[i].0, errors[i].1)
    };
    (0..chi.len()).map(one).collect()
}

fn series(arm: &Arm, robot: &Robot, days: &[Today], estimates: &[Estimates]) -> Vec<Series> {
    let one = |(p, name): (usize, String)| Series {
        robot: robot.name.clone(),
        table: "planar_2r".into(),
        unit: unit(&name).into(),
        parameter: name,
        observations: days
            .iter()
            .zip(estimates)
            .map(|(today, e)| Observation {
                day: FIRST_DAY + today.day as i64,
                value: e[p].0,
                sigma: e[p].1,
                temperature: robot.temperature_known.then_some(today.temperature),
                load: None,
            })
            .collect(),
    };
    arm.names().into_iter().enumerate().map(one).collect()
}

fn unit(name: &str) -> &'static str {
    match &name[..2] {
        "Fc" | "of" => "N.m",
        "Fv" => "N.m.s/rad",
        "MX" | "MY" => "kg.m",
        _ => "kg.m²",
    }
}
