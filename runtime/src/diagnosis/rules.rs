//! Every threshold of the diagnosis: what it decides, why it has this value, and which committed figure moves with it.
//!
//! Three kinds of reasons: *statistics* (a level of a test, a degree of freedom), *mechanics* (what filters, gears and
//! motions do), and *judgement* (a value between two that were seen to fail; the figures named show what it does).
//! What a user may set is in [`Settings`](super::Settings), whose defaults are here too.
//!
//! The figures: `docs/concealment.md` (long motions), `docs/concealment_short.md` (one short motion),
//! `docs/evidence.md` (real recordings).

// ---- Defaults of the settings -------------------------------------------------------------------------------------

/// Half-width of the slow window, s: half of the amplitude passes at 11 Hz, above which friction, load and bodies of a
/// moving arm change nothing. Mechanics; `docs/evidence.md`, all figures.
pub(super) const SLOW_WINDOW: f64 = 0.045;
/// Half-width of the fast window, s: half of the amplitude passes at 25 Hz, where gears ripple and transmissions ring.
/// Mechanics; ripple, elasticity and backlash in `docs/concealment.md`.
pub(super) const FAST_WINDOW: f64 = 0.020;
/// Fraction of a joint's top speed below which it counts as standing still: above the noise of speeds that encoders
/// give. Judgement; the friction effects in `docs/concealment.md`.
pub(super) const STANDSTILL: f64 = 0.015;
/// Least explained fraction of a joint's held-out squares. Judgement: below it, what is right is of no use, and small
/// errors of the standard model are named as effects; false namings in `docs/concealment.md`.
pub(super) const LEAST_EXPLAINED_FRACTION: f64 = 0.12;
/// Least confidence. Statistics: of two hundred recordings that lack nothing one seems to lack something; false namings in both
/// concealment pages.
pub(super) const LEAST_CONFIDENCE: f64 = 0.995;
/// The level is so many times as high where all that was found in the end are laws of the catalogue. Statistics: of a thousand
/// recordings that lack nothing one is told to lack something. A law over any variables pays for thousands of tries as if each
/// were another chance, while splines over a few variables are nearly each other: it needs no more than the level.
pub(super) const LEVEL_OF_CATALOGUE: f64 = 0.2;
/// The level is so many times as high once a law is in the model: a gate in front of the other tests, which alone says whether
/// anything is missing (Dmitrienko and Tamhane 2007). Statistics: one false naming in a hundred rounds.
pub(super) const LEVEL_BESIDE_LAWS: f64 = 2.0;
/// Searches of their own that a recording goes through: laws, lines, contacts, skew. The chance of a false naming is shared
/// among them. Statistics.
pub(super) const SEARCHES: f64 = 4.0;
/// Most effects that are named. Judgement: more than any recording of the evidence has; stops a search that
/// would fit what no law describes.
pub(super) const MOST_EFFECTS: usize = 12;

// ---- Preparation --------------------------------------------------------------------------------------------------

/// Highest cut-off of the filter of positions and torques, Hz. Mechanics: more than twice the band of the fast
/// window, so that the filter leaves that band alone. All figures.
pub(super) const HIGHEST_CUTOFF: f64 = 60.0;
/// The cut-off is at most the sampling rate over this: a filter closer to half of the rate warps. Mechanics.
pub(super) const RATE_PER_CUTOFF: f64 = 5.0;
/// Samples a second that are kept: eight times the highest cut-off, so that nothing is lost. Mechanics.
pub(super) const SAMPLES_PER_SECOND: f64 = 500.0;
/// The fast rows' limit of standstill is the slow rows' over this: the narrower window reaches less far into a
/// standstill. Judgement; ripple and backlash in `docs/concealment.md`.
pub(super) const FAST_STANDSTILL_DIVISOR: f64 = 1.5;
/// A recording shorter than this, s, has no rows to spare: slow effects are smoothed no more than fast ones.
/// Judgement; `docs/concealment_short.md`.
pub(super) const SHORT_RECORDING: f64 = 12.0;
/// Segments that few motions are split into, all together: enough that two may disagree.
/// Judgement; `docs/concealment_short.md`.
pub(super) const SEGMENTS_OF_FEW_MOTIONS: usize = 8;
/// From this many motions on, whole motions are held out: two remain to fit. Statistics.
pub(super) const ENOUGH_MOTIONS: usize = 3;
/// Least rows of a joint that laws are looked for on. Statistics: three for each number that only its own rows can
/// tell, viscous and Coulomb friction, offset, and a law.
pub(super) const LEAST_ROWS: usize = 12;
/// Least rows of all joints for each parameter that they determine. Statistics: as many degrees of freedom as
/// parameters.
pub(super) const ROWS_PER_PARAMETER: usize = 2;
/// A column of which less than this fraction of its norm is its own counts as not determined. Judgement: its
/// standard deviation is then 1e4 times that of a column by itself.
pub(super) const UNDETERMINED: f64 = 1e-4;
/// Where more than one parameter out of this many is not determined, or a joint holds still, columns that nothing
/// determines are left out instead of being kept small. Judgement: with a few that are not, effects are still found
/// (`docs/evidence.md`, UR10e).
pub(super) const PARAMETERS_PER_UNDETERMINED: usize = 4;
/// The recording is refused where the standard model explains less of the torque's squares, per cent. Judgement: far
/// below any right model, above what wrong units or a wrong joint order leave; not measured.
pub(super) const LEAST_EXPLAINED_BY_MODEL: f64 = 40.0;
/// Part of the samples of a joint that its top speed is not below: single spikes do not set it. Statistics.
pub(super) const TOP_SPEED_PERCENT: usize = 98;
/// Least inertia behind a transmission, as a part of that with the rotor. Mechanics: no division by zero.
pub(super) const LEAST_LINK_INERTIA: f64 = 1e-3;
/// Rounds in which a skew is taken out: the second takes what linearisation left of the first. Mechanics.
pub(super) const DELAY_ROUNDS: usize = 2;
/// So many times its standard deviations a reference's parameters may be off while the skew is measured. Statistics: it says
/// nothing of what motion determines, and all of what it does not.
pub(super) const LOOSE_REFERENCE: f64 = 1e3;
/// A skew of fewer samples is left to its column. Mechanics: within one sample, linear interpolation is exact enough.
pub(super) const DELAY_TAKEN_OUT: f64 = 0.75;
/// Standard deviation of skews before anything is known of one, s, a sample at least. Mechanics: filters of currents, buses and
/// cycles of controllers delay by milliseconds.
pub(super) const DELAY_DEVIATION: f64 = 0.01;
/// A delay is named from this many samples on: a smaller one is part of sampling. Mechanics; time_delay in
/// `docs/concealment.md`.
pub(super) const NAMED_DELAY_SAMPLES: f64 = 0.75;
/// A delay is named from this duration on, s. Mechanics: drives sample currents within a millisecond.
pub(super) const NAMED_DELAY: f64 = 1e-3;

