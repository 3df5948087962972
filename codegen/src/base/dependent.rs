//! Base parameters of tables whose frames move with several joint variables, or several frames with one, or of which
//! parameters are known.
//!
//! First every moving frame is taken to move by itself: what is regrouped then stays zero whatever the frames' variables
//! depend on, and keeps its relation in symbols. What is left is compared at states drawn at random, in exact arithmetic:
//! a combination of columns is zero when its energy is constant. Energies are polynomials in the sines, cosines, positions
//! and speeds of the joints. One that is zero at points drawn from 2^60 values is zero (Schwartz 1980, Zippel 1979), but
//! for a chance far below that of a fault in the machine; sines and cosines of the points are those of rational rotations,
//! and a position that enters a length is as independent of its sine and cosine as the functions are.

use super::random_states::{energies_at_random, is_irrational};
use super::regroup::{Regrouping, regroup};
use crate::exact::{Form, Number};
use crate::robot::{DriveTable, RobotTable};
use dynid_description::{ParameterKind, StandardParameter};
use std::collections::BTreeMap;

/// [`regroup`] of a robot with dependent frames, or with parameters that are known.
pub(super) fn regroup_dependent(robot: &RobotTable, standard: &[StandardParameter]) -> Regrouping {
    let mut regrouping = regroup_as_if_free(robot, standard);
    let inertial = |k: &usize| standard[*k].kind <= ParameterKind::M && !regrouping.contains_key(k);
    let rational = |k: usize| !is_irrational(robot, &standard[k]);
    let all = (0..standard.len()).filter(|&k| !robot.is_known(k) && rational(k));
    let of_kind = |kind: ParameterKind| all.clone().filter(move |&k| standard[k].kind == kind);
    // First choice is what stands first in the table; rotors and offsets go into bodies where they can, and what springs have
    // where their combination is 0 into offsets. What is known is kept only where nothing else can take it.
    let columns: Vec<usize> = all
        .clone()
        .filter(inertial)
        .chain(of_kind(ParameterKind::Off))
        .chain(of_kind(ParameterKind::Ia))
        .chain(of_kind(ParameterKind::K))
        .chain(of_kind(ParameterKind::KR))
        .chain(
            robot.fixed.iter().map(|&(k, _)| k).filter(|&k| !standard[k].kind.is_friction() && rational(k)),
        )
        .collect();
    let dependent = dependencies(&energies_at_random(robot, standard, &columns));
    let second: BTreeMap<usize, Vec<(usize, Number)>> = dependent
        .into_iter()
        .map(|(column, of)| (columns[column], of.into_iter().map(|(k, c)| (columns[k], c)).collect()))
        .collect();
    for taken in regrouping.values_mut() {
        let mut sum: BTreeMap<usize, Form> = BTreeMap::new();
        let mut add = |column: usize, share: Form| {
            let entry = sum.entry(column).or_default();
            *entry = entry.plus(&share);
        };
        for (column, factor) in taken.iter() {
            match second.get(column) {
                None => add(*column, factor.clone()),
                Some(of) => of.iter().for_each(|&(kept, c)| add(kept, factor.scaled(c))),
            }
        }
        *taken = sum.into_iter().filter(|(_, factor)| !factor.is_zero()).collect();
    }
    let forms = |of: Vec<(usize, Number)>| of.into_iter().map(|(kept, c)| (kept, Form::number(c))).collect();
    regrouping.extend(second.into_iter().map(|(column, of)| (column, forms(of))));
    regrouping
}

/// The regrouping of the bodies where every frame that moves is a joint of its own.
fn regroup_as_if_free(robot: &RobotTable, standard: &[StandardParameter]) -> Regrouping {
    let mut free = robot.clone();
    for (frame, motion) in free.frames.iter_mut().zip(robot.motions()) {
        frame.kind = motion.kind;
    }
    free.dependent = Vec::new();
    free.known = Vec::new();
    free.fixed = Vec::new();
    free.couplings = Vec::new();
    free.drive = DriveTable::direct(free.joint_frames().len());
    let places: Vec<usize> = (0..standard.len())
        .filter(|k| standard[*k].kind <= ParameterKind::M && !robot.is_known(*k))
        .collect();
    let bodies: Vec<StandardParameter> = places.iter().map(|&k| standard[k].clone()).collect();
    let found = regroup(&free, &bodies);
    found
        .into_iter()
        .map(|(column, taken)| {
            (places[column], taken.into_iter().map(|(kept, factor)| (places[kept], factor)).collect())
        })
        .collect()
}

