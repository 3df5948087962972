//! The report of `validate`: what a model predicts of a recording.

use dynid_runtime::model_file::Identified;
use dynid_runtime::report::{Page, percent};

use super::parameters::{parameters, relations};
use super::provenance::provenance;
use super::residuals::residuals;
use super::torques::{per_joint, torques};
use crate::compared::Compared;
use crate::provenance::Provenance;
use crate::words::joint_number;

/// The whole page. `notes` are sentences about the rows and the model.
pub fn page(
    heading: &str,
    model: &Identified,
    compared: Compared<'_>,
    notes: &[String],
    from: &Provenance,
) -> String {
    let mut page = Page::new(heading);
    page.verdict(&verdict(compared));
    page.list(notes);
    page.table(&["joint", "relative error"], &per_joint(compared));
    page.details("The parameters of the model", |page| {
        parameters(page, compared.robot, &model.base_parameters, None);
        relations(page, compared.robot);
    });
    page.heading("Torques, measured and predicted");
    torques(&mut page, compared);
    page.heading("What the model leaves");
    residuals(&mut page, compared);
    provenance(&mut page, from);
    page.to_html()
}

fn verdict(compared: Compared<'_>) -> String {
    let Some(prediction) = compared.evaluation.predictions.last() else { return String::new() };
    let errors = &prediction.errors;
    let known = errors.per_joint.iter().enumerate().filter_map(|(joint, error)| Some((joint, (*error)?)));
    let worst = known.max_by(|a, b| a.1.total_cmp(&b.1)).map_or_else(String::new, |(joint, error)| {
        format!(" The worst joint is {} with {}.", joint_number(compared.robot, joint), percent(error))
    });
    format!("The torques are predicted with a relative error of {}.{worst}", percent(errors.relative_error))
}
