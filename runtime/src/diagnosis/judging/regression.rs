//! The regression of the torques on the standard model's columns and those of accepted effects, on the rows of one
//! smoothing window.

use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::judging::folds::{Fold, folds};
use crate::diagnosis::judging::hull::{Beyond, Curve};
use crate::diagnosis::rows::bent::Bent;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::fit::Fit;
use crate::diagnosis::rows::gram::dot;
use crate::diagnosis::rows::prior::Prior;
use crate::diagnosis::rows::uncovered::Uncovered;
use std::ops::Range;
use std::sync::Arc;

/// Rows and columns with their fit, their folds, and the noise of each joint. What is asked of all four is asked here:
/// to judge a candidate, to predict held-out motion, to tell how sure a gain is (the other files of this room).
#[derive(Clone)]
pub(in crate::diagnosis) struct Regression {
    pub design: Design,
    /// Standard deviation of the residual of each joint, N.m or N.
    pub sigma: Vec<f64>,
    /// Fit to all segments.
    pub fit: Fit,
    pub folds: Vec<Fold>,
    /// What is left of the held-out rows of each fold, joint by joint, squared.
    pub held_out_squares: Vec<Vec<f64>>,
    /// Products of each column with the residual of the fit, `[joint][segment][column]`.
    pub(super) residual_products: Vec<Vec<Vec<f64>>>,
    /// Squares of the residual of each joint in the recording that is diagnosed.
    pub(super) target_squares: Vec<f64>,
    /// Columns of each term; empty where its amplitude is fixed.
    pub term_columns: Vec<Range<usize>>,
    /// Columns of the gains that bodies show.
    pub gains: Range<usize>,
    /// y without any term of fixed amplitude.
    measured: Vec<f64>,
    /// The whole torques of the rows.
    torque: Vec<f64>,
    /// Columns of the base parameters of the robot as it is in its table, where those of the design are others.
    plain: Option<Vec<Vec<f64>>>,
    /// The last of these others.
    pub bent: Option<Bent>,
    /// Columns that are always there: base parameters and nuisances.
    fixed_columns: usize,
    /// What is known of these beforehand.
    known: Option<Arc<Prior>>,
    /// Those of curves among them.
    curves: Vec<Range<usize>>,
    /// Joint and columns of terms that say nothing of values that no motion has passed.
    bounded: Vec<(usize, Range<usize>)>,
    /// Whether such a term says nothing of a row where its motion is held out; empty where there is none. On a single motion
    /// laws are judged beside terms that are fitted to all of it.
    pub(super) beyond: Vec<bool>,
}

/// What is fitted or taken out beside the terms.
pub(in crate::diagnosis) struct Besides {
    /// A torque on all rows that is known.
    pub known: Option<Vec<f64>>,
    /// Columns that are zero within a standard deviation.
    pub gains: Vec<Vec<f64>>,
    pub deviation: f64,
    /// The columns of the base parameters with the terms that are large errors of numbers, where there are any.
    pub bent: Option<Bent>,
}

/// The columns of a term on the rows, and its amplitude where the law leaves none free.
pub(in crate::diagnosis) struct TermColumns {
    pub columns: Arc<Vec<Vec<f64>>>,
    pub fixed: Option<f64>,
    /// Amplitudes at which the columns are derivatives beside bent columns of the base parameters; nothing for other columns.
    pub derived_at: Vec<f64>,
    /// Those of its columns that an error uncovers.
    pub uncovered: Option<Uncovered>,
    /// Whether it is a curve of many numbers.
    pub is_curve: bool,
    /// The joint of a curve that says nothing of values that no motion has passed.
    pub curve_on: Option<usize>,
}

impl Regression {
    /// Without any term; `nuisances` are columns that are always fitted along. Curves among these are `shrunk` already.
    ///
    /// # Errors
    /// [`SingularDesign`] where there is no fit.
    pub fn new(mut design: Design, nuisances: Vec<Vec<f64>>) -> Result<Self, SingularDesign> {
        for column in nuisances {
            design.push(column);
        }
        design.refresh();
        let fit = Fit::weighted(&design, &vec![1.0; design.joints])?;
        let (measured, fixed_columns) = (design.y.clone(), design.columns.len());
        let torque = (0..design.rows.len()).map(|r| design.torque(r)).collect();
        let sigma = fit.sigma.clone();
        let (known, curves) = (design.prior.clone(), design.shrunk.clone());
        let mut regression = Self {
            design,
            sigma,
            fit,
            folds: Vec::new(),
            held_out_squares: Vec::new(),
            residual_products: Vec::new(),
            target_squares: Vec::new(),
            term_columns: Vec::new(),
            gains: fixed_columns..fixed_columns,
            measured,
            torque,
            plain: None,
            bent: None,
            fixed_columns,
            known,
            curves,
            bounded: Vec::new(),
            beyond: Vec::new(),
        };
        regression.hold_out()?;
        Ok(regression)
    }

