//! Headers of Parquet pages, in the compact protocol of Thrift.

use std::io::{self, Read};

/// What stands before a page.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct PageHeader {
    /// 0 data, 1 index, 2 dictionary, 3 data of version 2.
    pub kind: i64,
    /// Bytes unpacked and packed.
    pub unpacked: i64,
    pub packed: i64,
    /// Of the kind of page: fields of its own header by their numbers.
    pub fields: [Option<i64>; 9],
}

/// Longest header; statistics may be in it.
const LONGEST: u64 = 1 << 20;
/// Deepest nesting that is passed over.
const DEEPEST: usize = 8;

impl PageHeader {
    /// Reads a header.
    ///
    /// # Errors
    /// What the source says; what is no header.
    pub fn read(source: &mut dyn Read) -> io::Result<Self> {
        let mut thrift = Thrift { source: source.take(LONGEST) };
        let (mut header, mut field) = (Self::default(), 0);
        while let Some(kind) = thrift.field(&mut field)? {
            match (field, kind) {
                (1..=3, I16..=I64) => {
                    let value = thrift.zigzag()?;
                    *[&mut header.kind, &mut header.unpacked, &mut header.packed][field as usize - 1] = value;
                }
                (5 | 7 | 8, STRUCT) => header.fields = thrift.numbers()?,
                _ => thrift.pass_over(kind, DEEPEST)?,
            }
        }
        Ok(header)
    }

    /// A number of its kind's own header that is not negative.
    pub fn number(&self, field: usize) -> Option<u32> {
        self.fields.get(field).copied().flatten().and_then(|value| u32::try_from(value).ok())
    }
}

const TRUE: u8 = 1;
const FALSE: u8 = 2;
const BYTE: u8 = 3;
const I16: u8 = 4;
const I64: u8 = 6;
const DOUBLE: u8 = 7;
const BINARY: u8 = 8;
const LIST: u8 = 9;
const SET: u8 = 10;
const STRUCT: u8 = 12;

struct Thrift<'a> {
    source: io::Take<&'a mut dyn Read>,
}

fn wrong() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, "the header of a page is damaged")
}

impl Thrift<'_> {
    fn byte(&mut self) -> io::Result<u8> {
        let mut byte = [0];
        self.source.read_exact(&mut byte)?;
        Ok(byte[0])
    }

    fn varint(&mut self) -> io::Result<u64> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Ok(value);
            }
        }
        Err(wrong())
    }

    fn zigzag(&mut self) -> io::Result<i64> {
        let value = self.varint()?;
        Ok((value >> 1) as i64 ^ -((value & 1) as i64))
    }

    /// The type of the next field, whose number is put into `field`; `None` at the end of the struct.
    fn field(&mut self, field: &mut i64) -> io::Result<Option<u8>> {
        let head = self.byte()?;
        if head == 0 {
            return Ok(None);
        }
        *field = match i64::from(head >> 4) {
            0 => self.zigzag()?,
            step => field.checked_add(step).ok_or_else(wrong)?,
        };
        Ok(Some(head & 0x0f))
    }

    /// The fields of a struct that are whole numbers or truths.
    fn numbers(&mut self) -> io::Result<[Option<i64>; 9]> {
        let (mut fields, mut field) = ([None; 9], 0);
        while let Some(kind) = self.field(&mut field)? {
            let value = match kind {
                TRUE | FALSE => Some(i64::from(kind == TRUE)),
                I16..=I64 => Some(self.zigzag()?),
                _ => {
                    self.pass_over(kind, DEEPEST)?;
                    None
                }
            };
            if let Some(place) = usize::try_from(field).ok().and_then(|field| fields.get_mut(field)) {
                *place = value;
            }
        }
        Ok(fields)
    }

    fn bytes(&mut self, count: u64) -> io::Result<()> {
        let passed = io::copy(&mut self.source.by_ref().take(count), &mut io::sink())?;
        if passed == count { Ok(()) } else { Err(wrong()) }
    }

    fn pass_over(&mut self, kind: u8, deepest: usize) -> io::Result<()> {
        if deepest == 0 {
            return Err(wrong());
        }
        match kind {
            TRUE | FALSE => {}
            BYTE => self.bytes(1)?,
            I16..=I64 => _ = self.zigzag()?,
            DOUBLE => self.bytes(8)?,
            BINARY => {
                let count = self.varint()?;
                self.bytes(count)?;
            }
            LIST | SET => {
                let head = self.byte()?;
                let count = if head >> 4 == 15 { self.varint()? } else { u64::from(head >> 4) };
                for _ in 0..count {
                    match head & 0x0f {
                        // A truth of a list has a byte.
                        TRUE | FALSE => self.bytes(1)?,
                        kind => self.pass_over(kind, deepest - 1)?,
                    }
                }
            }
            STRUCT => {
                let mut field = 0;
                while let Some(kind) = self.field(&mut field)? {
                    self.pass_over(kind, deepest - 1)?;
                }
            }
            _ => return Err(wrong()),
        }
        Ok(())
    }
}
