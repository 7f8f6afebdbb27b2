//! The fields of rows as texts, without the quotation marks around them.

use crate::bytes::Needle;
use crate::lines::{Dialect, Kind, Scan};
use crate::quotes::behind_blanks;
use crate::row::{each, width};

/// The fields of one column, one behind the other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texts {
    /// Their bytes.
    pub data: Vec<u8>,
    /// Where each begins, and where the last one ends.
    pub bounds: Vec<i32>,
}

/// Fields of the columns at some ascending places; empty where a row has none.
///
/// Blanks before a field are no part of it. A row that is too wide has no field, and one that is cut not its last.
/// None where the fields of a column are more than two gigabytes.
///
/// # Examples
/// ```
/// # use echocal_text::{fields::texts, lines::{Dialect, Memory, scan}};
/// let dialect = Dialect { separator: b',', width: 2, ..Dialect::default() };
/// let text = b"5,\"a, \"\"b\"\"\"\n6, c\n7\n";
/// let lines = scan(text, &dialect, &mut Memory::default(), true);
/// let found = texts(text, &lines, &dialect, &[1]).unwrap();
/// assert_eq!(found[0].data, b"a, \"b\"c");
/// assert_eq!(found[0].bounds, [0, 6, 7, 7]);
/// ```
#[must_use]
pub fn texts(data: &[u8], lines: &Scan, dialect: &Dialect, places: &[usize]) -> Option<Vec<Texts>> {
    let empty = Texts {
        data: Vec::new(),
        bounds: vec![0],
    };
    let mut columns = vec![empty; places.len()];
    let separator = Needle::new(dialect.separator);
    for (begin, end, kind) in lines.rows() {
        if kind == Kind::Plain {
            let (mut at, mut before) = (begin, 0);
            for (&place, column) in places.iter().zip(&mut columns) {
                at = separator
                    .behind(data, at, end, place - before)
                    .unwrap_or(end);
                before = place;
                let last = separator.first(data, at, end);
                column
                    .data
                    .extend_from_slice(&data[behind_blanks(&data[..last], at)..last]);
            }
        } else {
            wanted(
                &data[begin..end],
                kind,
                dialect.separator,
                places,
                |number, field| {
                    columns[number].data.extend_from_slice(field);
                },
            );
        }
        for column in &mut columns {
            column.bounds.push(i32::try_from(column.data.len()).ok()?);
        }
    }
    Some(columns)
}

/// Take each field that counts of a row that is not plain, with the number of its place.
pub(crate) fn wanted(
    row: &[u8],
    kind: Kind,
    separator: u8,
    places: &[usize],
    mut take: impl FnMut(usize, &[u8]),
) {
    let most = match kind {
        Kind::Wide => return,
        Kind::Cut => width(row, separator) - 1,
        _ => usize::MAX,
    };
    let mut rest = places.iter().copied().enumerate().peekable();
    each(row, separator, |place, field| {
        if place < most
            && let Some((number, _)) = rest.next_if(|&(_, own)| own == place)
        {
            take(number, field);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lines::{Memory, scan};
    use proptest::prelude::*;

    fn found(text: &str, width: usize, places: &[usize]) -> Vec<Vec<String>> {
        let dialect = Dialect {
            separator: b',',
            width,
            ..Dialect::default()
        };
        let lines = scan(text.as_bytes(), &dialect, &mut Memory::default(), true);
        let columns = texts(text.as_bytes(), &lines, &dialect, places).unwrap();
        let plain = |own: &Texts| {
            let cut = |pair: &[i32]| own.data[pair[0] as usize..pair[1] as usize].to_vec();
            own.bounds
                .windows(2)
                .map(|pair| String::from_utf8(cut(pair)).unwrap())
                .collect()
        };
        columns.iter().map(plain).collect()
    }

    #[test]
    fn fields_with_marks() {
        let text = "\"5\", \"a,b\",\n\"\"\"\",\"\" , 7 \n";
        assert_eq!(
            found(text, 3, &[0, 1, 2]),
            [["5", "\""], ["a,b", " "], ["", "7 "]]
        );
        assert_eq!(found("5\" pipe,1\n", 2, &[0]), [["5\" pipe"]]);
        assert_eq!(
            found("5\n6,7,\n8,9,x\n1,2", 2, &[0, 1]),
            [["5", "6", "", "1"], ["", "7", "", "2"]]
        );
        assert_eq!(found("5,6,7\n8,9", 3, &[0, 1]), [["5", "8"], ["6", ""]]);
    }

    proptest! {
        #[test]
        fn marks_around_a_field_are_taken_away(fields in prop::collection::vec("[a\", ]{0,4}", 1..5)) {
            let quoted: Vec<_> = fields.iter().map(|own| format!("\"{}\"", own.replace('"', "\"\""))).collect();
            let places: Vec<_> = (0..fields.len()).collect();
            let text = quoted.join(",") + "\n";
            let wanted: Vec<_> = fields.iter().map(|own| vec![own.clone()]).collect();
            prop_assert_eq!(found(&text, fields.len(), &places), wanted);
        }

        #[test]
        fn plain_rows_are_read_like_others(rows in prop::collection::vec("[a ]{0,9},[a ]{0,2},[a ]{1,9}", 1..5)) {
            let plain = rows.join("\n") + "\n";
            let odd = rows.join(",\n") + ",\n";
            prop_assert_eq!(found(&plain, 3, &[0, 2]), found(&odd, 3, &[0, 2]));
        }

        #[test]
        fn any_bytes_are_read(data in prop::collection::vec(any::<u8>(), 0..40), width in 1_usize..4) {
            let dialect = Dialect { separator: b',', width, ..Dialect::default() };
            let lines = scan(&data, &dialect, &mut Memory::default(), true);
            let columns = texts(&data, &lines, &dialect, &[0]).unwrap();
            prop_assert_eq!(columns[0].bounds.len(), 1 + lines.rows().count());
        }
    }
}
