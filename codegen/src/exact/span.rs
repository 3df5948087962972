//! Subspaces of exact vectors.

use super::Surd;

/// The space that some vectors span, as a basis in fully reduced echelon form.
#[derive(Debug, Clone, Default)]
pub struct Span {
    /// Vectors with their pivot: 1 there, 0 at the pivots of the others.
    rows: Vec<(usize, Vec<Surd>)>,
}

impl Span {
    /// Adds a vector; whether the space grew.
    pub fn insert(&mut self, mut vector: Vec<Surd>) -> bool {
        for (pivot, row) in &self.rows {
            subtract(&mut vector, *pivot, row);
        }
        let Some(pivot) = vector.iter().position(|x| !x.is_zero()) else { return false };
        scale_to_one(&mut vector, pivot);
        for (_, row) in &mut self.rows {
            subtract(row, pivot, &vector);
        }
        self.rows.push((pivot, vector));
        true
    }

    /// Adds vectors and all that `image` makes of them, again and again, until the space is closed under `image`.
    pub fn insert_closed(&mut self, vectors: Vec<Vec<Surd>>, image: impl Fn(&[Surd]) -> Vec<Surd>) {
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
    pub fn reduced(&self, order: &[usize]) -> Vec<(usize, Vec<Surd>)> {
        let mut waiting: Vec<Vec<Surd>> = self.vectors().cloned().collect();
        let mut done: Vec<(usize, Vec<Surd>)> = Vec::new();
        for &k in order {
            let Some(at) = waiting.iter().position(|row| !row[k].is_zero()) else { continue };
            let mut lead = waiting.swap_remove(at);
            scale_to_one(&mut lead, k);
            waiting.iter_mut().for_each(|row| subtract(row, k, &lead));
            done.iter_mut().for_each(|(_, row)| subtract(row, k, &lead));
            done.push((k, lead));
        }
        done
    }

    /// The basis.
    pub fn vectors(&self) -> impl Iterator<Item = &Vec<Surd>> {
        self.rows.iter().map(|(_, row)| row)
    }
}

/// Multiplies a vector so that coordinate `pivot`, which is not 0, becomes 1.
fn scale_to_one(vector: &mut [Surd], pivot: usize) {
    let Some(scale) = vector[pivot].inverse() else { return };
    for x in vector.iter_mut().filter(|x| !x.is_zero()) {
        *x = &*x * &scale;
    }
}

/// Makes coordinate `pivot` of a vector zero with a multiple of `row`, which is 1 there.
fn subtract(vector: &mut [Surd], pivot: usize, row: &[Surd]) {
    if vector[pivot].is_zero() {
        return;
    }
    let factor = -&vector[pivot];
    for (x, y) in vector.iter_mut().zip(row).filter(|(_, y)| !y.is_zero()) {
        *x = &*x + &(&factor * y);
    }
}
