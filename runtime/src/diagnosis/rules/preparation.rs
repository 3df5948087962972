//! Preparation, rows and fits.

/// Highest cut-off of the filter of positions and torques, Hz. Mechanics: more than twice the band of the fast
/// window, so that the filter leaves that band alone. All figures.
pub(in crate::diagnosis) const HIGHEST_CUTOFF: f64 = 60.0;
/// The cut-off is at most the sampling rate over this: a filter closer to half of the rate warps. Mechanics.
pub(in crate::diagnosis) const RATE_PER_CUTOFF: f64 = 5.0;
/// Samples a second that are kept: eight times the highest cut-off, so that nothing is lost. Mechanics.
pub(in crate::diagnosis) const SAMPLES_PER_SECOND: f64 = 500.0;
/// The fast rows' limit of standstill is the slow rows' over this: the narrower window reaches less far into a
/// standstill. Judgement; ripple and backlash in `docs/concealment.md`.
pub(in crate::diagnosis) const FAST_STANDSTILL_DIVISOR: f64 = 1.5;
/// A recording shorter than this, s, has no rows to spare: slow effects are smoothed no more than fast ones.
/// Judgement; `docs/concealment_short.md`.
pub(in crate::diagnosis) const SHORT_RECORDING: f64 = 12.0;
/// Segments that few motions are split into, all together: enough that two may disagree.
/// Judgement; `docs/concealment_short.md`.
pub(in crate::diagnosis) const SEGMENTS_OF_FEW_MOTIONS: usize = 8;
/// Whole motions are held out where what the others leave open of the parameters is in no joint more than so many times the
/// variance of its noise; of what is held out the torques of a joint count where it is no more for that joint. Statistics: beyond
/// that, held-out errors tell of the parameters and not of laws.
pub(in crate::diagnosis) const LEFT_OPEN_BY_OTHERS: f64 = 1.0;
/// The same of a single motion that is predicted forward in time, and of new motion that is from a baseline alone: stretches are
/// less of a test, but that is given up where it would show nothing at all. Judgement: errors of ten times the noise.
pub(in crate::diagnosis) const LEFT_OPEN_AT_MOST: f64 = 100.0;
/// A joint moves in a motion where it does so for more than this part of the time that it does in that in which it moves most.
/// Judgement: less tells little of its parameters.
pub(in crate::diagnosis) const MOVES_IN_MOTION: f64 = 0.1;
/// From this many motions on, whole motions are held out: two remain to fit. Statistics.
pub(in crate::diagnosis) const ENOUGH_MOTIONS: usize = 3;
/// Least rows of a joint that laws are looked for on. Statistics: three for each number that only its own rows can
/// tell, viscous and Coulomb friction, offset, and a law.
pub(in crate::diagnosis) const LEAST_ROWS: usize = 12;
/// Least rows of all joints for each parameter that they determine. Statistics: as many degrees of freedom as
/// parameters.
pub(in crate::diagnosis) const ROWS_PER_PARAMETER: usize = 2;
/// A column of which less than this fraction of its norm is its own counts as not determined. Judgement: its
/// standard deviation is then 1e4 times that of a column by itself.
pub(in crate::diagnosis) const UNDETERMINED: f64 = 1e-4;
/// Where more than one parameter out of this many is not determined, or a joint holds still, columns that nothing
/// determines are left out instead of being kept small. Judgement: with a few that are not, effects are still found
/// (`docs/evidence.md`, UR10e).
pub(in crate::diagnosis) const PARAMETERS_PER_UNDETERMINED: usize = 4;
/// The recording is refused where the standard model explains less of the torque's squares, per cent. Judgement: far
/// below any right model, above what wrong units or a wrong joint order leave; not measured.
pub(in crate::diagnosis) const LEAST_EXPLAINED_BY_MODEL: f64 = 40.0;
/// Part of the samples of a joint that its top speed is not below: single spikes do not set it. Statistics.
pub(in crate::diagnosis) const TOP_SPEED_PERCENT: usize = 98;
/// Least inertia behind a transmission, as a part of that with the rotor. Mechanics: no division by zero.
pub(in crate::diagnosis) const LEAST_LINK_INERTIA: f64 = 1e-3;
/// Most rounds in which a skew is taken out: each takes what linearisation left of the one before. Numerics: mostly one leaves
/// less than [`DELAY_TAKEN_OUT`].
pub(in crate::diagnosis) const DELAY_ROUNDS: usize = 10;
/// So many times its standard deviations a reference's parameters may be off while the skew is measured. Statistics: it says
/// nothing of what motion determines, and all of what it does not.
pub(in crate::diagnosis) const LOOSE_REFERENCE: f64 = 1e3;
/// A skew of fewer samples is left to its column. Mechanics: within one sample, linear interpolation is exact enough.
pub(in crate::diagnosis) const DELAY_TAKEN_OUT: f64 = 0.75;
/// Standard deviation of skews before anything is known of one, s, a sample at least. Mechanics: filters of currents, buses and
/// cycles of controllers delay by milliseconds.
pub(in crate::diagnosis) const DELAY_DEVIATION: f64 = 0.01;
/// Standard deviations from which on a delay of the motions from before is taken out of new motion. Statistics: the usual 5 %.
pub(in crate::diagnosis) const DELAY_THERE: f64 = 2.0;
/// A delay is named from this many samples on: a smaller one is part of sampling. Mechanics; time_delay in
/// `docs/concealment.md`.
pub(in crate::diagnosis) const NAMED_DELAY_SAMPLES: f64 = 0.75;
/// A delay is named from this duration on, s. Mechanics: drives sample currents within a millisecond.
pub(in crate::diagnosis) const NAMED_DELAY: f64 = 1e-3;

/// Longest block of motion, s, longer than residuals of a robot in motion are correlated. Judgement; both concealment
/// pages.
pub(in crate::diagnosis) const LONGEST_BLOCK: f64 = 0.5;
/// Least part of a block's squares that a fit is taken to leave. Numerics: a block that alone tells a parameter leaves none;
/// effects in `docs/coverage.md`.
pub(in crate::diagnosis) const LEAST_OF_A_BLOCK: f64 = 0.1;
/// From this many blocks of that length on, gains are compared block by block. Judgement: with fewer,
/// Student's tail is so long that hundreds of comparisons leave nothing certain; `docs/concealment_short.md`.
pub(in crate::diagnosis) const ENOUGH_BLOCKS: usize = 24;
/// Relative ridge of a fit: what is not determined stays small. Mechanics: far below any part that counts
/// as own, far above rounding.
pub(in crate::diagnosis) const FIT_RIDGE: f64 = 1e-10;
/// Most rounds of weights from the residuals' own standard deviations. Judgement: they have converged; not measured.
pub(in crate::diagnosis) const WEIGHT_ROUNDS: usize = 6;
/// Relative change of these standard deviations at which the rounds end. Numerics: far below how well they are known.
pub(in crate::diagnosis) const WEIGHTS_AT_REST: f64 = 1e-9;
/// Least standard deviation of a joint relative to its largest torque: noise-free recordings stay finite. Mechanics.
pub(in crate::diagnosis) const LEAST_RELATIVE_SIGMA: f64 = 1e-9;
/// Least standard deviation of a joint, N.m or N: the same for a joint without torque. Mechanics.
pub(in crate::diagnosis) const LEAST_SIGMA: f64 = 1e-12;