// ---- Rows and fits ------------------------------------------------------------------------------------------------

/// Longest block of motion, s, longer than residuals of a robot in motion are correlated. Judgement; both concealment
/// pages.
pub(super) const LONGEST_BLOCK: f64 = 0.5;
/// Least part of a block's squares that a fit is taken to leave. Numerics: a block that alone tells a parameter leaves none;
/// effects in `docs/coverage.md`.
pub(super) const LEAST_OF_A_BLOCK: f64 = 0.1;
/// From this many blocks of that length on, gains are compared block by block. Judgement: with fewer,
/// Student's tail is so long that hundreds of comparisons leave nothing certain; `docs/concealment_short.md`.
pub(super) const ENOUGH_BLOCKS: usize = 24;
/// Relative ridge of a fit: what is not determined stays small. Mechanics: far below any part that counts
/// as own, far above rounding.
pub(super) const FIT_RIDGE: f64 = 1e-10;
/// Most rounds of weights from the residuals' own standard deviations. Judgement: they have converged; not measured.
pub(super) const WEIGHT_ROUNDS: usize = 6;
/// Relative change of these standard deviations at which the rounds end. Numerics: far below how well they are known.
pub(super) const WEIGHTS_AT_REST: f64 = 1e-9;
/// Least standard deviation of a joint relative to its largest torque: noise-free recordings stay finite. Mechanics.
pub(super) const LEAST_RELATIVE_SIGMA: f64 = 1e-9;
/// Least standard deviation of a joint, N.m or N: the same for a joint without torque. Mechanics.
pub(super) const LEAST_SIGMA: f64 = 1e-12;

// ---- Partial regression and judgement -----------------------------------------------------------------------------

/// Least fraction of a trial column's squares that the design does not make: below it, the column is the design's, and what
/// is left of it is what is wrong with either. Judgement: no column of a real robot is right to better than a hundredth of
/// its torque.
pub(super) const OWN_FRACTION: f64 = 2e-4;
/// The same of a derivative of the model, which is wrong in the same way as the model's own columns: what an error of the
/// table or of the time adds is nearly that of other inertias, and shows by a thousandth of its torque. Mechanics: ten
/// thousand times [`FIT_RIDGE`], below which the part of its own is what the ridge leaves.
pub(super) const OWN_FRACTION_OF_DERIVATIVE: f64 = 1e-6;
/// Relative ridge of a candidate's amplitudes. Mechanics, as [`FIT_RIDGE`], for columns that nearly agree.
pub(super) const AMPLITUDE_RIDGE: f64 = 1e-7;
/// What one more number must gain to be worth it, in units of the noise variance (Akaike 1974). Statistics.
pub(super) const AIC_PENALTY: f64 = 2.0;
/// The fitted fraction must be this part of the held-out one that is asked for: a gain in prediction without one in
/// the fit is an accident of extrapolation. Judgement; false namings.
pub(super) const FITTED_TO_HELD_OUT: f64 = 0.5;
/// A single motion is cut at these eighths: what comes before is fitted and predicts what comes after.
/// Judgement: most of a motion is needed to determine the standard parameters; `docs/concealment_short.md`.
pub(super) const FORWARD_CUTS: [usize; 2] = [5, 6];
/// Share of what held-out stretches leave open from which on a law need not hold forward in time: without it the parameters
/// that are extrapolated are no model of the motion. Judgement.
pub(super) const MOST_OF_WHAT_IS_OPEN: f64 = 0.75;
/// Standard deviations of a gain, by the error of parameters that were fitted elsewhere, from which on a loss is that of the
/// law. Statistics: one in forty of losses by that error alone is larger.
pub(super) const LOST: f64 = 2.0;
/// Of the stretches of few motions, one in so many may lose: an effect may leave some of them untouched. Judgement.
pub(super) const STRETCHES_PER_LOSS: usize = 4;
/// Of whole motions, one in so many may lose. Judgement.
pub(super) const MOTIONS_PER_LOSS: usize = 6;

