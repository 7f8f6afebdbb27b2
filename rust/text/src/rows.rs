//! The numbers of plain lines, in one pass over their bytes.

use crate::numbers::number;

/// How the lines of a file are written, and what of them is wanted.
#[derive(Clone, Copy, Debug)]
pub struct Layout<'a> {
    /// Between two fields.
    pub separator: u8,
    /// Fields of each line.
    pub width: usize,
    /// Places of the wanted fields.
    pub places: &'a [usize],
    /// Texts of a field without a value.
    pub missing: &'a [Vec<u8>],
    /// What a line begins with that is no row.
    pub comment: Option<u8>,
    /// What ends each line: `\n` or `\r\n`.
    pub end: &'a [u8],
}

/// Lines that are all plain rows.
#[derive(Clone, Debug, PartialEq)]
pub struct PlainRows {
    /// Place behind the last byte of each line, without what ends it.
    pub ends: Vec<u32>,
    /// The wanted columns; NaN where a value is missing.
    pub columns: Vec<Vec<f64>>,
    /// Whether the last line is ended.
    pub ended: bool,
}

/// The rows of a block; None if one of its lines is not plain.
///
/// # Panics
/// If a place is not in a line.
#[must_use]
pub fn plain_rows(data: &[u8], layout: &Layout<'_>) -> Option<PlainRows> {
    u32::try_from(data.len()).ok()?;
    if !(1..=data.len() + 1).contains(&layout.width) {
        return None; // more fields than bytes
    }
    let mut wanted = vec![None; layout.width];
    for (column, &place) in layout.places.iter().enumerate() {
        wanted[place] = Some(column);
    }
    let mut stops = [false; 256];
    for byte in [layout.separator, b'\n', b'\r', b'"'] {
        stops[usize::from(byte)] = true;
    }
    let expected = data.len() / (4 * layout.width) + 1;
    let mut ends = Vec::with_capacity(expected);
    let mut columns = vec![Vec::with_capacity(expected); layout.places.len()];
    let (mut at, mut ended) = (0, true);
    while at < data.len() {
        if Some(data[at]) == layout.comment || data[at..].starts_with(layout.end) {
            return None;
        }
        for (place, wanted) in wanted.iter().enumerate() {
            let field = &data[at..];
            let length = field.iter().position(|&byte| stops[usize::from(byte)]);
            let field = &field[..length.unwrap_or(field.len())];
            if let Some(column) = wanted {
                columns[*column].push(value(field, layout)?);
            }
            at += field.len();
            if place + 1 < layout.width {
                if data.get(at) != Some(&layout.separator) {
                    return None;
                }
                at += 1;
            }
        }
        ends.push(at as u32);
        if at < data.len() {
            if !data[at..].starts_with(layout.end) {
                return None;
            }
            at += layout.end.len();
        } else {
            ended = false;
        }
    }
    Some(PlainRows {
        ends,
        columns,
        ended,
    })
}

/// The number of a field, NaN if it is missing; None if it is neither.
fn value(field: &[u8], layout: &Layout<'_>) -> Option<f64> {
    let missing = || layout.missing.iter().any(|text| text == field);
    number(field).or_else(|| missing().then_some(f64::NAN))
}

#[cfg(test)]
mod tests {
    use super::{Layout, PlainRows, plain_rows};

    fn rows(text: &str, end: &[u8]) -> Option<PlainRows> {
        let layout = Layout {
            separator: b',',
            width: 3,
            places: &[2, 0],
            missing: &[Vec::new(), b"NA".to_vec()],
            comment: Some(b'#'),
            end,
        };
        plain_rows(text.as_bytes(), &layout)
    }

    #[test]
    fn wanted_columns_in_their_order() {
        let found = rows("1,x,2.5\n-3,,4e2\n", b"\n").unwrap();
        assert_eq!(found.columns, [vec![2.5, 400.0], vec![1.0, -3.0]]);
        assert_eq!((found.ends, found.ended), (vec![7, 15], true));
    }

    #[test]
    fn a_last_line_without_an_end() {
        let found = rows("1,x,2\r\n3,y,4", b"\r\n").unwrap();
        assert_eq!((found.ends, found.ended), (vec![5, 12], false));
    }

    #[test]
    fn missing_values() {
        let found = rows("NA,,\n", b"\n").unwrap();
        assert!(found.columns.iter().all(|column| column[0].is_nan()));
    }

    #[test]
    fn other_lines_are_none() {
        let others = [
            "1,2\n",
            "1,2,3,4\n",
            "\n",
            "1,2,3\n\n",
            "#1,2,3\n",
            "1,\"2\",3\n",
            "1,2,3\r\n",
            "1,2\r,3\n",
            "a,2,3\n",
            "1,2,3\n1",
            "1,2,NaN \n",
        ];
        for text in others {
            assert_eq!(rows(text, b"\n"), None, "{text:?}");
        }
        assert_eq!(rows("1,2,3\n", b"\r\n"), None);
    }
}
