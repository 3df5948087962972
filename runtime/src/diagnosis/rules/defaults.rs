//! Defaults of the settings.

/// Half-width of the slow window, s: half of the amplitude passes at 11 Hz, above which friction, load and bodies of a
/// moving arm change nothing. Mechanics; `docs/evidence.md`, all figures.
pub(in crate::diagnosis) const SLOW_WINDOW: f64 = 0.045;
/// Half-width of the fast window, s: half of the amplitude passes at 25 Hz, where gears ripple and transmissions ring.
/// Mechanics; ripple, elasticity and backlash in `docs/concealment.md`.
pub(in crate::diagnosis) const FAST_WINDOW: f64 = 0.020;
/// Fraction of a joint's top speed below which it counts as standing still: above the noise of speeds that encoders
/// give. Judgement; the friction effects in `docs/concealment.md`.
pub(in crate::diagnosis) const STANDSTILL: f64 = 0.015;
/// Least explained fraction of a joint's held-out squares. Judgement: below it, what is right is of no use, and small
/// errors of the standard model are named as effects; false namings in `docs/concealment.md`.
pub(in crate::diagnosis) const LEAST_EXPLAINED_FRACTION: f64 = 0.12;
/// Least confidence. Statistics: of two hundred recordings that lack nothing one seems to lack something; false namings in both
/// concealment pages.
pub(in crate::diagnosis) const LEAST_CONFIDENCE: f64 = 0.995;
/// The level is so many times as high where all that was found in the end are laws of the catalogue. Statistics: of a thousand
/// recordings that lack nothing one is told to lack something. A law over any variables pays for thousands of tries as if each
/// were another chance, while splines over a few variables are nearly each other: it needs no more than the level.
pub(in crate::diagnosis) const LEVEL_OF_CATALOGUE: f64 = 0.2;
/// The level is so many times as high once a law is in the model: a gate in front of the other tests, which alone says whether
/// anything is missing (Dmitrienko and Tamhane 2007). Statistics: one false naming in a hundred rounds.
pub(in crate::diagnosis) const LEVEL_BESIDE_LAWS: f64 = 2.0;
/// Searches of their own that a recording goes through: laws, lines, contacts, skew. The chance of a false naming is shared
/// among them. Statistics.
pub(in crate::diagnosis) const SEARCHES: f64 = 4.0;
/// Most effects that are named. Judgement: more than any recording of the evidence has; stops a search that
/// would fit what no law describes.
pub(in crate::diagnosis) const MOST_EFFECTS: usize = 12;