    /// Puts exactly these terms into the design and fits again; what is held out follows by [`Self::hold_out`].
    ///
    /// # Errors
    /// [`SingularDesign`] where there is no fit.
    pub fn set_terms(&mut self, terms: Vec<TermColumns>, besides: Besides) -> Result<(), SingularDesign> {
        self.design.columns.truncate(self.fixed_columns);
        self.design.y.clone_from(&self.measured);
        let known = besides.known.as_deref().unwrap_or_default();
        self.design.y.iter_mut().zip(known).for_each(|(y, known)| *y -= known);
        let first = if self.bend(&besides) { 0 } else { self.fixed_columns };
        self.design.shrunk.clone_from(&self.curves);
        self.term_columns.clear();
        self.bounded.clear();
        self.gains = self.fixed_columns..self.fixed_columns + besides.gains.len();
        self.design.prior.clone_from(&self.known);
        if !besides.gains.is_empty() {
            let prior = Prior::with_zeros(self.known.as_deref(), self.gains.clone(), besides.deviation);
            self.design.prior = Some(Arc::new(prior));
        }
        besides.gains.into_iter().for_each(|column| self.design.push(column));
        for term in terms {
            let start = self.design.columns.len();
            for (column, at) in term.columns.iter().zip(&term.derived_at) {
                self.design.y.iter_mut().zip(column).for_each(|(y, c)| *y += at * c);
            }
            for column in term.columns.iter() {
                match term.fixed {
                    Some(a) => self.design.y.iter_mut().zip(column).for_each(|(y, c)| *y -= a * c),
                    None => self.design.push(column.clone()),
                }
            }
            if let Some(Uncovered { from, deviation }) = term.uncovered {
                let columns = (start + from).min(self.design.columns.len())..self.design.columns.len();
                let prior = Prior::with_zeros(self.design.prior.as_deref(), columns, deviation);
                self.design.prior = Some(Arc::new(prior));
            }
            self.term_columns.push(start..self.design.columns.len());
            if term.is_curve {
                self.design.shrunk.push(start..self.design.columns.len());
            }
            self.bounded.extend(term.curve_on.map(|joint| (joint, start..self.design.columns.len())));
        }
        self.design.is_part_of(&self.torque);
        self.design.refresh_from(first);
        self.fit = Fit::weighted(&self.design, &self.sigma)?;
        self.sigma.clone_from(&self.fit.sigma);
        Ok(())
    }

    /// Puts the columns of the base parameters beside large errors into the design, of known ones what these change of their
    /// torques into y; says whether any column became another one.
    fn bend(&mut self, besides: &Besides) -> bool {
        let before = self.plain.take();
        let was_bent = before.is_some();
        for (column, plain) in self.design.columns.iter_mut().zip(before.into_iter().flatten()) {
            *column = plain;
        }
        let Some(bent) = &besides.bent else { return was_bent };
        let plain = self.design.columns[..self.design.parameters].to_vec();
        for (i, column) in bent.columns.iter().enumerate() {
            match self.design.known.iter().find(|(k, _)| *k == i) {
                Some((_, value)) => {
                    self.design.y.iter_mut().zip(column).for_each(|(y, more)| *y -= value * more);
                }
                None => self.design.columns[i].clone_from(column),
            }
        }
        self.plain = Some(plain);
        self.bent.clone_from(&besides.bent);
        true
    }

    /// Columns of the base parameters of the robot as it is in its table.
    pub fn plain(&self) -> &[Vec<f64>] {
        self.plain.as_deref().unwrap_or(&self.design.columns[..self.design.parameters])
    }

