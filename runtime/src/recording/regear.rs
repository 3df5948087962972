//! Motor-side signals as the gear of another robot brings them to the joints.

use nalgebra::DMatrix;

use crate::model::Drive;
use crate::signal::Motion;

/// A motion that was recorded on the motor side and brought to the joints with one gear, as another gear N' brings it
/// there: q' = N'⁻¹ N q, tau' = N'ᵀ N⁻ᵀ tau. `None` where a gear has no inverse or another number of joints.
pub fn regear(motion: &Motion, gear: &Drive, other: &Drive) -> Option<Motion> {
    let n = motion.q.len();
    let matrix =
        |drive: &Drive| (drive.gear.len() == n * n).then(|| DMatrix::from_row_slice(n, n, &drive.gear));
    let (gear, other) = (matrix(gear)?, matrix(other)?);
    let speeds = other.clone().try_inverse()? * &gear;
    let torques = other.transpose() * gear.try_inverse()?.transpose();
    let mixed = |signal: &[Vec<f64>], by: &DMatrix<f64>| -> Vec<Vec<f64>> {
        let samples = signal.first().map_or(0, Vec::len);
        (0..n)
            .map(|i| {
                let mut mixed = vec![0.0; samples];
                for j in (0..n).filter(|&j| by[(i, j)] != 0.0) {
                    mixed.iter_mut().zip(&signal[j]).for_each(|(m, x)| *m += by[(i, j)] * x);
                }
                mixed
            })
            .collect()
    };
    Some(Motion {
        q: mixed(&motion.q, &speeds),
        dq: mixed(&motion.dq, &speeds),
        ddq: mixed(&motion.ddq, &speeds),
        torque: mixed(&motion.torque, &torques),
        ..motion.clone()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drive(gear: [f64; 4]) -> Drive {
        Drive { gear: gear.to_vec().into(), coupled_friction: Vec::new().into() }
    }

    #[test]
    fn motors_turn_and_push_as_before() {
        let motion = Motion {
            name: "m".to_owned(),
            rate: 100.0,
            start: 0.0,
            q: vec![vec![1.0, -0.5], vec![0.25, 2.0]],
            dq: vec![vec![2.0, 1.0], vec![0.5, -1.0]],
            ddq: vec![vec![0.0, 1.0], vec![3.0, 4.0]],
            torque: vec![vec![10.0, -20.0], vec![5.0, 8.0]],
            fixed: Vec::new(),
            edge_samples: 0,
        };
        let (own, other) = (drive([32.0, 0.0, 32.0, 32.0]), drive([50.0, 10.0, 0.0, -20.0]));
        let moved = regear(&motion, &own, &other).expect("both have an inverse");
        for t in 0..2 {
            let motors = |drive: &Drive, q: &[Vec<f64>], m: usize| -> f64 {
                (0..2).map(|j| drive.gear[2 * m + j] * q[j][t]).sum()
            };
            for m in 0..2 {
                approx::assert_relative_eq!(
                    motors(&own, &motion.q, m),
                    motors(&other, &moved.q, m),
                    epsilon = 1e-12
                );
            }
            let power = |m: &Motion| -> f64 { (0..2).map(|j| m.dq[j][t] * m.torque[j][t]).sum() };
            approx::assert_relative_eq!(power(&motion), power(&moved), epsilon = 1e-12);
        }
        assert_eq!(regear(&motion, &own, &drive([1.0, 1.0, 1.0, 1.0])), None);
    }
}
