//! The search: which laws are tried, fitted and kept.

/// Most candidates of a round whose evidence is worked out. Times only: those further down explain too little.
pub(in crate::diagnosis) const MOST_CHECKED: usize = 30;
/// Part of what is open from which on a law is judged by the best shape between those of the grid. Statistics: a grid leaves up
/// to a twentieth of a law, which beside a law that explains less is less than a twentieth of the rest.
pub(in crate::diagnosis) const EXPLAINS_MOST: f64 = 0.5;
/// How many of them go through the gate at a time. Times: threads have work, and little of it is for nothing.
pub(in crate::diagnosis) const GATES_AHEAD: usize = 4;
/// Part of the error of all joints that must stay for the joint on which most is gained to be told too. Words only.
pub(in crate::diagnosis) const SHOWS_IN_ALL: f64 = 0.95;
/// Rivals that are told. Words only.
pub(in crate::diagnosis) const RIVALS: usize = 5;
/// A law is tried as the first of a pair where its p-value is below this. Judgement: lets one in a hundred accidents
/// be tried, each second law is then tested with all comparisons counted; `docs/concealment_short.md`.
pub(in crate::diagnosis) const FIRST_OF_PAIR: f64 = 0.01;
/// Most laws that are tried as the first of a pair, those that gain most. Times only.
pub(in crate::diagnosis) const MOST_FIRSTS: usize = 12;
/// An accepted effect stays where it explains this part of the fraction that was asked of it. Judgement: others that
/// came later explain some of it too.
pub(in crate::diagnosis) const KEPT_FRACTION: f64 = 0.6;
/// An effect that was accepted stays up to this many times the level that it had to pass. Statistics: stepwise regression
/// asks less to stay than to enter (Efroymson 1960), or what is near the level comes and goes.
pub(in crate::diagnosis) const LEVEL_TO_STAY: f64 = 5.0;
/// Factors on the rate that are tried before anything else; smaller errors are found as a law. Seconds read as
/// milliseconds, a decimation that was forgotten, a double rate.
pub(in crate::diagnosis) const RATE_FACTORS: [f64; 6] = [0.001, 0.1, 0.5, 2.0, 10.0, 1000.0];
/// Least logarithm of a factor that is taken. Judgement: a smaller error is a law among others, which other lengths of the
/// table may imitate.
pub(in crate::diagnosis) const RATE_LEAST: f64 = 0.4;
/// A factor is taken where it leaves this part of the squares of the standard model, in the mean of the joints' logarithms.
/// Judgement: no other physics is imitated so well by a time that runs otherwise.
pub(in crate::diagnosis) const RATE_LEAVES: f64 = 0.5;
/// No joint may be left with so many times its squares. Which rows stand still differs between rates, and noise with them;
/// on recordings whose times are right, a factor leaves some joint with ten times its squares and more.
pub(in crate::diagnosis) const RATE_WORSENS: f64 = 1.25;
/// Around the best of the factors it is refined within this, in the logarithm: a factor of five. Numerics.
pub(in crate::diagnosis) const RATE_SPAN: f64 = 1.6;
/// Golden sections of that: to a thousandth. Numerics.
pub(in crate::diagnosis) const RATE_REFINED: usize = 16;
/// Most rounds in which it is then refined by its law. Numerics: one is enough where the rest fits.
pub(in crate::diagnosis) const RATE_ROUNDS: usize = 3;
/// Angles of a turn at which the zero of an encoder is tried: every 15 degrees. Numerics: squares of torques are waves of two to
/// four a turn over the angle.
pub(in crate::diagnosis) const ZERO_ANGLES: usize = 24;
/// Factors at which the torques of a drive are tried, up to twelve in either direction, in steps of their logarithm. Numerics.
pub(in crate::diagnosis) const GAIN_STEP: f64 = 0.35;
pub(in crate::diagnosis) const GAIN_STEPS: i32 = 7;
/// Golden sections of two steps: to a hundredth. Numerics: refits of the law go on from there.
pub(in crate::diagnosis) const ERROR_REFINED: usize = 8;
/// From this error on, in units of its number, the columns of the base parameters are those of the robot that has it. Numerics:
/// below, parameters that follow it one refit later have converged to a thousandth after three.
pub(in crate::diagnosis) const LARGE_ERROR: f64 = 0.1;
/// Columns that were made for an error, in units of its number, do for one that is as near. Numerics: parameters then settle by a
/// factor of fifty a refit.
pub(in crate::diagnosis) const NEAR_ERROR: f64 = 0.02;
/// Most refits, where parameters or the numbers that columns are derivatives by have not converged. Numerics: what is far off
/// converges as Newton's steps do, everything else by a factor of ten each.
pub(in crate::diagnosis) const MOST_REFITS: usize = 8;
/// Parameters that change by no more than this part of their standard deviations have converged. Statistics.
pub(in crate::diagnosis) const SETTLED_PARAMETER: f64 = 0.1;
/// Errors that change by no more than this part of themselves have converged. Statistics: a tenth of a standard deviation of one
/// that is known to a hundredth.
pub(in crate::diagnosis) const SETTLED_ERROR: f64 = 1e-3;

