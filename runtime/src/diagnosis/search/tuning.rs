//! One law on its way to the shape with which least is left.
//!
//! A search by steps along the numbers of a shape stops in a narrow valley that lies across them, as where a longer play
//! with a stiffer spring tells nearly the same. From there Gauss-Newton steps go on, all linear parameters and the numbers
//! of the shape together (variable projection; Golub and Pereyra 1973, Kaufman 1975).

use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::fit::Fit;
use crate::diagnosis::rules::{HALVINGS, LEAST_FALL, LONGEST_STEP, MOST_STEPS};
use crate::diagnosis::search::extended_model::ExtendedModel;
use crate::diagnosis::search::tangents::tangents;
use crate::diagnosis::search::term::Accepted;
use crate::effects::{ShapeSearch, Step};
use std::ops::Range;

/// A law with a shape, and what is left with it.
pub(in crate::diagnosis) struct Tuning<'a> {
    model: &'a ExtendedModel<'a>,
    sigma: &'a [f64],
    search: ShapeSearch,
    term: Accepted,
    /// Its columns on the rows, and where the design has them: nowhere where its amplitude is fixed.
    columns: Vec<Vec<f64>>,
    places: Range<usize>,
    design: Design,
    fit: Fit,
    /// What the fit leaves of all rows, in units of the joints' noise.
    squares: f64,
}

impl<'a> Tuning<'a> {
    /// Law k of the model, as it is there.
    pub fn within(model: &'a ExtendedModel<'a>, k: usize) -> Result<Self, SingularDesign> {
        let term = &model.terms[k];
        let side = model.regression(term.effect.properties().window);
        let columns = model.columns_of(&side.design, term);
        Self::new(model, term, columns, side.design.clone(), side.term_columns[k].clone())
    }

    /// A law that is not in the model, beside those that are.
    pub fn beside(model: &'a ExtendedModel<'a>, term: &Accepted) -> Result<Self, SingularDesign> {
        let mut design = model.regression(term.effect.properties().window).design.clone();
        let first = design.columns.len();
        let columns = model.columns_of(&design, term);
        for column in &columns {
            match term.fixed {
                Some(a) => design.y.iter_mut().zip(column).for_each(|(y, c)| *y -= a * c),
                None => design.push(column.clone()),
            }
        }
        design.refresh_from(first);
        let places = first..design.columns.len();
        Self::new(model, term, columns, design, places)
    }

    fn new(
        model: &'a ExtendedModel<'a>,
        term: &Accepted,
        columns: Vec<Vec<f64>>,
        design: Design,
        places: Range<usize>,
    ) -> Result<Self, SingularDesign> {
        let sigma = &model.regression(term.effect.properties().window).sigma;
        let (form, scales) = (term.effect.form(), &model.context.scales);
        let grid = form.shapes(term.place, scales);
        let grid: Vec<&[f64]> = grid.iter().map(Vec::as_slice).collect();
        let search = form.shape_search(term.place, scales, &grid);
        let fit = Fit::whole(&design, sigma)?;
        let squares = fit.weighted_squares(&design);
        Ok(Self { model, sigma, search, term: term.clone(), columns, places, design, fit, squares })
    }

    /// Moves the shape to where least is left, or to where a step has no fit.
    pub fn run(&mut self) {
        for _ in 0..MOST_STEPS {
            let before = self.squares;
            let went = self.step().unwrap_or(false);
            if !went || before - self.squares < LEAST_FALL * before {
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
        self.squares
    }

    /// Goes as far along the direction of Gauss and Newton as less is left; says whether it went.
    fn step(&mut self) -> Result<bool, SingularDesign> {
        let direction = self.direction()?;
        for halvings in 0..HALVINGS {
            let part = 0.5_f64.powi(halvings);
            let shape = self.moved(direction.iter().map(|(i, change)| (*i, part * change)));
            if shape == self.term.shape {
                return Ok(false);
            }
            let (columns, design) = self.with(&shape);
            let fit = Fit::whole(&design, self.sigma)?;
            let left = fit.weighted_squares(&design);
            if left < self.squares {
                (self.term.shape, self.columns) = (shape, columns);
                (self.design, self.fit, self.squares) = (design, fit, left);
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// How each number of the shape changes to where the derivatives of the torques have nothing left; numbers that would
    /// leave their bounds stay there.
    fn direction(&mut self) -> Result<Vec<(usize, f64)>, SingularDesign> {
        let amplitude: Vec<f64> = self.places.clone().map(|c| self.fit.chi[c]).collect();
        let mut free = tangents(self.model, &self.design, &self.term, &amplitude);
        let start = self.design.columns.len();
        loop {
            self.design.columns.extend(free.iter().map(|(_, slope)| slope.clone()));
            self.design.refresh_from(start);
            let fit = Fit::whole(&self.design, self.sigma);
            self.design.columns.truncate(start);
            self.design.refresh_from(start);
            let chi = fit?.chi;
            let direction: Vec<(usize, f64)> =
                free.iter().enumerate().map(|(n, (i, _))| (*i, chi[start + n])).collect();
            let inside =
                |i: usize, change: f64| self.moved(std::iter::once((i, change)))[i] != self.term.shape[i];
            let leaving: Vec<usize> = direction.iter().filter(|d| !inside(d.0, d.1)).map(|d| d.0).collect();
            if leaving.is_empty() {
                return Ok(direction);
            }
            free.retain(|(i, _)| !leaving.contains(i));
        }
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

    /// The columns of another shape of the law, and the rows with them.
    fn with(&self, shape: &[f64]) -> (Vec<Vec<f64>>, Design) {
        let mut design = self.design.clone();
        let moved = Accepted { shape: shape.to_vec(), ..self.term.clone() };
        let columns = self.model.columns_of(&self.design, &moved);
        if let Some(amplitude) = self.term.fixed {
            for (old, new) in self.columns.iter().zip(&columns) {
                let change = old.iter().zip(new).map(|(old, new)| amplitude * (old - new));
                design.y.iter_mut().zip(change).for_each(|(y, change)| *y += change);
            }
        }
        for (place, new) in self.places.clone().zip(&columns) {
            design.columns[place].clone_from(new);
        }
        // Nothing but y changes where no column is the law's.
        let first = if self.places.is_empty() { design.columns.len() } else { self.places.start };
        design.refresh_from(first);
        (columns, design)
    }
}
