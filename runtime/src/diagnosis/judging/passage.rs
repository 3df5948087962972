//! The one passage in which a law shows most, and whether the rest of the motion shows it, too.
//!
//! Stretches of motion that are held out are shorter than a push may last, so that a curve which follows a push on some of its
//! stretches predicts the others. A law of the robot is there whenever its variables come back.

use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::judging::significance::Evidence;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::fit::Fit;
use crate::diagnosis::rules::{REFUTED, TOLD_APART};
use nalgebra::DVector;
use std::ops::Range;

/// What the rest of the motion says of a law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::diagnosis) enum Elsewhere {
    /// It shows there.
    Shows,
    /// It may be there or not.
    Untold,
    /// It is not there as it is in its passage.
    Refutes,
}

/// Where a law shows most.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::diagnosis) struct Passage {
    pub motion: usize,
    /// On the grid of rows.
    pub places: Range<usize>,
    pub elsewhere: Elsewhere,
}

impl Regression {
    /// The passage of so many places, at most, in which the law of these columns takes most squares away; `inflation` is how much
    /// wider its numbers spread than the noise of rows alone would have it. `None` where there are no rows.
    ///
    /// # Errors
    /// [`SingularDesign`] where there is no fit without the law.
    pub fn passage(
        &self,
        law: Range<usize>,
        inflation: f64,
        longest: usize,
    ) -> Result<Option<Passage>, SingularDesign> {
        let (design, fit) = self.without(law.clone())?;
        let gains = self.gains_of_rows(&fit.residual(&design));
        let passage = most_gained(&self.design, &gains, longest);
        Ok(passage.map(|(motion, places)| Passage {
            motion,
            elsewhere: self.elsewhere(law, inflation, motion, &places),
            places,
        }))
    }

    /// The design without the law of these columns, and its fit.
    ///
    /// # Errors
    /// [`SingularDesign`] where there is none.
    pub fn without(&self, law: Range<usize>) -> Result<(Design, Fit), SingularDesign> {
        let mut design = self.design.clone();
        law.clone().for_each(|k| design.columns[k].fill(0.0));
        design.refresh_from(law.start);
        let fit = Fit::whole(&design, &self.sigma)?;
        Ok((design, fit))
    }

    /// Squares of each row less than a residual leaves, in units of the noise.
    fn gains_of_rows(&self, before: &[f64]) -> Vec<f64> {
        let after = self.residual();
        let mut gains = vec![0.0; after.len()];
        for (j, sigma) in self.sigma.iter().enumerate() {
            for r in self.design.of_joint(j) {
                gains[r] = (before[r] * before[r] - after[r] * after[r]) / (sigma * sigma);
            }
        }
        gains
    }

    /// What the rows outside of a passage, by themselves, say of a law: whether its amplitudes may be zero there, and may be those of
    /// all motion. Where the rest has no fit it says nothing.
    fn elsewhere(
        &self,
        law: Range<usize>,
        inflation: f64,
        motion: usize,
        places: &Range<usize>,
    ) -> Elsewhere {
        let mut rest = self.design.clone();
        for r in 0..rest.rows.len() {
            if rest.rows[r].signal == motion && places.contains(&rest.place(r)) {
                rest.columns.iter_mut().for_each(|column| column[r] = 0.0);
                rest.y[r] = 0.0;
            }
        }
        rest.refresh();
        let Ok(fit) = Fit::whole(&rest, &self.sigma) else { return Elsewhere::Untold };
        let Some(information) = fit.information(law.clone()) else { return Elsewhere::Untold };
        let p_value = |x: DVector<f64>| {
            let squares = x.dot(&(&information * &x)) / (inflation * inflation);
            Evidence::fisher(squares, law.len(), f64::INFINITY).p_value
        };
        let amplitude = |fit: &Fit| fit.chi.rows_range(law.clone()).into_owned();
        if p_value(amplitude(&fit)) <= TOLD_APART {
            Elsewhere::Shows
        } else if p_value(amplitude(&fit) - amplitude(&self.fit)) <= REFUTED {
            Elsewhere::Refutes
        } else {
            Elsewhere::Untold
        }
    }
}

