//! One law on its way to the shape with which least is left.
//!
//! A search by steps along the numbers of a shape stops in a narrow valley that lies across them, as where a longer play
//! with a stiffer spring tells nearly the same. From there Gauss-Newton steps go on, all linear parameters and the numbers
//! of the shape together (variable projection; Golub and Pereyra 1973, Kaufman 1975). What stays is projected out of the
//! law's columns and their derivatives, and factored once.

use crate::diagnosis::candidates::trial::{Sparse, Trial, columns};
use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::fit::Fit;
use crate::diagnosis::rules::{
    HALVINGS, LEAST_FALL, LONGEST_STEP, MOST_STEPS, OWN_FRACTION_OF_DERIVATIVE, SHAPE_STEP,
};
use crate::diagnosis::search::extended_model::ExtendedModel;
use crate::diagnosis::search::tangents::weights;
use crate::diagnosis::search::term::Accepted;
use crate::effects::{ShapeSearch, Step};
use std::borrow::Cow;

/// A law with a shape, and what is left with it.
pub(in crate::diagnosis) struct Tuning<'a> {
    model: &'a ExtendedModel<'a>,
    search: ShapeSearch,
    term: Accepted,
    /// Its columns on the rows.
    columns: Vec<Sparse>,
    /// The rows without the law, and the fit to them.
    rest: Cow<'a, Design>,
    fit: Cow<'a, Fit>,
    /// Amplitudes of the columns, where they are not fixed, and the squares that the law takes from what that fit leaves, in
    /// units of the joints' noise.
    amplitude: Vec<f64>,
    gain: f64,
}

impl<'a> Tuning<'a> {
    /// Law k of the model, as it is there.
    ///
    /// # Errors
    /// [`SingularDesign`] where the model has no fit without it.
    pub fn within(model: &'a ExtendedModel<'a>, k: usize) -> Result<Self, SingularDesign> {
        let term = &model.terms[k];
        let side = model.regression(term.effect.properties().window);
        let mut rest = side.design.clone();
        let places = side.term_columns[k].clone();
        if let Some(a) = term.fixed {
            for column in model.columns_of(&rest, term) {
                rest.y.iter_mut().zip(&column).for_each(|(y, c)| *y += a * c);
            }
        }
        places.clone().for_each(|place| rest.columns[place].fill(0.0));
        // Nothing but y changes where no column is the law's.
        rest.refresh_from(if places.is_empty() { rest.columns.len() } else { places.start });
        let fit = Fit::whole(&rest, &side.sigma)?;
        Ok(Self::new(model, term, Cow::Owned(rest), Cow::Owned(fit)))
    }

    /// A law that is not in the model, beside those that are.
    pub fn beside(model: &'a ExtendedModel<'a>, term: &Accepted) -> Self {
        let side = model.regression(term.effect.properties().window);
        Self::new(model, term, Cow::Borrowed(&side.design), Cow::Borrowed(&side.fit))
    }

    fn new(model: &'a ExtendedModel<'a>, term: &Accepted, rest: Cow<'a, Design>, fit: Cow<'a, Fit>) -> Self {
        let (form, scales) = (term.effect.form(), &model.context.scales);
        let grid = form.shapes(term.place, scales);
        let grid: Vec<&[f64]> = grid.iter().map(Vec::as_slice).collect();
        let search = form.shape_search_of(term.place, scales, &grid, &term.shape);
        let (term, columns, amplitude) = (term.clone(), Vec::new(), Vec::new());
        let mut tuning = Self { model, search, term, columns, rest, fit, amplitude, gain: 0.0 };
        tuning.columns = tuning.columns_of(&tuning.term.shape);
        (tuning.amplitude, tuning.gain) = tuning.solved(&[]).unwrap_or_default();
        tuning
    }

    /// Moves the shape to where least is left, or to where a step has no fit.
    pub fn run(&mut self) {
        for _ in 0..MOST_STEPS {
            let before = self.squares();
            let went = self.step().unwrap_or(false);
            if !went || before - self.squares() < LEAST_FALL * before {
                break;
            }
        }
    }

    /// The shape.
    pub fn shape(&self) -> &[f64] {
        &self.term.shape
    }

    /// Squares that are left, in units of the joints' noise.
    pub fn squares(&self) -> f64 {
        self.fit.weighted_squares(&self.rest) - self.gain
    }

