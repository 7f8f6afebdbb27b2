//! One field as a number: the double next to its digits, or none where it is no number.

use crate::bytes::{Needle, ONES};

/// Powers of ten that are doubles without rounding.
const TENS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];

/// Digits that always fit into 64 bits.
const FIT: usize = 19;

/// Integers up to this one are doubles without rounding.
const EXACT: u64 = 1 << 53;

/// Number at the start of some bytes that has a sign, digits and a decimal sign at most, and where it ends.
///
/// None where its digits and its power of ten are not both doubles without rounding: [`of_field`] then knows.
/// Else one division rounds, and the number is the double next to the digits (Clinger 1990).
#[inline]
#[must_use]
pub fn leading(text: &[u8], decimal: u8) -> Option<(f64, usize)> {
    let mut at = usize::from(text.first() == Some(&b'-'));
    let begin = at;
    let mut digits = 0_u64;
    let mut fraction = 0;
    while let Some(digit) = digit(text, at) {
        digits = digits.wrapping_mul(10).wrapping_add(digit);
        at += 1;
    }
    let mut count = at - begin;
    if text.get(at) == Some(&decimal) {
        at += 1;
        let first = at;
        while let Some(digit) = digit(text, at) {
            digits = digits.wrapping_mul(10).wrapping_add(digit);
            at += 1;
        }
        fraction = at - first;
        count += fraction;
    }
    if count == 0 || count > FIT || digits > EXACT {
        return None;
    }
    #[allow(clippy::cast_precision_loss, reason = "it is exact")]
    let size = digits as f64 / TENS[fraction];
    Some((if begin == 1 { -size } else { size }, at))
}

/// Number of a field of at most eight bytes, the first in the lowest places of a word; see [`leading`].
///
/// Without a step for each digit: where fields differ in length, a processor cannot foresee the last one.
#[inline]
pub(crate) fn of_word(word: u64, length: usize, decimal: Needle) -> Option<f64> {
    let minus = word & 0xff == u64::from(b'-') && length > 0;
    let (word, length) = if minus {
        (word >> 8, length - 1)
    } else {
        (word, length)
    };
    let kept = word & below(length);
    let point = decimal.hits(kept).trailing_zeros() as usize / 8;
    let other = kept ^ (below(length) & (ONES * u64::from(b'0'))); // what digits stand for
    let (digits, count, fraction) = if point < length {
        let joined = (other & below(point)) | ((other >> 8) & !below(point));
        (joined, length - 1, length - 1 - point)
    } else {
        (other, length, 0)
    };
    let none = digits.wrapping_add(0x76 * ONES) | digits; // beyond 9: the highest bit of a byte
    if count == 0 || none & (0x80 * ONES) != 0 {
        return None;
    }
    #[allow(clippy::cast_precision_loss, reason = "it is exact")]
    let size = of_digits(digits << (64 - 8 * count)) as f64 / TENS[fraction];
    Some(if minus { -size } else { size })
}

/// The lowest bytes of a word.
const fn below(bytes: usize) -> u64 {
    if bytes < 8 {
        (1 << (8 * bytes)) - 1
    } else {
        u64::MAX
    }
}

/// Number of eight digits, the first in the lowest places (Lemire 2018).
const fn of_digits(digits: u64) -> u64 {
    const PAIRS: u64 = 0xff_0000_00ff;
    let pairs = digits.wrapping_mul(10).wrapping_add(digits >> 8);
    let first = (pairs & PAIRS).wrapping_mul(100 + (1_000_000 << 32));
    let second = ((pairs >> 16) & PAIRS).wrapping_mul(1 + (10_000 << 32));
    first.wrapping_add(second) >> 32
}

fn digit(text: &[u8], at: usize) -> Option<u64> {
    let digit = text.get(at)?.wrapping_sub(b'0');
    (digit < 10).then_some(u64::from(digit))
}

/// Number of a whole field, with blanks around it or not; None where it is none.
///
/// Its decimal sign may be a point, too. The words of infinities, and of what is no number, are numbers.
///
/// # Examples
/// ```
/// # use echocal_text::number::of_field;
/// assert_eq!(of_field(b" 2,5e1", b','), Some(25.0));
/// assert_eq!(of_field(b"-inf", b'.'), Some(f64::NEG_INFINITY));
/// assert_eq!(of_field(b"far", b'.'), None);
/// ```
#[must_use]
pub fn of_field(field: &[u8], decimal: u8) -> Option<f64> {
    let text = trimmed(field);
    let word = text
        .strip_prefix(b"-")
        .or_else(|| text.strip_prefix(b"+"))
        .unwrap_or(text);
    let is_word = |known: &&[u8]| word.eq_ignore_ascii_case(known);
    if !is_number(word, decimal) && ![&b"inf"[..], b"infinity", b"nan"].iter().any(is_word) {
        return None;
    }
    let point = |&byte: &u8| if byte == decimal { b'.' } else { byte };
    let plain: Vec<u8> = text.iter().map(point).collect();
    str::from_utf8(&plain).ok()?.parse().ok()
}

