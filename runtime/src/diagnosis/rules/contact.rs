//! Contact, in motion and at rest.

/// An instant counts as pushed when its mean squared residual passes this many noise variances. Judgement; contact in
/// `docs/concealment.md`, false contacts in `docs/evidence.md`.
pub(in crate::diagnosis) const PUSHED: f64 = 14.0;
/// A single joint counts as pushed beyond this many standard deviations. Statistics: one in 2000 of a normal.
pub(in crate::diagnosis) const JOINT_PUSHED: f64 = 3.5;
/// Joints that must be pushed together. Mechanics: what pushes one joint alone is inside of it.
pub(in crate::diagnosis) const PUSHED_TOGETHER: usize = 2;
/// Shortest push and longest gap within one, s: shorter bursts are impacts inside of the robot. Mechanics.
pub(in crate::diagnosis) const SHORTEST_PUSH: f64 = 0.15;
/// A push is an exception: together at most this fraction of the motion. Judgement.
pub(in crate::diagnosis) const LARGEST_PUSHED_FRACTION: f64 = 0.35;
/// One force on one link must explain this fraction of the squares of a window. Judgement; false contacts.
pub(in crate::diagnosis) const FORCE_EXPLAINS: f64 = 0.7;
/// The force of the neighbouring instants must explain this fraction: a push is smooth. Judgement; false contacts.
pub(in crate::diagnosis) const FORCE_PREDICTS: f64 = 0.75;
/// Fewest instants of a window: one needs a neighbour to each side. Mechanics.
pub(in crate::diagnosis) const LEAST_INSTANTS: usize = 3;
/// A link further in must leave this fraction of what the next link out leaves: the same force seen from there is
/// nearly as good. Judgement; the link in `docs/concealment.md`.
pub(in crate::diagnosis) const INNER_LINK_BETTER: f64 = 0.6;
/// Time before and after a window that no row may use, s: the reach of the slow window. Mechanics.
pub(in crate::diagnosis) const CONTACT_MARGIN: f64 = 0.05;
/// A contact remains while its instants pass this part of [`PUSHED`] with the effects in the model. Judgement.
pub(in crate::diagnosis) const REMAINING_FRACTION: f64 = 0.5;
/// Rounds of the robust fit. Judgement: its weights have converged; not measured.
pub(in crate::diagnosis) const ROBUST_ROUNDS: usize = 20;
/// Mean squared residual, in noise variances, at which the robust weight (Cauchy's) is one half. Judgement:
/// Cauchy's usual 2.385² for one row, less as all joints of an instant share a weight.
pub(in crate::diagnosis) const ROBUST_SCALE: f64 = 3.0;
/// Points that a law is drawn by, of equal width. Judgement: a picture is some 700 pixels wide.
pub(in crate::diagnosis) const FINE_BINS: usize = 300;
/// Standard deviation of a normal per median absolute deviation. Statistics.
pub(in crate::diagnosis) const SIGMA_PER_MAD: f64 = 1.4826;
/// Least robust standard deviation relative to the joint's largest torque: noise-free recordings. Mechanics.
pub(in crate::diagnosis) const LEAST_ROBUST_SIGMA: f64 = 1e-6;
/// Relative ridge of the robust fit. Mechanics.
pub(in crate::diagnosis) const ROBUST_RIDGE: f64 = 1e-11;
/// Relative ridge of a force at one instant: directions that no joint feels stay zero. Mechanics.
pub(in crate::diagnosis) const FORCE_RIDGE: f64 = 1e-6;
/// Absolute ridge of the same, for a pose in which no joint feels anything. Mechanics.
pub(in crate::diagnosis) const FORCE_RIDGE_ABSOLUTE: f64 = 1e-12;

/// Static friction is at most this many times the Coulomb friction of the moving joint, but for one joint in a
/// hundred. Mechanics: dry gears break away at 1.1 to 1.3 times what they slide at.
pub(in crate::diagnosis) const STICTION: f64 = 1.25;
/// Standard normal deviate that is passed once in a hundred times: what ties [`STICTION`] to a spread. Statistics.
pub(in crate::diagnosis) const ONE_IN_A_HUNDRED: f64 = 2.326_347_874;
/// False alarms per recording of a robot that stands, however often it does. Judgement: one in a thousand, as what a model
/// leaves out adds to what friction seems to hold.
pub(in crate::diagnosis) const LEVEL_AT_REST: f64 = 1e-3;
/// Shortest push against a robot at rest, s: what is shorter is an impact. Mechanics.
pub(in crate::diagnosis) const SHORTEST_PUSH_AT_REST: f64 = 0.2;
/// Torques at rest are averaged over this long, s. Mechanics: a hand does not push faster.
pub(in crate::diagnosis) const AVERAGED_AT_REST: f64 = 0.1;
/// Gaps of a push at rest shorter than this belong to it, s. Mechanics.
pub(in crate::diagnosis) const GAP_AT_REST: f64 = 0.1;
/// Shortest time of standing still that is looked at, s. Mechanics: twice a shortest push.
pub(in crate::diagnosis) const SHORTEST_REST: f64 = 0.5;
/// After a motion the robot has come to rest by this time, s, and pushes off by as much before it is seen to move.
/// Mechanics: a few periods of a position loop.
pub(in crate::diagnosis) const SETTLING: f64 = 0.3;
/// Time from one instant of a push at rest to the next at which a force is looked for, s. Times only.
pub(in crate::diagnosis) const FORCE_STEP_AT_REST: f64 = 0.02;

