//! How much laws of a kind change, from unit to unit where nothing has changed, or in the recording beside a law that has.

use crate::diagnosis::judging::compared::Compared;
use crate::diagnosis::rules::OWN_FRACTION;
use crate::statistics::moderation::{Prior, Variance, independent};
use nalgebra::DMatrix;

/// For each companion its change in every unit in which it is determined, compared with what is common to all, in standard deviations
/// of a white residual.
pub(super) fn changes_of_companions(
    compared: &[Compared],
    (units, count): (&[DMatrix<f64>], usize),
    y: usize,
) -> Vec<Vec<f64>> {
    let mut changes = vec![Vec::new(); count];
    for Compared { whole, model, units: own_units } in compared {
        let Some(model) = model else { continue };
        let white_y = model.white(whole, y, 1);
        let of_whole = model.white(whole, y + 1, count);
        for &u in own_units {
            let part = &units[u];
            let of_part = model.white(part, y + 1, count);
            for (b, changes) in changes.iter_mut().enumerate() {
                let i = y + 1 + b;
                let [all, own] = [of_whole.column(b), of_part.column(b)];
                // Common amplitude and change, both without what the columns make of them.
                let common = whole[(i, i)] - all.norm_squared();
                let both = part[(i, i)] - own.dot(&all);
                let change = part[(i, i)] - own.norm_squared();
                if common <= OWN_FRACTION * whole[(i, i)] || part[(i, i)] <= 0.0 {
                    continue;
                }
                let determined = change - both * both / common;
                if determined <= OWN_FRACTION * part[(i, i)] {
                    continue;
                }
                let [with_all, with_part] =
                    [whole[(i, y)] - all.dot(&white_y.column(0)), part[(i, y)] - own.dot(&white_y.column(0))];
                let slope = with_part - both / common * with_all;
                changes.push(slope / determined.sqrt());
            }
        }
    }
    changes
}

/// The mean square of the changes of a law from unit to unit; `None` of fewer than three.
pub(super) fn variance_of(changes: &[f64]) -> Option<Variance> {
    let sum: f64 = changes.iter().map(|size| size * size).sum();
    let n = changes.len();
    (n > 2).then(|| Variance { value: sum / n as f64, freedom: (n - 1) as f64 })
}

/// Inner products of companions over a part of the motion, or all of it, without what the columns before them make; `None` without a
/// model.
pub(super) fn own_parts(
    compared: &Compared,
    part: &DMatrix<f64>,
    (count, y): (usize, usize),
) -> Option<DMatrix<f64>> {
    let white = compared.model.as_ref()?.white(part, y + 1, count);
    Some(part.view((y + 1, y + 1), (count, count)) - white.tr_mul(&white))
}

/// Squared correlation of two companions that look alike beside the model.
fn correlation(own_parts: &DMatrix<f64>, i: usize, k: usize) -> f64 {
    let both = own_parts[(i, k)] * own_parts[(i, k)];
    (both / (own_parts[(i, i)] * own_parts[(k, k)]).max(f64::MIN_POSITIVE)).min(1.0)
}

/// Where the variances of companions scatter around. Those of two that look alike beside the model are correlated by
/// the square of what their columns are.
pub(super) fn prior(own_parts: &DMatrix<f64>, changes: &[Vec<f64>]) -> Option<Prior> {
    let (known, variances): (Vec<usize>, Vec<Variance>) =
        changes.iter().enumerate().filter_map(|(i, changes)| Some((i, variance_of(changes)?))).unzip();
    Prior::of(&variances, &|i, k| correlation(own_parts, known[i], known[k]))
}

/// How much companions change in the part of the motion that is diagnosed beside a law which has changed there: what differs between
/// the two recordings in general differs in all of them. Products are those of the whole and of the part, ordered `[p columns, k of
/// the law, y, companions]`; where `common`, the law may be there in all motion. `None` where fewer than three companions tell.
pub(super) fn of_kind(
    (whole, part): (&DMatrix<f64>, &DMatrix<f64>),
    count: usize,
    (p, k): (usize, usize),
    common: bool,
) -> Option<Variance> {
    // The law in all motion, where it may be, and its change.
    let standing = if common { p + k } else { p };
    let order: Vec<usize> = (0..standing).chain(p..whole.nrows()).collect();
    let is_change = |i: usize| (standing..standing + k).contains(&i);
    let of_both = |i: usize, j: usize| if is_change(i) || is_change(j) { part } else { whole };
    let n = order.len();
    let with_change = DMatrix::from_fn(n, n, |i, j| of_both(i, j)[(order[i], order[j])]);
    let part = part.select_rows(&order).select_columns(&order);
    let y = standing + k;
    let compared = [Compared::new(with_change, y, vec![0])];
    let changes = changes_of_companions(&compared, (std::slice::from_ref(&part), count), y);
    let own_parts = own_parts(&compared[0], &part, (count, y))?;
    let known: Vec<usize> = (0..count).filter(|&i| !changes[i].is_empty()).collect();
    let sum: f64 = known.iter().flat_map(|&i| &changes[i]).map(|size| size * size).sum();
    let freedom = independent(known.len(), &|i, j| correlation(&own_parts, known[i], known[j]));
    let value = (sum / known.len() as f64).max(1.0);
    (known.len() > 2).then_some(Variance { value, freedom })
}
