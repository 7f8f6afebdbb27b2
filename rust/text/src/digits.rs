//! One number as the fewest digits that are the number again.
//!
//! As Arrow writes them: `5`, `0.715060974`, `1e+10`. They have an exponent below a millionth and from ten
//! billion on.

use zmij::Buffer;

/// Power of ten of the first digit from which on, and up to which, there is no exponent.
const PLAIN: std::ops::RangeInclusive<i32> = -6..=9;

/// Digits before the decimal sign up to which there is no exponent.
const LONGEST: usize = 10;

/// Steps of a distance in a meter: a nanometer.
const STEPS: f64 = 1e9;
const STEPS_OF_ONE: u64 = 1_000_000_000;

/// Eight zeros as text.
const ZEROS: u64 = u64::from_le_bytes([b'0'; 8]);

/// Place of the decimal sign of such a number: behind six digits of meters at most.
const POINT: usize = 6;

/// Steps below which fewer digits never are the same double: such a number has at most 15 of them.
const SHORTEST: f64 = 1e15;

/// Appends a distance \[m\], rounded to a nanometer; nothing where it is not a number.
///
/// # Examples
/// ```
/// # use echocal_text::digits::push_distance;
/// let mut out = vec![];
/// push_distance(&mut out, 0.7150609741, b',');
/// assert_eq!(out, b"0,715060974");
/// ```
#[inline]
pub fn push_distance(out: &mut Vec<u8>, distance: f64, decimal: u8) {
    let steps = (distance * STEPS).round_ties_even();
    if steps.abs() < SHORTEST && steps.abs() >= 1000.0 {
        // no double beside it has as few digits: these are the shortest
        if steps < 0.0 {
            out.push(b'-');
        }
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "it is a whole number below 1e15"
        )]
        push_steps(out, steps.abs() as u64, decimal);
    } else {
        push_double(out, steps / STEPS, decimal);
    }
}

/// Appends a number of nanometers as meters, below a million of them.
fn push_steps(out: &mut Vec<u8>, steps: u64, decimal: u8) {
    let mut text = [b'0'; POINT + 10];
    let (mut whole, rest) = (steps / STEPS_OF_ONE, steps % STEPS_OF_ONE);
    let mut begin = POINT - 1;
    text[begin] = digit(whole);
    while whole >= 10 {
        whole /= 10;
        begin -= 1;
        text[begin] = digit(whole);
    }
    let mut end = POINT;
    if rest > 0 {
        let last = eight_digits(rest % 100_000_000);
        text[POINT] = decimal;
        text[POINT + 1] = digit(rest / 100_000_000);
        text[POINT + 2..].copy_from_slice(&(last | ZEROS).to_le_bytes());
        end = text.len() - last.leading_zeros() as usize / 8; // the last digits are in the highest places
    }
    out.extend_from_slice(&text[begin..end]);
}

#[allow(clippy::cast_possible_truncation, reason = "it is below ten")]
fn digit(number: u64) -> u8 {
    b'0' + (number % 10) as u8
}

/// The eight digits of a number below 1e8, the first in the lowest place: halves, then pairs, then digits.
const fn eight_digits(number: u64) -> u64 {
    let halves = number / 10_000 + ((number % 10_000) << 32);
    let hundreds = ((halves * 10_486) >> 20) & 0x7f_0000_007f; // a hundredth, exact below 10,000
    let pairs = hundreds + ((halves - 100 * hundreds) << 16);
    let tens = ((pairs * 103) >> 10) & 0xf_000f_000f_000f; // a tenth, exact below 100
    tens + ((pairs - 10 * tens) << 8)
}

/// Appends a double; nothing where it is not a number.
pub fn push_double(out: &mut Vec<u8>, number: f64, decimal: u8) {
    if number.is_finite() {
        push(out, Buffer::new().format_finite(number), decimal);
    } else {
        push_other(out, number);
    }
}

/// Appends a number of single precision; nothing where it is not a number.
pub fn push_single(out: &mut Vec<u8>, number: f32, decimal: u8) {
    if number.is_finite() {
        push(out, Buffer::new().format_finite(number), decimal);
    } else {
        push_other(out, number.into());
    }
}

fn push_other(out: &mut Vec<u8>, number: f64) {
    if number == f64::INFINITY {
        out.extend_from_slice(b"inf");
    } else if number == f64::NEG_INFINITY {
        out.extend_from_slice(b"-inf");
    }
}