// ---- Evidence -----------------------------------------------------------------------------------------------------

/// Shifts in time that a waveform is compared with. Statistics: enough for the standard deviation of a correlation to
/// 7 %.
pub(super) const SHIFTS: usize = 100;
/// Shifts next to zero that count as the waveform itself. Statistics.
pub(super) const SHIFTS_LEFT_OUT: usize = 2;
/// Shortest block, s: two rows of the slow window. Mechanics.
pub(super) const SHORTEST_BLOCK: f64 = 0.1;
/// Blocks are this many times as long as the residual's decorrelation lag. Judgement, as the tests of `significance`
/// have it.
pub(super) const LAGS_PER_BLOCK: usize = 2;
/// Autocorrelation below which residuals count as uncorrelated: 4 % of the variance in common. Judgement.
pub(super) const UNCORRELATED: f64 = 0.2;
/// A law of time must be there with this confidence whichever unit of the recording is left out: else it is an event for all
/// that is known. Statistics: a test of its own, of one law.
pub(super) const WITHOUT_ANY_UNIT: f64 = 0.99;
/// Part of its squares that a transient may have left when it has faded. Judgement: two time constants.
pub(super) const FADED: f64 = 0.02;
/// A transient has faded before so large a part of the shortest motion begins: what follows the recording has none of it.
/// Judgement; TX-40 in `docs/evidence.md`, where it is over before half of the motion.
pub(super) const LATE: f64 = 0.25;
/// A body lies within so many times the lengths of the robot's table of the link that carries it. Mechanics: what is
/// farther away than the robot reaches from end to end and back is not carried by it; the last link's own length is not in
/// the table.
pub(super) const BODY_REACH: f64 = 2.0;
/// Ten numbers are no body where one would explain as little as that with less probability. Judgement: one in a thousand
/// bodies is not named.
pub(super) const NO_BODY: f64 = 1e-3;
/// Fewest blocks for a mean gain. Statistics: three degrees of freedom.
pub(super) const LEAST_BLOCKS: f64 = 4.0;
/// Highest confidence that is told. Judgement: no model of noise is right beyond it.
pub(super) const HIGHEST_CONFIDENCE: f64 = 0.9999;
/// How often something that is no accident has the right name on the right joint. Measured: 429 of the 458 findings of
/// hidden effects in `docs/calibration.md` and of one more run of the same kind.
pub(super) const RIGHT_NAMES: f64 = 0.94;
/// Two laws are told apart where the better one is so by accident with less than this probability. Statistics: the
/// usual 5 %; `cannot_tell` in `docs/evidence.md`.
pub(super) const TOLD_APART: f64 = 0.05;

// ---- Calibration --------------------------------------------------------------------------------------------------
// What a law's statistic is where nothing has changed is measured: between units of the baseline, or of the recording.

/// Share of the level of a law in noise of uneven sizes that goes to the test by signs: where it decides, it is certain by
/// orders of magnitude, and the other one should hardly be the weaker for it.
pub(super) const LEVEL_OF_SIGNS: f64 = 0.1;

/// Highest order of the autoregression that makes a residual white. Statistics: half a second of slow rows; the order
/// itself is chosen by the Bayesian information criterion.
pub(super) const HIGHEST_AR_ORDER: usize = 12;
/// Fewest pairs of rows that an order is estimated from. Statistics: a reflection coefficient of so many has a fifth
/// as its standard deviation.
pub(super) const LEAST_AR_PAIRS: usize = 20;
/// Shortest and longest unit of a baseline, s, and never longer than the recording's motions: a law must show in one,
/// and what differs between days or poses must not be averaged away. Statistics; not measured on shorter ones.
pub(super) const UNIT_OF_BASELINE: [f64; 2] = [1.0, 12.0];
/// Shortest and longest unit where a recording is compared with itself, s. Statistics.
pub(super) const UNIT_OF_ITSELF: [f64; 2] = [1.0, 8.0];
/// Units that are wanted, where they are not too short or long. Statistics: a variance of so many has half of its size
/// as its standard deviation, and a law is certain at a level of 1e-4 from six standard errors on.
pub(super) const UNITS_WANTED: f64 = 10.0;
/// Relative ridge of the regressions on white rows. Numerics.
pub(super) const CALIBRATION_RIDGE: f64 = 1e-10;
/// A law that keeps this part of the squares that only it explains when another joins the model, on other joints, was not
/// imitating that one. A law that keeps it with amplitudes of its own sign may have these; one that explains it of what two
/// of its cases do takes their place. Judgement: two laws that share a tenth of their squares are told apart; saves time.
pub(super) const KEPT_BESIDE: f64 = 0.9;
/// A law that takes away this part of the squares of another joint's residual has changed what is noise there.
/// Judgement: below it, the noise is the same as before; saves time.
pub(super) const FREED: f64 = 0.01;
/// Directions of a law with less than this part of its squares are rounding. Numerics.
pub(super) const LEAST_EIGENVALUE: f64 = 1e-6;
/// Torques of a joint repeat to this share of their root mean square from one day to another, where nothing shows that
/// they repeat better: a change since a baseline must be larger. Mechanics: temperature and load change friction by as
/// much (Bittencourt and Axelsson 2014).
pub(super) const REPEATS: f64 = 0.02;
/// A law on another joint is a rival from this share of a candidate's gain on. Judgement: saves time; a rival with
/// less cannot come ahead by what whitening changes. Not measured.
pub(super) const COMPARABLE: f64 = 0.5;
/// Most such rivals that a candidate is compared with. Judgement: saves time.
pub(super) const MOST_COMPARED: usize = 6;
/// Least part of a law's torque that a rival in the model leaves, for the two to explain different things. Statistics: where
/// less than half of it stays, most of what it explained is the rival's as well.
pub(super) const LEAST_KEPT: f64 = 0.5;
/// Part of a wave's amplitude that rows must let through for its law to be judged on them: where most of it is smoothed away,
/// what is left of it depends on the smoothing. Judgement; torque_ripple in `docs/concealment.md`.
pub(super) const WAVE_SEEN: f64 = 0.5;
/// Least change of a joint's friction torque that is named, as a share of it. Judgement: a user acts on no less.
pub(super) const LEAST_FRICTION_CHANGE: f64 = 0.05;
/// Displacement, as a fraction of a joint's travel, over which friction builds up after a reversal in the nuisance
/// column: the shortest of the grid of the law itself. Mechanics.
pub(super) const PRESLIDING_NUISANCE: f64 = 0.002;
/// Standard deviation of the gain of a drive about what its data sheet says: makers give tolerances of a tenth, twice this.
pub(super) const GAIN_DEVIATION: f64 = 0.05;
/// Where the parts of the acceleration begin that may be noise of the encoder, as a fraction of the rate of the rows:
/// octaves below the highest frequency that they show. Statistics.
pub(super) const NOISE_OCTAVES: [f64; 3] = [0.0625, 0.125, 0.25];
/// Most of the noise's squares that columns an octave wide may miss: its share of the acceleration grows from none to all,
/// and is described to within a half. Statistics.
pub(super) const NOISE_MISSED: f64 = 0.25;

