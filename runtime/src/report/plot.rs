//! Plots as inline SVG: no script, no font and no file from elsewhere.

use std::fmt::Write as _;

use super::axis::Axis;
use super::escape::escape;
use super::series::{Band, Role, Series, SeriesKind, draw_series};

const WIDTH: f64 = 720.0;
const LEFT: f64 = 84.0;
const RIGHT: f64 = 12.0;
const TOP: f64 = 10.0;
const BOTTOM: f64 = 48.0;

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

#[cfg(test)]
mod tests {
    use super::super::series::{MOST_POINTS, thinned};
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