    /// Fits the folds of the design as it is, and works out what each leaves of the motion that it holds out.
    ///
    /// # Errors
    /// [`SingularDesign`] where a fold has no fit.
    pub fn hold_out(&mut self) -> Result<(), SingularDesign> {
        self.folds = folds(&self.design, &self.sigma)?;
        self.beyond = self.beyond_curves();
        self.held_out_squares = held_out_squares(&self.design, &self.fit, &self.folds, &self.beyond);
        self.residual_products = residual_products(&self.design, &self.fit);
        self.target_squares = target_squares(&self.design, &self.fit);
        Ok(())
    }

    /// Takes columns out of the design for good: a term has them from now on.
    pub fn silence(&mut self, columns: impl Iterator<Item = usize>) {
        for column in columns {
            self.design.columns[column].fill(0.0);
        }
        self.design.columns.truncate(self.fixed_columns);
        self.design.shrunk.clone_from(&self.curves);
        self.design.prior.clone_from(&self.known);
        self.design.refresh();
    }

    /// Terms that say nothing of values that no motion has passed.
    pub fn curves(&self) -> Vec<Curve> {
        let of_term = |(joint, columns): &(usize, Range<usize>)| {
            let rows = self.design.of_joint(*joint);
            let on_joint = |k: usize| self.design.columns[k][rows.clone()].to_vec();
            Curve { joint: *joint, columns: columns.clone().map(on_joint).collect() }
        };
        self.bounded.iter().map(of_term).collect()
    }

    fn beyond_curves(&self) -> Vec<bool> {
        if self.bounded.is_empty() || self.design.is_single_motion() {
            return Vec::new();
        }
        let mut out = vec![false; self.design.rows.len()];
        for curve in self.curves() {
            for fold in &self.folds {
                let beyond = Beyond::of(&self.design, &curve, &fold.fit.train);
                for g in fold.held() {
                    for r in self.design.ranges[curve.joint][g].clone() {
                        out[r] |= beyond.contains(r);
                    }
                }
            }
        }
        out
    }

    /// Number of columns that are always there: base parameters and nuisances.
    pub fn fixed_columns(&self) -> usize {
        self.fixed_columns
    }

    /// Squares that another regression of the same rows leaves less of with these weights, in units of the noise variance.
    ///
    /// # Errors
    /// [`SingularDesign`] where there is no fit.
    pub fn gain_against(&self, other: &Self) -> Result<f64, SingularDesign> {
        let with = Fit::whole(&other.design, &self.sigma)?;
        Ok(self.fit.weighted_squares(&self.design) - with.weighted_squares(&other.design))
    }

    /// Residual of every row, all segments fitted.
    pub fn residual(&self) -> Vec<f64> {
        self.fit.residual(&self.design)
    }
}

/// Squares that the fit of each fold leaves of the segments that it holds out, without the rows `beyond`, joint by joint;
/// on a single motion those of the fit to all of it, beside which laws are judged there.
fn held_out_squares(design: &Design, whole: &Fit, folds: &[Fold], beyond: &[bool]) -> Vec<Vec<f64>> {
    let of_fold = |fold: &Fold| {
        let fit = if design.is_single_motion() { whole } else { &fold.fit };
        let squares = |j: usize, g: usize| {
            let all = design.ranges[j][g].clone();
            let seen: Vec<usize> = all.clone().filter(|&r| !is_beyond(beyond, r)).collect();
            if seen.len() < all.len() {
                fit.residual_on(design, &seen).iter().map(|left| left * left).sum()
            } else {
                fit.squares(design, j, g)
            }
        };
        let of_joint = |j: usize| fold.told(design, j).map(|g| squares(j, g)).sum();
        (0..design.joints).map(of_joint).collect()
    };
    folds.iter().map(of_fold).collect()
}

/// Whether a row is one that curves say nothing of; there may be none at all.
pub(super) fn is_beyond(beyond: &[bool], row: usize) -> bool {
    beyond.get(row).copied().unwrap_or(false)
}

fn residual_products(design: &Design, fit: &Fit) -> Vec<Vec<Vec<f64>>> {
    let chi = fit.chi.as_slice();
    let of = |j: usize, g: usize| -> Vec<f64> {
        let gram = design.gram(j, g);
        (0..gram.columns()).map(|i| gram.with_y(i) - dot(gram.row(i), chi)).collect()
    };
    (0..design.joints).map(|j| (0..design.segments.len()).map(|g| of(j, g)).collect()).collect()
}

fn target_squares(design: &Design, fit: &Fit) -> Vec<f64> {
    let targets = design.target_segments();
    (0..design.joints).map(|j| targets.iter().map(|&g| fit.squares(design, j, g)).sum()).collect()
}