// ---- Search -------------------------------------------------------------------------------------------------------

/// Most candidates of a round whose evidence is worked out. Times only: those further down explain too little.
pub(super) const MOST_CHECKED: usize = 30;
/// Part of what is open from which on a law is judged by the best shape between those of the grid. Statistics: a grid leaves up
/// to a twentieth of a law, which beside a law that explains less is less than a twentieth of the rest.
pub(super) const EXPLAINS_MOST: f64 = 0.5;
/// How many of them go through the gate at a time. Times: threads have work, and little of it is for nothing.
pub(super) const GATES_AHEAD: usize = 4;
/// Part of the error of all joints that must stay for the joint on which most is gained to be told too. Words only.
pub(super) const SHOWS_IN_ALL: f64 = 0.95;
/// Rivals that are told. Words only.
pub(super) const RIVALS: usize = 5;
/// A law is tried as the first of a pair where its p-value is below this. Judgement: lets one in a hundred accidents
/// be tried, each second law is then tested with all comparisons counted; `docs/concealment_short.md`.
pub(super) const FIRST_OF_PAIR: f64 = 0.01;
/// Most laws that are tried as the first of a pair, those that gain most. Times only.
pub(super) const MOST_FIRSTS: usize = 12;
/// An accepted effect stays where it explains this part of the fraction that was asked of it. Judgement: others that
/// came later explain some of it too.
pub(super) const KEPT_FRACTION: f64 = 0.6;
/// An effect that was accepted stays up to this many times the level that it had to pass. Statistics: stepwise regression
/// asks less to stay than to enter (Efroymson 1960), or what is near the level comes and goes.
pub(super) const LEVEL_TO_STAY: f64 = 5.0;
/// Factors on the rate that are tried before anything else; smaller errors are found as a law. Seconds read as
/// milliseconds, a decimation that was forgotten, a double rate.
pub(super) const RATE_FACTORS: [f64; 6] = [0.001, 0.1, 0.5, 2.0, 10.0, 1000.0];
/// Least logarithm of a factor that is taken. Judgement: a smaller error is a law among others, which other lengths of the
/// table may imitate.
pub(super) const RATE_LEAST: f64 = 0.4;
/// A factor is taken where it leaves this part of the squares of the standard model, in the mean of the joints' logarithms.
/// Judgement: no other physics is imitated so well by a time that runs otherwise.
pub(super) const RATE_LEAVES: f64 = 0.5;
/// No joint may be left with so many times its squares. Which rows stand still differs between rates, and noise with them;
/// on recordings whose times are right, a factor leaves some joint with ten times its squares and more.
pub(super) const RATE_WORSENS: f64 = 1.25;
/// Around the best of the factors it is refined within this, in the logarithm: a factor of five. Numerics.
pub(super) const RATE_SPAN: f64 = 1.6;
/// Golden sections of that: to a thousandth. Numerics.
pub(super) const RATE_REFINED: usize = 16;
/// Most rounds in which it is then refined by its law. Numerics: one is enough where the rest fits.
pub(super) const RATE_ROUNDS: usize = 3;
/// Largest error, in units of its number, along the way to which derivatives are taken: an exponential factor of two.
/// Judgement.
pub(super) const LARGEST_ERROR: f64 = 0.7;
/// Refits after which columns that follow the standard parameters have converged. Judgement; not measured.
pub(super) const REFITS: usize = 2;
/// Most of them where a term changes the number that its own column is the derivative by. Judgement; not measured.
pub(super) const REFITS_OF_BENT_COLUMNS: usize = 4;
/// Errors that change by no more than this part of themselves have converged. Statistics: a tenth of a standard deviation of one
/// that is known to a hundredth.
pub(super) const SETTLED_ERROR: f64 = 1e-3;

