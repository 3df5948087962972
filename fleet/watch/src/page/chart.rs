//! Small charts of one series: the siblings as a band, the robot as a line, the change as a mark.

use super::escape::escape;
use super::family::Band;
use crate::calendar::date;
use crate::words::significant;
use crate::{Alarm, Series};
use std::fmt::Write as _;

const WIDTH: f64 = 320.0;
const HEIGHT: f64 = 150.0;
const LEFT: f64 = 50.0;
const RIGHT: f64 = 8.0;
const TOP: f64 = 8.0;
const BOTTOM: f64 = 22.0;
/// Days further apart than this are not joined by a line.
const GAP: i64 = 7;

/// Where numbers are on paper.
struct Axes {
    days: (i64, i64),
    values: (f64, f64),
}

impl Axes {
    /// Covers the band, all readings but the wildest fiftieth, and the change.
    fn of(points: &[(i64, f64)], band: &Band, alarm: Option<&Alarm>) -> Option<Self> {
        let mut values: Vec<f64> = points.iter().map(|p| p.1).collect();
        values.sort_by(f64::total_cmp);
        let cut = values.len() / 50;
        let mut inner: Vec<f64> = values.get(cut..values.len() - cut)?.to_vec();
        inner.extend(band.days.iter().flat_map(|d| [d.low, d.high]));
        inner.extend(alarm.iter().flat_map(|a| [a.before, a.before + a.change]));
        let low = inner.iter().copied().fold(f64::INFINITY, f64::min);
        let high = inner.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let margin = (0.08 * (high - low)).max(1e-9 * high.abs()).max(1e-12);
        Some(Self { days: (points.first()?.0, points.last()?.0), values: (low - margin, high + margin) })
    }

    fn x(&self, day: i64) -> f64 {
        let span = (self.days.1 - self.days.0).max(1) as f64;
        LEFT + (WIDTH - LEFT - RIGHT) * (day - self.days.0) as f64 / span
    }

    /// Beyond the paper at its edge.
    fn y(&self, value: f64) -> f64 {
        let part = (value - self.values.0) / (self.values.1 - self.values.0);
        TOP + (HEIGHT - TOP - BOTTOM) * (1.0 - part.clamp(0.0, 1.0))
    }
}

/// A figure of one series; nothing where it has fewer than two days.
pub(super) fn chart(series: &Series, points: &[(i64, f64)], band: &Band, alarm: Option<&Alarm>) -> String {
    let Some(axes) = Axes::of(points, band, alarm).filter(|a| points.len() > 1 && a.values.0.is_finite())
    else {
        return String::new();
    };
    let class = if alarm.is_some() { "law" } else { "after" };
    let name = escape(&series.parameter);
    let unit = if series.unit.is_empty() { String::new() } else { format!(", {}", escape(&series.unit)) };
    let mut out = format!(
        "<figure><figcaption>{name}{unit}</figcaption><svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" \
         aria-label=\"{name} of {} over days\">",
        escape(&series.robot)
    );
    grid(&mut out, &axes);
    area(&mut out, &axes, band);
    if let Some(alarm) = alarm {
        mark(&mut out, &axes, alarm);
    }
    let _ = write!(
        out,
        "<path class=\"line {class}\" d=\"{}\" fill=\"none\" stroke=\"currentColor\"/>",
        line(&axes, points)
    );
    let _ =
        write!(out, "<path class=\"dots {class}\" d=\"{}\" stroke=\"currentColor\"/>", dots(&axes, points));
    out.push_str("</svg></figure>");
    out
}

fn grid(out: &mut String, axes: &Axes) {
    for value in ticks(axes.values) {
        let y = axes.y(value);
        let label = significant(value, 3);
        let _ = write!(
            out,
            "<path class=\"grid\" d=\"M{LEFT} {y:.1}H{:.1}\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>",
            WIDTH - RIGHT,
            LEFT - 5.0,
            y + 3.5
        );
    }
    let (first, last) = axes.days;
    for (day, anchor) in [(first, "start"), (last, "end")] {
        let _ = write!(
            out,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\">{}</text>",
            axes.x(day),
            HEIGHT - 6.0,
            date(day)
        );
    }
}

/// Two to seven round numbers inside.
fn ticks((low, high): (f64, f64)) -> Vec<f64> {
    let raw = (high - low) / 2.5;
    let power = 10_f64.powf(raw.log10().floor());
    let step = [5.0, 2.0, 1.0].map(|m| m * power).into_iter().find(|s| *s <= raw).unwrap_or(raw);
    let first = (low / step).ceil();
    // Of values that are too large for their range there may be no round number between them.
    (0..8).map(|k| (first + f64::from(k)) * step).filter(|t| t.is_finite() && *t <= high).collect()
}

fn area(out: &mut String, axes: &Axes, band: &Band) {
    let inside: Vec<_> = band.days.iter().filter(|d| d.day >= axes.days.0 && d.day <= axes.days.1).collect();
    if inside.len() < 2 {
        return;
    }
    let forth = inside.iter().map(|d| format!("{:.1} {:.1}", axes.x(d.day), axes.y(d.high)));
    let back = inside.iter().rev().map(|d| format!("{:.1} {:.1}", axes.x(d.day), axes.y(d.low)));
    let outline: Vec<String> = forth.chain(back).collect();
    let middle: Vec<(i64, f64)> = inside.iter().map(|d| (d.day, d.middle)).collect();
    let _ = write!(
        out,
        "<path class=\"band\" d=\"M{}Z\"/><path class=\"line aside\" d=\"{}\" fill=\"none\" stroke=\"currentColor\"/>",
        outline.join("L"),
        line(axes, &middle)
    );
}

/// Where a change began, as an interval and a line, and the day of its alarm.
fn mark(out: &mut String, axes: &Axes, alarm: &Alarm) {
    let inside = |day: i64| day.clamp(axes.days.0, axes.days.1);
    let (from, to) = (axes.x(inside(alarm.began_between.0)), axes.x(inside(alarm.began_between.1)));
    let (began, raised) = (axes.x(inside(alarm.began)), axes.x(inside(alarm.day)));
    let floor = HEIGHT - BOTTOM;
    let _ = write!(
        out,
        "<rect class=\"between\" x=\"{from:.1}\" y=\"{TOP}\" width=\"{:.1}\" height=\"{:.1}\"/>\
         <path class=\"began\" d=\"M{began:.1} {TOP}V{floor}\"/><path class=\"raised\" d=\"M{raised:.1} {TOP}V{floor}\"/>",
        (to - from).max(1.0),
        floor - TOP
    );
}

fn line(axes: &Axes, points: &[(i64, f64)]) -> String {
    let mut out = String::new();
    let mut last: Option<i64> = None;
    for &(day, value) in points {
        let pen = if last.is_some_and(|l| day - l <= GAP) { 'L' } else { 'M' };
        let _ = write!(out, "{pen}{:.1} {:.1}", axes.x(day), axes.y(value));
        last = Some(day);
    }
    out
}

fn dots(axes: &Axes, points: &[(i64, f64)]) -> String {
    points.iter().map(|&(day, value)| format!("M{:.1} {:.1}h0", axes.x(day), axes.y(value))).collect()
}
