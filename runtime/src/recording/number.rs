//! Decimal numbers from bytes.

/// Powers of ten that are exact in `f64`.
const EXACT_POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

/// Reads `-123.456` at the start of `bytes`: the value and the number of bytes it took.
///
/// Only numbers whose digits fit in 53 bits and whose fraction has at most 22 digits are read here; then one
/// division of two exact numbers gives the nearest `f64` (Clinger 1990). `None` for everything else, which
/// `parse_field` takes care of.
#[inline]
pub(super) fn plain_decimal(bytes: &[u8], point: u8) -> Option<(f64, usize)> {
    let mut at = 0;
    let negative = bytes.first() == Some(&b'-');
    if negative {
        at = 1;
    }
    let mut digits: u64 = 0;
    let start = at;
    while let Some(d) = digit(bytes, at) {
        digits = digits.wrapping_mul(10).wrapping_add(d);
        at += 1;
    }
    let mut count = at - start;
    let mut fraction = 0;
    if bytes.get(at) == Some(&point) {
        at += 1;
        let start = at;
        while let Some(d) = digit(bytes, at) {
            digits = digits.wrapping_mul(10).wrapping_add(d);
            at += 1;
        }
        fraction = at - start;
        count += fraction;
    }
    // 19 digits cannot overflow 64 bits.
    if count == 0 || count > 19 || digits > 1 << 53 {
        return None;
    }
    let value = digits as f64 / EXACT_POWERS[fraction];
    Some((if negative { -value } else { value }, at))
}

#[inline]
fn digit(bytes: &[u8], at: usize) -> Option<u64> {
    let d = bytes.get(at)?.wrapping_sub(b'0');
    (d < 10).then_some(u64::from(d))
}

/// What a field holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Field {
    /// A finite number.
    Number(f64),
    /// NaN, an infinity, or a number too large for `f64`.
    NotFinite,
    /// Nothing, or no number.
    NotANumber,
}

/// Reads a whole field: blanks around it, quotes, exponents, a decimal point of one's own.
pub(super) fn parse_field(field: &[u8], point: u8) -> Field {
    let mut text = field.trim_ascii();
    if let [b'"', inner @ .., b'"'] = text {
        text = inner.trim_ascii();
    }
    if text.len() > 400 {
        // Longer than the longest f64 written out in full; nothing that a controller logs.
        return match text.iter().all(|b| b.is_ascii_digit() || b"+-.eE".contains(b)) {
            true => Field::NotFinite,
            false => Field::NotANumber,
        };
    }
    let mut own = [0; 400];
    if point != b'.' {
        if text.contains(&b'.') {
            return Field::NotANumber;
        }
        own[..text.len()].copy_from_slice(text);
        for b in &mut own[..text.len()] {
            if *b == point {
                *b = b'.';
            }
        }
        text = &own[..text.len()];
    }
    match std::str::from_utf8(text).ok().and_then(|t| t.parse::<f64>().ok()) {
        Some(value) if value.is_finite() => Field::Number(value),
        Some(_) => Field::NotFinite,
        None => Field::NotANumber,
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn fields_are_read_as_a_person_would() {
        assert_eq!(parse_field(b" 1.5 ", b'.'), Field::Number(1.5));
        assert_eq!(parse_field(b"\"-2e-3\"", b'.'), Field::Number(-2e-3));
        assert_eq!(parse_field(b"1,25", b','), Field::Number(1.25));
        assert_eq!(parse_field(b"1.25", b','), Field::NotANumber);
        assert_eq!(parse_field(b"nan", b'.'), Field::NotFinite);
        assert_eq!(parse_field(b"-inf", b'.'), Field::NotFinite);
        assert_eq!(parse_field(b"1e999", b'.'), Field::NotFinite);
        assert_eq!(parse_field(&[b'9'; 500], b'.'), Field::NotFinite);
        assert_eq!(parse_field(b"", b'.'), Field::NotANumber);
        assert_eq!(parse_field(b"--1", b'.'), Field::NotANumber);
        assert_eq!(parse_field(b"1.2.3", b'.'), Field::NotANumber);
        assert_eq!(parse_field(&[0xff, 0xfe], b'.'), Field::NotANumber);
    }

    #[test]
    fn a_number_ends_where_it_ends() {
        assert_eq!(plain_decimal(b"12.5,3", b'.'), Some((12.5, 4)));
        assert_eq!(plain_decimal(b"-7\n", b'.'), Some((-7.0, 2)));
        assert_eq!(plain_decimal(b".", b'.'), None);
        assert_eq!(plain_decimal(b"-", b'.'), None);
        assert_eq!(plain_decimal(b"", b'.'), None);
    }

    proptest! {
        #[test]
        fn plain_decimals_are_the_nearest_number(text in "-?[0-9]{1,12}(\\.[0-9]{0,12})?") {
            if let Some((value, taken)) = plain_decimal(text.as_bytes(), b'.') {
                prop_assert_eq!(taken, text.len());
                prop_assert_eq!(value.to_bits(), text.parse::<f64>().expect("a decimal").to_bits());
            }
        }

        #[test]
        fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..60)) {
            let _ = plain_decimal(&bytes, b'.');
            let _ = parse_field(&bytes, b',');
        }
    }
}
