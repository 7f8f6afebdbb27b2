//! A number of a field, correctly rounded.

/// Powers of ten that are doubles: a quotient or a product with one of them is rounded once.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];

/// Integers up to here are doubles.
const EXACT: u64 = 1 << 53;

/// The double next to the digits of a field: `-12`, `3.5`, `1.2e-3`; None for any other text.
///
/// A mantissa and a power of ten that are both doubles need one division (Clinger 1990,
/// <https://doi.org/10.1145/93542.93557>); the standard library reads the rest.
pub fn number(field: &[u8]) -> Option<f64> {
    let (negative, digits) = match field {
        [b'-', rest @ ..] => (true, rest),
        _ => (false, field),
    };
    let whole = count(digits);
    let fraction = match &digits[whole..] {
        [b'.', rest @ ..] => count(rest),
        _ => 0,
    };
    let end = if fraction > 0 {
        whole + 1 + fraction
    } else {
        whole
    };
    if whole == 0 || (end < digits.len() && !is_exponent(&digits[end..])) {
        return None;
    }
    if end == digits.len() && whole + fraction <= 18 {
        let read = |sum: u64, &digit: &u8| 10 * sum + u64::from(digit - b'0');
        let fractional = &digits[end - fraction..];
        let mantissa = fractional
            .iter()
            .fold(digits[..whole].iter().fold(0, read), read);
        if mantissa <= EXACT {
            let size = mantissa as f64 / POWERS[fraction];
            return Some(if negative { -size } else { size });
        }
    }
    let value: f64 = core::str::from_utf8(field).ok()?.parse().ok()?;
    value.is_finite().then_some(value)
}

/// Number of digits that a text begins with.
fn count(text: &[u8]) -> usize {
    text.iter().take_while(|byte| byte.is_ascii_digit()).count()
}

/// Whether a text is an exponent and nothing else.
fn is_exponent(text: &[u8]) -> bool {
    let digits = match text {
        [b'e' | b'E', b'+' | b'-', digits @ ..] | [b'e' | b'E', digits @ ..] => digits,
        _ => return false,
    };
    !digits.is_empty() && count(digits) == digits.len()
}

#[cfg(test)]
mod tests {
    use super::number;
    use proptest::prelude::*;

    #[test]
    fn other_texts_are_none() {
        let others = [
            "", "-", ".", "5.", ".5", "+5", " 5", "5 ", "1e", "1e+", "e5", "nan", "inf", "1e400",
            "--1", "1.2.3", "0x10", "1_000", "12,5",
        ];
        for text in others {
            assert_eq!(number(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn negative_zero_keeps_its_sign() {
        assert!(number(b"-0.00").unwrap().is_sign_negative());
    }

    proptest! {
        #[test]
        fn any_double_is_read_again(bits: u64) {
            let value = f64::from_bits(bits);
            prop_assume!(value.is_finite());
            for text in [format!("{value}"), format!("{value:e}"), format!("{value:.17e}")] {
                prop_assert_eq!(number(text.as_bytes()).map(f64::to_bits), Some(bits));
            }
        }

        #[test]
        fn digits_are_what_the_standard_library_reads(text in "-?[0-9]{1,20}(\\.[0-9]{1,20})?([eE][-+]?[0-9]{1,2})?") {
            let expected: f64 = text.parse().unwrap();
            prop_assert_eq!(number(text.as_bytes()).map(f64::to_bits), Some(expected.to_bits()));
        }
    }
}