/// Appends the shortest digits of a number, which are known, in the form of Arrow.
fn push(out: &mut Vec<u8>, shortest: &str, decimal: u8) {
    let size = shortest.strip_prefix('-').unwrap_or(shortest);
    if size.len() < shortest.len() {
        out.push(b'-');
    }
    let (mantissa, exponent) = size.split_once('e').unwrap_or((size, "0"));
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    if mantissa.len() == size.len() && whole.len() <= LONGEST && !fraction.starts_with("00000") {
        out.extend_from_slice(whole.as_bytes());
        let fraction = if fraction == "0" { "" } else { fraction };
        return push_fraction(out, fraction.as_bytes(), decimal);
    }
    let mut digits = [0_u8; 32];
    let mut count = 0;
    let mut power = exponent.parse::<i32>().unwrap_or(0) - 1; // of the first digit
    for (place, digit) in whole.bytes().chain(fraction.bytes()).enumerate() {
        if count == 0 && digit == b'0' {
            power -= i32::from(place >= whole.len());
            continue;
        }
        power += i32::from(place < whole.len());
        digits[count] = digit;
        count += 1;
    }
    while count > 0 && digits[count - 1] == b'0' {
        count -= 1;
    }
    let digits = &digits[..count];
    match digits {
        [] => out.push(b'0'),
        [first, rest @ ..] if !PLAIN.contains(&power) => {
            out.push(*first);
            push_fraction(out, rest, decimal);
            let sign = if power < 0 { "e-" } else { "e+" };
            out.extend_from_slice(sign.as_bytes());
            out.extend_from_slice(power.unsigned_abs().to_string().as_bytes());
        }
        _ if power < 0 => {
            out.extend_from_slice(&[b'0', decimal]);
            out.resize(out.len() + power.unsigned_abs() as usize - 1, b'0');
            out.extend_from_slice(digits);
        }
        _ => {
            let whole = power.unsigned_abs() as usize + 1;
            let (before, behind) = digits.split_at(whole.min(count));
            out.extend_from_slice(before);
            out.resize(out.len() + whole - before.len(), b'0');
            push_fraction(out, behind, decimal);
        }
    }
}

fn push_fraction(out: &mut Vec<u8>, digits: &[u8], decimal: u8) {
    if !digits.is_empty() {
        out.push(decimal);
        out.extend_from_slice(digits);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn text(write: impl Fn(&mut Vec<u8>)) -> String {
        let mut out = vec![];
        write(&mut out);
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn forms_are_those_of_arrow() {
        let known = [
            (5.0, "5"),
            (-0.0, "-0"),
            (0.0, "0"),
            (1e-6, "0.000001"),
            (9.99e-7, "9.99e-7"),
            (-1.5e-9, "-1.5e-9"),
            (1e-5, "0.00001"),
            (0.05, "0.05"),
            (120.0, "120"),
            (1234.5, "1234.5"),
            (1e9, "1000000000"),
            (1e10, "1e+10"),
            (12_345_678_901.5, "1.23456789015e+10"),
            (1e300, "1e+300"),
            (1e-300, "1e-300"),
            (f64::NAN, ""),
            (f64::INFINITY, "inf"),
            (f64::NEG_INFINITY, "-inf"),
        ];
        for (number, shown) in known {
            assert_eq!(text(|out| push_double(out, number, b'.')), shown);
        }
        assert_eq!(text(|out| push_single(out, 0.1, b',')), "0,1");
        assert_eq!(text(|out| push_single(out, f32::NAN, b',')), "");
        assert_eq!(
            text(|out| push_single(out, f32::NEG_INFINITY, b',')),
            "-inf"
        );
    }

    #[test]
    fn digits_in_eights() {
        for number in (0..100_000_000)
            .step_by(997)
            .chain(0..20_000)
            .chain(99_980_000..100_000_000)
        {
            let shown = (eight_digits(number) | ZEROS).to_le_bytes();
            assert_eq!(str::from_utf8(&shown).unwrap(), format!("{number:08}"));
        }
    }

    proptest! {
        #[test]
        fn distances_are_those_of_the_general_way(
            distance in prop_oneof![-30.0..30.0_f64, -1e-6..1e-6, -2e6..2e6_f64, any::<f64>()],
        ) {
            let rounded: f64 = (distance * 1e9).round_ties_even() / 1e9;
            prop_assert_eq!(
                text(|out| push_distance(out, distance, b'.')),
                text(|out| push_double(out, rounded, b'.'))
            );
        }

        #[test]
        fn few_digits_stay(whole in 0_u32..2000, fraction in 0_u32..1000) {
            let shown = format!("{whole}.{fraction:03}");
            let shown = shown.trim_end_matches('0').trim_end_matches('.');
            prop_assert_eq!(text(|out| push_distance(out, shown.parse().unwrap(), b'.')), shown);
        }

        #[test]
        fn digits_are_the_number_again(number in any::<f64>(), single in any::<f32>()) {
            prop_assume!(number.is_finite() && single.is_finite());
            let shown = text(|out| push_double(out, number, b'.'));
            prop_assert_eq!(shown.parse::<f64>().unwrap().to_bits(), number.to_bits());
            let shown = text(|out| push_single(out, single, b'.'));
            prop_assert_eq!(shown.parse::<f32>().unwrap().to_bits(), single.to_bits());
        }
    }
}
