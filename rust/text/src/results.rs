//! Lines with results behind each of them.

use crate::digits::{push_distance, push_single};
use crate::lines::spans;

/// Results of each row.
#[derive(Clone, Copy, Debug)]
pub struct Results<'a> {
    /// Corrected distance \[m\]; NaN where there is none.
    pub distance: &'a [f64],
    /// Its standard uncertainty \[m\]; NaN where there is none.
    pub uncertainty: &'a [f32],
    /// Place of the row's text among `status`; a row with a place beyond has no fields behind its numbers.
    pub codes: &'a [i16],
    /// Texts behind the numbers, with what separates their fields.
    pub status: &'a [Vec<u8>],
}

/// Bytes that the numbers of a row take at most, with separators: -1.2345678901234567e-300 and its like.
const NUMBERS: usize = 48;

/// The lines of a text, each with its results; `ends` and `ending` are of [`crate::lines`].
///
/// Rows are as many as lines, results and codes all have; the others are left out.
///
/// # Examples
/// ```
/// # use echocal_text::results::{Results, appended};
/// let status = [b",".to_vec()];
/// let results = Results { distance: &[2.5], uncertainty: &[f32::NAN], codes: &[0], status: &status };
/// assert_eq!(appended(b"a,b\n", &[4], 1, results, b",", b'.'), b"a,b,2.5,,,\n");
/// ```
#[must_use]
pub fn appended(
    data: &[u8],
    ends: &[u32],
    ending: usize,
    results: Results<'_>,
    separator: &[u8],
    decimal: u8,
) -> Vec<u8> {
    let ends_with = if ending == 2 {
        &b"\r\n"[..]
    } else {
        &b"\n"[..]
    };
    let tail = |text: &[u8]| [separator, text, ends_with].concat();
    let tails: Vec<_> = results.status.iter().map(|text| tail(text)).collect();
    let empty: Vec<_> = tails
        .iter()
        .map(|tail| [separator, tail].concat())
        .collect(); // without uncertainty
    let longest = empty.iter().map(Vec::len).max().unwrap_or(0);
    let mut out =
        Vec::with_capacity(data.len() + (NUMBERS + 2 * separator.len() + longest) * ends.len());
    let numbers = results
        .distance
        .iter()
        .zip(results.uncertainty)
        .zip(results.codes);
    for ((begin, end), ((&distance, &uncertainty), &code)) in spans(ends, ending).zip(numbers) {
        let code = usize::try_from(code).ok();
        out.extend_from_slice(&data[begin..end]);
        out.extend_from_slice(separator);
        push_distance(&mut out, distance, decimal);
        let behind = if uncertainty.is_nan() {
            &empty
        } else {
            out.extend_from_slice(separator);
            push_single(&mut out, uncertainty, decimal);
            &tails
        };
        match code.and_then(|code| behind.get(code)) {
            Some(tail) => out.extend_from_slice(tail),
            None => out.extend_from_slice(ends_with),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lines;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_same_as_line_by_line(
            rows in prop::collection::vec(("[a-z,]{1,90}", 0_u32..9_999_999, any::<bool>(), 0_i16..3), 1..20),
            with_return in any::<bool>(),
            separator in "[;\t\u{e4}]",
        ) {
            let end = if with_return { "\r\n" } else { "\n" };
            let reasons = ["", "a", "b c"].map(|reason| format!("{reason}{separator}{reason}"));
            let status = reasons.clone().map(String::into_bytes);
            let (mut text, mut expected) = (String::new(), String::new());
            let (mut distance, mut uncertainty, mut codes) = (vec![], vec![], vec![]);
            for (line, millimeters, known, code) in rows {
                let value = f64::from(millimeters) / 1e3;
                distance.push(if code == 0 { value } else { f64::NAN });
                uncertainty.push(if known { 0.25 } else { f32::NAN });
                codes.push(code);
                let shown = if code == 0 { value.to_string() } else { String::new() };
                let reason = &reasons[usize::try_from(code).unwrap()];
                let results = [line.as_str(), &shown, if known { "0.25" } else { "" }, reason];
                text += &(line.clone() + end);
                expected += &(results.join(&separator) + end);
            }
            let results = Results {
                distance: &distance,
                uncertainty: &uncertainty,
                codes: &codes,
                status: &status,
            };
            let ends = lines::ends(text.as_bytes(), with_return).unwrap();
            let ending = lines::ending(with_return);
            let written = appended(text.as_bytes(), &ends, ending, results, separator.as_bytes(), b'.');
            prop_assert_eq!(String::from_utf8(written).unwrap(), expected);
        }
    }
}
