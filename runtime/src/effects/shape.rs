//! How the shape of a law is searched between the values of its grid.

/// How one number of a shape is varied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Step {
    /// By a factor, as between neighbours of the grid.
    Times(f64),
    /// By an amount; the number does not go below 0.
    Add(f64),
    /// By an amount, above and below 0.
    Move(f64),
    /// Not at all: it chooses between forms of the law.
    Keep,
}

/// Numbers of a shape that are moved together: which, and by how many steps.
pub type Move = Vec<(usize, f64)>;

/// The search of a shape.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ShapeSearch {
    /// How each number is varied; what is not listed stays.
    pub steps: Vec<Step>,
    /// Lowest and highest value of each number.
    pub bounds: Vec<[f64; 2]>,
    /// Moves of several numbers at once, beside those of each alone.
    pub together: Vec<Move>,
}

impl ShapeSearch {
    /// A shape that has no numbers, or none that is varied.
    pub fn none() -> Self {
        Self::default()
    }

    /// Steps without bounds, but for those of [`Step::Add`].
    pub fn unbounded(steps: Vec<Step>) -> Self {
        let bounds = steps.iter().map(|_| [f64::NEG_INFINITY, f64::INFINITY]).collect();
        Self { steps, bounds, together: Vec::new() }
    }

    /// Steps that stay within one of the (positive) grid: a power of nearly 0, say, is a second Coulomb level.
    pub fn within_a_step_of(grid: &[&[f64]], steps: Vec<Step>) -> Self {
        let bounds = steps.iter().enumerate().map(|(k, step)| {
            let Step::Times(factor) = step else { return [f64::NEG_INFINITY, f64::INFINITY] };
            let values = grid.iter().filter_map(|shape| shape.get(k));
            let (low, high) =
                values.fold((f64::INFINITY, 0.0_f64), |(low, high), &x| (low.min(x), high.max(x)));
            let (low, high) = (low / factor, high * factor);
            if low < high { [low, high] } else { [f64::NEG_INFINITY, f64::INFINITY] }
        });
        Self { bounds: bounds.collect(), steps, together: Vec::new() }
    }

    /// Whether a number of the shape is varied.
    pub fn varies(&self, number: usize) -> bool {
        self.steps.get(number).is_some_and(|step| !matches!(step, Step::Keep))
    }

    /// Whether two shapes are of one form of the law: as many numbers, the same ones where they are kept.
    pub fn is_same_form(&self, one: &[f64], other: &[f64]) -> bool {
        let kept = |k: usize| matches!(self.steps.get(k), Some(Step::Keep));
        one.len() == other.len() && one.iter().zip(other).enumerate().all(|(k, (a, b))| !kept(k) || a == b)
    }

    /// Moves that are tried for a shape of so many numbers: each number alone, both ways, then those together.
    pub fn moves(&self, numbers: usize) -> Vec<Move> {
        let mut moves: Vec<Move> = Vec::new();
        for k in 0..self.steps.len().min(numbers) {
            moves.extend([vec![(k, 1.0)], vec![(k, -1.0)]]);
        }
        moves.extend(self.together.iter().filter(|m| m.iter().all(|(k, _)| *k < numbers)).cloned());
        moves
    }

    /// A shape after a move by `size` steps.
    pub fn moved(&self, shape: &[f64], along: &Move, size: f64) -> Vec<f64> {
        let mut next = shape.to_vec();
        for &(k, direction) in along {
            next[k] = match self.steps[k] {
                Step::Times(factor) => next[k] * factor.powf(direction * size),
                Step::Add(amount) => (next[k] + amount * direction * size).max(0.0),
                Step::Move(amount) => next[k] + amount * direction * size,
                Step::Keep => next[k],
            };
            let [low, high] = self.bounds[k];
            next[k] = next[k].clamp(low, high);
        }
        next
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_factor_stays_within_one_step_of_the_grid() {
        let grid: [&[f64]; 2] = [&[1.0], &[4.0]];
        let search = ShapeSearch::within_a_step_of(&grid, vec![Step::Times(2.0)]);
        assert_eq!(search.bounds, [[0.5, 8.0]]);
        assert_eq!(search.moved(&[4.0], &vec![(0, 1.0)], 1.0), [8.0]);
        assert_eq!(search.moved(&[8.0], &vec![(0, 1.0)], 1.0), [8.0]);
        assert!((search.moved(&[1.0], &vec![(0, -1.0)], 0.5)[0] - 0.5_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn an_amount_does_not_lead_below_zero_and_what_is_kept_does_not_move() {
        let search = ShapeSearch::unbounded(vec![Step::Add(1.0), Step::Keep]);
        assert_eq!(search.moved(&[0.3, 5.0], &vec![(0, -1.0)], 1.0), [0.0, 5.0]);
        assert_eq!(search.moved(&[0.3, 5.0], &vec![(1, 1.0)], 1.0), [0.3, 5.0]);
        assert_eq!(search.moves(1).len(), 2);
    }

    #[test]
    fn shapes_are_of_one_form_where_what_is_kept_is_the_same() {
        let search = ShapeSearch::unbounded(vec![Step::Times(2.0), Step::Keep]);
        assert!(search.is_same_form(&[1.0, 2.0], &[3.0, 2.0]));
        assert!(!search.is_same_form(&[1.0, 2.0], &[1.0, 1.0]));
        assert!(!search.is_same_form(&[1.0], &[1.0, 2.0]));
    }
}
