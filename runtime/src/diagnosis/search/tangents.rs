//! How the torque of a law moves with the numbers of its shape, and with the parameters of the robot.

use crate::diagnosis::candidates::trial::dense_columns;
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rules::SHAPE_STEP;
use crate::diagnosis::search::extended_model::ExtendedModel;
use crate::diagnosis::search::term::Accepted;
use crate::parallel;

/// Derivatives of a term's torque on the rows of a design by the numbers of its shape that are estimated, by central
/// differences; each with its place in the shape. What changes nothing is left out.
pub(in crate::diagnosis) fn tangents(
    model: &ExtendedModel<'_>,
    design: &Design,
    term: &Accepted,
    amplitude: &[f64],
) -> Vec<(usize, Vec<f64>)> {
    let form = term.effect.form();
    let search = form.shape_search(term.place, &model.context.scales, &[]);
    // What the search does not vary chooses between forms of the law, and is no estimate. The shape of a sensitivity is
    // its amplitude once more.
    let estimated = |i: usize| !form.shape_is_amplitude() && search.varies(i);
    let weights = weights(term, amplitude);
    let along = |i: usize| {
        let step = SHAPE_STEP * term.shape[i].abs().max(1e-6);
        let moved = |by: f64| {
            let mut shape = term.shape.clone();
            shape[i] += by;
            model.columns_of(design, &Accepted { shape, ..term.clone() })
        };
        let mut slope = vec![0.0; design.rows.len()];
        for ((plus, minus), a) in moved(step).iter().zip(&moved(-step)).zip(&weights) {
            for ((s, p), m) in slope.iter_mut().zip(plus).zip(minus) {
                *s += a * (p - m) / (2.0 * step);
            }
        }
        (i, slope)
    };
    let all = (0..term.shape.len()).filter(|&i| estimated(i)).map(along);
    all.filter(|(_, slope)| slope.iter().any(|x| *x != 0.0)).collect()
}

/// What the columns of a term are multiplied by.
pub(super) fn weights(term: &Accepted, amplitude: &[f64]) -> Vec<f64> {
    term.fixed.map_or_else(|| amplitude.to_vec(), |fixed| vec![fixed])
}

/// What the torque of a term with an inner state moves by where this is off by one at the beginning of a motion, on the rows of a
/// design: one column for each motion; none for other terms.
pub(in crate::diagnosis) fn along_starts(
    model: &ExtendedModel<'_>,
    design: &Design,
    term: &Accepted,
) -> Vec<Vec<f64>> {
    if !term.effect.form().has_memory() {
        return Vec::new();
    }
    let here = model.columns_of(design, term);
    let mut moved = model.context.clone();
    moved.off_at_start = 1.0;
    let there = dense_columns(&moved, design, term.effect, term.place, &term.shape, model.change);
    let of_motion = |k: usize| {
        let moved = here.iter().zip(&there).map(move |(here, there)| {
            let row = |(r, (here, there)): (usize, (&f64, &f64))| {
                if design.rows[r].signal == k { there - here } else { 0.0 }
            };
            here.iter().zip(there).enumerate().map(row).collect::<Vec<f64>>()
        });
        moved.filter(|column| column.iter().any(|x| *x != 0.0)).collect::<Vec<_>>()
    };
    (0..model.context.signals.len()).flat_map(of_motion).collect()
}

/// Derivatives of a term's torque on the rows of a regression by the base parameters, where its columns are made of
/// these: the load of a gear, a torque that is heard. Differences over one standard deviation of each parameter, as far as
/// it may be off; each with the place of the parameter.
pub(in crate::diagnosis) fn along_parameters(
    model: &ExtendedModel<'_>,
    Regression { design, fit, .. }: &Regression,
    term: &Accepted,
    amplitude: &[f64],
) -> Vec<(usize, Vec<f64>)> {
    // A curve over torques bends where they are: a deviation of a parameter moves along it what it is fitted to anyway.
    if !term.effect.properties().follows_parameters || term.effect.form().is_curve() {
        return Vec::new();
    }
    let deviations = fit.variances().map(|v| v.max(0.0).sqrt());
    let weights = weights(term, amplitude);
    let torque = |context: &Context<'_>| {
        let columns = dense_columns(context, design, term.effect, term.place, &term.shape, model.change);
        let mut sum = vec![0.0; design.rows.len()];
        for (column, a) in columns.iter().zip(&weights) {
            sum.iter_mut().zip(column).for_each(|(sum, c)| *sum += a * c);
        }
        sum
    };
    let here = torque(&model.context);
    let along = |i: usize| {
        let (mut chi, mut moved) = (model.context.chi.clone(), model.context.clone());
        chi[i] += deviations[i];
        moved.update(chi);
        let mut slope = torque(&moved);
        slope.iter_mut().zip(&here).for_each(|(there, here)| *there = (*there - here) / deviations[i]);
        (i, slope)
    };
    let known: Vec<usize> = (0..design.parameters).filter(|&i| deviations[i] > 0.0).collect();
    parallel::map(model.context.threads, known.len(), |k| along(known[k]))
}
