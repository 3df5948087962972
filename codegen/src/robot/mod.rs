//! A robot as its YAML says: the modified-DH table in symbols.
//!
//! ```yaml
//! name: arm                         # a Rust identifier
//! description: one line             # optional
//! gravity: [0, 0, -9.81]            # m/s2, in frame 0; this where it is not given
//! constants: {d3: 0.225}            # optional; a constant may use those above it
//! frames:                           # angles in rad, lengths in m
//!   - {j: 1, sigma: 0, alpha: 0,     d: 0,  theta: q1,        r: 0}
//!   - {j: 2, sigma: 0, alpha: -pi/2, d: 0,  theta: q2 - pi/2, r: 0}
//!   - {j: 3, parent: 1, sigma: 1, gamma: pi/4, b: 0.1, alpha: 0, d: d3, theta: 0, r: q3}
//! drive:                            # optional
//!   gear: [32, 32, 400]             # one ratio a joint, or a matrix: motor speed = gear * joint speed
//!   coupled_friction: [2]           # motors with friction at motor speed (Fvm2, Fcm2)
//! massless: [3]                     # optional: frames whose ten inertial parameters are 0
//! friction:                         # optional: friction between links or of a tendon, on a sum of joint speeds
//!   - {joints: {q1: 1, q2: -1}}     # Fvc1_2 and Fcc1_2
//! springs:                          # optional: springs known by design, on a joint or a sum of joint positions
//!   - {joint: 2}                    # torque K2*q2 - KR2; with `rest: 0.3` K2*(q2 - 0.3)
//!   - {joints: {q1: 1, q2: 1}, name: balancer}   # K_balancer, KR_balancer
//! known: {Ia1: 0, M2: 3.4}           # optional: standard parameters whose values are known
//! ellipsoids:                       # optional: what holds the mass of links, in their frames; centre and rpy may be 0
//!   - {frame: 2, centre: [0.2, 0, 0], radii: [0.3, 0.1, 0.1], rpy: [0, 0, pi/6]}
//! limits:                           # optional, each of them; x stands for [-x, x], one value for every joint
//!   position: [pi, [-1, 2], 0.2]
//!   velocity: 3
//!   acceleration: 50
//!   torque: [100, 80, 200]
//! nominal:                          # optional, each of them
//!   parameters: {ZZ1: 0.35, Fv1: 7.9}              # standard parameters by name; others are 0
//!   controller: {kp: [900, 700, 5000], kd: 20, ki: 0}  # joint side
//!   noise: {position: 1e-6, torque: 0.3}           # one sigma, joint side
//! ```
//!
//! Wherever a number stands there may be an expression of numbers, `pi` and constants with + - * / and parentheses.
//! theta of a row with sigma 0 and r of one with sigma 1 are joint variables plus such an expression, in any order: `q2`,
//! `-q1 + pi/2`, `q3 - q2`, `-q3`. A row j in which `q<j>` stands is the own frame of joint j: the joint is named after it,
//! is an angle where its sigma is 0 and a length where it is 1, and limits, drive, Ia, Fv, Fc and off count the joints in
//! the order of these rows. Other rows may use the same variable, before or after it: the bars of a parallelogram, a
//! counter-carriage. A row that has only variables of others has no joint. Coefficients of angles are whole numbers (a sum
//! of joint angles has a closed form), those of lengths any numbers; an angle has no lengths in it.
//!
//! Every mistake of a file is reported with its place, not only the first:
//!
//! ```
//! use dynid_codegen::robot::parse;
//!
//! let yaml = b"name: arm
//! frames:
//!   - {j: 1, sigma: 0, alpha: 0, d: 0, theta: 0.5*q1, r: 0}
//!   - {j: 2, sigma: 3, alpha: 0, d: 0, theta: q2, r: 0}
//! ";
//! let mistakes = parse("arm.yaml", yaml).unwrap_err();
//! let text: Vec<String> = mistakes.iter().map(ToString::to_string).collect();
//! assert_eq!(text[0], "arm.yaml:3:49: theta of frame 1: q1 has the coefficient 0.5; an angle needs whole numbers, \
//!     because only their sines and cosines are those of sums of joint angles. Let the joint variable be the smaller angle, \
//!     and put the ratio in drive: gear");
//! assert_eq!(text[1], "arm.yaml:4:19: expected sigma as 0 (revolute), 1 (prismatic) or 2 (fixed), found '3'");
//! ```

mod between;
mod coupled_robot;
mod couplings;
mod diagnostic;
mod document;
mod drive;
mod drive_table;
mod ellipsoids;
mod expression;
mod formula;
mod identifier;
mod known;
mod magnitudes;
mod parse;
mod reader;
mod rows;
mod simulation_values;
mod table;
mod variables;

pub use diagnostic::Diagnostic;
pub use drive_table::DriveTable;
pub use expression::Expression;
pub(crate) use parse::at_name;
pub use parse::{parse, parse_with_warnings};
pub use table::{NominalValues, RobotTable, TableRow};
