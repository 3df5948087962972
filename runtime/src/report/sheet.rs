//! A sheet of plots as one SVG file that stands by itself: colours and fonts are in it.

use std::fmt::Write as _;

use super::axis::Axis;
use super::escape::escape;

const LEFT: f64 = 60.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 26.0;
const BOTTOM: f64 = 34.0;

/// Line colours that differ in lightness too, so that they can be told apart in grey print (after Okabe and Ito 2008).
const COLOURS: [&str; 8] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#555555", "#111111"];

/// Points more than this in a line are thinned.
const MOST_POINTS: usize = 900;

/// One plot of a sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// What it shows.
    pub title: String,
    /// Label and points of each line.
    pub lines: Vec<(String, Vec<(f64, f64)>)>,
}

/// Plots side by side and below each other, with one legend.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// Printed on top.
    pub title: String,
    /// Name and unit of all x axes.
    pub x: String,
    /// Panels in a row.
    pub columns: usize,
    /// Width and height of a panel, pixels.
    pub panel: [f64; 2],
    /// The plots, row by row. The k-th line has the same colour in all of them; the first panel's labels are the
    /// legend.
    pub panels: Vec<Panel>,
}

impl Sheet {
    /// The file.
    pub fn to_svg(&self) -> String {
        let columns = self.columns.max(1);
        let rows = self.panels.len().div_ceil(columns);
        let [w, h] = self.panel;
        let (width, height) = (w * columns as f64, h * rows as f64 + 56.0);
        let mut out = String::new();
        let _ = writeln!(
            out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
             height=\"{height}\" font-family=\"sans-serif\" font-size=\"12\" role=\"img\" aria-label=\"{0}\">\
             <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\
             <text x=\"12\" y=\"20\" font-size=\"14\" font-weight=\"bold\">{0}</text>",
            escape(&self.title)
        );
        let mut x = 12.0;
        for (k, (label, _)) in self.panels.first().map_or(&[][..], |p| &p.lines).iter().enumerate() {
            let colour = COLOURS[k % COLOURS.len()];
            let _ = writeln!(
                out,
                "<path d=\"M{x} 38h22\" stroke=\"{colour}\" stroke-width=\"3\"/><text x=\"{}\" y=\"42\">{}</text>",
                x + 28.0,
                escape(label)
            );
            x += 46.0 + 7.0 * label.chars().count() as f64;
        }
        for (k, panel) in self.panels.iter().enumerate() {
            let (left, top) = (w * (k % columns) as f64, 52.0 + h * (k / columns) as f64);
            let _ = writeln!(out, "<g transform=\"translate({left} {top})\">");
            self.draw(panel, &mut out);
            out.push_str("</g>\n");
        }
        out.push_str("</svg>\n");
        out
    }

    fn draw(&self, panel: &Panel, out: &mut String) {
        let [w, h] = self.panel;
        let points = || panel.lines.iter().flat_map(|(_, points)| points);
        let x = Axis::covering(points().map(|p| p.0), LEFT, w - RIGHT);
        let y = Axis::covering(points().map(|p| p.1), h - BOTTOM, TOP);
        let _ =
            writeln!(out, "<text x=\"{LEFT}\" y=\"18\" font-weight=\"bold\">{}</text>", escape(&panel.title));
        for (value, label) in x.ticks(6) {
            let at = x.pixel(value);
            let _ = writeln!(
                out,
                "<path d=\"M{at:.1} {TOP}V{}\" stroke=\"#dddddd\"/><text x=\"{at:.1}\" y=\"{}\" \
                 text-anchor=\"middle\">{label}</text>",
                h - BOTTOM,
                h - BOTTOM + 15.0
            );
        }
        for (value, label) in y.ticks(6) {
            let at = y.pixel(value);
            let _ = writeln!(
                out,
                "<path d=\"M{LEFT} {at:.1}H{}\" stroke=\"#dddddd\"/><text x=\"{}\" y=\"{:.1}\" \
                 text-anchor=\"end\">{label}</text>",
                w - RIGHT,
                LEFT - 5.0,
                at + 4.0
            );
        }
        let _ = writeln!(
            out,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\" fill=\"#555555\">{}</text>",
            0.5 * (LEFT + w - RIGHT),
            h - 4.0,
            escape(&self.x)
        );
        for (k, (_, points)) in panel.lines.iter().enumerate() {
            let step = points.len().div_ceil(MOST_POINTS).max(1);
            let mut path = String::new();
            for (px, py) in points.iter().step_by(step).filter(|p| p.0.is_finite() && p.1.is_finite()) {
                let command = if path.is_empty() { 'M' } else { 'L' };
                let _ = write!(path, "{command}{:.1} {:.1}", x.pixel(*px), y.pixel(*py));
            }
            let colour = COLOURS[k % COLOURS.len()];
            let _ =
                writeln!(out, "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.3\"/>");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_of_every_panel_is_drawn_and_text_is_escaped() {
        let line = |a: f64| (0..5000).map(|k| (k as f64, a * k as f64)).collect::<Vec<_>>();
        let panel = |title: &str| Panel {
            title: title.to_string(),
            lines: vec![("a < b".to_string(), line(1.0)), ("c".to_string(), line(-1.0))],
        };
        let panels = vec![panel("one"), panel("two"), panel("three & four")];
        let sheet =
            Sheet { title: "t".into(), x: "time, s".into(), columns: 2, panel: [400.0, 200.0], panels };
        let svg = sheet.to_svg();
        assert_eq!(svg.matches("stroke-width=\"1.3\"").count(), 6);
        assert!(svg.contains("a &lt; b") && svg.contains("three &amp; four"));
        assert!(svg.len() < 200_000, "{}", svg.len());
    }
}