/// The motion of the recording and the places in it, so many at most, whose rows gain most together.
fn most_gained(design: &Design, gains: &[f64], longest: usize) -> Option<(usize, Range<usize>)> {
    let mut best: Option<(f64, usize, Range<usize>)> = None;
    for (motion, span) in design.target_spans() {
        let mut of_places = vec![0.0; span.len()];
        for (r, gain) in gains.iter().enumerate().filter(|(r, _)| design.rows[*r].signal == motion) {
            of_places[design.place(r) - span.start] += gain;
        }
        let mut sum = 0.0;
        for (to, gain) in of_places.iter().enumerate() {
            sum += gain;
            let from = (to + 1).saturating_sub(longest);
            if from > 0 {
                sum -= of_places[from - 1];
            }
            if best.as_ref().is_none_or(|(most, ..)| sum > *most) {
                best = Some((sum, motion, span.start + from..span.start + to + 1));
            }
        }
    }
    best.map(|(_, motion, places)| (motion, places))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::judging::testing::correlated;
    use crate::testing::normal;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    const SEGMENTS: [(usize, bool); 4] = [(0, true), (0, true), (1, true), (1, true)];
    const ROWS: usize = 250;
    /// Rows of three seconds.
    const LONGEST: usize = 150;

    /// A slow column, whose second half of the rows is `seen` or zero but for what is between these rows, with this amplitude
    /// everywhere, and another one between these rows.
    fn passage(rng: &mut Pcg64, seen: bool, [everywhere, there]: [f64; 2]) -> Passage {
        let rows = SEGMENTS.len() * ROWS;
        let mut columns: Vec<Vec<f64>> = (0..3).map(|_| correlated(rng, rows, 0.95)).collect();
        let passing = 600..720;
        for r in (0..rows).filter(|r| !seen && !passing.contains(r)) {
            columns[2][r] = 0.0;
        }
        let amplitude = |r: usize| everywhere + if passing.contains(&r) { there } else { 0.0 };
        let y = (0..rows).map(|r| columns[0][r] + amplitude(r) * columns[2][r] + normal(rng)).collect();
        let design = Design::made_up(1, &SEGMENTS, ROWS, columns, y);
        let regression = Regression::new(design, Vec::new()).expect("a small problem is regular");
        regression.passage(2..3, 1.0, LONGEST).expect("regular").expect("rows")
    }

    /// How many of 200 say this.
    fn said(seed: u64, seen: bool, amplitudes: [f64; 2], what: Elsewhere) -> usize {
        let mut rng = Pcg64::seed_from_u64(seed);
        (0..200).filter(|_| passage(&mut rng, seen, amplitudes).elsewhere == what).count()
    }

    #[test]
    fn a_law_that_is_there_in_all_motion_shows_elsewhere() {
        let shows = said(1, true, [0.3, 0.0], Elsewhere::Shows);
        assert!(shows >= 198, "{shows} of 200");
    }

    #[test]
    fn what_happens_in_one_passage_is_refuted_by_motion_that_would_show_it() {
        let refuted = said(2, true, [0.0, 1.0], Elsewhere::Refutes);
        // One in twenty shows elsewhere by accident.
        assert!((180..=199).contains(&refuted), "{refuted} of 200");
    }

    #[test]
    fn of_what_the_motion_passes_once_the_rest_tells_nothing() {
        let untold = said(3, false, [1.0, 0.0], Elsewhere::Untold);
        // The edges of what is passed may be outside of the passage.
        assert!(untold >= 180, "{untold} of 200");
    }

    #[test]
    fn the_passage_is_where_the_law_shows() {
        let mut rng = Pcg64::seed_from_u64(4);
        for _ in 0..20 {
            let Passage { motion, places, .. } = passage(&mut rng, true, [0.0, 2.0]);
            // Rows 600 to 720 of two motions of 500.
            assert_eq!(motion, 1);
            assert!(places.start <= 130 && places.end >= 190 && places.len() <= LONGEST, "{places:?}");
        }
    }
}