/// Shapes that a refinement tries at most. Times, and how sharp a resonance is; joint_elasticity in
/// `docs/concealment.md`.
pub(super) const MOST_EVALUATIONS: usize = 80;
/// A refinement ends when its steps are this part of the first ones. Judgement: finer than shapes are known.
pub(super) const SMALLEST_STEP: f64 = 0.02;
/// Shapes from which the best of a compliant transmission is looked for, each of another frequency. Times; what is in step
/// with a motion at one frequency is so again a fifth higher or lower, and six are an octave.
pub(super) const MOST_STARTS: usize = 6;
/// Rounds over all laws in which each shape goes to the least squares beside the others. Judgement: the second finds
/// hardly anything.
pub(super) const SHARPENING_SWEEPS: usize = 2;
/// Steps of one law in a round at most, and how often a step that finds nothing is halved. Numerics: Gauss-Newton steps
/// double the digits each time where they lead anywhere.
pub(super) const MOST_STEPS: usize = 12;
pub(super) const HALVINGS: i32 = 5;
/// Longest step of the logarithm of a number of a shape. Numerics: a derivative says little of twice the number.
pub(super) const LONGEST_STEP: f64 = 0.5;
/// What is left has to fall by this part for another step. Numerics: a tenth of a standard deviation, with some thousand
/// rows, is 1e-6 of the squares.
pub(super) const LEAST_FALL: f64 = 1e-6;

// ---- Laws over any variables --------------------------------------------------------------------------------------

/// A law over any variables explains at least this part of what held-out motion leaves of its joint beyond noise. What it
/// says: the torque that is missing depends on these variables and on nothing else, which is wrong where it is not most
/// of it.
pub(super) const FREE_FORM_SHARE: f64 = 0.5;
/// Such a law is looked for where this part of what remains of a joint is the same two rows later, and so no noise: twice
/// the least fraction of a law, of which it must explain half.
pub(super) const SLOW_PART_OF_REMAINS: f64 = 0.25;
/// A law of the catalogue that explains this part of what such a law does is not displaced by it: as where a spring
/// suffices for a curve over the position. Judgement.
pub(super) const NEARLY_AS_MUCH: f64 = 0.75;
/// Relative ridge of the amplitudes of such a law. Statistics: where each column may be as large as what remains of a
/// joint, the ridge of the posterior mean is one over the rows (Hoerl and Kennard 1970), of which a joint has hundreds;
/// without it, bends that one motion does not determine are predicted for another.
pub(super) const CURVE_RIDGE: f64 = 1e-3;
/// Part of a variable's values beyond each end of the interval that curves are over. Statistics: single spikes do not
/// stretch it.
pub(super) const FREE_FORM_TAIL: f64 = 0.001;
/// Most single variables that are judged on held-out motion. Times only: more than are told.
pub(super) const FREE_FORM_SINGLES: usize = 12;
/// Most pairs of variables that are judged on held-out motion, and as many with the best variable alone. Times only.
pub(super) const FREE_FORM_PAIRS: usize = 8;

// ---- Order spectra ------------------------------------------------------------------------------------------------

/// Highest order per motor turn: beyond the sixth harmonic of a motor's torque. Mechanics; torque_ripple.
pub(super) const HIGHEST_ORDER: f64 = 7.0;
/// Gear that is assumed where a smaller one or none is known: few robots have a larger one. Mechanics.
pub(super) const ASSUMED_GEAR: f64 = 100.0;
/// Most orders of a spectrum. Times only.
pub(super) const MOST_ORDERS: usize = 600;
/// Periods that must fit into the travel. Statistics: fewer are a slow curve over the position.
pub(super) const LEAST_PERIODS: f64 = 4.0;
/// Orders are this many waves over the travel apart: 2.5 within the width of a peak. Statistics.
pub(super) const ORDER_STEP: f64 = 0.4;
/// Part of half of the sampling rate up to which a wave is fitted. Mechanics.
pub(super) const PART_OF_NYQUIST: f64 = 0.6;
/// Samples a second that a spectrum uses. Times only.
pub(super) const SPECTRUM_RATE: f64 = 1000.0;
/// Fewest samples of a spectrum's value. Statistics.
pub(super) const LEAST_SAMPLES: f64 = 100.0;
/// Spectra use samples faster than this many times the standstill speed: the noise of the sign is gone. Mechanics.
pub(super) const SPECTRUM_STANDSTILL_FACTOR: f64 = 3.0;
/// A peak stands out above this many medians. Statistics: of Rayleigh's amplitudes one in 6e4 does.
pub(super) const PEAK_OVER_MEDIAN: f64 = 4.0;
/// Peaks of a joint that are tried as ripple beside the orders of the catalogue. Judgement.
pub(super) const PEAKS: usize = 2;

// ---- Contact ------------------------------------------------------------------------------------------------------

