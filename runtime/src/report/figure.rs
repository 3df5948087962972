//! A plot in a page: its SVG, its legend, and its samples for the script.

use std::fmt::Write as _;

use super::escape::escape;
use super::plot::Plot;
use super::samples::samples;
use super::series::SeriesKind;

impl Plot {
    /// A `figure` element with an inline SVG, a legend, and the samples for the script of a page. Points that are not
    /// finite are not drawn.
    pub fn to_html(&self) -> String {
        let mut out = String::new();
        let _ = write!(out, "<figure><figcaption>{}</figcaption>", escape(&self.title));
        out.push_str(&self.to_svg());
        if self.series.len() > 1 {
            out.push_str("<p class=\"legend\">");
            for series in self.series.iter().filter(|s| !s.label.is_empty()) {
                let dots = if series.kind == SeriesKind::Points { " dots" } else { "" };
                let _ = write!(
                    out,
                    "<span class=\"key {}{dots}\">{}</span> ",
                    series.role.class(),
                    escape(&series.label)
                );
            }
            out.push_str("</p>");
        }
        // Text in a script element ends at the first tag.
        let samples = samples(self).to_string().replace('<', "\\u003c");
        let _ = write!(out, "<script type=\"application/json\">{samples}</script></figure>");
        out
    }
}
