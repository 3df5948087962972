//! Where a page comes from, at its end.

use dynid_runtime::report::Page;

use crate::provenance::Provenance;

/// The program, the command line, the files with their fingerprints, and when they were recorded where they say so.
pub(super) fn provenance(page: &mut Page, from: &Provenance) {
    page.heading("Where this page comes from");
    let version = env!("CARGO_PKG_VERSION");
    match from.command() {
        Some(command) => {
            page.paragraph(&format!(
                "dynid {version}. The same files and the same words make the same page:"
            ));
            page.literal(&command);
        }
        None => {
            page.paragraph(&format!("dynid {version}."));
        }
    }
    for (name, begun) in &from.recorded {
        page.paragraph(&format!("{name} begins at {begun} by the header stamps of its messages."));
    }
    if !from.files.is_empty() {
        let rows: Vec<Vec<String>> = from
            .files
            .iter()
            .map(|file| vec![file.name.clone(), file.size.to_string(), file.sha256.clone()])
            .collect();
        page.table(&["file", "bytes", "<sha256"], &rows);
    }
}
