//! The curves of a plot and how they are drawn.

use std::fmt::Write as _;

use super::axis::Axis;
use super::thin::{MOST_POINTS, thinned};

/// Up to so many points are drawn large, from so many on small.
const FEW: usize = 120;
const MANY: usize = 400;

/// What a series stands for; decides its colour on screen and its dash in print.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// What was recorded.
    Measured,
    /// The model before an effect was added.
    Before,
    /// The model with the effect.
    After,
    /// A law that was fitted.
    Law,
    /// Anything else: a noise floor, a threshold.
    Aside,
}

impl Role {
    pub(super) fn class(self) -> &'static str {
        match self {
            Role::Measured => "measured",
            Role::Before => "before",
            Role::After => "after",
            Role::Law => "law",
            Role::Aside => "aside",
        }
    }
}

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SeriesKind {
    /// Points joined by a line; a point that is not finite interrupts it.
    Line,
    /// Single points.
    Points,
    /// Vertical lines from zero.
    Stems,
}

/// One curve of a plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Its name in the legend; empty: it is not named there.
    pub label: String,
    /// What it stands for.
    pub role: Role,
    /// How it is drawn.
    pub kind: SeriesKind,
    /// x and y.
    pub points: Vec<(f64, f64)>,
}

/// An interval of x that is shaded, such as a time window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Where it begins.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
}

/// Adds the paths of a series to an SVG.
pub(super) fn draw_series(out: &mut String, series: &Series, x: &Axis, y: &Axis) {
    let class = series.role.class();
    let finite = |p: &(f64, f64)| p.0.is_finite() && p.1.is_finite();
    match series.kind {
        SeriesKind::Line => {
            let mut path = String::new();
            let mut pen_down = false;
            for point in thinned(&series.points) {
                if finite(&point) {
                    let command = if pen_down { 'L' } else { 'M' };
                    let _ = write!(path, "{command}{:.1} {:.1}", x.pixel(point.0), y.pixel(point.1));
                }
                pen_down = finite(&point);
            }
            let _ = write!(
                out,
                "<path class=\"line {class}\" fill=\"none\" stroke=\"currentColor\" d=\"{path}\"/>"
            );
        }
        SeriesKind::Points => {
            let step = series.points.len().div_ceil(MOST_POINTS).max(1);
            // One path of zero-length round-capped strokes is a fraction of the size of as many circles.
            let mut path = String::new();
            for point in series.points.iter().step_by(step).filter(|p| finite(p)) {
                let _ = write!(path, "M{:.1} {:.1}h0", x.pixel(point.0), y.pixel(point.1));
            }
            // A few means stand out; a cloud does not hide what is in it.
            let few = match series.points.len() {
                count if count <= FEW => " few",
                count if count < MANY => "",
                _ => " many",
            };
            let _ = write!(
                out,
                "<path class=\"dots{few} {class}\" fill=\"none\" stroke=\"currentColor\" stroke-linecap=\"round\" d=\"{path}\"/>"
            );
        }
        SeriesKind::Stems => {
            let mut path = String::new();
            let ground = y.pixel(0.0);
            for point in thinned(&series.points).iter().filter(|p| finite(p)) {
                let _ = write!(path, "M{:.1} {ground:.1}V{:.1}", x.pixel(point.0), y.pixel(point.1));
            }
            let _ = write!(
                out,
                "<path class=\"line {class}\" fill=\"none\" stroke=\"currentColor\" d=\"{path}\"/>"
            );
        }
    }
}
