//! Which friction parameters of motors and of combinations of joints are independent of those of the joints.

use super::dependent::dependencies;
use super::regroup::Regrouping;
use crate::exact::{Form, Number};
use crate::robot::RobotTable;
use dynid_description::StandardParameter;
use num_rational::BigRational;
use num_traits::Signed;

/// Regroups viscous and Coulomb friction.
///
/// Friction on the speed s = c dq has the torques c f(s). Viscous friction is the symmetric matrix c cT, and matrices are
/// compared entry by entry. Coulomb friction is c sign(c dq), which jumps where s is 0 and nowhere else, so that two of them
/// are independent unless their combinations are the same but for a factor. What stands first is kept: joints before motors,
/// motors before combinations that the table names, what is known last.
pub(super) fn regroup_friction(
    robot: &RobotTable,
    standard: &[StandardParameter],
    regrouping: &mut Regrouping,
) {
    let joints = robot.joint_frames().len();
    let forms = |is_one: &dyn Fn(&StandardParameter) -> bool| -> Vec<(usize, Vec<BigRational>)> {
        let mut columns: Vec<usize> =
            (0..standard.len()).filter(|&k| is_one(&standard[k]) && !robot.known.contains(&k)).collect();
        columns.sort_by_key(|&k| (robot.is_known(k), standard[k].kind));
        columns.into_iter().map(|k| (k, robot.acts_on(&standard[k]))).collect()
    };

    let viscous = forms(&|p| p.kind.is_viscous());
    let entry = |i: usize, k: usize| {
        viscous.iter().map(|(_, c)| Number::from(&c[i] * &c[k])).collect::<Vec<Number>>()
    };
    let rows: Vec<Vec<Number>> =
        (0..joints).flat_map(|i| (0..=i).map(move |k| (i, k))).map(|(i, k)| entry(i, k)).collect();
    for (column, of) in dependencies(&rows) {
        let taken = of.into_iter().map(|(kept, factor)| (viscous[kept].0, Form::number(factor)));
        regrouping.insert(viscous[column].0, taken.collect());
    }

    let dry = forms(&|p| p.kind.is_coulomb());
    for (at, (column, form)) in dry.iter().enumerate() {
        // c' = a c has the torques |a| c sign(c dq).
        let same = dry[..at].iter().find_map(|(kept, other)| Some((*kept, ratio(form, other)?)));
        if let Some((kept, factor)) = same {
            regrouping.insert(*column, vec![(kept, Form::number(factor.abs().into()))]);
        }
    }
}

/// a where c = a d, entry by entry.
fn ratio(c: &[BigRational], d: &[BigRational]) -> Option<BigRational> {
    let zero = BigRational::from_integer(0.into());
    let first = d.iter().position(|x| *x != zero)?;
    let factor = &c[first] / &d[first];
    (factor != zero && c.iter().zip(d).all(|(x, y)| *x == &factor * y)).then_some(factor)
}
