//! A picture of a page as a file by itself.

/// The colours that a page gives its pictures, in daylight.
const STYLE: &str = "text{font:11px sans-serif;fill:#5c6475}text.name{font-size:12px;fill:#1d2330}\
    .grid{stroke:#d9dde5;fill:none}.band{fill:#f6e3b4;opacity:.7}.line{stroke-width:1.3;stroke-linejoin:round}\
    .dots{stroke-width:3;opacity:.55}.dots.few{stroke-width:6;opacity:.9}.law{stroke-width:2.4}\
    .measured{color:#8a93a6}.before{color:#d9730d}.after{color:#1f6feb}.law{color:#c4314b}\
    .aside{color:#6b7280;stroke-dasharray:5 4}";

/// An SVG that has its colours from a page, with them in it.
pub fn alone(svg: &str) -> String {
    let Some((head, rest)) = svg.split_once('>') else { return svg.to_owned() };
    format!("{head}><style>{STYLE}</style><rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>{rest}\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{Plot, Role, SeriesKind};

    #[test]
    fn a_picture_by_itself_has_a_style_for_each_of_its_classes() {
        let points = vec![(0.0, 1.0), (1.0, 2.0)];
        let plot = Plot::new("a", "x", "y").with("b", Role::Law, SeriesKind::Line, points);
        let file = alone(&plot.to_svg());
        assert!(file.starts_with("<svg ") && file.matches("<svg").count() == 1);
        for class in ["line", "law", "grid", "name"] {
            assert!(
                file.contains(&format!("class=\"{class}")) || file.contains(&format!(" {class}\"")),
                "{class}"
            );
            assert!(file.contains(&format!(".{class}{{")), "{class}");
        }
    }
}
