//! Waves over the angle of a joint, fitted to samples by least squares.

/// A sample that can hold a line: its angle and the residual without what is slower.
pub(super) struct Sample {
    pub q: f64,
    pub r: f64,
}

/// c cos kq + s sin kq.
#[derive(Clone, Copy)]
pub(super) struct Wave {
    pub c: f64,
    pub s: f64,
}

impl Wave {
    pub fn norm(&self) -> f64 {
        self.c.hypot(self.s)
    }

    /// Its value where kq has this sine and cosine.
    pub fn at(&self, (sine, cosine): (f64, f64)) -> f64 {
        self.c * cosine + self.s * sine
    }
}

/// Inner products of cosine, sine and residual.
#[derive(Clone, Copy, Default)]
struct Products {
    cc: f64,
    cs: f64,
    ss: f64,
    rc: f64,
    rs: f64,
}

impl Products {
    fn add(&mut self, r: f64, (sine, cosine): (f64, f64)) {
        self.cc += cosine * cosine;
        self.cs += cosine * sine;
        self.ss += sine * sine;
        self.rc += r * cosine;
        self.rs += r * sine;
    }

    /// The wave by least squares.
    fn wave(&self) -> Wave {
        let Products { cc, cs, ss, rc, rs } = *self;
        let determinant = cc * ss - cs * cs;
        if determinant <= 1e-9 * cc * ss {
            return Wave { c: 0.0, s: 0.0 };
        }
        Wave { c: (rc * ss - rs * cs) / determinant, s: (rs * cc - rc * cs) / determinant }
    }
}

/// Sine and cosine of kq at samples.
pub(super) fn turned(samples: &[Sample], order: f64) -> Vec<(f64, f64)> {
    samples.iter().map(|x| (order * x.q).sin_cos()).collect()
}

/// The wave of one order, from sine and cosine of kq at the samples.
pub(super) fn wave(samples: &[Sample], turned: &[(f64, f64)]) -> Wave {
    let mut products = Products::default();
    for (x, &turned) in samples.iter().zip(turned) {
        products.add(x.r, turned);
    }
    products.wave()
}

/// Orders at equal steps.
pub(super) struct Orders {
    pub first: f64,
    pub step: f64,
    pub count: usize,
}

impl Orders {
    pub fn all(&self) -> impl Iterator<Item = f64> + use<> {
        let (first, step) = (self.first, self.step);
        (0..self.count).map(move |k| first + step * k as f64)
    }

    /// The wave of each order. The angle of a sample grows by the same from order to order, so that it is turned on
    /// instead of being evaluated again.
    pub fn waves(&self, samples: &[Sample]) -> impl Iterator<Item = Wave> + use<> {
        let mut products = vec![Products::default(); self.count];
        for x in samples {
            let (mut sine, mut cosine) = (self.first * x.q).sin_cos();
            let (turn_sine, turn_cosine) = (self.step * x.q).sin_cos();
            for at in &mut products {
                at.add(x.r, (sine, cosine));
                (sine, cosine) =
                    (sine * turn_cosine + cosine * turn_sine, cosine * turn_cosine - sine * turn_sine);
            }
        }
        products.into_iter().map(|p| p.wave())
    }
}
