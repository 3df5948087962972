//! CDR, the encoding of ROS 2 messages (OMG DDS-XTypes 1.3, 7.4): numbers aligned to their size, counted from the byte
//! behind the four of the encapsulation header.

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

    fn take(&mut self, length: usize) -> Result<&'a [u8], Fault> {
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
