//! Where a function of one number is least.

/// By so many golden sections of what is between two values (Kiefer 1953).
///
/// # Errors
/// Those of the function.
pub(crate) fn least<E>(
    [mut low, mut high]: [f64; 2],
    sections: usize,
    value: impl Fn(f64) -> Result<f64, E>,
) -> Result<f64, E> {
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    for _ in 0..sections {
        let (a, b) = (high - golden * (high - low), low + golden * (high - low));
        if value(a)? < value(b)? { high = b } else { low = a }
    }
    Ok(0.5 * (low + high))
}
