//! What the paper printed for the TX-40: Tables II, III and IV.

use super::Case;

/// A row of Table II: values identified in Cases 1 to 4; `None` where the parameter was cancelled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PublishedParameter {
    /// Standard name without the R of regrouping.
    pub name: &'static str,
    /// Cases 1 to 4.
    pub values: [Option<f64>; 4],
}

const fn row(name: &'static str, values: [f64; 4]) -> PublishedParameter {
    let mut given = [None; 4];
    let mut k = 0;
    while k < 4 {
        // The table has no zeros: 0 stands for its dashes.
        if values[k] != 0.0 {
            given[k] = Some(values[k]);
        }
        k += 1;
    }
    PublishedParameter { name, values: given }
}

/// Table II of Gautier and Briot. Its fs is the Coulomb friction Fc.
pub const PUBLISHED_PARAMETERS: &[PublishedParameter] = &[
    row("ZZ1", [1.29, 1.27, 1.18, 1.24]),
    row("Fv1", [6.90, 6.90, 7.98, 5.33]),
    row("Fc1", [6.71, 6.72, 0.0, 15.9]),
    row("XX2", [-0.457, -0.484, -0.468, -0.422]),
    row("XY2", [0.0, 0.0, -0.106, 0.0]),
    row("XZ2", [-0.135, -0.145, -0.132, -0.122]),
    row("ZZ2", [1.06, 1.06, 1.24, 1.09]),
    row("MX2", [2.22, 2.21, 2.02, 2.18]),
    row("Fv2", [4.54, 4.45, 1.42, 4.28]),
    row("Fc2", [8.11, 7.87, 28.0, 8.25]),
    row("XX3", [0.0, 0.0949, 0.0, 0.0]),
    row("XZ3", [0.0, 0.0, 0.093, 0.0]),
    row("YZ3", [0.0, 0.0, 0.225, 0.0]),
    row("ZZ3", [0.139, 0.146, 0.270, 0.157]),
    row("MY3", [-0.630, -0.607, 0.0, -0.610]),
    row("Ia3", [0.0827, 0.0874, 0.0, 0.0754]),
    row("Fv3", [1.73, 1.60, 0.0, 1.32]),
    row("Fc3", [6.30, 6.30, 20.8, 7.50]),
    row("XY4", [0.0, 0.0, -0.1, 0.0]),
    row("YZ4", [0.0, 0.0, 0.0588, 0.0]),
    row("ZZ4", [0.0, 0.0, 0.0, 0.0372]),
    row("MX4", [0.0, 0.0, 0.0, -0.0427]),
    row("Ia4", [0.0, 0.0351, 0.0, 0.0]),
    row("Fv4", [0.915, 0.851, 0.856, 0.734]),
    row("Fc4", [2.40, 2.55, 0.0, 3.05]),
    row("YZ5", [0.0, 0.0, 0.0561, 0.0]),
    row("Ia5", [0.0544, 0.0416, 0.196, 0.0441]),
    row("Fv5", [1.60, 1.56, 3.02, 1.46]),
    row("Fc5", [3.37, 2.71, 0.0, 2.00]),
    row("XY6", [0.0, 0.0, 0.0182, 0.0]),
    row("XZ6", [0.0, 0.0, 0.0, -0.00254]),
    row("ZZ6", [0.0, 0.0, -0.026, 0.0]),
    row("MX6", [0.0, 0.0, 0.055, -0.0253]),
    row("MY6", [0.0, 0.0, 0.0547, 0.0]),
    row("Ia6", [0.0, 0.0109, 0.0, 0.00999]),
    row("Fv6", [0.581, 0.513, 1.29, 0.401]),
    row("Fc6", [1.96, 1.83, -8.58, 2.63]),
    row("Fvm6", [0.519, 0.492, 0.808, 0.339]),
    row("Fcm6", [1.85, 1.53, -2.97, 2.79]),
];

/// Relative standard deviations of Cases 1 and 2 in Table II, percent; `None` where the parameter was cancelled.
pub const PUBLISHED_DEVIATIONS: &[(&str, [Option<f64>; 2])] = &[
    ("ZZ1", [Some(0.45), Some(0.36)]),
    ("Fv1", [Some(0.78), Some(0.58)]),
    ("Fc1", [Some(2.37), Some(1.76)]),
    ("XX2", [Some(2.02), Some(1.44)]),
    ("XZ2", [Some(4.3), Some(3.03)]),
    ("ZZ2", [Some(0.57), Some(0.31)]),
    ("MX2", [Some(0.52), Some(0.27)]),
    ("Fv2", [Some(1.33), Some(0.72)]),
    ("Fc2", [Some(1.83), Some(0.97)]),
    ("XX3", [None, Some(7.62)]),
    ("ZZ3", [Some(3.7), Some(1.81)]),
    ("MY3", [Some(1.53), Some(0.79)]),
    ("Ia3", [Some(5.83), Some(2.85)]),
    ("Fv3", [Some(2.61), Some(1.19)]),
    ("Fc3", [Some(2.4), Some(1.03)]),
    ("Ia4", [None, Some(3.81)]),
    ("Fv4", [Some(4.79), Some(1.78)]),
    ("Fc4", [Some(6.87), Some(2.31)]),
    ("Ia5", [Some(9.94), Some(4.84)]),
    ("Fv5", [Some(3.8), Some(1.42)]),
    ("Fc5", [Some(4.47), Some(1.92)]),
    ("Ia6", [None, Some(4.43)]),
    ("Fv6", [Some(4.91), Some(1.69)]),
    ("Fc6", [Some(7.72), Some(2.68)]),
    ("Fvm6", [Some(4.59), Some(1.69)]),
    ("Fcm6", [Some(7.76), Some(3.19)]),
];

/// Relative error norm of the identification (Table III, not given for Case 5) and of the torque reconstruction
/// (Table IV).
pub fn published_error(case: Case) -> (Option<f64>, f64) {
    match case {
        Case::One => (Some(0.077358), 0.0726),
        Case::Two => (Some(0.0821229), 0.0765),
        Case::Three => (Some(0.0689218), 0.5346),
        Case::Four => (Some(0.0670227), 0.1545),
        Case::Five => (None, 0.7485),
    }
}