    /// Goes as far along the direction of Gauss and Newton as less is left; says whether it went, `None` where there is none.
    fn step(&mut self) -> Option<bool> {
        let direction = self.direction()?;
        for halvings in 0..HALVINGS {
            let part = 0.5_f64.powi(halvings);
            let shape = self.moved(direction.iter().map(|(i, change)| (*i, part * change)));
            if shape == self.term.shape {
                return Some(false);
            }
            let there = self.columns_of(&shape);
            let here = std::mem::replace(&mut self.columns, there);
            match self.solved(&[]) {
                Some((amplitude, gain)) if gain > self.gain => {
                    (self.term.shape, self.amplitude, self.gain) = (shape, amplitude, gain);
                    return Some(true);
                }
                _ => self.columns = here,
            }
        }
        Some(false)
    }

    /// How each number of the shape changes to where the derivatives of the torques have nothing left; numbers that would
    /// leave their bounds stay there.
    fn direction(&self) -> Option<Vec<(usize, f64)>> {
        let mut free = self.slopes();
        loop {
            let slopes: Vec<&Sparse> = free.iter().map(|(_, slope)| slope).collect();
            let changes = self.solved(&slopes)?.0.split_off(self.amplitude.len());
            let direction: Vec<(usize, f64)> = free.iter().map(|(i, _)| *i).zip(changes).collect();
            let leaving: Vec<usize> =
                direction.iter().filter(|d| !self.moves(d.0, d.1)).map(|d| d.0).collect();
            if leaving.is_empty() {
                return Some(direction);
            }
            free.retain(|(i, _)| !leaving.contains(i));
        }
    }

    /// Derivatives of the law's torque by the numbers of its shape that can change, by differences, each with its place in the
    /// shape.
    fn slopes(&self) -> Vec<(usize, Sparse)> {
        let can_change =
            |i: usize, by: f64| self.search.varies(i) && (self.moves(i, by) || self.moves(i, -by));
        let weights = weights(&self.term, &self.amplitude);
        let steps = self.term.shape.iter().map(|x| SHAPE_STEP * x.abs().max(1e-6)).enumerate();
        let of_number = |(i, step): (usize, f64)| {
            let mut shape = self.term.shape.clone();
            shape[i] += step;
            let there = self.columns_of(&shape);
            let mut slope: Sparse = Vec::new();
            for ((there, here), weight) in there.iter().zip(&self.columns).zip(&weights) {
                let weight = weight / step;
                for (n, ((joint, there), (_, here))) in there.iter().zip(here).enumerate() {
                    let change = there.iter().zip(here).map(|(there, here)| weight * (there - here));
                    match slope.get_mut(n) {
                        Some((_, sum)) => sum.iter_mut().zip(change).for_each(|(sum, c)| *sum += c),
                        None => slope.push((*joint, change.collect())),
                    }
                }
            }
            (i, slope)
        };
        steps.filter(|(i, step)| can_change(*i, *step)).map(of_number).collect()
    }

    /// Amplitudes of the law's columns, where they are not fixed, and of columns beside them; and the squares that all take away.
    fn solved(&self, beside: &[&Sparse]) -> Option<(Vec<f64>, f64)> {
        let all = self.columns.iter().chain(beside.iter().copied()).cloned();
        let mut trial = Trial::new(&self.rest, self.term.shape.clone(), all.collect());
        (trial.needed, trial.own_fraction) = (0, OWN_FRACTION_OF_DERIVATIVE);
        let part = self.fit.project_out(&trial)?;
        let fixed = self.term.fixed.map_or_else(Vec::new, |a| vec![a; self.columns.len()]);
        let (solution, gain) = part.solve_beside(&fixed)?;
        Some((solution.as_slice().to_vec(), gain))
    }

    /// Whether a change of one number of the shape is one.
    fn moves(&self, i: usize, change: f64) -> bool {
        self.moved(std::iter::once((i, change)))[i] != self.term.shape[i]
    }

    /// The shape after a change of its numbers; one that is varied by factors is multiplied.
    fn moved(&self, along: impl Iterator<Item = (usize, f64)>) -> Vec<f64> {
        let mut shape = self.term.shape.clone();
        for (i, change) in along {
            let moved = match self.search.steps.get(i) {
                Some(Step::Times(_)) if shape[i] == 0.0 => 0.0,
                Some(Step::Times(_)) => {
                    shape[i] * (change / shape[i]).clamp(-LONGEST_STEP, LONGEST_STEP).exp()
                }
                Some(Step::Add(_)) => (shape[i] + change).max(0.0),
                _ => shape[i] + change,
            };
            let [low, high] =
                self.search.bounds.get(i).copied().unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
            shape[i] = moved.clamp(low, high);
        }
        shape
    }

    /// The columns of a shape of the law.
    fn columns_of(&self, shape: &[f64]) -> Vec<Sparse> {
        let Accepted { effect, place, .. } = self.term;
        columns(&self.model.context, &self.rest, effect, place, shape, self.model.change)
    }
}
