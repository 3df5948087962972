//! The numbers that options take: for each a parser that refuses what lies outside, and the range as words for
//! `--help`.

use std::fmt::Display;
use std::str::FromStr;

/// A parser and its words from one range.
macro_rules! range {
    ($what:literal, $parser:ident, $words:ident: $kind:ty, $low:literal to $high:literal) => {
        #[doc = concat!("Reads ", $what, ".\n\n# Errors\nWhat is no number, or lies outside of ", $low, " to ", $high, ".")]
        pub fn $parser(text: &str) -> Result<$kind, String> {
            within::<$kind>(text, $low, $high)
        }

        #[doc = concat!("The range of ", $what, ".")]
        pub const $words: &str = concat!($low, "..", $high);
    };
}

range!("a band, Hz", band, BAND: f64, 0.01 to 1e5);
range!("a tolerance of angles, rad", snap, SNAP: f64, 0.0 to 0.1);
range!("an acceleration of gravity, m/s2", gravity, GRAVITY: f64, -1e4 to 1e4);
range!("equations a second, Hz", rows_rate, ROWS_RATE: f64, 0.01 to 1e6);
range!("a cut-off, Hz", cutoff, CUTOFF: f64, 0.01 to 1e6);
range!("a speed of standstill, rad/s or m/s", standstill, STANDSTILL: f64, 0.0 to 1e4);
range!("a number of threads, 0 for all cores", threads, THREADS: usize, 0 to 1024);
range!("an instant of a recording, s", instant, INSTANT: f64, -1e12 to 1e12);
range!("a ratio of relative standard deviations", r_sigma, R_SIGMA: f64, 1.01 to 1e6);
range!("the length of a motion, s", period, PERIOD: f64, 0.01 to 3600.0);
range!("a number of harmonics", harmonics, HARMONICS: usize, 2 to 64);
range!("a number of points", points, POINTS: usize, 2 to 1000);
range!("a stop, s", pause, PAUSE: f64, 0.0 to 3600.0);
range!("a share", share, SHARE: f64, 0.001 to 1.0);
range!("a number of motions", motions, MOTIONS: usize, 1 to 1000);
range!("a control rate, Hz", control_rate, CONTROL_RATE: f64, 0.01 to 1e6);
range!("control samples a row", record_every, RECORD_EVERY: usize, 1 to 1000000);
range!("a factor on noise", noise, NOISE: f64, 0.0 to 1e4);
range!("a step of encoders, rad or m", quantum, QUANTUM: f64, 0.0 to 1.0);
range!("a size of physics beyond the model", size, SIZE: f64, 0.0 to 100.0);
range!("a gain, N.m or N per unit", gain, GAIN: f64, -1e9 to 1e9);
range!("a largest torque of a law, N.m or N", law_size, LAW_SIZE: f64, 1e-6 to 1e6);
range!("a stiffness, N.m/rad or N/m", stiffness, STIFFNESS: f64, 1e-3 to 1e12);
range!("a damping, N.m.s/rad or N.s/m", damping, DAMPING: f64, 0.0 to 1e9);
range!("a play, rad or m", play, PLAY: f64, 0.0 to 10.0);
range!("a number of random starts", starts, STARTS: usize, 1 to 1000);
range!("a number of tried motions", evaluations, EVALUATIONS: usize, 0 to 1000000);
range!("rows a second of a file, Hz", file_rate, FILE_RATE: f64, 0.01 to 1e5);
range!("a number of repetitions", seeds, SEEDS: u64, 1 to 1000);

fn within<T: FromStr + PartialOrd + Display>(text: &str, low: T, high: T) -> Result<T, String> {
    match text.trim().parse::<T>() {
        Ok(number) if number >= low && number <= high => Ok(number),
        _ => Err(format!("it must be a number from {low} to {high}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_belong_to_a_range_and_nothing_outside_does() {
        assert_eq!((band("0.01"), band("1e5"), BAND), (Ok(0.01), Ok(1e5), "0.01..1e5"));
        assert_eq!((threads("0"), threads("1024")), (Ok(0), Ok(1024)));
        assert_eq!(instant("-1e12"), Ok(-1e12));
        for text in ["0.0099", "100001", "nan", "inf", "-inf", "1e-300", "", "ten", "0x10"] {
            assert_eq!(band(text), Err("it must be a number from 0.01 to 100000".to_owned()), "{text}");
        }
    }
}
