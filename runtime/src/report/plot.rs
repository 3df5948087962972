//! Plots as inline SVG: no font and no file from elsewhere. The samples beside them are for the script of a page; without
//! it a plot is whole.

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
    /// The same curves over other variables, one of which the reader chooses.
    pub over: Vec<Over>,
}

/// The curves of a plot over another variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Over {
    /// Name and unit of x.
    pub x: String,
    /// The points of each series, in their order.
    pub points: Vec<Vec<(f64, f64)>>,
}

impl Plot {
    /// Name of a time axis. Those of a page show the same interval.
    pub const TIME: &str = "time, s";

    /// An empty plot.
    pub fn new(title: impl Into<String>, x: impl Into<String>, y: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            x: x.into(),
            y: y.into(),
            height: 260.0,
            series: Vec::new(),
            bands: Vec::new(),
            over: Vec::new(),
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

    /// The plot with its series over one more variable, which a reader may choose; without a script it is drawn as it
    /// stands.
    pub fn over(mut self, x: impl Into<String>, points: Vec<Vec<(f64, f64)>>) -> Self {
        self.over.push(Over { x: x.into(), points });
        self
    }

    /// Name of x in a view: 0 as it is drawn, then over the other variables.
    pub(super) fn name_of_x(&self, view: usize) -> &str {
        view.checked_sub(1).and_then(|v| self.over.get(v)).map_or(&self.x, |over| &over.x)
    }

    /// x and y axis of a view.
    pub(super) fn axes(&self, view: usize) -> [Axis; 2] {
        let over = view.checked_sub(1).and_then(|v| self.over.get(v));
        let points: Vec<&[(f64, f64)]> = match over {
            Some(over) => over.points.iter().map(Vec::as_slice).collect(),
            None => self.series.iter().map(|s| s.points.as_slice()).collect(),
        };
        let each = || points.iter().copied().flatten();
        let edges = self.bands.iter().flat_map(|b| [b.from, b.to]).filter(|_| over.is_none());
        let stems = self.series.iter().any(|s| s.kind == SeriesKind::Stems);
        [
            Axis::covering(each().map(|p| p.0).chain(edges), LEFT, WIDTH - RIGHT),
            Axis::covering(each().map(|p| p.1).chain(stems.then_some(0.0)), self.height - BOTTOM, TOP),
        ]
    }

    /// The SVG alone. Its classes are coloured by the page; without a page the lines are black.
    pub fn to_svg(&self) -> String {
        let [x, y] = self.axes(0);
        let mut out = String::new();
        let _ = write!(
            out,
            "<svg viewBox=\"0 0 {WIDTH} {}\" data-frame=\"{LEFT} {TOP} {} {}\" role=\"img\" aria-label=\"{}\" \
             xmlns=\"http://www.w3.org/2000/svg\"><g class=\"bands\">",
            self.height,
            WIDTH - RIGHT,
            self.height - BOTTOM,
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
        out.push_str("</g>");
        self.draw_axes(&mut out, &x, &y);
        out.push_str("<g class=\"curves\">");
        for series in &self.series {
            draw_series(&mut out, series, &x, &y);
        }
        out.push_str("</g></svg>");
        out
    }

    fn draw_axes(&self, out: &mut String, x: &Axis, y: &Axis) {
        let floor = self.height - BOTTOM;
        out.push_str("<g class=\"ticks x\">");
        for (value, label) in x.ticks(7) {
            let at = x.pixel(value);
            let _ = write!(
                out,
                "<path class=\"grid\" d=\"M{at:.1} {TOP}V{floor}\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{label}</text>",
                floor + 17.0
            );
        }
        out.push_str("</g><g class=\"ticks y\">");
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
            "</g><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\" class=\"name x\">{}</text>",
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
    use super::*;

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