/// Shapes that a refinement tries at most. Times, and how sharp a resonance is; joint_elasticity in
/// `docs/concealment.md`.
pub(in crate::diagnosis) const MOST_EVALUATIONS: usize = 80;
/// A refinement ends when its steps are this part of the first ones. Judgement: finer than shapes are known.
pub(in crate::diagnosis) const SMALLEST_STEP: f64 = 0.02;
/// Shapes from which the best of a compliant transmission is looked for, each of another frequency. Times; what is in step
/// with a motion at one frequency is so again a fifth higher or lower, and six are an octave.
pub(in crate::diagnosis) const MOST_STARTS: usize = 6;
/// Rounds over all laws in which each shape goes to the least squares beside the others. Judgement: the second finds
/// hardly anything.
pub(in crate::diagnosis) const SHARPENING_SWEEPS: usize = 2;
/// Steps of one law in a round at most, and how often a step that finds nothing is halved. Numerics: Gauss-Newton steps
/// double the digits each time where they lead anywhere.
pub(in crate::diagnosis) const MOST_STEPS: usize = 12;
pub(in crate::diagnosis) const HALVINGS: i32 = 5;
/// Longest step of the logarithm of a number of a shape. Numerics: a derivative says little of twice the number.
pub(in crate::diagnosis) const LONGEST_STEP: f64 = 0.5;
/// What is left has to fall by this part for another step. Numerics: a tenth of a standard deviation, with some thousand
/// rows, is 1e-6 of the squares.
pub(in crate::diagnosis) const LEAST_FALL: f64 = 1e-6;

/// A law over any variables explains at least this part of what held-out motion leaves of its joint beyond noise. What it
/// says: the torque that is missing depends on these variables and on nothing else, which is wrong where it is not most
/// of it.
pub(in crate::diagnosis) const FREE_FORM_SHARE: f64 = 0.5;
/// Probability that the swing of amplitudes which are noise passes for one: that of the 95 % intervals which are told.
pub(in crate::diagnosis) const SWING_LEVEL: f64 = 0.05;
/// Such a law is looked for where this part of what remains of a joint is the same two rows later, and so no noise: twice
/// the least fraction of a law, of which it must explain half.
pub(in crate::diagnosis) const SLOW_PART_OF_REMAINS: f64 = 0.25;
/// A law of the catalogue that explains this part of what such a law does is not displaced by it: as where a spring
/// suffices for a curve over the position. Judgement.
pub(in crate::diagnosis) const NEARLY_AS_MUCH: f64 = 0.75;
/// Relative ridge of the amplitudes of such a law. Statistics: where each column may be as large as what remains of a
/// joint, the ridge of the posterior mean is one over the rows (Hoerl and Kennard 1970), of which a joint has hundreds;
/// without it, bends that one motion does not determine are predicted for another.
pub(in crate::diagnosis) const CURVE_RIDGE: f64 = 1e-3;
/// Part of a variable's values beyond each end of the interval that curves are over. Statistics: single spikes do not
/// stretch it.
pub(in crate::diagnosis) const FREE_FORM_TAIL: f64 = 0.001;
/// Most single variables that are judged on held-out motion. Times only: more than are told.
pub(in crate::diagnosis) const FREE_FORM_SINGLES: usize = 12;
/// Most pairs of variables that are judged on held-out motion, and as many with the best variable alone. Times only.
pub(in crate::diagnosis) const FREE_FORM_PAIRS: usize = 8;
