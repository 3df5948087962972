//! Tables II, III and IV beside the paper's, as rows of text.

use dynid_runtime::estimation::Estimate;
use dynid_runtime::model::{JointIndex, Robot};
use dynid_runtime::paper::{
    Case, CaseResult, PUBLISHED_DEVIATIONS, PUBLISHED_PARAMETERS, Spread, mean_difference, published_error,
    spread,
};
use dynid_runtime::report::significant;

/// A table: header and rows; header names that start with `<` are words, the others numbers.
pub struct Rows {
    /// Column names.
    pub header: Vec<String>,
    /// The rows.
    pub rows: Vec<Vec<String>>,
}

/// The five cases of several seeds (or of one recording).
pub struct Results<'a> {
    /// The robot.
    pub robot: &'a Robot,
    /// Base parameters of the simulated robot; `None` for a real one.
    pub truth: Option<Vec<f64>>,
    /// For each seed, the cases that were run.
    pub seeds: Vec<&'a [CaseResult]>,
    /// Whether the paper's numbers belong beside ours.
    pub published: bool,
}

impl Results<'_> {
    fn cases(&self) -> Vec<Case> {
        let run = |case: &Case| self.seeds.iter().any(|s| s.iter().any(|r| r.case == *case));
        Case::ALL.into_iter().filter(run).collect()
    }

    fn of(&self, case: Case) -> impl Iterator<Item = &CaseResult> {
        self.seeds.iter().filter_map(move |s| s.iter().find(|r| r.case == case))
    }

    /// Table II: what survives of the parameters, and its values.
    pub fn parameters(&self) -> Rows {
        let cases: Vec<Case> = self.cases().into_iter().filter(|&c| c != Case::Five).collect();
        let mut header = vec!["<parameter".to_owned()];
        if self.truth.is_some() {
            header.push("true".to_owned());
        }
        for case in &cases {
            header.push(format!("case {}", case.number()));
            header.push("sigma %".to_owned());
            if self.published {
                header.push("paper".to_owned());
            }
        }
        let mut rows = Vec::new();
        for (k, parameter) in self.robot.base.iter().enumerate() {
            let plain = self.robot.standard[parameter.standard].name.as_ref();
            let paper = PUBLISHED_PARAMETERS.iter().find(|p| p.name == plain).filter(|_| self.published);
            let often = |case: Case| {
                let kept = self.of(case).filter(|r| r.chi[k] != 0.0).count();
                2 * kept > self.seeds.len()
            };
            if paper.is_none() && !cases.iter().any(|&case| often(case)) {
                continue;
            }
            let mut row = vec![parameter.name.to_string()];
            row.extend(self.truth.as_ref().map(|chi| significant(chi[k], 3)));
            for &case in &cases {
                let values = spread(self.of(case).map(|r| r.chi[k]).filter(|&x| x != 0.0));
                row.push(with_spread(values.filter(|_| often(case)), 3));
                let sigmas = self.of(case).filter_map(|r| relative_sigma(&r.estimate, &parameter.name));
                let sigma = spread(sigmas).filter(|_| often(case));
                row.push(sigma.map_or_else(dash, |s| significant(s.mean, 2)));
                if self.published {
                    let value = paper.and_then(|p| p.values[case.number() - 1]);
                    row.push(value.map_or_else(dash, |v| significant(v, 3)));
                }
            }
            let first = 1 + usize::from(self.truth.is_some());
            if row[first..].iter().any(|cell| *cell != dash()) {
                rows.push(row);
            }
        }
        Rows { header, rows }
    }

    /// Relative standard deviations of the essential parameters in cases 1 and 2, percent: weighted joint by joint,
    /// with equal weights, and the paper's.
    pub fn deviations(&self) -> Rows {
        let cases: Vec<Case> =
            self.cases().into_iter().filter(|c| matches!(c, Case::One | Case::Two)).collect();
        let mut header = vec!["<parameter".to_owned()];
        for case in &cases {
            let words = ["weighted", "equal", "paper"].iter().take(if self.published { 3 } else { 2 });
            header.extend(words.map(|word| format!("case {}, {word}", case.number())));
        }
        let mut rows = Vec::new();
        for parameter in self.robot.base.iter() {
            let plain = self.robot.standard[parameter.standard].name.as_ref();
            let paper = PUBLISHED_DEVIATIONS.iter().find(|p| p.0 == plain).filter(|_| self.published);
            let mut row = vec![parameter.name.to_string()];
            for &case in &cases {
                let weighted: Vec<f64> =
                    self.of(case).filter_map(|r| relative_sigma(&r.estimate, &parameter.name)).collect();
                let equal: Vec<f64> = self
                    .of(case)
                    .filter_map(|r| relative_sigma(r.equal_weights.as_ref()?, &parameter.name))
                    .collect();
                for values in [weighted, equal] {
                    let often = 2 * values.len() > self.seeds.len();
                    let mean = spread(values).filter(|_| often);
                    row.push(mean.map_or_else(dash, |s| significant(s.mean, 2)));
                }
                if self.published {
                    let value = paper.and_then(|p| p.1[case.number() - 1]);
                    row.push(value.map_or_else(dash, |v| significant(v, 3)));
                }
            }
            if row[1..].iter().any(|cell| *cell != dash()) {
                rows.push(row);
            }
        }
        Rows { header, rows }
    }

    /// The paper's findings, each with in how many of the seeds it holds.
    pub fn findings(&self) -> Vec<String> {
        let count = |holds: &dyn Fn(Found<'_>) -> Option<bool>| {
            let held = self.seeds.iter().filter(|results| holds(Found(results)).unwrap_or(false)).count();
            format!("{held} of {}", self.seeds.len())
        };
        let error = |r: &CaseResult| r.reconstruction_error;
        let mut findings = vec![
            format!(
                "The power model on one motion (case 3) reconstructs the torques more than 2.5 times worse than \
                 case 1: {}",
                count(&|run| Some(error(run.of(Case::Three)?) > 2.5 * error(run.of(Case::One)?)))
            ),
            format!(
                "Joint 1 alone (case 5) reconstructs them more than 5 times worse than case 1: {}",
                count(&|run| Some(error(run.of(Case::Five)?) > 5.0 * error(run.of(Case::One)?)))
            ),
        ];
        if self.of(Case::Four).next().is_some() {
            findings.push(format!(
                "With the sets, the power model (case 4) comes within a factor of 2.5 of case 2: {}",
                count(&|run| Some(error(run.of(Case::Four)?) < 2.5 * error(run.of(Case::Two)?)))
            ));
            findings.push(format!(
                "The residual of case 3 looks as good as that of case 4 (at most 1.3 times it), which is the trap: {}",
                count(&|run| {
                    Some(run.of(Case::Three)?.identification_error < 1.3 * run.of(Case::Four)?.identification_error)
                })
            ));
            findings.push(format!(
                "More parameters survive in case 2 than in case 1: with equal weights, which the standard deviations \
                 that the paper prints follow, {}; weighted joint by joint {}; more are known to 10 %: {}",
                count(&|run| {
                    let survived = |case| run.of(case)?.survived_equal_weights();
                    Some(survived(Case::Two)? > survived(Case::One)?)
                }),
                count(&|run| Some(run.of(Case::Two)?.survived > run.of(Case::One)?.survived)),
                count(&|run| Some(run.of(Case::Two)?.known_to(10.0) > run.of(Case::One)?.known_to(10.0)))
            ));
        }
        findings
    }

    /// Table III: quality of the identification.
    pub fn identification(&self) -> Rows {
        let cases: Vec<Case> = self.cases().into_iter().filter(|&c| c != Case::Five).collect();
        let mut rows = Vec::new();
        let residual = |case| spread(self.of(case).map(|r| r.identification_error));
        rows.push(self.row("relative error norm of the identification", &cases, 3, residual));
        if self.published {
            rows.push(published_row("the paper", &cases, |case| published_error(case).0));
        }
        rows.push(self.row("parameters that survive", &cases, 3, |case| {
            spread(self.of(case).map(|r| r.survived as f64))
        }));
        if self.published {
            rows.push(published_row("the paper", &cases, |case| {
                let at = case.number() - 1;
                Some(PUBLISHED_PARAMETERS.iter().filter(|p| p.values[at].is_some()).count() as f64)
            }));
        }
        rows.push(self.row("parameters that survive, equal weights", &cases, 3, |case| {
            spread(self.of(case).filter_map(CaseResult::survived_equal_weights).map(|count| count as f64))
        }));
        rows.push(self.row("parameters known to 10 %", &cases, 3, |case| {
            spread(self.of(case).map(|r| r.known_to(10.0) as f64))
        }));
        for (reference, published) in [(Case::One, [119.09, 22.89]), (Case::Two, [131.97, 21.70])] {
            if !cases.contains(&reference) {
                continue;
            }
            let name = format!("mean difference to case {}, %", reference.number());
            rows.push(self.row(&name, &cases, 3, |case| {
                spread(self.seeds.iter().filter_map(|results| {
                    let find = |case| results.iter().find(|r| r.case == case);
                    mean_difference(find(case).filter(|_| case != reference)?, find(reference)?)
                }))
            }));
            if self.published {
                rows.push(published_row("the paper", &cases, |case| match case {
                    Case::Three => Some(published[0]),
                    Case::Four => Some(published[1]),
                    _ => None,
                }));
            }
        }
        Rows { header: case_header(&cases), rows }
    }

    /// Table IV: quality of the torque reconstruction, overall and joint by joint.
    pub fn reconstruction(&self) -> Rows {
        let cases = self.cases();
        let error = |case| spread(self.of(case).map(|r| r.reconstruction_error));
        let mut rows = vec![self.row("relative error norm of the torques", &cases, 3, error)];
        if self.published {
            rows.push(published_row("the paper", &cases, |case| Some(published_error(case).1)));
        }
        for joint in 0..self.robot.joints() {
            let number = self.robot.joint_number(JointIndex(joint));
            rows.push(self.row(&format!("joint {number}"), &cases, 3, |case| {
                spread(self.of(case).map(|r| r.per_joint[joint]))
            }));
        }
        Rows { header: case_header(&cases), rows }
    }

    fn row(
        &self,
        name: &str,
        cases: &[Case],
        digits: usize,
        value: impl Fn(Case) -> Option<Spread>,
    ) -> Vec<String> {
        let mut row = vec![name.to_owned()];
        row.extend(cases.iter().map(|&case| with_spread(value(case), digits)));
        row
    }
}