/// An instant counts as pushed when its mean squared residual passes this many noise variances. Judgement; contact in
/// `docs/concealment.md`, false contacts in `docs/evidence.md`.
pub(super) const PUSHED: f64 = 14.0;
/// A single joint counts as pushed beyond this many standard deviations. Statistics: one in 2000 of a normal.
pub(super) const JOINT_PUSHED: f64 = 3.5;
/// Joints that must be pushed together. Mechanics: what pushes one joint alone is inside of it.
pub(super) const PUSHED_TOGETHER: usize = 2;
/// Shortest push and longest gap within one, s: shorter bursts are impacts inside of the robot. Mechanics.
pub(super) const SHORTEST_PUSH: f64 = 0.15;
/// A push is an exception: together at most this fraction of the motion. Judgement.
pub(super) const LARGEST_PUSHED_FRACTION: f64 = 0.35;
/// One force on one link must explain this fraction of the squares of a window. Judgement; false contacts.
pub(super) const FORCE_EXPLAINS: f64 = 0.7;
/// The force of the neighbouring instants must explain this fraction: a push is smooth. Judgement; false contacts.
pub(super) const FORCE_PREDICTS: f64 = 0.75;
/// Fewest instants of a window: one needs a neighbour to each side. Mechanics.
pub(super) const LEAST_INSTANTS: usize = 3;
/// A link further in must leave this fraction of what the next link out leaves: the same force seen from there is
/// nearly as good. Judgement; the link in `docs/concealment.md`.
pub(super) const INNER_LINK_BETTER: f64 = 0.6;
/// Time before and after a window that no row may use, s: the reach of the slow window. Mechanics.
pub(super) const CONTACT_MARGIN: f64 = 0.05;
/// A contact remains while its instants pass this part of [`PUSHED`] with the effects in the model. Judgement.
pub(super) const REMAINING_FRACTION: f64 = 0.5;
/// Rounds of the robust fit. Judgement: its weights have converged; not measured.
pub(super) const ROBUST_ROUNDS: usize = 20;
/// Mean squared residual, in noise variances, at which the robust weight (Cauchy's) is one half. Judgement:
/// Cauchy's usual 2.385² for one row, less as all joints of an instant share a weight.
pub(super) const ROBUST_SCALE: f64 = 3.0;
/// Points that a law is drawn by, of equal width. Judgement: a picture is some 700 pixels wide.
pub(super) const FINE_BINS: usize = 300;
/// Standard deviation of a normal per median absolute deviation. Statistics.
pub(super) const SIGMA_PER_MAD: f64 = 1.4826;
/// Least robust standard deviation relative to the joint's largest torque: noise-free recordings. Mechanics.
pub(super) const LEAST_ROBUST_SIGMA: f64 = 1e-6;
/// Relative ridge of the robust fit. Mechanics.
pub(super) const ROBUST_RIDGE: f64 = 1e-11;
/// Relative ridge of a force at one instant: directions that no joint feels stay zero. Mechanics.
pub(super) const FORCE_RIDGE: f64 = 1e-6;
/// Absolute ridge of the same, for a pose in which no joint feels anything. Mechanics.
pub(super) const FORCE_RIDGE_ABSOLUTE: f64 = 1e-12;

// ---- Contact with a robot that holds still ------------------------------------------------------------------------

/// Static friction is at most this many times the Coulomb friction of the moving joint, but for one joint in a
/// hundred. Mechanics: dry gears break away at 1.1 to 1.3 times what they slide at.
pub(super) const STICTION: f64 = 1.25;
/// Standard normal deviate that is passed once in a hundred times: what ties [`STICTION`] to a spread. Statistics.
pub(super) const ONE_IN_A_HUNDRED: f64 = 2.326_347_874;
/// Shortest push against a robot at rest, s: what is shorter is an impact. Mechanics.
pub(super) const SHORTEST_PUSH_AT_REST: f64 = 0.2;
/// Torques at rest are averaged over this long, s. Mechanics: a hand does not push faster.
pub(super) const AVERAGED_AT_REST: f64 = 0.1;
/// Gaps of a push at rest shorter than this belong to it, s. Mechanics.
pub(super) const GAP_AT_REST: f64 = 0.1;
/// Shortest time of standing still that is looked at, s. Mechanics: twice a shortest push.
pub(super) const SHORTEST_REST: f64 = 0.5;
/// After a motion the robot has come to rest by this time, s, and pushes off by as much before it is seen to move.
/// Mechanics: a few periods of a position loop.
pub(super) const SETTLING: f64 = 0.3;
/// Time from one instant of a push at rest to the next at which a force is looked for, s. Times only.
pub(super) const FORCE_STEP_AT_REST: f64 = 0.02;

// ---- Contact in motion, joint by joint ----------------------------------------------------------------------------

