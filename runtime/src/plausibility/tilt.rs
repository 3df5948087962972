//! A base that is tilted: gravity is in another direction than the table says, by any angle.

use super::instead::Instead;
use super::judged::Judged;
use super::{Found, ratio};
use crate::estimation::PhysicalFit;
use crate::parallel;
use nalgebra::{Vector2, Vector3};

/// Tangents of the angles about two axes that steps begin with, and the one that they end with. Numerics: errors fall steadily to the
/// best direction from half a radian around it.
const FIRST: f64 = 0.2;
const LAST: f64 = 0.01;
/// Tangent of the largest tilt. Mechanics: a base that is mounted otherwise is turned by a quarter.
const MOST: f64 = 0.7;

/// The tilt that lowers the joints' errors most, as [`Instead::Tilt`], by which factor, and the error that it leaves; `None` without
/// gravity, or where none lowers them.
pub(super) fn best_tilt(judged: &Judged<'_>, own: &PhysicalFit) -> Option<Found> {
    let down = Vector3::from(judged.model.robot().gravity);
    let size = down.norm();
    // The axis that is least along it is not along it.
    let aside = Vector3::ith(down.iamin(), 1.0);
    let first = down.cross(&aside).try_normalize(f64::MIN_POSITIVE)?;
    let second = down.cross(&first).try_normalize(f64::MIN_POSITIVE)?;
    let tilted = |by: &Vector2<f64>| {
        let gravity = (down / size + by[0] * first + by[1] * second).normalize() * size;
        Instead::Tilt([gravity[0], gravity[1], gravity[2]])
    };
    let tried = |by: &Vector2<f64>| {
        let instead = tilted(by);
        let fit = instead.fit(judged, &[], |_| true)?;
        Some((ratio(&own.per_equation, &fit.per_equation), instead, fit.relative_error?))
    };
    let (mut here, mut best, mut step) = (Vector2::zeros(), None, FIRST);
    while step >= LAST {
        let ways = [(step, 0.0), (-step, 0.0), (0.0, step), (0.0, -step)];
        let next = ways.map(|(a, b)| here + Vector2::new(a, b));
        let within: Vec<_> = next.into_iter().filter(|by| by.norm() <= MOST).collect();
        let of_each = parallel::map(judged.settings.threads, within.len(), |k| tried(&within[k]));
        let found = within.into_iter().zip(of_each).filter_map(|(by, found)| Some((by, found?)));
        let found = found.max_by(|(_, a), (_, b)| a.0.total_cmp(&b.0));
        let least = best.as_ref().map_or(1.0, |(ratio, _, _): &Found| *ratio);
        match found.filter(|(_, found)| found.0 > least) {
            Some((by, found)) => (here, best) = (by, Some(found)),
            None => step /= 2.0,
        }
    }
    best
}
