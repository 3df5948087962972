//! Weighted triangles as bytes: little endian, numbers bit for bit, 15 kB for sixty parameters and as much again where the
//! noise of the encoders is known.

use nalgebra::DMatrix;

use super::{Reduced, ReducedError};
use crate::estimation::Factor;

/// How the bytes begin; the last one is the version.
const MAGIC: &[u8; 8] = b"dynidR\0\x01";

/// Most parameters, and longest name, that are read.
const MOST_PARAMETERS: usize = 4096;
const LONGEST_NAME: usize = 256;

impl Reduced {
    /// As bytes, for [`Reduced::from_bytes`].
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        text(&mut bytes, &self.fingerprint);
        count(&mut bytes, self.parameters.len());
        for (name, unit) in &self.parameters {
            text(&mut bytes, name);
            text(&mut bytes, unit);
        }
        count(&mut bytes, self.fixed.len());
        for (l, value) in &self.fixed {
            count(&mut bytes, *l);
            numbers(&mut bytes, &[*value]);
        }
        count(&mut bytes, self.samples);
        count(&mut bytes, self.factor.rows());
        numbers(&mut bytes, &self.factor.upper());
        numbers(&mut bytes, &self.inflation);
        numbers(&mut bytes, &self.known);
        bytes.push(u8::from(self.noise.is_some()));
        if let Some(noise) = &self.noise {
            numbers(&mut bytes, &upper_of(noise));
        }
        bytes
    }

    /// Reads what [`Reduced::to_bytes`] wrote.
    ///
    /// # Errors
    /// [`ReducedError::NoFactors`] with what is wrong: other bytes, a part that is missing, a number that is none.
    pub fn from_bytes(bytes: &[u8]) -> Result<Reduced, ReducedError> {
        let rest = bytes.strip_prefix(MAGIC);
        let mut reader = Reader(rest.ok_or(ReducedError::NoFactors("they begin with other bytes"))?);
        let fingerprint = reader.text()?;
        let unknowns = reader.count(MOST_PARAMETERS)?;
        let parameters: Vec<(String, String)> = (0..unknowns)
            .map(|_| Ok((reader.text()?, reader.text()?)))
            .collect::<Result<_, ReducedError>>()?;
        let held = reader.count(unknowns)?;
        let mut fixed = Vec::with_capacity(held);
        for _ in 0..held {
            let place = reader.count(unknowns.saturating_sub(1))?;
            fixed.push((place, reader.numbers(1)?[0]));
        }
        let samples = reader.count(usize::MAX)?;
        let rows = reader.count(usize::MAX)?;
        let upper = reader.numbers((unknowns + 1) * (unknowns + 2) / 2)?;
        let factor = Factor::from_upper(unknowns, rows, &upper);
        let factor = factor.ok_or(ReducedError::NoFactors("the triangle is none"))?;
        let inflation = reader.numbers(unknowns)?;
        let known = reader.numbers(unknowns)?;
        let noise = match reader.take(1)? {
            [0] => None,
            _ => Some(symmetric(unknowns, &reader.numbers(unknowns * (unknowns + 1) / 2)?)),
        };
        if !reader.0.is_empty() {
            return Err(ReducedError::NoFactors("there is more behind them"));
        }
        Ok(Reduced { fingerprint, parameters, fixed, factor, noise, inflation, known, samples })
    }
}

fn count(bytes: &mut Vec<u8>, count: usize) {
    bytes.extend_from_slice(&(count as u64).to_le_bytes());
}

fn text(bytes: &mut Vec<u8>, text: &str) {
    count(bytes, text.len());
    bytes.extend_from_slice(text.as_bytes());
}

fn numbers(bytes: &mut Vec<u8>, numbers: &[f64]) {
    numbers.iter().for_each(|x| bytes.extend_from_slice(&x.to_le_bytes()));
}

/// The upper triangle row by row.
fn upper_of(matrix: &DMatrix<f64>) -> Vec<f64> {
    let k = matrix.nrows();
    (0..k).flat_map(|i| (i..k).map(move |l| (i, l))).map(|at| matrix[at]).collect()
}

fn symmetric(k: usize, upper: &[f64]) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(k, k);
    let places = (0..k).flat_map(|i| (i..k).map(move |l| (i, l)));
    for ((i, l), x) in places.zip(upper) {
        (matrix[(i, l)], matrix[(l, i)]) = (*x, *x);
    }
    matrix
}

struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take(&mut self, length: usize) -> Result<&'a [u8], ReducedError> {
        let (taken, rest) = self.0.split_at_checked(length).ok_or(ReducedError::NoFactors("they are cut"))?;
        self.0 = rest;
        Ok(taken)
    }

    fn count(&mut self, most: usize) -> Result<usize, ReducedError> {
        let bytes = self.take(8)?.try_into().map_err(|_| ReducedError::NoFactors("they are cut"))?;
        let count = usize::try_from(u64::from_le_bytes(bytes)).ok().filter(|count| *count <= most);
        count.ok_or(ReducedError::NoFactors("a count is larger than can be"))
    }

    fn text(&mut self) -> Result<String, ReducedError> {
        let length = self.count(LONGEST_NAME)?;
        let text = std::str::from_utf8(self.take(length)?);
        text.map(str::to_owned).map_err(|_| ReducedError::NoFactors("a name is no text"))
    }

    fn numbers(&mut self, count: usize) -> Result<Vec<f64>, ReducedError> {
        let (numbers, _) = self.take(8 * count)?.as_chunks::<8>();
        let numbers: Vec<f64> = numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
        let finite = numbers.iter().all(|x| x.is_finite());
        if finite { Ok(numbers) } else { Err(ReducedError::NoFactors("a number is not finite")) }
    }
}
