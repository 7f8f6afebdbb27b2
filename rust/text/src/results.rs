//! Lines with results behind each of them.

use std::slice;

use memchr::memrchr;

use crate::digits::{push_distance, push_single};
use crate::lines::{Dialect, Kind, Scan};
use crate::quotes::{MARK, Marks, marks};
use crate::row::width;

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

/// The lines of a text, each row with its results.
///
/// A row gets as many fields as the header. One that has more becomes one quoted field, with the others empty.
/// Rows are as many as lines, results and codes all have; the others are left out.
///
/// # Examples
/// ```
/// # use echocal_text::{lines::{Dialect, Memory, scan}, results::{Results, appended}};
/// let dialect = Dialect { separator: b',', width: 2, ..Dialect::default() };
/// let lines = scan(b"a\n", &dialect, &mut Memory::default(), true);
/// let status = [b",".to_vec()];
/// let results = Results { distance: &[2.5], uncertainty: &[f32::NAN], codes: &[0], status: &status };
/// assert_eq!(appended(b"a\n", &lines, &dialect, results, b'.'), b"a,,2.5,,,\n");
/// ```
#[must_use]
pub fn appended(
    data: &[u8],
    lines: &Scan,
    dialect: &Dialect,
    results: Results<'_>,
    decimal: u8,
) -> Vec<u8> {
    let separator = dialect.separator;
    let tails: Vec<_> = results
        .status
        .iter()
        .map(|text| [&[separator], &text[..]].concat())
        .collect();
    let empty: Vec<_> = tails
        .iter()
        .map(|tail| [&[separator], &tail[..]].concat())
        .collect(); // without uncertainty
    let longest = empty.iter().map(Vec::len).max().unwrap_or(0);
    let mut out = Vec::with_capacity(data.len() + (NUMBERS + 2 + longest) * lines.lines.len());
    let mut numbers = results
        .distance
        .iter()
        .zip(results.uncertainty)
        .zip(results.codes);
    for (begin, line) in lines.spans() {
        let (end, next) = (line.end as usize, line.next as usize);
        if line.kind == Kind::Other {
            out.extend_from_slice(&data[begin..next]);
            continue;
        }
        let Some(((&distance, &uncertainty), &code)) = numbers.next() else {
            break;
        };
        push_row(&mut out, &data[begin..end], line.kind, dialect);
        out.push(separator);
        push_distance(&mut out, distance, decimal);
        let behind = if uncertainty.is_nan() {
            &empty
        } else {
            out.push(separator);
            push_single(&mut out, uncertainty, decimal);
            &tails
        };
        let code = usize::try_from(code).ok();
        if let Some(tail) = code.and_then(|code| behind.get(code)) {
            out.extend_from_slice(tail);
        }
        out.extend_from_slice(&data[end..next]);
    }
    out
}

/// Append a row with as many fields as the header.
fn push_row(out: &mut Vec<u8>, row: &[u8], kind: Kind, dialect: &Dialect) {
    let separator = dialect.separator;
    let more = match kind {
        Kind::Plain | Kind::Other => {
            out.extend_from_slice(row);
            return;
        }
        Kind::Wide => {
            out.push(MARK);
            for &byte in row {
                out.extend_from_slice(if byte == MARK {
                    b"\"\""
                } else {
                    slice::from_ref(&byte)
                });
            }
            out.push(MARK);
            dialect.width - 1
        }
        Kind::Odd | Kind::Cut => {
            let count = width(row, separator);
            let mut end = row.len();
            for _ in dialect.width..count {
                end = memrchr(separator, &row[..end]).unwrap_or(end);
            }
            out.extend_from_slice(&row[..end]);
            if kind == Kind::Cut && marks(row, false, separator) == Marks::Open {
                out.push(MARK); // the results stand behind the field, not in it
            }
            dialect.width.saturating_sub(count)
        }
    };
    out.extend(std::iter::repeat_n(separator, more));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lines::{Memory, scan};
    use proptest::prelude::*;

    fn plain(text: &str, width: usize, separator: u8) -> (Scan, Dialect) {
        let dialect = Dialect {
            separator,
            width,
            comments: true,
            ..Dialect::default()
        };
        (
            scan(text.as_bytes(), &dialect, &mut Memory::default(), true),
            dialect,
        )
    }

    #[test]
    fn rows_get_the_fields_of_the_header() {
        let text = "1,2\n\n# 7\n3\r\n4,5, ,\n6,\"a\",b\n\"7\nx\",8\n9,\"b";
        let (lines, dialect) = plain(text, 2, b',');
        let count = lines.rows().count();
        let (distance, codes) = (vec![1.0; count], vec![0; count]);
        let results = Results {
            distance: &distance,
            uncertainty: &vec![f32::NAN; count],
            codes: &codes,
            status: &[b"s".to_vec()],
        };
        let written = appended(text.as_bytes(), &lines, &dialect, results, b'.');
        let wanted = "1,2,1,,s\n\n# 7\n3,,1,,s\r\n4,5,1,,s\n\"6,\"\"a\"\",b\",,1,,s\n\"7\nx\",8,1,,s\n9,\"b\",1,,s";
        assert_eq!(String::from_utf8(written).unwrap(), wanted);
    }

    proptest! {
        #[test]
        fn the_same_as_line_by_line(
            rows in prop::collection::vec(("[a-z]{1,90}", 0_u32..9_999_999, any::<bool>(), 0_i16..3), 1..20),
            with_return in any::<bool>(),
            separator in "[;\t]",
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
            let (lines, dialect) = plain(&text, 1, separator.as_bytes()[0]);
            let written = appended(text.as_bytes(), &lines, &dialect, results, b'.');
            prop_assert_eq!(String::from_utf8(written).unwrap(), expected);
        }
    }
}
