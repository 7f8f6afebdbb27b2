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
    /// Place of the row's text among `status`; a place beyond stands for an empty one.
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
    let longest = results.status.iter().map(Vec::len).max().unwrap_or(0);
    let more = NUMBERS + 3 * separator.len() + longest;
    let mut out = Vec::with_capacity(data.len() + more * ends.len());
    let numbers = results
        .distance
        .iter()
        .zip(results.uncertainty)
        .zip(results.codes);
    for ((begin, end), ((&distance, &uncertainty), &code)) in spans(ends, ending).zip(numbers) {
        out.extend_from_slice(&data[begin..end]);
        out.extend_from_slice(separator);
        push_distance(&mut out, distance, decimal);
        out.extend_from_slice(separator);
        push_single(&mut out, uncertainty, decimal);
        out.extend_from_slice(separator);
        if let Some(text) = usize::try_from(code)
            .ok()
            .and_then(|code| results.status.get(code))
        {
            out.extend_from_slice(text);
        }
        out.extend_from_slice(&data[end..end + ending]);
    }
    out
}
