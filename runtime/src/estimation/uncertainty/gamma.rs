//! Derivatives of the logarithm of the gamma function: what the logarithm of a variance is on average, and how it
//! scatters.

/// From here on the asymptotic series have all digits that are needed.
const ASYMPTOTIC: f64 = 12.0;

/// psi(x), the first derivative of ln gamma, for x > 0 (Abramowitz and Stegun 6.3.5 and 6.3.18).
pub(in crate::estimation) fn digamma(x: f64) -> f64 {
    let (mut x, mut sum) = (x, 0.0);
    while x < ASYMPTOTIC {
        sum -= 1.0 / x;
        x += 1.0;
    }
    let square = 1.0 / (x * x);
    let series = square * (1.0 / 12.0 - square * (1.0 / 120.0 - square * (1.0 / 252.0 - square / 240.0)));
    sum + x.ln() - 0.5 / x - series
}

/// psi'(x), the second derivative, for x > 0 (6.4.6 and 6.4.12).
pub(in crate::estimation) fn trigamma(x: f64) -> f64 {
    let (mut x, mut sum) = (x, 0.0);
    while x < ASYMPTOTIC {
        sum += 1.0 / (x * x);
        x += 1.0;
    }
    let square = 1.0 / (x * x);
    let series = square * (1.0 / 6.0 - square * (1.0 / 30.0 - square * (1.0 / 42.0 - square / 30.0)));
    sum + (1.0 + 0.5 / x + series) / x
}

/// The x > 0 with psi'(x) = y, for y > 0: Newton's method on 1 / psi' (Smyth 2004, appendix).
pub(in crate::estimation) fn inverse_trigamma(y: f64) -> f64 {
    let mut x = 0.5 + 1.0 / y;
    for _ in 0..50 {
        let value = trigamma(x);
        let step = value * (1.0 - value / y) / tetragamma(x);
        x += step;
        if -step / x < 1e-12 {
            break;
        }
    }
    x
}

/// psi''(x), for x > 0 (6.4.6 and 6.4.13).
fn tetragamma(x: f64) -> f64 {
    let (mut x, mut sum) = (x, 0.0);
    while x < ASYMPTOTIC {
        sum -= 2.0 / (x * x * x);
        x += 1.0;
    }
    let square = 1.0 / (x * x);
    let series = square * (0.5 - square * (1.0 / 6.0 - square * (1.0 / 6.0 - square * 0.3)));
    sum - square * (1.0 + 1.0 / x + series)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_values_are_those_of_scipy() {
        // scipy.special.digamma, polygamma(1, x) and polygamma(2, x)
        for (x, first, second, third) in [
            (0.25, -4.2274535333762655, 17.197329154507113, -129.32773993753688),
            (1.0, -0.5772156649015329, 1.6449340668482266, -2.404113806319188),
            (3.7, 1.1671535393615113, 0.31003785767003833, -0.09539530872855405),
            (40.0, 3.6763273740348428, 0.025315103841291032, -0.0006408202718352985),
        ] {
            assert!((digamma(x) - first).abs() < 1e-12 * first.abs());
            assert!((trigamma(x) - second).abs() < 1e-12 * second);
            assert!((tetragamma(x) - third).abs() < 1e-9 * third.abs(), "{}", tetragamma(x));
            assert!((inverse_trigamma(second) - x).abs() < 1e-10 * x);
        }
    }
}
