//! Lines with their results, digit for digit as Arrow writes numbers: the fewest that are the number again.

use std::io::Write;

/// Digits of a distance behind the point: to a nanometer.
const NANO: f64 = 1e9;

/// Decimals of up to 15 digits are different doubles, so the digits that were rounded to are the fewest.
const MOST: f64 = 1e15;

/// Below, numbers have an exponent.
const SMALL: f64 = 1e-6;

/// Results of rows.
#[derive(Clone, Copy, Debug)]
pub struct Results<'a> {
    /// Corrected distances; NaN where there is none.
    pub distance: &'a [f64],
    /// Their standard uncertainties; NaN where there is none.
    pub uncertainty: &'a [f32],
    /// Of each row the place of what follows both numbers.
    pub codes: &'a [i16],
    /// What follows both numbers: separators, reasons and the end of the line.
    pub tails: &'a [Vec<u8>],
}

/// The lines of a block, each with its results; None if a number is too large to be written here.
///
/// # Panics
/// If the results are not those of as many rows as there are lines, or a code has no tail.
#[must_use]
pub fn with_results(
    data: &[u8],
    ends: &[u32],
    between: usize,
    separator: u8,
    results: &Results<'_>,
) -> Option<Vec<u8>> {
    let rows = ends.len();
    assert!(results.distance.len() == rows && results.uncertainty.len() == rows);
    assert!(results.codes.len() == rows);
    let longest = results.tails.iter().map(Vec::len).max().unwrap_or(0);
    let mut out = Vec::with_capacity(data.len() + rows * (32 + longest));
    let mut begin = 0;
    let numbers = results.distance.iter().zip(results.uncertainty);
    for ((&end, (&distance, &uncertainty)), &code) in ends.iter().zip(numbers).zip(results.codes) {
        out.extend_from_slice(&data[begin..end as usize]);
        out.push(separator);
        write_distance(&mut out, distance)?;
        out.push(separator);
        write_uncertainty(&mut out, uncertainty)?;
        out.extend_from_slice(&results.tails[usize::try_from(code).ok()?]);
        begin = (end as usize).saturating_add(between);
    }
    Some(out)
}

/// A distance rounded to a nanometer.
fn write_distance(out: &mut Vec<u8>, distance: f64) -> Option<()> {
    if distance.is_nan() {
        return Some(());
    }
    let nano = (distance * NANO).round_ties_even();
    if nano.abs() >= MOST {
        return None;
    }
    let rounded = nano / NANO;
    if nano != 0.0 && rounded.abs() < SMALL {
        write!(out, "{rounded:e}").ok()?;
        return Some(());
    }
    if rounded.is_sign_negative() {
        out.push(b'-');
    }
    let count = nano.abs() as u64;
    write_integer(out, count / NANO as u64);
    let mut fraction = count % NANO as u64;
    if fraction > 0 {
        let mut digits = [b'0'; 9];
        for digit in digits.iter_mut().rev() {
            *digit += (fraction % 10) as u8;
            fraction /= 10;
        }
        let zeros = digits
            .iter()
            .rev()
            .take_while(|&&digit| digit == b'0')
            .count();
        out.push(b'.');
        out.extend_from_slice(&digits[..9 - zeros]);
    }
    Some(())
}

fn write_integer(out: &mut Vec<u8>, mut value: u64) {
    let mut digits = [b'0'; 20];
    let mut first = digits.len();
    loop {
        first -= 1;
        digits[first] += (value % 10) as u8;
        value /= 10;
        if value == 0 {
            break;
        }
    }
    out.extend_from_slice(&digits[first..]);
}

/// A number as it is; of two decimals that are equally near, the even one.
fn write_uncertainty(out: &mut Vec<u8>, value: f32) -> Option<()> {
    if value.is_nan() {
        return Some(());
    }
    let size = f64::from(value.abs());
    if size >= MOST {
        return None;
    }
    let mut buffer = zmij::Buffer::new();
    let digits = buffer.format_finite(value);
    if !digits.contains('e') {
        out.extend_from_slice(digits.strip_suffix(".0").unwrap_or(digits).as_bytes());
    } else if size < SMALL {
        write!(out, "{value:e}").ok()?;
    } else {
        write!(out, "{value}").ok()?;
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::{Results, with_results, write_distance};
    use proptest::prelude::*;

    fn distance(value: f64) -> String {
        let mut out = Vec::new();
        write_distance(&mut out, value).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn digits_of_distances() {
        let expected = [
            (2.0, "2"),
            (-0.25, "-0.25"),
            (1.000_000_000_4, "1"),
            (123_456.789_012_345, "123456.789012345"),
            (1e-9, "1e-9"),
            (-9.9e-7, "-9.9e-7"),
            (1e-6, "0.000001"),
            (1e-12, "0"),
            (-1e-12, "-0"),
            (f64::NAN, ""),
        ];
        for (value, text) in expected {
            assert_eq!(distance(value), text);
        }
    }

    #[test]
    fn each_line_keeps_its_bytes() {
        let results = Results {
            distance: &[1.5, f64::NAN],
            uncertainty: &[0.25, f32::NAN],
            codes: &[0, 1],
            tails: &[b",,\r\n".to_vec(), b",no,no\r\n".to_vec()],
        };
        let found = with_results(b"a,1\r\nb,2\r\n", &[3, 8], 2, b',', &results).unwrap();
        assert_eq!(found, b"a,1,1.5,0.25,,\r\nb,2,,,no,no\r\n");
    }

    #[test]
    fn a_number_that_is_too_large() {
        let results = Results {
            distance: &[1e7],
            uncertainty: &[0.0],
            codes: &[0],
            tails: &[Vec::new()],
        };
        assert_eq!(with_results(b"1", &[1], 1, b',', &results), None);
    }

    proptest! {
        #[test]
        fn the_fewest_digits_of_the_rounded_number(value in -1e5..1e5_f64) {
            let rounded = (value * 1e9).round_ties_even() / 1e9;
            prop_assume!(rounded.abs() >= 1e-6);
            prop_assert_eq!(distance(value), format!("{rounded}"));
        }

        #[test]
        fn small_numbers_have_an_exponent(value in -1e-6..1e-6_f64) {
            let rounded = (value * 1e9).round_ties_even() / 1e9;
            prop_assume!(rounded != 0.0 && rounded.abs() < 1e-6);
            prop_assert_eq!(distance(value), format!("{rounded:e}"));
        }
    }
}