/// Window lengths that means of a residual are taken over, s: pushes of 0.15 to 2.4 s, each length covered to 1.5
/// times. Mechanics; power in the tests of `scan`.
pub(super) const SCAN_LENGTHS: [f64; 9] = [0.15, 0.2, 0.3, 0.4, 0.5, 0.7, 1.0, 1.6, 2.4];
/// Shortest window, rows. Statistics: a half wave has a beginning, a height and an end.
pub(super) const SCAN_SHORTEST: usize = 3;
/// Windows of a length are this part of it apart. Statistics: a half wave beside itself by half of that has lost less than
/// a hundredth of its square.
pub(super) const SCAN_STEPS: usize = 8;
/// Least fraction of a half wave's squares that smooth curves over the joint's own state do not make. Judgement: with less,
/// what is seen may as well be a law of a state that no other part of the motion visits.
pub(super) const SCAN_OWN_SHAPE: f64 = 0.4;
/// Least fraction of what these curves leave of a half wave that the columns of the model do not make. Judgement: with less the
/// model is extrapolated to the window, and an error of a tenth in how its columns are made looks like a push.
pub(super) const SCAN_LEFT_BY_MODEL: f64 = 0.2;
/// Rows for each knot of these curves. Statistics: curves over a state are curves over time, too, and those of so many knots
/// make a fifth of a half wave.
pub(super) const SCAN_ROWS_PER_KNOT: usize = 150;
/// Least and most knots of these curves. Judgement: a line, and a curve that follows what a law of friction does.
pub(super) const SCAN_KNOTS: [usize; 2] = [2, 8];
/// Length of the stretches whose largest means the law is fitted to, s. Statistics: a dozen of them in a recording of
/// half a minute, each with many independent means.
pub(super) const SCAN_STRETCH: f64 = 2.0;
/// Least fraction of the rows of a stretch. Statistics: with fewer its largest window is one of too few.
pub(super) const SCAN_FILLED: f64 = 1.0 / 3.0;
/// How often the few largest stretches of a joint make the tail of its law longer by accident. Statistics: every joint of a
/// recording is asked, and one whose tail is taken for three times as long hides a push.
pub(super) const SCAN_LONGER_TAIL: f64 = 0.01;
/// Standard deviation of the edges of a push for its shape, as a part of its length: the half wave that fits a rectangle
/// best is longer by as much on each side, that of a squared sine shorter. Of its mean torque, too. Mechanics.
pub(super) const SCAN_EDGE: f64 = 0.1;
/// A push whose half wave is shorter than this, s, is an impact inside of the robot. Mechanics: four fifths of
/// [`SHORTEST_PUSH`], as a half wave is shorter than a push that begins and ends gently by [`SCAN_EDGE`] on each side.
pub(super) const SCAN_IMPACT: f64 = 0.12;
/// Least fraction of a window's rows that must be there: a joint that reverses has none. Judgement.
pub(super) const SCAN_PRESENT: f64 = 0.7;
/// False alarms per recording in which nothing else was found. Statistics: one in five thousand, of which the candidates that
/// are left out of what they are compared with make one in a thousand; size and power in the tests of `scan`.
pub(super) const SCAN_LEVEL: f64 = 2e-4;
/// The same beside laws, and where laws were found that could not be told apart or kept. Judgement: a law that is fitted nearly
/// right, or not at all, leaves short waves where it acts, which the law of the largest means knows nothing of, and of which
/// joints feel the same; pushes of a hand are mostly far beyond.
pub(super) const SCAN_LEVEL_BESIDE_LAWS: f64 = 1e-6;
/// Pushes on single joints, at least so many, are a law where one over any variables leaves at most one in so many of them.
/// Judgement: a hand does not come back with the state of the robot, and what does is predicted on motion that was held out.
pub(super) const RECURRING: usize = 2;
/// A push whose half wave is longer than this, s, is none. Mechanics: what lasts longer than the longest window goes on as slowly
/// as the motion does, and a law that acts as long as a stroke looks like it.
pub(super) const SCAN_LONGEST: f64 = 2.7;
/// Windows that one of so many recordings has by accident do not count among what the residual does by itself until they have
/// turned out to be no pushes. Statistics: hardly anything is left out of noise.
pub(super) const SCAN_SUSPECT: f64 = 0.05;
/// Rows that a joint needs to be scanned. Statistics: for the autoregression of its residual.
pub(super) const SCAN_LEAST_ROWS: usize = 60;
/// Fewest stretches that the law of largest means is fitted to. Statistics: quartiles.
pub(super) const SCAN_LEAST_STRETCHES: usize = 8;
/// Stretches that count as much as all joints together for the law of one joint. Statistics: size against power in the
/// tests of `scan`.
pub(super) const SCAN_OWN_STRETCHES: f64 = 40.0;
/// Independent windows of all lengths in a stretch. Statistics: the square that the largest of a stretch of noise mostly is, 5.4,
/// is passed by one normal deviate in fifty.
pub(super) const SCAN_INDEPENDENT: f64 = 50.0;
/// Least scale of the largest squares: that of normal deviates, whose squares fall as exp(-x/2) / sqrt(x), around
/// x = 10, where the largest of a stretch are. Statistics.
pub(super) const SCAN_NORMAL_SCALE: f64 = 2.0 / 1.1;
/// Rows of a joint this close to its own reversals are not looked at, s. Mechanics: presliding, play and the ringing of a
/// gear die away within two periods of 20 Hz.
pub(super) const REVERSAL_LEFT_OUT: f64 = 0.1;
/// Nor are those at which it creeps, as a fraction of its top speed. Mechanics: friction at such speeds (Stribeck's, what
/// sticks and comes loose) is not that of the rest of the motion, and few rows show it: what one slow passage leaves is no
/// push.
pub(super) const CREEPING: f64 = 0.05;
/// A joint feels a push that was found on another one from this many standard deviations of its mean on. Statistics: one
/// in four hundred by accident.
pub(super) const FELT: f64 = 3.0;
/// Squares of the means that the force on another link may leave more than the best one, in units of the noise, and still
/// be as good. Statistics: the 95 % point of one degree of freedom.
pub(super) const LINKS_ALIKE: f64 = 3.84;
/// Most squares that a force may leave for each joint, in units of the noise. Judgement: a push whose joints disagree by
/// more than three standard deviations is told as their torques.
pub(super) const FORCE_LEAVES: f64 = 9.0;
/// Standard deviation of a force, as a part of it, from which on it is not told. Judgement.
pub(super) const UNDETERMINED_FORCE: f64 = 10.0;
/// Joints whose windows are this close together see the same push, s. Mechanics.
pub(super) const SCAN_TOGETHER: f64 = 0.2;
/// Windows of all lengths count as so many of one length for how the noise of two joints goes together there. Statistics: the
/// correlation of so many is known to a quarter.
pub(super) const SCAN_COMMON_WINDOWS: f64 = 30.0;
/// Values beyond so many standard deviations count as no more for the memory of a residual. Statistics.
pub(super) const SCAN_CLIPPED: f64 = 2.5;
/// Least variance of the noise of a row, as a part of the mean. Judgement: no sensor is free of noise where a joint bears nothing.
pub(super) const SCAN_LEAST_VARIANCE: f64 = 0.1;
/// Most coefficients of the autoregression of a residual. Statistics: a quarter of a second of fast rows.
pub(super) const SCAN_MOST_ORDER: usize = 12;

