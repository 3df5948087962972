//! CDR, the encoding of ROS 2 messages (OMG DDS-XTypes 1.3, 7.4): numbers aligned to their size, counted from the byte
//! behind the four of the encapsulation header.

use super::definition::Number;

/// Why a message cannot be decoded.
pub(super) type Fault = &'static str;

const SHORT: Fault = "the message ends too early";

/// Reads a message from its beginning on.
#[derive(Clone)]
pub(super) struct Cdr<'a> {
    body: &'a [u8],
    at: usize,
    little: bool,
    /// Alignment of 8-byte numbers: 8, in version 2 of the encoding 4.
    widest: usize,
}

impl<'a> Cdr<'a> {
    pub fn new(message: &'a [u8]) -> Result<Self, Fault> {
        let (header, body) = message.split_at_checked(4).ok_or("the message is shorter than its header")?;
        let (little, widest) = match (header[0], header[1]) {
            (0, 0) => (false, 8),
            (0, 1) => (true, 8),
            (0, 6) => (false, 4),
            (0, 7) => (true, 4),
            _ => return Err("its encapsulation is none of CDR"),
        };
        Ok(Self { body, at: 0, little, widest })
    }

    /// The next bytes.
    pub fn take(&mut self, length: usize) -> Result<&'a [u8], Fault> {
        let end = self.at.checked_add(length).ok_or(SHORT)?;
        let taken = self.body.get(self.at..end).ok_or(SHORT)?;
        self.at = end;
        Ok(taken)
    }

    fn align(&mut self, to: usize) {
        self.at = self.at.next_multiple_of(to);
    }

    pub fn u32(&mut self) -> Result<u32, Fault> {
        self.align(4);
        let bytes = self.take(4)?.try_into().map_err(|_| SHORT)?;
        Ok(if self.little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) })
    }

    /// A time as the headers of messages have it, ns.
    pub fn stamp(&mut self) -> Result<i64, Fault> {
        let (seconds, nanoseconds) = (self.u32()? as i32, self.u32()?);
        Ok(i64::from(seconds) * 1_000_000_000 + i64::from(nanoseconds))
    }

    /// A number of any kind.
    pub fn number(&mut self, kind: Number) -> Result<f64, Fault> {
        let size = size_of(kind);
        self.align(size.min(self.widest));
        let bytes = self.take(size)?;
        let mut wide = [0; 8];
        match self.little {
            true => wide[..size].copy_from_slice(bytes),
            false => bytes.iter().rev().zip(&mut wide).for_each(|(byte, place)| *place = *byte),
        }
        let whole = u64::from_le_bytes(wide);
        Ok(match kind {
            Number::Bool => f64::from(u8::from(whole != 0)),
            Number::U8 | Number::U16 | Number::U32 | Number::U64 => whole as f64,
            Number::I8 => f64::from(whole as u8 as i8),
            Number::I16 => f64::from(whole as u16 as i16),
            Number::I32 => f64::from(whole as u32 as i32),
            Number::I64 => whole as i64 as f64,
            Number::F32 => f64::from(f32::from_bits(whole as u32)),
            Number::F64 => f64::from_bits(whole),
        })
    }

    /// So many numbers of a kind, one after another.
    pub fn numbers(&mut self, kind: Number, count: usize, mut take: impl FnMut(f64)) -> Result<(), Fault> {
        self.fits(kind, count)?;
        for _ in 0..count {
            take(self.number(kind)?);
        }
        Ok(())
    }

    /// Passes over so many numbers of a kind.
    pub fn pass_over(&mut self, kind: Number, count: usize) -> Result<(), Fault> {
        self.fits(kind, count)?;
        if count > 0 {
            self.align(size_of(kind).min(self.widest));
            self.take(size_of(kind) * count)?;
        }
        Ok(())
    }

    /// That the message is long enough for so many numbers.
    fn fits(&self, kind: Number, count: usize) -> Result<(), Fault> {
        let left = self.body.len().saturating_sub(self.at);
        if count > left / size_of(kind) { Err(SHORT) } else { Ok(()) }
    }

    /// The number of elements of a sequence whose elements have at least `least` bytes each.
    pub fn count(&mut self, least: usize) -> Result<usize, Fault> {
        let count = self.u32()? as usize;
        if count > (self.body.len() - self.at.min(self.body.len())) / least.max(1) {
            return Err(SHORT);
        }
        Ok(count)
    }

    /// A string without the zero behind it. Some writers send a length of 0 for an empty one.
    pub fn text(&mut self) -> Result<&'a [u8], Fault> {
        let length = self.u32()? as usize;
        let bytes = self.take(length)?;
        Ok(bytes.strip_suffix(&[0]).unwrap_or(bytes))
    }

    /// A sequence of doubles.
    pub fn doubles(&mut self) -> Result<Doubles<'a>, Fault> {
        let count = self.u32()? as usize;
        // Nothing is aligned where nothing follows.
        let bytes = match count {
            0 => &[][..],
            _ => {
                self.align(self.widest);
                self.take(count.checked_mul(8).ok_or(SHORT)?)?
            }
        };
        Ok(Doubles { bytes, little: self.little })
    }

    /// How far it was read.
    pub fn position(&self) -> usize {
        self.at
    }

    /// The bytes from a position up to here.
    pub fn since(&self, from: usize) -> &'a [u8] {
        self.body.get(from..self.at).unwrap_or_default()
    }
}

/// Bytes of a number.
fn size_of(kind: Number) -> usize {
    match kind {
        Number::Bool | Number::I8 | Number::U8 => 1,
        Number::I16 | Number::U16 => 2,
        Number::I32 | Number::U32 | Number::F32 => 4,
        Number::I64 | Number::U64 | Number::F64 => 8,
    }
}

/// Doubles as they lie in a message.
#[derive(Debug, Clone, Copy)]
pub(super) struct Doubles<'a> {
    bytes: &'a [u8],
    little: bool,
}

impl Doubles<'_> {
    pub fn get(&self, index: usize) -> Option<f64> {
        let bytes = self.bytes.get(index * 8..index * 8 + 8)?.try_into().ok()?;
        Some(if self.little { f64::from_le_bytes(bytes) } else { f64::from_be_bytes(bytes) })
    }
}
