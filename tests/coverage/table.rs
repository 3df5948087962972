//! What is counted, and the page that it is written to.

use std::fmt::Write as _;

use super::methods::Outcome;

/// Half the width of an interval of 95 %, in standard deviations.
const NORMAL_95: f64 = 1.959_964;

/// The outcomes of one case, seed by seed.
pub struct Tally {
    truth: Vec<(String, f64)>,
    seeds: Vec<(u64, Vec<Outcome>)>,
}

/// One method on one case.
struct Row {
    method: String,
    /// Coverage, bias over sigma, and spread over sigma of each parameter that had an interval.
    parameters: Vec<(String, f64, f64, f64)>,
    /// Intervals that were not given.
    missing: usize,
}

impl Tally {
    pub fn new(truth: Vec<(String, f64)>) -> Tally {
        Tally { truth, seeds: Vec::new() }
    }

    pub fn add(&mut self, seed: u64, outcomes: Vec<Outcome>) {
        self.seeds.push((seed, outcomes));
    }

    /// The same for any order in which the seeds came.
    fn rows(mut self) -> Vec<Row> {
        self.seeds.sort_by_key(|s| s.0);
        let methods = self.seeds.first().map_or(0, |s| s.1.len());
        (0..methods)
            .map(|m| {
                let mut row =
                    Row { method: self.seeds[0].1[m].method.clone(), parameters: Vec::new(), missing: 0 };
                for (k, (name, truth)) in self.truth.iter().enumerate() {
                    let given: Vec<(f64, f64)> = self
                        .seeds
                        .iter()
                        .filter_map(|(_, o)| Some((o[m].chi[k] - truth, o[m].sigma[k]?)))
                        .collect();
                    row.missing += self.seeds.len() - given.len();
                    if given.len() < 2 {
                        continue;
                    }
                    let n = given.len() as f64;
                    let inside = given.iter().filter(|(e, s)| e.abs() <= NORMAL_95 * s).count() as f64;
                    // In units of their own sigmas: seeds have other motions.
                    let bias = given.iter().map(|(e, s)| e / s).sum::<f64>() / n;
                    let spread =
                        (given.iter().map(|(e, s)| (e / s - bias).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
                    row.parameters.push((name.clone(), 100.0 * inside / n, bias, spread));
                }
                row
            })
            .collect()
    }
}

/// The tables of all cases.
pub struct Page {
    text: String,
}

impl Page {
    pub fn new(seeds: u64) -> Page {
        let text = format!(
            "{seeds} seeds a case. Coverage, %: of the intervals value ± 1.96 sigma.\n\n\
             | robot | motions | noise | method | median coverage | least | its parameter | rms bias / sigma | largest | \
             median spread / sigma | no interval |\n\
             | --- | --- | --- | --- | ---: | ---: | --- | ---: | ---: | ---: | ---: |\n"
        );
        println!("{text}");
        Page { text }
    }

    pub fn add(&mut self, robot: &str, shape: &str, noise: &str, tally: Tally) {
        let seeds = tally.seeds.len();
        for row in tally.rows() {
            let all = row.parameters.len().max(1);
            let of = |part: fn(&(String, f64, f64, f64)) -> f64| {
                let mut values: Vec<f64> = row.parameters.iter().map(part).collect();
                values.sort_by(f64::total_cmp);
                values.get(all / 2).copied().unwrap_or(f64::NAN)
            };
            let least = row.parameters.iter().min_by(|a, b| a.1.total_cmp(&b.1));
            let (name, least) = least.map_or(("-", f64::NAN), |p| (p.0.as_str(), p.1));
            let bias = (row.parameters.iter().map(|p| p.2.powi(2)).sum::<f64>() / all as f64).sqrt();
            let most = row.parameters.iter().fold(0.0_f64, |m, p| m.max(p.2.abs()));
            let line = format!(
                "| {robot} | {shape} | {noise} | {} | {:.1} | {least:.1} | {name} | {bias:.2} | {most:.2} | {:.2} | {} |",
                row.method,
                of(|p| p.1),
                of(|p| p.3),
                if row.missing == 0 { String::new() } else { format!("{} of {}", row.missing, seeds * all) },
            );
            println!("{line}");
            let _ = writeln!(self.text, "{line}");
            if std::env::var_os("COVERAGE_PARAMETERS").is_some() {
                for (name, coverage, bias, ratio) in &row.parameters {
                    println!("    {name:8} {coverage:5.1} {bias:6.2} {ratio:5.2}");
                }
            }
        }
    }

    pub fn finish(self, file: Option<String>) {
        if let Some(file) = file {
            let marker = "<!-- measured -->\n";
            let before = std::fs::read_to_string(&file).unwrap_or_default();
            let kept = before.split(marker).next().unwrap_or_default();
            std::fs::write(file, format!("{kept}{marker}\n{}", self.text)).unwrap();
        }
    }
}
