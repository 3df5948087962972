//! One self-contained HTML page: opens from disk, reads on a phone, prints. A page with pictures has a script with which
//! a reader explores them; without it the page is the same to read.

use std::fmt::Write as _;

use super::escape::escape;
use super::plot::Plot;

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = concat!(include_str!("picture.js"), include_str!("hand.js"));

/// A page that grows from top to bottom. Every text given to it is escaped.
#[derive(Debug, Clone)]
pub struct Page {
    title: String,
    body: String,
    has_pictures: bool,
}

impl Page {
    /// An empty page.
    pub fn new(title: &str) -> Self {
        let title = escape(title);
        Self { body: format!("<h1>{title}</h1>"), title, has_pictures: false }
    }

    /// The sentence that a reader in a hurry must see.
    pub fn verdict(&mut self, text: &str) -> &mut Self {
        self.element("p class=\"verdict\"", "p", text)
    }

    /// A section heading.
    pub fn heading(&mut self, text: &str) -> &mut Self {
        self.element("h2", "h2", text)
    }

    /// A heading inside a section.
    pub fn subheading(&mut self, text: &str) -> &mut Self {
        self.element("h3", "h3", text)
    }

    /// A paragraph.
    pub fn paragraph(&mut self, text: &str) -> &mut Self {
        self.element("p", "p", text)
    }

    /// A paragraph of small print.
    pub fn note(&mut self, text: &str) -> &mut Self {
        self.element("p class=\"note\"", "p", text)
    }

    /// Words that are meant to the letter, such as a command.
    pub fn literal(&mut self, text: &str) -> &mut Self {
        let _ = write!(self.body, "<p><code>{}</code></p>", escape(text));
        self
    }

    /// A plot.
    pub fn plot(&mut self, plot: &Plot) -> &mut Self {
        self.body.push_str(&plot.to_html());
        self.has_pictures = true;
        self
    }

    /// A list of sentences; nothing where there are none.
    pub fn list<S: AsRef<str>>(&mut self, items: impl IntoIterator<Item = S>) -> &mut Self {
        let before = self.body.len();
        for item in items {
            self.element("li", "li", item.as_ref());
        }
        if self.body.len() > before {
            self.body.insert_str(before, "<ul>");
            self.body.push_str("</ul>");
        }
        self
    }

    /// A table. The first column and those whose header starts with `<` hold words, the others numbers.
    pub fn table<S: AsRef<str>>(&mut self, header: &[S], rows: &[Vec<String>]) -> &mut Self {
        self.body.push_str("<div class=\"wide\"><table><thead><tr>");
        let words = |k: usize| k == 0 || header.get(k).is_some_and(|h| h.as_ref().starts_with('<'));
        for (k, cell) in header.iter().enumerate() {
            let open = if words(k) { "th class=\"words\"" } else { "th" };
            self.element(open, "th", cell.as_ref().trim_start_matches('<'));
        }
        self.body.push_str("</tr></thead><tbody>");
        for row in rows {
            self.body.push_str("<tr>");
            for (k, cell) in row.iter().enumerate() {
                self.element(if words(k) { "td class=\"words\"" } else { "td" }, "td", cell);
            }
            self.body.push_str("</tr>");
        }
        self.body.push_str("</tbody></table></div>");
        self
    }

    /// A part that is closed until the reader opens it (and open in print).
    pub fn details(&mut self, summary: &str, fill: impl FnOnce(&mut Self)) -> &mut Self {
        let _ = write!(self.body, "<details><summary>{}</summary>", escape(summary));
        fill(self);
        self.body.push_str("</details>");
        self
    }

    /// The whole document.
    pub fn to_html(&self) -> String {
        let script = if self.has_pictures { format!("<script>\n{SCRIPT}</script>\n") } else { String::new() };
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>{}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>{}</main>\n{script}</body>\n</html>\n",
            self.title, self.body
        )
    }

    fn element(&mut self, open: &str, close: &str, text: &str) -> &mut Self {
        // A number and its per cent sign stay on one line.
        let text = escape(text).replace(" %", "\u{a0}%");
        let _ = write!(self.body, "<{open}>{text}</{close}>");
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{Role, SeriesKind};

    #[test]
    fn a_page_needs_nothing_from_elsewhere() {
        let mut page = Page::new("tx40 <b>");
        page.verdict("done").table(&["joint", "error"], &[vec!["1".into(), "2 %".into()]]);
        assert!(!page.to_html().contains("<script"));
        let points = vec![(0.0, 1.0), (1.0, 2.0)];
        page.plot(&Plot::new("</script>", "x", "y").with("a", Role::After, SeriesKind::Line, points));
        let html = page.to_html().replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
        assert!(html.contains("tx40 &lt;b&gt;"));
        assert_eq!((html.matches("<script").count(), html.matches("</script>").count()), (2, 2));
        for outside in ["http:", "https:", "src=", "href=", "@import", "url(\"", "fetch(", "import("] {
            assert!(!html.contains(outside), "{outside}");
        }
    }
}
