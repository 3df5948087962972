//! The quantities of an accepted effect that a person knows, with their uncertainty.

use crate::diagnosis::candidates::candidate::smoothing_window;
use crate::diagnosis::candidates::trial::dense_columns;
use crate::diagnosis::rows::fit::{Fit, SingularDesign};
use crate::diagnosis::search::extended_model::ExtendedModel;
use crate::diagnosis::search::term::Accepted;
use crate::effects::{EffectKind, Form, Lump, Parameter, Place};

/// Standard deviations of amplitudes and shape parameters, estimated together: shape parameters enter through the
/// derivative of the columns (variable projection, Golub and Pereyra 1973).
pub(in crate::diagnosis) fn uncertainty(
    model: &ExtendedModel<'_>,
    k: usize,
    amplitude: &[f64],
) -> Result<(Vec<f64>, Vec<f64>), SingularDesign> {
    let term = &model.terms[k];
    let side = model.regression(smoothing_window(term.effect));
    let mut design = side.design.clone();
    let dense = |shape: &[f64]| {
        dense_columns(&model.context, &side.design, term.effect, term.place, shape, model.change)
    };
    let start = design.columns.len();
    let mut varied = Vec::new();
    // The shape of a sensitivity is its amplitude once more.
    let own_shape = !matches!(term.effect.form(), Form::Sensitivity(_));
    for (i, &value) in term.shape.iter().enumerate().filter(|_| own_shape) {
        let step = 0.02 * value.abs().max(1e-6);
        let moved = |s: f64| {
            let mut shape = term.shape.clone();
            shape[i] += s * step;
            dense(&shape)
        };
        let (plus, minus) = (moved(1.0), moved(-1.0));
        let weights: Vec<f64> = if term.fixed.is_some() { vec![1.0] } else { amplitude.to_vec() };
        let mut slope = vec![0.0; design.rows.len()];
        for ((p, m), a) in plus.iter().zip(&minus).zip(&weights) {
            for ((s, p), m) in slope.iter_mut().zip(p).zip(m) {
                *s += a * (p - m) / (2.0 * step);
            }
        }
        if slope.iter().any(|x| *x != 0.0) {
            design.push(slope);
            varied.push(i);
        }
    }
    design.refresh_from(start);
    let fit = Fit::whole(&design, &side.sigma)?;
    let variances = fit.variances();
    let sd = |c: usize| variances[c].max(0.0).sqrt();
    let amplitudes = side.term_columns[k].clone().map(sd).collect();
    let mut shapes = vec![0.0; term.shape.len()];
    for (at, &i) in varied.iter().enumerate() {
        shapes[i] = sd(start + at).min(10.0 * term.shape[i].abs());
    }
    Ok((amplitudes, shapes))
}

/// The quantities a person knows, with the uncertainty of shapes propagated to first order.
pub(in crate::diagnosis) fn parameters(
    model: &ExtendedModel<'_>,
    term: &Accepted,
    amplitude: &mut Vec<f64>,
    sigma: &mut Vec<f64>,
    shape_sigma: &[f64],
) -> Vec<Parameter> {
    let robot = model.context.model.robot();
    let context = &model.context;
    match (term.effect.form(), term.place) {
        (Form::Joint(law), Place::Joint(j)) => {
            let of = |shape: &[f64]| law.parameters(&context.scales[j], shape, amplitude, sigma);
            propagate(of, &term.shape, shape_sigma)
        }
        (Form::Compliance(law), Place::Joint(j)) => {
            let of = |shape: &[f64]| {
                law.describe(&context.transmission(j, shape))
                    .into_iter()
                    .map(|(name, value, unit)| Parameter::new(name, value, 0.0, unit))
                    .collect()
            };
            let t = context.transmission(j, &term.shape);
            *amplitude = vec![t.stiffness, t.damping, t.rotor, t.play];
            *sigma = vec![0.0; 4];
            propagate(of, &term.shape, shape_sigma)
        }
        (Form::Sensitivity(law), Place::Variant(v)) => {
            let variants = law.variants(robot);
            let wanted = if law.together() { &variants[..] } else { &variants[v..=v] };
            wanted
                .iter()
                .zip(amplitude.iter().zip(sigma.iter()))
                .map(|(x, (a, s))| match term.effect {
                    // Along the way to it a factor grows exponentially.
                    EffectKind::WrongSampleRate => Parameter::new(x.name, a.exp_m1(), s * a.exp(), x.unit),
                    _ => Parameter::new(x.name, *a, *s, x.unit),
                })
                .collect()
        }
        (Form::Body(_), _) => {
            let slack = 3.0 * sigma.iter().take(6).fold(0.0_f64, |a, b| a.max(*b));
            let lump = Lump::from_parameters(amplitude, slack);
            let s = |k: usize| sigma.get(k).copied().unwrap_or(0.0);
            let m = lump.mass.abs().max(1e-9);
            vec![
                Parameter::new("mass", lump.mass, s(9), "kg"),
                Parameter::new("x", lump.centre[0], s(6) / m, "m"),
                Parameter::new("y", lump.centre[1], s(7) / m, "m"),
                Parameter::new("z", lump.centre[2], s(8) / m, "m"),
                Parameter::new("I1", lump.principal[0], s(0), "kg.m2"),
                Parameter::new("I2", lump.principal[1], s(3), "kg.m2"),
                Parameter::new("I3", lump.principal[2], s(5), "kg.m2"),
                Parameter::new("physically_consistent", f64::from(lump.consistent), 0.0, "1"),
            ]
        }
        (Form::Coupled, _) => {
            let names = [("viscous", "N.m.s/rad"), ("coulomb", "N.m"), ("inertia", "kg.m2")];
            let mut list: Vec<Parameter> = names
                .iter()
                .zip(amplitude.iter().zip(sigma.iter()))
                .map(|((name, unit), (a, s))| Parameter::new(name, *a, *s, unit))
                .collect();
            list.push(Parameter::new("ratio", term.shape[0], shape_sigma[0], "1"));
            list
        }
        _ => Vec::new(),
    }
}

fn propagate(of: impl Fn(&[f64]) -> Vec<Parameter>, shape: &[f64], shape_sigma: &[f64]) -> Vec<Parameter> {
    let mut list = of(shape);
    for (i, &s) in shape_sigma.iter().enumerate() {
        if s == 0.0 {
            continue;
        }
        let step = 1e-4 * shape[i].abs().max(1e-9);
        let mut moved = shape.to_vec();
        moved[i] += step;
        for (p, q) in list.iter_mut().zip(of(&moved)) {
            p.sigma = p.sigma.hypot((q.value - p.value) / step * s);
        }
    }
    list
}
