//! Plots as inline SVG: no script, no font and no file from elsewhere.

use std::fmt::Write as _;

use super::axis::Axis;
use super::escape::escape;

const WIDTH: f64 = 720.0;
const LEFT: f64 = 84.0;
const RIGHT: f64 = 12.0;
const TOP: f64 = 10.0;
const BOTTOM: f64 = 48.0;

/// More points than this in a line are thinned to their extremes per pixel: the picture stays the same.
const MOST_POINTS: usize = 1400;

/// Up to so many points are drawn large.
const FEW: usize = 120;

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
    fn class(self) -> &'static str {
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

/// A plot with linear axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// What it shows, read out by screen readers and printed above.
    pub title: String,
    /// Name and unit of x.
    pub x: String,
    /// Name and unit of y.
    pub y: String,
    /// Height in pixels at a width of 720; 260 is a good value.
    pub height: f64,
    /// The curves, drawn in order.
    pub series: Vec<Series>,
    /// Shaded intervals.
    pub bands: Vec<Band>,
}

impl Plot {
    /// An empty plot.
    pub fn new(title: impl Into<String>, x: impl Into<String>, y: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            x: x.into(),
            y: y.into(),
            height: 260.0,
            series: Vec::new(),
            bands: Vec::new(),
        }
    }

    /// The plot with one more series.
    pub fn with(
        mut self,
        label: impl Into<String>,
        role: Role,
        kind: SeriesKind,
        points: Vec<(f64, f64)>,
    ) -> Self {
        self.series.push(Series { label: label.into(), role, kind, points });
        self
    }

    /// A `figure` element with an inline SVG and a legend. Points that are not finite are not drawn.
    pub fn to_html(&self) -> String {
        let mut out = String::new();
        let _ = write!(out, "<figure><figcaption>{}</figcaption>", escape(&self.title));
        out.push_str(&self.to_svg());
        if self.series.len() > 1 {
            out.push_str("<p class=\"legend\">");
            for series in self.series.iter().filter(|s| !s.label.is_empty()) {
                let _ = write!(
                    out,
                    "<span class=\"key {}\">{}</span> ",
                    series.role.class(),
                    escape(&series.label)
                );
            }
            out.push_str("</p>");
        }
        out.push_str("</figure>");
        out
    }

    /// The SVG alone. Its classes are coloured by the page; without a page the lines are black.
    pub fn to_svg(&self) -> String {
        let points = || self.series.iter().flat_map(|s| s.points.iter());
        let edges = self.bands.iter().flat_map(|b| [b.from, b.to]);
        let stems = self.series.iter().any(|s| s.kind == SeriesKind::Stems);
        let x = Axis::covering(points().map(|p| p.0).chain(edges), LEFT, WIDTH - RIGHT);
        let y = Axis::covering(points().map(|p| p.1).chain(stems.then_some(0.0)), self.height - BOTTOM, TOP);
        let mut out = String::new();
        let _ = write!(
            out,
            "<svg viewBox=\"0 0 {WIDTH} {}\" role=\"img\" aria-label=\"{}\" xmlns=\"http://www.w3.org/2000/svg\">",
            self.height,
            escape(&self.title)
        );
        for band in &self.bands {
            let (from, to) = (x.pixel(band.from), x.pixel(band.to));
            let _ = write!(
                out,
                "<rect class=\"band\" x=\"{from:.1}\" y=\"{TOP}\" width=\"{:.1}\" height=\"{:.1}\"/>",
                (to - from).max(1.0),
                self.height - BOTTOM - TOP
            );
        }
        self.draw_axes(&mut out, &x, &y);
        for series in &self.series {
            draw_series(&mut out, series, &x, &y);
        }
        out.push_str("</svg>");
        out
    }

    fn draw_axes(&self, out: &mut String, x: &Axis, y: &Axis) {
        let floor = self.height - BOTTOM;
        for (value, label) in x.ticks(7) {
            let at = x.pixel(value);
            let _ = write!(
                out,
                "<path class=\"grid\" d=\"M{at:.1} {TOP}V{floor}\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{label}</text>",
                floor + 17.0
            );
        }
        for (value, label) in y.ticks(5) {
            let at = y.pixel(value);
            let _ = write!(
                out,
                "<path class=\"grid\" d=\"M{LEFT} {at:.1}H{}\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>",
                WIDTH - RIGHT,
                LEFT - 6.0,
                at + 4.0
            );
        }
        let _ = write!(
            out,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\" class=\"name\">{}</text>",
            0.5 * (LEFT + WIDTH - RIGHT),
            self.height - 6.0,
            escape(&self.x)
        );
        let middle = 0.5 * (TOP + floor);
        let _ = write!(
            out,
            "<text x=\"19\" y=\"{middle:.1}\" text-anchor=\"middle\" class=\"name\" transform=\"rotate(-90 19 {middle:.1})\">{}</text>",
            escape(&self.y)
        );
    }
}

fn draw_series(out: &mut String, series: &Series, x: &Axis, y: &Axis) {
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
            let few = if series.points.len() <= FEW { " few" } else { "" };
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

/// Where a line has more points than pixels: the lowest and the highest point of each run, in their order.
fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if points.len() <= MOST_POINTS {
        return points.to_vec();
    }
    let run = points.len().div_ceil(MOST_POINTS / 2);
    let mut kept = Vec::with_capacity(MOST_POINTS + 2);
    for chunk in points.chunks(run) {
        let by_y = |a: &usize, b: &usize| chunk[*a].1.total_cmp(&chunk[*b].1);
        let low = (0..chunk.len()).min_by(by_y);
        let high = (0..chunk.len()).max_by(by_y);
        if let (Some(low), Some(high)) = (low, high) {
            kept.push(chunk[low.min(high)]);
            if low != high {
                kept.push(chunk[low.max(high)]);
            }
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_line_keeps_its_extremes() {
        let mut points: Vec<(f64, f64)> = (0..100_000).map(|k| (k as f64, (k as f64 * 0.01).sin())).collect();
        points[54_321].1 = 7.0;
        let thin = thinned(&points);
        assert!(thin.len() <= MOST_POINTS + 2);
        assert!(thin.contains(&(54_321.0, 7.0)));
        assert!(thin.windows(2).all(|w| w[0].0 < w[1].0));
    }

    #[test]
    fn a_gap_interrupts_the_line_and_words_are_escaped() {
        let plot = Plot::new("a < b", "x", "y").with(
            "s",
            Role::Measured,
            SeriesKind::Line,
            vec![(0.0, 1.0), (1.0, f64::NAN), (2.0, 1.0)],
        );
        let svg = plot.to_svg();
        assert!(svg.contains("a &lt; b"));
        let line = svg.split("class=\"line").nth(1).expect("one line");
        assert_eq!(line.matches('M').count(), 2);
        assert!(!svg.contains("NaN"));
    }

    #[test]
    fn a_plot_of_nothing_is_still_a_plot() {
        assert!(Plot::new("t", "x", "y").to_html().contains("<svg"));
    }
}
