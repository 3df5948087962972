//! `fleet.html`: what a service team reads first.

use crate::{Series, Watched};

/// One self-contained page: the worst robot first.
///
/// `links` gives the address of a robot's own report, where it has one.
pub fn page(_series: &[Series], _watched: &Watched, _links: &dyn Fn(&str) -> Option<String>) -> String {
    String::new()
}
