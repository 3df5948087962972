//! How often a second variable is taken that is not there, and one that is.

use super::*;
use crate::diagnosis::candidates::candidate::Candidate;
use crate::diagnosis::candidates::trial::Trial;
use crate::diagnosis::judging::testing::correlated;
use crate::diagnosis::rows::design::Design;
use crate::effects::{Axis, FreeLaw, Seen, Together, Variable};
use rand::SeedableRng;
use rand_pcg::Pcg64;

const ROWS: usize = 120;
const SEGMENTS: [(usize, bool); 4] = [(0, true), (1, true), (2, true), (3, true)];
const ALL: usize = ROWS * SEGMENTS.len();

/// Four variables that go their own ways, and noise, all with a memory.
fn series(rng: &mut Pcg64) -> (Vec<Vec<f64>>, Vec<f64>) {
    let variables = (0..4).map(|_| correlated(rng, ALL, 0.95)).collect();
    (variables, correlated(rng, ALL, 0.5))
}

fn axis(joint: usize) -> Axis {
    Axis { variable: Variable::Position(joint), centre: 0.0, half: 8.0 }
}

fn judged(regression: &Regression, variables: &[Vec<f64>], laws: Vec<FreeLaw>) -> Option<Judged> {
    let trial = |law: &FreeLaw| {
        let mut columns = vec![vec![0.0; ALL]; law.amplitudes()];
        let mut out = Vec::new();
        for r in 0..ALL {
            let seen = |a: &Axis| a.seen(variables[a.variable.joint().unwrap_or(0)][r], None);
            let at: Vec<Seen> = law.axes.iter().map(seen).collect();
            law.columns(&at, &mut out);
            columns.iter_mut().zip(&out).for_each(|(c, x)| c[r] = *x);
        }
        let columns = columns.into_iter().map(|c| vec![(0, c)]).collect();
        let mut trial = Trial::new(&regression.design, law.shape(), columns);
        trial.needed = 1;
        trial
    };
    let candidate = Candidate {
        effect: EffectKind::FreeForm,
        place: Place::Joint(0),
        own: vec![0],
        trials: laws.iter().map(trial).collect(),
        shapes: laws.len(),
        fixed: None,
        only_positive: false,
    };
    let verdict = regression.judge(&candidate)?;
    let law = laws[verdict.trial].clone();
    Some(Judged { law, candidate, verdict })
}

/// Which variables are taken of torques that depend on the first one, and on the second one by `second`.
fn taken(rng: &mut Pcg64, second: f64) -> Vec<Variable> {
    let law = law(rng, |a, b| 2.0 * (0.5 * a).sin() + second * b);
    law.axes.iter().map(|a| a.variable).collect()
}

/// The law that is taken of torques that depend like this on the first two variables.
fn law(rng: &mut Pcg64, torque: impl Fn(f64, f64) -> f64) -> FreeLaw {
    let (variables, noise) = series(rng);
    let y: Vec<f64> = (0..ALL).map(|r| torque(variables[0][r], variables[1][r]) + noise[r]).collect();
    let design = Design::made_up(1, &SEGMENTS, ROWS, vec![vec![1.0; ALL]], y);
    let regression = Regression::new(design, Vec::new()).expect("a small problem is regular");
    let sorted = |list: Vec<Option<Judged>>| {
        let mut list: Vec<Judged> = list.into_iter().flatten().collect();
        list.sort_by(|a, b| b.verdict.total().total_cmp(&a.verdict.total()));
        list
    };
    let single = (0..4).map(|k| judged(&regression, &variables, vec![FreeLaw::one(axis(k))])).collect();
    let ways = || Together::OF_ANY_TWO.into_iter().chain(Together::OF_POSITIONS);
    let pairs = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]].map(|pair| {
        let laws = ways().map(|way| FreeLaw::two(way, pair.map(axis))).collect();
        judged(&regression, &variables, laws)
    });
    let screened = Screened { single: sorted(single), pairs: sorted(pairs.into()), tried: 10 };
    let laws = fewest_variables(&regression, screened, 0.1);
    laws.into_iter().next().expect("the first variable is there").law
}

#[test]
fn a_variable_that_is_not_there_is_taken_in_no_more_than_one_case_of_twenty() {
    let mut rng = Pcg64::seed_from_u64(5);
    let (mut first, mut more) = (0, 0);
    for _ in 0..60 {
        let variables = taken(&mut rng, 0.0);
        first += usize::from(variables[0] == Variable::Position(0));
        more += usize::from(variables.len() > 1);
    }
    assert_eq!(first, 60);
    assert!(more <= 6, "{more} of 60");
}

#[test]
fn a_second_variable_that_is_there_is_taken() {
    let mut rng = Pcg64::seed_from_u64(6);
    let both = [Variable::Position(0), Variable::Position(1)];
    let right = (0..30).filter(|_| taken(&mut rng, 0.8) == both).count();
    assert!(right >= 27, "{right} of 30");
}

#[test]
fn a_torque_in_proportion_to_two_variables_is_taken_as_that() {
    let mut rng = Pcg64::seed_from_u64(7);
    let lines = (0..30).filter(|_| law(&mut rng, |a, b| a - b).together == Together::Lines).count();
    assert!(lines >= 27, "{lines} of 30");
}

#[test]
fn a_torque_that_waves_over_the_sum_of_two_positions_is_taken_as_that() {
    let mut rng = Pcg64::seed_from_u64(8);
    let wave = |a: f64, b: f64| 2.0 * (0.7 * (a + b)).sin();
    let sums = (0..30).filter(|_| law(&mut rng, wave).together == Together::Sum).count();
    assert!(sums >= 27, "{sums} of 30");
}
