//! How the variables of a law over any of them come together.

/// How the variables come together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Together {
    /// One variable alone.
    One,
    /// A curve over each, added.
    Added,
    /// Products only: what one does is scaled by the other.
    Multiplied,
    /// Both.
    Full,
    /// One variable alone, by a curve with narrow bends.
    Fine,
    /// In proportion to each, of one or two.
    Lines,
    /// One curve with narrow bends over the sum of two positions.
    Sum,
    /// The same over the first less the second.
    Difference,
    /// What has the direction of one and fades along the other: friction that wears off after a rest.
    Fading,
}

impl Together {
    const ALL: [Self; 9] = [
        Self::One,
        Self::Added,
        Self::Multiplied,
        Self::Full,
        Self::Fine,
        Self::Lines,
        Self::Sum,
        Self::Difference,
        Self::Fading,
    ];

    /// Ways in which any two variables may come together.
    pub const OF_ANY_TWO: [Self; 4] = [Self::Multiplied, Self::Added, Self::Full, Self::Lines];

    /// Ways in which two positions of one unit may come together besides.
    pub const OF_POSITIONS: [Self; 2] = [Self::Sum, Self::Difference];

    /// Its number in the shape of a term.
    pub(super) fn code(self) -> f64 {
        Self::ALL.iter().position(|t| *t == self).unwrap_or(0) as f64
    }

    /// The way with a number; `None` where it is none.
    pub(super) fn from_code(code: f64) -> Option<Self> {
        Self::ALL.into_iter().find(|t| t.code() == code)
    }

    /// Whether there is a curve or a line over each variable.
    pub(super) fn has_curves(self) -> bool {
        !matches!(self, Self::Multiplied | Self::Sum | Self::Difference | Self::Fading)
    }

    /// Whether there are products of two variables.
    pub(super) fn has_products(self) -> bool {
        matches!(self, Self::Multiplied | Self::Full)
    }

    /// Sign of the second position where the curve is over the first one with it.
    pub(super) fn sign_of_second(self) -> Option<f64> {
        match self {
            Self::Sum => Some(1.0),
            Self::Difference => Some(-1.0),
            _ => None,
        }
    }
}
