//! One column in one motion.

/// One column in one motion at the full rate: the joints that it acts on, with their torques.
pub(in crate::diagnosis) type Series = Vec<(usize, Vec<f64>)>;

/// Adds columns, each by its amplitude, to torques `[j][t]`.
pub(in crate::diagnosis) fn add_to(torques: &mut [Vec<f64>], columns: &[Series], amplitude: &[f64]) {
    for (column, a) in columns.iter().zip(amplitude) {
        for (j, values) in column {
            torques[*j].iter_mut().zip(values).for_each(|(t, v)| *t += a * v);
        }
    }
}
