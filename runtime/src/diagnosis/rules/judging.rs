//! What counts as evidence: partial regression, tests, and their calibration: what a law's statistic is where nothing has
//! changed is measured, between units of the baseline or of the recording.

/// Least fraction of a trial column's squares that the design does not make: below it, the column is the design's, and what
/// is left of it is what is wrong with either. Judgement: no column of a real robot is right to better than a hundredth of
/// its torque.
pub(in crate::diagnosis) const OWN_FRACTION: f64 = 2e-4;
/// The same of a derivative of the model, which is wrong in the same way as the model's own columns: what an error of the
/// table or of the time adds is nearly that of other inertias, and shows by a thousandth of its torque. Mechanics: ten
/// thousand times `FIT_RIDGE`, below which the part of its own is what the ridge leaves.
pub(in crate::diagnosis) const OWN_FRACTION_OF_DERIVATIVE: f64 = 1e-6;
/// Relative ridge of a candidate's amplitudes. Mechanics, as `FIT_RIDGE`, for columns that nearly agree.
pub(in crate::diagnosis) const AMPLITUDE_RIDGE: f64 = 1e-7;
/// What one more number must gain to be worth it, in units of the noise variance (Akaike 1974). Statistics.
pub(in crate::diagnosis) const AIC_PENALTY: f64 = 2.0;
/// The fitted fraction must be this part of the held-out one that is asked for: a gain in prediction without one in
/// the fit is an accident of extrapolation. Judgement; false namings.
pub(in crate::diagnosis) const FITTED_TO_HELD_OUT: f64 = 0.5;
/// A single motion is cut at these eighths: what comes before is fitted and predicts what comes after.
/// Judgement: most of a motion is needed to determine the standard parameters; `docs/concealment_short.md`.
pub(in crate::diagnosis) const FORWARD_CUTS: [usize; 2] = [5, 6];
/// Share of what held-out stretches leave open from which on a law need not hold forward in time: without it the parameters
/// that are extrapolated are no model of the motion. Judgement.
pub(in crate::diagnosis) const MOST_OF_WHAT_IS_OPEN: f64 = 0.75;
/// Standard deviations of a gain, by the error of parameters that were fitted elsewhere, from which on a loss is that of the
/// law. Statistics: one in forty of losses by that error alone is larger.
pub(in crate::diagnosis) const LOST: f64 = 2.0;
/// Of the stretches of few motions, one in so many may lose: an effect may leave some of them untouched. Judgement.
pub(in crate::diagnosis) const STRETCHES_PER_LOSS: usize = 4;
/// Of whole motions, one in so many may lose. Judgement.
pub(in crate::diagnosis) const MOTIONS_PER_LOSS: usize = 6;

/// Shifts in time that a waveform is compared with. Statistics: enough for the standard deviation of a correlation to
/// 7 %.
pub(in crate::diagnosis) const SHIFTS: usize = 100;
/// Shifts next to zero that count as the waveform itself. Statistics.
pub(in crate::diagnosis) const SHIFTS_LEFT_OUT: usize = 2;
/// Shortest block, s: two rows of the slow window. Mechanics.
pub(in crate::diagnosis) const SHORTEST_BLOCK: f64 = 0.1;
/// Blocks are this many times as long as the residual's decorrelation lag. Judgement, as the tests of `significance`
/// have it.
pub(in crate::diagnosis) const LAGS_PER_BLOCK: usize = 2;
/// Autocorrelation below which residuals count as uncorrelated: 4 % of the variance in common. Judgement.
pub(in crate::diagnosis) const UNCORRELATED: f64 = 0.2;
/// A law of time must be there with this confidence whichever unit of the recording is left out: else it is an event for all
/// that is known. Statistics: a test of its own, of one law.
pub(in crate::diagnosis) const WITHOUT_ANY_UNIT: f64 = 0.99;
/// Part of its squares that a transient may have left when it has faded. Judgement: two time constants.
pub(in crate::diagnosis) const FADED: f64 = 0.02;
/// A transient has faded before so large a part of the shortest motion begins: what follows the recording has none of it.
/// Judgement; TX-40 in `docs/evidence.md`, where it is over before half of the motion.
pub(in crate::diagnosis) const LATE: f64 = 0.25;
/// A body lies within so many times the lengths of the robot's table of the link that carries it. Mechanics: what is
/// farther away than the robot reaches from end to end and back is not carried by it; the last link's own length is not in
/// the table.
pub(in crate::diagnosis) const BODY_REACH: f64 = 2.0;
/// Ten numbers are no body where one would explain as little as that with less probability. Judgement: one in a thousand
/// bodies is not named.
pub(in crate::diagnosis) const NO_BODY: f64 = 1e-3;
/// Fewest blocks for a mean gain. Statistics: three degrees of freedom.
pub(in crate::diagnosis) const LEAST_BLOCKS: f64 = 4.0;
/// Highest confidence that is told. Judgement: no model of noise is right beyond it.
pub(in crate::diagnosis) const HIGHEST_CONFIDENCE: f64 = 0.9999;
/// How often something that is no accident has the right name on the right joint. Measured: 429 of the 458 findings of
/// hidden effects in `docs/calibration.md` and of one more run of the same kind.
pub(in crate::diagnosis) const RIGHT_NAMES: f64 = 0.94;
/// Two laws are told apart where the better one is so by accident with less than this probability. Statistics: the
/// usual 5 %; `cannot_tell` in `docs/evidence.md`.
pub(in crate::diagnosis) const TOLD_APART: f64 = 0.05;