/// A field without the blanks around it.
pub(crate) fn trimmed(field: &[u8]) -> &[u8] {
    let outer = field.trim_ascii();
    if outer.is_ascii() {
        return outer;
    }
    str::from_utf8(outer).map_or(outer, |text| text.trim().as_bytes())
}

/// Whether a text is a decimal number without a sign.
fn is_number(text: &[u8], decimal: u8) -> bool {
    let digits = |from: usize| {
        text[from..]
            .iter()
            .take_while(|byte| byte.is_ascii_digit())
            .count()
    };
    let mut count = digits(0);
    let mut at = count;
    if text
        .get(at)
        .is_some_and(|&byte| byte == decimal || byte == b'.')
    {
        let fraction = digits(at + 1);
        count += fraction;
        at += 1 + fraction;
    }
    if count == 0 {
        return false;
    }
    if matches!(text.get(at), Some(b'e' | b'E')) {
        at += 1;
        at += usize::from(matches!(text.get(at), Some(b'-' | b'+')));
        let exponent = digits(at);
        if exponent == 0 {
            return false;
        }
        at += exponent;
    }
    at == text.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn what_is_a_number() {
        let known: [(&str, Option<f64>); 26] = [
            ("5", Some(5.0)),
            ("5.", Some(5.0)),
            (".5", Some(0.5)),
            ("-.5e-3", Some(-0.0005)),
            (" 5", Some(5.0)),
            ("5\t ", Some(5.0)),
            ("1E+2", Some(100.0)),
            ("0e999", Some(0.0)),
            ("", None),
            (" ", None),
            (".", None),
            ("-", None),
            ("+5", Some(5.0)),
            ("+-5", None),
            ("5 5", None),
            ("5,5", None),
            ("1e", None),
            ("1e+", None),
            ("1e5.", None),
            ("1e400", Some(f64::INFINITY)),
            ("1e-320", Some(1e-320)),
            ("-Infinity", Some(f64::NEG_INFINITY)),
            ("inf", Some(f64::INFINITY)),
            ("0x10", None),
            ("5\u{a0}", Some(5.0)),
            ("5\u{a0}5", None),
        ];
        for (text, number) in known {
            assert_eq!(of_field(text.as_bytes(), b'.'), number, "{text:?}");
        }
        assert!(of_field(b"NaN", b'.').is_some_and(f64::is_nan));
        assert!(of_field(b"-0", b'.').is_some_and(f64::is_sign_negative));
        assert!(leading(b"-0", b'.').is_some_and(|(number, _)| number.is_sign_negative()));
        assert_eq!(leading(b"12.5;3", b'.'), Some((12.5, 4)));
        assert_eq!(leading(b"12,5;3", b','), Some((12.5, 4)));
        assert_eq!(leading(b";3", b'.'), None);
        assert_eq!(leading(b"9007199254740993", b'.'), None);
        assert_eq!(
            of_field(b"9007199254740993", b'.'),
            Some(9_007_199_254_740_992.0)
        );
    }

    proptest! {
        #[test]
        fn both_are_the_double_next_to_the_digits(text in "-?[0-9]{0,14}\\.?[0-9]{0,12}(e-?[0-9]{1,2})?") {
            let expected: Option<f64> = text.parse().ok();
            prop_assert_eq!(of_field(text.as_bytes(), b'.').map(f64::to_bits), expected.map(f64::to_bits));
            if let Some((number, end)) = leading(text.as_bytes(), b'.') {
                prop_assert_eq!(number.to_bits(), text[..end].parse::<f64>().unwrap().to_bits());
            }
        }

        #[test]
        fn a_word_is_a_short_field(text in "-?[0-9]{0,5}[.,;e]?[0-9]{0,3}", more in "[0-9.,]{8}") {
            let length = text.len().min(8);
            let word = crate::bytes::word((text[..length].to_owned() + &more).as_bytes(), 0).unwrap();
            let field = &text[..length];
            let plain = !field.contains('e');
            let expected = of_field(field.as_bytes(), b'.').filter(|_| plain).map(f64::to_bits);
            prop_assert_eq!(of_word(word, length, Needle::new(b'.')).map(f64::to_bits), expected);
        }

        #[test]
        fn any_word_is_a_number_of_its_digits_or_none(word in any::<u64>(), length in 0_usize..9) {
            if let Some(number) = of_word(word, length, Needle::new(b'.')) {
                prop_assert_eq!(of_field(&word.to_le_bytes()[..length], b'.'), Some(number));
            }
        }

        #[test]
        fn any_bytes_give_no_number_that_the_library_does_not_know(
            field in prop::collection::vec(any::<u8>(), 0..6),
        ) {
            if let Some(number) = of_field(&field, b'.') {
                let text = str::from_utf8(&field).unwrap();
                prop_assert_eq!(text.trim().parse().map(f64::to_bits), Ok(number.to_bits()));
            }
        }
    }
}