/// The columns that depend on columns before them, each as a combination of those that do not.
pub(super) fn dependencies(rows: &[Vec<Number>]) -> Vec<(usize, Vec<(usize, Number)>)> {
    let mut matrix = rows.to_vec();
    let columns = matrix.first().map_or(0, Vec::len);
    let mut kept: Vec<usize> = Vec::new();
    let mut dependent: Vec<(usize, Vec<(usize, Number)>)> = Vec::new();
    for k in 0..columns {
        let rank = kept.len();
        let pivot = (rank..matrix.len())
            .filter(|&i| !matrix[i][k].is_zero())
            .max_by(|&i, &j| matrix[i][k].real().abs().total_cmp(&matrix[j][k].real().abs()));
        let Some(pivot) = pivot else {
            let of = (0..rank).filter(|&i| !matrix[i][k].is_zero()).map(|i| (kept[i], matrix[i][k]));
            dependent.push((k, of.collect()));
            continue;
        };
        matrix.swap(rank, pivot);
        // The pivot is not zero.
        let inverse = matrix[rank][k].inverse().unwrap_or(Number::ONE);
        let lead: Vec<Number> = matrix[rank].iter().map(|&x| x * inverse).collect();
        for row in &mut matrix {
            let factor = row[k];
            if !factor.is_zero() {
                row[k..].iter_mut().zip(&lead[k..]).for_each(|(x, y)| *x = *x - factor * *y);
            }
        }
        matrix[rank] = lead;
        kept.push(k);
    }
    dependent.iter_mut().for_each(|(k, of)| refine(rows, *k, of));
    dependent
}

/// Coefficients of an exact combination with the floating point values that fit best: those of a long elimination carry its
/// rounding.
fn refine(rows: &[Vec<Number>], column: usize, combination: &mut [(usize, Number)]) {
    let real = |k: usize| -> Vec<f64> { rows.iter().map(|row| row[k].real()).collect() };
    let inner = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(x, y)| x * y).sum() };
    let mut left = real(column);
    let count = combination.len();
    // Gram and Schmidt, each column twice: A = Q R.
    let mut q: Vec<Vec<f64>> = Vec::with_capacity(count);
    let mut r = vec![vec![0.0; count]; count];
    for (k, &(from, _)) in combination.iter().enumerate() {
        let mut v = real(from);
        for _ in 0..2 {
            for (i, unit) in q.iter().enumerate() {
                let along = inner(unit, &v);
                r[i][k] += along;
                v.iter_mut().zip(unit).for_each(|(x, u)| *x -= along * u);
            }
        }
        r[k][k] = inner(&v, &v).sqrt();
        q.push(v.iter().map(|x| x / r[k][k]).collect());
    }
    let mut best: Vec<f64> = q
        .iter()
        .map(|unit| {
            let along = inner(unit, &left);
            left.iter_mut().zip(unit).for_each(|(x, u)| *x -= along * u);
            along
        })
        .collect();
    for k in (0..count).rev() {
        let known: f64 = (k + 1..count).map(|i| r[k][i] * best[i]).sum();
        best[k] = (best[k] - known) / r[k][k];
    }
    for ((_, factor), best) in combination.iter_mut().zip(best) {
        *factor = factor.with_real(best).cleaned();
    }
}

#[cfg(test)]
mod tests {
    use crate::base::base_set;
    use crate::robot::parse;

    fn names(rows: &str) -> Vec<String> {
        let text = format!("name: arm\ngravity: [0, -9.81, 0]\nconstants: {{d2: 0.4}}\nframes:\n{rows}");
        let robot = parse("arm.yaml", text.as_bytes()).expect("a table without mistakes");
        base_set(&robot).base.iter().map(|p| p.relation.to_string()).collect()
    }

    #[test]
    fn two_bodies_on_one_joint_have_one_inertia() {
        let rows = "  - {j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}\n  \
                    - {j: 2, parent: 0, sigma: 0, alpha: 0, d: d2, theta: -q1, r: 0}\n";
        let expected = ["ZZ1 + Ia1 + ZZ2", "MX1 - MX2", "MY1 + MY2", "Fv1", "Fc1", "off1"];
        assert_eq!(names(rows), expected);
    }

    #[test]
    fn the_bars_of_a_parallelogram_share_inertias_across_its_branches() {
        // Upper arm 2 and lower bar 3 on the base; the bar that closes them, 4 on 3, is parallel to 2, and the forearm 5 on 2
        // to 3.
        let rows = "  - {j: 1, parent: 0, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}\n  \
                    - {j: 2, parent: 0, sigma: 0, alpha: 0, d: 0, theta: q2, r: 0}\n  \
                    - {j: 3, parent: 2, sigma: 0, alpha: 0, d: 0.1, theta: q1 - q2, r: 0}\n  \
                    - {j: 4, parent: 1, sigma: 0, alpha: 0, d: d2, theta: q2 - q1, r: 0}\n";
        let relations = names(rows);
        assert_eq!(relations[0], "ZZ1 + Ia1 + ZZ3 + d2^2*M4");
        let inertias =
            relations.iter().filter(|r| r.contains("ZZ") || r.starts_with("MX3") || r.starts_with("MX4"));
        assert_eq!(inertias.count(), 3, "{relations:?}");
        assert!(relations.contains(&"ZZ2 + Ia2 + 0.01*M3 + ZZ4".to_owned()), "{relations:?}");
    }
}