/// Share of the level of a law in noise of uneven sizes that goes to the test by signs: where it decides, it is certain by
/// orders of magnitude, and the other one should hardly be the weaker for it.
pub(in crate::diagnosis) const LEVEL_OF_SIGNS: f64 = 0.1;

/// Share of the level of a law beside a baseline that goes to the test by what other laws of the joint change by in the recording.
/// Statistics: which of the two tests is the better one depends on how long the baseline is.
pub(in crate::diagnosis) const LEVEL_OF_KIND: f64 = 0.5;

/// Highest order of the autoregression that makes a residual white. Statistics: half a second of slow rows; the order
/// itself is chosen by the Bayesian information criterion.
pub(in crate::diagnosis) const HIGHEST_AR_ORDER: usize = 12;
/// Fewest pairs of rows that an order is estimated from. Statistics: a reflection coefficient of so many has a fifth
/// as its standard deviation.
pub(in crate::diagnosis) const LEAST_AR_PAIRS: usize = 20;
/// Shortest and longest unit of a baseline, s, and never longer than the recording's motions: a law must show in one,
/// and what differs between days or poses must not be averaged away. Statistics; not measured on shorter ones.
pub(in crate::diagnosis) const UNIT_OF_BASELINE: [f64; 2] = [1.0, 12.0];
/// Shortest and longest unit where a recording is compared with itself, s. Statistics.
pub(in crate::diagnosis) const UNIT_OF_ITSELF: [f64; 2] = [1.0, 8.0];
/// Units that are wanted, where they are not too short or long. Statistics: a variance of so many has half of its size
/// as its standard deviation, and a law is certain at a level of 1e-4 from six standard errors on.
pub(in crate::diagnosis) const UNITS_WANTED: f64 = 10.0;
/// Relative ridge of the regressions on white rows. Numerics.
pub(in crate::diagnosis) const CALIBRATION_RIDGE: f64 = 1e-10;
/// A law that keeps this part of the squares that only it explains when another joins the model, on other joints, was not
/// imitating that one. A law that keeps it with amplitudes of its own sign may have these; one that explains it of what two
/// of its cases do takes their place. Judgement: two laws that share a tenth of their squares are told apart; saves time.
pub(in crate::diagnosis) const KEPT_BESIDE: f64 = 0.9;
/// A law that takes away this part of the squares of another joint's residual has changed what is noise there.
/// Judgement: below it, the noise is the same as before; saves time.
pub(in crate::diagnosis) const FREED: f64 = 0.01;
/// Directions of a law with less than this part of its squares are rounding. Numerics.
pub(in crate::diagnosis) const LEAST_EIGENVALUE: f64 = 1e-6;
/// Torques of a joint repeat to this share of their root mean square from one day to another, where nothing shows that
/// they repeat better: a change since a baseline must be larger. Mechanics: temperature and load change friction by as
/// much (Bittencourt and Axelsson 2014).
pub(in crate::diagnosis) const REPEATS: f64 = 0.02;
/// A law on another joint is a rival from this share of a candidate's gain on. Judgement: saves time; a rival with
/// less cannot come ahead by what whitening changes. Not measured.
pub(in crate::diagnosis) const COMPARABLE: f64 = 0.5;
/// Most such rivals that a candidate is compared with. Judgement: saves time.
pub(in crate::diagnosis) const MOST_COMPARED: usize = 6;
/// Least part of a law's torque that a rival in the model leaves, for the two to explain different things. Statistics: where
/// less than half of it stays, most of what it explained is the rival's as well.
pub(in crate::diagnosis) const LEAST_KEPT: f64 = 0.5;
/// Part of a wave's amplitude that rows must let through for its law to be judged on them: where most of it is smoothed away,
/// what is left of it depends on the smoothing. Judgement; torque_ripple in `docs/concealment.md`.
pub(in crate::diagnosis) const WAVE_SEEN: f64 = 0.5;
/// Least change of a joint's friction torque that is named, as a share of it. Judgement: a user acts on no less.
pub(in crate::diagnosis) const LEAST_FRICTION_CHANGE: f64 = 0.05;
/// Displacement, as a fraction of a joint's travel, over which friction builds up after a reversal in the nuisance
/// column: the shortest of the grid of the law itself. Mechanics.
pub(in crate::diagnosis) const PRESLIDING_NUISANCE: f64 = 0.002;
/// Standard deviation of the gain of a drive about what its data sheet says: makers give tolerances of a tenth, twice this.
pub(in crate::diagnosis) const GAIN_DEVIATION: f64 = 0.05;
/// Where the parts of the acceleration begin that may be noise of the encoder, as a fraction of the rate of the rows:
/// octaves below the highest frequency that they show. Statistics.
pub(in crate::diagnosis) const NOISE_OCTAVES: [f64; 3] = [0.0625, 0.125, 0.25];
/// Most of the noise's squares that columns an octave wide may miss: its share of the acceleration grows from none to all,
/// and is described to within a half. Statistics.
pub(in crate::diagnosis) const NOISE_MISSED: f64 = 0.25;
