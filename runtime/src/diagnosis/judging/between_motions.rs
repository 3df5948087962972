//! How much laws of each joint differ from one motion to the next where nothing has changed.
//!
//! A recording that is judged against a model has no motions of the robot before it changed. What they would have told is
//! worked out while they are there, in the way of [`super::calibration`], and kept with the model.

use crate::diagnosis::judging::changes::{changes_of_companions, own_parts, prior};
use crate::diagnosis::judging::compared::{Compared, with_other_motions};
use crate::diagnosis::judging::regressors::Regressors;
use crate::diagnosis::judging::units::Units;
use crate::diagnosis::judging::white_products::Background;
use crate::diagnosis::outcome::BetweenMotions;
use crate::parallel;

/// Of each joint; nothing where there are fewer than two motions, or too few laws or stretches to say. `friction` are the
/// friction columns of each joint, values on its rows, of which the first `levels` are its level and the first of its
/// companions.
pub(in crate::diagnosis) fn between_motions(
    units: &Units,
    regressors: &Regressors<'_>,
    friction: &[Vec<Vec<f64>>],
    levels: usize,
    (residual, threads): (&[f64], usize),
) -> Vec<Option<BetweenMotions>> {
    // Where the recording is compared with a baseline, nothing has changed in that.
    let taken = |f: usize| units.is_target(f) != units.change();
    if !units.are_several(taken) {
        return Vec::new();
    }
    let freed = Regressors { free: friction, ..*regressors };
    let background = Background::new(units, &freed, residual, threads);
    let p = regressors.shared.len();
    let of_joint = |j: usize| {
        let companions = &regressors.companions[j];
        let laws = &companions[levels.min(companions.len())..];
        let products = background.with_companions(units, &freed, j, laws);
        let compared = with_other_motions(units, &products, p, taken)?;
        let first = compared.first()?;
        let changes = changes_of_companions(&compared, (&products.units, products.companions), p);
        let of_laws = prior(&own_parts(first, &first.whole, (changes.len(), p))?, &changes)?;

        // What its level differs by shows where it is the same in all motions.
        let (level, held) = friction[j].split_at(levels.min(friction[j].len()));
        let level: Vec<Vec<f64>> = level.iter().map(|c| regressors.on_all_rows(j, c)).collect();
        let mut free = friction.to_vec();
        free[j] = held.to_vec();
        let bound = Regressors { free: &free, ..*regressors };
        let products = background.with(units, &bound, &level, residual).products;
        let of_unit = |c: &Compared| c.wald(&products.units[*c.units.first()?], (p, level.len()));
        let compared = with_other_motions(units, &products, p, taken)?;
        let own: Vec<f64> = compared.iter().filter_map(of_unit).map(|wald| wald.mean()).collect();
        (own.len() > 1).then(|| BetweenMotions {
            laws: of_laws.variance,
            laws_freedom: of_laws.freedom,
            friction: own.iter().sum::<f64>() / own.len() as f64,
            friction_freedom: (own.len() - 1) as f64,
            stretch: units.duration,
        })
    };
    let all = parallel::map(threads, friction.len(), of_joint);
    if all.iter().all(Option::is_none) { Vec::new() } else { all }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::judging::units::Unit;
    use crate::testing::normal;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    const MOTIONS: usize = 10;
    const ROWS: usize = 200;

    /// Statistics of one joint whose laws differ between motions by `spread` times random columns, in white noise.
    fn measured(rng: &mut Pcg64, spread: f64) -> BetweenMotions {
        let rows = MOTIONS * ROWS;
        let mut column = || -> Vec<f64> { (0..rows).map(|_| normal(rng)).collect() };
        let shared = vec![column(), column()];
        let friction = vec![vec![column(), column()]];
        let mut companions = friction.clone();
        companions[0].extend((0..4).map(|_| column()));
        let mut y = column();
        for motion in 0..MOTIONS {
            for law in &companions[0] {
                let level = spread * normal(rng);
                for t in motion * ROWS..(motion + 1) * ROWS {
                    y[t] += level * law[t];
                }
            }
        }
        let of_joint = 0..rows;
        let motion = |f: usize| f * ROWS..(f + 1) * ROWS;
        let units = Units {
            units: (0..MOTIONS).map(|file| Unit { file, target: true }).collect(),
            rows: vec![(0..MOTIONS).map(motion).collect()],
            stretches: vec![(0..MOTIONS).map(motion).collect()],
            duration: 4.0,
            target_duration: 4.0,
        };
        let regressors = Regressors {
            shared: &shared,
            y: &y,
            free: &[vec![]],
            companions: &companions,
            prior: None,
            between_motions: &[],
            of_joint: std::slice::from_ref(&of_joint),
        };
        let all = between_motions(&units, &regressors, &friction, 2, (&y, 1));
        all.first().copied().flatten().expect("ten motions say something")
    }

    #[test]
    fn laws_that_differ_by_noise_alone_have_statistics_of_one() {
        let mut rng = Pcg64::seed_from_u64(41);
        let all: Vec<BetweenMotions> = (0..40).map(|_| measured(&mut rng, 0.0)).collect();
        let mean = |of: fn(&BetweenMotions) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
        let (laws, friction) = (mean(|b| b.laws), mean(|b| b.friction));
        println!("{laws} {friction}");
        assert!((laws - 1.0).abs() < 0.15, "{laws}");
        assert!((friction - 1.0).abs() < 0.15, "{friction}");
    }

    #[test]
    fn what_laws_differ_by_between_motions_is_measured() {
        let mut rng = Pcg64::seed_from_u64(42);
        // Four laws and two levels differ: what the other three laws do is noise to each; the levels are free.
        let spread = 0.3;
        let differ = |noise: f64| 1.0 + ROWS as f64 * spread * spread / noise;
        let (laws, levels) = (differ(1.0 + 3.0 * spread * spread), differ(1.0 + 4.0 * spread * spread));
        let all: Vec<BetweenMotions> = (0..40).map(|_| measured(&mut rng, spread)).collect();
        let mean = |of: fn(&BetweenMotions) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
        for (mean, expected) in [(mean(|b| b.laws), laws), (mean(|b| b.friction), levels)] {
            println!("{mean} where {expected} are expected");
            assert!((mean / expected - 1.0).abs() < 0.25, "{mean} where {expected} are expected");
        }
    }
}
