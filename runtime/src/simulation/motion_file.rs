//! Planned motions as CSV: t, then q, dq and ddq of all joints, SI.

use std::fmt::Write as _;

use super::reference::{Reference, SampledReference, SampledReferenceError};

/// What of a motion's file cannot be.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{line}: {what}")]
pub struct MotionFileError {
    /// Line of the file.
    pub line: usize,
    /// What is wrong.
    pub what: String,
}

/// A motion sampled at `rate`, as `[q, dq, ddq]` with `signal[joint][sample]`.
pub fn sampled(motion: &dyn Reference, rate: f64) -> [Vec<Vec<f64>>; 3] {
    let n = motion.joints();
    let samples = (motion.duration() * rate + 1e-6).floor() as usize + 1;
    let mut signals: [Vec<Vec<f64>>; 3] = std::array::from_fn(|_| vec![Vec::with_capacity(samples); n]);
    let (mut q, mut dq, mut ddq) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    for k in 0..samples {
        motion.at(k as f64 / rate, &mut q, &mut dq, &mut ddq);
        for (signal, values) in signals.iter_mut().zip([&q, &dq, &ddq]) {
            for (channel, &value) in signal.iter_mut().zip(values) {
                channel.push(value);
            }
        }
    }
    signals
}

/// A motion as CSV: t, then positions, velocities and accelerations of all joints, SI.
pub fn to_csv(motion: &dyn Reference, rate: f64) -> String {
    let signals = sampled(motion, rate);
    let n = motion.joints();
    let mut text = String::from("t");
    for letter in ["q", "dq", "ddq"] {
        for j in 1..=n {
            // Writing to a String cannot fail.
            let _ = write!(text, ",{letter}{j}");
        }
    }
    text.push('\n');
    for k in 0..signals[0].first().map_or(0, Vec::len) {
        let _ = write!(text, "{}", k as f64 / rate);
        for channel in signals.iter().flatten() {
            let _ = write!(text, ",{}", channel[k]);
        }
        text.push('\n');
    }
    text
}

/// Reads a motion that [`to_csv`] wrote, or one of the same columns: t, then q, dq and ddq of all joints, SI.
///
/// # Errors
/// Line and mistake: another number of columns, a field that is no finite number, rows that are not equally spaced.
pub fn from_csv(text: &str, joints: usize) -> Result<SampledReference, MotionFileError> {
    let wrong = |line: usize, what: String| MotionFileError { line, what };
    let columns = 1 + 3 * joints;
    let mut time = Vec::new();
    let mut signals: Vec<Vec<f64>> = vec![Vec::new(); 3 * joints];
    for (k, row) in text.lines().enumerate().skip(1).filter(|(_, row)| !row.trim().is_empty()) {
        let fields: Vec<&str> = row.split(',').collect();
        if fields.len() != columns {
            let found = fields.len();
            return Err(wrong(
                k + 1,
                format!("{found} columns: t, q, dq and ddq of {joints} joints are {columns}"),
            ));
        }
        for (place, field) in fields.iter().enumerate() {
            let value: f64 = field
                .trim()
                .parse()
                .ok()
                .filter(|x: &f64| x.is_finite())
                .ok_or_else(|| wrong(k + 1, format!("'{field}' is not a finite number")))?;
            if place == 0 { time.push(value) } else { signals[place - 1].push(value) }
        }
    }
    let ddq = signals.split_off(2 * joints);
    let dq = signals.split_off(joints);
    SampledReference::new(&time, [signals, dq, ddq]).map_err(|error| match error {
        // The first line has the names.
        SampledReferenceError::Spacing { sample, .. } => wrong(sample + 2, error.to_string()),
        SampledReferenceError::TooShort => wrong(1, error.to_string()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_that_is_written_is_read_again() {
        let swing = |k: usize| (0.1 * k as f64).sin();
        let channel: Vec<f64> = (0..40).map(swing).collect();
        let still = vec![0.5; 40];
        let motion = SampledReference {
            step: 0.01,
            q: vec![channel.clone(), still.clone()],
            dq: vec![channel.clone(), vec![0.0; 40]],
            ddq: vec![channel, vec![0.0; 40]],
            fixed: vec![1],
        };
        let read = from_csv(&to_csv(&motion, 100.0), 2).expect("it was written so");
        assert_eq!((read.fixed, read.q.len()), (vec![1], 2));
        for (a, b) in read.q[0].iter().zip(&motion.q[0]) {
            assert!((a - b).abs() < 1e-12);
        }
    }

    #[test]
    fn what_cannot_be_is_named_with_its_line() {
        let good = "t,q1,dq1,ddq1\n0,0,0,0\n0.1,0,0,0\n0.2,0,0,0\n";
        assert!(from_csv(good, 1).is_ok());
        for (from, to, line) in [("0.1,0,0,0", "0.1,0,0", 3), ("0.2,0,", "0.2,x,", 4), ("0.2,", "0.35,", 3)] {
            assert_eq!(from_csv(&good.replace(from, to), 1).expect_err(to).line, line, "{to}");
        }
        assert!(from_csv("t,q1,dq1,ddq1\n0,0,0,0\n", 1).is_err());
    }
}