/// The cases of one seed.
struct Found<'a>(&'a [CaseResult]);

impl<'a> Found<'a> {
    fn of(&self, case: Case) -> Option<&'a CaseResult> {
        self.0.iter().find(|r| r.case == case)
    }
}

fn case_header(cases: &[Case]) -> Vec<String> {
    let mut header = vec!["<".to_owned()];
    header.extend(cases.iter().map(|case| format!("case {}", case.number())));
    header
}

fn published_row(name: &str, cases: &[Case], value: impl Fn(Case) -> Option<f64>) -> Vec<String> {
    let mut row = vec![format!("  {name}")];
    row.extend(cases.iter().map(|&case| value(case).map_or_else(dash, |v| significant(v, 3))));
    row
}

fn dash() -> String {
    "-".to_owned()
}

fn with_spread(value: Option<Spread>, digits: usize) -> String {
    match value {
        None => dash(),
        Some(Spread { mean, deviation: 0.0 }) => significant(mean, digits),
        Some(Spread { mean, deviation }) => {
            format!("{} ±{}", significant(mean, digits), significant(deviation, 2))
        }
    }
}

fn relative_sigma(estimate: &Estimate, name: &str) -> Option<f64> {
    let kept = &estimate.essential.as_ref()?.parameters;
    kept.iter().find(|p| p.name == name)?.relative_sigma_percent
}