/// Window lengths that means of a residual are taken over, s: pushes of 0.15 to 2.4 s, each length covered to 1.5
/// times. Mechanics; power in the tests of `scan`.
pub(in crate::diagnosis) const SCAN_LENGTHS: [f64; 9] = [0.15, 0.2, 0.3, 0.4, 0.5, 0.7, 1.0, 1.6, 2.4];
/// Shortest window, rows. Statistics: a half wave has a beginning, a height and an end.
pub(in crate::diagnosis) const SCAN_SHORTEST: usize = 3;
/// Windows of a length are this part of it apart. Statistics: a half wave beside itself by half of that has lost less than
/// a hundredth of its square.
pub(in crate::diagnosis) const SCAN_STEPS: usize = 8;
/// Least fraction of a half wave's squares that smooth curves over the joint's own state do not make. Judgement: with less,
/// what is seen may as well be a law of a state that no other part of the motion visits.
pub(in crate::diagnosis) const SCAN_OWN_SHAPE: f64 = 0.4;
/// Least fraction of what these curves leave of a half wave that the columns of the model do not make. Judgement: with less the
/// model is extrapolated to the window, and an error of a tenth in how its columns are made looks like a push.
pub(in crate::diagnosis) const SCAN_LEFT_BY_MODEL: f64 = 0.2;
/// Rows for each knot of these curves. Statistics: curves over a state are curves over time, too, and those of so many knots
/// make a fifth of a half wave.
pub(in crate::diagnosis) const SCAN_ROWS_PER_KNOT: usize = 150;
/// Least and most knots of these curves. Judgement: a line, and a curve that follows what a law of friction does.
pub(in crate::diagnosis) const SCAN_KNOTS: [usize; 2] = [2, 8];
/// Loads this far apart in time, s, are borne twice. Mechanics: a stroke's acceleration takes no longer, and what is borne for
/// longer is seen at its beginning and at its end.
pub(in crate::diagnosis) const PASSAGE: f64 = 1.0;
/// A law is refuted by the rest of the motion where its amplitudes are by accident as far from those of all motion there with less
/// than this probability. Statistics: the usual 1 %, of laws that the rest does not show by itself.
pub(in crate::diagnosis) const REFUTED: f64 = 0.01;
/// Length of the stretches whose largest means the law is fitted to, s. Statistics: a dozen of them in a recording of
/// half a minute, each with many independent means.
pub(in crate::diagnosis) const SCAN_STRETCH: f64 = 2.0;
/// Least fraction of the rows of a stretch. Statistics: with fewer its largest window is one of too few.
pub(in crate::diagnosis) const SCAN_FILLED: f64 = 1.0 / 3.0;
/// How often the few largest stretches of a joint make the tail of its law longer by accident. Statistics: every joint of a
/// recording is asked, and one whose tail is taken for three times as long hides a push.
pub(in crate::diagnosis) const SCAN_LONGER_TAIL: f64 = 0.01;
/// Standard deviation of the edges of a push for its shape, as a part of its length: the half wave that fits a rectangle
/// best is longer by as much on each side, that of a squared sine shorter. Of its mean torque, too. Mechanics.
pub(in crate::diagnosis) const SCAN_EDGE: f64 = 0.1;
/// A push whose half wave is shorter than this, s, is an impact inside of the robot. Mechanics: four fifths of
/// [`SHORTEST_PUSH`], as a half wave is shorter than a push that begins and ends gently by [`SCAN_EDGE`] on each side.
pub(in crate::diagnosis) const SCAN_IMPACT: f64 = 0.12;
/// Least fraction of a window's rows that must be there: a joint that reverses has none. Judgement.
pub(in crate::diagnosis) const SCAN_PRESENT: f64 = 0.7;
/// False alarms per recording in which nothing else was found. Statistics: one in a thousand; size and power in the tests of
/// `scan`.
pub(in crate::diagnosis) const SCAN_LEVEL: f64 = 1e-3;
/// The same beside laws, where laws were found that could not be told apart or kept, and where something remains on a joint that
/// nothing explains. Judgement: a law that is fitted nearly
/// right, or not at all, leaves short waves where it acts, which the law of the largest means knows nothing of, and of which
/// joints feel the same; pushes of a hand are mostly far beyond.
pub(in crate::diagnosis) const SCAN_LEVEL_BESIDE_LAWS: f64 = 5e-5;
/// Something remains on a joint where this part of its residual is the same two rows later. Judgement: most of it is no noise.
pub(in crate::diagnosis) const MOSTLY_UNEXPLAINED: f64 = 0.5;
/// Pushes on single joints, at least so many, are a law where one over any variables leaves at most one in so many of them.
/// Judgement: a hand does not come back with the state of the robot, and what does is predicted on motion that was held out.
pub(in crate::diagnosis) const RECURRING: usize = 2;
/// A push whose half wave is longer than this, s, is none. Mechanics: what lasts longer than the longest window goes on as slowly
/// as the motion does, and a law that acts as long as a stroke looks like it.
pub(in crate::diagnosis) const SCAN_LONGEST: f64 = 2.7;
/// Windows that one of so many recordings has by accident do not count among what the residual does by itself until they have
/// turned out to be no pushes. Statistics: hardly anything is left out of noise.
pub(in crate::diagnosis) const SCAN_SUSPECT: f64 = 0.05;
/// Rows that a joint needs to be scanned. Statistics: for the autoregression of its residual.
pub(in crate::diagnosis) const SCAN_LEAST_ROWS: usize = 60;
/// Fewest stretches that the law of largest means is fitted to. Statistics: quartiles; that so few know it badly is counted.
pub(in crate::diagnosis) const SCAN_FEWEST_STRETCHES: usize = 4;
/// With fewer stretches a joint has no law of its own, and a recording that of its baseline. Statistics: the scale is known to a
/// third.
pub(in crate::diagnosis) const SCAN_LEAST_STRETCHES: usize = 8;
/// Stretches that count as much as all joints together for the law of one joint. Statistics: size against power in the
/// tests of `scan`.
pub(in crate::diagnosis) const SCAN_OWN_STRETCHES: f64 = 40.0;
/// Independent windows of all lengths in a stretch. Statistics: the square that the largest of a stretch of noise mostly is, 5.4,
/// is passed by one normal deviate in fifty.
pub(in crate::diagnosis) const SCAN_INDEPENDENT: f64 = 50.0;
/// Least scale of the largest squares: that of normal deviates, whose squares fall as exp(-x/2) / sqrt(x), around
/// x = 10, where the largest of a stretch are. Statistics.
pub(in crate::diagnosis) const SCAN_NORMAL_SCALE: f64 = 2.0 / 1.1;
/// Rows of a joint this close to its own reversals are not looked at, s. Mechanics: presliding, play and the ringing of a
/// gear die away within two periods of 20 Hz.
pub(in crate::diagnosis) const REVERSAL_LEFT_OUT: f64 = 0.1;
/// Nor are those at which it creeps, as a fraction of its top speed. Mechanics: friction at such speeds (Stribeck's, what
/// sticks and comes loose) is not that of the rest of the motion, and few rows show it: what one slow passage leaves is no
/// push.
pub(in crate::diagnosis) const CREEPING: f64 = 0.05;
/// A joint feels a push that was found on another one from this many standard deviations of its mean on. Statistics: one
/// in four hundred by accident.
pub(in crate::diagnosis) const FELT: f64 = 3.0;
/// Squares of the means that the force on another link may leave more than the best one, in units of the noise, and still
/// be as good. Statistics: the 95 % point of one degree of freedom.
pub(in crate::diagnosis) const LINKS_ALIKE: f64 = 3.84;
/// Most squares that a force may leave for each joint, in units of the noise. Judgement: a push whose joints disagree by
/// more than three standard deviations is told as their torques.
pub(in crate::diagnosis) const FORCE_LEAVES: f64 = 9.0;
/// Standard deviation of a force, as a part of it, from which on it is not told. Judgement.
pub(in crate::diagnosis) const UNDETERMINED_FORCE: f64 = 10.0;
/// Joints whose windows are this close together see the same push, s. Mechanics.
pub(in crate::diagnosis) const SCAN_TOGETHER: f64 = 0.2;
/// Windows of all lengths count as so many of one length for how the noise of two joints goes together there. Statistics: the
/// correlation of so many is known to a quarter.
pub(in crate::diagnosis) const SCAN_COMMON_WINDOWS: f64 = 30.0;
/// Values beyond so many standard deviations count as no more for the memory of a residual. Statistics.
pub(in crate::diagnosis) const SCAN_CLIPPED: f64 = 2.5;
/// Least variance of the noise of a row, as a part of the mean. Judgement: no sensor is free of noise where a joint bears nothing.
pub(in crate::diagnosis) const SCAN_LEAST_VARIANCE: f64 = 0.1;
/// Most coefficients of the autoregression of a residual. Statistics: a quarter of a second of fast rows.
pub(in crate::diagnosis) const SCAN_MOST_ORDER: usize = 12;
