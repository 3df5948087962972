//! Subspaces of exact vectors.

use super::number::Number;

/// The space that some vectors span, as a basis in fully reduced echelon form.
#[derive(Debug, Clone, Default)]
pub struct Span {
    /// Vectors with their pivot: 1 there, 0 at the pivots of the others.
    rows: Vec<(usize, Vec<Number>)>,
}

impl Span {
    /// Adds a vector; whether the space grew.
    pub fn insert(&mut self, mut vector: Vec<Number>) -> bool {
        for (pivot, row) in &self.rows {
            subtract(&mut vector, *pivot, row);
        }
        // Which coordinate leads is free; the largest keeps the floating point values accurate.
        let nonzero = (0..vector.len()).filter(|&k| !vector[k].is_zero());
        let Some(pivot) = nonzero.max_by(|&i, &k| vector[i].real().abs().total_cmp(&vector[k].real().abs()))
        else {
            return false;
        };
        scale_to_one(&mut vector, pivot);
        for (_, row) in &mut self.rows {
            subtract(row, pivot, &vector);
        }
        self.rows.push((pivot, vector));
        true
    }

    /// Adds vectors and all that `image` makes of them, again and again, until the space is closed under `image`.
    pub fn insert_closed(&mut self, vectors: Vec<Vec<Number>>, image: impl Fn(&[Number]) -> Vec<Number>) {
        let mut waiting = vectors;
        while let Some(vector) = waiting.pop() {
            let next = image(&vector);
            if self.insert(vector) && next.iter().any(|x| !x.is_zero()) {
                waiting.push(next);
            }
        }
    }

    /// The basis that is reduced with the coordinates taken in the given order, each vector with its pivot.
    ///
    /// The pivots are the first coordinates of that order in which the space has independent components.
    pub fn reduced(&self, order: &[usize]) -> Vec<(usize, Vec<Number>)> {
        let mut waiting: Vec<Vec<Number>> = self.vectors().cloned().collect();
        let mut done: Vec<(usize, Vec<Number>)> = Vec::new();
        for &k in order {
            let shows = (0..waiting.len()).filter(|&at| !waiting[at][k].is_zero());
            let size = |at: usize| waiting[at][k].real().abs();
            let Some(at) = shows.max_by(|&a, &b| size(a).total_cmp(&size(b))) else { continue };
            let mut lead = waiting.swap_remove(at);
            scale_to_one(&mut lead, k);
            waiting.iter_mut().for_each(|row| subtract(row, k, &lead));
            done.iter_mut().for_each(|(_, row)| subtract(row, k, &lead));
            done.push((k, lead));
        }
        done
    }

    /// The basis.
    pub fn vectors(&self) -> impl Iterator<Item = &Vec<Number>> {
        self.rows.iter().map(|(_, row)| row)
    }
}

/// Multiplies a vector so that coordinate `pivot`, which is not 0, becomes 1.
fn scale_to_one(vector: &mut [Number], pivot: usize) {
    let Some(scale) = vector[pivot].inverse() else { return };
    for x in vector.iter_mut().filter(|x| !x.is_zero()) {
        *x = (*x * scale).cleaned();
    }
}

/// Makes coordinate `pivot` of a vector zero with a multiple of `row`, which is 1 there.
fn subtract(vector: &mut [Number], pivot: usize, row: &[Number]) {
    if vector[pivot].is_zero() {
        return;
    }
    let factor = vector[pivot];
    for (x, y) in vector.iter_mut().zip(row).filter(|(_, y)| !y.is_zero()) {
        *x = (*x - factor * *y).cleaned();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vector(entries: [i64; 4]) -> Vec<Number> {
        entries.map(Number::from).to_vec()
    }

    #[test]
    fn a_dependent_vector_does_not_make_the_space_grow() {
        let mut space = Span::default();
        assert!(space.insert(vector([1, 2, 0, 3])));
        assert!(space.insert(vector([0, 1, 1, 1])));
        assert!(!space.insert(vector([2, 5, 1, 7])));
        assert_eq!(space.vectors().count(), 2);
    }

    #[test]
    fn pivots_are_the_first_possible_coordinates_of_the_stated_order() {
        let mut space = Span::default();
        space.insert(vector([1, 1, 0, 2]));
        space.insert(vector([0, 0, 1, 5]));
        let pivots =
            |order: &[usize]| space.reduced(order).into_iter().map(|(pivot, _)| pivot).collect::<Vec<_>>();
        assert_eq!(pivots(&[0, 1, 2, 3]), [0, 2]);
        assert_eq!(pivots(&[1, 3, 2, 0]), [1, 3]);
        let rows = space.reduced(&[3, 0, 1, 2]);
        assert_eq!(rows[0].1[3], Number::ONE);
        assert!(rows[1].1[3].is_zero());
    }

    #[test]
    fn the_closure_of_a_shift_is_the_whole_tail() {
        let mut space = Span::default();
        let shift = |v: &[Number]| [&[Number::ZERO], &v[..3]].concat();
        space.insert_closed(vec![vector([0, 1, 0, 0])], shift);
        assert_eq!(space.vectors().count(), 3);
    }
}