// ---- Lines of torque ripple ---------------------------------------------------------------------------------------

/// Orders per motor turn that cogging, current offsets, gear teeth and wave generators have. Mechanics.
pub(super) const LINE_MULTIPLES: [f64; 6] = [0.5, 1.0, 2.0, 3.0, 4.0, 6.0];
/// Part of the sampling rate up to which recorded torques are taken for what they say. Mechanics: four fifths of what
/// can be sampled at all.
pub(super) const RECORDED_BAND: f64 = 0.4;
/// Parts of that band in which a wave is sought. Mechanics: a position loop reaches a twentieth to a fifth of the rate at
/// which a robot is recorded, and its motor answers to no ripple that is faster.
pub(super) const LINE_BANDS: [f64; 4] = [1.0, 0.5, 0.25, 0.125];
/// Part of the cut-off of the positions below which a wave has its whole amplitude. Mechanics: there a filter of the fourth
/// order, forwards and backwards, lets 99.6 % of the acceleration through that a controller leaves of it.
pub(super) const LINE_FOLLOWED: f64 = 0.5;
/// Largest standard deviation of an amplitude from there, as a part of what all of the motion shows. Judgement: what is known
/// worse than by a third is told as the torque shows it, with a deviation of what it may lack.
pub(super) const LINE_TOLD: f64 = 1.0 / 3.0;
/// Orders of a spectrum that are looked at besides.
pub(super) const LINE_PICKED: usize = 4;
/// How far a known order must stand above the larger median of the orders on both sides of it to be a line of a motion.
/// Statistics: an amplitude of noise does once in 2,000 orders (`statistics::greatest_of`); how sure the line of all motions is,
/// of all orders that were tried, is judged besides.
pub(super) const LINE_ABOVE: f64 = 3.3;
/// The same for an order that was picked from a spectrum. Statistics: once in 60,000.
pub(super) const LINE_PICKED_ABOVE: f64 = 4.2;
/// Least fraction that one half of a motion predicts for the other. Judgement: a line worth its name; lines of noise
/// stay below 0.012.
pub(super) const LINE_LEAST_FRACTION: f64 = 0.02;
/// What is slower than so many waves is not the line. Mechanics.
pub(super) const LINE_SLOWER: f64 = 4.0;
/// Waves that each half of a motion must pass. Statistics.
pub(super) const LINE_LEAST_WAVES: f64 = 8.0;
/// Samples that each half must have. Statistics.
pub(super) const LINE_LEAST_SAMPLES: usize = 100;
/// Orders on each side that a line is compared with. Statistics: a median of sixteen on each side.
pub(super) const LINE_AROUND: usize = 16;
/// Steps of what the travel resolves that a line covers itself on each side. Mechanics: its main lobe.
pub(super) const LINE_COVERED: usize = 3;

// ---- Explanation --------------------------------------------------------------------------------------------------

/// A parameter is told to have shifted beyond this many standard deviations of the difference. Statistics.
pub(super) const SHIFTED: f64 = 3.0;
/// Step of a position, rad or m, over which the derivative of a torque is taken. Numerics: small against a turn, large
/// against rounding.
pub(super) const POSITION_STEP: f64 = 1e-4;
/// Step of a shape, relative to it, over which the derivative of its columns is taken. Mechanics: small against its
/// standard deviation, large against rounding.
pub(super) const SHAPE_STEP: f64 = 0.02;
/// The same for the derivative of a quantity.
pub(super) const QUANTITY_STEP: f64 = 1e-4;
/// Largest standard deviation of a shape that is told, relative to the shape. Judgement: beyond it nothing is known.
pub(super) const LARGEST_SHAPE_SIGMA: f64 = 10.0;
/// Standard deviation of a play, relative to it, where the joint rings above the band. Measured: every knock sets off a
/// ringing that is not seen, stiffness and damping are whatever leaves least of the knocks, and where between the flanks the
/// link is when the next one comes differs with them. A model of this kind is off by more than noise makes it
/// (model discrepancy, Kennedy and O'Hagan 2001): by 8 % (root mean square) in 53 simulated recordings of three robots.
pub(super) const PLAY_BESIDE_UNSEEN: f64 = 0.08;
/// Bins of a curve. Words and plots only.
pub(super) const BINS: usize = 40;
/// Part of a residual that a variable must order to be named. Words only.
pub(super) const ORDERED_BY_VARIABLE: f64 = 0.1;
/// Part of the mismatch of all joints below which a joint has none. Words only.
pub(super) const LEAST_MISMATCH: f64 = 0.02;
/// Fewest second differences that a noise floor is estimated from. Statistics: known to a quarter.
pub(super) const LEAST_DIFFERENCES: f64 = 10.0;
/// Part of what remains that must be more than noise to be told. Words only.
pub(super) const UNEXPLAINED: f64 = 0.3;
